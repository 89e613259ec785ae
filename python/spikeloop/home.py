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
        home.mkdir(mode=0o700, exist_ok=True)
        found = home.lstat()
        is_ours = found.st_uid == os.getuid() and not home.is_symlink() and not found.st_mode & 0o077
        os.environ["HOME"] = str(home) if is_ours else "/nonexistent"
