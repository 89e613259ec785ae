#!/usr/bin/python3
"""`spikeloop import`: the experiment gives the spikes that the .music job gave under MUSIC.

The input of both is what a robot's drive recorded. Jobs are written as the older families wrote
them, and as `spikeloop export` writes random experiments.
"""

import argparse
import pathlib
import random
import shutil
import subprocess
import tempfile

import random_graphs

# Older names, defaults of both dialects, files that are missing or do not fit, delays.
OLDER = """stoptime=0.5
music_timestep=0.001
seed=7
sync=unpaced
dialect={dialect}
[scan]
np=1
binary=signal_playback
file={drive}/scan.h5
[beams]
np=1
binary=spike_playback
file={drive}/encoder.h5
[speed]
np=1
binary=signal_playback
file={drive}/decoder.h5
[mean]
np=1
binary=cont_cont_adapter
weights_filename=missing.json
[some]
np=1
binary=connect_adapter
weights_filename=data/some.json
signal_delay=2
[squash]
np=1
binary=sigmoid_adapter
slope=4
[regular]
np=1
binary=rate_encoder
rate_min=1
rate_max=0.2 kHz
[poisson]
np=1
binary=poisson_encoder
rate_max=150
[nef]
np=2
binary=nef_encoder
neuron_resolution=0.0005
gain_max=200
spike_times=interpolated
[brain]
np=1
binary=spikeloop-network
network=brain.yaml
[readout]
np=1
binary=linear_readout_decoder
tau=0.025
weights_filename=data/readout.json
spike_delay=3
[each]
np=1
binary=linear_decoder
[end]
np=1
binary=rate_encoder
[last]
np=1
binary=rate_encoder
[a]
np=1
binary=linear_decoder
[b]
np=1
binary=linear_decoder
[c]
np=1
binary=linear_decoder
[d]
np=1
binary=linear_decoder
scan.out -> mean.in [100]
scan.out -> some.in [100]
mean.out -> squash.in [3]
squash.out -> regular.in [3]
some.out -> poisson.in [2]
speed.out -> nef.in [2]
nef.out -> readout.in [20]
beams.out -> brain.in [10]
brain.out -> each.in [10]
each.out -> end.in [4]
readout.out -> last.in [2]
regular.out -> a.in [3]
poisson.out -> b.in [2]
end.out -> c.in [4]
last.out -> d.in [2]
a.out -> use.in [3]
b.out -> use2.in [2]
c.out -> use3.in [4]
d.out -> use4.in [2]
"""
USES = "".join(f"[{name}]\nnp=1\nbinary=threshold_adapter\n" for name in
               ("use", "use2", "use3", "use4"))


def older_text(dialect, drive):
    head, connections = OLDER.split("scan.out ->", 1)
    loops = "".join(f"{name}.out -> {last}.in [{width}]\n" for name, last, width in
                    (("use", "z", 3), ("use2", "y", 2), ("use3", "x", 4), ("use4", "w", 2)))
    ends = "".join(f"[{name}]\nnp=1\nbinary=rate_encoder\n" for name in "zyxw")
    return (head + USES + ends + "scan.out ->" + connections + loops).format(
        dialect=dialect, drive=drive)


def run(spikeloop, *arguments):
    done = subprocess.run([spikeloop, *map(str, arguments)], capture_output=True, text=True,
                          check=False)
    assert done.returncode == 0, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def same_spikes(spikeloop, job, folder, *more):
    """Imports the job, runs the experiment in one process; the number of equal spikes."""
    imported = job.with_name("imported.yaml")
    said = run(spikeloop, "import", job, "--out", imported)
    run(spikeloop, "check", imported)
    for name in ("fused", "job"):
        shutil.rmtree(folder / name, ignore_errors=True)
    run(spikeloop, "run", "-q", imported, "--out", folder / "fused", *more)
    run(spikeloop, "run", "-q", job, "--record", "--out", folder / "job")
    spikes = random_graphs.compare(random_graphs.spikes_of(folder / "fused"),
                                   random_graphs.spikes_of(folder / "job"), "separate", imported.read_text())
    return spikes, said, imported.read_text()


