"""Requests of pages of other sites, of other machines, and of programs that mean no good; and a server that is
killed."""

import os
import pathlib
import re
import signal
import socket
import time
import unittest
import urllib.error
import urllib.request

import viewing
import websocket

STATUS = "/spikeloop/status"
FRAME = 100_000_000


class Hostile(viewing.FolderCase):
    def start(self, *arguments):
        run = viewing.Run(self.folder / "run", "--sync", "realtime", "--duration", "600", *arguments)
        self.addCleanup(run.__exit__)
        return run

    def refused(self, url, **options):
        with self.assertRaises((websocket.WebSocketException, OSError)):
            websocket.create_connection(url, timeout=10, **options)

    def still_serves(self, run):
        viewer = viewing.Viewer(run.socket_url(), STATUS)
        viewer.until(lambda: STATUS in viewer.messages)
        viewer.socket.close()

    def test_other_sites_are_refused(self):
        run = self.start()
        url, ours = run.socket_url(), [viewing.PROTOCOL]
        port = url.rstrip("/").rsplit(":", 1)[1]
        self.refused(url, subprotocols=ours, origin="http://evil.example")
        self.refused(url, subprotocols=ours, origin="null")
        self.refused(url, subprotocols=ours, origin=f"http://127.0.0.1:{int(port) + 1}")
        self.refused(url, subprotocols=ours, host=f"evil.example:{port}", suppress_origin=True)
        self.refused(url, subprotocols=ours, host=f"evil.example:{port}", origin=f"http://evil.example:{port}")
        self.refused(url)
        self.refused(url, subprotocols=["other.protocol"])
        request = urllib.request.Request(run.url + "run/resolved.json", headers={"Host": f"evil.example:{port}"})
        with self.assertRaises(urllib.error.HTTPError) as failure:
            urllib.request.urlopen(request, timeout=10)
        self.assertEqual(failure.exception.code, 403)
        for fine in ({"origin": f"http://127.0.0.1:{port}"}, {"origin": "file://"}, {"suppress_origin": True},
                     {"host": f"localhost:{port}", "origin": f"http://localhost:{port}"}):
            websocket.create_connection(url, subprotocols=ours, timeout=10, **fine).close()

    def test_control_from_other_machines_needs_the_token(self):
        run = self.start("--live-host", "0.0.0.0")
        self.assertRegex(run.url, r"^http://0\.0\.0\.0:\d+/\?token=[0-9a-f]{32}$")
        for url, may in ((run.socket_url(), True), (run.socket_url().split("?")[0], False),
                         (run.socket_url()[:-1] + "x", False), (run.socket_url(), True)):
            viewer = viewing.Viewer(url, STATUS)
            viewer.until(lambda viewer=viewer: STATUS in viewer.messages)
            viewer.set("run.pause", True)
            viewer.until(lambda viewer=viewer: viewer.statuses)
            refusal = viewer.statuses[0]["message"]
            self.assertTrue("'run.pause'" in refusal and ("address" in refusal) == (not may), refusal)
            viewer.set("run.stop", True)  # everybody may stop a robot
            viewer.until(lambda viewer=viewer: viewer.parameters.get("run.stop"))
            viewer.set("run.stop", False)
            viewer.until(lambda viewer=viewer: not viewer.parameters["run.stop"] or len(viewer.statuses) == 2)
            self.assertEqual(viewer.parameters["run.stop"], not may)
            viewer.socket.close()

    def test_what_is_not_the_protocol(self):
        run = self.start()
        viewer = viewing.Viewer(run.socket_url(), STATUS)
        for text in ("", "{", "[]", "7", '"x"', "{}", '{"op": 5}', '{"op": "subscribe"}',
                     '{"op": "subscribe", "subscriptions": [{"id": -1, "channelId": "x"}]}',
                     '{"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 100000}]}',
                     '{"op": "setParameters", "parameters": [{"name": "run.stop"}]}',
                     '{"op": "unsubscribe", "subscriptionIds": {"a": []}}', "[" * 50_000):
            viewer.socket.send(text)
        viewer.socket.send_binary(b"\xff" * 1000)
        viewer.until(lambda: len(viewer.statuses) >= 12)
        self.still_serves(run)

    def test_a_frame_of_100_mb_ends_the_connection(self):
        run = self.start()
        server, = run.servers()
        viewer = viewing.Viewer(run.socket_url(), STATUS)
        with self.assertRaises((websocket.WebSocketException, OSError)):
            viewer.socket.send("x" * FRAME)
            viewer.until(lambda: False, 10)
        resident = int(pathlib.Path(f"/proc/{server}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
        self.assertLess(resident, FRAME)
        self.still_serves(run)

    def test_connections_without_end_and_without_requests(self):
        run = self.start()
        address = ("127.0.0.1", int(run.url.rstrip("/").rsplit(":", 1)[1]))
        sockets = []
        for i in range(1000):
            connection = socket.socket()
            self.addCleanup(connection.close)
            connection.setblocking(False)
            connection.connect_ex(address)
            sockets.append(connection)
            if i % 2:
                try:
                    connection.send(b"GET / HTTP/1.1\r\nHost: ")  # and nothing more
                except OSError:
                    pass
        time.sleep(0.5)
        # Those that ask nothing are closed after a while, though they stay.
        end = time.monotonic() + 60
        while True:
            try:
                self.still_serves(run)
                break
            except (AssertionError, OSError, websocket.WebSocketException):
                assert time.monotonic() < end
                time.sleep(0.5)
        for connection in sockets:
            connection.close()
        code, printed = run.interrupt()
        self.assertEqual(code, 130, printed)

    def test_a_viewer_that_asks_and_does_not_read_is_closed(self):
        run = self.start("--set", "encoder.rate_max=5000 Hz")
        server, = run.servers()
        lazy = viewing.Viewer(run.socket_url())
        lazy.until(lambda: "/encoder/out" in lazy.messages)
        try:
            for _ in range(20_000):  # each is answered, and no answer is read
                lazy.send(op="getParameters", parameterNames=[], id="x" * 2000)
            lazy.until_closed()
        except (websocket.WebSocketException, OSError):
            pass  # closed before all was sent
        status = pathlib.Path(f"/proc/{server}/status").read_text()
        peak, = re.findall(r"VmHWM:\s*(\d+) kB", status)
        self.assertLess(int(peak) * 1024, FRAME)
        self.still_serves(run)

    def test_a_run_goes_on_without_its_server(self):
        run = viewing.Run(self.folder / "run", "--sync", "realtime", "--duration", "3")
        self.addCleanup(run.__exit__)
        server, = run.servers()
        self.still_serves(run)
        os.kill(server, signal.SIGKILL)
        code, printed = run.end()
        self.assertEqual(code, 0, printed)
        self.assertIn("finished: 3.0 of 3 s", printed)

    def test_a_paused_run_goes_on_without_its_server(self):
        run = viewing.Run(self.folder / "run", "--duration", "20")
        self.addCleanup(run.__exit__)
        server, = run.servers()
        viewer = viewing.Viewer(run.socket_url(), STATUS)
        viewer.until(lambda: STATUS in viewer.messages)
        viewer.set("run.pause", True)
        viewer.until(lambda: viewer.status()["paused"])
        os.kill(server, signal.SIGKILL)
        code, printed = run.end()
        self.assertEqual(code, 0, printed)

    def test_nothing_is_left_of_a_run_that_is_killed(self):
        run = self.start()
        server, = run.servers()
        words = pathlib.Path(f"/proc/{server}/cmdline").read_text().split("\0")
        feeds = pathlib.Path(next(word for word in words if word.startswith("--feeds=")).removeprefix("--feeds="))
        self.still_serves(run)
        run.process.kill()
        run.process.wait()
        end = time.monotonic() + 10
        while (run.servers() or feeds.exists()) and time.monotonic() < end:
            time.sleep(0.05)
        self.assertEqual((run.servers(), feeds.exists()), ([], False))


if __name__ == "__main__":
    unittest.main()
