"""Which simulators can take part here."""

import subprocess
import sys

NAMES = {"none": "no simulator", "builtin": "built-in", "nest": "NEST", "neuron": "NEURON",
         "brian2": "Brian2"}
_MODULES = {"nest": "nest", "neuron": "neuron", "brian2": "brian2"}
NOT_FUSED = "simulators take part as programs of the separate layout in this version"
_known = {}


def lacks(simulator, layout):
    """Why it cannot be measured in this layout; empty when it can."""
    if simulator not in _MODULES:
        return ""
    if layout == "fused":
        return NOT_FUSED
    if simulator not in _known:
        _known[simulator] = _lacks(simulator)
    return _known[simulator]


def _lacks(simulator):
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
