#!/usr/bin/python3
"""spikeloop-script: a section of a .music file runs a script that is not executable; and what it says."""

import os
import pathlib
import subprocess
import sys
import tempfile

from experiments import runs

PROGRAMS = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])
JOB = """stoptime=0.01
[a]
  np=1
  binary=spikeloop-script
  {a}
[b]
  np=1
  binary=spikeloop-script
  script=models/b.py
a.out -> b.in [2]
"""
SENDER = """import spikeloop
with spikeloop.music(spikes_out={"out": 2}) as host:
    for tick in host:
        tick.send("out", tick.end_s, 1)
"""
KEEPER = """import spikeloop
with spikeloop.music(spikes_in={"in": 2}) as host:
    got = [len(tick.spikes("in").times) for tick in host]
print("got", sum(got))
"""


def said(scratch, command, keys="script=a.py", code=0, **environment):
    (scratch / "job.music").write_text(JOB.format(a=keys))
    return "".join(runs.spikeloop(command, "job.music", code=code, cwd=scratch, env={**os.environ, **environment}))


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        (scratch / "models").mkdir()
        (scratch / "a.py").write_text(SENDER)
        (scratch / "models/b.py").write_text(KEEPER)
        assert "b: got 10" in said(scratch, "run")
        for command in ("check", "run"):
            printed = said(scratch, command, "script=c.py", 2)
            runs.assert_says(printed, "job.music:5:3: key 'script': ... 'c.py', ... [SL0108]")
            printed = said(scratch, command, "seed=1", 2)
            runs.assert_says(printed, "job.music:2:1: key 'script' is missing: a file in Python that "
                             "spikeloop-script runs; write  script=brain.py")
        runs.assert_says(said(scratch, "run", code=3, PYTHON="/nowhere/python3"),
                         "'/nowhere/python3': ... apt install python3), ... PYTHON ")
        printed = said(scratch, "import", code=1)
        assert "job.music:2:1: [a] runs the script a.py, whose delays are others in an experiment; " \
            "write  a: {simulator: python, script: a.py}  into one by hand" in printed, printed
    alone = subprocess.run([PROGRAMS / "spikeloop-script"], capture_output=True, text=True,
                           check=False)
    assert alone.returncode == 2, alone
    runs.assert_says(alone.stderr, " binary=spikeloop-script ... script=FILE.py")
    told = subprocess.run([PROGRAMS / "spikeloop-script", "--help"], capture_output=True, text=True,
                          check=True)
    assert "script=brain.py" in told.stdout, told
    print("spikeloop-script runs scripts, and says what is wrong")


if __name__ == "__main__":
    sys.exit(main())
