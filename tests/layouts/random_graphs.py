#!/usr/bin/python3
"""Runs random experiments fused, separate and in random processes, and compares their spikes.

    random_graphs.py --spikeloop build/release/bin/spikeloop --graphs 100 --seed 1

A graph is acyclic, 3 to 9 nodes long, driven by recordings of a robot's drive, with delays on all
connections, some of which have several senders or slices. Every spike of every node must be there in
every layout, at the same time to 1 ns.
"""

import argparse
import collections
import pathlib
import random
import subprocess
import sys
import tempfile

import numpy as np

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from recordings import in_order, spikes_of_run  # noqa: E402

DURATION_S = 0.5
TICKS = ("0.5 ms", "1 ms", "2 ms", "5 ms")
# One more may be added at the end. With five receivers of spikes MUSIC's interval tree has a node without values,
# and crashes now and then.
MOST_RECEIVERS = 3
LAYOUTS = {"fused": ("--layout", "fused"), "separate": ("--layout", "separate"), "processes": ()}


def dense(rng, rows, columns):
    """A weight table as YAML."""
    table = [[round(rng.uniform(-1, 1) / columns, 4) for _ in range(columns)] for _ in range(rows)]
    return str(table)


def signal_consumer(rng, width):
    """A node that takes a signal: its keys, the kind and the width of its output."""
    few = rng.randint(1, 4)
    return rng.choice((
        ("node: rate_encoder, rate_min: 1 Hz, rate_max: 150 Hz", "spikes", width),
        ("node: poisson_encoder, rate_min: 5 Hz, rate_max: 150 Hz", "spikes", width),
        ("node: nef_encoder, out_of_range: clip", "spikes", rng.randint(5, 40)),
        ("node: nef_encoder, spike_times: interpolated", "spikes", rng.randint(5, 40)),
        ("node: step_forward_encoder, threshold: 0.05", "spikes", 2 * width),
        (f"node: connect, weights: {dense(rng, few, width)}", "signal", few),
        ("node: low_pass, tau: 20 ms", "signal", width),
        ("node: sigmoid", "signal", width),
        ("node: clip, min: -0.5, max: 0.5", "signal", width),
    ))


def spike_consumer(rng, width):
    few = rng.randint(1, 4)
    network = ("{resolution: 0.1 ms, populations: {input: {model: input, size: %d}, "
               "relay: {model: repeater, size: %d}}, connections: [{from: input, to: relay, "
               "rule: one_to_one, delay: 0.7 ms}], output: [relay]}" % (width, width))
    return rng.choice((
        (f"node: linear_readout, tau: 30 ms, weights: {dense(rng, few, width)}", "signal", few),
        ("node: rate_window, window: 50 ms", "signal", width),
        (f"simulator: builtin, network: {network}", "spikes", width),
    ))


def random_senders(rng, ends, parts):
    """What a connection comes from: its text, its senders, its kind and its width."""
    first = rng.choice(sorted(ends))
    kind, width = ends[first]
    if not parts or rng.random() < 0.5:
        return first, [first], kind, width
    others = rng.choices(sorted(name for name in ends if ends[name][0] == kind), k=rng.randint(0, 2))
    senders = [first, *others]
    if rng.random() < 0.5:  # added: all as wide as the narrowest
        least = rng.randint(1, min(ends[name][1] for name in senders))
        begins = [rng.randint(0, ends[name][1] - least) for name in senders]
        texts = [f"{name}[{begin}:{begin + least}]" for name, begin in zip(senders, begins)]
        return " + ".join(texts), senders, kind, least
    texts, total = [], 0
    for name in senders:
        begin, end = sorted(rng.sample(range(ends[name][1] + 1), 2))
        whole = rng.random() < 0.5
        texts.append(name if whole else f"{name}[{begin}:{end}]")
        total += ends[name][1] if whole else end - begin
    return ", ".join(texts), senders, kind, total


def random_processes(rng, nodes, arrows, cyclic):
    """A list of lists of nodes, all of them joined; in a cycle of processes only when asked for."""
    for _ in range(100):
        count = rng.randint(2, min(4, len(nodes)))
        order = sorted(nodes, key=lambda _: rng.random()) if cyclic else nodes
        cuts = [0, *sorted(rng.sample(range(1, len(nodes)), count - 1)), len(nodes)]
        processes = [order[a:b] for a, b in zip(cuts, cuts[1:])]
        of = {node: i for i, process in enumerate(processes) for node in process}
        joined = {of[end] for source, sink in arrows if of[source] != of[sink] for end in (source, sink)}
        if len(joined) == count:
            return processes
    return [nodes]


