"""A home directory for users without one: processes/home.hpp for Python that `spikeloop` has not started."""

import os
import pathlib
import tempfile


def provide_home():
    """Sets HOME if neither HOME nor the user database contains a home directory: matplotlib cannot be imported without
    one."""
    try:
        pathlib.Path.home()
    except RuntimeError:
        home = pathlib.Path(tempfile.gettempdir(), f"spikeloop-home-{os.getuid()}")
        os.environ["HOME"] = str(home) if _is_private(home) else "/nonexistent"


def _is_private(folder):
    """Creates the folder. False if that fails, or if another user has made it or can write to it."""
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.lstat()
    except OSError:
        return False
    return found.st_uid == os.getuid() and not folder.is_symlink() and not found.st_mode & 0o077
