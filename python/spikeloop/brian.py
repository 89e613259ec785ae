"""Brian2 in a MUSIC job: an ordinary network, its spikes coming and going through MUSIC.

    import spikeloop.brian
    from brian2 import *

    with spikeloop.brian.music(spikes_in={"in": 100}, spikes_out={"out": 100}) as host:
        source = host.input("in")
        neurons = NeuronGroup(100, "dv/dt = -v / (10*ms) : 1", threshold="v > 1", reset="v = 0",
                              method="exact")
        synapses = Synapses(source, neurons, on_pre="v += 1.2")
        synapses.connect(j="i")
        host.output("out", neurons)
        host.run()

All of it is one run of Brian2's. docs/simulators.md has the rules.
"""

import importlib
import math
import sys

import numpy as np

from .frames import with_room
from .music_host import Host, HostError

# Cython, which Brian2 imports, takes 0.4 s for Pythran, for an option that Brian2 does not use.
sys.modules.setdefault("pythran", None)
try:
    brian2 = with_room(importlib.import_module, "brian2")
finally:
    if sys.modules["pythran"] is None:
        del sys.modules["pythran"]
from brian2.core.base import BrianObject  # noqa: E402
from brian2.core.spikesource import SpikeSource  # noqa: E402
from brian2.core.variables import Variables  # noqa: E402
from brian2.devices.device import runtime_device  # noqa: E402
from brian2.groups.group import Group  # noqa: E402
from brian2.groups.subgroup import Subgroup  # noqa: E402

WITHOUT_END_S = 1e6  # eleven days


class SpikeInput(Group, SpikeSource):
    """A spike input as a group of Brian2's: a source of synapses and monitors."""

    add_to_magic_network = True

    def __init__(self, width, name):
        Group.__init__(self, when="thresholds", name=name)
        self.start, self.stop = 0, width
        self.events = {"spike": None}
        self.variables = Variables(self)
        self.variables.add_constant("N", value=width)
        self.variables.add_arange("i", width, constant=True, read_only=True)
        self.variables.add_array("_spikespace", size=width + 1, dtype=np.int32)
        self.variables.create_clock_variables(self._clock)
        self._enable_group_attributes()
        self._space = self.variables["_spikespace"].get_value()
        self._step = 0
        self._steps = self._channels = np.zeros(0, np.int64)

    def __getitem__(self, item):
        start, stop, step = item.indices(self.stop)
        if step != 1 or start >= stop:
            raise IndexError("write a slice of neighbouring channels, such as [10:20]")
        return Subgroup(self, start, stop)

    @property
    def spikes(self):
        """The channels that spike in this step."""
        return self._space[:self._space[-1]]

    def add(self, steps, channels):
        """Spikes of the steps to come, sorted."""
        self._steps = np.concatenate((self._steps, np.maximum(steps, self._step)))
        self._channels = np.concatenate((self._channels, channels))

    def run(self):
        """A step. As many spikes fit into one as there are channels; others come a step later."""
        count = min(int(np.searchsorted(self._steps, self._step, side="right")), self.stop)
        self._space[:count] = np.sort(self._channels[:count])
        self._space[-1] = count
        if count:
            self._steps, self._channels = self._steps[count:], self._channels[count:]
        self._step += 1


class _Output(BrianObject):
    """Takes the spikes of a group, step by step."""

    def __init__(self, group):
        super().__init__(clock=group.clock, when="end")
        self.group, self._step = group, 0
        self._stamps, self._channels = [], []

    def run(self):
        spikes = self.group.spikes
        self._step += 1
        if len(spikes):
            self._channels.append(np.array(spikes))
            self._stamps.append(np.full(len(spikes), self._step))

    def take(self):
        """(numbers of the steps, from 1; channels) since the last time."""
        stamps = np.concatenate([np.zeros(0, np.int64), *self._stamps])
        channels = np.concatenate([np.zeros(0, np.int64), *self._channels])
        self._stamps, self._channels = [], []
        return stamps, channels


class _Conductor(BrianObject):
    """First in every step: turns to the next tick when it is time."""

    def __init__(self, steps_per_tick, turn):
        super().__init__(when="before_start")
        self._left, self._steps_per_tick, self._turn = 0, steps_per_tick, turn

    def run(self):
        if self._left == 0:
            self._left = self._steps_per_tick
            self._turn()
        self._left -= 1


