"""A ROS master of a test's own."""

import contextlib
import os
import signal
import socket
import subprocess
import time
import xmlrpc.client


def _free_port():
    with socket.socket() as free:
        free.bind(("", 0))
        return free.getsockname()[1]


def _answers(uri):
    try:
        return xmlrpc.client.ServerProxy(uri).getUri("/test")[0] == 1
    except OSError:
        return False


@contextlib.contextmanager
def master(scratch):
    """Starts roscore on a free port and points this process and its children to it."""
    before = dict(os.environ)
    os.environ.update(ROS_HOSTNAME="localhost", ROS_LOG_DIR=str(scratch / "ros"))
    for _ in range(5):  # somebody else may take the port
        port = str(_free_port())
        os.environ["ROS_MASTER_URI"] = uri = f"http://localhost:{port}"
        core = subprocess.Popen(["roscore", "-p", port], stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL)
        while core.poll() is None and not _answers(uri):
            time.sleep(0.1)
        if core.poll() is None:
            break
    assert core.poll() is None, "roscore does not start"
    try:
        yield uri
    finally:
        core.send_signal(signal.SIGINT)
        core.wait(30)
        os.environ.clear()
        os.environ.update(before)


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
