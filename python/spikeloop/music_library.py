"""Finds and opens the libraries behind spikeloop.music, Experiment.open and read_messages."""

import importlib.util
import os
import shutil
import sys

PACKAGE = os.path.dirname(os.path.abspath(__file__))


def _directories():
    written = os.environ.get("SPIKELOOP_LIBRARY_PATH", "")
    yield from (directory for directory in written.split(":") if directory)
    programs = os.environ.get("SPIKELOOP_PROGRAMS")
    if programs:
        yield os.path.join(programs, "../lib/spikeloop")
    # PREFIX/share/spikeloop/python/spikeloop, in the build tree as installed.
    yield os.path.join(PACKAGE, "../../../../lib/spikeloop")
    program = shutil.which("spikeloop")
    if program:
        yield os.path.join(os.path.dirname(os.path.realpath(program)), "../lib/spikeloop")


def find(name):
    """(path or None, where it was looked for) of a library of ours."""
    tried = [os.path.normpath(os.path.join(directory, f"lib{name}.so"))
             for directory in _directories()]
    return next((path for path in tried if os.path.exists(path)), None), tried


def library(name="spikeloop_python_music", user="spikeloop.music"):
    """The module. Raises ImportError that says what to do."""
    if name in sys.modules:
        return sys.modules[name]
    found, tried = find(name)
    if found is None:
        raise ImportError(f"{user} needs its library, which is not in: {', '.join(tried)};"
                          " start the job with `spikeloop run`, or write the directory of "
                          f"lib{name}.so into SPIKELOOP_LIBRARY_PATH")
    spec = importlib.util.spec_from_file_location(name, found)
    try:
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    except ImportError as error:
        version = f"{sys.version_info.major}.{sys.version_info.minor}"
        raise ImportError(f"{found} does not open in this Python, {sys.executable} {version}: "
                          f"{error}; begin the script with #!/usr/bin/python3") from None
    sys.modules[name] = module
    return module
