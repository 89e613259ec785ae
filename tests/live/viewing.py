"""A run with a live view, and a viewer that knows nothing but the protocol: Debian's python3-websocket."""

import contextlib
import json
import pathlib
import re
import signal
import struct
import subprocess
import time

import websocket

from runs import programs
from folder import FolderCase  # noqa: F401  (tests/support/folder.py; runs.py adds its folder to the path)

EXAMPLE = pathlib.Path(__file__).parents[2] / "examples/01_braitenberg/braitenberg.yaml"
PROTOCOL = "foxglove.websocket.v1"


class Run:
    """spikeloop run --live, until it ends by itself or the block does."""

    def __init__(self, folder, *arguments, experiment=EXAMPLE):
        self.folder = folder
        self.start([programs() / "spikeloop", "run", experiment, "--out", folder, "--force", "--live",
                    "--live-port", "0", *arguments])

    def start(self, command):
        # As in a terminal: a program in the background of a shell ignores Ctrl-C.
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True,
                                        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
        first = self.process.stderr.readline()
        found = re.fullmatch(r"live: (http://\S+)\n", first)
        assert found, first + self.process.stderr.read()
        self.url = found[1]

    def socket_url(self):
        return self.url.replace("http:", "ws:").replace("0.0.0.0", "127.0.0.1")

    def site(self):
        """The address without the token, for programs on this machine."""
        return self.url.split("?")[0].replace("0.0.0.0", "127.0.0.1")

    def address(self):
        return "127.0.0.1", int(self.site().rstrip("/").rsplit(":", 1)[1])

    def end(self):
        """Its exit code, and what it printed."""
        printed = self.process.stderr.read()
        return self.process.wait(60), printed

    def interrupt(self):
        self.process.send_signal(signal.SIGINT)
        return self.end()

    def servers(self):
        """Process ids of its spikeloop-live."""
        found = []
        for status in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            with contextlib.suppress(OSError):
                words = status.read_bytes().decode().split("\0")
                if words[0].endswith("/spikeloop-live") and f"--run={self.folder}" in words:
                    found.append(int(status.parent.name))
        return found

    def __enter__(self):
        return self

    def __exit__(self, *failure):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait()
        self.process.stderr.close()


class Viewer:
    """Subscribes to all channels whose topics it is told, to all without any."""

    def __init__(self, url, *topics, **options):
        self.socket = websocket.create_connection(url, subprotocols=[PROTOCOL], timeout=30, **options)
        self.topics = topics
        self.channels = {}
        self.messages = {}  # by topic: [(time in ns, bytes)]
        self.parameters = {}
        self.statuses = []
        self.info = None
        self.times = []

    def read(self):
        """One frame; False: the server has closed."""
        try:
            opcode, frame = self.socket.recv_data()
        except (websocket.WebSocketConnectionClosedException, ConnectionError):
            return False
        if opcode == websocket.ABNF.OPCODE_CLOSE:
            return False
        if opcode == websocket.ABNF.OPCODE_BINARY:
            self._take_binary(frame)
        else:
            self._take(json.loads(frame))
        return True

    def _take_binary(self, frame):
        if frame[0] == 2:
            self.times.append(struct.unpack("<Q", frame[1:])[0])
            return
        assert frame[0] == 1
        subscription, stamp = struct.unpack_from("<IQ", frame, 1)
        topic = self.channels[subscription - 1000]["topic"]
        self.messages.setdefault(topic, []).append((stamp, frame[13:]))

    def _take(self, message):
        kind = message["op"]
        if kind == "serverInfo":
            self.info = message
        elif kind == "advertise":
            wanted = [c for c in message["channels"] if not self.topics or c["topic"] in self.topics]
            self.channels.update({channel["id"]: channel for channel in message["channels"]})
            self.send(op="subscribe", subscriptions=[{"id": 1000 + c["id"], "channelId": c["id"]} for c in wanted])
        elif kind == "parameterValues":
            self.parameters = {p["name"]: p["value"] for p in message["parameters"]}
        else:
            self.statuses.append(message)

    def send(self, **message):
        self.socket.send(json.dumps(message))

    def set(self, name, value):
        self.send(op="setParameters", parameters=[{"name": name, "value": value}], id="set")

    def until(self, condition, seconds=60):
        end = time.monotonic() + seconds
        while not condition():
            assert time.monotonic() < end, f"not within {seconds} s; statuses: {self.statuses}"
            assert self.read(), f"the server has closed; statuses: {self.statuses}"

    def until_closed(self):
        while self.read():
            pass

    def status(self):
        """The newest message of /spikeloop/status."""
        return json.loads(self.messages["/spikeloop/status"][-1][1])


def watched(folder, topics, speed, complete, *arguments, experiment=EXAMPLE):
    """What a viewer receives of a run, which is at this speed when all of the topics have come. The server ends with
    the run: the last messages can be lost. Then complete(viewer) is false, and the run is repeated."""
    for _ in range(20):
        with Run(folder, *arguments, experiment=experiment) as job:
            viewer = Viewer(job.socket_url())
            viewer.until(lambda viewer=viewer: topics <= set(viewer.messages))
            viewer.set("run.speed", speed)
            viewer.until_closed()
            code, printed = job.end()
        assert code == 0, printed
        if complete(viewer):
            break
    return viewer


def spikes_of(messages):
    """Times in ns and channels, by CDR as OMG's "DDS Interoperability Wire Protocol" 2.3, chapter 10, has it."""
    times, channels = [], []
    for _, message in messages:
        assert message[:4] == b"\0\1\0\0"
        count, = struct.unpack_from("<I", message, 4)
        times += struct.unpack_from(f"<{count}q", message, 12)  # aligned to 8 behind the first four bytes
        again, = struct.unpack_from("<I", message, 12 + 8 * count)
        assert again == count and len(message) == 16 + 12 * count
        channels += struct.unpack_from(f"<{count}I", message, 16 + 8 * count)
    return times, channels


def signal_of(message):
    count, = struct.unpack_from("<I", message, 4)
    assert len(message) == 12 + 8 * count
    return list(struct.unpack_from(f"<{count}d", message, 12))

