"""NEURON in a MUSIC job: an ordinary model, its spikes coming and going through MUSIC.

    import spikeloop.neuron
    from neuron import h

    with spikeloop.neuron.music(spikes_in={"in": 1}, spikes_out={"out": 1}) as host:
        soma = h.Section(name="soma")
        soma.insert("hh")
        synapse = h.ExpSyn(soma(0.5))
        synapse.tau = 2
        host.connect_input("in", 0, synapse, weight=1, delay_ms=1)
        host.connect_output("out", 0, soma(0.5)._ref_v, sec=soma, threshold_mV=0)
        host.run(v_init_mV=-65)

Importing this module imports NEURON, which has to come before MPI is up. docs/simulators.md has the
rules.
"""

import collections
import ctypes
import os

import numpy as np

from .music_host import Host, HostError
from .music_library import find


def _open_communicator():
    """Before NEURON: python/neuron/communicator.cpp says why."""
    path, _ = find("spikeloop_neuron_mpi")
    return path and ctypes.CDLL(path, ctypes.RTLD_GLOBAL)


communicator = _open_communicator()
os.environ.setdefault("NEURON_MODULE_OPTIONS", "-nogui")  # or it complains that there is no screen
from neuron import h  # noqa: E402

# NEURON's time is a sum of steps: an event on a tick's border would come before or after it by
# chance. This much earlier (1e-12 s), it comes before, and rounds to the same nanosecond.
EARLY_MS = 1e-9
BEFORE_ALL = 3  # type of h.FInitializeHandler: before NEURON empties its queues
LONGEST_STEP_MS = 10  # of NEURON's own exchange between processes


