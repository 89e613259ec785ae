#!/usr/bin/python3
"""Episodes of a run: an environment against the published equations, step by step, from what the run recorded;
rewards, pauses and ends; the vehicle in a T-maze and on a lane. The same seed gives the same bits; a run folder is replayed."""

import json
import math
import pathlib
import sys
import tempfile

import h5py
import numpy as np

import runs

CAR = """experiment: car
duration: 200 s
tick: 10 ms
sync: lockstep
robot: {environment: mountain_car}
episodes: {count: 4, time_limit: 3 s, hold: 30 ms, pause: 90 ms, pause_observation: 9999, begin_reward: -2, end_reward: -0.4}
nodes:
  car: {node: ros_sensor, topic: /observation, message: std_msgs/Float64MultiArray}
  reward: {node: ros_sensor, topic: /reward, message: std_msgs/Float64MultiArray}
  episode: {node: ros_sensor, topic: /episode, message: std_msgs/Float64MultiArray}
  push: {node: function, function: "x1 > 0 ? 2 : 0"}
  action: {node: ros_command, topic: /action, message: std_msgs/Float64MultiArray}
connections:
  - car -> push [2] -> action [1]
"""
MAZE = """experiment: maze
duration: 100 s
tick: 2 ms
sync: lockstep
robot: {simulator: mujoco, world: t_maze}
episodes: {count: 6, time_limit: 9 s, pause: 100 ms}
nodes:
  where: {node: ros_sensor, topic: /odom, message: nav_msgs/Odometry,
          fields: [pose.pose.position.x, pose.pose.position.y]}
  scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}
  episode: {node: ros_sensor, topic: /episode, message: std_msgs/Float64MultiArray}
  reward: {node: ros_sensor, topic: /reward, message: std_msgs/Float64MultiArray}
  right: {node: function, function: "0.5; x1 < 0.2 ? 0 : x0 < 0.3 ? -1.4 : 0"}
  wheels: {node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, fields: {linear.x: 0, angular.z: 1}}
connections:
  - where -> right [2] -> wheels [2]
"""
# Straight on, until the lane ends, or for 3 s.
LANE = """experiment: lane
tick: 2 ms
sync: lockstep
robot: {simulator: mujoco, world: lane.xml}
episodes: {count: 5, time_limit: 3 s, pause: 100 ms}
nodes:
  where: {node: ros_sensor, topic: /odom, message: nav_msgs/Odometry,
          fields: [pose.pose.position.x, pose.pose.position.y, pose.pose.orientation.z, pose.pose.orientation.w]}
  lane: {node: ros_sensor, topic: /lane, message: std_msgs/Float64MultiArray}
  reward: {node: ros_sensor, topic: /reward, message: std_msgs/Float64MultiArray}
  episode: {node: ros_sensor, topic: /episode, message: std_msgs/Float64MultiArray}
  on: {node: function, function: "0.5; 0"}
  wheels: {node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, fields: {linear.x: 0, angular.z: 1}}
connections:
  - where -> on [4] -> wheels [2]
"""
LANE_BOXES = [(0, -1.5, 1.2, 0.2, 0), (1.7, -1.0, 0.7, 0.2, 45), (-1.7, -1.0, 0.2, 0.7, 45), (0, 0.5, 0.25, 1.9, 100)]
LANE_WORLD = """<mujoco>
  <include file="spikeloop_vehicle.xml"/>
  <custom><numeric name="arena" data="-4 -4 4 4"/></custom>
  <worldbody>
    <geom name="floor" type="plane" size="9 9 0.1"/>
    BOXES
  </worldbody>
</mujoco>
"""
# Down from the start of the lake: 4, 8, and a hole.
LAKE = """experiment: lake
tick: 20 ms
sync: lockstep
robot: {environment: frozen_lake, step: 100 ms}
episodes: {count: 6, pause: 40 ms, reset: [brain]}
nodes:
  field: {node: ros_sensor, topic: /observation, message: std_msgs/Float64MultiArray}
  down: {node: function, function: "1"}
  brain:
    simulator: builtin
    network:
      resolution: 1 ms
      populations:
        field: {model: signal_input, size: 1}
        slow: {model: lin_rate_ipn, size: 1, parameters: {tau: 100 ms, lambda: 0, mu: 0.1, sigma: 0}}
        one: {model: lin_rate_ipn, size: 1, parameters: {tau: 1 ms, mu: 0.001, sigma: 0}}
        cell: {model: iaf_psc_exp, size: 2, parameters: {I_e: 380 pA}}
        rain: {model: poisson, size: 1, parameters: {rate: 100 Hz}}
      connections:
        - {from: field, to: slow, rule: all_to_all, weight: 0.01}
        - {from: one, to: slow, rule: all_to_all, weight: 0, delay: 1 ms,
           plasticity: {rule: reward_hebbian, reward: one, A: 1, save: w.npy}}
        - {from: cell, to: cell, rule: pairs, pairs: [[0, 1]], weight: 900 pA, delay: 7 ms}
      rates: [slow]
      output: [cell, rain]
      potential: [cell]
  move: {node: ros_command, topic: /action, message: std_msgs/Float64MultiArray}
connections:
  - field -> down [1] -> move [1]
  - field -> brain.signal [1]
"""
# The same way, and nodes with a state.
NODES = """experiment: nodes
tick: 5 ms
sync: lockstep
robot: {environment: frozen_lake, step: 100 ms}
episodes: {count: 4, pause: 40 ms, reset: all}
nodes:
  field: {node: ros_sensor, topic: /observation, message: std_msgs/Float64MultiArray}
  down: {node: function, function: "1"}
  move: {node: ros_command, topic: /action, message: std_msgs/Float64MultiArray}
  scaled: {node: function, function: "0.11*x0 - 0.7"}
  phase: {node: rate_encoder, rate_max: 370 Hz, initial_phase: random}
  rate: {node: linear_readout, tau: 90 ms, weights: uniform}
  smooth: {node: low_pass, tau: 130 ms}
  steps: {node: step_forward_encoder, threshold: 3, min_interval: 7 ms}
  sum: {node: rate_window, window: 60 ms}
  rain: {node: poisson_encoder, rate_max: 500 Hz}
connections:
  - field -> down [1] -> move [1]
  - field -> scaled [1] -> phase [1] -> rate [1, delay 2 ticks] -> smooth [1] -> steps [1] -> sum [2]
  - scaled -> rain [1]
"""
GAIN = """import spikeloop


@spikeloop.node(inputs={"in": "signal"}, outputs={"out": "signal"}, text=spikeloop.Parameter("", text="Nothing"))
def gain(step, text):
    \"\"\"Does nothing\"\"\"
"""
STEP_S = 0.02
LIMIT = 150  # steps in 3 s


