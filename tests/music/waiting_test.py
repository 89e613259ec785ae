#!/usr/bin/python3
"""music/waiting.cpp, preloaded: who only waits sleeps in between, who computes in between does not.

Sleeps are counted as voluntary context switches. When others keep the machine busy everybody sleeps
for 20 ms: whoever computes in between is not counted then.
"""

import os
import subprocess
import sys

COMMON = """
import os, resource, time
def switches():
    return resource.getrusage(resource.RUSAGE_THREAD).ru_nvcsw
last = time.monotonic() + 1
"""
# Both print their sleeps in a second. The first calls as fast as MPI does: again within 300 ns.
WAITING = COMMON + """
before = switches()
while time.monotonic() < last:
    for _ in range(100):
        os.sched_yield()
print(switches() - before)
"""
# Works for 100 us before each call.
COMPUTING = COMMON + """
slept = busy_until = 0
while time.monotonic() < last:
    end = time.perf_counter() + 100e-6
    while time.perf_counter() < end:
        pass
    before, begin = switches(), time.monotonic()
    os.sched_yield()
    if begin > busy_until:
        slept += switches() - before
    if time.monotonic() - begin > 0.9e-3:
        busy_until = time.monotonic() + 25e-3
print(slept)
"""


def sleeps(library, program):
    environment = {**os.environ, "LD_PRELOAD": library}
    return int(subprocess.run([sys.executable, "-c", program], env=environment, check=True,
                              capture_output=True, text=True, timeout=60).stdout)


library = sys.argv[1]
waiting = sleeps(library, WAITING)
computing = sleeps(library, COMPUTING)
without = sleeps("", WAITING)
print(f"sleeps in a second: waiting {waiting}, computing {computing}, without the library {without}")
assert waiting > 100
assert computing < 20
assert without < 20
