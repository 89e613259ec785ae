#!/usr/bin/python3
"""A simulator that serves simulation_interfaces, stepped by ros/scripts/step_simulator: the same cart as in
docs/stepping.md against a recurrence by hand, twice in a row. Skipped where ROS 2 is not installed."""

import importlib.util
import pathlib
import re
import subprocess
import sys
import tempfile

import h5py
import numpy as np

import ros
import runs

SKIPPED = 77
BRIDGE = pathlib.Path(__file__).parents[2] / "ros/scripts/step_simulator"
TICKS = 500
EXPERIMENT = f"""experiment: cart
duration: {TICKS} ms
sync: lockstep
ros: 2
nodes:
  where: {{node: ros_sensor, topic: /where, message: geometry_msgs/PointStamped, fields: point.x}}
  back: {{node: connect, weights: [[-1.0]]}}
  go: {{node: ros_command, topic: /go, message: std_msgs/Float64MultiArray, deadband: 0}}
connections:
  - where -> back [1] -> go [1]
"""
# Two steps a tick, a message every tick; a node on one thread takes commands before it steps.
SIMULATOR = """import rclpy
from geometry_msgs.msg import PointStamped
from simulation_interfaces.msg import SimulationState
from simulation_interfaces.srv import ResetSimulation, SetSimulationState, StepSimulation
from std_msgs.msg import Float64MultiArray

STEP_NS = 500_000
cart = {"state": SimulationState.STATE_PLAYING}

def publish():
    message = PointStamped()
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(cart["time_ns"], 1_000_000_000)
    message.point.x = cart["x"]
    sensor.publish(message)

def reset(_, response):
    cart.update(x=1.0, v=0.0, time_ns=0)
    publish()
    response.result.result = response.result.RESULT_OK
    return response

def set_state(request, response):
    cart["state"] = request.state.state
    response.result.result = response.result.RESULT_OK
    return response

def step(request, response):
    paused = cart["state"] == SimulationState.STATE_PAUSED
    for _ in range(request.steps if paused else 0):
        cart["x"] += cart["v"] * STEP_NS * 1e-9
        cart["time_ns"] += STEP_NS
        if cart["time_ns"] % 1_000_000 == 0:
            publish()
    response.result.result = response.result.RESULT_OK if paused else response.result.RESULT_INCORRECT_STATE
    return response

rclpy.init()
node = rclpy.create_node("simulator")
sensor = node.create_publisher(PointStamped, "/where", 10)
node.create_subscription(Float64MultiArray, "/go", lambda message: cart.update(v=message.data[0]), 10)
for kind, name, function in ((ResetSimulation, "reset_simulation", reset),
                             (SetSimulationState, "set_simulation_state", set_state),
                             (StepSimulation, "step_simulation", step)):
    node.create_service(kind, name, function)
rclpy.spin(node)
"""


def by_hand():
    """Positions at the ticks: a command acts over the tick at whose end it leaves, as the simulator has it then."""
    x, wanted = 1.0, []
    for _ in range(TICKS):
        wanted.append(x)
        v = -x
        for _ in range(2):
            x += v * 500_000 * 1e-9
    return np.array(wanted)


def check_runs(scratch):
    file = scratch / "cart.yaml"
    file.write_text(EXPERIMENT)
    for name in ("first", "second"):
        summary, _ = runs.run(file, scratch / name)
        with h5py.File(scratch / name / "where.h5") as recording:
            where = recording["signals/out/values"][:, 0]
        assert np.array_equal(where, by_hand()), f"{name}: {np.abs(where - by_hand()).max()}"
    print(f"bit-identical, {1000 * summary['real_time_factor']:.0f} ticks/s")


def check_error(scratch, tick, text):
    file = scratch / "wrong.yaml"
    file.write_text(EXPERIMENT + f"tick: {tick}\n")
    _, printed = runs.run(file, scratch / "wrong", code=3)
    assert text in printed, printed


def main():
    if not all(map(importlib.util.find_spec, ("rclpy", "simulation_interfaces"))):
        print("there is no rclpy, or no simulation_interfaces, here")
        return SKIPPED
    with tempfile.TemporaryDirectory() as scratch, ros.domain():
        scratch = pathlib.Path(scratch)
        (scratch / "simulator.py").write_text(SIMULATOR)
        alone = subprocess.run([BRIDGE, "--step", "500us", "--patience", "1"], capture_output=True, text=True, check=False)
        assert alone.returncode == 3 and re.search("no node serves /?set_simulation_state", alone.stderr), alone
        with ros.program("/usr/bin/python3", scratch / "simulator.py"):
            with ros.program(BRIDGE, "--step", "500us", "--sensor", "/where=1000Hz"):
                check_runs(scratch)
                check_error(scratch, "0.8 ms", "is not a multiple of the simulator's step of 500000 ns")
            with ros.program(BRIDGE, "--step", "500us"):
                check_error(scratch, "1 ms", "the rate of /where is not known")
    return 0


if __name__ == "__main__":
    sys.exit(main())
