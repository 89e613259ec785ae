"""Messages of a run or of any recording as arrays of NumPy.

    >>> scans = spikeloop.open_run("runs/explorer-1").messages("/scan")
    >>> scans.times_s, scans["ranges"]          # (n,), (n, 100)
    >>> spikeloop.read_messages("drive.bag", "/odom")["pose.pose.position.x"]

docs/run-folder.md describes the shapes.
"""

import os
import re
import warnings

import numpy as np

from .run_folder import RunFolderError, did_you_mean

IMAGE = "sensor_msgs/Image"
NAMED_ENCODINGS = re.compile(r"(mono|rgb|bgr|rgba|bgra|bayer_\w+?)(8|16)")
TYPED_ENCODINGS = re.compile(r"(8|16|32|64)([USF])C(\d*)")  # of OpenCV: 32FC1
CHANNELS = {"rgb": 3, "bgr": 3, "rgba": 4, "bgra": 4}


def _module():
    from . import music_library
    return music_library.library("spikeloop_python_messages", "run.messages")


def _call(name, *arguments):
    module = _module()
    try:
        return getattr(module, name)(*arguments)
    except module.Failure as error:
        raise RunFolderError(*error.args) from None


def _objects(values):
    """A one-dimensional array of any objects."""
    result = np.empty(len(values), dtype=object)
    for i, value in enumerate(values):
        result[i] = value
    return result


def _split(values, counts):
    """Splits values into arrays of counts[i] entries: rows of one array if all counts are equal, else an object array."""
    if len(counts) == 0 or (counts == counts[0]).all():
        return values.reshape(len(counts), counts[0] if len(counts) else 0, *values.shape[1:])
    return _objects(np.split(values, np.cumsum(counts)[:-1]))


def _stack(arrays):
    """One array if all have the same shape and type, else an object array of arrays."""
    same = len({(array.shape, array.dtype) for array in arrays}) == 1
    return np.stack(arrays) if same else _objects(arrays)


class Messages:
    """All messages of a topic, in the order of their times. `len(messages)`: how many.

    times_s: float64, n; of a run: simulated, of any other recording: since its first message
    type: "sensor_msgs/LaserScan"
    fields: paths of the fields that were read: "header.stamp", "ranges", ...
    """

    def __init__(self, topic, kind, times_ns, columns):
        self.topic, self.type = topic, kind
        self.times_s = times_ns * 1e-9
        self._columns = {path: (values, counts) for path, values, counts in columns}
        self.fields = list(self._columns)

    def __len__(self):
        return len(self.times_s)

    def __repr__(self):
        return f"<{len(self)} messages of {self.type} on {self.topic}>"

    def __getitem__(self, path):
        """The values of a field, one entry per message. @raises RunFolderError: no such field"""
        if path not in self._columns:
            below = [field for field in self.fields if field.startswith(f"{path}.")]
            raise RunFolderError(f"{self.type} has no number or text '{path}'" +
                                 (f"; its fields: {', '.join(below)}" if below else did_you_mean(path, self.fields)), 2)
        values, counts = self._columns[path]
        values = _objects(values) if isinstance(values, list) else values
        for level in reversed(counts):
            values = _split(values, level)
        return values

    def images(self):
        """The images of sensor_msgs/Image: n x height x width (x channels), colours in the order red, green, blue. An
        object array of images if their sizes differ. @raises RunFolderError: another type or encoding"""
        if self.type != IMAGE:
            raise RunFolderError(f"topic '{self.topic}' has messages of {self.type}, not {IMAGE}" +
                                 ("; decode each message['data'][i], for example by PIL.Image.open(io.BytesIO(data))"
                                  if self.type == "sensor_msgs/CompressedImage" else ""), 2)
        return _stack([_image(*parts) for parts in zip(
            *(self[name] for name in ("encoding", "height", "width", "step", "is_bigendian", "data")))])


def _image(encoding, height, width, step, is_bigendian, data):
    if found := NAMED_ENCODINGS.fullmatch(encoding):
        channels, kind = CHANNELS.get(found[1], 1), f"u{int(found[2]) // 8}"
    elif found := TYPED_ENCODINGS.fullmatch(encoding):
        channels = int(found[3] or 1)
        kind = {"U": "u", "S": "i", "F": "f"}[found[2]] + str(int(found[1]) // 8)
    else:
        raise RunFolderError(f"images with encoding '{encoding}' are not decoded; their bytes are in ['data']", 2)
    kind = np.dtype(kind).newbyteorder(">" if is_bigendian else "<")
    used = int(width) * channels * kind.itemsize
    if step < used or len(data) < int(height) * int(step):
        raise RunFolderError(f"an image of {width} x {height} pixels '{encoding}' has {len(data)} bytes, {step} per row; "
                             "it is damaged")
    rows = np.ascontiguousarray(data[:int(height) * int(step)].reshape(height, step)[:, :used])
    pixels = rows.view(kind).astype(kind.newbyteorder("=")).reshape(height, width, channels)
    if encoding.startswith("bgr"):
        pixels[..., :3] = pixels[..., 2::-1].copy()
    return pixels[..., 0] if channels == 1 else pixels


def read_messages(path, topic, fields=(), node=""):
    """The messages of a topic in a recording (MCAP, SQLite or a bag of ROS 1; a file, or a folder of ros2 bag record).

    fields: the fields to read, with all below them ("pose.pose"); without it all: of images that takes much memory.
    node: of a run, whose nodes may take the same topic: the node whose messages are read; without it the first.
    @raises RunFolderError: the file cannot be read, or has no such topic (the error lists them), field or node
    """
    fields = [fields] if isinstance(fields, str) else list(fields)
    kind, times_ns, columns, said = _call("read", os.fspath(path), topic, node, fields)
    for text in said:
        warnings.warn(text, stacklevel=2)
    return Messages(topic, kind, times_ns, columns)


def read_topics(path):
    """The topics of a recording: {"/scan": "sensor_msgs/LaserScan"}. @raises RunFolderError: it cannot be read"""
    return _call("topics", os.fspath(path))
