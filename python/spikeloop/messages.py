"""Messages of a run or of any recording as arrays of NumPy.

    >>> scans = spikeloop.open_run("runs/explorer-1").messages("/scan")
    >>> scans.times_s, scans["ranges"]          # (n,), (n, 100)
    >>> spikeloop.read_messages("drive.bag", "/odom")["pose.pose.position.x"]

docs/run-folder.md describes the shapes.
"""

import os
import sys
import warnings

import numpy as np

from .run_folder import RunFolderError, did_you_mean

# Fields of an image's message, as the library's function takes them.
IMAGES = {"sensor_msgs/Image": ("image", ("encoding", "height", "width", "step", "is_bigendian", "data")),
          "sensor_msgs/CompressedImage": ("compressed_image", ("format", "data"))}


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
        """The images of sensor_msgs/Image or sensor_msgs/CompressedImage, in every encoding and format that a sensor
        reads (docs/images.md): n x height x width (x channels), colours in the order red, green, blue. An object array
        of images if their sizes differ. @raises RunFolderError: another type, another encoding, a damaged image"""
        if self.type not in IMAGES:
            raise RunFolderError(f"topic '{self.topic}' has messages of {self.type}, not {' or '.join(IMAGES)}", 2)
        function, fields = IMAGES[self.type]
        images = []
        for parts in zip(*(self[field] for field in fields)):
            try:
                images.append(_call(function, *parts))
            except RunFolderError as error:
                raise RunFolderError(f"topic '{self.topic}', message {len(images) + 1}: {error}",
                                     error.exit_code) from None
        return _stack(images)


def _warn(texts):
    """Issues warnings for the line that called the package."""
    level = 1
    frame = sys._getframe()
    while frame is not None and frame.f_globals.get("__name__", "").startswith(__package__ + "."):
        level, frame = level + 1, frame.f_back
    for text in texts:
        warnings.warn(text, stacklevel=level)


def read_messages(path, topic, fields=(), node=""):
    """The messages of a topic in a recording (MCAP, SQLite or a bag of ROS 1; a file, or a folder of ros2 bag record).

    fields: the fields to read, with all below them ("pose.pose"); without it all: of images that takes much memory.
    node: of a run, whose nodes may take the same topic: the node whose messages are read; without it the first.
    Parts that are missing, a file that is cut off, a clock that jumps and a definition that cannot be used are reported
    as Python warnings, as those of a run.
    @raises RunFolderError: the file cannot be read, or has no such topic (the error lists them), field or node
    """
    fields = [fields] if isinstance(fields, str) else list(fields)
    kind, times_ns, columns, texts = _call("read", os.fspath(path), topic, node, fields)
    _warn(texts)
    return Messages(topic, kind, times_ns, columns)


def read_topics(path):
    """The topics of a recording: {"/scan": "sensor_msgs/LaserScan"}. @raises RunFolderError: it cannot be read"""
    topics, texts = _call("topics", os.fspath(path))
    _warn(texts)
    return topics
