"""What a viewer gets is what the run records, and the run is the same with viewers and without."""

import http.client
import json
import os
import pathlib
import unittest
import urllib.request

import h5py
import viewing
from runs import fingerprint, recordings, run


def get(url, path, **headers):
    with urllib.request.urlopen(urllib.request.Request(url + path, headers=headers), timeout=30) as answer:
        return answer.status, answer.headers, answer.read()


class Protocol(viewing.FolderCase):
    def test_spikes_and_signals_are_those_of_the_recording(self):
        recorded = self.folder / "live"
        viewer = viewing.watched(recorded, {"/spikeloop/view"}, 20, lambda viewer: viewer.status()["ended"],
                                 "--duration", "30")
        topics = {channel["topic"]: channel for channel in viewer.channels.values()}
        self.assertEqual(topics["/encoder/out"]["schemaName"], "spikeloop/msg/Spikes")
        self.assertEqual(topics["/scan"]["schemaName"], "sensor_msgs/LaserScan")
        self.assertIn("float32[] ranges", topics["/scan"]["schema"])
        self.assertEqual(viewer.info["metadata"], {"experiment": "braitenberg", "recording": "no"})
        self.assertEqual(json.loads(viewer.messages["/spikeloop/view"][-1][1])["lost"], 0)
        for node in ("encoder", "brain"):
            times, channels = viewing.spikes_of(viewer.messages[f"/{node}/out"])
            all_times, all_channels = map(list, recordings.spikes(recorded, node))
            self.assertGreater(len(times), 1000)
            # The run may have begun before the viewer came.
            self.assertEqual(times, all_times[-len(times):], node)
            self.assertEqual(channels, all_channels[-len(times):], node)
        with h5py.File(recorded / "decoder.h5") as file:
            rows = {tuple(row) for row in file["signals/out/values"][()]}
        shown = [tuple(viewing.signal_of(message)) for _, message in viewer.messages["/decoder/out"]]
        self.assertGreater(len(shown), 20)
        self.assertLessEqual(set(shown), rows)
        self.assertTrue(viewer.status()["ended"])
        counters = json.loads((recorded / "summary.json").read_text())["counters"]
        self.assertEqual(viewer.status()["spikes"]["encoder.out"], counters["encoder.out->brain.in.spikes"])
        # The same run without a view.
        alone = self.folder / "alone"
        run(viewing.EXAMPLE, alone, "--duration", "30")
        self.assertEqual(fingerprint(recorded), fingerprint(alone))

    def heads(self, url):
        """HEAD gives the headers of GET, and no body; both requests on one connection."""
        connection = http.client.HTTPConnection(url.removeprefix("http://").rstrip("/"), timeout=30)
        answers = []
        for method in ("HEAD", "GET"):
            connection.request(method, "/main.js")
            answer = connection.getresponse()
            answers.append((answer.status, answer.headers["content-length"], answer.headers["content-type"]))
            self.assertEqual(len(answer.read()), 0 if method == "HEAD" else int(answers[0][1]))
        self.assertEqual(answers[0], answers[1])
        connection.request("PUT", "/main.js")
        self.assertEqual(connection.getresponse().status, 405)
        connection.close()

    def test_page_and_files_of_the_run(self):
        with viewing.Run(self.folder / "run", "--sync", "realtime", "--duration", "60") as job:
            viewer = viewing.Viewer(job.socket_url(), "/spikeloop/status")
            viewer.until(lambda: "/spikeloop/status" in viewer.messages and viewer.status()["simulated_s"] > 0.5)
            status, headers, page = get(job.site(), "")
            self.assertEqual(status, 200)
            self.assertIn(b"<html", page)
            self.assertEqual(get(job.url, "")[2], page)
            self.assertIn("default-src 'self'", headers["content-security-policy"])
            self.assertEqual(json.loads(get(job.site(), "run/resolved.json")[2])["experiment"], "braitenberg")
            _, _, path = get(job.site(), "run/trajectory.csv")
            self.assertTrue(path.startswith(b"t_s,x_m,"))
            status, headers, rest = get(job.site(), "run/trajectory.csv", Range=f"bytes={len(path) - 10}-")
            self.assertEqual(status, 206)
            self.assertTrue(rest.startswith(path[-10:]))
            first, size = len(path) - 10, len(path) - 10 + len(rest)
            self.assertEqual(headers["content-range"], f"bytes {first}-{size - 1}/{size}")
            for other in ("bytes=0-9", "bytes=-5", "lines=1-"):  # may be answered with all
                status, _, page = get(job.site(), "run/resolved.json", Range=other)
                self.assertEqual((status, json.loads(page)["experiment"]), (200, "braitenberg"))
            with self.assertRaises(urllib.error.HTTPError) as failure:
                get(job.site(), "run/resolved.json", Range="bytes=1000000000-")
            self.assertEqual(failure.exception.code, 416)
            self.assertRegex(failure.exception.headers["content-range"], r"^bytes \*/\d+$")
            self.heads(job.site())
            viewer.send(op="getParameters", parameterNames=["encoder.rate_min"], id="one")
            viewer.until(lambda: viewer.parameters == {"encoder.rate_min": 1})
            for missing in ("run/log.txt", "run/../../secret", "..%2f..%2fetc/passwd", "nothing.js"):
                with self.assertRaises(urllib.error.HTTPError, msg=missing) as failure:
                    get(job.site(), missing)
                self.assertEqual(failure.exception.code, 404, missing)
            self.only_regular_files(job)
            code, printed = job.interrupt()
        self.assertEqual(code, 130, printed)
        self.assertEqual(job.servers(), [])

    def only_regular_files(self, job):
        """The server serves no links out of the run folder, and no pipes, which would block it."""
        for name, make in (("world.json", lambda path: path.symlink_to("/etc/hostname")), ("episodes.csv", os.mkfifo),
                           ("summary.json", pathlib.Path.mkdir)):
            path = self.folder / "run" / name
            path.unlink(missing_ok=True)
            make(path)
            with self.assertRaises(urllib.error.HTTPError, msg=name) as failure:
                get(job.site(), f"run/{name}")
            self.assertEqual(failure.exception.code, 404, name)
            (path.rmdir if path.is_dir() and not path.is_symlink() else path.unlink)()


if __name__ == "__main__":
    unittest.main()
