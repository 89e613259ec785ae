"""One run of the chain: what it took, and whether every spike came through.

Build: from the start of `spikeloop run` to the begin of the first tick, when all programs are made,
connected and, in the separate layout, have met in MUSIC (a barrier in MPI); run: from there to the
end of the last tick of the slowest program. Only the run counts for the real-time factor.
"""

import json
import math
import re
import subprocess
import sys
import tempfile
import threading
import time
import pathlib

from . import chain
from ..progress import end_process
from ..run_folder import counters_of

BUILD_LIMIT_S = 300  # simulators that make a neuron a call in Python take their time
END_S = 30  # for a job to end once it was stopped
_FIRST_TICK = re.compile(r"^spikeloop: [0-9.]+ of ")


class TrialError(Exception):
    """A run failed: what it said last."""


class OutOfTime(Exception):
    """The time for the whole bench is over."""


class Job:
    """A run of a program of ours as a child, in a session of its own: Ctrl-C is ours to pass on."""

    def __init__(self, arguments, folder):
        self.folder = folder
        self.began = time.monotonic()
        self.first_tick = None  # when it was told that the loop had begun
        self.said = []
        try:
            self.process = subprocess.Popen(
                [str(word) for word in arguments], cwd=folder, stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace",
                start_new_session=True)
        except OSError as error:
            raise TrialError(f"cannot start '{arguments[0]}': {error.strerror}") from None
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self):
        for line in self.process.stderr:
            if self.first_tick is None and _FIRST_TICK.match(line):
                self.first_tick = time.monotonic()
            if line.strip():
                self.said.append(line.strip())

    def reason(self):
        """The launcher's last word."""
        words = [line for line in self.said if line.startswith("spikeloop: ")]
        return words[-1].removeprefix("spikeloop: ") if words else \
            f"spikeloop run ended with exit code {self.process.returncode}"

    def wait(self, limit_s, deadline):
        """True: it came to its end. False: its run took longer than limit_s, and was stopped."""
        try:
            while True:
                try:
                    self.process.wait(0.02)
                    return True
                except subprocess.TimeoutExpired:
                    pass
                now = time.monotonic()
                if self.first_tick is not None and now - self.first_tick > limit_s:
                    return False
                if now > deadline:
                    raise OutOfTime
                if self.first_tick is None and now - self.began > BUILD_LIMIT_S:
                    raise TrialError(f"no first tick within {BUILD_LIMIT_S} s")
        finally:
            self.stop()

    def stop(self):
        if self.process.poll() is None:
            end_process(self.process, END_S)
        self._reader.join(END_S)
        self.process.stderr.close()


def run(programs, setting, limit_s, deadline=math.inf):
    """Measures a setting once: what results.json has of a trial.

    programs: the folder of ours. limit_s: a run that takes longer is stopped; its factor is then
    an upper bound, below duration / limit. Raises TrialError, OutOfTime.
    """
    if time.monotonic() > deadline:
        raise OutOfTime
    with tempfile.TemporaryDirectory(prefix="spikeloop-bench-") as name:
        folder = pathlib.Path(name)
        if setting.layout == "alone":
            return _run_alone(folder, setting, limit_s)
        file = chain.write(setting, folder)
        options = ([] if setting.layout == "fused" else
                   ["--start-timeout", str(BUILD_LIMIT_S), "--stall-timeout", "0"])
        job = Job([programs / "spikeloop", "run", file, "--no-record", "--out", "out", *options], folder)
        complete = job.wait(limit_s, deadline)
        ended = time.monotonic()
        if not complete:
            return _trial(job.first_tick - job.began, limit_s,
                          _factor_when_stopped(setting, folder, limit_s), None)
        if job.process.returncode != 0:
            raise TrialError(job.reason())
        return _evaluated(setting, json.loads((folder / "out/summary.json").read_text()),
                          ended - job.began)


def _factor_when_stopped(setting, folder, limit_s):
    """Of one process as far as it came; of several, of which some are ahead, an upper bound."""
    try:
        summary = json.loads((folder / "out/summary.json").read_text())
        if setting.layout == "fused" and summary["simulated_s"] > 0:
            return summary["simulated_s"] / summary["wall_s"]
    except (OSError, ValueError, KeyError):
        pass  # it had to be killed
    return setting.duration_s / limit_s


def _run_alone(folder, setting, limit_s):
    """NEST without a job."""
    (folder / "nest.json").write_text(json.dumps({
        "neurons": setting.neurons, "tick_ms": setting.tick_ms,
        "resolution_ms": min(chain.RESOLUTION_MS, setting.tick_ms),
        "duration_ms": setting.duration_s * 1000,
        "rate_hz": (setting.rate_min_hz + setting.rate_max_hz) / 2}))
    try:
        done = subprocess.run([sys.executable, chain.HERE / "brains/nest_alone.py"], cwd=folder,
                              capture_output=True, text=True, check=False,
                              timeout=BUILD_LIMIT_S + limit_s, start_new_session=True)
    except subprocess.TimeoutExpired:
        return _trial(0, limit_s, setting.duration_s / limit_s, None)
    if done.returncode != 0:
        raise TrialError((done.stderr.strip().splitlines() or ["NEST failed"])[-1])
    said = json.loads(done.stdout.strip().splitlines()[-1])
    return _trial(said["build_s"], said["run_s"], setting.duration_s / said["run_s"],
                  said["spikes"])


def _trial(build_s, run_s, factor, spikes):
    trial = {"build_s": round(build_s, 4), "run_s": round(run_s, 9), "real_time_factor": factor,
             "spikes": spikes}
    if spikes is None:
        trial["stopped"] = True  # the factor is an upper bound
    return trial


def _evaluated(setting, summary, total_s):
    counters = counters_of(summary)
    run_s = summary["wall_s"]
    if "processes" in summary:
        processes = summary["processes"].values()
        # The source alone may be far ahead of the others.
        run_s = max(wall_s(process) for process in processes)
    encoded, decoded = counters["encoder.spikes"], counters["decoder.spikes"]
    trial = _trial(total_s - run_s, run_s, setting.duration_s / run_s, decoded)
    check_spikes(setting, encoded, decoded)
    return trial


def wall_s(process):
    """Of a process's loop, as it reported it; 0 for one that does not report."""
    return process["counters"].get("wall_ns", 0) / 1e9 or process["summary"].get("wall_s", 0)


def check_spikes(setting, encoded, decoded):
    """A run that loses spikes measures nothing: TrialError when numbers are not those of theory.

    Rate neurons fire once an integral of 1, Poisson neurons within six standard deviations of it.
    What a simulator holds at the end, at most what was encoded within its delay, need not be
    decoded.
    """
    if setting.encoder != "nef":
        expected = chain.expected_spikes_a_neuron(setting) * setting.neurons
        most = setting.neurons if setting.encoder == "rate" else 6 * math.sqrt(expected) + 1
        if abs(encoded - expected) > most:
            raise TrialError(f"the encoder sent {encoded} spikes, but its rate's integral is "
                             f"{expected:.0f}")
    late = 0
    if setting.simulator != "none":
        delay_s = (2 * setting.tick_ms + 3 * chain.RESOLUTION_MS) / 1000
        share = 1 if setting.encoder == "rate" else 0.1
        late = setting.neurons * (share + delay_s * setting.rate_max_hz)
        late += encoded * delay_s / setting.duration_s if setting.encoder == "nef" else 0
    if not encoded - late <= decoded <= encoded or encoded == 0:
        raise TrialError(f"{encoded} spikes were encoded, but {decoded} reached the decoder")