def signal(folder, node):
    times_ns, values = runs.recordings.signal(folder, node)
    return times_ns * 1e-9, values


def rows(folder):
    return runs.recordings.table(folder / "episodes.csv")


def car_after(position, velocity, push):
    """Moore 1990, as Gymnasium's MountainCar-v0 has it."""
    velocity = min(max(velocity + 0.001 * (push - 1) - 0.0025 * math.cos(3 * position), -0.07), 0.07)
    position = min(max(position + velocity, -1.2), 0.6)
    return position, 0 if position == -1.2 and velocity < 0 else velocity


def drive(position):
    """An episode with the rule of the experiment; its push arrives within the step."""
    velocity, path = 0, []
    while len(path) < LIMIT and position < 0.5:
        position, velocity = car_after(position, velocity, 2 if velocity > 0 else 0)
        path.append((position, velocity))
    return path


def check_car(folder):
    (folder / "car.yaml").write_text(CAR)
    (folder / "push.py").write_text("import spikeloop\n")
    summary, _ = runs.run(folder / "car.yaml", folder / "one")
    found = rows(folder / "one")
    assert len(found) == 4 == summary["episodes"] and summary["exit_reason"] == "finished", summary
    times, states = signal(folder / "one", "episode")
    _, car = signal(folder / "one", "car")
    _, rewards = signal(folder / "one", "reward")
    ends = 0
    for number, row in enumerate(found, 1):
        mine = np.flatnonzero(states[:, 0] == number)
        running, pause = mine[states[mine, 1] == 1], mine[states[mine, 1] == 0]
        steps = int(row["steps"])
        begin = running[states[running, 2] == 0][-1]  # the first episode waits for its first action
        start = car[begin]
        assert -0.6 <= start[0] <= -0.4 and start[1] == 0, start
        path = drive(start[0])
        assert steps == len(path), (row, len(path))
        np.testing.assert_allclose(car[begin + 1:begin + steps + 1], path, rtol=0, atol=1e-12)
        assert float(row["return"]) == -steps, row
        assert row["end"] == ("terminated" if steps < LIMIT else "time_limit"), row
        assert (row["success"] == "1") == (path[-1][0] >= 0.5), row
        assert rewards[begin, 0] == -2 and set(rewards[begin + 1:begin + steps, 0]) == {-1}
        if number < 4:
            held = pause[:2]  # 30 ms are two steps, 90 ms five
            assert np.all(rewards[held] == -0.4) and np.all(rewards[pause[2:]] == -2)
            assert np.all(car[pause[2:]] == 9999)
            length = times[pause[-1] + 1] - times[pause[0]]
            assert abs(length - 0.12) < 1e-9, f"the first step after 30 ms and 90 ms, not {length} s"
        ends += row["end"] == "terminated"
    assert summary["successes"] == ends > 0, (summary, ends)
    assert len({row["begin_s"] for row in found}) == 4


