"""Writes the place cells, 5 x 5 over the arena:  make_grid.py > grid.json"""

import json

SPACING_M, SIGMA_M = 1.2, 0.5
places = [(column - 2) * SPACING_M for column in range(5)]
rows = [[round(x, 3), round(y, 3), SIGMA_M, SIGMA_M] for y in places for x in places]
print("[" + ",\n ".join(json.dumps(row) for row in rows) + "]")
