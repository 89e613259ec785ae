#!/usr/bin/python3
"""Latency from a scan to the resulting command, as a function of the tick: the paper's figure.

    benchmarks/latency/measure_latency.py [--ticks 1,10,50] [--trials 100] [--network]
                                          [--layouts separate,fused] [--ros 1,2] [--json FILE]

This is part c of `spikeloop bench`, over ROS 1, ROS 2 or both (the protocol is described in
python/spikeloop/bench/latency.py).
`--network` adds a repeater of the built-in network between encoder and decoder.
"""

import argparse
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "python"))
from spikeloop.bench import latency  # noqa: E402: from this tree


def measure(place, options):
    rows = []
    for network in ([False, True] if options.network else [False]):
        for tick in (float(text) for text in options.ticks.split(",")):
            for layout in options.layouts.split(","):
                rows.append(latency.measure(options.build.resolve() / "bin", place, layout, tick,
                                            options.trials, network))
                print(f"measured: ROS {place.version}, {layout}, tick {tick:g} ms", file=sys.stderr)
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ticks", default="1,10,50", help="ms, separated by commas")
    parser.add_argument("--trials", type=int, default=100)
    parser.add_argument("--layouts", default="separate,fused", help="separated by commas")
    parser.add_argument("--ros", default="1", help="versions, separated by commas")
    parser.add_argument("--network", action="store_true", help="also with the built-in network")
    parser.add_argument("--build", default=ROOT / "build/release", type=pathlib.Path)
    parser.add_argument("--json", type=pathlib.Path, help="write the rows to this file")
    options = parser.parse_args()
    rows = []
    try:
        for version in options.ros.split(","):
            with latency.RosMaster() if version == "1" else latency.Domain() as place:
                rows += measure(place, options)
    except latency.LatencyError as error:
        raise SystemExit(str(error)) from None
    print("\n".join(latency.table(rows)))
    if options.json:
        options.json.write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