def check_repetition(folder):
    """The seed decides; a finer tick changes when a push arrives, and nothing else of the task."""
    runs.run(folder / "car.yaml", folder / "again")
    assert runs.fingerprint(folder / "again") == runs.fingerprint(folder / "one")
    runs.run(folder / "car.yaml", folder / "other", "--seed", "2")
    assert runs.fingerprint(folder / "other") != runs.fingerprint(folder / "one")
    runs.spikeloop("replay", folder / "one", "--out", folder / "replay")
    resolved = json.loads((folder / "one" / "resolved.json").read_text())
    assert resolved["robot"]["environment"] == "mountain_car", resolved["robot"]
    assert resolved["episodes"]["pause_ns"] == 90_000_000, resolved["episodes"]


def check_maze(folder):
    """A vehicle that always turns right: right when the cue is there."""
    (folder / "maze.yaml").write_text(MAZE)
    summary, _ = runs.run(folder / "maze.yaml", folder / "maze")
    found = rows(folder / "maze")
    assert len(found) == 6 == summary["episodes"], summary
    assert {row["return"] for row in found} == {"1", "-1"}, found
    assert all(row["end"] == "terminated" for row in found), found
    assert sum(row["success"] == "1" for row in found) == summary["successes"], summary
    # Every episode begins at the same place, with the same scan where the lamp is on the same side.
    times, where = signal(folder / "maze", "where")
    _, rewards = signal(folder / "maze", "reward")
    scanned, _ = signal(folder / "maze", "scan")
    for row in found[1:]:
        begin = np.searchsorted(times, float(row["begin_s"]) + 0.002)
        assert np.allclose(where[begin], [0, -2.15], atol=1e-9), where[begin]
        # What is seen is the new world, also between two periods of the laser.
        first = np.searchsorted(scanned, float(row["begin_s"]) + 0.002)
        assert scanned[first] - float(row["begin_s"]) < 0.003, scanned[first]
    assert set(rewards[:, 0]) == {-1, 0, 1}
    # A command that nobody repeats holds in the next episode, too.
    once, _ = runs.run(folder / "maze.yaml", folder / "once", "--set", "wheels.command_rate=0 Hz")
    assert [row["success"] for row in rows(folder / "once")] == [row["success"] for row in found], once
    short, _ = runs.run(folder / "maze.yaml", folder / "short", "--set", "episodes.time_limit=1 s")
    assert short["episodes"] == 6 and short["successes"] == 0, short
    assert {(row["end"], row["steps"]) for row in rows(folder / "short")} == {("time_limit", "50")}


