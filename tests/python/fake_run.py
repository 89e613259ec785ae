"""Makes a run folder of a robot that never was: a vehicle that wanders between obstacles.

The recordings follow docs/run-folder.md and are written with h5py.
"""

import json
import pathlib
import sys

import h5py
import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from folder import FolderCase  # noqa: E402, F401

TICK_S = 0.001
BEAMS = 100
ARENA = {"min_x_m": -3.0, "min_y_m": -3.0, "max_x_m": 3.0, "max_y_m": 3.0}
LASER = {"beams": BEAMS, "angle_min_rad": -np.pi / 2, "angle_increment_rad": np.pi / (BEAMS - 1)}
OBSTACLES = [
    {"name": "obstacle_box_1", "shape": "box", "x_m": -1.5, "y_m": 1.4, "theta_rad": 0.4,
     "half_x_m": 0.2, "half_y_m": 0.2},
    {"name": "obstacle_box_2", "shape": "box", "x_m": 1.6, "y_m": 1.2, "theta_rad": -0.2,
     "half_x_m": 0.25, "half_y_m": 0.15},
    {"name": "obstacle_cylinder_1", "shape": "cylinder", "x_m": 0.1, "y_m": -1.6,
     "radius_m": 0.25},
    {"name": "obstacle_cylinder_2", "shape": "cylinder", "x_m": -0.2, "y_m": 0.2,
     "radius_m": 0.15},
]


def recording(path, process):
    """An empty recording of one process."""
    file = h5py.File(path, "w")
    file.attrs["process"] = process
    file.attrs["spikeloop_version"] = "0.1.0"
    file.attrs["spikeloop_format"] = np.uint32(1)
    file.attrs["seed"] = np.uint64(1)
    file.attrs["tick_ns"] = np.int64(1_000_000)
    file.attrs["complete"] = np.uint32(1)
    file.create_group("spikes")
    file.create_group("signals")
    return file


def add_spikes(file, stream, times_s, channels, width, until_s, populations=()):
    group = file["spikes"].create_group(stream)
    group.attrs["width"] = np.uint32(width)
    group.attrs["until_ns"] = np.int64(round(until_s * 1e9))
    group.attrs["dropped"] = np.uint64(0)
    if populations:
        group.attrs["populations"], sizes = zip(*populations)
        group.attrs["population_sizes"] = np.array(sizes, dtype=np.uint32)
    group.create_dataset("timestamps", data=np.asarray(times_s, dtype=float) * 1e3)
    group.create_dataset("timestamps_ns", data=np.round(np.asarray(times_s) * 1e9).astype(np.int64))
    group.create_dataset("node_ids", data=np.asarray(channels, dtype=np.uint64))


def add_signal(file, stream, times_s, values, unit, until_s, channels=()):
    group = file["signals"].create_group(stream)
    group.attrs["width"] = np.uint32(np.shape(values)[1])
    group.attrs["until_ns"] = np.int64(round(until_s * 1e9))
    group.attrs["dropped"] = np.uint64(0)
    if channels:
        group.attrs["channels"] = list(channels)
    group.create_dataset("times_ns", data=np.round(np.asarray(times_s) * 1e9).astype(np.int64))
    group.create_dataset("values", data=np.asarray(values, dtype=float)).attrs["unit"] = unit


def _clearance(points):
    """Distance of points (n x 2) from the nearest wall or obstacle (taken as a circle)."""
    near = np.minimum.reduce([points[:, 0] + 3, 3 - points[:, 0], points[:, 1] + 3,
                              3 - points[:, 1]])
    for thing in OBSTACLES:
        radius = thing.get("radius_m") or np.hypot(thing["half_x_m"], thing["half_y_m"])
        away = np.hypot(points[:, 0] - thing["x_m"], points[:, 1] - thing["y_m"]) - radius
        near = np.minimum(near, away)
    return near


