"""An experiment's robot and codecs as an environment with Gymnasium's interface.

    import spikeloop

    with spikeloop.gymnasium_env("car.yaml") as env:
        observation, info = env.reset(seed=1)
        observation, reward, terminated, truncated, info = env.step([2])

The agent stands for the node that is written as `simulator: python`. Gymnasium is used where it can be imported,
and is not needed.
"""

import itertools

import numpy as np

from .experiment import Experiment
from .run_folder import SpikeloopError

try:
    from gymnasium import Env
    from gymnasium.spaces import Box, Dict
except ImportError:
    Env = object

    class Box:
        """Arrays of this shape, each value from low to high; as gymnasium.spaces.Box."""

        def __init__(self, low, high, shape, dtype=np.float32):
            self.shape, self.dtype = tuple(shape), np.dtype(dtype)
            self.low, self.high = np.full(shape, low, dtype), np.full(shape, high, dtype)
            self.seed(None)

        def seed(self, seed=None):
            self._random = np.random.default_rng(seed)

        def sample(self):
            """Uniform between bounds, exponential from the only bound, normal without one."""
            low, high = self.low.astype(float), self.high.astype(float)
            below, above = np.isfinite(low), np.isfinite(high)
            values = self._random.normal(size=self.shape)
            away = self._random.exponential(size=self.shape)
            values = np.where(below & ~above, low + away, np.where(above & ~below, high - away, values))
            both = below & above
            whole = self.dtype.kind in "iu"
            values[both] = self._random.uniform(low[both], high[both] + whole)
            return np.clip(np.floor(values) if whole else values, low, high).astype(self.dtype)

        def contains(self, values):
            return (isinstance(values, np.ndarray) and values.shape == self.shape
                    and np.can_cast(values.dtype, self.dtype)
                    and bool(np.all((values >= self.low) & (values <= self.high))))

        __contains__ = contains

    class Dict(dict):
        """Spaces by name; as gymnasium.spaces.Dict."""

        def seed(self, seed=None):
            for space in self.values():
                space.seed(seed)

        def sample(self):
            return {name: space.sample() for name, space in self.items()}

        def contains(self, values):
            return (isinstance(values, dict) and values.keys() == self.keys()
                    and all(space.contains(values[name]) for name, space in self.items()))


def longest(edges, node, passed=()):
    """Ticks of the longest way along edges, {node: [(next node, ticks)]}, that passes no node twice."""
    passed = (*passed, node)
    return max((ticks + longest(edges, other, passed) for other, ticks in edges.get(node, []) if other not in passed),
               default=0)


