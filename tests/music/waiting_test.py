#!/usr/bin/python3
"""music/waiting.cpp, preloaded: who only waits sleeps in between, who computes in between does not.

Sleeps are counted as voluntary context switches. When others keep the machine busy everybody sleeps
for 20 ms: whoever computes in between is not counted then.
"""

import os
import subprocess
import sys

# Prints the sleeps in a second of calls of sched_yield(), with so many us of work before each.
PROGRAM = """
import os, resource, time
def switches():
    return resource.getrusage(resource.RUSAGE_THREAD).ru_nvcsw
slept = busy_until = 0
last = time.monotonic() + 1
while time.monotonic() < last:
    end = time.perf_counter() + {work_us} * 1e-6
    while time.perf_counter() < end:
        pass
    before, begin = switches(), time.monotonic()
    os.sched_yield()
    if begin > busy_until or {work_us} == 0:
        slept += switches() - before
    if time.monotonic() - begin > 0.9e-3:
        busy_until = time.monotonic() + 25e-3
print(slept)
"""


def sleeps(library, work_us):
    environment = {**os.environ, "LD_PRELOAD": library}
    program = PROGRAM.format(work_us=work_us)
    return int(subprocess.run([sys.executable, "-c", program], env=environment, check=True,
                              capture_output=True, text=True, timeout=60).stdout)


library = sys.argv[1]
waiting = sleeps(library, work_us=0)
computing = sleeps(library, work_us=100)
without = sleeps("", work_us=0)
print(f"sleeps in a second: waiting {waiting}, computing {computing}, without the library {without}")
assert waiting > 100
assert computing < 20
assert without < 20
