#!/usr/bin/python3
"""`spikeloop plot` on the folder of an experiment and of a MUSIC job; its errors."""

import json
import os
import pathlib
import sys
import tempfile
import types

import h5py
import numpy as np
from spikeloop import parts, quantities, spikes_plot
from spikeloop.run_folder import RunFolder

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "fused"))
import ros  # noqa: E402
import runs  # noqa: E402


def plot(*arguments):
    """Names of the pictures and what was said."""
    out, said = runs.spikeloop("plot", *arguments)
    return [pathlib.Path(line).name for line in out.splitlines()], said


def run(*arguments):
    runs.spikeloop("run", "-q", *arguments)


def an_experiment(folder):
    """All pictures of a robot's run in lockstep, which has no latency to draw; it is recorded all the same."""
    (folder / "explorer.yaml").write_text(runs.spikeloop("new")[0])
    out = folder / "drive"
    run(folder / "explorer.yaml", "--sync", "lockstep", "--duration", "2", "--out", out)
    pictures, said = plot(out)
    assert (pictures, said) == (["trajectory.png", "spikes.png", "signals.png"], "")
    with h5py.File(out / "wheels.h5") as file:
        latency = file["signals/latency"]
        values, times = latency["values"][:, 0], latency["times_ns"][:]
        assert latency["values"].attrs["unit"] in ("ms", b"ms")
    summary = json.loads((out / "summary.json").read_text())
    assert np.sort(values)[(len(values) + 1) // 2 - 1] == summary["latency_median_ms"]
    assert len(values) == summary["scans"] == 40, (len(values), summary["scans"])
    # In lockstep a scan's command leaves a tick later; there is a scan every 50 ms.
    assert np.all(values == 1.0) and np.all(np.diff(times[1:]) == 50_000_000), (values, times)
    pictures, _ = plot(out, "--format", "pdf", "--from", "500 ms", "--to", "1", "--out",
                       folder / "figures")
    assert pictures == ["trajectory.pdf", "spikes.pdf", "signals.pdf"], pictures
    return out


MAZE = """experiment: maze
duration: 1 s
sync: lockstep
robot: {simulator: mujoco, world: t_maze}
nodes:
  scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}
  light: {node: ros_sensor, topic: /light, message: std_msgs/Float64MultiArray}
  sectors: {node: connect, weights: blocks}
  encoder: {node: rate_encoder, rate_max: 100 Hz}
  brain:
    simulator: builtin
    network:
      populations:
        input: {model: input, size: 10}
        first: {model: repeater, size: 10}
        second: {model: iaf_psc_exp, size: 2, parameters: {I_e: 400 pA}}
      connections:
        - {from: input, to: first, rule: one_to_one, delay: 1 ms}
      output: [first, second]
      record:
        second: {spikes: true, V_m: [1, 0]}
  decoder: {node: rate_window}
  wheels: {node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, fields: {linear.x: {channel: 1, scale: 0.01}}}
  seen: {node: delay, delay: 1 ms}
connections:
  - scan -> sectors [100] -> encoder [10] -> brain [10]
  - brain.out -> decoder [12] -> wheels [12]
  - light -> seen [2]
"""


def what_the_pictures_need(folder):
    """Names of populations, units, lamps and goals come with the run."""
    (folder / "maze.yaml").write_text(MAZE)
    out = folder / "maze"
    run(folder / "maze.yaml", "--out", out)
    found = parts.find(RunFolder(out))
    assert [(population.name, population.size) for population in spikes_plot.populations(
        [stream for stream in found.spikes if stream.label == "brain"])] == [("first", 10), ("second", 2)]
    potential, = (signal for signal in found.signals if signal.stream == "second_V_m")
    assert potential.channels == ["second 1", "second 0"], potential.channels
    assert potential.unit == "mV" and -75 < potential.values.min() < potential.values.max() < -50, potential
    light, = (signal for signal in found.sensors if signal.label == "light")
    assert (light.channels, light.quantities) == (["left", "right"], [("illuminance", "lux")] * 2), light
    lane = types.SimpleNamespace(channels=[], width=2)
    quantities.describe(lane, "std_msgs/Float64MultiArray", {"topic": "/lane"}, {"lanes": [{"name": "lane_1"}]})
    assert (lane.channels, lane.quantities) == (["distance", "angle"], [("distance", "m"), ("angle", "rad")]), lane
    world = RunFolder(out).world()
    assert [(lamp["name"], abs(lamp["x_m"]), lamp["y_m"]) for lamp in world["lamps"]] == [("lamp_1", 0.46, -1.2)]
    assert [(goal["name"], goal["x_m"], goal["half_y_m"]) for goal in world["goals"]] == [
        ("goal_left", -1.75, 0.45), ("goal_right", 1.75, 0.45)], world["goals"]
    decoder, = (signal for signal in found.signals if signal.label == "decoder")
    assert decoder.channels[:3] == ["channel 0", "to linear.x", "channel 2"], decoder.channels
    pictures, said = plot(out)
    assert (pictures, said) == (["trajectory.png", "spikes.png", "signals.png"], ""), (pictures, said)


def two_commands(folder, drive):
    """A summary counts the messages of both."""
    (folder / "two.yaml").write_text(f"""experiment: two
duration: 500 ms
ros: 2
nodes:
  scan: {{node: signal_playback, file: {drive}/scan.h5}}
  a: {{node: ros_command, topic: /a, message: std_msgs/Float64MultiArray}}
  b: {{node: ros_command, topic: /b, message: std_msgs/Float64MultiArray}}
connections:
  - scan -> a [100]
  - scan -> b [100]
""")
    with ros.domain():
        run(folder / "two.yaml", "--out", folder / "two")
    summary = json.loads((folder / "two/summary.json").read_text())
    process, = summary["processes"].values()
    each = [process["counters"][f"{name}.commands"] for name in "ab"]
    assert summary["commands"] == sum(each) and min(each) > 0, (summary["commands"], each)


def a_music_job(folder, drive):
    (folder / "job.music").write_text(f"""stoptime=1
[scan]
np=1
binary=signal_playback
file={drive}/scan.h5
[cells]
np=1
binary=rate_encoder
[readout]
np=1
binary=spikeloop-node
node=rate_window
scan.out -> cells.in [100]
cells.out -> readout.in [100]
""")
    run(folder / "job.music", "--record", "--out", folder / "job")
    pictures, said = plot(folder / "job")
    assert pictures[0] == "spikes.png", pictures
    assert "no command among what is recorded" in said, said
    assert "latency.png is not drawn: no latency is recorded" in said, said


def errors(folder, drive):
    empty = folder / "empty"
    empty.mkdir()
    fake = folder / "fake" / "matplotlib"
    fake.mkdir(parents=True)
    (fake / "__init__.py").write_text("raise ModuleNotFoundError('gone', name='matplotlib')\n")
    for arguments, environment, code, expected in (
            ((folder / "none",), {}, 4, f"'{folder}/none' "), ((empty,), {}, 4,
             f"'{empty}' is not a run folder: it has neither a recording (*.h5) nor resolved.json, effective.music, "
             "summary.json, trajectory.csv or world.json; name the folder that `spikeloop run` wrote"),
            ((drive, "--from", "2", "--to", "1"), {}, 2,
             "--from 2 is not before --to 1; exchange them"),
            ((drive, "--from", "soon"), {}, 2, "--from: 'soon' is not a moment of a run; write"),
            ((drive, "--to", "-1"), {}, 2, "--to: '-1' is not a moment of a run; write"),
            ((drive, "--format", "gif"), {}, 2, "--format"),
            ((), {}, 2, "RUN is required"),
            ((drive, "--out", "/proc/none"), {}, 4, "cannot make '/proc/none'"),
            ((drive, "--network", "brian"), {}, 1, "did you mean 'brain'?"),
            ((drive,), {"PYTHON": "/nowhere/python3"}, 3, "python3-matplotlib ... PYTHON "),
            ((drive,), {"PYTHONPATH": str(fake.parent)}, 3,
             "Python's package matplotlib is missing")):
        runs.refused(expected, "plot", *arguments, code=code, env={**os.environ, **environment})


def main():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        drive = an_experiment(folder)
        what_the_pictures_need(folder)
        two_commands(folder, drive)
        a_music_job(folder, drive)
        errors(folder, drive)


if __name__ == "__main__":
    main()
