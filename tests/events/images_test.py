#!/usr/bin/python3
"""Images on topics of ROS 1 and ROS 2: the values of two encodings; an encoding that cannot be read ends the run."""

import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import threading
import zlib

import camera
import ros
import runs

EXPERIMENT = """experiment: live
duration: {duration}
ros: {ros}
nodes:
  eye: {{node: ros_sensor, topic: /camera, message: {message}, image: {{{keys}}}}}
  spikes: {{node: rate_encoder, rate_max: 100 Hz}}
  count: {{node: rate_window}}
  go: {{node: ros_command, topic: /go, message: std_msgs/Float64MultiArray, limits: none}}
connections:
  - eye -> spikes [4] -> count [4] -> go [4]
"""


def writer(version):
    out = camera.Cdr() if version == "2" else camera.Ros1()
    out.header(0)
    return out


def image(version, encoding, step, data):
    """2 x 2 pixels."""
    out = writer(version)
    out.put("II", 2, 2)
    out.text(encoding)
    out.put("BII", 0, step, len(data))
    out.data += data
    return out.bytes()


def compressed(version, format_, data):
    out = writer(version)
    out.text(format_)
    out.put("I", len(data))
    out.data += data
    return out.bytes()


def depth_png(depths):
    """2 x 2 pixels of 16 bits."""
    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    rows = b"".join(b"\0" + struct.pack(">HH", *depths[i:i + 2]) for i in (0, 2))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 2, 2, 16, 0, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


class Publisher:
    """Sends one message again and again."""

    def __init__(self, version, type_, message):
        self.pipe = subprocess.Popen([os.environ["MESSAGE_PIPE"], version, "/camera", type_], text=True,
                                     stdin=subprocess.PIPE)
        self.stop = threading.Event()
        self.thread = threading.Thread(target=self._send, args=(message.hex() + "\n",))

    def _send(self, line):
        while not self.stop.wait(0.02):
            self.pipe.stdin.write(line)
            self.pipe.stdin.flush()

    def __enter__(self):
        self.thread.start()

    def __exit__(self, *_):
        self.stop.set()
        self.thread.join()
        self.pipe.stdin.close()
        assert self.pipe.wait(20) == 0


def main():
    image_type, compressed_type = "sensor_msgs/Image", "sensor_msgs/CompressedImage"
    for version in "12":
        # Red is the third component of 8UC3, and a step of 7 bytes leaves a gap.
        red = image(version, "8UC3", 7, bytes([9, 9, 0, 9, 9, 255, 9, 9, 9, 51, 9, 9, 204]))
        depth = compressed(version, "16UC1; compressedDepth png", bytes(12) + depth_png([1000, 2000, 3000, 9000]))
        two = image(version, "8UC2", 4, bytes(8))
        video = compressed(version, "h264", bytes(30))
        with tempfile.TemporaryDirectory() as scratch, ros.place(version, pathlib.Path(scratch)):
            scratch = pathlib.Path(scratch)
            file = scratch / "live.yaml"
            for type_, message, keys, expected in [(image_type, red, "channel: red", [-1, 1, -0.6, 0.6]),
                                                   (compressed_type, depth, "range: [0, 4000]", [-0.5, 0, 0.5, 1])]:
                file.write_text(EXPERIMENT.format(ros=version, duration="4 s", message=type_, keys=keys))
                with Publisher(version, type_, message):
                    runs.run(file, scratch / "run")
                _, values = runs.recordings.signal(scratch / "run", "eye")
                assert len(values) > 0 and abs(values - expected).max() < 1e-6, values
            for type_, message, name in [(image_type, two, "8UC2"), (compressed_type, video, "h264")]:
                file.write_text(EXPERIMENT.format(ros=version, duration="100 s", message=type_, keys="resize: [2, 2]"))
                with Publisher(version, type_, message):
                    _, printed = runs.run(file, scratch / "run", code=2)
                runs.assert_says(printed, f"live.yaml:5:3: node 'eye': topic '/camera': ... '{name}' ... [SL0511]")
        print(f"images over ROS {version}")


if __name__ == "__main__":
    sys.exit(main())
