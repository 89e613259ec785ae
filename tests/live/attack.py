"""Clients that mean no good: `attack.py KIND ADDRESS COUNT`. Prints "ready" when the first round is over, and goes on
until standard input ends.

  subscribers   COUNT viewers that send 10,000 subscriptions each, and again when they are through, and never read
  connections   COUNT connections, every second one with half a request; those that the server closes are made again
  frames        COUNT viewers that send frames of 100 MB
"""

import json
import pathlib
import selectors
import socket
import struct
import subprocess
import sys
import threading

KINDS = ("subscribers", "connections", "frames")
SUBSCRIPTIONS = 10_000
FRAME = 100_000_000
UPGRADE = ("GET / HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
           "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Protocol: foxglove.websocket.v1\r\n\r\n")


def header(size, opcode=1):
    """Header of a masked frame; the mask is 0."""
    length = bytes([0x80 | size]) if size < 126 else (
        struct.pack(">BH", 0xFE, size) if size < 1 << 16 else struct.pack(">BQ", 0xFF, size))
    return bytes([0x80 | opcode]) + length + bytes(4)


def subscriptions():
    """Valid messages: 400 of them in 10 KB."""
    frames = b""
    for begin in range(0, SUBSCRIPTIONS, 400):
        wanted = [{"id": i + 1, "channelId": 1 + i % 8} for i in range(begin, begin + 400)]
        text = json.dumps({"op": "subscribe", "subscriptions": wanted}, separators=(",", ":")).encode()
        frames += header(len(text)) + text
    return frames


def viewer(address, sent):
    """Sends `sent` again and again, over a new connection when the server closes. It never reads."""
    while True:
        try:
            with socket.create_connection(address) as connection:
                connection.sendall(UPGRADE.format("localhost").encode())
                while True:
                    connection.sendall(sent)
                    STARTED.release()
        except OSError:
            STARTED.release()


def connections(address, count):
    """Keeps so many connections open, or trying."""
    selector, opened = selectors.DefaultSelector(), 0
    while True:
        while len(selector.get_map()) < count:
            connection = socket.socket()
            connection.setblocking(False)
            connection.connect_ex(address)
            opened += 1
            selector.register(connection, selectors.EVENT_READ | (selectors.EVENT_WRITE if opened % 2 else 0))
        STARTED.release()
        for key, events in selector.select(0.01):
            try:
                if events & selectors.EVENT_WRITE:
                    key.fileobj.send(b"GET / HTTP/1.1\r\nHost: ")
                    selector.modify(key.fileobj, selectors.EVENT_READ)
                elif not key.fileobj.recv(1):
                    raise ConnectionError
            except OSError:
                selector.unregister(key.fileobj)
                key.fileobj.close()


STARTED = threading.Semaphore(0)


class Attack:
    """Runs attack.py in a subprocess until the block ends."""

    def __init__(self, kind, url, count):
        address = url.split("/")[2].replace("0.0.0.0", "127.0.0.1")
        self.process = subprocess.Popen([sys.executable, pathlib.Path(__file__), kind, address, str(count)],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def __enter__(self):
        assert self.process.stdout.readline() == "ready\n"
        return self

    def __exit__(self, *failure):
        self.process.communicate()


def main():
    kind, address, count = sys.argv[1], sys.argv[2].split(":"), int(sys.argv[3])
    address = (address[0], int(address[1]))
    rounds = 1 if kind == "connections" else count
    if kind == "connections":
        threading.Thread(target=connections, args=(address, count), daemon=True).start()
    else:
        sent = subscriptions() if kind == "subscribers" else header(FRAME) + b" " * FRAME
        for _ in range(count):
            threading.Thread(target=viewer, args=(address, sent), daemon=True).start()
    for _ in range(rounds):
        STARTED.acquire()
    print("ready", flush=True)
    sys.stdin.read()


if __name__ == "__main__":
    main()
