"""Functions that create files, as those of core/file.hpp."""

import os
import pathlib


def create(path, mode="xb", **options):
    """Opens a new file for writing. Removes a file or symbolic link of that name first: another user who can write to
    the folder could have made a link to any file of ours. @raises OSError"""
    pathlib.Path(path).unlink(missing_ok=True)
    return open(path, mode, **options)  # x: fails if the name exists, also as a link


def write_whole(path, text):
    """Writes a new file next to the path and renames it, so that no reader sees half a file. @raises OSError"""
    new = path.with_name(path.name + ".new")
    with create(new, "x", encoding="utf-8") as file:
        file.write(text)
    os.replace(new, path)
