#!/usr/bin/python3
"""An environment in Python as the robot of an experiment: the same steps as the object makes alone, its spaces, its
episodes, its errors; a run folder has its file and is replayed."""

import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

import runs

WALK = '''import types
import numpy as np


class Walk:
    """Swings around 0, until it is too far out or 25 steps are over."""

    observation_space = types.SimpleNamespace(low=np.array([-1.0, -0.5]), high=np.array([1.0, 0.5]), shape=(2,))
    action_space = types.SimpleNamespace(n=3, start=-1)

    def reset(self, seed=None, options=None):
        self.state, self.steps = np.array([np.random.default_rng(seed).uniform(-0.5, 0.5), 0.0]), 0
        return self.state, {}

    def step(self, action):
        x, v = self.state
        v = min(max(v + 0.02 * action - 0.1 * x, -0.5), 0.5)
        self.state, self.steps = np.array([x + v, v]), self.steps + 1
        out = abs(x + v) >= 1
        return self.state, x + v, out, self.steps >= 25, {"success": x + v >= 1}


class Corridor:
    """Five fields; the action is the width of a stride, and goes on without end."""

    observation_space = types.SimpleNamespace(n=5)
    action_space = types.SimpleNamespace(low=np.array([0.0]), high=np.array([np.inf]), shape=(1,), dtype=np.float32)
    spec = types.SimpleNamespace(max_episode_steps=7)

    def reset(self, seed=None, options=None):
        self.field = 0
        return 0, {}

    def step(self, action):
        assert action.shape == (1,) and action.dtype == np.float32
        self.field = (self.field + int(action[0])) % 5
        return self.field, 1, False, False, {}


class Free(Corridor):
    observation_space = types.SimpleNamespace(low=-np.inf, high=np.inf, shape=(1, 2))

    def reset(self, seed=None, options=None):
        return np.zeros((1, 2)), {}

    def step(self, action):
        raise RuntimeError("the floor has gone")


class Wide(Free):
    def reset(self, seed=None, options=None):
        return np.zeros(3), {}


class Several(Walk):
    action_space = types.SimpleNamespace(low=-np.ones(2), high=np.ones(2), shape=(2,))
'''
TEXT = """experiment: walk
duration: 60 s
tick: 10 ms
sync: lockstep
robot: {environment: "walk.py:Walk"}
episodes: {count: 6}
nodes:
  where: {node: ros_sensor, topic: /observation, message: std_msgs/Float64MultiArray}
  scaled: {node: ros_sensor, topic: /scaled_observation, message: std_msgs/Float64MultiArray}
  episode: {node: ros_sensor, topic: /episode, message: std_msgs/Float64MultiArray}
  push: {node: function, function: "x1 >= 0 ? 2 : 0"}
  action: {node: ros_command, topic: /action, message: std_msgs/Float64MultiArray}
connections:
  - where -> push [2] -> action [1]
"""
ONE = """experiment: one
duration: 2 s
tick: 10 ms
sync: lockstep
robot: {environment: "walk.py:Corridor", step: 30 ms}
nodes:
  where: {node: ros_sensor, topic: /observation, message: std_msgs/Float64MultiArray}
  stride: {node: function, function: "2 + 0 * x0"}
  action: {node: ros_command, topic: /action, message: std_msgs/Float64MultiArray}
connections:
  - where -> stride [WIDTH] -> action [1]
"""