def _scan(x, y, theta, angles):
    """Ranges (m, at most 5) of the beams, by walking along them."""
    steps = np.arange(0.05, 5.0, 0.05)
    direction = theta + angles
    points = np.stack((x + steps[:, None] * np.cos(direction),
                       y + steps[:, None] * np.sin(direction)), axis=-1)
    hit = _clearance(points.reshape(-1, 2)).reshape(points.shape[:2]) <= 0
    return np.where(hit.any(axis=0), steps[np.argmax(hit, axis=0)], 5.0)


def wander(duration_s, step_s=0.05):
    """Columns of the trajectory, scans (n x beams) and commands (n x 2), a row every step."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, BEAMS)
    x, y, theta = -2.2, -2.0, 0.6
    rows, scans, commands = [], [], []
    collisions = 0
    for k in range(int(duration_s / step_s)):
        ranges = _scan(x, y, theta, angles)
        right, left = ranges[:BEAMS // 2].mean(), ranges[BEAMS // 2:].mean()
        speed = 0.5 * min(1.0, ranges[35:65].min() / 1.2)
        turn = np.clip(1.4 * (left - right), -1.5, 1.5)
        turn += 0.8 * (1.0 - speed / 0.5) * (1 if left >= right else -1)
        rows.append((k * step_s, x, y, theta, speed, turn, collisions))
        scans.append(ranges)
        commands.append((speed, turn))
        theta += turn * step_s
        x += speed * np.cos(theta) * step_s
        y += speed * np.sin(theta) * step_s
        if k in (300, 700):
            collisions += 1
    return np.array(rows), np.array(scans), np.array(commands)


def make(folder, duration_s=60.0, neurons=20, seed=3):
    """A whole run folder."""
    random = np.random.default_rng(seed)
    rows, scans, commands = wander(duration_s)
    header = "t_s,x_m,y_m,theta_rad,v_m_s,w_rad_s,collisions"
    np.savetxt(folder / "trajectory.csv", rows, delimiter=",", header=header, comments="",
               fmt="%.6g")
    (folder / "world.json").write_text(json.dumps({"arena": ARENA, "laser": LASER, "obstacles": OBSTACLES}))
    length = np.hypot(*np.diff(rows[:, 1:3], axis=0).T).sum()
    (folder / "summary.json").write_text(json.dumps(
        {"distance_m": length, "coverage": 0.62, "collisions": int(rows[-1, 6]),
         "mean_speed_m_s": length / duration_s}))
    with recording(folder / "sensor.h5", "sensor") as file:
        normalised = (scans - 0.05) / 4.95 * 2 - 1
        add_signal(file, "out", rows[:, 0] + TICK_S, normalised, "1", duration_s)
        add_signal(file, "data_stamp", rows[:, 0] + TICK_S, rows[:, :1], "s", duration_s)
    with recording(folder / "network.h5", "network") as file:
        add_spikes(file, "out", *_spikes(random, rows, commands, neurons), neurons, duration_s)
    with recording(folder / "command.h5", "command") as file:
        add_signal(file, "command", rows[:, 0] + 2 * TICK_S, commands, "1", duration_s,
                   channels=("linear.x", "angular.z"))


def _spikes(random, rows, commands, neurons):
    """Poisson spikes whose rate follows the wheel of their half."""
    step_s = rows[1, 0] - rows[0, 0]
    wheels = np.stack((commands[:, 0] + 0.15 * commands[:, 1],
                       commands[:, 0] - 0.15 * commands[:, 1]))
    half = (np.arange(neurons) >= neurons // 2).astype(int)
    rate = np.clip(5 + 60 * wheels[half], 0, None)
    counts = random.poisson(rate * step_s)
    channel, row = np.nonzero(counts)
    channel, row = np.repeat(channel, counts[channel, row]), np.repeat(row, counts[channel, row])
    times = rows[row, 0] + step_s * random.random(len(row))
    order = np.argsort(times)
    return times[order], channel[order]