class BrianHost(Host):
    """A Host with a network of Brian2's.

    tick: the spikeloop.music_host.Tick of now, for network operations that use continuous ports.
    """

    def __init__(self, **arguments):
        super().__init__(**arguments)
        self.tick = None
        self._inputs, self._outputs = {}, {}
        self._network = self._ticks = None
        self._step_ns = 0

    def input(self, port):
        """The SpikeInput of a spike input: a group with a neuron a channel."""
        self._check_port(port, True)
        if port not in self._inputs:
            self._inputs[port] = SpikeInput(self.widths[port], f"music_{port}")
        return self._inputs[port]

    def output(self, port, group):
        """The spikes of a group, or of a part of one, are those of a spike output."""
        self._check_port(port, False)
        if len(group) != self.widths[port]:
            raise HostError(f"host.output('{port}', ...) got a group of {len(group)} neurons, but "
                            f"the port has {self.widths[port]} channels; write as many, as in "
                            f"group[:{self.widths[port]}]")
        if port in self._outputs:
            raise HostError(f"host.output('{port}', ...) has been called before; write one group a "
                            "port")
        self._outputs[port] = _Output(group)

    def run(self, network=None, namespace=None):
        """The whole run: the objects that are visible here, as Brian2's own run() does, or a
        Network."""
        if network is None:
            network = brian2.Network(brian2.collect(level=1))
        self._network = network
        steps = self._steps_per_tick(network)
        network.add(_Conductor(steps, self._turn), *self._inputs.values(), *self._outputs.values())
        self._ticks = iter(self)
        ticks = None if self._stop_ns is None else math.ceil(self._stop_ns / self._tick_ns)
        seconds = WITHOUT_END_S if ticks is None else ticks * steps * self._step_ns / 1e9
        with_room(network.run, seconds * brian2.second, namespace=namespace, level=2)
        if self._ticks is not None:
            self._turn()

    def _turn(self):
        """Ends a tick, and begins the next one."""
        if self._ticks is None:
            return
        if self.tick is not None:
            for port, output in self._outputs.items():
                steps, channels = output.take()
                self.tick.send(port, steps * self._step_ns / 1e9, channels.astype(int))
        self.tick = next(self._ticks, None)
        if self.tick is None:
            self._ticks = None
            self._network.stop()
            return
        for port, group in self._inputs.items():
            times, channels = self.tick.spikes(port)
            stamps = np.rint(times * 1e9).astype(np.int64)
            group.add(-(-stamps // self._step_ns) - 1, channels)

    def _steps_per_tick(self, network):
        if brian2.get_device() is not runtime_device:
            raise HostError("this Brian2 device runs a program of its own; leave set_device() out")
        if float(network.t_) != 0:
            raise HostError(f"the network's time is {network.t_:g} s before the run; let host.run() "
                            "be its first")
        step_s = float(brian2.defaultclock.dt_)
        self._step_ns = round(step_s * 1e9)
        if abs(step_s * 1e9 - self._step_ns) > 1e-3 or self._step_ns < 1 \
                or self._tick_ns % self._step_ns:
            raise HostError(f"the tick of {self._tick_ns / 1e6:g} ms is not a multiple of Brian2's "
                            f"step of {step_s * 1e3:g} ms; choose another defaultclock.dt")
        groups = [*self._inputs.values(), *(each.group for each in self._outputs.values())]
        for group in groups:
            if abs(float(group.clock.dt_) - step_s) > 1e-12:
                raise HostError(f"'{group.name}' has steps of {float(group.clock.dt_) * 1e3:g} ms, "
                                f"but defaultclock.dt is {step_s * 1e3:g} ms; use one")
        return self._tick_ns // self._step_ns

    def _check_port(self, port, is_input):
        known = self._ports["spikes", is_input]
        if port not in known:
            call, group = ("input", "spikes_in") if is_input else ("output", "spikes_out")
            raise HostError(f"host.{call}('{port}'): {group} has no '{port}'; known: "
                            f"{', '.join(known) or 'none'}")


def music(**arguments):
    """As spikeloop.music, with a BrianHost."""
    return BrianHost(**arguments)
