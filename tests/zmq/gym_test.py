#!/usr/bin/python3
"""A gymz-style environment closes a loop through the ZeroMQ adapters.

The environment's sockets are gymz's: it publishes observations and rewards and subscribes to
commands. Its body moves with the commanded speed, x' = command; the job commands -2 x by way of
spikes, so x must decay like exp(-2 t). The rewards come back as a FloatArray.
"""

import json
import math
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

import zmq

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "python"))
from spikeloop.bench.latency import reserved_port  # noqa: E402

STEP_S = 0.02
GAIN_HZ = 2.0
START = 1.5
REWARD = 3.0

# rate = 1000 + 500 x Hz, so 4 - rate / 250 = -2 x.
JOB = """stoptime=100
music_timestep=0.005
[observation]
  np=1
  binary={programs}/zmq_cont_adapter
  message_type=GymObservation
  zmq_addr=tcp://localhost:{observation}
[encoder]
  np=1
  binary={programs}/rate_encoder
  rate_max=2000
[decoder]
  np=1
  binary={programs}/linear_decoder
  tau=0.05
[scale]
  np=1
  binary={programs}/cont_cont_adapter
  weights_filename=scale.json
[shift]
  np=1
  binary={programs}/threshold_adapter
  threshold=-1e9
  is_heaviside=false
  shift=4
[command]
  np=1
  binary={programs}/cont_zmq_adapter
  message_type=GymCommand
  zmq_addr=tcp://*:{command}
  min=-4
  max=4
[reward]
  np=1
  binary={programs}/zmq_cont_adapter
  message_type=GymObservation
  zmq_addr=tcp://localhost:{reward}
[echo]
  np=1
  binary={programs}/cont_zmq_adapter
  message_type=FloatArray
  zmq_addr=tcp://*:{echo}
observation.out -> encoder.in [1]
encoder.out -> decoder.in [1]
decoder.out -> scale.in [1]
scale.out -> shift.in [1]
shift.out -> command.in [1]
reward.out -> echo.in [1]
"""


class Environment:
    """x' = command, observed in [-2, 2]."""

    def __init__(self, ports):
        context = zmq.Context.instance()
        self.observation = context.socket(zmq.PUB)
        self.observation.bind(f"tcp://*:{ports['observation']}")
        self.reward = context.socket(zmq.PUB)
        self.reward.bind(f"tcp://*:{ports['reward']}")
        self.command = self.subscribe(context, ports["command"])
        self.echo = self.subscribe(context, ports["echo"])
        self.x, self.speed, self.commands = START, 0.0, 0

    @staticmethod
    def subscribe(context, port):
        subscriber = context.socket(zmq.SUB)
        subscriber.connect(f"tcp://localhost:{port}")
        subscriber.setsockopt_string(zmq.SUBSCRIBE, "")
        return subscriber

    @staticmethod
    def newest(subscriber):
        text = None
        while subscriber.poll(0):
            text = subscriber.recv()
        return None if text is None else json.loads(text)

    def publish(self):
        def message(value, low, high):
            return json.dumps([{"value": value, "min": low, "max": high, "ts": time.time()}])
        self.observation.send_string(message(self.x, -2.0, 2.0))
        self.reward.send_string(message(REWARD, 0.0, 4.0))

    def step(self):
        message = self.newest(self.command)
        if message is not None:
            assert len(message) == 1 and set(message[0]) == {"value", "ts", "min", "max"}, message
            assert (message[0]["min"], message[0]["max"]) == (-4, 4), message
            assert abs(time.time() - message[0]["ts"]) < 10, message
            self.speed = message[0]["value"]
            self.commands += 1
        self.x += STEP_S * self.speed
        self.publish()
        time.sleep(STEP_S)


def run(programs, folder):
    names = ("observation", "reward", "command", "echo")
    reserved = [reserved_port() for _ in names]
    ports = {name: port.getsockname()[1] for name, port in zip(names, reserved)}
    (folder / "scale.json").write_text("[[-0.004]]")
    (folder / "job.music").write_text(JOB.format(programs=programs, **ports))
    environment = Environment(ports)
    job = subprocess.Popen([programs / "spikeloop", "run", folder / "job.music", "--quiet", "--out",
                            folder / "out"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                           text=True)
    try:
        deadline = time.monotonic() + 60
        while environment.commands == 0:
            assert job.poll() is None, job.communicate()[0]
            assert time.monotonic() < deadline, "no command came"
            environment.publish()
            time.sleep(STEP_S)
            environment.commands += environment.newest(environment.command) is not None
        environment.x = START
        began, halved = time.monotonic(), None
        while time.monotonic() < began + 4:
            environment.step()
            if time.monotonic() < began + 2:
                environment.newest(environment.echo)  # more must come afterwards
            if halved is None and environment.x < START / 2:
                halved = time.monotonic() - began
        echo = environment.newest(environment.echo)
    finally:
        job.send_signal(signal.SIGINT)
        output = job.communicate(timeout=30)[0]
        for port in reserved:
            port.close()
    print(f"x halved after {halved} s (theory without delay {math.log(2) / GAIN_HZ:.2f} s), "
          f"at the end {environment.x:.4f}; {environment.commands} commands")
    assert halved is not None and 0.2 < halved < 1.0, output
    assert abs(environment.x) < 0.1, output
    assert echo == [2 * REWARD / 4 - 1], echo


def main():
    os.environ["SPIKELOOP_OUT"] = ""
    with tempfile.TemporaryDirectory() as name:
        run(pathlib.Path(os.environ["SPIKELOOP_PROGRAMS"]), pathlib.Path(name))


if __name__ == "__main__":
    sys.exit(main())
