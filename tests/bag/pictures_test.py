#!/usr/bin/python3
"""Pictures, fields with options and point clouds from a bag, against NumPy; change of pictures as
spikes; a command into a named array. What rospy's own messages wrote, our programs read."""

import pathlib
import struct
import tempfile

import numpy as np
import rosbag
import yaml
from sensor_msgs.msg import Image, JointState, PointCloud2, PointField

import bags
import runs
from mcap_file import McapFile

MS = 10**6
WIDTH, HEIGHT = 24, 18

EXPERIMENT = """experiment: pictures
sync: unpaced
robot: {robot}
{more}nodes:
  eye: {{node: ros_sensor, topic: /camera, message: sensor_msgs/Image,
         image: {{crop: [4, 2, 16, 12], resize: [4, 3], channel: red}}}}
  contrast: {{node: ros_sensor, topic: /camera, message: sensor_msgs/Image,
              image: {{resize: [6, 6], filter: on_off, gain: 4}}}}
  change: {{node: temporal_contrast_encoder, threshold: 0.05}}
  joints: {{node: ros_sensor, topic: /joints, message: sensor_msgs/JointState,
            fields: [{{path: "position[name=left]", range: [-2, 2]}},
                     {{path: "velocity[0:2]", scale: 10, offset: 1, max: 5, nan: hold}}]}}
  cloud: {{node: ros_sensor, topic: /points, message: sensor_msgs/PointCloud2,
           fields: ["points.z[1:3]", {{path: "points.intensity[0]", scale: 0.5}}]}}
  counted: {{node: rate_window}}
  on: {{node: rate_encoder, rate_max: 100 Hz}}
  all: {{node: rate_encoder, rate_max: 100 Hz}}
  out: {{node: ros_command, topic: /motors, message: sensor_msgs/JointState,
         fields: {{"effort[name=left]": 0, "velocity[0:2]": {{channel: 1, scale: 2}}}}}}
connections:
  - eye -> change [12] -> counted [24]
  - contrast -> on [72]
  - joints -> out [3]
  - cloud -> all [3]
"""


def picture(generator):
    pixels = generator.integers(0, 256, (HEIGHT, WIDTH, 3), dtype=np.uint8)
    message = Image(height=HEIGHT, width=WIDTH, encoding="bgr8", step=3 * WIDTH + 5)
    padded = np.full((HEIGHT, message.step), 77, np.uint8)
    padded[:, :3 * WIDTH] = pixels.reshape(HEIGHT, 3 * WIDTH)
    message.data = padded.tobytes()
    message.header.frame_id = "camera"
    return message, pixels[:, :, ::-1].astype(float)


def cloud():
    message = PointCloud2(height=1, width=3, point_step=20, row_step=60, is_dense=True)
    message.fields = [PointField("x", 0, PointField.FLOAT32, 1),
                      PointField("z", 8, PointField.FLOAT32, 1),
                      PointField("intensity", 16, PointField.UINT16, 1)]
    message.data = b"".join(struct.pack("<fffIHxx", 1, 2, 0.25 * i, 0, 7 + i) for i in range(3))
    return message


def gaussian_average(plane, deviation):
    """As docs/images.md defines it, pixel by pixel."""
    rows, columns = np.indices(plane.shape)
    radius = np.ceil(3 * deviation)
    result = np.empty_like(plane)
    for v, u in np.ndindex(plane.shape):
        weights = np.exp(-((rows - v)**2 + (columns - u)**2) / (2 * deviation**2))
        weights *= (abs(rows - v) <= radius) & (abs(columns - u) <= radius)
        result[v, u] = (weights * plane).sum() / weights.sum()
    return result


def on_off(rgb):
    grey = rgb @ [0.299, 0.587, 0.114]
    u = grey.reshape(6, 3, 6, 4).mean((1, 3)) / 255
    contrast = 4 * (gaussian_average(u, 1) - gaussian_average(u, 3))
    halves = [np.clip(2 * np.maximum(0, sign * contrast) - 1, -1, 1) for sign in (1, -1)]
    return np.concatenate([half.ravel() for half in halves])


