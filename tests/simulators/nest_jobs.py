"""Jobs with NEST in the middle.

    play (a script that sends given spikes) -> brain -> sink

A test says in its command line which kind of NEST it is for.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import jobs
import nest_found


JOB = """\
stoptime={duration_s}
music_timestep={tick_s}
{sections}
play.out -> brain.in [{width}]
brain.out -> sink.in [{width_out}]
"""


def main():
    """Of a test file: `FILE KIND ...`. Chooses the NEST of this kind for all that is started, or
    says that there is none."""
    kind = sys.argv.pop(1)
    directory = nest_found.directory_or_skip(kind)
    if directory:
        os.environ["PYTHONPATH"] = directory
    global WITH_MUSIC
    WITH_MUSIC = kind == nest_found.KINDS[0]
    sys.exit(unittest.main())


WITH_MUSIC = None


class NestJob(jobs.Job):
    """A folder with a .music file and its scripts. spikes: (times in ns, channels) that are sent.
    order: of the sections; `spikeloop run` orders them itself, run_by_music() does not."""

    def __init__(self, script, width, spikes, *, width_out=None, tick_s=0.001, duration_s=1, keys="",
                 play_keys="", order=("sink", "brain", "play"), binary=None):
        self._temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self._temporary.name)
        for name in (script, "sink.py", "play.py"):
            shutil.copy(jobs.HERE / "scripts" / name, self.folder)
        np.save(self.folder / "spikes.npy", np.stack(spikes))
        sections = {
            "play": f"[play]\n  np=1\n  binary=./play.py\n  sync=unpaced\n  {play_keys}",
            "brain": f"[brain]\n  np=1\n  binary={binary or './' + script}\n  record=true\n  {keys}",
            "sink": "[sink]\n  np=1\n  binary=./sink.py"}
        self.file = self.folder / "job.music"
        self.file.write_text(JOB.format(
            duration_s=duration_s, tick_s=tick_s, width=width, width_out=width_out or width,
            sections="\n".join(sections[label] for label in order)))
        self.out = self.folder / "out"

    def run_by_music(self, timeout=120):
        """Without our launcher, which would order the sections and choose keys."""
        self.out.mkdir(exist_ok=True)
        environment = {**os.environ, "SPIKELOOP_OUT": str(self.out),
                       "PYTHONPATH": f"{jobs.PACKAGE}:{os.environ.get('PYTHONPATH', '')}"}
        done = subprocess.run(
            ["mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "--mca",
             "mpi_yield_when_idle", "1", "-np", "3", "music", "job.music"], cwd=self.folder,
            env=environment, capture_output=True, text=True, timeout=timeout, check=False)
        assert done.returncode == 0, done.stdout + done.stderr


def expected(times, begins, *, step_ns, delay_ns, guarded, end_ns):
    """(times, which of them come before the end): what comes back of these spikes, by the rules of
    docs/simulators.md. begins: of the ticks that they are sent in."""
    if guarded:
        times = np.maximum(times, begins + 1000)
    rounded = (times + 500) // 1000 * 1000  # NEST's tic
    steps = -(-rounded // step_ns)
    if not WITH_MUSIC:
        steps = np.maximum(steps, begins // step_ns + 1)
    times = steps * step_ns + delay_ns
    return times, times <= end_ns
