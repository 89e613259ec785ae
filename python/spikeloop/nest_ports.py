"""How spikes come into NEST and out of it: through its own MUSIC proxies, or without them."""

import nest
import numpy as np

from .music_host import HostError, Tick

# NEST keeps all that a recorder has seen while it runs; when it is more than this and the number of
# nodes, to begin anew is less work than to look through it every tick.
MOST_EVENTS = 1000
MOST_CONNECTIONS_LOOKED_AT = 1_000_000

# Times on the stack for each of the numbers of nodes below them; a call of nest.SetStatus a node
# takes longer than a tick of many neurons. Between two ticks all of Python is out of the processor's
# caches: each line counts here.
DEFINE_SET_SPIKE_TIMES = """
/spikeloop_set_spike_times
{ 2 arraystore { << >> begin /spike_times Set currentdict end SetStatus } ScanThread } def
"""
# What a recorder has, if it is more than the number on the stack below it; 0: no more.
DEFINE_MORE_EVENTS = """
/spikeloop_more_events
{ GetStatus dup /n_events get 3 -1 roll gt { /events get } { pop 0 } ifelse } def
"""


class Recorder:
    """A spike_recorder of a port, read while NEST runs."""

    def __init__(self, neurons, delay_ms):
        ids = np.array(neurons.tolist())
        self._first = ids.min()
        self._channels = np.zeros(ids.max() - self._first + 1, np.int64)
        self._channels[ids - self._first] = np.arange(len(ids))
        self._node = nest.Create("spike_recorder", params={"time_in_steps": True})
        self._number = self._node.tolist()[0]
        nest.Connect(neurons, self._node, syn_spec={"delay": delay_ms})
        self.seen = 0

    def take(self, step_ns, precise):
        """(times in ns, channels) since the last time. precise: with the offsets that neurons with
        precise spike times give, instead of rounded up to the step."""
        nest.ll_api.sps(self.seen)
        nest.ll_api.sps(self._number)
        nest.ll_api.sr("spikeloop_more_events")
        events = nest.ll_api.spp()
        if events == 0:
            return (), ()
        new = slice(self.seen, None)
        self.seen = len(events["times"])
        times = events["times"][new] * step_ns
        if precise:
            times -= np.rint(events["offsets"][new] * 1e6).astype(np.int64)
        return times, self._channels[events["senders"][new] - self._first]

    def clear(self):
        """Between nest.Cleanup() and nest.Prepare()."""
        self._node.n_events = 0
        self.seen = 0


class Exchange:
    """What both ways have in common."""

    def __init__(self, host):
        self._host = host
        self._inputs, self._rate_inputs, self._recorders = {}, {}, {}
        self._tick_ms = host.tick_s * 1e3

    def _begin(self):
        """Defined and asked once, because NEST answers slowly."""
        nest.ll_api.sr(DEFINE_MORE_EVENTS)
        self._step_ns = round(nest.resolution * 1e6)
        # What several threads have recorded is not in the order in which it came.
        one_thread = nest.local_num_threads == 1
        self._most_events = max(MOST_EVENTS, nest.network_size) if one_thread else 0

    def input(self, port, precise):
        """The nodes of a port, made once."""
        if port not in self._inputs:
            self._inputs[port] = self._make_input(port, precise)
        return self._inputs[port]

    def rate_input(self, port):
        """The nodes of a continuous input, made once."""
        if port not in self._rate_inputs:
            self._rate_inputs[port] = self._make_rate_input(port)
        return self._rate_inputs[port]

    def _held_rates(self, port):
        """Rate neurons that stay at the rate they are set to."""
        return nest.Create("lin_rate_ipn", self._host.widths[port], {"sigma": 0.0, "lambda": 0.0})

    def _take_spikes(self, tick, precise):
        for port, recorder in self._recorders.items():
            times, channels = recorder.take(self._step_ns, precise)
            if len(times):
                Tick.send(tick, port, times / 1e9, channels)
        if sum(recorder.seen for recorder in self._recorders.values()) > self._most_events:
            nest.Cleanup()
            for recorder in self._recorders.values():
                recorder.clear()
            nest.Prepare()

    def _add_recorder(self, port, neurons):
        self._recorders[port] = Recorder(neurons, self._tick_ms)

    @staticmethod
    def _once(call, port, known):
        if port in known:
            raise HostError(f"host.{call}('{port}', ...) has been called before; write one group a "
                            "port")


