"""Writes recordings of ROS 2 as other programs do: MCAP and SQLite, by their specifications alone."""

import pathlib
import re
import sqlite3
import struct
import zlib

MAGIC = b"\x89MCAP0\r\n"
MESSAGES = pathlib.Path(__file__).parents[2] / "robots/messages/msg"
NUMBERS = {"bool", "byte", "char", "float32", "float64", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64",
           "uint64", "string"}


def definition(name):
    return next(path for part in ("ros2", "both") if (path := MESSAGES / part / f"{name}.msg").exists()).read_text()


def full_definition(name):
    """As rosbag2 writes it: each part behind a line of 80 '='."""
    done, waiting, text = [], [name], ""
    while waiting:
        one = waiting.pop(0)
        if one in done:
            continue
        done.append(one)
        text += ("" if one == name else "=" * 80 + f"\nMSG: {one}\n") + definition(one)
        for line in definition(one).splitlines():
            kind = re.match(r"\s*([A-Za-z][\w/]*)", line.split("#")[0])
            if kind and kind[1] not in NUMBERS:
                waiting.append(kind[1] if "/" in kind[1] else f"{one.split('/')[0]}/{kind[1]}")
    return text


class Cdr:
    """Plain CDR in little endian."""

    def __init__(self):
        self.body = b""

    def add(self, form, *values):
        size = struct.calcsize(form)
        for value in values:
            self.body += b"\0" * (-len(self.body) % size) + struct.pack("<" + form, value)
        return self

    def text(self, value):
        self.add("I", len(value) + 1)
        self.body += value.encode() + b"\0"
        return self

    def array(self, form, values):
        return self.add("I", len(values)).add(form, *values)

    def bytes(self):
        return b"\0\1\0\0" + self.body


def scan(distance=2.0, beams=12, ranges=None, limits=(0.1, 10)):
    """sensor_msgs/LaserScan from 0.1 to 10 m. All beams are at `distance` unless `ranges` are given."""
    return Cdr().add("i", 1).add("I", 0).text("laser").add("f", -1, 1, 0.1, 0, 0.05, *limits) \
        .array("f", [distance] * beams if ranges is None else ranges).array("f", []).bytes()


def image(encoding, width, height, data):
    """sensor_msgs/Image without padding."""
    return Cdr().add("i", 1).add("I", 0).text("camera").add("I", height, width).text(encoding).add("B", 0) \
        .add("I", len(data) // max(height, 1)).array("B", data).bytes()


def joints(names, positions):
    """sensor_msgs/JointState without velocities and efforts."""
    message = Cdr().add("i", 1).add("I", 0).text("").add("I", len(names))
    for name in names:
        message.text(name)
    return message.array("d", positions).array("d", []).array("d", []).bytes()


def humble_range(distance=1.5):
    """sensor_msgs/Range without `variance`."""
    return Cdr().add("i", 1).add("I", 0).text("sonar").add("B", 0).add("f", 0.1, 0.2, 4.0, distance).bytes()


def text(value):
    value = value.encode() if isinstance(value, str) else value
    return struct.pack("<I", len(value)) + value


def record(op, content):
    return struct.pack("<BQ", op, len(content)) + content


def channel(topic, kind, schema=None, encoding="ros2msg", hash=""):
    """The records of a schema and of a channel."""
    package, name = kind.split("/")
    metadata = text("topic_type_hash") + text(hash) if hash else b""
    return record(3, struct.pack("<H", 1) + text(f"{package}/msg/{name}") + text(encoding) +
                  text(full_definition(kind) if schema is None else schema)) + \
        record(4, struct.pack("<HH", 1, 1) + text(topic) + text("cdr") + text(metadata))


def message(time, data):
    return record(5, struct.pack("<HIQQ", 1, 0, time, time) + data)


def chunk(records, compression, packed):
    return record(6, struct.pack("<QQQI", 0, 0, len(records), zlib.crc32(records)) + text(compression) +
                  struct.pack("<Q", len(packed)) + packed)


END = record(15, struct.pack("<I", 0)) + record(2, struct.pack("<QQI", 0, 0, 0)) + MAGIC


def mcap(path, messages, topic="/scan", kind="sensor_msgs/LaserScan", compression="", pack=None, end=END, **schema):
    """messages: (time in ns, bytes). pack: compresses the only chunk; None: there are no chunks."""
    records = channel(topic, kind, **schema) + b"".join(message(*one) for one in messages)
    body = chunk(records, compression, pack(records)) if pack else records
    path.write_bytes(MAGIC + record(1, text("ros2") + text("test")) + body + end)
    return path


# Columns as the distributions create them (rosbag2_storage_sqlite3, sqlite_storage.cpp).
TOPICS = {
    "eloquent": "id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL",
    "foxy": "id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL, "
            "offered_qos_profiles TEXT NOT NULL",
    "jazzy": "id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL, "
             "offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL",
}
DEFINITIONS = ("id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL, "
               "encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL")


def db3(path, messages, topic="/scan", kind="sensor_msgs/LaserScan", distribution="jazzy", hash="", close=True):
    """As `ros2 bag record` of a distribution writes it. Returns the connection if it is not closed."""
    kind = kind.replace("/", "/msg/")
    file = sqlite3.connect(path)
    file.execute("PRAGMA journal_mode=WAL")
    file.execute(f"CREATE TABLE topics({TOPICS[distribution]})")
    file.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
                 "timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
    file.execute("CREATE INDEX timestamp_idx ON messages (timestamp ASC)")
    columns = {"eloquent": (), "foxy": ("",), "jazzy": ("", hash)}[distribution]
    row = (1, topic, kind, "cdr", *columns)
    file.execute(f"INSERT INTO topics VALUES ({','.join('?' * len(row))})", row)
    if distribution == "jazzy":
        file.execute("CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL)")
        file.execute("INSERT INTO schema VALUES (4, 'jazzy')")
        file.execute(f"CREATE TABLE message_definitions({DEFINITIONS})")
        file.execute("INSERT INTO message_definitions VALUES (1, ?, 'ros2msg', ?, ?)",
                     (kind, full_definition(kind.replace("/msg/", "/")), hash))
    file.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES (1, ?, ?)", messages)
    file.commit()
    if not close:
        return file
    file.close()
    return path


def metadata(folder, files, mode="", packed=""):
    """metadata.yaml, with what a reader needs of it."""
    (folder / "metadata.yaml").write_text(
        "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n  relative_file_paths:\n" +
        "".join(f"    - {file}\n" for file in files) +
        f'  compression_format: "{packed}"\n  compression_mode: "{mode}"\n')
