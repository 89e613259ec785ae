"""Draws angle and position of runs beside the theory:  plot.py RUN_FOLDER... PICTURE.png

The theory is the linear model of cart and pole with the force u = F / (1 + s tau), F the sum that the neurons
decode, tau the time constant of the decoder; without neurons, noise and limits.
"""

import sys

import numpy as np
from spikeloop import style
from spikeloop.run_folder import RunFolder

CART, POLE, LENGTH, INERTIA, DAMPING, GRAVITY = 1.0, 0.1, 0.3, 0.003, 0.5, 9.81  # of pendulum.xml, SI units
TAU = 0.02
SCALES = np.array([1, 1, 0.3, 1.5])  # what 1 means at the input: m, m/s, rad, rad/s
GAINS = 20 * np.array([0.158, 0.242, 0.572, 0.551]) / SCALES  # N per unit of the state


def linear_model():
    """d/dt (position, speed, angle, angular speed, force) = A (the same)."""
    mass, moment, swing = CART + POLE, INERTIA + POLE * LENGTH**2, POLE * LENGTH
    d = mass * moment - swing**2
    a = np.zeros((5, 5))
    a[0, 1] = a[2, 3] = 1
    a[1] = [0, -DAMPING * moment / d, -swing**2 * GRAVITY / d, 0, moment / d]
    a[3] = [0, DAMPING * swing / d, mass * swing * GRAVITY / d, 0, -swing / d]
    a[4] = [*GAINS / TAU, -1 / TAU]
    return a


def theory(times_s, angle):
    values, vectors = np.linalg.eig(linear_model())
    parts = np.linalg.solve(vectors, np.array([0, 0, angle, 0, 0], complex))
    return (vectors @ (parts[:, None] * np.exp(np.outer(values, times_s)))).real


folders, picture = sys.argv[1:-1], sys.argv[-1]
with style.styled():
    figure = style.new_figure(8, 4.5)
    axes = figure.subplots(2, sharex=True)
    for folder, colour in zip(folders, [style.BLUE, style.VERMILLION]):
        state = RunFolder(folder).signal("state")
        times_s, values = state.times_s, state.values * SCALES
        axes[0].plot(times_s, np.degrees(values[:, 2]), color=colour, label=folder)
        axes[1].plot(times_s, 100 * values[:, 0], color=colour)
        late = times_s > times_s[-1] - 5
        # Rounded: further digits depend on the processor, as those of MuJoCo do.
        spread = np.ceil(2 * np.degrees(np.std(values[late, 2]))) / 2
        place = 5 * np.round(20 * np.mean(values[late, 0]))
        print(f"{folder}: angle below {spread:.1f} degrees, position near {place:.0f} cm in the last 5 s")
    ideal = theory(times_s, 0.1)
    axes[0].plot(times_s, np.degrees(ideal[2]), color=style.INK, ls="--", label="linear theory")
    axes[1].plot(times_s, 100 * ideal[0], color=style.INK, ls="--")
    first = times_s < 2
    state = RunFolder(folders[0]).signal("state").values * SCALES
    error = np.degrees(np.abs(state[first, 2] - ideal[2, first]).max())
    print(f"first 2 s: less than {np.ceil(10 * error) / 10:.1f} degrees from the linear theory")
    axes[0].set_ylabel("angle (degrees)")
    axes[1].set_ylabel("cart (cm)")
    axes[1].set_xlabel("time (s)")
    axes[0].legend(loc="upper right")
    style.save(figure, picture)
print(picture)
