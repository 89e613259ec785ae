"""Functions that create files, as those of core/file.hpp."""

import contextlib
import errno
import os
import pathlib
import stat

# Errors of removing or renaming a file that may not prevent writing to it: the file is bind-mounted into a container,
# or only its folder is not writable.
_PREVENT_REPLACEMENT = (errno.EBUSY, errno.EACCES, errno.EPERM, errno.EROFS)


def create(path, mode="xb", **options):
    """Opens a new file for writing. Removes a file or symbolic link of that name first: another user who can write to
    the folder could have made a link to any file of ours. @raises OSError"""
    try:
        pathlib.Path(path).unlink(missing_ok=True)
    except OSError as error:
        return open(_open_existing(path, error), mode.replace("x", "w"), **options)
    return open(path, mode, **options)  # x: fails if the name exists, also as a link


def _open_existing(path, error):
    """Empties a file that cannot be replaced because of `error`, and returns its descriptor. Raises `error` for a
    symbolic link, a file of another user and a file with a second name."""
    if error.errno not in _PREVENT_REPLACEMENT:
        raise error
    try:
        file = os.open(path, os.O_WRONLY | os.O_NONBLOCK | os.O_NOFOLLOW)
    except OSError:
        raise error from None
    status = os.fstat(file)
    if not stat.S_ISREG(status.st_mode) or status.st_uid != os.geteuid() or status.st_nlink != 1:
        os.close(file)
        raise error
    os.ftruncate(file, 0)
    return file


def write_whole(path, text):
    """Writes a new file next to the path and renames it, so that no reader sees half a file. @raises OSError"""
    new = path.with_name(path.name + ".new")
    try:
        with create(new, "x", encoding="utf-8") as file:
            file.write(text)
        os.replace(new, path)
    except OSError as error:
        with open(_open_existing(path, error), "w", encoding="utf-8") as file:
            file.write(text)
        with contextlib.suppress(OSError):
            new.unlink()
