#!/usr/bin/python3
"""Nodes of ROS 1 that cannot be connected because of a host name or an address: a warning within 5 s names them."""

import contextlib
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading
import xmlrpc.client
import xmlrpc.server

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "fused"))
import ros  # noqa: E402
import runs  # noqa: E402

EXPERIMENT = """experiment: hosts
duration: 4 s
ros: 1
nodes:
  pose: {node: ros_sensor, topic: /odom, message: nav_msgs/Odometry}
  speed: {node: connect, weights: uniform}
  wheels: {node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, fields: {linear.x: 0, angular.z: 1}}
connections:
  - pose -> speed [2] -> wheels [2]
"""
UNRESOLVED = "the host name 'no-such-host.invalid' cannot be resolved ... /etc/hosts ... ROS_IP"


@contextlib.contextmanager
def node(data_port):
    """A node that answers, and offers its messages at this port; the address of its interface."""
    with xmlrpc.server.SimpleXMLRPCServer(("127.0.0.1", 0), logRequests=False) as server:
        server.register_function(lambda *_: (1, "", 1), "getPid")
        server.register_function(lambda *_: (1, "", ["TCPROS", "127.0.0.1", data_port]), "requestTopic")
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_address[1]}/"
        server.shutdown()


def unused_port():
    with socket.create_server(("127.0.0.1", 0)) as server:
        return server.getsockname()[1]


def run(file, expected, absent=(), **variables):
    """Runs the experiment with these variables; None removes one."""
    environment = {key: value for key, value in {**os.environ, **variables}.items() if value is not None}
    _, printed = runs.spikeloop("run", file, "--out", file.parent / "run", "--force", env=environment)
    runs.assert_says(printed, *expected)
    for text in absent:
        assert text not in printed, printed


def other_nodes(file, master):
    """Publishers and subscribers with every kind of wrong address."""
    wrong = {"name": "http://no-such-host.invalid:45123/", "port": f"http://127.0.0.1:{unused_port()}/",
             "ipv6": "http://::1:45123/"}
    for name, uri in wrong.items():
        master.registerPublisher(f"/driver_{name}", "/odom", "nav_msgs/Odometry", uri)
        master.registerSubscriber(f"/base_{name}", "/cmd_vel", "geometry_msgs/Twist", uri)
    port = unused_port()
    with node(port) as uri:
        master.registerPublisher("/driver_data", "/odom", "nav_msgs/Odometry", uri)
        run(file, (f"topic '/odom': no connection with its publisher /driver_name: {UNRESOLVED}",
                   f"topic '/cmd_vel': no connection with its subscriber /base_name: {UNRESOLVED}",
                   "its publisher /driver_ipv6: the host name '::1' has IPv6 addresses only; set ROS_IPV6=on",
                   f"its publisher /driver_port: no node answers at {wrong['port'][7:-1]} (Connection refused) ... "
                   "'rosnode cleanup' ... ROS_IP",
                   f"its publisher /driver_data: no node answers at 127.0.0.1:{port} (Connection refused)"),
            ("no message on topic '/odom' for",))
        master.unregisterPublisher("/driver_data", "/odom", uri)
    for name, uri in wrong.items():
        master.unregisterPublisher(f"/driver_{name}", "/odom", uri)
        master.unregisterSubscriber(f"/base_{name}", "/cmd_vel", uri)


def clock(file, master):
    uri = "http://no-such-host.invalid:45123/"
    master.registerPublisher("/gazebo", "/clock", "rosgraph_msgs/Clock", uri)
    by_clock = file.with_name("clock.yaml")
    by_clock.write_text(f"sync: sim_time\n{EXPERIMENT}")
    said = runs.spikeloop("run", by_clock, "--out", file.parent / "clock", "--start-timeout", "4", code=3)[1]
    runs.assert_says(said, f"topic '/clock': no connection with its publisher /gazebo: {UNRESOLVED}")
    runs.assert_says(said, "no message on /clock within 4 s: its publisher cannot be connected; start the simulator again ... [SL0702]")
    master.unregisterPublisher("/gazebo", "/clock", uri)


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        file = scratch / "hosts.yaml"
        file.write_text(EXPERIMENT)
        with ros.master(scratch) as uri, xmlrpc.client.ServerProxy(uri) as master:
            other_nodes(file, master)
            clock(file, master)
            own = "other nodes cannot connect to this one"
            run(file, (f"{own} ... 'no-such-host.invalid' (ROS_HOSTNAME=no-such-host.invalid) ... cannot be resolved "
                       "... ROS_IP ... unset ROS_HOSTNAME",), ROS_HOSTNAME="no-such-host.invalid")
            run(file, (f"{own} ... '192.0.2.1' (ROS_IP=192.0.2.1), which does not lead to this node ... ROS_IP",),
                ROS_HOSTNAME=None, ROS_IP="192.0.2.1")
            run(file, ("no message on topic '/odom' for 2 s",), (own, "no connection with"))


if __name__ == "__main__":
    sys.exit(main())