def random_experiment(rng, recording, parts=True):
    """The text of an experiment, whose layout has several processes. parts: some connections have several
    senders or slices."""
    cyclic = rng.random() < 0.5
    nodes = {"scan": f"node: signal_playback, file: {recording}/scan.h5",
             "speed": f"node: signal_playback, file: {recording}/decoder.h5",
             "beams": f"node: spike_playback, file: {recording}/encoder.h5"}
    ends = {"scan": ("signal", 100), "speed": ("signal", 2), "beams": ("spikes", 10)}
    arrows = []
    joins = []
    receivers = collections.defaultdict(set)
    for i in range(rng.randint(3, 9)):
        free = {name: end for name, end in ends.items() if len(receivers[name]) < MOST_RECEIVERS or not parts}
        text, senders, kind, width = random_senders(rng, free, parts)
        keys, out_kind, out_width = (signal_consumer if kind == "signal" else spike_consumer)(rng, width)
        name = f"n{i}"
        nodes[name] = keys
        ends[name] = (out_kind, out_width)
        least = (3, 1) if cyclic else (1, 0)  # that processes in a cycle take
        delay = rng.randint(least[0 if kind == "signal" else 1], 5)
        arrows.append((text, name, width, delay))
        joins += [(sender, name) for sender in senders]
        for sender in senders:
            receivers[sender].add(name)
    used = {end for join in joins for end in join}
    lines = [f"experiment: random\nduration: {DURATION_S} s\ntick: {rng.choice(TICKS)}",
             f"seed: {rng.randint(0, 10**9)}\nsync: unpaced\nnodes:"]
    lines += [f"  {name}: {{{keys}}}" for name, keys in nodes.items() if name in used]
    lines.append("connections:")
    for text, name, width, delay in arrows:
        lines.append(f"  - {text} -> {name} [{width}, delay {delay} ticks]")
    # The width of an output is known from a connection of all its channels: give each one.
    read = {arrow[0] for arrow in arrows}
    chain = [name for name in nodes if name in used]
    for name in sorted(used - read):
        kind, width = ends[name]
        sink = f"end_{name}"
        keys = ("node: rate_encoder, rate_max: 50 Hz" if kind == "signal"
                else "node: rate_window, window: 20 ms")
        lines.insert(2, f"  {sink}: {{{keys}}}")
        lines.append(f"  - {name} -> {sink} [{width}, delay 3 ticks]")
        chain.append(sink)
        joins.append((name, sink))
    processes = ", ".join(f"p{i}: [{', '.join(process)}]"
                          for i, process in enumerate(random_processes(rng, chain, joins, cyclic)))
    lines.insert(0, f"layout: {{{processes}}}")
    return "\n".join(lines) + "\n"


def spikes_of(folder):
    """Every recorded train: times in ns and channels, sorted."""
    return {name: tuple(in_order(*train)) for name, train in spikes_of_run(folder).items()}


def run(spikeloop, *arguments, text=""):
    done = subprocess.run([spikeloop, "run", "-q", *arguments], capture_output=True, text=True,
                          check=False)
    if done.returncode != 0:
        sys.exit(f"{text}\nspikeloop run {' '.join(arguments)} ended with {done.returncode}:\n{done.stderr}")


def record_drive(spikeloop, folder):
    text = subprocess.run([spikeloop, "new"], capture_output=True, text=True, check=True).stdout
    path = folder / "explorer.yaml"
    path.write_text(text)
    run(spikeloop, str(path), "--sync", "lockstep", "--duration", str(DURATION_S), "--out",
        str(folder / "drive"))
    return folder / "drive"


def compare(fused, other, layout, text):
    """The number of spikes; exits when a train differs."""
    if fused.keys() != other.keys():
        sys.exit(f"{text}\nfused recorded {sorted(fused)}, {layout} {sorted(other)}")
    for name, (times, channels) in fused.items():
        others, other_channels = other[name]
        same = len(times) == len(others) and np.array_equal(channels, other_channels)
        if not same or np.abs(times - others).max(initial=0) > 1:
            sys.exit(f"{text}\n{name}: {len(times)} spikes fused, {len(others)} {layout}; they differ")
    return sum(len(times) for times, _ in fused.values())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--spikeloop", default="build/release/bin/spikeloop")
    parser.add_argument("--graphs", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    program = str(pathlib.Path(options.spikeloop).resolve())
    spikes = 0
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        drive = record_drive(program, scratch)
        for i in range(options.graphs):
            rng = random.Random(options.seed * 100003 + i)
            text = random_experiment(rng, drive)
            path = scratch / "random.yaml"
            path.write_text(text)
            for layout, option in LAYOUTS.items():
                run(program, str(path), *option, "--out", str(scratch / layout), "--force", text=text)
            fused = spikes_of(scratch / "fused")
            for layout in ("separate", "processes"):
                spikes += compare(fused, spikes_of(scratch / layout), layout, text)
    if spikes < 100 * options.graphs:
        sys.exit(f"only {spikes} spikes in {options.graphs} graphs: nothing was compared")
    print(f"{options.graphs} graphs, {spikes} spikes: the same in every layout")


if __name__ == "__main__":
    main()