class NeuronHost(Host):
    """A Host with a NEURON model. With np processes in its section, h.ParallelContext() made after it
    has these: pc.id() and pc.nhost() tell which cells are whose."""

    _many_processes = True

    def __init__(self, **arguments):
        super().__init__(**arguments)
        if self._library.processes() > 1:
            communicator.spikeloop_stand_in_for_world(self._library.communicator())
            h.nrnmpi_init()
        # Without it before h.finitialize(), processes exchange spikes once a tick only.
        self._before = h.FInitializeHandler(
            BEFORE_ALL, lambda: h.ParallelContext().set_maxstep(LONGEST_STEP_MS))
        self._inputs = {port: collections.defaultdict(list)
                        for port in self._ports["spikes", True]}
        self._outputs = {}
        self._kept = []
        self._context = None

    def connect_input(self, port, channel, target, *, weight=0.0, delay_ms=0.0):
        """A NetCon from a channel of a spike input to a point process or artificial cell.

        weight: of its kind's unit. delay_ms: milliseconds from 0. Both may be changed later. Of several
        processes every one gets all spikes of the input, and connects those that its own cells need.
        """
        self._check_channel(port, channel, True)
        self._keep(target)
        connection = h.NetCon(None, target)
        connection.delay = delay_ms
        connection.weight[0] = weight
        self._inputs[port][channel].append(connection)
        return connection

    def connect_output(self, port, channel, source, *, sec=None, threshold_mV=None):
        """A NetCon whose spikes are a channel of a spike output.

        source: an artificial cell or point process, or a variable such as soma(0.5)._ref_v with its
        section. threshold_mV: without it, NEURON's 10 mV. Of several processes the one that has the
        cell calls this; a channel is connected in one of them.
        """
        self._check_channel(port, channel, False)
        self._keep(source, sec)
        connection = h.NetCon(source, None) if sec is None else h.NetCon(source, None, sec=sec)
        if threshold_mV is not None:
            connection.threshold = threshold_mV
        times, channels, connections = self._outputs.setdefault(
            port, (h.Vector(), h.Vector(), collections.defaultdict(list)))
        connection.record(times, channels, channel)
        connections[channel].append(connection)
        return connection

    def _keep(self, end, sec=None):
        """NEURON deletes a cell, or a section, that no variable holds: what is connected stays."""
        segment = end.get_segment() if sec is None and hasattr(end, "get_segment") else None
        section = segment.sec if segment is not None else sec
        self._kept.append((end, section.wholetree() if section is not None else None))

    def run(self, v_init_mV=-65):
        """h.finitialize(v_init_mV), and the loop to the end of the run."""
        h.finitialize(v_init_mV)
        for tick in self:
            self.advance(tick)

    def advance(self, tick):
        """NEURON's part of a tick, for a loop of one's own after h.finitialize(): spikes go in, the
        model advances to tick.end_s, spikes go out."""
        if self._context is None:
            self._begin(tick)
        if not h.CVode().active():
            h.t = tick.begin_ns / 1e6  # its sum of steps has drifted
        for port, connections in self._inputs.items():
            self._deliver(tick, port, connections)
        self._context.psolve(tick.end_ns / 1e6)
        for port in self._outputs:
            self._collect(tick, port)

    def _begin(self, tick):
        if abs(h.t - tick.begin_ns / 1e6) > EARLY_MS:
            raise HostError(f"NEURON's time is {h.t:g} ms at the first tick; call h.finitialize() "
                            "before the loop, and leave h.run() and h.continuerun() out")
        steps = self._tick_ns / 1e6 / h.dt
        if not h.CVode().active() and (round(steps) < 1 or abs(steps - round(steps)) > 1e-6):
            raise HostError(f"the tick of {self._tick_ns / 1e6:g} ms is not a multiple of NEURON's step "
                            f"h.dt of {h.dt:g} ms; choose another h.dt, or variable steps: "
                            "h.CVode().active(True)")
        self._context = h.ParallelContext()
        self._check_owners()

    def _check_owners(self):
        """A script that makes every cell in every process would send each spike several times."""
        own = {(port, channel) for port, (_, _, connections) in self._outputs.items()
               for channel in connections}
        owner = {}
        for process, theirs in enumerate(self._context.py_allgather(own)):
            for port, channel in sorted(theirs):
                first = owner.setdefault((port, channel), process)
                if first != process:
                    raise HostError(
                        f"channel {channel} of '{port}' is connected in the processes {first} and "
                        f"{process}, and would send each spike twice; make a cell in one process:  "
                        "for gid in range(int(pc.id()), CELLS, int(pc.nhost())): ...")

    @staticmethod
    def _deliver(tick, port, connections):
        times, channels = tick.spikes(port)
        # Those that came late act at once.
        times_ms = np.maximum(times, (tick.begin_ns + 1) / 1e9) * 1e3 - EARLY_MS
        for time, channel in zip(times_ms.tolist(), channels.tolist()):
            for connection in connections.get(channel, ()):
                connection.event(time + connection.delay)

    def _collect(self, tick, port):
        times, channels, _ = self._outputs[port]
        if not times.size():
            return
        stamps = np.rint(np.array(times) * 1e6)
        # NEURON finds what happened on the border of a tick in the next one.
        tick.send(port, np.maximum(stamps, tick.begin_ns + 1) / 1e9, np.array(channels).astype(int))
        times.resize(0)
        channels.resize(0)

    def _check_channel(self, port, channel, is_input):
        known = self._ports["spikes", is_input]
        call, group = ("connect_input", "spikes_in") if is_input else ("connect_output",
                                                                       "spikes_out")
        if port not in known:
            raise HostError(f"{call}('{port}', ...): {group} has no '{port}'; known: "
                            f"{', '.join(known) or 'none'}")
        if channel != int(channel) or not 0 <= channel < self.widths[port]:
            raise HostError(f"{call}('{port}', {channel}, ...): the port has channels 0 to "
                            f"{self.widths[port] - 1}")


def music(**arguments):
    """As spikeloop.music, with a NeuronHost."""
    return NeuronHost(**arguments)
