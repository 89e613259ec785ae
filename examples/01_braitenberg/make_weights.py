#!/usr/bin/python3
"""Writes readout_weights.json and mapping.json: Braitenberg's explorer as a linear readout.

Beam j looks at the angle a_j, from -90 degrees (right) to +90 degrees (left), and drives one neuron
at rate_j: 1 Hz at a distance of 0.05 m, 200 Hz at 5 m and beyond. The readout is

    y_i = sum_j W_ij rate_j,   W_ij = p_i(a_j) / (100 beams * 200 Hz)

so y_i is the mean of p_i over the beams when everything is far away. y_0 is the speed (m/s), y_1 the
yaw rate (rad/s, counterclockwise); the mapping adds an offset and limits them. Three profiles of |a|:

    p_0(a) = SPEED(|a|)                        look ahead: slow down for what is near in front,
                                               and do not race along what is far at the side
    p_1(a) = sign(a) * OPEN(|a|)               turn to the side where there is more room
             + LEFT(|a|)                       and, where the way ahead is shut, to the left: a wall
                                               met head-on is as near on the right as on the left

The offset gives the path its bias: it curls through the arena instead of running to and fro on one
line. Without spikes the speed is 0 and the vehicle only turns on the spot.

The profiles are piecewise linear between the angles of KNOTS. Their values were found by an evolution
strategy (benchmarks/braitenberg/fit_weights.py), 60 s a drive, first on a simplified robot that moves as it is told, in the arenas of
seeds 1 to 25, then on the simulated physics in those of seeds 1 to 10, with delay (3 to 25 ms) and
spike phases varied. It was asked for no collision, speed, and coverage. So seeds 1 to 10 are what it
was fitted to, no test of how well it does elsewhere: in the arenas of seeds 11 to 70, 4 of 60 drives
touch something, 18 see less than 30 % of the cells. Where they do, and in seeds 5 and 7, the path has
closed to a loop.
tests/vehicle/braitenberg_test.cpp drives the result through the simulated physics.

usage: make_weights.py [--check]     --check: compare with the files instead of writing them
"""

import json
import pathlib
import sys

import numpy as np

BEAMS = 100
RATE_MAX_HZ = 200.0

KNOTS = np.radians([0, 10, 22, 40, 65, 90])
OPEN = [-0.0451, 6.5194, 9.1502, 10.6512, 4.4622, -4.1917]
LEFT = [-7.4279, -5.1622, -1.5864, 0.6365, -2.5586, 5.5986]
SPEED = [10.5427, 8.0003, 6.0175, -0.3189, -0.7393, -7.3591]

MAPPING = {
    "message_type": "Twist",
    "mapping": {
        "linear.x": {"channel": 0, "min": 0.0, "max": 0.8},
        "angular.z": {"channel": 1, "offset": 0.2115, "min": -2.1959, "max": 1.7449},
    },
}


def weights(speed, open_side, left):
    """2 x 100, in m/s and rad/s a hertz, from the values at the knots."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, BEAMS)
    profile = [np.interp(np.abs(angles), KNOTS, values) for values in (speed, open_side, left)]
    rows = np.array([profile[0], np.sign(angles) * profile[1] + profile[2]])
    return rows / (BEAMS * RATE_MAX_HZ)


def files():
    rows = ",\n".join("[" + ", ".join(f"{value:.6e}" for value in row) + "]" for row in weights(SPEED, OPEN, LEFT))
    return {"readout_weights.json": f"[{rows}]\n",
            "mapping.json": json.dumps(MAPPING, indent=2) + "\n"}


def main():
    folder = pathlib.Path(__file__).resolve().parent
    check = sys.argv[1:] == ["--check"]
    if sys.argv[1:] and not check:
        sys.exit(__doc__)
    for name, text in files().items():
        if not check:
            (folder / name).write_text(text)
        elif (folder / name).read_text() != text:
            sys.exit(f"{name} is not what {pathlib.Path(__file__).name} writes; run it")


if __name__ == "__main__":
    main()