def check_goal_and_collision(folder):
    """The same path is right or wrong, as the named goal says; straight on it ends at the wall."""
    for goal, value in (("goal_right", 1), ("goal_left", -1)):
        runs.run(folder / "maze.yaml", folder / goal, "--set", f"episodes.goal={goal}",
                 "--set", "episodes.collision_reward=-0.5")
        assert {(row["return"], row["success"]) for row in rows(folder / goal)} == {(str(value), str(max(value, 0)))}
    runs.run(folder / "maze.yaml", folder / "wall", "--set", "right.function=0.5; 0",
             "--set", "episodes.collision_reward=-0.5", "--set", "episodes.pause=40 ms")
    found = rows(folder / "wall")
    assert {(row["return"], row["success"], row["end"]) for row in found} == {("-0.5", "0", "terminated")}, found
    # From -2.15 m at 0.5 m/s after 0.125 s of acceleration; the front is 0.2 m before the centre.
    expected = (2.15 + 1 - 0.2) / 0.5 + 0.125 / 2
    assert len({row["steps"] for row in found}) == 1 and abs(0.02 * int(found[0]["steps"]) - expected) < 0.15, found
    _, rewards = signal(folder / "wall", "reward")
    assert set(rewards[:, 0]) == {0, -0.5}
    for setting, part in (("episodes.goal=goal_middle", "no goal 'goal_middle'; write one of: goal_left, goal_right"),
                          ("robot.world=arena", "no goal 'goal_left'; leave  goal  out")):
        runs.refused(part, "check", folder / "maze.yaml", "--set", "episodes.goal=goal_left", "--set", setting)


def lane_of(position, heading):
    """Distance, angle and half width at a point and a heading, complex numbers, of the nearest box of LANE_BOXES."""
    found = []
    for x, y, half_x, half_y, degrees in LANE_BOXES:
        along = np.exp(1j * np.radians(degrees)) * (1 if half_x > half_y else 1j)
        along *= 1 if (heading / along).real >= 0 else -1
        at = (position - complex(x, y)) / along
        beside = at - np.clip(at.real, -max(half_x, half_y), max(half_x, half_y))
        side = 1 if at.imag > 0 else -1
        found.append((abs(beside), side * abs(beside), np.angle(heading / along), min(half_x, half_y)))
    return min(found)[1:]


def check_lane(folder):
    """A vehicle that drives straight on: distance, reward and end of every step from its odometry."""
    boxes = [f'<geom name="lane_{i}" type="box" size="{a} {b} 0.002" pos="{x} {y} 0.002" euler="0 0 {turn}" '
             'contype="0" conaffinity="0"/>' for i, (x, y, a, b, turn) in enumerate(LANE_BOXES)]
    (folder / "lane.xml").write_text(LANE_WORLD.replace("BOXES", "\n".join(boxes)))
    (folder / "lane.yaml").write_text(LANE)
    summary, _ = runs.run(folder / "lane.yaml", folder / "lane")
    found = rows(folder / "lane")
    assert len(found) == 5 == summary["episodes"], summary
    times, where = signal(folder / "lane", "where")
    lane_times, lane = signal(folder / "lane", "lane")
    _, rewards = signal(folder / "lane", "reward")
    _, states = signal(folder / "lane", "episode")
    assert np.array_equal(times, lane_times) and len(lane) == len(rewards) == len(states)
    expected = np.array([lane_of(complex(*row[:2]), complex(row[3], row[2]) ** 2) for row in where])
    np.testing.assert_allclose(lane, expected[:, :2], rtol=0, atol=1e-9)
    part = np.abs(expected[:, 0]) / expected[:, 2]
    stepped = (states[:, 1] == 1) & (states[:, 2] > 0)
    np.testing.assert_allclose(rewards[stepped, 0], 1 - part[stepped], rtol=0, atol=1e-9)
    assert np.all(part[stepped] <= 1)
    ends = set()
    for number, row in enumerate(found, 1):
        mine = (states[:, 0] == number) & (states[:, 2] > 0)
        last = np.flatnonzero(mine & (states[:, 1] == 0))[0]
        assert row["end"] == ("terminated" if part[last] > 1 else "time_limit"), (row, part[last])
        assert row["success"] == ("0" if part[last] > 1 else "1"), row
        total = rewards[mine & stepped, 0].sum() + max(0, 1 - part[last])
        assert abs(float(row["return"]) - total) < 1e-6, (row, total)
        ends.add(row["end"])
    assert ends == {"terminated", "time_limit"}, found
    starts = {tuple(where[np.searchsorted(times, float(row["begin_s"]))]) for row in found}
    assert len(starts) == 5, starts
    off = (folder / "lane.xml").read_text().replace("</custom>", '<numeric name="start" data="0 -3 0"/></custom>')
    (folder / "lane.xml").write_text(off)
    runs.refused("lane.xml: numeric 'start' = (0, -3) is not on a lane", "run", folder / "lane.yaml", "--out",
                 folder / "off")


