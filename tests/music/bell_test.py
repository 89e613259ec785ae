#!/usr/bin/python3
"""music/bell.cpp, preloaded: a message wakes the program that waits for it, which sleeps until then instead of looking
again and again. Messages arrive all the same when the senders have no bells, or Open MPI sends them in pieces."""

import os
import pathlib
import struct
import subprocess
import sys
import tempfile

LIBRARY, PROGRAM = sys.argv[1:3]
MESSAGES = 42
MOST_SLEEPS = 20  # on a busy machine; else five for a message that comes after 2.5 to 5 ms, and up to 40 without bells
# Twenty messages of each rank, the large ones' first and last value.
SUM = sum(i + 1000 * rank for rank in (0, 2) for i in range(20)) + 2 * 2


def slept(folder, *, bells):
    command = ["mpirun", "--allow-run-as-root", "-np", "3", "--oversubscribe", "--bind-to", "none",
               "--mca", "mpi_yield_when_idle", "1", "--mca", "mpi_event_tick_rate", "1000000",
               "-x", f"LD_PRELOAD={LIBRARY}", *(["-x", f"SPIKELOOP_STATUS={folder}/status"] if bells else []), PROGRAM]
    environment = {name: value for name, value in os.environ.items() if name != "SPIKELOOP_STATUS"}
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True, timeout=120)
    total, times = map(float, done.stdout.split())
    assert total == SUM, (total, SUM)
    return times


with tempfile.TemporaryDirectory() as scratch:
    folder = pathlib.Path(scratch)
    with_bells, without = slept(folder, bells=True), slept(folder, bells=False)
    print(f"sleeps for a message: with bells {with_bells}, without {without}")
    assert with_bells <= MOST_SLEEPS
    bells, = folder.iterdir()
    rings = [struct.unpack("=I", bells.read_bytes()[64 * rank:][:4])[0] for rank in range(3)]
    assert bells.stat().st_size == 3 * 64 and rings[1] >= MESSAGES, rings
    # Whoever waits until its message is received is rung for that.
    assert min(rings) >= MESSAGES / 4, rings
