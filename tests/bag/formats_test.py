#!/usr/bin/python3
"""Recordings in every form in which the programs of ROS 1 and ROS 2 write them give the same values."""

import ctypes
import ctypes.util
import pathlib
import shutil
import sqlite3
import struct
import sys
import tempfile

import numpy as np
import zstandard

import bags
import recording_writer as writer
import rosbag
import runs

SECOND = 10**9
BEGIN = 1_700_000_000 * SECOND
VALUE = 2 * (2.0 - 0.1) / (10 - 0.1) - 1  # docs/nodes.md, of a beam of 2 m


def scans(first=0, count=20, distance=2.0):
    """20 a second."""
    return [(BEGIN + i * SECOND // 20, writer.scan(distance)) for i in range(first, first + count)]


def values_of(scratch, recording, code=0):
    """The value of every message, which all beams have, the ticks of the messages, and what was printed."""
    file = bags.experiment(scratch / "x.yaml", recording)
    _, printed = runs.run(file, scratch / "run", code=code)
    times, rows = runs.recordings.signal(scratch / "run", "scan")
    assert (rows == rows[:, :1]).all()
    return rows[:, 0], times // 1_000_000, printed


def same_as_plain(scratch, recording, warning=""):
    values, ticks, printed = values_of(scratch, recording)
    np.testing.assert_allclose(values, [VALUE] * 20, atol=1e-6, err_msg=str(recording))
    assert list(ticks) == [1 + 50 * i for i in range(20)], (recording, ticks)
    assert printed.count("warning") == (1 if warning else 0), (recording, printed)
    if warning:
        runs.assert_says(printed, warning)


LZ4 = ctypes.CDLL(ctypes.util.find_library("lz4"))
LZ4.LZ4F_compressFrameBound.restype = LZ4.LZ4F_compressFrame.restype = ctypes.c_size_t


def lz4_frame(data, content_size=0, linked=True, checksum=False):
    preferences = (ctypes.c_uint32 * 14)(0, 0 if linked else 1, int(checksum), 0, content_size and len(data))
    room = ctypes.create_string_buffer(LZ4.LZ4F_compressFrameBound(ctypes.c_size_t(len(data)), preferences))
    size = LZ4.LZ4F_compressFrame(room, ctypes.c_size_t(len(room)), data, ctypes.c_size_t(len(data)), preferences)
    return room.raw[:size]


def lz4_block(data):
    room = ctypes.create_string_buffer(LZ4.LZ4_compressBound(len(data)))
    size = LZ4.LZ4_compress_default(data, room, len(data), len(room))
    return room.raw[:size]


def zstd_stream(data):
    """As Rust's and Go's libraries: no content size in the frame."""
    return zstandard.ZstdCompressor(write_content_size=False).compress(data)


def several(pack):
    return lambda data: pack(data[:1000]) + pack(data[1000:1001]) + pack(data[1001:])


PACKERS = {
    "zstd": {"one frame": zstandard.compress, "no content size": zstd_stream, "several frames": several(zstd_stream),
             "skippable frame": lambda data: struct.pack("<II", 0x184D2A50, 4) + b"note" + zstandard.compress(data),
             "checksum": zstandard.ZstdCompressor(write_checksum=True).compress},
    "lz4": {"one frame": lz4_frame, "several frames": several(lz4_frame), "block": lz4_block,
            "skippable frame": lambda data: struct.pack("<II", 0x184D2A5F, 4) + b"note" + lz4_frame(data),
            "independent blocks": lambda data: lz4_frame(data, True, False, True),
            "block behind its size": lambda data: struct.pack("<I", len(data)) + lz4_block(data)},
    "none": {"uncompressed chunk": lambda data: data},
}


def mcap_files(scratch):
    for compression, packers in PACKERS.items():
        for name, pack in packers.items():
            same_as_plain(scratch, writer.mcap(scratch / "x.mcap", scans(), compression=compression, pack=pack))
            print("mcap:", compression, name)
    same_as_plain(scratch, writer.mcap(scratch / "x.mcap", scans()))
    writer.mcap(scratch / "x.mcap", scans(), compression="br", pack=lambda data: data)
    runs.refused("has chunks that are compressed by 'br', and only lz4 and zstd are supported; write  mcap compress ",
                 "check", bags.experiment(scratch / "x.yaml", "x.mcap"), code=4)
    # Without DataEnd; without footer and DataEnd.
    same_as_plain(scratch, writer.mcap(scratch / "x.mcap", scans(), end=writer.record(2, bytes(20)) + writer.MAGIC))
    same_as_plain(scratch, writer.mcap(scratch / "x.mcap", scans(), end=b""), "was not ended")


def cut_files(scratch):
    """A recorder that is killed, or a machine without power, leaves half a record, or zeros."""
    whole = writer.mcap(scratch / "whole.mcap", scans(), end=b"").read_bytes()
    for name, end in (("half", b"\5\xff\0\0\0\0\0\0\0abc"), ("zeros", bytes(5000)), ("garbage", b"\xff" * 300)):
        (scratch / f"{name}.mcap").write_bytes(whole + end)
        same_as_plain(scratch, scratch / f"{name}.mcap", "was not ended: only its first 950 ms can be read")
    # The last chunk is half zeros.
    records = b"".join(writer.message(*one) for one in scans(20))
    packed = zstandard.compress(records)
    broken = writer.chunk(records, "zstd", packed[:len(packed) // 2] + bytes(len(packed) - len(packed) // 2))
    (scratch / "broken.mcap").write_bytes(whole + broken)
    same_as_plain(scratch, scratch / "broken.mcap", "was not ended")
    (scratch / "broken.mcap").write_bytes(whole + broken + writer.END)
    runs.refused("broken.mcap' is damaged: a chunk cannot be unpacked", "check",
                 bags.experiment(scratch / "x.yaml", "broken.mcap"), code=4)


def sqlite_files(scratch):
    for distribution in writer.TOPICS:
        path = scratch / f"{distribution}.db3"
        same_as_plain(scratch, writer.db3(path, scans(), distribution=distribution))
    # Packed messages, also in MCAP.
    for pack in (zstandard.compress, zstd_stream, several(zstd_stream)):
        packed = [(time, pack(data)) for time, data in scans()]
        (scratch / "packed.db3").unlink(missing_ok=True)
        same_as_plain(scratch, writer.db3(scratch / "packed.db3", packed, distribution="foxy"))
        same_as_plain(scratch, writer.mcap(scratch / "packed.mcap", packed))
    writer.mcap(scratch / "packed.mcap", [(time, data[:-5]) for time, data in packed])
    runs.refused("packed.mcap' is damaged: a compressed message is cut off", "check",
                 bags.experiment(scratch / "x.yaml", "packed.mcap"), code=4)
    # A recorder that was killed: all messages are still in the write-ahead log.
    recorder = writer.db3(scratch / "live.db3", scans(), close=False)
    (scratch / "killed").mkdir()
    for end in ("", "-wal"):
        shutil.copy(scratch / f"live.db3{end}", scratch / f"killed/killed.db3{end}")
    recorder.close()
    assert (scratch / "killed/killed.db3-wal").stat().st_size > 0
    same_as_plain(scratch, scratch / "killed/killed.db3")
    assert (scratch / "run/experiment-files/killed/killed.db3-wal").exists()
    # The folder of the file is left as it was.
    assert not list(scratch.glob("foxy.db3-*"))
    other = sqlite3.connect(scratch / "other.db3")
    other.execute("CREATE TABLE topics(id INTEGER PRIMARY KEY)")
    other.close()
    (scratch / "cut.db3").write_bytes((scratch / "foxy.db3").read_bytes()[:5000])
    for name, text in (("other", "no recording of ROS 2: it has no tables 'topics' and 'messages'"),
                       ("cut", "is damaged")):
        runs.refused(text, "check", bags.experiment(scratch / "x.yaml", f"{name}.db3"), code=4)


def parts(scratch):
    """The same 20 messages in three files."""
    for name, make, pack in (("mcap", writer.mcap, False), ("packed", writer.mcap, True), ("db3", writer.db3, False),
                             ("packed_db3", writer.db3, True)):
        folder = scratch / name
        folder.mkdir()
        ending = ".mcap" if make == writer.mcap else ".db3"
        files = []
        for number, (first, count) in ((9, (0, 5)), (10, (5, 10)), (11, (15, 5))):
            path = make(folder / f"{name}_{number}{ending}", scans(first, count))
            if pack:
                path.with_name(path.name + ".zstd").write_bytes(zstandard.compress(path.read_bytes()))
                path.unlink()
            files.append(path.name + (".zstd" if pack else ""))
        same_as_plain(scratch, folder)  # as a recorder that was killed leaves it
        (folder / f"{name}_12{ending}").write_bytes(b"")
        same_as_plain(scratch, folder, f"{name}_12{ending}' is empty and is left out")
        (folder / f"{name}_12{ending}").unlink()
        writer.metadata(folder, files, *(("FILE", "zstd") if pack else ()))
        same_as_plain(scratch, folder)
        same_as_plain(scratch, folder / "metadata.yaml")
        writer.metadata(folder, [f"{name}/{file}" for file in files])  # Foxy
        same_as_plain(scratch, f"{folder}/")
        values, _, printed = values_of(scratch, folder / files[1])
        assert len(values) == 10
        runs.assert_says(printed, f"{files[1]}' is one of 3 parts of a recording; write the path {folder} to read all")
        print("folder:", name)


def odd_folders(scratch):
    folder = scratch / "mcap"
    files = sorted(path.name for path in folder.glob("*.mcap"))
    writer.metadata(folder, [*files, "mcap_12.mcap"])
    file = bags.experiment(scratch / "x.yaml", folder)
    runs.refused("metadata.yaml' lists the part mcap_12.mcap, which is missing; copy it to the folder", "check",
                 file, code=4)
    writer.metadata(folder, files, "MESSAGE", "lz4")
    runs.refused("the messages are compressed by 'lz4', and only zstd is supported", "check", file, code=4)
    (folder / "metadata.yaml").write_text("rosbag2_bagfile_information: {relative_file_paths: [")
    runs.refused("metadata.yaml' is damaged", "check", file, code=4)
    (folder / "metadata.yaml").unlink()
    (folder / "mcap_10.mcap").rename(scratch / "mcap_10.mcap")
    runs.assert_says(bags.spikeloop("check", file), "part 10 is missing before 'mcap_11.mcap'")
    (scratch / "mcap_10.mcap").rename(folder / "mcap_10.mcap")
    writer.db3(folder / "mcap_11.db3", scans(15, 5))
    same_as_plain(scratch, folder, "mcap_11.db3' is left out, because")
    writer.mcap(folder / "other.mcap", scans())
    runs.refused("has several recordings: ", "check", file, code=4)
    (scratch / "empty").mkdir()
    runs.refused("is a folder without a recording", "check", bags.experiment(scratch / "x.yaml", "empty"), code=4)
    (scratch / "x.mcap.gz").write_bytes(b"\x1f\x8b\x08" + bytes(100))
    runs.refused("is compressed; write  gunzip ", "check", bags.experiment(scratch / "x.yaml", "x.mcap.gz"), code=4)


def ros1_bags(scratch):
    """`rosbag record --split` puts the time into every name."""
    expected = [bags.signal_of(message) for message in bags.arena(20)]
    for compression in (rosbag.Compression.NONE, rosbag.Compression.BZ2, rosbag.Compression.LZ4):
        folder = scratch / f"split_{compression}"
        folder.mkdir()
        messages = [(BEGIN + i * SECOND // 20, message) for i, message in enumerate(bags.arena(20))]
        for number, minute in enumerate((59, "00")):
            bags.write(folder / f"drive_2024-01-01-1{number}-{minute}-00_{number}.bag", messages[10 * number:][:10],
                       compression=compression)
        runs.run(bags.experiment(scratch / "x.yaml", folder), scratch / "run")
        _, rows = runs.recordings.signal(scratch / "run", "scan")
        np.testing.assert_allclose(rows, expected, atol=1e-6)
    bags.experiment(scratch / "x.yaml", folder / "drive_2024-01-01-10-59-00_0.bag")
    runs.assert_says(bags.spikeloop("check", scratch / "x.yaml"),
                     f"_0.bag' is one of 2 parts of a recording; write the path {folder} to read all")
    (folder / "other.bag").write_bytes(b"")
    runs.assert_says(bags.spikeloop("check", scratch / "x.yaml"), "move them to a folder of their own")
    (folder / "other.bag").unlink()
    # Numbers from 1 are often those of recordings, not of parts.
    for number in (1, 2):
        shutil.copy(folder / "drive_2024-01-01-10-59-00_0.bag", scratch / f"trial_{number}.bag")
    bags.experiment(scratch / "x.yaml", "trial_1.bag")
    assert "parts of a recording" not in bags.spikeloop("check", scratch / "x.yaml")
    # Also packed, and cut off while it was packed.
    whole = (folder / "drive_2024-01-01-10-59-00_0.bag").read_bytes()
    (scratch / "packed.bag.zstd").write_bytes(zstandard.compress(whole))
    runs.run(bags.experiment(scratch / "x.yaml", "packed.bag.zstd"), scratch / "run")
    np.testing.assert_allclose(runs.recordings.signal(scratch / "run", "scan")[1], expected[:10], atol=1e-6)
    (scratch / "packed.bag.zstd").write_bytes(zstandard.compress(whole)[:-100])
    runs.refused("packed.bag.zstd' is damaged: it is cut off", "check", scratch / "x.yaml", code=4)
    (folder / "drive_2024-01-01-12-00-00_2.bag.active").write_bytes(b"")
    _, printed = runs.run(bags.experiment(scratch / "x.yaml", folder), scratch / "run")
    runs.assert_says(printed, "_2.bag.active' is incomplete and is skipped; run  rosbag reindex")


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        mcap_files(scratch)
        cut_files(scratch)
        sqlite_files(scratch)
        parts(scratch)
        odd_folders(scratch)
        ros1_bags(scratch)


if __name__ == "__main__":
    sys.exit(main())
