"""The processes of a running job."""

import contextlib
import os
import pathlib


def _all():
    """Parents, and programs with their environments, of every process that can be read, by id."""
    parents, known = {}, {}
    for entry in pathlib.Path("/proc").iterdir():
        with contextlib.suppress(OSError, ValueError, IndexError):
            pid = int(entry.name)
            parents[pid] = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
            words = (entry / "cmdline").read_text(errors="replace").split("\0")
            # What MUSIC has started keeps MUSIC's command line; scripts have Python's file.
            words = words[1:2] + [os.readlink(entry / "exe")]
            known[pid] = ([os.path.basename(word) for word in words],
                          (entry / "environ").read_text(errors="replace").split("\0"))
    return parents, known


def processes_of(launcher):
    """Program and environment of every process that the launcher has started, by id."""
    parents, known = _all()

    def belongs(pid):
        while pid in parents:
            if pid == launcher:
                return True
            pid = parents[pid]
        return False
    return {pid: known[pid] for pid in known if belongs(pid)}


def with_environment(word):
    """Programs of all processes with this word, NAME=VALUE, in their environment, by id."""
    return {pid: words for pid, (words, environment) in _all()[1].items() if word in environment}


def find(launcher, program, section=None):
    """Of several processes of a program that of the section."""
    for pid, (words, environment) in processes_of(launcher).items():
        if program in words and (section is None or any(
                word.startswith(f"_MUSIC_CONFIG_={section}:") for word in environment)):
            return pid
    raise AssertionError(f"no process runs {program}")


def guard_of(launcher):
    """The guard, which is nobody's child: what the launcher has started knows where it listens."""
    sockets = {word.removeprefix("SPIKELOOP_GUARD=") for _, environment in processes_of(launcher).values()
               for word in environment if word.startswith("SPIKELOOP_GUARD=")}
    for pid, (words, _) in _all()[1].items():
        with contextlib.suppress(OSError):
            if "spikeloop-guard" in words and sockets & set(
                    pathlib.Path(f"/proc/{pid}/cmdline").read_text(encoding="utf-8").split("\0")):
                return pid
    raise AssertionError("the job has no guard")
