#!/usr/bin/python3
"""spikeloop.gymnasium_env: an agent in Python in the place of a network, in an environment and in the vehicle."""

import math
import os
import pathlib
import random
import re
import subprocess
import sys
import unittest

import numpy as np

import spikeloop
from explorer import FolderCase
from spikeloop.environment import Box

CAR = """experiment: car
tick: 2 ms
robot: {environment: mountain_car}
nodes:
  car: {node: ros_sensor, topic: /observation, message: std_msgs/Float64MultiArray}
  agent: {simulator: python, script: agent.py}
  action: {node: ros_command, topic: /action, message: std_msgs/Float64MultiArray}
connections:
  - car -> agent.observation [2]
  - agent.value -> action [1]
"""
MAZE = """experiment: maze
tick: 2 ms
robot: {simulator: mujoco, world: t_maze}
episodes: {}
nodes:
  where: {node: ros_sensor, topic: /odom, message: nav_msgs/Odometry,
          fields: [pose.pose.position.x, pose.pose.position.y]}
  spikes: {node: poisson_encoder, rate_min: 100 Hz, rate_max: 100 Hz}
  agent: {simulator: python, script: agent.py}
  wheels: {node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, fields: {linear.x: 0, angular.z: 1}}
connections:
  - where -> agent.where [2]
  - where -> spikes [2] -> agent.spikes [2]
  - agent.value -> wheels [2]
"""
STEPS = 10_000


def car_after(position, velocity, action):
    """Gymnasium's documentation of MountainCar-v0, "Transition Dynamics"; the action is the nearest whole number."""
    velocity += (math.floor(action + 0.5) - 1) * 0.001 - math.cos(3 * position) * 0.0025
    velocity = min(max(velocity, -0.07), 0.07)
    position = min(max(position + velocity, -1.2), 0.6)
    return position, 0.0 if position == -1.2 else velocity


