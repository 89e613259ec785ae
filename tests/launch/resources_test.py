#!/usr/bin/python3
"""`spikeloop run` refuses a job for which the machine has too little of a resource, and starts nothing. Two programs run
with 6 MB of shared memory."""

import pathlib
import resource
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
from calls import SPIKELOOP, TWO_PROGRAMS  # noqa: E402

SMALL = "mount -t tmpfs -o size=6m tmpfs /dev/shm && exec \"$@\""
NAMESPACE = ["unshare", "--mount", "--propagation", "private", "sh", "-c", SMALL, "sh"]


def may_mount():
    return subprocess.run([*NAMESPACE, "true"], capture_output=True).returncode == 0


class Resources(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "cycle.yaml").write_text(TWO_PROGRAMS)

    def run_job(self, *options, before=(), limit=None):
        def lower():
            if limit is not None:
                resource.setrlimit(*limit)
        return subprocess.run([*before, SPIKELOOP, "run", "cycle.yaml", "--out", "run", "--force", *options],
                              cwd=self.folder, preexec_fn=lower, capture_output=True, text=True, timeout=120)

    def refused(self, done, *words):
        self.assertEqual(done.returncode, 3, done)
        for word in (*words, "[SL0604]"):
            self.assertIn(word, done.stderr)
        log = self.folder / "run/mpirun.log"
        self.assertFalse(log.exists() and log.read_text(), "a program was started")

    def test_open_files(self):
        self.refused(self.run_job(limit=(resource.RLIMIT_NOFILE, (32, 32))), "files is 32", "needs 35", "ulimit -n 35")

    def test_address_space(self):
        few = 450_000_000
        self.refused(self.run_job(limit=(resource.RLIMIT_AS, (few, few))), "450 MB", "510 MB", "ulimit -v unlimited")

    @unittest.skipUnless(may_mount(), "the kernel refuses a mount namespace")
    def test_shared_memory(self):
        done = self.run_job(before=NAMESPACE)
        self.assertEqual(done.returncode, 0, done)
        self.refused(self.run_job("--live", "--live-port=0", before=NAMESPACE), "/dev/shm has 6 MB free",
                     "2 programs with --live need up to 43 MB", "--shm-size=", "leave out --live")


if __name__ == "__main__":
    unittest.main()
