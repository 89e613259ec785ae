"""Requests of pages of other sites, of other machines, and of programs that mean no good; and a server that is
killed."""

import contextlib
import os
import pathlib
import re
import signal
import socket
import time
import unittest
import urllib.error
import urllib.request

import attack
import viewing
import websocket

STATUS = "/spikeloop/status"
FRAME = 100_000_000


class Hostile(viewing.FolderCase):
    def start(self, *arguments):
        run = viewing.Run(self.folder / "run", "--sync", "realtime", "--duration", "600", *arguments)
        self.addCleanup(run.__exit__)
        return run

    def refused(self, status, url, **options):
        """Asserts that the server refuses with this status and a sentence."""
        with self.assertRaises(websocket.WebSocketBadStatusException, msg=options) as failure:
            websocket.create_connection(url, timeout=10, **options)
        self.assertEqual(failure.exception.status_code, status)

    def sent(self, run, *pieces):
        """Sends the bytes; returns the answer of the server until it closes the connection."""
        with socket.create_connection(run.address(), timeout=10) as connection:
            answer = b""
            for piece in pieces:
                connection.sendall(piece)
            with contextlib.suppress(ConnectionError):
                while received := connection.recv(4096):
                    answer += received
        return answer

    def still_serves(self, run):
        viewer = viewing.Viewer(run.socket_url(), STATUS)
        viewer.until(lambda: STATUS in viewer.messages)
        viewer.socket.close()

    def test_other_sites_are_refused(self):
        run = self.start()
        url, ours = run.socket_url().split("?")[0], [viewing.PROTOCOL]
        port = run.address()[1]
        self.refused(403, url, subprotocols=ours, origin="http://evil.example")
        self.refused(403, url, subprotocols=ours, origin="null")
        self.refused(403, url, subprotocols=ours, origin="file://")  # without the token
        self.refused(403, url, subprotocols=ours, origin=f"http://127.0.0.1:{port + 1}")
        self.refused(403, url, subprotocols=ours, host=f"evil.example:{port}", suppress_origin=True)
        self.refused(403, url, subprotocols=ours, host=f"evil.example:{port}", origin=f"http://evil.example:{port}")
        self.refused(400, url)
        self.refused(400, url, subprotocols=["other.protocol"])
        request = urllib.request.Request(run.site() + "run/resolved.json", headers={"Host": f"evil.example:{port}"})
        with self.assertRaises(urllib.error.HTTPError) as failure:
            urllib.request.urlopen(request, timeout=10)
        self.assertEqual(failure.exception.code, 403)
        self.assertEqual(failure.exception.read().decode(),
                         f"host 'evil.example:{port}' is not a name of this machine; open the printed address\n")
        for fine in ({"origin": f"http://127.0.0.1:{port}"}, {"suppress_origin": True},
                     {"host": f"localhost:{port}", "origin": f"http://localhost:{port}"}):
            websocket.create_connection(url, subprotocols=ours, timeout=10, **fine).close()
        for other in "file://", "null", "https://app.foxglove.dev":
            websocket.create_connection(run.socket_url(), subprotocols=ours, timeout=10, origin=other).close()
        _, printed = run.interrupt()
        self.assertIn("spikeloop-live: 127.0.0.1 refused with 403: origin 'http://evil.example'", printed)

    def test_upgrade_to_another_protocol_is_ignored(self):
        run = self.start()
        request = urllib.request.Request(run.site(), headers={"Upgrade": "h2c"})  # curl --http2
        with urllib.request.urlopen(request, timeout=10) as response:
            self.assertEqual(response.status, 200)

    def test_what_is_not_http(self):
        run = self.start()
        for request in (b"x\r\n\r\n", b"GET / HTTP/1.0\r\n\r\n", b"\0" * 9000,
                        b"POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1\r\n\r\n"):
            self.assertTrue(self.sent(run, request).startswith(b"HTTP/1.1 400 "), request)
        self.still_serves(run)

    def test_frames_that_no_client_may_send(self):
        run = self.start()
        upgrade = attack.UPGRADE.format("localhost").encode()
        for frame, code in ((b"\x81\x02{}", 1002), (attack.header(2, 3) + b"{}", 1002), (attack.header(attack.FRAME), 1009),
                            (attack.header(2, 0) + b"{}", 1002)):
            self.assertEqual(self.sent(run, upgrade, frame)[-4:], b"\x88\x02" + code.to_bytes(2, "big"), frame)
        self.still_serves(run)

    def test_control_needs_the_token(self):
        for host in ("127.0.0.1", "0.0.0.0"):
            run = self.start("--live-host", host)
            self.assertRegex(run.url, rf"^http://{re.escape(host)}:\d+/\?token=[0-9a-f]{{32}}$")
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
            run.interrupt()

    def test_what_is_not_the_protocol(self):
        run = self.start()
        viewer = viewing.Viewer(run.socket_url(), STATUS)
        for text in ("", "{", "[]", "7", '"x"', "{}", '{"op": 5}', '{"op": "subscribe"}',
                     '{"op": "subscribe", "subscriptions": [{"id": -1, "channelId": "x"}]}',
                     '{"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 100000}]}',
                     '{"op": "setParameters", "parameters": [{"name": "run.stop"}]}',
                     '{"op": "unsubscribe", "subscriptionIds": {"a": []}}', "[" * 16_000):
            viewer.socket.send(text)
        viewer.socket.send_binary(b"\xff" * 1000)
        viewer.until(lambda: len(viewer.statuses) >= 12)
        self.still_serves(run)

    def test_a_frame_of_100_mb_ends_the_connection(self):
        run = self.start()
        server, = run.servers()
        viewer = viewing.Viewer(run.socket_url(), STATUS)
        try:
            viewer.socket.send("x" * FRAME)
            viewer.until_closed()
        except websocket.WebSocketTimeoutException:
            self.fail("the server keeps the connection")
        except (websocket.WebSocketException, OSError):
            pass  # closed while the frame was sent
        resident = int(pathlib.Path(f"/proc/{server}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
        self.assertLess(resident, FRAME)
        self.still_serves(run)

    def test_silent_connections_lock_nobody_out(self):
        run = self.start()
        sockets = []
        for i in range(1000):
            connection = socket.socket()
            self.addCleanup(connection.close)
            connection.setblocking(False)
            connection.connect_ex(run.address())
            sockets.append(connection)
            if i % 2:
                try:
                    connection.send(b"GET / HTTP/1.1\r\nHost: ")  # and nothing more
                except OSError:
                    pass
        self.still_serves(run)
        code, printed = run.interrupt()
        self.assertEqual(code, 130, printed)

    def test_viewers_without_the_token_leave_room(self):
        run = self.start()
        url = run.socket_url().split("?")[0]
        viewers = [websocket.create_connection(url, subprotocols=[viewing.PROTOCOL], timeout=10) for _ in range(32)]
        self.refused(503, url, subprotocols=[viewing.PROTOCOL])
        self.still_serves(run)  # with the token
        for viewer in viewers:
            viewer.close()

    def test_one_subscription_per_channel(self):
        run = self.start()
        viewer = viewing.Viewer(run.socket_url(), STATUS)
        viewer.until(lambda: STATUS in viewer.messages)
        channel = next(id for id, each in viewer.channels.items() if each["topic"] == STATUS)
        viewer.send(op="subscribe", subscriptions=[{"id": 9000 + i, "channelId": channel} for i in range(300)])
        viewer.until(lambda: viewer.statuses)
        self.assertEqual([status["message"] for status in viewer.statuses],
                         [f"subscription {1000 + channel} to channel {channel} exists; end it before another one"])
        viewer.send(op="unsubscribe", subscriptionIds=[1000 + channel])
        viewer.send(op="subscribe", subscriptions=[{"id": 1000 + channel, "channelId": channel}])
        seen = len(viewer.messages[STATUS])
        viewer.until(lambda: len(viewer.messages[STATUS]) > seen + 3)
        self.assertEqual(len(viewer.statuses), 1)

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

    def test_a_viewer_that_reads_nothing_is_disconnected(self):
        run = self.start("--set", "encoder.rate_max=5000 Hz")
        lazy = viewing.Viewer(run.socket_url(), sockopt=[(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)])
        lazy.until(lambda: "/encoder/out" in lazy.messages)
        while "the viewer has read nothing for 5 s" not in run.process.stderr.readline():
            self.assertIsNone(run.process.poll())
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
