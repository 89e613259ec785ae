"""Machines of a test's own: network namespaces of the kernel, joined by a cable or alone. Where the kernel
gives none, as in most containers, a test says so and is skipped."""

import contextlib
import os
import subprocess
import sys

SKIPPED = 77
_INSIDE = "SPIKELOOP_TEST_INSIDE_NETWORKS"
_UNSHARED = ["unshare", "--map-root-user", "--net", "--mount"]


def _refusal():
    try:
        tried = subprocess.run([*_UNSHARED, "ip", "link", "set", "lo", "up"], capture_output=True, text=True,
                               check=False)
    except OSError as error:
        return str(error)
    return tried.stderr.strip() if tried.returncode else ""


def enter():
    """Runs this program once more, where it may make networks, and shares no memory with others."""
    if _INSIDE in os.environ:
        subprocess.run(["mount", "-t", "tmpfs", "none", "/dev/shm"], check=True)
        return
    if why := _refusal():
        print(f"not run: here are no network namespaces ({why})")
        sys.exit(SKIPPED)
    os.environ[_INSIDE] = "1"
    os.execvp("unshare", [*_UNSHARED, sys.executable, "-B", *sys.argv])


def _ip(words):
    subprocess.run(["ip", *words.split()], check=True)


class Machine:
    """A loopback interface that is up."""

    def __init__(self):
        self._holder = subprocess.Popen(["unshare", "-n", "sh", "-c", "ip link set lo up && echo up && cat"],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self._holder.stdout.readline() == "up\n"
        self.pid = self._holder.pid
        self.enter = ["nsenter", f"--net=/proc/{self.pid}/ns/net"]

    def close(self):
        self._holder.communicate()

    def connect(self, name, address):
        """Brings up an interface that this machine has been given."""
        subprocess.run([*self.enter, "sh", "-ec", f"ip address add {address}/24 dev {name}; ip link set {name} up"],
                       check=True)


@contextlib.contextmanager
def alone():
    """A machine without a network."""
    with contextlib.closing(Machine()) as machine:
        yield machine


@contextlib.contextmanager
def joined(addresses, multicast=True):
    """Two machines on one cable, with these addresses."""
    with contextlib.closing(Machine()) as first, contextlib.closing(Machine()) as second:
        _ip("link add left type veth peer name right")
        for machine, name, address in zip((first, second), ("left", "right"), addresses):
            if not multicast:
                _ip(f"link set {name} multicast off")
            _ip(f"link set {name} netns {machine.pid}")
            machine.connect(name, address)
        yield first, second