def check_reset(folder):
    """A network begins every episode as the first one, but for its weights; its noise goes on."""
    (folder / "lake.yaml").write_text(LAKE)
    runs.run(folder / "lake.yaml", folder / "reset")
    (folder / "on.yaml").write_text(LAKE.replace(", reset: [brain]", ""))
    runs.run(folder / "on.yaml", folder / "goes_on")
    begins = [round(float(row["begin_s"]) * 1e9) for row in rows(folder / "reset")][1:]
    assert len(begins) == 5, begins
    length = begins[1] - begins[0]
    times, channels = runs.recordings.spikes(folder / "reset", "brain")
    with h5py.File(folder / "reset" / "brain.h5") as file:
        at = file["signals/potential/times_ns"][:]
        membranes = file["signals/potential/values"][:]
        slow = file["signals/rates/values"][:, 0]
    seen = []
    for begin in begins[:-1]:
        rows_in = (at > begin) & (at <= begin + length)
        cells = (times > begin) & (times <= begin + length) & (channels < 2)
        seen.append((membranes[rows_in].tobytes(), list(zip(times[cells] - begin, channels[cells]))))
    assert len(seen[0][1]) > 10 and all(one == seen[0] for one in seen[1:]), "every episode is the same"
    # The same to the bit as a network that has just been made, which sees the start a tick later.
    first = (times > 0) & (times <= length) & (channels < 2)
    assert list(zip(times[first], channels[first])) == seen[0][1]
    assert membranes[at <= length].tobytes() == seen[0][0]
    weight = np.load(folder / "reset" / "brain.w.npy")[0, 0]
    gone_on = np.load(folder / "goes_on" / "brain.w.npy")[0, 0]
    assert weight > 1e-3 and abs(weight - gone_on) < 0.05 * weight, (weight, gone_on)  # it is learned all the time
    assert slow.max() < 0.2 * signal_max(folder / "goes_on"), "the slow neuron grows for one episode"
    runs.refused("experiment.yaml:5:11: key 'episodes': ... spikeloop run FOLDER [SL0208]", "replay", folder / "reset",
                 "--out", folder / "no")
    rain = times[channels == 2]
    mean = 100e-9 * at[-1]
    assert abs(len(rain) - mean) < 5 * mean ** 0.5 and np.unique(rain, return_counts=True)[1].max() < 5, len(rain)


def recorded(folder, node, begin, length):
    """Of a time, that counts from its begin: what the node's file has."""
    with h5py.File(folder / f"{node}.h5") as file:
        group = file["spikes/out"] if "spikes/out" in file else file["signals/out"]
        times, values = (group[name][:] for name in
                         (("timestamps_ns", "node_ids") if "node_ids" in group else ("times_ns", "values")))
    part = (times > begin) & (times <= begin + length)
    return (times[part] - begin).tolist(), values[part].tobytes()


def check_reset_of_nodes(folder):
    """After the reset nodes do what they did at the begin of the run, to the bit; Poisson spikes are others."""
    (folder / "nodes.yaml").write_text(NODES)
    runs.run(folder / "nodes.yaml", folder / "anew")
    runs.run(folder / "nodes.yaml", folder / "on", "--set", "episodes={count: 4, pause: 40 ms}")
    begins = [round(float(row["begin_s"]) * 1e9) for row in rows(folder / "anew")]
    length = begins[2] - begins[1]
    for node in ("scaled", "phase", "rate", "smooth", "steps", "sum"):
        first = recorded(folder / "anew", node, 0, length)
        assert len(first[0]) > 4, (node, first)
        for begin in begins[1:3]:
            assert recorded(folder / "anew", node, begin, length) == first, (node, begin)
        if node != "scaled":
            assert recorded(folder / "on", node, begins[1], length) != first, node
    rain = [recorded(folder / "anew", "rain", begin, length) for begin in (0, *begins[1:3])]
    assert len(rain[0][0]) > 20 and rain[0] != rain[1] != rain[2], rain
    resolved = json.loads((folder / "anew" / "resolved.json").read_text())
    assert set(resolved["episodes"]["reset"]) == {"down", "scaled", "phase", "rate", "smooth", "steps", "sum", "rain"}


