#!/usr/bin/python3
"""Whatever other programs of the user send to the guard's socket, the guard runs on, disconnects them, and stops the
robot of the adapter that it watches when that one dies.
"""

import array
import contextlib
import os
import pathlib
import random
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

sys.path.append(str(pathlib.Path(__file__).parents[1] / "fused"))
import ros  # noqa: E402

PROGRAMS = pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"])
SILENT = 200  # more than the guard takes at once


def packet(kind, **fields):
    """Encodes a packet like music/guard/src/protocol.cpp."""
    texts = [kind.encode()]
    for key, value in fields.items():
        texts += [key.encode(), value if isinstance(value, bytes) else str(value).encode()]
    return b"".join(struct.pack("=I", len(text)) + text for text in texts)


def connect(path):
    client = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    client.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 20)
    client.settimeout(30)
    client.connect(path)
    return client


def hello(topic):
    return packet("hello", protocol=5, process="wheels", topic=topic, message_type="geometry_msgs/Twist", ros=2,
                  watchdog=int(5e9), stop=b"\0\1\0\0" + bytes(48),
                  **{"place.ROS_DOMAIN_ID": os.environ["ROS_DOMAIN_ID"], "place.ROS_LOCALHOST_ONLY": "1"})


class Adapter:
    """A command adapter that sends beats in a background thread."""

    def __init__(self, path, topic):
        self._socket = connect(path)
        self._socket.send(hello(topic))
        assert self._socket.recv(100) == packet("ready")
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._beat)
        self._thread.start()

    def _beat(self):
        while not self._ended.wait(0.02):
            self._socket.send(packet("beat"))  # an error of a closed connection fails the test

    def close(self):
        self._ended.set()
        self._thread.join()
        self._socket.close()

    def is_watched(self):
        return self._thread.is_alive()


def is_disconnected(client):
    """Waits until the guard closes the connection."""
    try:
        while client.recv(1 << 20):
            pass
    except ConnectionError:
        pass
    return True


def send_all(path, packets, then_wait=True):
    with contextlib.closing(connect(path)) as client:
        with contextlib.suppress(ConnectionError):
            for data in packets:
                client.send(data)
        assert not then_wait or is_disconnected(client)


def nested_and_huge(path):
    """CBOR, JSON and lengths that exhaust the stack or the memory of a careless reader."""
    for data in (bytes.fromhex("bbfffffffffffffff0"), b"\x81" * 30000, b"\x81" * 150000, b"[" * 150000,
                 struct.pack("=I", 0xffffffff), struct.pack("=I", 0xffffffff) * 1000, b"\0" * 150000,
                 packet("hello"), packet("hello", protocol="9" * 1000, stop=b"\0" * 100000)):
        send_all(path, [data])


def after_a_hello(path):
    for data in (b"\xff" * 1000, packet("beat", **{"x" * 1000: "y" * 1000}) + b"\1"):
        adapter = Adapter(path, "/other")
        adapter._socket.send(data)
        assert is_disconnected(adapter._socket)
        adapter._ended.set()
        adapter._thread.join()


def impatient_adapter(path):
    """An adapter that closes the connection before the answer introduces itself again, and drives meanwhile."""
    send_all(path, [hello("/impatient")], then_wait=False)


def random_bytes(path, seed):
    draw = random.Random(seed)
    good = packet("hello", protocol=5, process="p", topic="/t", message_type="std_msgs/Bool", ros=2, watchdog=1, stop=b"")
    for _ in range(300):
        data = bytearray(good if draw.random() < 0.5 else draw.randbytes(draw.choice((1, 9, 100, 5000))))
        for _ in range(draw.randrange(1, 5)):
            data[draw.randrange(len(data))] = draw.randrange(256)
        send_all(path, [bytes(data)], then_wait=False)
    send_all(path, [b"\xee"])


def descriptors(path):
    """The guard closes descriptors that a client sends."""
    with contextlib.closing(connect(path)) as client:
        with contextlib.suppress(ConnectionError):
            client.sendmsg([b"\xee"], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array("i", [0] * 50))])
        assert is_disconnected(client)


def floods(path):
    with contextlib.closing(connect(path)) as client:
        end = time.monotonic() + 1
        with contextlib.suppress(ConnectionError):
            while time.monotonic() < end:
                client.send(packet("beat"))
    adapter = Adapter(path, "/flood")
    end = time.monotonic() + 1
    while time.monotonic() < end:
        adapter._socket.send(packet("beat"))
    adapter.close()


def silent_clients(path):
    """Silent clients are disconnected after 2 s; then the guard accepts an adapter."""
    clients = []
    for _ in range(SILENT):
        client = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        client.setblocking(False)
        with contextlib.suppress(BlockingIOError):  # the backlog is full
            client.connect(path)
            clients.append(client)
    assert len(clients) > 64, len(clients)
    begin = time.monotonic()
    while True:
        try:
            adapter = Adapter(path, "/late")
            break
        except (BlockingIOError, AssertionError, socket.timeout):
            assert time.monotonic() - begin < 30
    print(f"an adapter gets in behind {len(clients)} silent clients after {time.monotonic() - begin:.1f} s", flush=True)
    adapter.close()
    for client in clients:
        client.close()


def main():
    with tempfile.TemporaryDirectory() as scratch, ros.domain():
        path, log = f"{scratch}/guard", pathlib.Path(scratch) / "log"
        with open(log, "w", encoding="utf-8") as out, \
                ros.program("sh", "-c", f"exec {PROGRAMS}/spikeloop-guard --socket {path} 2> {log}") as guard:
            del out
            ros.until(lambda: os.path.exists(path), "the socket")
            adapter = Adapter(path, "/cmd_vel")
            for attack in (nested_and_huge, after_a_hello, impatient_adapter, lambda path: random_bytes(path, 1), descriptors, floods,
                           silent_clients):
                attack(path)
                assert guard.poll() is None, f"the guard has ended with {guard.returncode}: {log.read_text()}"
                assert adapter.is_watched(), log.read_text()
                assert "the robot on /cmd_vel is stopped" not in log.read_text(), log.read_text()
            adapter.close()
            ros.until(lambda: "the robot on /cmd_vel is stopped: its command adapter 'wheels' has died" in
                      log.read_text(), "a stop")
            assert "/impatient" not in log.read_text(), log.read_text()
            assert len(list(pathlib.Path(f"/proc/{guard.pid}/fd").iterdir())) < 40, "descriptors are left"


if __name__ == "__main__":
    main()
