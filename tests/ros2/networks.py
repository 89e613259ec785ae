"""Machines of a test's own: network namespaces of the kernel, joined by a cable or alone. Where the kernel
gives none, as in most containers, a test says so and is skipped."""

import contextlib
import os
import subprocess
import sys

SKIPPED = 77
_INSIDE = "SPIKELOOP_TEST_INSIDE_NETWORKS"
_UNSHARED = ["unshare", "--map-root-user", "--net", "--mount"]
# In a chroot the kernel refuses namespaces of users, and mounts of a test's own. Then /dev/shm is shared.
_IN_CHROOT = ["unshare", "--net"]


def _refusal(unshared):
    try:
        tried = subprocess.run([*unshared, "ip", "link", "set", "lo", "up"], capture_output=True, text=True,
                               check=False)
    except OSError as error:
        return str(error)
    return tried.stderr.strip() if tried.returncode else ""


def enter(as_root=False):
    """Runs this program once more, where it may make networks, and shares no memory with others.
    @param as_root where root may change users, as an sshd does: of this machine, not of a namespace"""
    if _INSIDE in os.environ:
        if os.environ[_INSIDE] == "mounts":
            subprocess.run(["mount", "-t", "tmpfs", "none", "/dev/shm"], check=True)
        return
    # With a namespace of processes nobody outlives the test.
    unshared = ["unshare", "--net", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc"] if as_root \
        else _UNSHARED
    why = _refusal(unshared)
    if why and not as_root and os.getuid() == 0 and not _refusal(_IN_CHROOT):
        unshared = _IN_CHROOT
    elif why:
        print(f"not run: here are no network namespaces ({why})")
        sys.exit(SKIPPED)
    os.environ[_INSIDE] = "mounts" if "--mount" in unshared else "network"
    os.execvp("unshare", [*unshared, sys.executable, "-B", *sys.argv])


def _ip(words):
    subprocess.run(["ip", *words.split()], check=True)


class Machine:
    """A loopback interface that is up, and a name."""

    def __init__(self, name="machine"):
        self._holder = subprocess.Popen(
            ["unshare", "-n", "-u", "sh", "-c", f"hostname {name} && ip link set lo up && echo up && exec cat"],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self._holder.stdout.readline() == "up\n"
        self.pid = self._holder.pid
        self.enter = ["nsenter", f"--net=/proc/{self.pid}/ns/net", f"--uts=/proc/{self.pid}/ns/uts"]

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


@contextlib.contextmanager
def switched(addresses):
    """Machines on one switch: m1, m2 and so on, with these addresses; cut_off() takes the cable out of one."""
    with contextlib.ExitStack() as stack:
        _ip("link add switch type bridge")
        _ip("link set switch up")
        machines = []
        for i, address in enumerate(addresses, 1):
            machine = stack.enter_context(contextlib.closing(Machine(f"m{i}")))
            _ip(f"link add port{i} type veth peer name cable{i}")
            _ip(f"link set port{i} master switch up")
            _ip(f"link set cable{i} netns {machine.pid}")
            machine.connect(f"cable{i}", address)
            machines.append(machine)
        yield machines


def cut_off(number):
    """@param number 1 for the first of switched()"""
    _ip(f"link set port{number} down")
