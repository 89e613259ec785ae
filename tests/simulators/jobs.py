"""Jobs with a script in the middle, as a user runs them; for the tests beside this file.

    sine -> encoder -> brain (the script) -> sink (a script that keeps what it gets)

or, where nobody looks at what is sent, and half of the processor time is enough:

    encoder (that plays back what it has sent) -> brain (the script) -> sink (a readout)
"""

import functools
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "support"))
from calls import assert_says  # noqa: E402, F401
from recordings import assert_same, spikes  # noqa: E402, F401

SINE = HERE.parents[1] / "examples/05_encoder_python/sine.py"
PROGRAMS = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])
SPIKELOOP = PROGRAMS / "spikeloop"
PACKAGE = PROGRAMS.parent / "share/spikeloop/python"

JOB = """\
stoptime={duration_s}
music_timestep={tick_s}
[sine]
  np=1
  binary=spikeloop-node
  plugin={sine}
  node=sine
  sync=unpaced
[encoder]
  np=1
  binary={encoder}
  rate_max={rate_max} Hz
  record=true
[brain]
  np=1
  binary=./{script}
  record=true
  {keys}
[sink]
  np=1
  binary=./sink.py
  record=false
sine.out -> encoder.in [{width}]
encoder.out -> brain.in [{width}]
brain.out -> sink.in [{width_out}]
"""
# The ends are programs that take no time to start, unlike Python's.
SHORT_JOB = """\
stoptime={duration_s}
music_timestep={tick_s}
[encoder]
  np=1
  binary=spike_playback
  file=played.h5
  sync=unpaced
[brain]
  np=1
  binary=./{script}
  record=true
  {keys}
[sink]
  np=1
  binary=linear_readout_decoder
  weights=uniform
  record=false
encoder.out -> brain.in [{width}]
brain.out -> sink.in [{width_out}]
"""


class Job:
    """A folder with a .music file and its scripts; `with Job(...) as job`."""

    def __init__(self, script, width, *, text=None, encoder="poisson_encoder", rate_max=40,
                 tick_s=0.001, duration_s=1, width_out=None, keys="", short=False):
        self._temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self._temporary.name)
        for name in (script, "sink.py"):
            if (HERE / "scripts" / name).exists():
                shutil.copy(HERE / "scripts" / name, self.folder)
        if text is not None:
            (self.folder / script).write_text(text)
            (self.folder / script).chmod(0o755)
        if short:
            (self.folder / "played.h5").write_bytes(sent_by_encoder(width))
        self.file = self.folder / "job.music"
        self.file.write_text((SHORT_JOB if short else JOB).format(
            script=script, width=width, width_out=width_out or width, encoder=encoder,
            rate_max=rate_max, tick_s=tick_s, duration_s=duration_s, keys=keys, sine=SINE))
        self.out = self.folder / "out"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._temporary.cleanup()

    def command(self, *more):
        return [str(SPIKELOOP), "run", "job.music", "--out", "out", "--force", *more]

    def run(self, *more, code=0, timeout=240):
        """Runs to the end, which must have this exit code; gives what was printed."""
        # Brian2 leaves a log in TMPDIR when its script does not come to its end.
        done = subprocess.run(self.command(*more), cwd=self.folder, capture_output=True, text=True,
                              env={**os.environ, "TMPDIR": str(self.folder)}, check=False,
                              timeout=timeout)
        said = done.stdout + done.stderr
        assert done.returncode == code, f"exit code {done.returncode} instead of {code}:\n{said}"
        return said

    def stopped_by(self, number):
        """In real time, ended by this signal when it is under way: (exit code, what was printed)."""
        self.file.write_text(self.file.read_text().replace("sync=unpaced", "sync=realtime"))
        started = subprocess.Popen(self.command(), cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True, bufsize=1)
        try:
            for line in started.stdout:  # the first word of progress comes with the first ticks
                if re.search(r" of \d+ s", line):
                    break
            time.sleep(0.5)
            started.send_signal(number)
            said = started.communicate(timeout=60)[0]
        finally:
            started.kill()
            started.wait()
        return started.returncode, said

    def sent(self):
        """(times in ns, channels) that the encoder recorded."""
        return spikes(self.out, "encoder")

    def recorded(self):
        """(times in ns, channels) that the script's host recorded."""
        return spikes(self.out, "brain")

    def received(self):
        """(times in ns, channels, begins of the ticks in ns) that the sink got."""
        times, channels, begins = np.load(self.folder / "got.npy")
        return (np.rint(times * 1e9).astype(np.int64), channels.astype(int),
                np.rint(begins * 1e9).astype(np.int64))


@functools.cache
def sent_by_encoder(width):
    """The recording of an encoder in a job whose script is all right."""
    with Job("repeat_python.py", width, encoder="rate_encoder") as job:
        job.run("--quiet")
        return (job.out / "encoder.h5").read_bytes()
