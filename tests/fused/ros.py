"""A ROS master, or a domain of ROS 2, of a test's own."""

import contextlib
import fcntl
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import xmlrpc.client

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "python"))
from spikeloop.bench.latency import reserved_port  # noqa: E402


def _answers(uri):
    try:
        return xmlrpc.client.ServerProxy(uri).getUri("/test")[0] == 1
    except OSError:
        return False


@contextlib.contextmanager
def master(scratch, *program):
    """Starts rosmaster, or this program, on a free port and points this process and its children to it."""
    program = program or ("rosmaster", "--core")
    before = dict(os.environ)
    os.environ.update(ROS_HOSTNAME="localhost", ROS_LOG_DIR=str(scratch / "ros"))
    with reserved_port() as reserved:
        port = str(reserved.getsockname()[1])
        os.environ["ROS_MASTER_URI"] = uri = f"http://localhost:{port}"
        core = subprocess.Popen([*program, "-p", port], stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL)
        while core.poll() is None and not _answers(uri):
            time.sleep(0.1)
        assert core.poll() is None, f"{program[0]} does not start"
        try:
            yield uri
        finally:
            core.send_signal(signal.SIGINT)
            try:
                core.wait(30)
            except subprocess.TimeoutExpired:  # it still calls nodes that were killed
                core.kill()
                core.wait()
            os.environ.clear()
            os.environ.update(before)


@contextlib.contextmanager
def domain():
    """Puts this process and its children where no other test of this machine is, and nobody hears them.
    tests/ros2/domain.hpp takes domains by the same files."""
    before = dict(os.environ)
    for number in range(1, 101):
        path = pathlib.Path(tempfile.gettempdir()) / f"spikeloop-test-ros-domain-{number}"
        with open(os.open(path, os.O_RDWR | os.O_CREAT, 0o666), "r+b") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            os.environ.update(ROS_DOMAIN_ID=str(number), ROS_LOCALHOST_ONLY="1")
            try:
                yield number
            finally:
                os.environ.clear()
                os.environ.update(before)
            return
    raise RuntimeError("a hundred tests use a ROS domain each")


@contextlib.contextmanager
def place(version, scratch):
    """Where nodes of this version meet."""
    with master(scratch) if version == "1" else domain() as where:
        yield where


@contextlib.contextmanager
def program(*command):
    """A program that is ended with the block."""
    process = subprocess.Popen([str(word) for word in command])
    try:
        yield process
    finally:
        process.send_signal(signal.SIGCONT)
        process.send_signal(signal.SIGINT)
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def until(condition, what, patience_s=60):
    """Waits for a condition, which must come true."""
    end = time.monotonic() + patience_s
    while not condition():
        assert time.monotonic() < end, f"{what} has not happened within {patience_s} s"
        time.sleep(0.02)
