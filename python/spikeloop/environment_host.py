"""What the library spikeloop_python_nodes calls for an environment: an object with Gymnasium's interface.

Not for users. What crosses to C++ is strings, numbers and lists.
"""

import sys

import numpy as np

from .declare import did_you_mean
from .node_host import LoadError, run


def make(source):
    """FILE.py:FUNCTION, or gymnasium:NAME. @raises LoadError"""
    if source.startswith("gymnasium:"):
        return Hosted(_gymnasium().make(source.partition(":")[2]))
    path, _, name = source.rpartition(":")
    if not path.endswith(".py"):
        raise LoadError("write  FILE.py:FUNCTION, a function that makes the environment, or  gymnasium:NAME")
    functions = {each: value for each, value in vars(run(path)).items() if callable(value)}
    if name not in functions:
        raise LoadError(f"there is no function '{name}' in '{path}'{did_you_mean(name, list(functions))}")
    return Hosted(functions[name]())


def _gymnasium():
    try:
        import gymnasium
    except ImportError as error:
        raise LoadError(f"{sys.executable} cannot import gymnasium ({error}); make a virtual environment of this Python, "
                        "activate it, and write there  pip install gymnasium numpy") from None
    return gymnasium


def _is_discrete(space):
    return hasattr(space, "n") and not hasattr(space, "low")


def _is_box(space):
    return all(hasattr(space, name) for name in ("low", "high", "shape"))


class Hosted:
    """An environment by numbers.

    actions: how many there are, of a Discrete space; 0: action_low to action_high. max_steps: 0: no limit.
    """

    def __init__(self, env):
        for name in ("reset", "step", "observation_space", "action_space"):
            if not hasattr(env, name):
                raise LoadError(f"an environment of type {type(env).__name__} has no '{name}'; write one with Gymnasium's "
                                "interface")
        self.env, space = env, env.action_space
        if _is_discrete(space):
            self.actions = int(space.n)
            self.action_low, self.action_high = 0.0, self.actions - 1.0
        elif _is_box(space) and np.prod(space.shape) == 1:
            self.actions = 0
            self.action_low, self.action_high = float(np.ravel(space.low)[0]), float(np.ravel(space.high)[0])
        else:
            raise LoadError(f"the space of actions is {space}; there can be one action, of a Discrete or a Box of one "
                            "number")
        self.bounds = self._bounds(env.observation_space)
        self.max_steps = int(getattr(getattr(env, "spec", None), "max_episode_steps", None) or 0)

    @staticmethod
    def _bounds(space):
        if _is_discrete(space):
            first = int(getattr(space, "start", 0))
            return [(first, first + int(space.n) - 1)]
        if _is_box(space):
            return list(zip(np.ravel(np.broadcast_to(space.low, space.shape)),
                            np.ravel(np.broadcast_to(space.high, space.shape))))
        raise LoadError(f"the space of observations is {space}; it can be Discrete, or a Box")

    def quantities(self):
        """(name, low, high) of every number of an observation."""
        return [(f"x{i}", float(low), float(high)) for i, (low, high) in enumerate(self.bounds)]

    def reset(self, seed, episode):
        """The first observation; its seed is a function of both."""
        observation, _ = self.env.reset(seed=int(np.random.SeedSequence((seed, episode)).generate_state(1)[0]))
        return self._numbers(observation)

    def step(self, action):
        """(observation, reward, terminated, truncated, success)"""
        space = self.env.action_space
        if self.actions:
            given = int(action) + int(getattr(space, "start", 0))
        else:
            given = np.full(space.shape, action, getattr(space, "dtype", float))
        observation, reward, terminated, truncated, info = self.env.step(given)
        return (self._numbers(observation), float(reward), bool(terminated), bool(truncated),
                bool(info.get("success", False)))

    def _numbers(self, observation):
        numbers = np.ravel(np.asarray(observation, float))
        if numbers.size != len(self.bounds):
            raise LoadError(f"an observation has {numbers.size} numbers, but its space has {len(self.bounds)}")
        return numbers.tolist()
