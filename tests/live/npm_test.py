"""Files and live view, read by the packages of npm that Foxglove is made of: @mcap/core, @foxglove/ws-protocol. Where
npm is not there, or cannot get the packages, the test is skipped."""

import collections
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

import viewing
from mcap_file import McapFile
from runs import SPIKELOOP, recordings, run

SKIPPED = 77
SCRIPTS = pathlib.Path(__file__).parent / "npm"
MODULES = tempfile.TemporaryDirectory()
NODE = pathlib.Path(MODULES.name)


def install():
    """Why the packages are not there; None: they are."""
    if not shutil.which("npm") or not shutil.which("node"):
        return "there is no npm"
    for file in SCRIPTS.iterdir():
        shutil.copy(file, NODE)
    try:
        subprocess.run(["npm", "install", "--ignore-scripts", "--no-audit", "--no-fund", "--no-package-lock"], cwd=NODE,
                       check=True, capture_output=True, text=True, timeout=240)
    except subprocess.TimeoutExpired:
        return "npm install takes too long"
    except subprocess.CalledProcessError as failure:
        return f"npm install: {failure.stderr}"
    return None


def node(script, *arguments):
    """What the script prints, from JSON."""
    done = subprocess.run(["node", script, *map(str, arguments)], cwd=NODE, capture_output=True, text=True, check=False,
                          timeout=120)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def messages_of(file):
    """Their number, by topic and node, as a reader of our own counts them."""
    names = {number: f"{topic} {metadata['spikeloop_node']}"
             for number, (_, topic, _, metadata) in file.channels.items()}
    return dict(collections.Counter(names[number] for number, _, _ in file.messages))


class Npm(viewing.FolderCase):
    def test_files(self):
        run(viewing.EXAMPLE, self.folder / "run", "--duration", "5")
        exported = self.folder / "run.mcap"
        subprocess.run([SPIKELOOP, "view", self.folder / "run", "--out", exported], check=True, timeout=120)
        for path in (self.folder / "run/messages.mcap", exported):
            found = node("read_mcap.js", path)
            self.assertTrue(found["whole"])
            self.assertEqual(found["attachments"], ["resolved.json"])
            self.assertEqual(found["messages"], messages_of(McapFile(path)))
        for name in ("encoder", "brain"):
            times, channels = recordings.spikes(self.folder / "run", name)
            self.assertEqual(found["spikes"][f"/{name}/out"], {
                "number": len(times), "times": str(int(times.sum())), "channels": int(channels.sum())})

    def test_the_file_of_a_run_that_was_killed(self):
        messages = self.folder / "run/messages.mcap"
        job = subprocess.Popen([SPIKELOOP, "run", viewing.EXAMPLE, "--out", self.folder / "run", "--duration", "36000"],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        end = time.monotonic() + 120
        while not messages.exists() or messages.stat().st_size < 1_000_000:
            self.assertLess(time.monotonic(), end)
            self.assertIsNone(job.poll())
            time.sleep(0.02)
        job.kill()
        job.wait()
        whole = messages.read_bytes()
        messages.write_bytes(whole[:-len(whole) // 10])  # in the middle of a chunk, as at worst
        file, found = McapFile(messages), node("read_mcap.js", messages)
        self.assertFalse(found["whole"] or file.ended)
        self.assertGreater(found["messages"]["/scan scan"], 100)
        self.assertEqual(found["messages"], messages_of(file))

    def test_live(self):
        with viewing.Run(self.folder / "run", "--sync", "realtime", "--duration", "600") as job:
            found = node("watch_run.js", job.socket_url(), "encoder.rate_max", 150)
            self.assertLessEqual({"/scan", "/cmd_vel", "/encoder/out", "/spikeloop/status"}, set(found["channels"]))
            self.assertEqual(found["parameters"], [{"name": "encoder.rate_max", "value": 150}])
            self.assertGreater(found["beams"], 10)
            job.interrupt()


if __name__ == "__main__":
    missing = install()
    if missing:
        print(f"skipped: {missing}")
        sys.exit(SKIPPED)
    unittest.main()
