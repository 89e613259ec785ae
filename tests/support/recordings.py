"""What runs leave, read with h5py and csv alone."""

import pathlib

import h5py
import numpy as np

from growing_file import table  # noqa: F401


def spikes(folder, node, output="out"):
    """(times in ns, channels)"""
    with h5py.File(folder / f"{node}.h5") as file:
        group = file["spikes"][output]
        assert group.attrs["dropped"] == 0
        return group["timestamps_ns"][:], group["node_ids"][:].astype(np.int64)


def signal(folder, node, output="out"):
    """(times in ns, rows)"""
    with h5py.File(folder / f"{node}.h5") as file:
        group = file["signals"][output]
        assert group.attrs["dropped"] == 0
        return group["times_ns"][:], group["values"][:]


def spikes_of_run(folder):
    """(times in ns, channels) of all outputs of all nodes, by `node.output`."""
    found = {}
    for path in sorted(pathlib.Path(folder).glob("*.h5")):
        with h5py.File(path) as file:
            outputs = list(file.get("spikes", ()))
        found |= {f"{path.stem}.{output}": spikes(path.parent, path.stem, output) for output in outputs}
    return found


def same(first, second):
    """Of two runs: every spike at its time, in the same order."""
    return first.keys() == second.keys() and len(first) > 0 and all(
        np.array_equal(a, b) for name in first for a, b in zip(first[name], second[name]))


def in_order(times, channels):
    """[times, channels] by time and channel."""
    order = np.lexsort((channels, times))
    return np.stack([times[order], channels[order]])


def assert_same(expected, found, what):
    """Of two pairs (times, channels): the same spikes, each as often."""
    expected, found = in_order(*expected), in_order(*found)
    assert expected.shape == found.shape, \
        f"{what}: {expected.shape[1]} spikes expected, {found.shape[1]} found"
    wrong = np.flatnonzero(np.any(expected != found, axis=0))
    assert not len(wrong), (f"{what}: {len(wrong)} of {found.shape[1]} spikes differ; the first: "
                            f"{expected[:, wrong[0]]} expected, {found[:, wrong[0]]} found")
