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


def parent(pid):
    """The id of the parent; None if the process has ended."""
    with contextlib.suppress(OSError):
        return int(pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[1])
    return None


def _name(pid):
    """The name of the process, which a fork can change; at most 15 characters."""
    with contextlib.suppress(OSError):
        return pathlib.Path(f"/proc/{pid}/comm").read_text().strip()
    return ""


def roles(launcher):
    """What each process of a run does, by id: launcher, supervisor, cleaner, mpirun, guard, live server, robot;
    "experiment" for the only process of the nodes; else the section of the .music file, or the program."""
    programs = {"orterun": "mpirun", "spikeloop-live": "live server", "spikeloop-robot": "robot",
                "spikeloop-fused": "experiment", "spikeloop": "supervisor of another program"}
    found, family = {}, processes_of(launcher)
    supervised = [parent(pid) for pid, (words, _) in family.items() if words[-1] in ("orterun", "spikeloop-fused")]
    for pid, (words, environment) in family.items():
        section = next((word.removeprefix("_MUSIC_CONFIG_=").split(":")[0] for word in environment
                        if word.startswith("_MUSIC_CONFIG_=")), "")
        if pid == launcher:
            found[pid] = "launcher"
        elif _name(pid) == "spikeloop-tidy":
            found[pid] = "cleaner"
        elif words[-1] == "spikeloop" and pid in supervised:
            found[pid] = "supervisor"
        else:
            found[pid] = section or programs.get(words[-1], words[-1])
    with contextlib.suppress(AssertionError):
        found[guard_of(launcher)] = "guard"
    return found


def state(pid):
    """The letter of /proc/PID/stat: T if the process is stopped; empty if it has ended, also as a zombie."""
    with contextlib.suppress(OSError):
        letter = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
        return "" if letter in "ZX" else letter
    return ""


def shared_files(pids):
    """Files and folders of /dev/shm that these processes have open or mapped."""
    paths = set()
    for pid in pids:
        with contextlib.suppress(OSError):
            paths |= {line.split()[-1] for line in pathlib.Path(f"/proc/{pid}/maps").read_text().splitlines()}
            for entry in pathlib.Path(f"/proc/{pid}/fd").iterdir():
                with contextlib.suppress(OSError):
                    paths.add(os.readlink(entry))
    return {pathlib.Path("/dev/shm") / path.split("/")[3] for path in paths if path.startswith("/dev/shm/")}


def send(pids, number):
    """Sends a signal to those that still exist."""
    for pid in pids:
        with contextlib.suppress(ProcessLookupError):
            os.kill(pid, number)


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
