"""A camera that sees random things, and what its messages are, byte by byte: nothing here is
Spikeloop's."""

import random
import struct

WIDTH, HEIGHT = 8, 6
PACKET = "event_camera_msgs/EventPacket"
ARRAY = "dvs_msgs/EventArray"


def film(seed, packets, period_us=10_000, each=25, start_us=5_000_000):
    """Lists of (time in us, x, y, brighter), one for each message, in order; no two at one time."""
    chance = random.Random(seed)
    messages = []
    for packet in range(packets):
        begin = start_us + packet * period_us
        step = period_us // each
        messages.append([(begin + i * step + chance.randrange(step - 1), chance.randrange(WIDTH),
                          chance.randrange(HEIGHT), chance.random() < 0.5) for i in range(each)])
    return messages


class Evt3:
    """Words of 16 bits; what does not change is not said again."""

    name = "evt3"

    def __init__(self):
        self.said = {}

    def _say(self, kind, value):
        if self.said.get(kind) == value:
            return b""
        self.said[kind] = value
        return struct.pack("<H", kind << 12 | value)

    def encode(self, events):
        data = b""
        for us, x, y, on in events:
            if self.said.get(8) != us >> 12 & 0xfff:
                self.said.pop(6, None)
            data += self._say(8, us >> 12 & 0xfff) + self._say(6, us & 0xfff) + self._say(0, y)
            data += struct.pack("<H", 2 << 12 | on << 11 | x)
        return data, 0


class Evt2:
    """Words of 32 bits; the upper part of the time when it changes."""

    name = "evt2"

    def __init__(self):
        self.upper = None

    def encode(self, events):
        data = b""
        for us, x, y, on in events:
            if us >> 6 != self.upper:
                self.upper = us >> 6
                data += struct.pack("<I", 8 << 28 | self.upper & 0xfffffff)
            data += struct.pack("<I", on << 28 | (us & 63) << 22 | x << 11 | y)
        return data, 0


class Mono:
    """64 bits an event, from a time of the message's own."""

    name = "mono"

    def encode(self, events):
        base = 1000 * events[0][0] - 17
        return b"".join(struct.pack("<Q", 1000 * us - base | x << 32 | y << 48 | on << 63)
                        for us, x, y, on in events), base


class Cdr:
    """ROS 2's bytes: every number at a multiple of its size, behind 4 bytes that say so."""

    def __init__(self):
        self.data = b""

    def put(self, format_, *values):
        for letter, value in zip(format_, values):
            self.data += b"\0" * (-len(self.data) % struct.calcsize(letter))
            self.data += struct.pack("<" + letter, value)

    def text(self, text):
        self.put("I", len(text) + 1)
        self.data += text.encode() + b"\0"

    def header(self, _sequence):
        self.put("iI", 12, 34)
        self.text("camera")

    def bytes(self):
        return b"\0\1\0\0" + self.data


class Ros1:
    """ROS 1's bytes: number behind number."""

    def __init__(self):
        self.data = b""

    def put(self, format_, *values):
        self.data += struct.pack("<" + format_, *values)

    def text(self, text):
        self.put("I", len(text))
        self.data += text.encode()

    def header(self, sequence):
        self.put("III", sequence, 12, 34)
        self.text("camera")

    def bytes(self):
        return self.data


def packets(messages, encoding, ros):
    """EventPacket messages."""
    result = []
    for sequence, events in enumerate(messages):
        data, base = encoding.encode(events)
        out = Cdr() if ros == "2" else Ros1()
        out.header(sequence)
        out.put("IIQQ", HEIGHT, WIDTH, sequence, base)
        out.text(encoding.name)
        out.put("?I", False, len(data))
        out.data += data
        result.append(out.bytes())
    return result


def arrays(messages, ros):
    """EventArray messages."""
    result = []
    for sequence, events in enumerate(messages):
        out = Cdr() if ros == "2" else Ros1()
        out.header(sequence)
        out.put("III", HEIGHT, WIDTH, len(events))
        for us, x, y, on in events:
            out.put("HHII?", x, y, us // 1_000_000, us % 1_000_000 * 1000, on)
        result.append(out.bytes())
    return result


def whole(x, y, _on):
    """The channel of a pixel: a key of its own has another rule."""
    return y * WIDTH + x


def split(x, y, on):
    return (0 if on else WIDTH * HEIGHT) + y * WIDTH + x


def part(x, y, on):
    """polarity: on, roi: [2, 1, 5, 4], downsample: 2; none for what is left out."""
    if not on or not 2 <= x < 7 or not 1 <= y < 5:
        return None
    return (y - 1) // 2 * 3 + (x - 2) // 2


def spikes(messages, channel_of):
    """(Time of the sensor in ns, channel) of what is sent."""
    return [(1000 * us, channel_of(x, y, on)) for events in messages for us, x, y, on in events
            if channel_of(x, y, on) is not None]
