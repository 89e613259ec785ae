#!/usr/bin/python3
"""Who meets whom, over real interfaces: on a machine without a network, on one with it, and on two machines,
whatever ROS_AUTOMATIC_DISCOVERY_RANGE and ROS_STATIC_PEERS say on either side.

The tables are those that ROS 2 documents: who is OFF meets nobody; on one machine the others meet; on two machines
they do when both look in the subnet, or when one names the other."""

import contextlib
import itertools
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import networks

OURS, FAST_DDS = sys.argv[1:]
ADDRESSES = ("10.77.0.1", "10.77.0.2")
PATIENCE_S = 60  # Fast DDS takes one or two, a busy machine more
STRANGERS_S = 4  # as long do those get who must not meet
RANGES = ("OFF", "LOCALHOST", "SUBNET")
OF_ROS = ("ROS_", "CYCLONEDDS_")


class Side:
    """A robot or a brain: what it is told, and what it has heard."""

    def __init__(self, program, *words, machine, log, **variables):
        environment = {name: value for name, value in os.environ.items() if not name.startswith(OF_ROS)}
        self.told = f"{pathlib.Path(program).name} {' '.join(words)} {variables}"
        self._log = log
        with open(log, "w") as out:
            self._process = subprocess.Popen([*machine.enter, program, *words], stdout=out, stderr=subprocess.STDOUT,
                                             env={**environment, **variables})

    def output(self):
        return self._log.read_text()

    def met(self):
        assert self._process.poll() is None, f"{self.told}: {self.output()}"
        return "\ntwist " in self.output() or "\nscan" in self.output()

    def close(self):
        self._process.terminate()
        self._process.wait(PATIENCE_S)


def place(range_, peer, domain):
    found = {"ROS_AUTOMATIC_DISCOVERY_RANGE": range_} if range_ else {}
    return {**found, **({"ROS_STATIC_PEERS": peer} if peer else {}), "ROS_DOMAIN_ID": domain}


def meet(pairs, machines, title):
    """All of them at once, each in a domain of its own.
    @param pairs of (robot's words, its (range, peer), the brain's (range, peer), whether they meet)"""
    with tempfile.TemporaryDirectory() as scratch, contextlib.ExitStack() as stack:
        sides = []
        for i, (robot, robots, brains, _) in enumerate(pairs):
            domain = str(i)
            program, *words = robot
            sides.append([stack.enter_context(contextlib.closing(side)) for side in (
                Side(program, domain, *words, machine=machines[0], log=pathlib.Path(scratch) / f"robot{i}",
                     **place(*robots, domain)),
                Side(OURS, domain, "brain", machine=machines[1], log=pathlib.Path(scratch) / f"brain{i}",
                     **place(*brains, domain)))])
        end = time.monotonic() + PATIENCE_S
        friends = [pair for pair, (*_, wanted) in zip(sides, pairs) if wanted]
        while not all(side.met() for pair in friends for side in pair):
            missing = [side.told for pair in friends if not all(side.met() for side in pair) for side in pair]
            assert time.monotonic() < end, f"{title}: not met: {missing}"
            time.sleep(0.05)
        time.sleep(STRANGERS_S)
        strangers = [side.told for pair, (*_, wanted) in zip(sides, pairs) if not wanted
                     for side in pair if side.met()]
        assert not strangers, f"{title}: met: {strangers}"
    print(f"{title}: {len(friends)} of {len(pairs)} pairs meet, as they must")


def table(peers, rule):
    """Every range on either side, with and without a static peer.
    @param peers addresses of robot and brain"""
    robots, brains = (list(itertools.product(RANGES, ("", peer))) for peer in reversed(peers))
    return [((OURS,), robot, brain, "OFF" not in (robot[0], brain[0]) and rule(robot, brain))
            for robot, brain in itertools.product(robots, brains)]


def on_one_machine(_robot, _brain):
    return True


def on_two_machines(robot, brain):
    return robot[0] == brain[0] == "SUBNET" or bool(robot[1] or brain[1])


def fast_dds_on_one_machine():
    return [((FAST_DDS, mode), ("", ""), (range_, ""), True)
            for mode in ("subnet", "localhost", "localhost-only") for range_ in ("LOCALHOST", "SUBNET")]


def fast_dds_on_two_machines():
    """The robot names its peers itself: ROS_STATIC_PEERS is for it, too."""
    first, second = ADDRESSES
    return [((FAST_DDS, mode), ("", robots), (range_, brains), met) for mode, robots, range_, brains, met in (
        ("udp", "", "SUBNET", "", True), ("udp", "", "LOCALHOST", first, True), ("udp", "", "OFF", "", False),
        ("localhost", "", "LOCALHOST", "", False), ("localhost", "", "SUBNET", "", False),
        ("localhost", second, "LOCALHOST", "", True), ("localhost", "", "LOCALHOST", first, True),
        ("localhost", second, "SUBNET", first, True), ("localhost", second, "OFF", "", False))]


def without_end(machine):
    """A peer that cannot be reached is told of, but not for each of its ports, every time that it is looked for."""
    with tempfile.TemporaryDirectory() as scratch, contextlib.closing(
            Side(OURS, "1", "brain", machine=machine, log=pathlib.Path(scratch) / "brain",
                 **place("SUBNET", "192.0.2.7", "1"))) as side:
        end = time.monotonic() + PATIENCE_S
        told = lambda: side.output().count("192.0.2.7")  # noqa: E731
        while not told() or "ready" not in side.output():
            assert time.monotonic() < end, side.output()
            time.sleep(0.05)
        time.sleep(STRANGERS_S)
        assert told() <= 3, f"{told()} messages of one peer:\n{side.output()}"
    print("a peer that cannot be reached: told of, and no more")


def main():
    networks.enter()
    with networks.alone() as machine:
        meet(table(("127.0.0.1", "localhost"), on_one_machine) + fast_dds_on_one_machine(), (machine, machine),
             "a machine without a network")
        without_end(machine)
    with networks.joined(ADDRESSES) as (first, second):
        meet(table((ADDRESSES[0], ADDRESSES[0]), on_one_machine), (first, first), "a machine with a network")
        meet(table(ADDRESSES, on_two_machines) + fast_dds_on_two_machines(), (first, second), "two machines")
    with networks.joined(ADDRESSES, multicast=False) as machines:
        without = lambda robot, brain: bool(robot[1] or brain[1])  # noqa: E731
        meet(table(ADDRESSES, without), machines, "two machines without multicast")


if __name__ == "__main__":
    main()
