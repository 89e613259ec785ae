"""Writes the place cells, grid.json, the connections between the actors, ring.json, and the mean of the
critics, mean.json."""

import json
import math

SPACING_M, SIGMA_M, RADIUS_M = 0.2, 0.2, 1.3  # of the place cells; the pool has a radius of 1 m
CRITICS, ACTORS = 40, 36
EXCITATION_PA, INHIBITION_PA, WIDTH_RAD = 16, 7, 0.5


def write(name, rows):
    with open(name, "w", encoding="utf-8") as file:
        file.write("[" + ",\n ".join(json.dumps(row) for row in rows) + "]\n")
    print(f"{name}: {len(rows)} x {len(rows[0])}")


def lateral_pa(i, j):
    """Actors with similar directions excite, all others inhibit each other."""
    steps = abs(i - j)
    angle = 2 * math.pi * min(steps, ACTORS - steps) / ACTORS
    return 0 if i == j else round(EXCITATION_PA * math.exp(-(angle / WIDTH_RAD) ** 2 / 2) - INHIBITION_PA, 3)


axis = [round(SPACING_M * k, 3) for k in range(-6, 7)]
write("grid.json", [[x, y, SIGMA_M, SIGMA_M] for x in axis for y in axis if math.hypot(x, y) < RADIUS_M])
write("ring.json", [[lateral_pa(i, j) for j in range(ACTORS)] for i in range(ACTORS)])
write("mean.json", [[1 / CRITICS] * CRITICS])
