"""Draws curve.png: distance over rate_max, from the table of a sweep.

    python3 curve.py runs/rates
"""

import csv
import pathlib
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402


def main():
    with open(pathlib.Path(sys.argv[1]) / "results.csv", newline="", encoding="utf-8") as table:
        rows = list(csv.DictReader(table))
    rates = sorted({float(row["encoder.rate_max"].removesuffix(" Hz")) for row in rows})
    distances = [[float(row["distance_m"]) for row in rows if row["encoder.rate_max"] == f"{rate:g} Hz"]
                 for rate in rates]
    lower, median, upper = (np.array([np.percentile(each, share) for each in distances]) for share in (25, 50, 75))
    figure, axes = plt.subplots(figsize=(6, 3.5), dpi=120)
    axes.fill_between(rates, lower, upper, alpha=0.25, label="quartiles")
    axes.plot(rates, median, "o-", label=f"median of {len(distances[0])} seeds")
    axes.set(xlabel="rate_max of the encoder (Hz)", ylabel="distance in 20 s (m)", ylim=(0, None))
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, frameon=False)
    axes.spines[["top", "right"]].set_visible(False)
    figure.tight_layout()
    figure.savefig("curve.png")
    print("curve.png")


if __name__ == "__main__":
    main()
