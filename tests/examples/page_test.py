#!/usr/bin/python3
"""page_test.py --example examples/NN_NAME --source DIRECTORY --build DIRECTORY

Follows the README of an example as a new user does: in a copy of the examples beside the programs that
were built, on a terminal, command by command, and compares what is printed with what the page shows
(console.py). Pictures of the page are taken away first: its commands have to draw them again. A page with
`<!-- needs NEST -->` is not followed where there is none (tests/simulators/nest_found.py).
"""

import argparse
import os
import pathlib
import pty
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import uuid

from console import as_seen, commands_of, difference

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "simulators"))
from nest_found import directory_or_skip  # noqa: E402

LIMIT_S = 120  # for one command; nothing is timed by it
MARK = "SPIKELOOP_EXAMPLE_OF"
NEEDS_NEST = "<!-- needs NEST -->"
GENERATED = shutil.ignore_patterns("runs", "out", "build", "__pycache__")


def clone_of(source, build, folder):
    """What a user has after `git clone` and a build, as far as examples see it."""
    clone = folder / "spikeloop"
    shutil.copytree(source / "examples", clone / "examples", ignore=GENERATED)
    (clone / "build").mkdir()
    (clone / "build/release").symlink_to(build)
    (clone / "python").symlink_to(source / "python")
    return clone


def environment(clone, home, mark):
    """What examples/README.md tells a user to set, and nothing else."""
    page = (clone / "examples/README.md").read_text(encoding="utf-8")
    line = re.search(r"^ {4}(export .*)$", page, re.MULTILINE)[1]
    bare = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "HOME": str(home), "LANG": "C.UTF-8",
            "TERM": "xterm", MARK: mark}
    told = subprocess.run(["/bin/bash", "-c", f"{line} && env --null"], cwd=clone, env=bare,
                          capture_output=True, text=True, check=True).stdout
    return dict(entry.split("=", 1) for entry in told.rstrip("\0").split("\0"))


def processes_of(mark):
    """Processes that a command has started, whoever is their parent by now."""
    found = []
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if f"{MARK}={mark}".encode() in (process / "environ").read_bytes().split(b"\0"):
                found.append(int(process.name))
        except OSError:
            pass  # has ended, or somebody else's
    return found


def end(mark):
    for process in processes_of(mark):
        try:
            os.kill(process, signal.SIGKILL)
        except ProcessLookupError:
            pass


def run_on_terminal(command, folder, variables):
    """Exit code and output; 124 and what there is after LIMIT_S."""
    master, slave = pty.openpty()
    child = subprocess.Popen(["/bin/bash", "-c", command], cwd=folder, env=variables,
                             stdin=subprocess.DEVNULL, stdout=slave, stderr=slave,
                             start_new_session=True)
    os.close(slave)
    os.set_blocking(master, False)
    output, until = b"", time.monotonic() + LIMIT_S
    while time.monotonic() < until:
        try:
            output += os.read(master, 65536)
        except BlockingIOError:
            time.sleep(0.01)
        except OSError:  # nobody has the terminal any more
            break
    else:
        end(variables[MARK])
        return 124, output.decode(errors="replace")
    os.close(master)
    return child.wait(), output.decode(errors="replace")


def left_behind(mark):
    """Those that have not ended 5 s after their command: a guard needs 2."""
    until = time.monotonic() + 5
    while processes_of(mark) and time.monotonic() < until:
        time.sleep(0.05)
    return processes_of(mark)


def fault_of(command, folder, variables):
    """None, or a text."""
    code, output = run_on_terminal(command.text, folder, variables)
    printed = as_seen(output)
    fault = difference(command.expected, printed, command.percent)
    if code != command.exit_code:
        fault = f"ends with {code}, not {command.exit_code}"
    if left_behind(variables[MARK]):
        fault = "leaves processes behind"
        end(variables[MARK])
    if fault:
        shown = "".join(f"\n    {line}" for line in printed)
        return f"README.md:{command.line}: $ {command.text}\n  {fault}; all of its output:{shown}"
    return None


def size_of(picture):
    """Width and height of a PNG; of an SVG, that it is one."""
    data = picture.read_bytes()
    if data.startswith(b"\x89PNG\r\n\x1a\n"):
        return struct.unpack(">II", data[16:24])
    return "svg" if b"<svg" in data[:2000] and data.rstrip().endswith(b"</svg>") else None


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--example", required=True, type=pathlib.Path)
    parser.add_argument("--source", required=True, type=pathlib.Path)
    parser.add_argument("--build", required=True, type=pathlib.Path)
    given = parser.parse_args()
    text = (given.example / "README.md").read_text(encoding="utf-8")
    nest = directory_or_skip() if NEEDS_NEST in text else ""
    text = text.replace(NEEDS_NEST, "")
    commands = commands_of(text)
    if not commands:
        sys.exit(f"{given.example}/README.md shows no command")
    with tempfile.TemporaryDirectory() as directory:
        clone = clone_of(given.source.resolve(), given.build.resolve(), pathlib.Path(directory))
        home = pathlib.Path(directory) / "home"
        home.mkdir()
        folder = clone / "examples" / given.example.name
        pictures = [name for name in re.findall(r"!\[[^]]*\]\(([^)/]+)\)", text)]
        sizes = {name: size_of(folder / name) for name in pictures}
        for name in pictures:
            (folder / name).unlink()
        variables = environment(clone, home, uuid.uuid4().hex)
        if nest:
            variables["PYTHONPATH"] += f":{nest}"
        for command in commands:
            fault = fault_of(command, folder, variables)
            if fault:
                sys.exit(fault)
        for name in pictures:
            if not (folder / name).exists():
                sys.exit(f"README.md shows {name}, and none of its commands draws it")
            if size_of(folder / name) != sizes[name] or not sizes[name]:
                sys.exit(f"{name}: {size_of(folder / name)} was drawn, committed is {sizes[name]}")
    print(f"{len(commands)} commands, {len(pictures)} pictures")


if __name__ == "__main__":
    main()