def walk_of(folder):
    spec = importlib.util.spec_from_file_location("walk", folder / "walk.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.Walk()


def signal(folder, node):
    return runs.recordings.signal(folder, node)[1]


def rows(folder):
    return runs.recordings.table(folder / "episodes.csv")


def check_steps(folder):
    """What the object makes alone, with the seeds and the actions of the run."""
    summary, _ = runs.run(folder / "walk.yaml", folder / "run")
    found, walk = rows(folder / "run"), walk_of(folder)
    assert len(found) == 6 == summary["episodes"], summary
    states, where, scaled = (signal(folder / "run", node) for node in ("episode", "where", "scaled"))
    np.testing.assert_allclose(scaled, where / [1, 0.5], rtol=0, atol=1e-15)
    for number, row in enumerate(found, 1):
        running = np.flatnonzero((states[:, 0] == number) & (states[:, 1] == 1))
        begin = running[states[running, 2] == 0][-1]  # the first episode waits for its first action
        state, _ = walk.reset(seed=int(np.random.SeedSequence((1, number)).generate_state(1)[0]))
        path, total, over = [state], 0, False
        while not over:
            state, reward, terminated, truncated, info = walk.step(1 if state[1] >= 0 else -1)
            path, total, over = [*path, state], total + reward, terminated or truncated
        np.testing.assert_array_equal(where[begin:begin + len(path)], path)
        assert (int(row["steps"]), row["end"]) == (len(path) - 1, "terminated" if terminated else "time_limit"), row
        assert float(row["return"]) == total and int(row["success"]) == info["success"], (row, total, info)
    assert {row["end"] for row in found} == {"terminated", "time_limit"}, found
    assert {row["success"] for row in found} == {"0", "1"}, found


def check_repetition(folder):
    runs.run(folder / "walk.yaml", folder / "again")
    assert runs.fingerprint(folder / "again") == runs.fingerprint(folder / "run")
    runs.run(folder / "walk.yaml", folder / "other", "--seed", "2")
    assert runs.fingerprint(folder / "other") != runs.fingerprint(folder / "run")
    assert (folder / "run/experiment-files/walk.py").read_text() == WALK
    elsewhere = folder / "elsewhere"
    (folder / "run").rename(elsewhere)
    for command in ("replay", "run"):
        runs.spikeloop(command, elsewhere, "--out", folder / command)


def check_spaces(folder):
    """Box(1) actions, a Discrete observation, the limit of the object's spec."""
    (folder / "one.yaml").write_text(ONE.replace("WIDTH", "1"))
    summary, _ = runs.run(folder / "one.yaml", folder / "one")
    where = signal(folder / "one", "where")[:, 0]
    assert set(where) == {0, 1, 2, 3, 4} and set(np.diff(where[3:7]) % 5) == {2}, where
    first = rows(folder / "one")[0]
    assert summary["episodes"] > 1 and (first["steps"], first["return"], first["end"]) == ("7", "7", "time_limit"), first


def check_gymnasium(folder):
    """With a package of this name that has what is asked of it."""
    (folder / "have").mkdir()
    (folder / "have/gymnasium.py").write_text(
        "import walk\ndef make(name):\n    return {'Corridor-v1': walk.Corridor}[name]()\n")
    runs.spikeloop("run", folder / "one.yaml", "--out", folder / "gymnasium", "--set",
                   "robot.environment=gymnasium:Corridor-v1",
                   env={**os.environ, "PYTHONPATH": f"{folder / 'have'}:{folder}"})
    np.testing.assert_array_equal(signal(folder / "gymnasium", "where"), signal(folder / "one", "where"))


def check_errors(folder):
    def said(command, *settings):
        (folder / "one.yaml").write_text(ONE.replace("WIDTH", "2"))
        words = [word for setting in settings for word in ("--set", setting)]
        done = subprocess.run([runs.SPIKELOOP, *command, str(folder / "one.yaml"), *words],
                              capture_output=True, text=True, check=False, timeout=100, env={**os.environ, "PYTHONPATH": str(folder / "none")})
        return done.returncode, done.stderr

    (folder / "none").mkdir()
    (folder / "none/gymnasium.py").write_text("raise ImportError('this one is none')\n")
    for environment, part in (
            ("wlk.py:Walk", "wlk.py ... [SL0108]"),
            ("walk.py:Wlak", "'Wlak' ... walk.py"),
            ("walk.py", "write  FILE.py:FUNCTION"),
            ("walk:Walk", "write  FILE.py:FUNCTION"),
            ("gymnasium:CartPole-v1", "cannot import gymnasium (this one is none); make a virtual environment"),
            ("walk.py:Several", "there can be one action"),
            ("walk.py:types", "'types' ... walk.py"),
            ("walk.py:Wide", "an observation has 3 numbers, but its space has 2")):
        code, text = said(["check"], f"robot.environment={environment}")
        assert code != 0 and "one.yaml" in text, (environment, code, text)
        runs.assert_says(text, part)
    code, text = said(["check"], "robot.environment=walk.py:Free", "where.topic=/scaled_observation")
    assert code == 2, (code, text)
    runs.assert_says(text, "/scaled_observation ... [SL0507]")
    code, text = said(["run", "--out", str(folder / "failed")], "robot.environment=walk.py:Free")
    assert code == 5 and "walk.py:47: in step: RuntimeError: the floor has gone [SL0704]" in text, (code, text)
    assert 'raise RuntimeError("the floor has gone")' in text, "the traceback's lines"
    spy = folder / "ran"
    (folder / "walk.py").write_text(f"import pathlib\npathlib.Path({str(spy)!r}).touch()\n")
    code, text = said(["check", "--no-code"])
    assert code == 0 and "walk.py:Corridor' is code" in text and not spy.exists(), text
    said(["check"])
    assert spy.exists()


def check_python(folder):
    """In the process of a caller, who has an interpreter of his own already."""
    (folder / "walk.py").write_text(WALK)
    (folder / "agent.py").write_text("import spikeloop\n")
    text = TEXT.replace('{node: function, function: "x1 >= 0 ? 2 : 0"}', "{simulator: python, script: agent.py}")
    (folder / "agent.yaml").write_text(text.replace("tick: 10 ms", "tick: 2 ms").replace(
        "where -> push [2] -> action [1]", "where -> push.where [2]\n  - push.value -> action [1]"))
    program = ("import spikeloop\n"
               "with spikeloop.gymnasium_env('agent.yaml') as env:\n"
               "    for _ in range(3):\n"
               "        over, (observation, _) = False, env.reset()\n"
               "        while not over:\n"
               "            observation, _, terminated, truncated, info = env.step(2 if observation[1] >= 0 else 0)\n"
               "            over = terminated or truncated\n"
               "        print(info['steps'])\n")
    package = runs.programs().parent / "share/spikeloop/python"
    done = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, check=False,
                          timeout=100, env={**os.environ, "PYTHONPATH": str(package)})
    assert done.stdout.split() == [row["steps"] for row in rows(folder / "again")[:3]], (done.stdout, done.stderr)


def main():
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        (folder / "walk.py").write_text(WALK)
        (folder / "walk.yaml").write_text(TEXT)
        for check in (check_steps, check_repetition, check_spaces, check_gymnasium, check_errors, check_python):
            check(folder)
            print(f"{check.__name__}: good")
    return 0


if __name__ == "__main__":
    sys.exit(main())