def older_families(spikeloop, folder, drive):
    here = folder / "older"
    (here / "data").mkdir(parents=True)
    (here / "data" / "some.json").write_text("[[0.5, 0.5, -1], [1]]")  # 100 inputs: does not fit
    rng = random.Random(3)
    rows = [[round(rng.uniform(-1, 1) / 20, 4) for _ in range(20)] for _ in range(2)]
    (here / "data" / "readout.json").write_text(str(rows))
    (here / "brain.yaml").write_text(
        "populations: {input: {model: input, size: 10}, relay: {model: repeater, size: 10}}\n"
        "connections: [{from: input, to: relay, rule: one_to_one, delay: 0.7 ms}]\n"
        "output: [relay]\n")
    counts = []
    for dialect in ("rma", "ma"):
        job = here / "old.music"
        job.write_text(older_text(dialect, drive))
        spikes, said, text = same_spikes(spikeloop, job, folder)
        counts.append(spikes)
        assert f"preset: {dialect}" in text, text
        assert "resolution: 0.5 ms" in text and "rate_max: 0.2 kHz" in text, text
        assert "weights: uniform\n" in text and "weights: data/readout.json\n" in text, text
        assert "warning:" in said and "missing.json" in said and "some.json" in said, said
        assert "brain.out -> each [10, delay 0 ticks]" in text, text
        assert "scan -> some [100, delay 3 ticks]" in text, text
        assert "nef -> readout [20, delay 3 ticks]" in text, text
    assert counts[0] != counts[1] and min(counts) > 1000, counts


def what_export_writes(spikeloop, folder, drive, graphs):
    """The way there and back gives the same spikes."""
    spikes = 0
    for i in range(graphs):
        path = folder / "random.yaml"
        path.write_text(random_graphs.random_experiment(random.Random(7919 + i), drive, parts=False))
        job = folder / "job-of-random"
        shutil.rmtree(job, ignore_errors=True)
        run(spikeloop, "export", path, "--out", job)
        imported = folder / "back.yaml"
        run(spikeloop, "import", job / "experiment.music", "--out", imported)
        for name, file in (("there", path), ("back", imported)):
            shutil.rmtree(folder / name, ignore_errors=True)
            run(spikeloop, "run", "-q", file, "--out", folder / name)
        spikes += random_graphs.compare(random_graphs.spikes_of(folder / "there"),
                                        random_graphs.spikes_of(folder / "back"), "once more",
                                        imported.read_text())
    assert spikes > 100 * graphs, spikes


def the_example(spikeloop, folder, example):
    """Braitenberg's vehicle drives on what import makes of its .music file."""
    shutil.copytree(example, folder / "braitenberg")
    target = folder / "braitenberg" / "imported.yaml"
    said = run(spikeloop, "import", folder / "braitenberg" / "braitenberg.music", "--robot",
               "--out", target)
    assert said == "", said
    assert "OK: 5 nodes, 4 connections" in run(spikeloop, "check", target)
    run(spikeloop, "run", target, "--sync", "lockstep", "--duration", "2", "--out",
        folder / "driven")
    assert sum(len(times) for times, _ in random_graphs.spikes_of(folder / "driven").values()) > 9000


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--spikeloop", required=True)
    parser.add_argument("--example", required=True, help="examples/01_braitenberg")
    parser.add_argument("--graphs", type=int, default=5)
    options = parser.parse_args()
    program = str(pathlib.Path(options.spikeloop).resolve())
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        drive = random_graphs.record_drive(program, folder)
        the_example(program, folder, options.example)
        what_export_writes(program, folder, drive, options.graphs)
        older_families(program, folder, drive)


if __name__ == "__main__":
    main()
