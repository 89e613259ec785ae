"""Ctrl-Z in a Python program also suspends the runs that it has started, which have sessions of their own."""

import os
import pathlib
import signal
import subprocess
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
import jobs  # noqa: E402

# The parent as experiment.run() is; the child prints what a launcher would act on.
CHILD = """
import signal, time
for number in (signal.SIGTSTP, signal.SIGCONT):
    signal.signal(number, lambda number, _: print(signal.Signals(number).name, flush=True))
print("ready", flush=True)
while True:
    time.sleep(1)
"""
PARENT = """
import subprocess, sys, time
from spikeloop.experiment import suspending
child = subprocess.Popen([sys.executable, "-c", sys.argv[1]], start_new_session=True)
with suspending(lambda: [child]):
    child.wait()
"""


class Suspend(unittest.TestCase):
    def test_the_child_is_suspended_and_continued(self):
        parent = subprocess.Popen([sys.executable, "-c", PARENT, CHILD], stdout=subprocess.PIPE, text=True)
        family = []
        try:
            self.assertEqual(parent.stdout.readline(), "ready\n")
            family = jobs.processes_of(parent.pid)
            os.kill(parent.pid, signal.SIGTSTP)
            self.assertEqual(parent.stdout.readline(), "SIGTSTP\n")
            deadline = time.monotonic() + 10
            while jobs.state(parent.pid) != "T" and time.monotonic() < deadline:
                time.sleep(0.01)
            self.assertEqual(jobs.state(parent.pid), "T")
            os.kill(parent.pid, signal.SIGCONT)
            self.assertEqual(parent.stdout.readline(), "SIGCONT\n")
        finally:
            jobs.send({*family, parent.pid}, signal.SIGKILL)
            parent.stdout.close()
            parent.wait()


if __name__ == "__main__":
    unittest.main()