def check_cart_pole(folder):
    """What `spikeloop new` prints balances the pole."""
    (folder / "pole.yaml").write_text(runs.spikeloop("new", "--environment", "cart_pole")[0])
    summary, _ = runs.run(folder / "pole.yaml", folder / "pole")
    assert summary["episodes"] == summary["successes"] == 20, summary
    text = (folder / "pole.yaml").read_text()
    assert text.count("-> push [1]") == 1, text
    (folder / "anew.yaml").write_text(text.replace("-> push [1]", "-> push [1, delay 1 tick]"))
    summary, _ = runs.run(folder / "anew.yaml", folder / "pole_anew", "--set",
                          "episodes={count: 5, time_limit: 1 s, reset: all}")
    assert summary["episodes"] == 5 and summary["stopped_s"] == 0, "no value after a reset is no stop: " + str(summary)


def signal_max(folder):
    with h5py.File(folder / "brain.h5") as file:
        return file["signals/rates/values"][:].max()


def check_errors(folder):
    """What check says."""
    (folder / "arm.xml").write_text('<mujoco><worldbody><body><joint name="j"/><geom size="1"/></body></worldbody></mujoco>')
    for setting, part in (
            ("robot.environment=mountain_cr", "'mountain_cr' ... 'mountain_car'? ... [SL0205]"),
            ("robot.step=15 ms", "a step of the environment, 15 ms, ... 10 ms ... [SL0207]"),
            ("robot.world=arena", "key 'world' is for a robot in MuJoCo"),
            ("robot.slippery=true", "key 'slippery' is for frozen_lake"),
            ("ros=2", "an environment has no topics of ROS"),
            ("car.topic=/scan", "/scan ... [SL0507]"),
            ("push={simulator: python, script: push.py}", "count and reset are for a run of one process"),
            ("episodes.reset=[action]", "node 'action' cannot begin anew, because it is an output of the experiment"),
            ("episodes.reset=[car]", "node 'car' cannot begin anew, because it is an input of the experiment"),
            ("episodes.reset=[push, push]", "node 'push' is listed twice"),
            ("episodes.reset=[all, push]", "'all' stands alone; write  reset: all"),
            ("episodes.reset=[pusch]", "'pusch' ... 'push'? ... [SL0301]"),
            ("robot={simulator: mujoco, model: arm.xml}", "only the vehicle and environments have episodes"),
            ("robot={simulator: mujoco}", "pause_observation is for an environment"),
            ("episodes.collision_reward=-1", "collision_reward and goal are for the vehicle"),
            ("episodes.count=0", "count")):
        runs.refused(part, "check", folder / "car.yaml", "--set", setting)
    (folder / "gain.py").write_text(GAIN)
    (folder / "gain.yaml").write_text(CAR.replace("reward: -0.4", "reward: -0.4, reset: [push]")
                                      .replace("node: function, function", "node: gain, text")
                                      .replace("nodes:", "plugins: [gain.py]\nnodes:"))
    runs.refused("node 'push' cannot begin anew, because plug-ins have a state of their own",
                 "check", folder / "gain.yaml")
    for options, part in ((["--render", "x.png"], "--render ... robot"),
                          (["--ros", "2"], "an environment has no topics of ROS")):
        runs.refused(part, "run", folder / "car.yaml", "--out", folder / "none", *options)
    runs.refused("write one of: cart_pole, frozen_lake, lane, mountain_car, t_maze, water_maze", "new", "--environment",
                 "cart_pol")
    (folder / "wrong.yaml").write_text(CAR.replace("x1 > 0 ? 2 : 0", "7"))
    runs.refused("'mountain_car': ... action 7; ... 0 ... 2 [SL0203]", "run", folder / "wrong.yaml", "--out",
                 folder / "wrong")


def main():
    with tempfile.TemporaryDirectory() as temporary:
        for check in (check_car, check_repetition, check_maze, check_goal_and_collision, check_lane, check_reset,
                      check_reset_of_nodes, check_cart_pole, check_errors):
            check(pathlib.Path(temporary))
            print(f"{check.__name__}: good")
    return 0


if __name__ == "__main__":
    sys.exit(main())
