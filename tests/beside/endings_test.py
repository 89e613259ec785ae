#!/usr/bin/python3
"""However a simulator ends the run, it is said, the robot stands, and nothing recorded is lost."""

import json
import os
import pathlib
import signal
import sys
import tempfile

import experiments
from experiments import runs
import jobs  # tests/support/jobs.py; runs.py adds its folder to the path

KILLED = "'brain' (echo.py) was killed by signal 9 (Killed)"
BRAIN = "simulator: python\nscript: echo.py"


def with_script(scratch, text, **keys):
    file = experiments.explorer(scratch, BRAIN, **keys)
    (scratch / "echo.py").write_text(text)
    return file


def said(scratch, name, text, code, *parts, **keys):
    """What a run says whose script is this one."""
    file = with_script(scratch, text, **{"duration": "20 s", "sync": "lockstep", **keys})
    summary, printed = experiments.run(file, scratch / name, code=code)
    runs.assert_says(printed, *parts)
    assert summary["exit_code"] == code, summary
    return summary


LOOP = """import spikeloop
with spikeloop.music(spikes_in={"in": None}, spikes_out={"out": None}) as host:
    for tick in host:
        %s
"""


def failures(scratch):
    summary = said(scratch, "raised", LOOP % 'assert tick.end_s < 1, "the battery is empty"', 5,
                   "AssertionError: the battery is empty", "echo.py:4: AssertionError", "Traceback ")
    assert "the battery is empty" in summary["exit_reason"], summary
    said(scratch, "left", "import spikeloop\nimport sys\nsys.exit(3)\n", 3,
         "'brain' (echo.py) ended with exit code 3")
    said(scratch, "no_module", "import spikeloop, nonsense\n", 1,
         "'brain' (echo.py) ended with exit code 1", "No module named 'nonsense'")
    said(scratch, "ports", LOOP.replace('"in"', '"im"') % "pass", 2,
         "explorer.yaml ... 'brain' ... 'in'; ... 'im'? ... [SL0302]")
    said(scratch, "width", LOOP.replace('{"in": None}', '{"in": 3}') % "pass", 2,
         "explorer.yaml ... 'brain.in' ... 10 ... echo.py ... 3 ... [SL0306]")
    said(scratch, "kind_in", LOOP.replace('spikes_in={"in"', 'signals_in={"in"') % "pass", 2,
         "explorer.yaml ... 'brain.in' carries spikes, but echo.py declares it in signals_in; write spikes_in")
    said(scratch, "kind_out", LOOP.replace('spikes_out={"out"', 'signals_out={"out"') % "pass", 2,
         "explorer.yaml ... 'brain.out' ... spikes ... echo.py ... signals_out; ... spikes_out")
    said(scratch, "killed", LOOP % "import os; tick.end_s < 1 or os.kill(os.getpid(), 9)", 137,
         KILLED)


def unknown_parameter(scratch):
    file = experiments.explorer(scratch, BRAIN + "\nhesitatin: true", sync="lockstep")
    _, printed = experiments.run(file, scratch / "unknown", code=2)
    runs.assert_says(printed, "explorer.yaml ... 'hesitatin'; ... 'hesitating'? ... [SL0103]")


def drives(row):
    return row["v_m_s"] > 0.1


def interrupted(scratch):
    file = experiments.explorer(scratch, BRAIN, sync="realtime", duration="60 s")
    process = runs.started(file, scratch / "interrupted")
    runs.wait_for_row(scratch / "interrupted", process, drives)
    runs.interrupt(process)
    summary = json.loads((scratch / "interrupted/summary.json").read_text())
    assert 0 < summary["simulated_s"] < 60, summary
    sent = experiments.spikes(scratch / "interrupted", "encoder")
    answered = experiments.spikes(scratch / "interrupted", "brain")
    until = answered[0].max()
    experiments.assert_same(sent[:, sent[0] <= until], answered, "what was recorded")
    counters = summary["processes"]["experiment"]["counters"]
    assert counters["wheels.stops_ended"] == 1, counters


def killed_over_ros(scratch):
    """The robot of a simulator that is gone stands."""
    file = experiments.explorer(scratch, BRAIN, sync="realtime", ros="1", duration="60 s")
    process = runs.started(file, scratch / "dead")
    runs.wait_for_row(scratch / "dead", process, drives)
    os.kill(jobs.find(process.pid, "echo.py"), signal.SIGKILL)
    runs.ended(process, 137, KILLED)
    rows = runs.trajectory(scratch / "dead")
    assert abs(rows[-1]["v_m_s"]) < 0.05, rows[-5:]


def hanging_over_ros(scratch):
    """A robot whose simulator does not answer is stopped by the watchdog, long before the run ends."""
    file = with_script(scratch, LOOP % (
        'tick.send("out", *tick.spikes("in"))\n'
        "        import time; tick.end_s < 3 or time.sleep(60)"),
                       sync="realtime", ros="1", duration="60 s")
    folder = scratch / "hung"
    _, printed = experiments.run(file, folder, "--stall-timeout", "4", code=3)
    runs.assert_says(printed, "the job has stood still for 4 s", "'brain' (echo.py)")
    rows = [(float(row["t_s"]), abs(float(row["v_m_s"]))) for row in runs.recordings.table(folder / "trajectory.csv")]
    driving = [t for t, speed in rows if speed > 0.1]
    # It stood for most of the four seconds in which nothing came any more.
    assert driving and rows[-1][0] - max(driving) > 1.5, (driving[-1:], rows[-1])


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        failures(scratch)
        unknown_parameter(scratch)
        interrupted(scratch)
        killed_over_ros(scratch)
        hanging_over_ros(scratch)
    print("twelve ways to end, each with its reason")


if __name__ == "__main__":
    sys.exit(main())