def check_run(run, pictures):
    red = np.array([rgb[2:14, 4:20, 0].reshape(3, 4, 4, 4).mean((1, 3)).ravel() for rgb in pictures])
    eye = 2 * red / 255 - 1
    times, values = runs.recordings.signal(run, "eye")
    assert np.allclose(values, eye, atol=1e-6), values
    _, contrast = runs.recordings.signal(run, "contrast")
    assert np.allclose(contrast, [on_off(rgb) for rgb in pictures], atol=1e-6)
    _, joints = runs.recordings.signal(run, "joints")
    assert np.allclose(joints, [[-0.75, 3, 5], [0.5, 3, -3]]), joints
    _, points = runs.recordings.signal(run, "cloud")
    assert np.allclose(points, [[0.25, 0.5, 3.5]]), points
    # Frame differences: a spike for every change by more than the threshold; ON is even, OFF odd.
    expected = []
    for time, difference in zip(times[1:] - MS, np.diff(eye, axis=0)):  # the end of the tick
        expected += [(time, 2 * c) for c in np.flatnonzero(difference > 0.05)]
        expected += [(time, 2 * c + 1) for c in np.flatnonzero(difference < -0.05)]
    stamps, channels = runs.recordings.spikes(run, "change")
    ticks = (stamps - 1) // MS * MS
    assert sorted(zip(ticks, channels)) == sorted(expected), (list(zip(ticks, channels)), expected)
    assert len(expected) > 10
    sent = [message for _, message in McapFile(run / "messages.mcap").of("/motors")]
    assert any(m.name == ["left"] and np.allclose(m.effort, [0.5, np.nan], equal_nan=True) and
               np.allclose(m.velocity, [6, -6]) for m in sent), sent


def main():
    generator = np.random.default_rng(5)
    with tempfile.TemporaryDirectory() as folder:
        scratch = pathlib.Path(folder)
        made = [picture(generator) for _ in range(4)]
        with rosbag.Bag(str(scratch / "camera.bag"), "w") as bag:
            for i, (message, _) in enumerate(made):
                bag.write("/camera", message, bags.genpy.Time(0, 10 * i * MS + 1))
            bag.write("/points", cloud(), bags.genpy.Time(0, 2 * MS))
            left = JointState(name=["right", "left"], position=[9, -1.5], velocity=[0.2, 0.7])
            bag.write("/joints", left, bags.genpy.Time(0, 3 * MS))
            left = JointState(name=["left"], position=[1], velocity=[float("nan"), -0.4])
            bag.write("/joints", left, bags.genpy.Time(0, 13 * MS))
        file = scratch / "pictures.yaml"
        file.write_text(EXPERIMENT.format(robot="{bag: camera.bag}", more=""))
        run = scratch / "run"
        bags.spikeloop("run", file, "--out", run)
        check_run(run, [rgb for _, rgb in made])
        check_export(scratch)


def check_export(scratch):
    """An exported job has the rules in files, which its programs read."""
    file = scratch / "ros.yaml"
    file.write_text(EXPERIMENT.replace("robot: {robot}\n", "ros: 1\nduration: 1 s\n").format(more=""))
    bags.spikeloop("export", file, "--out", scratch / "job")
    job = scratch / "job" / "experiment.music"
    bags.spikeloop("check", job)
    bags.spikeloop("import", job, "--out", scratch / "again.yaml")
    nodes = yaml.safe_load((scratch / "again.yaml").read_text())["nodes"]
    assert nodes["eye"]["image"] == {"crop": [4, 2, 16, 12], "resize": [4, 3], "channel": "red"}, nodes
    assert nodes["joints"]["fields"][0] == {"path": "position[name=left]", "range": [-2, 2]}, nodes
    mapping = scratch / "job" / "eye.mapping.json"
    mapping.write_text(mapping.read_text().replace("resize", "resiz"))
    runs.refused("eye.mapping.json:2:3: key 'image': ... 'resiz'; ... 'resize'? ... [SL0103]", "check", job)


if __name__ == "__main__":
    main()
