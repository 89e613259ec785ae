#!/usr/bin/python3
"""Ctrl-C, nodes that fail and hang, a folder in use, options of the other kind of file; and nothing
recorded is lost."""

import json
import pathlib
import sys
import tempfile

import runs

FAILING = """import spikeloop

@spikeloop.node(inputs={"in": "signal"}, outputs={"out": spikeloop.Signal(same_as="in")})
def failing(step):
    if step.begin > 100_000_000:
        raise ValueError("the battery is empty")

@spikeloop.node
class Miscounting:
    inputs, outputs = {"in": spikeloop.Signal()}, {"out": spikeloop.Signal(same_as="in")}
    def step(self, step):
        pass
    def counters(self):
        raise ValueError("lost count")

@spikeloop.node(inputs={"in": "signal"}, outputs={"out": spikeloop.Signal(same_as="in")})
def losing(step):
    from_here = step.begin > 100_000_000
    step.write("out", step.inputs["in"] * (float("nan") if from_here else 1.0))

@spikeloop.node(inputs={"in": "signal"}, outputs={"out": spikeloop.Signal(same_as="in")})
def hanging(step):
    import pathlib, time
    if step.begin > 100_000_000:
        pathlib.Path(__file__).with_name("hangs").touch()
        time.sleep(60)
"""


def interrupted(scratch):
    file = runs.new_experiment(scratch / "long.yaml", duration="60 s")
    folder = scratch / "long"
    process = runs.started(file, folder)
    runs.wait_for_row(folder, process, lambda row: row["v_m_s"] > 0.1)
    runs.refused(f"'{folder}'; ... --out [SL0109]", "run", file, "--out", folder, code=4)
    runs.interrupt(process, "stopped by Ctrl-C")
    summary = json.loads((folder / "summary.json").read_text())
    assert (summary["exit_code"], summary["exit_reason"]) == (130, "stopped by Ctrl-C"), summary
    assert 0 < summary["simulated_s"] < 50, summary
    assert summary["counters"]["wheels.stops_ended"] == 1, summary


def with_node(scratch, name):
    """An experiment with a node of failing.py between sensor and encoder."""
    (scratch / "failing.py").write_text(FAILING)
    file = runs.new_experiment(scratch / "bad.yaml", sync="lockstep")
    text = file.read_text()
    text = text.replace("nodes:\n", f"plugins: [failing.py]\nnodes:\n  odd: {{node: {name}}}\n")
    file.write_text(text.replace("scan -> sectors", "scan -> odd [100] -> sectors"))
    return file


def hanging_node(scratch):
    file = with_node(scratch, "hanging")
    process = runs.started(file, scratch / "hung")
    runs.wait(process, (scratch / "hangs").exists)
    runs.interrupt(process, "a node has not come back within 3 s")


def own_recording(scratch):
    file = scratch / "again.yaml"
    file.write_text(f"""duration: 1 s
sync: unpaced
nodes:
  old: {{node: spike_playback, file: {scratch}/long/encoder.h5}}
  decoder: {{node: rate_window}}
connections: [old -> decoder]
""")
    runs.refused(f"{file}:4:37: key 'file': ... {scratch}/long/encoder.h5 ... --out [SL0109]",
                 "run", file, "--out", scratch / "long")
    assert (scratch / "long/encoder.h5").exists()


def nothing_is_lost(scratch):
    """Without a clock the loop waits for the disk: 2,500,000 spikes are ten times what may wait."""
    file = scratch / "wide.yaml"
    file.write_text(f"""duration: 0.5 s
sync: unpaced
nodes:
  old: {{node: signal_playback, file: {scratch}/long/sectors.h5}}
  wide: {{node: connect, weights: uniform}}
  encoder: {{node: rate_encoder, rate_min: 1 kHz, rate_max: 1 kHz}}
connections:
  - old -> wide -> encoder [5000]
""")
    summary, _ = runs.run(file, scratch / "wide")
    assert summary["records_dropped"] == 0, summary
    assert summary["spikes_recorded"] == summary["counters"]["encoder.spikes"] > 2_000_000, summary