class Environment(Env):
    """An experiment as a task for an agent in Python.

    file: of the experiment, which has one node `simulator: python`. settings: keys in place of those of the file;
    it runs in lockstep, unless they say otherwise. ticks: of one step; not given: a step of the environment, of the
    vehicle's task (20 ms). action_space: what Gymnasium's agents are to choose from, for example
    gymnasium.spaces.Discrete(3); not given: a Box without bounds.

    Observation: what comes into the node. A signal: its newest values, 0 before the first; spikes: the number of
    each channel's since the last step. Of several inputs a dict by port. Action: the values of its output. Reward:
    of the robot's task, the sum over the steps of the task in a step. truncated: by the time limit of the episode,
    or the end of the run.
    @raises SpikeloopError: the experiment is wrong, or has no such node or task
    """

    metadata = {"render_modes": []}
    render_mode = None

    def __init__(self, file, settings=None, *, ticks=None, action_space=None):
        self._experiment = Experiment(file, {"sync": "lockstep", **(settings or {})})
        resolved = self._experiment.resolved()
        self._node = self._find_node(resolved["nodes"])
        self._seed = resolved["seed"]
        self._loop = self._experiment.open()
        try:
            self._look(resolved, ticks)
        except SpikeloopError:
            self.close()
            raise
        self.action_space = action_space
        if action_space is None:
            self.action_space = Box(-np.inf, np.inf, (self._loop.inputs[self._output][1],), np.float64)

    def _error(self, text):
        return SpikeloopError(f"{self._experiment.file}: {text}", 2)

    def _find_node(self, nodes):
        found = [name for name, keys in nodes.items() if "simulator" in keys]
        if len(found) != 1 or nodes[found[0]]["simulator"] != "python":
            have = ", ".join(f"{name} ({nodes[name]['simulator']})" for name in found) or "none"
            raise self._error("an agent stands for the one simulator of an experiment, but its simulators are: "
                              f"{have}; write one node as  agent: {{simulator: python, script: agent.py}}")
        return found[0]

    def _look(self, resolved, ticks):
        """At the ports, and at the robot's task."""
        node, episode = self._node, self._loop.episode
        if episode is None:
            raise self._error("the robot has no task, so there is no reward; write for example  robot: "
                              "{environment: mountain_car} , or for the vehicle in a world with goals  episodes: {}")
        outputs = {end: kind for end, (kind, _) in self._loop.inputs.items()}
        if list(outputs.values()) != ["signal"]:
            have = ", ".join(f"{end} ({kind})" for end, kind in outputs.items()) or "none"
            raise self._error(f"an agent acts by one continuous output, but those of '{node}' are: {have}; connect one, "
                              f"for example  {node}.value -> action [1]")
        self._output = next(iter(outputs))
        self._ports = {end.partition(".")[2]: (kind, width) for end, (kind, width) in self._loop.outputs.items()
                       if end.partition(".")[0] == node}
        if not self._ports:
            raise self._error(f"nothing comes into '{node}', which an agent could observe; connect a sensor to it, for "
                              f"example  car -> {node}.observation")
        spaces = {port: Box(0, np.iinfo(np.int32).max, (width,), np.int32) if kind == "spikes" else
                  Box(-np.inf, np.inf, (width,), np.float64) for port, (kind, width) in self._ports.items()}
        self.observation_space = Dict(spaces) if len(spaces) > 1 else next(iter(spaces.values()))
        self._look_at_time(episode["step_ns"], resolved, ticks)

    def _look_at_time(self, step_ns, resolved, ticks):
        tick_ns, stepped = resolved["tick_ns"], "environment" in resolved["robot"]
        into, out = {}, {}
        for edge in resolved["connections"]:
            begin, end = (edge[key].partition(".")[0] for key in ("from", "to"))
            into.setdefault(end, []).append((begin, edge["delay_ticks"]))
            out.setdefault(begin, []).append((end, edge["delay_ticks"]))
        self._seen_after = 1 + longest(into, self._node)  # ticks after which the agent sees what the robot sent
        self._block = step_ns // tick_ns  # after which the task is looked at
        least = self._seen_after + (longest(out, self._node) + 1 if stepped else 0)
        if self._block < least:
            enough = next(count for count in itertools.count(least) if step_ns % count == 0)
            raise self._error(f"a step of the task is {step_ns / 1e6:g} ms, {self._block} ticks, but an observation and "
                              f"the action on it take {least} ticks; write  tick: {step_ns / enough / 1e6:g} ms  or less")
        self._ticks = self._block if ticks is None else ticks
        if self._ticks < 1 or stepped and self._ticks % self._block:
            raise self._error(f"{ticks} ticks are not a whole number of steps of the environment, each of {self._block}; "
                              f"write  ticks={max(1, self._ticks // self._block) * self._block}")

    def reset(self, *, seed=None, options=None):
        """Begins the next episode. @returns (observation, info)

        seed: runs the experiment anew with it, from the first episode on; the same seed makes the same episodes.
        Without it, and with an episode in progress or no more left, the next seed is taken.
        """
        if Env is not object:
            super().reset(seed=seed)
        if self._loop is None:
            raise self._error("the environment was closed; make another one")
        self._counts = self._no_spikes()
        if seed is None and (self._loop.time_s == 0 or self._wait()) and self._advance(self._seen_after):
            return self._observation(), self._info()
        self.close()
        self._seed = int(self._seed + 1 if seed is None else seed)
        self._loop = self._experiment.open(seed=self._seed, set={"robot.seed": self._seed})
        self._advance(self._seen_after)
        return self._observation(), self._info()

    def _wait(self):
        """For the next episode. False: one is in progress, or there is none left."""
        before = self._loop.episode
        while not before["running"] and self._loop.step():
            if self._loop.episode["number"] > before["number"]:
                return True
        return False

    def step(self, action):
        """One step. @returns (observation, reward, terminated, truncated, info)
        @raises SpikeloopError: before reset(), an episode that has ended, an action of another width"""
        before = self._loop.episode if self._loop is not None else {"running": False}
        if not before["running"] or self._loop.time_s == 0:
            raise self._error("no episode is in progress; call reset() first")
        self._loop.write(self._output, np.ravel(action))
        self._counts = self._no_spikes()
        left, more = self._ticks, True
        while more and left > 0 and self._loop.episode["running"]:
            more = self._advance(min(left, self._block))
            left -= self._block
        episode = self._loop.episode
        over = not episode["running"] or not more
        return (self._observation(), episode["return"] - before["return"], episode["terminated"],
                over and not episode["terminated"], self._info())

    def _no_spikes(self):
        return {port: np.zeros(width, np.int32) for port, (kind, width) in self._ports.items() if kind == "spikes"}

    def _advance(self, ticks):
        """Whether all of them were left."""
        until = self._loop.time_s + (ticks - 0.5) * self._loop.tick_s
        self._loop.step(ticks)
        for port, counts in self._counts.items():
            np.add.at(counts, self._loop.spikes(f"{self._node}.{port}")[1], 1)
        return self._loop.time_s > until

    def _observation(self):
        found = dict(self._counts)
        for port, (kind, width) in self._ports.items():
            if kind == "signal":
                values = self._loop.signal(f"{self._node}.{port}")
                found[port] = np.zeros(width) if values is None else values
        return found if len(found) > 1 else next(iter(found.values()))

    def _info(self):
        episode = self._loop.episode
        return {"number": episode["number"], "steps": episode["steps"], "success": episode["success"],
                "time_s": self._loop.time_s}

    def close(self):
        """Ends the run."""
        if self._loop is not None:
            self._loop.close()
            self._loop = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
