#!/usr/bin/python3
"""The ROS 1 master is on another machine: a node that registers as localhost is reported, with the address to write."""

import os
import pathlib
import subprocess
import sys
import tempfile

sys.path += [str(pathlib.Path(__file__).resolve().parents[1] / folder) for folder in ("ros2", "fused")]
import networks  # noqa: E402
import ros  # noqa: E402
import runs  # noqa: E402
from hosts_test import EXPERIMENT  # noqa: E402

ADDRESSES = ("10.61.0.1", "10.61.0.2")
PORT = "11311"


def run(machine, file, **variables):
    environment = {**os.environ, "ROS_MASTER_URI": f"http://{ADDRESSES[1]}:{PORT}", **variables}
    done = subprocess.run([*machine.enter, runs.SPIKELOOP, "run", file, "--out", file.parent / "run", "--force"],
                          capture_output=True, text=True, check=False, timeout=60, env=environment)
    assert done.returncode == 0, done.stderr
    return done.stderr


def main():
    networks.enter()
    with tempfile.TemporaryDirectory() as scratch, networks.joined(ADDRESSES) as (first, second):
        file = pathlib.Path(scratch) / "hosts.yaml"
        file.write_text(EXPERIMENT)
        os.environ.update(ROS_LOG_DIR=scratch)
        master = subprocess.Popen([*second.enter, "rosmaster", "--core", "-p", PORT], stdout=subprocess.DEVNULL,
                                  env={**os.environ, "ROS_IP": ADDRESSES[1]})
        try:
            connect = [*first.enter, "bash", "-c", f"< /dev/tcp/{ADDRESSES[1]}/{PORT}"]
            ros.until(lambda: subprocess.run(connect, stderr=subprocess.DEVNULL, check=False).returncode == 0, "a master")
            printed = run(first, file, ROS_HOSTNAME="localhost")
            runs.assert_says(printed, "other nodes cannot connect to this one ... 'localhost' (ROS_HOSTNAME=localhost), "
                             f"which only this machine reaches ... set ROS_IP to {ADDRESSES[0]}, and unset ROS_HOSTNAME")
            assert "other nodes" not in run(first, file, ROS_IP=ADDRESSES[0])
        finally:
            master.terminate()
            master.wait()


if __name__ == "__main__":
    sys.exit(main())