def failing_node(scratch):
    summary, printed = runs.run(with_node(scratch, "miscounting"), scratch / "bad", code=5)
    assert "ValueError: lost count" in summary["exit_reason"], summary
    summary, printed = runs.run(with_node(scratch, "failing"), scratch / "bad", code=5)
    assert "node 'odd'" in printed and "ValueError: the battery is empty" in printed, printed
    assert summary["exit_code"] == 5 and "battery" in summary["exit_reason"], summary
    assert summary["counters"]["wheels.stops_terminated"] <= 1, summary


def not_a_number(scratch):
    """The robot is stopped, and it is said whose value stopped it."""
    file = runs.new_experiment(scratch / "nan.yaml", sync="lockstep")
    text = file.read_text().replace("nodes:\n",
                                    "plugins: [failing.py]\nnodes:\n  odd: {node: losing}\n")
    file.write_text(text.replace("-> wheels [2]", "-> odd [2] -> wheels [2]"))
    summary, printed = runs.run(file, scratch / "nan", "--duration", "2")
    assert printed.count(": the robot is stopped: ") == 1, printed
    runs.assert_says(printed, "the robot is stopped: ... 'odd.out' ... (NaN)")
    assert 0 < summary["commands"] <= 101, summary  # as many ticks as there are before it


def old_data(scratch):
    """A scan comes every 50 ms; data that are older than 10 ms stop the robot, which is printed once
    a second at most. With the next scan it goes on."""
    file = runs.new_experiment(scratch / "old.yaml", sync="lockstep")
    file.write_text(file.read_text().replace("  wheels:\n", "  wheels:\n    max_age: 10 ms\n    sensor_timeout: 1 s\n"))
    summary, printed = runs.run(file, scratch / "old", "--duration", "2")
    assert summary["counters"]["wheels.stops_data_too_old"] >= 38, summary
    assert summary["counters"]["wheels.resumed"] >= 38, summary
    said = "s: the robot is stopped: the data are older than max_age, 10 ms"
    assert 1 <= printed.count(said) <= 2 and "warning: node 'wheels' at " in printed, printed


def wrong_options(scratch):
    file = runs.new_experiment(scratch / "options.yaml")
    for arguments, text in (
            (["--roscore"], "--roscore is for .music files, an experiment file says such things "
                            "itself; leave it out"),
            (["--layout", "separate"], "key 'layout': ... [SL0601]"), (["--sync", "locked"], "--sync")):
        runs.refused(text, "run", file, *arguments, cwd=scratch)
    open_end = scratch / "end.yaml"
    open_end.write_text(
        "nodes: {a: {simulator: builtin, network: {populations: {n: {model: iaf_psc_delta, size: 1}},"
        " output: [n]}},\n  r: {node: linear_readout, weights: [[1]]}}\n"
        "connections: [a -> r]\nduration: 1 s\nsync: unpaced\n")
    runs.run(open_end, scratch / "end")
    runs.run(open_end, scratch / "apart", "--layout", "separate")
    runs.refused("end.yaml:2:3: nothing is connected to an output of 'r', and a program in an exported job knows its "
                 "width from a connection; connect it [SL0305]", "export", open_end, "--out", scratch / "job")
    music = scratch / "a.music"
    music.write_text("[a]\nnp=1\nbinary=b\n")
    runs.refused("--no-record is for experiment files; leave it out", "run", music, "--no-record", cwd=scratch)


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        interrupted(scratch)
        own_recording(scratch)
        nothing_is_lost(scratch)
        failing_node(scratch)
        hanging_node(scratch)
        not_a_number(scratch)
        old_data(scratch)
        wrong_options(scratch)
    print("stopped by Ctrl-C, by a failing node, and not begun with wrong options")


if __name__ == "__main__":
    sys.exit(main())