class Agents(FolderCase):
    def setUp(self):
        super().setUp()
        (self.folder / "agent.py").write_text("import spikeloop\nraise RuntimeError('an agent stands for it')\n")

    def file(self, text):
        path = self.folder / "experiment.yaml"
        path.write_text(text)
        return path

    def episodes(self, env, count, seed=None):
        """(observation, reward) of all steps of several episodes, with the same actions every time."""
        generator, found = random.Random(1), []
        for number in range(count):
            found.append((*env.reset(seed=seed if number == 0 else None)[0], 0))
            over = False
            while not over:
                observation, reward, terminated, truncated, _ = env.step(generator.randrange(3))
                found.append((*observation, reward))
                over = terminated or truncated
        return found

    def test_random_steps_equal_the_equations(self):
        """Actions are held for a while, so that some episodes reach the goal."""
        generator, ends, numbers = random.Random(1), {"terminated": 0, "truncated": 0}, []
        largest, state, held = 0, None, 0
        with spikeloop.gymnasium_env(self.file(CAR), action_space=Box(0, 2, (1,))) as env:
            self.assertEqual((env.observation_space.shape, env.action_space.shape), ((2,), (1,)))
            env.action_space.seed(1)
            for _ in range(STEPS):
                if state is None:
                    state, info = env.reset()
                    self.assertTrue(-0.6 <= state[0] <= -0.4 and state[1] == 0, state)
                    self.assertEqual(info["steps"], 0)
                    numbers.append(info["number"])
                    steps = 0
                if held == 0:
                    action, held = env.action_space.sample(), generator.randint(1, 60)
                    self.assertTrue(env.action_space.contains(action), action)
                held -= 1
                observation, reward, terminated, truncated, info = env.step(action)
                state = car_after(*state, float(action[0]))
                self.assertTrue(env.observation_space.contains(observation))
                largest = max(largest, *(abs(a - b) for a, b in zip(observation, state)))
                self.assertLessEqual(largest, 1e-12)
                steps += 1
                goal = state[0] >= 0.5 and state[1] >= 0
                self.assertEqual((reward, terminated, truncated, info["steps"], info["success"]),
                                 (-1, goal, steps == 200 and not goal, steps, goal))
                if terminated or truncated:
                    ends["terminated" if terminated else "truncated"] += 1
                    state = None
        self.assertEqual(numbers, list(range(1, len(numbers) + 1)), "one run")
        self.assertTrue(ends["terminated"] and ends["truncated"], ends)
        print(f"{STEPS} steps, {ends}; largest difference {largest:g}")

    def test_the_seed_makes_the_same_episodes(self):
        with spikeloop.gymnasium_env(self.file(CAR)) as env:
            first = self.episodes(env, 3, seed=5)
            self.assertEqual(self.episodes(env, 3, seed=5), first)
            self.assertNotEqual(self.episodes(env, 3, seed=6), first)
            self.assertNotEqual(self.episodes(env, 3), first, "they go on")
        with spikeloop.gymnasium_env(self.file(CAR), {"seed": 5}) as env:
            self.assertEqual(self.episodes(env, 3), first)
            starts = {tuple(env.reset()[0]) for _ in range(4)}
            self.assertEqual(len(starts), 4, "of the next seeds, because an episode is in progress")

    def test_several_steps_at_once(self):
        """The reward is their sum; the end of an episode is not passed over."""
        with spikeloop.gymnasium_env(self.file(CAR)) as env:
            env.reset()
            one = [env.step(2)[:2] for _ in range(100)]
        with spikeloop.gymnasium_env(self.file(CAR), ticks=70) as env:
            env.reset()
            for number in range(28):
                observation, reward, terminated, truncated, info = env.step(2)
                self.assertEqual((reward, truncated), (-7, False))
                if number * 7 + 6 < len(one):
                    np.testing.assert_array_equal(observation, one[number * 7 + 6][0])
            _, reward, terminated, truncated, info = env.step(2)
            self.assertEqual((reward, terminated, truncated, info["steps"]), (-4, False, True, 200))
            with self.assertRaisesRegex(spikeloop.SpikeloopError, "no episode is in progress; call reset"):
                env.step(2)

    def test_the_end_of_the_run(self):
        """By its duration, and by the number of its episodes; reset() begins another one."""
        for settings, steps in (({"duration": "1 s"}, 50), ({"episodes": {"count": 1, "time_limit": "200 ms"}}, 10)):
            with spikeloop.gymnasium_env(self.file(CAR), settings) as env:
                starts = set()
                for _ in range(3):
                    starts.add(tuple(env.reset()[0]))
                    ends = [env.step(0)[2:4] for _ in range(steps)]
                    self.assertEqual(ends, [(False, False)] * (steps - 1) + [(False, True)])
                self.assertEqual(len(starts), 3)

    def test_the_vehicle_in_the_maze(self):
        """It turns right always, which is right when the cue is there."""
        rewards = []
        with spikeloop.gymnasium_env(self.file(MAZE)) as env:
            self.assertEqual({port: (space.shape, space.dtype) for port, space in env.observation_space.items()},
                             {"where": ((2,), np.float64), "spikes": ((2,), np.int32)})
            for _ in range(6):
                observation, _ = env.reset()
                np.testing.assert_allclose(observation["where"], [0, -2.15], atol=1e-9)
                spikes, steps, total, over = 0, 0, 0, False
                while not over:
                    x, y = observation["where"]
                    observation, reward, terminated, truncated, info = env.step(
                        [0.5, 0 if y < 0.2 or x >= 0.3 else -1.4])
                    self.assertTrue(env.observation_space.contains(observation), observation)
                    spikes, steps, total = spikes + observation["spikes"].sum(), steps + 1, total + reward
                    over = terminated or truncated
                self.assertEqual((terminated, info["success"], info["steps"]), (True, total == 1, steps))
                self.assertLess(abs(spikes / (steps * 0.02 * 2) - 100), 30, "counts of whole steps")
                rewards.append(total)
        self.assertEqual(set(rewards), {-1, 1})
        with spikeloop.gymnasium_env(self.file(MAZE), {"episodes.time_limit": "100 ms"}, ticks=25) as env:
            env.reset()
            self.assertEqual([env.step([0, 0])[1:4] for _ in range(2)], [(0, False, False), (0, False, True)])

    def test_wrong_experiments(self):
        command = "  - agent.value -> action [1]\n"
        relay = "  relay: {simulator: python, script: agent.py}\n  action:"
        maze = MAZE.replace("episodes: {}\n", "")
        for text, arguments, part in (
                (CAR.replace("{simulator: python, script: agent.py}", '{node: function, function: "2 * x0"}')
                 .replace("agent.observation", "agent").replace("agent.value", "agent"), {},
                 "its simulators are: none; write one node as  agent: {simulator: python"),
                (CAR.replace("  action:", relay).replace(command, "  - agent.value -> relay.in [1]\n  - relay.out -> action [1]"),
                 {}, r"its simulators are: agent \(python\), relay \(python\); write one node"),
                (maze, {}, r"the robot has no task, so there is no reward; write .* episodes: \{\}"),
                (CAR.replace("  - car -> agent.observation [2]\n", ""), {}, "nothing comes into 'agent'.* connect a sensor"),
                (CAR.replace("agent.value", "agent.out -> decoder [1]")
                 .replace("  action:", "  decoder: {node: linear_readout, weights: [[1]]}\n  action:"), {},
                 r"those of 'agent' are: agent.out \(spikes\); connect one"),
                (CAR.replace("tick: 2 ms", "tick: 5 ms"), {}, "is 20 ms, 4 ticks, but .* the action on it take 7 ticks; write  tick: 2.5 ms  or"),
                (CAR, {"ticks": 26}, "26 ticks are not a whole number of steps .* each of 10; write  ticks=20"),
                (CAR, {"settings": {"ros": 2}}, "leave  ros  out"),
                (CAR.replace("mountain_car", "mountain_cr"), {}, "'mountain_cr'.* 'mountain_car'")):
            with self.subTest(part), self.assertRaisesRegex(spikeloop.SpikeloopError, part) as caught:
                spikeloop.gymnasium_env(self.file(text), **arguments).close()
            self.assertIn("experiment.yaml", str(caught.exception))
        with spikeloop.gymnasium_env(self.file(CAR)) as env:
            with self.assertRaisesRegex(spikeloop.SpikeloopError, "call reset"):
                env.step(0)
            env.reset()
            with self.assertRaisesRegex(spikeloop.SpikeloopError, "'agent.value' has 1 channels"):
                env.step([0, 1])
            with self.assertRaisesRegex(spikeloop.SpikeloopError, " action 7"):
                env.step(7)
        with self.assertRaisesRegex(spikeloop.SpikeloopError, "closed; make another"):
            env.reset()

    def test_the_example_of_the_page(self):
        """Of docs/many-runs.md: the car reaches the goal in every episode."""
        page = (pathlib.Path(__file__).parents[2] / "docs/many-runs.md").read_text()
        experiment, agent = re.findall(r"```\w+\n(.*?)```", page.partition("### Gymnasium\n")[2], re.DOTALL)[:2]
        (self.folder / "car.yaml").write_text(experiment)
        (self.folder / "agent.py").write_text(agent)
        done = subprocess.run([sys.executable, "agent.py"], cwd=self.folder, capture_output=True, text=True,
                              timeout=100, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertRegex(done.stdout, r"^((\d+) steps, return -\2.0, True\n){3}$")

    def test_gymnasium_is_used_where_it_is(self):
        """With a package of this name that has what is asked of it."""
        package = self.folder / "gymnasium"
        package.mkdir()
        (package / "__init__.py").write_text(
            "class Env:\n    def reset(self, *, seed=None, options=None):\n        self.seeds = seed\n")
        (package / "spaces.py").write_text(
            "class Box:\n    def __init__(self, low, high, shape, dtype=None):\n        self.dtype = dtype\n"
            "class Dict(dict): pass\n")
        done = subprocess.run(
            [sys.executable, "-c", "import gymnasium, numpy, spikeloop, sys\n"
             "with spikeloop.gymnasium_env(sys.argv[1]) as env:\n"
             "    env.reset(seed=4)\n"
             "    assert isinstance(env, gymnasium.Env) and env.seeds == 4\n"
             "    for space in (env.action_space, env.observation_space):\n"
             "        assert type(space) is gymnasium.spaces.Box and space.dtype is numpy.float64\n", self.file(CAR)],
            env={**os.environ, "PYTHONPATH": f"{self.folder}:{os.environ['PYTHONPATH']}"}, capture_output=True,
            text=True, timeout=100, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
