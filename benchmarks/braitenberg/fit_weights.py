#!/usr/bin/python3
"""Fits the knots of examples/01_braitenberg/make_weights.py by an evolution strategy (CMA-ES, Hansen &
Ostermeier 2001, Evol. Comput. 9:159-195), with drives of 60 simulated seconds.

    scripts/bench nodes        builds the program that it needs (build/release/benchmarks/bin)
    benchmarks/braitenberg/fit_weights.py --minutes 60

Prints one line per generation, and finally the knots for make_weights.py. The score of a drive is its
coverage up to 36 %, minus 0.5 if that is below 30 %, and -1 if the vehicle touches something.
"""

import argparse
import pathlib
import subprocess
import sys
import threading
import time

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "examples/01_braitenberg"))
import make_weights  # noqa: E402

PROGRAM = ROOT / "build/release/benchmarks/bin/braitenberg_drives"
# Seed of the arena, delay in ms, phases of the neurons.
DRIVES = [(seed, delay, phase) for seed in range(1, 6) for delay, phase in ((5, 0.0), (18, 0.6))] + [
    (seed, 10, 0.2) for seed in range(6, 26)]
SCALE = np.array([2.0] * 18 + [0.1, 0.3, 0.3])


class Drivers:
    """Programs that drive, one a core."""

    def __init__(self, count):
        self.programs = [subprocess.Popen([PROGRAM], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                          text=True) for _ in range(count)]

    def drive(self, lines):
        results = [None] * len(lines)
        todo = iter(list(enumerate(lines)))
        lock = threading.Lock()

        def work(program):
            while True:
                with lock:
                    place, line = next(todo, (None, None))
                if place is None:
                    return
                program.stdin.write(line + "\n")
                program.stdin.flush()
                results[place] = tuple(float(word) for word in program.stdout.readline().split())

        threads = [threading.Thread(target=work, args=(program,)) for program in self.programs]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        return results


def start():
    turn = make_weights.MAPPING["mapping"]["angular.z"]
    return np.array(make_weights.SPEED + make_weights.OPEN + make_weights.LEFT +
                    [turn["offset"], -turn["min"], turn["max"]])


def line_of(knots, drive):
    weights = make_weights.weights(knots[0:6], knots[6:12], knots[12:18])
    speed = [0.0, 0.0, make_weights.MAPPING["mapping"]["linear.x"]["max"], *weights[0]]
    turn = [knots[18], -abs(knots[19]), abs(knots[20]), *weights[1]]
    return " ".join(f"{number:.9g}" for number in [*drive, *speed, *turn])


def score(result):
    collisions, _, coverage = result
    if collisions:
        return -1.0
    return min(coverage, 0.36) / 0.36 - (0.5 if coverage < 0.3 else 0.0)


class EvolutionStrategy:
    """Hansen's (mu/mu_w, lambda) strategy with its default constants."""

    def __init__(self, size, sigma, generator):
        self.size, self.sigma, self.generator = size, sigma, generator
        self.population = 4 + int(3 * np.log(size))
        self.parents = self.population // 2
        weights = np.log(self.parents + 0.5) - np.log(np.arange(1, self.parents + 1))
        self.weights = weights / weights.sum()
        mu = 1 / np.sum(self.weights**2)
        self.c_path = (4 + mu / size) / (size + 4 + 2 * mu / size)
        self.c_sigma = (mu + 2) / (size + mu + 5)
        self.c_one = 2 / ((size + 1.3)**2 + mu)
        self.c_mu = min(1 - self.c_one, 2 * (mu - 2 + 1 / mu) / ((size + 2)**2 + mu))
        self.damping = 1 + 2 * max(0, np.sqrt((mu - 1) / (size + 1)) - 1) + self.c_sigma
        self.mu = mu
        self.expected = np.sqrt(size) * (1 - 1 / (4 * size) + 1 / (21 * size**2))
        self.mean, self.path, self.path_sigma = np.zeros((3, size))
        self.covariance = np.eye(size)
        self.generation = 0

    def sample(self):
        values, self.axes = np.linalg.eigh(self.covariance)
        self.lengths = np.sqrt(np.maximum(values, 1e-12))
        normal = self.generator.standard_normal((self.size, self.population))
        self.steps = (self.axes * self.lengths) @ normal
        return (self.mean[:, None] + self.sigma * self.steps).T

    def tell(self, scores):
        """Higher is better."""
        best = self.steps[:, np.argsort(-np.asarray(scores))[:self.parents]]
        step = best @ self.weights
        self.generation += 1
        self.mean = self.mean + self.sigma * step
        whitened = self.axes @ ((self.axes.T @ step) / self.lengths)
        self.path_sigma = ((1 - self.c_sigma) * self.path_sigma +
                           np.sqrt(self.c_sigma * (2 - self.c_sigma) * self.mu) * whitened)
        length = np.linalg.norm(self.path_sigma) / self.expected
        settled = length / np.sqrt(1 - (1 - self.c_sigma)**(2 * self.generation)) < 1.4 + 2 / (
            self.size + 1)
        self.path = ((1 - self.c_path) * self.path +
                     settled * np.sqrt(self.c_path * (2 - self.c_path) * self.mu) * step)
        self.covariance = (
            (1 - self.c_one - self.c_mu) * self.covariance + self.c_one *
            (np.outer(self.path, self.path) +
             (1 - settled) * self.c_path * (2 - self.c_path) * self.covariance) +
            self.c_mu * (best * self.weights) @ best.T)
        self.sigma *= np.exp((self.c_sigma / self.damping) * (length - 1))


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=60, help="wall time")
    parser.add_argument("--programs", type=int, default=2, help="number of parallel drives")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    if not PROGRAM.exists():
        sys.exit(f"fit_weights.py: there is no {PROGRAM}; write  scripts/bench nodes  first")
    drivers = Drivers(arguments.programs)
    begin, origin = time.time(), start()
    strategy = EvolutionStrategy(len(origin), 0.06, np.random.default_rng(arguments.seed))
    while time.time() - begin < 60 * arguments.minutes:
        candidates = [origin + SCALE * sample for sample in strategy.sample()]
        lines = [line_of(knots, drive) for knots in candidates for drive in DRIVES]
        scores = np.array([score(r) for r in drivers.drive(lines)]).reshape(len(candidates), -1)
        strategy.tell(scores.mean(axis=1))
        print(f"generation {strategy.generation}, {time.time() - begin:.0f} s: best "
              f"{scores.mean(axis=1).max():.3f}, mean {scores.mean():.3f}", flush=True)
    knots = origin + SCALE * strategy.mean
    for name, values in zip(("SPEED", "OPEN", "LEFT", "offset, -min, max"),
                            np.split(knots, [6, 12, 18])):
        print(name, "=", [round(float(value), 4) for value in values])


if __name__ == "__main__":
    main()
