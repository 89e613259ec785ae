"""Which NEST there is, for tests that need one.

SPIKELOOP_NEST names directories, separated by colons, each with a package `nest`; without it NEST is
what /usr/bin/python3 imports.
"""

import os
import subprocess
import sys

PYTHON = "/usr/bin/python3"
SKIPPED = 77  # CMakeLists.txt says so to ctest
KINDS = ("with-music", "without-music")
ASK = "import nest; print('have', nest.ll_api.sli_func('statusdict/have_music ::'))"


def kind_of(directory):
    """Of the NEST in this directory, or in Python's own path; None: there is none."""
    environment = {**os.environ, "PYNEST_QUIET": "1"}
    if directory:
        environment["PYTHONPATH"] = directory
    asked = subprocess.run([PYTHON, "-c", ASK], env=environment, capture_output=True, text=True,
                           timeout=120, check=False)
    return {"have True": KINDS[0], "have False": KINDS[1]}.get(asked.stdout.strip())


def directory_or_skip(kind=None):
    """Of the NEST of this kind, or of the first one; empty: Python finds it by itself. Ends the test,
    as one that was not run, when there is none."""
    named = os.environ.get("SPIKELOOP_NEST", "").split(":")
    found = {kind_of(directory): directory for directory in reversed(named)}
    found.pop(None, None)
    if kind is None and found:
        return list(found.values())[-1]
    if kind in found:
        return found[kind]
    wanted = "NEST" if kind is None else "NEST " + kind.replace("-music", " MUSIC")
    other = "".join(f", only one {each.replace('-music', ' MUSIC')}" for each in found)
    print(f"not run: {wanted} is not installed for {PYTHON}{other}; write the directory of its "
          "package `nest` into SPIKELOOP_NEST", flush=True)
    sys.exit(SKIPPED)
