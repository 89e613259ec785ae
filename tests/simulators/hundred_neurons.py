"""A network of 100 neurons for every simulator: 80 excite, 20 inhibit, driven by 40 channels.

Random weights with a density of 0.2, a delay a projection. Weights are multiples of 1/8, so that a
sum of them is the same in any order, to the bit; delays are whole milliseconds and tenths, at least
1 ms. Weights are pA for `iaf_psc_exp`, mV for `iaf_psc_delta`.
"""

import numpy as np

CHANNELS = 40
POPULATIONS = {"excitatory": 80, "inhibitory": 20}
NEURONS = sum(POPULATIONS.values())
RESOLUTION_MS = 0.1

# By model, in NEST's units: ms, mV, pF, pA.
PARAMETERS = {
    "iaf_psc_exp": {"C_m": 250.0, "tau_m": 10.0, "t_ref": 2.0, "E_L": -70.0, "V_reset": -65.0,
                    "V_th": -55.0, "I_e": 300.0, "tau_syn_ex": 2.0, "tau_syn_in": 5.0},
    "iaf_psc_delta": {"C_m": 250.0, "tau_m": 10.0, "t_ref": 2.0, "E_L": -70.0, "V_reset": -65.0,
                      "V_th": -55.0, "I_e": 300.0},
}
# (from, to, delay in ms)
PROJECTIONS = [("input", "excitatory", 1.0), ("input", "inhibitory", 1.4),
               ("excitatory", "excitatory", 1.5), ("excitatory", "inhibitory", 1.1),
               ("inhibitory", "excitatory", 1.0), ("inhibitory", "inhibitory", 2.3)]
LARGEST = {"iaf_psc_exp": {"input": 240, "excitatory": 80, "inhibitory": -240},
           "iaf_psc_delta": {"input": 2, "excitatory": 1, "inhibitory": -4}}


def size(name):
    return CHANNELS if name == "input" else POPULATIONS[name]


def weights(model, source, target):
    """A row a target, a column a source; 0: no synapse."""
    order = [projection[:2] for projection in PROJECTIONS].index((source, target))
    random = np.random.default_rng([20, order])
    shape = size(target), size(source)
    largest = LARGEST[model][source]
    drawn = np.round(random.uniform(0.25, 1, shape) * largest * 8) / 8
    return np.where(random.random(shape) < 0.2, drawn, 0)


def driving_spikes(duration_s, rate_hz=60, seed=1):
    """(times in ns, channels), sorted: Poisson, in whole microseconds, never two of a channel in one
    step of 0.1 ms."""
    random = np.random.default_rng([21, seed])
    end_us = round(duration_s * 1e6)
    count = random.poisson(duration_s * rate_hz * CHANNELS)
    times, channels = random.integers(1, end_us + 1, count), random.integers(0, CHANNELS, count)
    steps = -(-times // round(RESOLUTION_MS * 1e3))
    _, first = np.unique(steps * CHANNELS + channels, return_index=True)
    times, channels = times[first], channels[first]
    order = np.lexsort((channels, times))
    return times[order] * 1000, channels[order]


def write_files(folder, model):
    """brain.yaml for spikeloop-network, and the weights beside it, by which all build it."""
    lines = [f"resolution: {RESOLUTION_MS} ms", "populations:",
             f"  input: {{model: input, size: {CHANNELS}}}"]
    parameters = ", ".join(f"{name}: {value}" for name, value in PARAMETERS[model].items())
    lines += [f"  {name}: {{model: {model}, size: {count}, parameters: {{{parameters}}}}}"
              for name, count in POPULATIONS.items()]
    lines.append("connections:")
    for source, target, delay_ms in PROJECTIONS:
        name = f"{source}_{target}.npy"
        np.save(folder / name, weights(model, source, target))
        lines.append(f"  - {{from: {source}, to: {target}, rule: {name}, weight: 1, "
                     f"delay: {delay_ms} ms}}")
    lines.append(f"output: [{', '.join(POPULATIONS)}]")
    (folder / "brain.yaml").write_text("\n".join(lines) + "\n")


def build_in_nest(nest, model, source, folder):
    """The neurons, driven by the nodes `source`; weights of the files in the folder."""
    nodes = {"input": source}
    for name, count in POPULATIONS.items():
        nodes[name] = nest.Create(model, count, PARAMETERS[model])
    for pre, post, delay_ms in PROJECTIONS:
        table = np.load(folder / f"{pre}_{post}.npy")
        targets, sources = np.nonzero(table)
        nest.Connect(np.array(nodes[pre].tolist())[sources],
                     np.array(nodes[post].tolist())[targets], "one_to_one",
                     {"weight": table[targets, sources], "delay": np.full(len(targets), delay_ms)})
    return nodes["excitatory"] + nodes["inhibitory"]
