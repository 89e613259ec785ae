#!/usr/bin/python3
"""10,000 steps of every environment equal those of an independent implementation of the published equations.

Each environment takes two series of actions: one where every action is drawn anew, and one where each is held
for a while, which reaches walls and goals. The first observation of an episode is taken over from the program.
Sums and products have the order of Gymnasium's: with another, a pole that is balanced for 500 steps is off by more
than 1e-12.
"""

import math
import os
import random
import subprocess
import unittest

STEPS = 10_000
TOLERANCE = 1e-12


def mountain_car(state, action):
    """Gymnasium's documentation of MountainCar-v0, "Transition Dynamics"."""
    position, velocity = state
    velocity += (action - 1) * 0.001 - math.cos(3 * position) * 0.0025
    velocity = min(max(velocity, -0.07), 0.07)
    position = min(max(position + velocity, -1.2), 0.6)
    if position == -1.2:
        velocity = max(velocity, 0.0)
    goal = position >= 0.5 and velocity >= 0
    return (position, velocity), -1.0, goal, goal


def cart_pole(state, action):
    """Barto, Sutton & Anderson (1983) without friction, as in Florian (2007), "Correct equations for the dynamics of
    the cart-pole system", equations 23 and 24; Euler's method."""
    x, v, angle, w = state
    cart, pole, half, gravity, tau = 1.0, 0.1, 0.5, 9.8, 0.02
    force = 10.0 if action else -10.0
    sine, cosine = math.sin(angle), math.cos(angle)
    total = pole + cart
    without_pole = (force + pole * half * (w * w) * sine) / total
    angular = (gravity * sine - cosine * without_pole) / (half * (4.0 / 3.0 - pole * (cosine * cosine) / total))
    linear = without_pole - pole * half * angular * cosine / total
    x, v, angle, w = x + tau * v, v + tau * linear, angle + tau * w, w + tau * angular
    return (x, v, angle, w), 1.0, abs(x) > 2.4 or abs(angle) > math.radians(12), False


LAKE = ["SFFF", "FHFH", "FFFH", "HFFG"]


def lake_move(field, direction):
    row, column = divmod(field, 4)
    down, right = [(0, -1), (1, 0), (0, 1), (-1, 0)][direction]
    if 0 <= row + down < 4 and 0 <= column + right < 4:
        row, column = row + down, column + right
    return row * 4 + column


def lake_outcome(field):
    letter = LAKE[field // 4][field % 4]
    return (field,), float(letter == "G"), letter in "GH", letter == "G"


def frozen_lake(state, action):
    return lake_outcome(lake_move(int(state[0]), action))


def water_maze(state, heading):
    x, y = state[0] + 0.02 * math.cos(heading), state[1] + 0.02 * math.sin(heading)
    outside = max(math.sqrt(x * x + y * y), 1.0)
    x, y = x / outside, y / outside
    reached = math.sqrt((x - 0.35) ** 2 + (y - 0.35) ** 2) <= 0.1
    return (x, y), float(reached), reached, reached


def trace(actions, *arguments):
    """The program's lines as (first word, numbers)."""
    program = subprocess.run([os.environ["ENVIRONMENTS_TRACE"], *arguments], check=True, timeout=120, text=True,
                             stdout=subprocess.PIPE, input="".join(f"{action!r}\n" for action in actions))
    lines = [line.split() for line in program.stdout.splitlines()]
    return [(line[0], [float(word) for word in line[1:]]) for line in lines]


def held(generator, draw, longest):
    """STEPS actions, each drawn once and repeated up to `longest` times."""
    actions = []
    while len(actions) < STEPS:
        actions += [draw(generator)] * generator.randint(1, longest)
    return actions[:STEPS]


class Equations(unittest.TestCase):
    def compare(self, equations, limit, actions):
        """Returns how episodes ended: a count for each of goal, end, limit."""
        lines = iter(trace(actions, equations.__name__))
        ends = {"goal": 0, "end": 0, "limit": 0}
        largest, state = 0.0, None
        for action in actions:
            if state is None:
                word, state = next(lines)
                self.assertEqual(word, "reset")
                steps = 0
            word, numbers = next(lines)
            self.assertEqual(word, "step")
            state, *outcome = equations(state, action)
            self.assertEqual(numbers[:3], outcome)
            self.assertEqual(len(numbers[3:]), len(state))
            largest = max([largest] + [abs(a - b) for a, b in zip(numbers[3:], state)])
            self.assertLessEqual(largest, TOLERANCE)
            steps += 1
            _, terminated, success = outcome
            if terminated or steps == limit:
                ends["goal" if success else "end" if terminated else "limit"] += 1
                state = None
        self.assertEqual([word for word, _ in lines], ["reset"] if state is None else [])
        print(f"{equations.__name__}: {STEPS} steps, {ends}; largest difference {largest:g}")
        return ends

    def both(self, equations, limit, draw, longest):
        generator = random.Random(1)
        first = self.compare(equations, limit, held(generator, draw, 1))
        second = self.compare(equations, limit, held(generator, draw, longest))
        return {end: first[end] + second[end] for end in first}

    def test_mountain_car(self):
        ends = self.both(mountain_car, 200, lambda generator: generator.randrange(3), 60)
        self.assertTrue(ends["goal"] and ends["limit"] and not ends["end"], ends)

    def test_cart_pole(self):
        ends = self.both(cart_pole, 500, lambda generator: generator.randrange(2), 3)
        self.assertTrue(ends["end"] and not ends["goal"], ends)

    def test_cart_pole_for_500_steps(self):
        """Of the balanced pole, too: the actions are a rule's, on the states of the equations."""
        actions, state = [], None
        for step in range(STEPS):
            if step % 500 == 0:
                state = next(numbers for word, numbers in reversed(trace(actions, "cart_pole")) if word == "reset")
            actions.append(int(state[2] + 0.5 * state[3] + 0.03 * state[1] + 0.02 * state[0] > 0))
            state = cart_pole(state, actions[-1])[0]
        self.assertEqual(self.compare(cart_pole, 500, actions), {"goal": 0, "end": 0, "limit": STEPS // 500})

    def test_frozen_lake(self):
        ends = self.both(frozen_lake, 100, lambda generator: generator.randrange(4), 3)
        self.assertTrue(ends["goal"] and ends["end"], ends)

    def test_water_maze(self):
        ends = self.both(water_maze, 600, lambda generator: generator.uniform(-math.pi, math.pi), 150)
        self.assertTrue(ends["goal"] and ends["limit"] and not ends["end"], ends)

    def test_slippery_frozen_lake(self):
        """Where it slips is the program's choice: the action's direction or a perpendicular one."""
        generator = random.Random(1)
        actions = held(generator, lambda generator: generator.randrange(4), 1)
        lines = iter(trace(actions, "frozen_lake", "slippery"))
        state, steps, slips = None, 0, 0
        for action in actions:
            if state is None:
                _, (state,) = next(lines)
                self.assertEqual(state, 0)
                steps = 0
            _, (*outcome, field) = next(lines)
            fields = [lake_move(int(state), (action + turn) % 4) for turn in (-1, 0, 1)]
            self.assertIn(field, fields)
            self.assertEqual(outcome, list(lake_outcome(int(field))[1:]))
            slips += field != fields[1]
            steps += 1
            state = None if outcome[1] or steps == 100 else field
        self.assertTrue(slips)


if __name__ == "__main__":
    unittest.main()
