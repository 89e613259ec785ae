"""Which simulators can take part here."""

import functools
import pathlib
import subprocess
import sys
import tempfile

from . import chain

NAMES = {"none": "no simulator", "builtin": "built-in", "nest": "NEST", "neuron": "NEURON",
         "brian2": "Brian2"}
_MODULES = {"nest": "nest", "neuron": "neuron", "brian2": "brian2"}


def lacks(simulator, layout, programs):
    """Why it cannot be measured in this layout; empty when it can. programs: the folder of ours."""
    if simulator not in _MODULES:
        return ""
    return _refused(simulator, layout, programs) or _not_installed(simulator)


@functools.cache
def _refused(simulator, layout, programs):
    """What Spikeloop itself says of it: not every layout has every simulator."""
    if layout == "alone":
        return ""
    setting = chain.Setting(layout, "rate", simulator, chain.SCAN_MS, 1, 1, 2, 1.0)
    with tempfile.TemporaryDirectory() as name:
        file = chain.write(setting, pathlib.Path(name))
        done = subprocess.run([programs / "spikeloop", "check", file], cwd=name, text=True,
                              capture_output=True, check=False, stdin=subprocess.DEVNULL)
    errors = [line for line in (done.stdout + done.stderr).splitlines()
              if line.startswith("error: ")]
    return errors[0].split("node 'brain': ")[-1] if done.returncode and errors else ""


@functools.cache
def _not_installed(simulator):
    name, module = NAMES[simulator], _MODULES[simulator]
    try:
        done = subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True,
                              text=True, timeout=120, check=False, stdin=subprocess.DEVNULL)
    except subprocess.TimeoutExpired:
        return f"'import {module}' did not come back within 120 s"
    said = done.stderr.strip().splitlines()
    if done.returncode != 0:
        missing = f"No module named '{module}'" in (said[-1] if said else "")
        return f"{name} is not installed" if missing else \
            f"{name} cannot be imported: {said[-1] if said else done.returncode}"
    return ""
