#!/usr/bin/python3
"""music/waiting.cpp, preloaded: who only waits sleeps in between, who computes in between does not.

Sleeps are counted as voluntary context switches, which other programs on the machine do not change.
"""

import os
import subprocess
import sys

# Prints the sleeps in so many calls of sched_yield(), with so many us of work before each.
PROGRAM = """
import os, resource, time
def switches():
    return resource.getrusage(resource.RUSAGE_THREAD).ru_nvcsw
before = switches()
for _ in range({calls}):
    end = time.perf_counter() + {work_us} * 1e-6
    while time.perf_counter() < end:
        pass
    os.sched_yield()
print(switches() - before)
"""


def sleeps(library, calls, work_us):
    environment = {**os.environ, "LD_PRELOAD": library}
    program = PROGRAM.format(calls=calls, work_us=work_us)
    return int(subprocess.run([sys.executable, "-c", program], env=environment, check=True,
                              capture_output=True, text=True, timeout=60).stdout)


library = sys.argv[1]
waiting = sleeps(library, calls=20_000, work_us=0)
computing = sleeps(library, calls=2_000, work_us=100)
without = sleeps("", calls=20_000, work_us=0)
print(f"sleeps: waiting {waiting} of 20,000 calls, computing {computing} of 2,000, without the library {without}")
assert waiting > 1_000
assert computing < 20
assert without < 20
