"""MCAP files, read by https://mcap.dev/spec alone: nothing of Spikeloop's reader is in here."""

import struct
import zlib

import genpy.message
import zstandard

MAGIC = b"\x89MCAP0\r\n"
SCHEMA, CHANNEL, MESSAGE, CHUNK, INDEX, CHUNK_INDEX, ATTACHMENT, ATTACHMENT_INDEX, STATISTICS = 3, 4, 5, 6, 7, 8, 9, 10, 11
DATA_END, FOOTER = 15, 2


def fields(content, form):
    """The fields of a record: s is a text, m a map of texts, d data behind 8 bytes, a an array; others as in
    struct. What is left is the last one."""
    found, at = [], 0
    for letter in form:
        size = struct.calcsize("<Q" if letter == "d" else "<I" if letter in "sma" else "<" + letter)
        value, = struct.unpack_from("<Q" if letter == "d" else "<I" if letter in "sma" else "<" + letter, content, at)
        at += size
        if letter in "smad":
            value, at = content[at:at + value], at + value
        if letter == "s":
            value = value.decode()
        if letter == "m":
            texts, place = [], 0
            while place < len(value):
                size, = struct.unpack_from("<I", value, place)
                texts.append(value[place + 4:place + 4 + size].decode())
                place += 4 + size
            value = dict(zip(texts[::2], texts[1::2]))
        found.append(value)
    return [*found, content[at:]]


def records(data, at=0):
    """(place, opcode, content), up to what is not a whole record."""
    while at + 9 <= len(data):
        op, size = struct.unpack_from("<BQ", data, at)
        if at + 9 + size > len(data):
            return
        yield at, op, data[at + 9:at + 9 + size]
        at += 9 + size


class McapFile:
    """All of a file; what its indexes and its summary say is checked when it was ended."""

    def __init__(self, path):
        self.data = path.read_bytes()
        assert self.data.startswith(MAGIC)
        self.schemas, self.channels, self.messages, self.attachments, self.chunks = {}, {}, [], {}, []
        self.ended = False
        for at, op, content in records(self.data, len(MAGIC)):
            if op == CHUNK:
                self._chunk(at, content)
            elif op == INDEX:
                self._index(content)
            elif op == ATTACHMENT:
                _, _, name, media, data, _ = fields(content, "QQssd")
                assert struct.unpack("<I", content[-4:])[0] == zlib.crc32(content[:-4])
                self.attachments[name] = (media, data)
            elif op == DATA_END:
                self._summary(at + 9 + len(content))
                self.ended = True
                break

    def _chunk(self, at, content):
        first, last, size, checksum, compression, packed, _ = fields(content, "QQQIsd")
        assert compression == "zstd"
        chunk = zstandard.decompress(packed, max_output_size=size)
        assert len(chunk) == size and zlib.crc32(chunk) == checksum
        times = []
        for place, op, inner in records(chunk):
            if op == SCHEMA:
                number, *schema, _ = fields(inner, "Hsss")
                assert number not in self.schemas
                self.schemas[number] = schema
            elif op == CHANNEL:
                number, *channel, _ = fields(inner, "HHssm")
                assert number not in self.channels and channel[0] in self.schemas
                self.channels[number] = channel
            else:
                assert op == MESSAGE
                number, _, time, sent, data = fields(inner, "HIQQ")
                assert sent == time
                self.messages.append((number, time, data))
                times.append((number, time, place))
        assert (first, last) == (min(time for _, time, _ in times), max(time for _, time, _ in times))
        self.chunks.append((at, first, last, len(packed), size))
        self.indexed = times

    def _index(self, content):
        number, entries, _ = fields(content, "Ha")
        pairs = [struct.unpack_from("<QQ", entries, i) for i in range(0, len(entries), 16)]
        assert pairs == [(time, place) for channel, time, place in self.indexed if channel == number]

    def _summary(self, begin):
        footer = len(self.data) - len(MAGIC) - 29
        assert self.data.endswith(MAGIC) and self.data[footer] == FOOTER
        start, groups, checksum, _ = fields(self.data[footer + 9:footer + 29], "QQI")
        assert start == begin and checksum == zlib.crc32(self.data[start:footer + 25])
        told = [(op, content) for at, op, content in records(self.data, start) if at < groups]
        assert [op for op, _ in told] == sorted((op for op, _ in told),
                                                key=[SCHEMA, CHANNEL, STATISTICS, CHUNK_INDEX, ATTACHMENT_INDEX].index)
        assert {fields(c, "Hsss")[0]: fields(c, "Hsss")[1:4] for op, c in told if op == SCHEMA} == self.schemas
        assert {fields(c, "HHssm")[0]: fields(c, "HHssm")[1:5] for op, c in told if op == CHANNEL} == self.channels
        indexes = [fields(c, "QQQQaQsQQ") for op, c in told if op == CHUNK_INDEX]
        assert [(i[2], i[0], i[1], i[7], i[8]) for i in indexes] == self.chunks
        statistics = [fields(c, "QHIIIIQQa") for op, c in told if op == STATISTICS]
        (count, schemas, channels, attachments, _, chunks, first, last, counts, _), = statistics
        assert (count, schemas, channels, attachments, chunks) == (
            len(self.messages), len(self.schemas), len(self.channels), len(self.attachments), len(self.chunks))
        assert sum(struct.unpack_from("<HQ", counts, i)[1] for i in range(0, len(counts), 10)) == count
        times = [time for _, time, _ in self.messages] or [0]
        assert (first, last) == (min(times), max(times))

    def type_of(self, topic):
        """(type, encoding of messages, encoding of the definition, definition)"""
        schema, encoding = next((schema, encoding) for schema, name, encoding, _ in self.channels.values()
                                if name == topic)
        name, of_definition, definition = self.schemas[schema]
        return name, encoding, of_definition, definition

    def nodes_of(self, topic):
        return {metadata["spikeloop_node"] for _, name, _, metadata in self.channels.values() if name == topic}

    def raw(self, topic):
        return [(time, data) for number, time, data in self.messages if self.channels[number][1] == topic]

    def of(self, topic):
        """(time in ns, message of ROS 1)"""
        if not any(name == topic for _, name, _, _ in self.channels.values()):
            return []
        kind = genpy.message.get_message_class(self.type_of(topic)[0])
        return [(time, kind().deserialize(data)) for time, data in self.raw(topic)]