class Generators(Exchange):
    """For a NEST without MUSIC: a spike_generator a channel, and a spike_recorder a port."""

    def __init__(self, host):
        super().__init__(host)
        self._records, self._precise = {}, {}

    def _make_input(self, port, precise):
        self._precise[port] = precise
        return nest.Create("spike_generator", self._host.widths[port], {"precise_times": precise})

    def output(self, port, neurons):
        self._once("output", port, self._recorders)
        self._add_recorder(port, neurons)

    def record(self, port, neurons, variable):
        self._once("record", port, self._records)
        self._records[port] = neurons, variable

    def _make_rate_input(self, port):
        return self._held_rates(port)

    def rate_output(self, port, neurons):
        self._once("rate_output", port, self._records)
        self._records[port] = neurons, "rate"

    def begin(self, tick_ns):
        self._begin()
        self._tic_ns = round(1e6 / nest.tics_per_ms)
        self._ids = {port: nodes.tolist() for port, nodes in self._inputs.items()}
        nest.ll_api.sr(DEFINE_SET_SPIKE_TIMES)
        nest.Prepare()

    def advance(self, tick):
        for port in self._inputs:
            self._deliver(tick, port)
        for port, nodes in self._rate_inputs.items():
            values = Tick.signal(tick, port)
            if values is not None:
                nodes.rate = values
        nest.Run(self._tick_ms)
        self._take_spikes(tick, precise=True)
        for port, (neurons, variable) in self._records.items():
            Tick.write(tick, port, neurons.get(variable))

    def end(self):
        nest.Cleanup()

    def signal(self, tick, port):
        return Tick.signal(tick, port)

    def write(self, tick, port, values):
        Tick.write(tick, port, values)

    def _deliver(self, tick, port):
        # As in NEST's own proxies: to the next tic, up to the next step; what came late, now.
        grid_ns = self._tic_ns if self._precise[port] else self._step_ns
        channels, times_ms = tick._library().spikes_on_grid(
            tick._index(port, "spikes", True), self._tic_ns, grid_ns, tick.begin_ns)
        if channels:
            ids = self._ids[port]
            nest.ll_api.sps([ids[channel] for channel in channels])
            nest.ll_api.sps(times_ms)
            nest.ll_api.sr("spikeloop_set_spike_times")


