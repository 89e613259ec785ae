"""What `spikeloop bench` does; its options are checked and explained in C++ (bench_command.cpp)."""

import argparse
import pathlib
import sys
import time

from ..progress import Progress, Stopped, take_signals

EXIT_MISSING, EXIT_PACKAGE, EXIT_FILE = 1, 3, 4
QUICK_S = 100  # wall time of --quick for everything but the end
# Parts of the time until which a part has to be done; what it leaves is for the next.
QUICK_SHARES = {"a": 0.45, "b": 0.55, "d": 0.72, "c": 1.0}
ORDER = "abdc"
PROTOCOL = {
    "source": "100 beams at 20 Hz, made inside (signal_playback); part c over ROS 1",
    "chain": "scan -> connect (uniform weights) -> encoder -> (repeaters) -> readout (uniform) -> "
             "low pass; NEF: 16 means of neighbouring beams",
    "rates": "rate and Poisson neurons 1 to 2 Hz in a and d; NEF neurons: preset rma, the constants "
             "of the paper's programs",
    "ticks": "50 ms in a and b",
    "build": "from the start of `spikeloop run` until all programs are made and have met at MUSIC's "
             "barrier (fused: until the graph is made); not counted",
    "run": "from there to the end of the slowest program's last tick, as fast as it goes (sync: "
           "unpaced); real-time factor = simulated time / run",
    "largest": "decades, then halving with one trial a number; what is found is in real time in the "
               "median of all trials. A factor below 0.5 has one trial; a run that takes longer than "
               "the limit is stopped (`stopped`), and its factor, in the separate layout, is an upper "
               "bound",
    "spikes": "that reached the readout, compared with the integral of the rate (rate: within 1 a "
              "neuron; Poisson: 6 standard deviations)",
}


def _arguments(arguments):
    parser = argparse.ArgumentParser(prog="spikeloop bench")
    parser.add_argument("--programs", type=pathlib.Path, required=True)
    for name in ("part", "layouts", "simulators", "encoders"):
        parser.add_argument(f"--{name}", type=lambda text: text.split(","), required=True)
    for name in ("ticks", "rates"):
        parser.add_argument(f"--{name}", required=True,
                            type=lambda text: sorted({float(word) for word in text.split(",")}))
    for name in ("trials", "steps", "neurons", "most"):
        parser.add_argument(f"--{name}", type=int, required=True)
    parser.add_argument("--duration", type=float, required=True)
    parser.add_argument("--limit", type=float)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    for name in ("quick", "draw", "again"):
        parser.add_argument(f"--{name}", action="store_true")
    return parser.parse_args(arguments)


def _plan(given):
    from . import sweeps
    plan = sweeps.Plan(
        layouts=given.layouts, simulators=given.simulators, encoders=given.encoders,
        ticks_ms=given.ticks, rates_hz=given.rates, trials=given.trials, steps=given.steps,
        neurons=given.neurons, least=sweeps.LEAST, most=given.most, duration_s=given.duration,
        limit_s=given.limit or 2 * given.duration, again=given.again)
    if given.quick:  # the rest of it is in the options: bench_command.cpp
        plan.least, plan.precision = 10_000, 10
    return plan


def _refuse_parts_of_ticks(given, plan):
    from .results import ResultsError
    from .sweeps import COARSE_TICK_MS
    ticks_ms = ([COARSE_TICK_MS] if {"a", "b"} & set(given.part) else []) + (
        plan.ticks_ms if "d" in given.part else [])
    for tick_ms in ticks_ms:
        ticks = plan.duration_s * 1000 / tick_ms
        if abs(ticks - round(ticks)) > 1e-6:
            raise ResultsError(
                f"--duration {plan.duration_s:g} is not a whole number of ticks of {tick_ms:g} ms; write "
                "another duration, or --ticks that divide it", 2)


def _measure(given, plan, results, progress):
    from . import latency, sweeps
    began = time.monotonic()
    work = sweeps.Sweeps(given.programs, plan, results, progress.say)
    for part in (part for part in ORDER if part in given.part):
        progress.part = part
        if given.quick:
            work.deadline = began + QUICK_S * QUICK_SHARES[part]
        if part == "c":
            latency.part_c(given.programs, plan, results, progress.say,
                           lambda: work.deadline - time.monotonic())
        else:
            {"a": work.part_a, "b": work.part_b, "d": work.part_d}[part]()


def _show(results):
    """Table and pictures."""
    from . import pictures, table
    document = results.document()
    for line in table.lines(document):
        print(line)
    for path in pictures.draw(document, results.path.parent):
        print(path)


def _fail(message, code):
    print(f"spikeloop: {message}", file=sys.stderr)
    return code


def _run(given):
    from . import paper
    from .results import Results, ResultsError
    plan = _plan(given)
    notes = {**paper.as_json(), "protocol": PROTOCOL, "duration_s": plan.duration_s}
    results = Results(given.out, notes)
    if given.draw:
        if results.empty:
            raise ResultsError(f"'{results.path}' has no results to draw; leave out --draw", 4)
        _show(results)
        return 0
    _refuse_parts_of_ticks(given, plan)
    results.refuse_other_machine()
    try:
        given.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ResultsError(f"cannot make '{given.out}': {error.strerror}") from None
    progress, stopped = Progress(), None
    take_signals()
    try:
        _measure(given, plan, results, progress)
    except Stopped as stop:
        stopped = stop
    progress.end()
    results.keep()
    _show(results)
    if stopped is not None:
        return _fail(f"stopped by {stopped}; what was measured is in {results.path}, and the same "
                     "command goes on from there", 128 + stopped.number)
    return EXIT_MISSING if any(entry["failed"] for entry in results.not_measured) else 0


def main(arguments=None):
    words = sys.argv[1:] if arguments is None else arguments
    try:
        from .results import ResultsError
        from . import pictures  # noqa: F401: all packages, before hours of work
    except ImportError as error:
        package = (error.name or "matplotlib").split(".")[0]
        return _fail(f"Python's package {package} is missing, or of no use ({error}); "
                     f"apt-get install python3-{package}", EXIT_PACKAGE)
    try:
        if "--learning" in words:
            from . import learning
            return learning.run(words)
        return _run(_arguments(words))
    except ResultsError as error:
        return _fail(error, error.code)
