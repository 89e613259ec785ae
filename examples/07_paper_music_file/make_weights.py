"""Writes the three .dat files: the vehicle of example 1 with 20 neurons, in ros_music_adapter's formats."""

import json
import pathlib

import numpy as np

BEAMS, CHANNELS, BIAS_HZ, BIAS_RAD_S = 100, 20, 63.1, 0.2115


def rows(table):
    return "[" + ",\n ".join(json.dumps([float(f"{value:.4g}") for value in row]) for row in table) + "]\n"


# A channel is the mean of five neighbouring beams.
blocks = np.kron(np.eye(CHANNELS), np.full(BEAMS // CHANNELS, CHANNELS / BEAMS))
# A neuron weighs what its five beams' neurons weigh in example 1. The last one turns to the left.
weights = np.array(json.load(open("../01_braitenberg/readout_weights.json")))
readout = weights.reshape(2, CHANNELS, -1).sum(axis=2)
readout = np.column_stack([readout, [0, BIAS_RAD_S / BIAS_HZ]])
mapping = {"message_type": "Twist", "mapping": {"linear.x": 0, "angular.z": 1}, "min": -1, "max": 1}

files = {"sensor_weights.dat": rows(blocks),
         "readout_weights.dat": rows(readout),
         "twist_mapping.dat": json.dumps(mapping) + "\n"}
for name, text in files.items():
    pathlib.Path(name).write_text(text)
print(*files)