class Proxies(Exchange):
    """For a NEST with MUSIC: its proxies. NEST is the MUSIC program, and ticks at its min_delay."""

    def __init__(self, host):
        super().__init__(host)
        library = host._library
        self._connected = dict(zip(host.widths, library.connected()))
        self._latency_ns = library.accept_latency()
        self._outputs, self._records, self._rate_outputs, self._signals = {}, {}, {}, {}
        for key, value in (("spike_delay", library.spike_delay()),
                           ("signal_delay", library.signal_delay())):
            if value:
                raise HostError(f"{value / 1e6:g} ms of delay are asked for on the way out of NEST "
                                f"({key}=, or a connection's delay in an experiment), and NEST's "
                                "own MUSIC has none there; leave it out, and make the delays of "
                                "NEST's connections longer")

    def _make_input(self, port, precise):
        # Proxies always bring precise times to those that can use them.
        width = self._host.widths[port]
        if not self._connected[port]:
            return nest.Create("spike_generator", width)  # silent
        proxies = nest.Create("music_event_in_proxy", width, {"port_name": port})
        proxies.set([{"music_channel": channel} for channel in range(width)])
        return proxies

    def output(self, port, neurons):
        self._once("output", port, self._outputs)
        self._outputs[port] = neurons
        if self._connected[port]:
            proxy = nest.Create("music_event_out_proxy", params={"port_name": port})
            nest.Connect(neurons, proxy, "all_to_all",
                         {"receptor_type": [list(range(len(neurons)))], "delay": self._tick_ms})
        if self._host._library.record():
            self._add_recorder(port, neurons)

    def record(self, port, neurons, variable):
        self._once("record", port, self._records)
        self._records[port] = neurons
        if self._connected[port]:
            nest.Create("music_cont_out_proxy",
                        params={"port_name": port, "targets": neurons, "record_from": [variable],
                                "interval": self._tick_ms})

    def _make_rate_input(self, port):
        if not self._connected[port]:
            return self._held_rates(port)
        width = self._host.widths[port]
        proxies = nest.Create("music_rate_in_proxy", width, {"port_name": port})
        proxies.set([{"music_channel": channel} for channel in range(width)])
        return proxies

    def rate_output(self, port, neurons):
        self._once("rate_output", port, self._rate_outputs)
        self._rate_outputs[port] = neurons
        if self._connected[port]:
            proxy = nest.Create("music_rate_out_proxy", params={"port_name": port})
            nest.Connect(neurons, proxy, "all_to_all",
                         {"synapse_model": "rate_connection_instantaneous",
                          "receptor_type": [list(range(len(neurons)))]})

    def begin(self, tick_ns):
        self._serve_all_ports()
        self._begin()
        for port in self._inputs:
            if self._connected[port]:
                nest.SetAcceptableLatency(port, self._acceptable(tick_ns) / 1e6)
                nest.SetMaxBuffered(port, 1)
        self._settle_tick(tick_ns)
        nest.Prepare()
        if self._records:
            # The proxies have just asked for recordings, which neurons only now make room for.
            nest.Cleanup()
            nest.Prepare()

    def advance(self, tick):
        nest.Run(self._tick_ms)
        self._take_spikes(tick, precise=False)

    def end(self):
        # NEST hands over the spikes of a slice when it begins the next one.
        nest.Run(nest.resolution)
        nest.Cleanup()

    def signal(self, tick, port):
        tick._index(port, "signal", True)
        if port not in self._signals:
            return None
        values = np.array(self._signals[port].get("data"), float)
        return None if np.all(np.isnan(values)) else values

    def write(self, tick, port, values):
        tick._index(port, "signal", False)
        raise HostError(f"tick.write('{port}', ...): NEST's own MUSIC sends what NEST records; write"
                        f"  host.record('{port}', neurons, \"V_m\")  before the loop")

    def _serve_all_ports(self):
        """MUSIC would wait for ever for one that nobody serves."""
        ports = self._host._ports
        for port in ports["spikes", True]:
            self.input(port, precise=False)
        for port in ports["spikes", False]:
            if port not in self._outputs:
                self.output(port, nest.Create("parrot_neuron", self._host.widths[port]))
        for port in ports["signal", True]:
            if self._connected[port] and port not in self._rate_inputs:
                self._signals[port] = nest.Create("music_cont_in_proxy",
                                                  params={"port_name": port})
        for port in ports["signal", False]:
            if self._connected[port] and port not in {**self._records, **self._rate_outputs}:
                raise HostError(f"the output '{port}' is connected, but has no values; write  "
                                f"host.record('{port}', neurons, \"V_m\")")

    def _acceptable(self, tick_ns):
        """NEST does not look for spikes before its second slice, and one that it finds too late
        silences its channel for ever. So it accepts what is up to a tick old: every delay is at
        least as long, and the spike acts at its time. A nanosecond less is none to MUSIC, which
        would exchange a tick later; NEST rounds it to the tick."""
        if self._latency_ns > tick_ns:
            raise HostError(f"spikes may come {self._latency_ns / 1e6:g} ms late, more than the tick "
                            f"of {tick_ns / 1e6:g} ms, and then their delay is over; write "
                            f"accept_latency={tick_ns / 1e9:g} or less, in an experiment a longer "
                            "tick")
        return max(self._latency_ns, tick_ns - 1)

    def _settle_tick(self, tick_ns):
        # Two neurons that nobody hears: no delay of the network need be as short as the tick.
        pair = nest.Create("parrot_neuron", 2)
        nest.Connect(pair[0], pair[1], syn_spec={"delay": self._tick_ms})
        if round(nest.min_delay * 1e6) != tick_ns:
            raise HostError(f"the shortest delay in NEST is {nest.min_delay:g} ms, {self._shortest()}"
                            f", but the tick is {self._tick_ms:g} ms, and NEST's own MUSIC ticks at "
                            f"its shortest delay; write  tick: {nest.min_delay:g} ms  in the "
                            f"experiment (music_timestep={nest.min_delay / 1e3:g} in a .music file), "
                            f"or delays of at least {self._tick_ms:g} ms, or use a NEST without "
                            "MUSIC, which takes any delay")

    @staticmethod
    def _shortest():
        if nest.num_connections > MOST_CONNECTIONS_LOOKED_AT:
            return f"one of {nest.num_connections} connections"
        connections = nest.GetConnections()
        if not len(connections):
            return "that of no connection"
        shortest = connections[int(np.argmin(connections.delay))]
        models = [nest.NodeCollection([node]).model for node in (shortest.source, shortest.target)]
        return f"that of a connection from {models[0]} to {models[1]}"
