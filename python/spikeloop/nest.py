"""NEST in a MUSIC job: an ordinary network, its spikes coming and going through MUSIC.

    import spikeloop.nest
    import nest

    with spikeloop.nest.music(spikes_in={"in": 100}, spikes_out={"out": 100}) as host:
        neurons = nest.Create("iaf_psc_exp", 100)
        nest.Connect(host.input("in"), neurons, "one_to_one", {"weight": 500.0, "delay": 1.0})
        host.output("out", neurons)
        host.run()

One script for every NEST 3: one that was built with MUSIC exchanges spikes itself, through its own
proxies; for any other this module does, between two calls of nest.Run. docs/simulators.md has the
rules.

Importing this module imports NEST, which does MUSIC's Setup when it has MUSIC.
"""

import importlib.util
import os
import shlex
import subprocess
import sys

from .music_host import End, Host, HostError, Tick
from .music_library import library

TO_INSTALL = ("install it (conda-forge: nest-simulator, Ubuntu: ppa:nest-simulator/nest, or from "
              "source), and write the directory that holds its package `nest` into PYTHONPATH")

# A NEST without MPI ends the process when it sees these.
SEEN_BY_NEST = ("PMIX_RANK", "PMI_RANK")
ASK_FOR_OPTIONS = """
import nest
for name in "have_music", "have_mpi":
    print("spikeloop", nest.ll_api.sli_func(f"statusdict/{name} ::"))
"""


class _Hidden:
    """Environment variables of MPI's that NEST must not see."""

    def __init__(self):
        self._kept = {}

    def hide(self):
        for name in SEEN_BY_NEST:
            if name in os.environ:
                self._kept[name] = os.environ.pop(name)

    def show(self):
        os.environ.update(self._kept)


def _options():
    """(whether NEST has MUSIC, whether it has MPI), said by one in another process: here it must be
    known before the import."""
    environment = {name: value for name, value in os.environ.items()
                   if not name.startswith(("OMPI_", "PMIX_", "PMI_", "_MUSIC_"))}
    said = subprocess.run([sys.executable, "-c", ASK_FOR_OPTIONS], env=environment, check=False,
                          capture_output=True, text=True)
    words = [line.split()[1] for line in said.stdout.splitlines() if line.startswith("spikeloop ")]
    if len(words) != 2:
        lines = said.stderr.strip().splitlines() or [f"exit code {said.returncode}"]
        raise ImportError(f"NEST cannot be imported by {sys.executable}: {lines[-1]}", name="nest")
    return tuple(word == "True" for word in words)


def _import_under_music():
    """The module, and whether it exchanges spikes through MUSIC itself. Its Setup stands between
    what a host does before and after its own."""
    end = End.take_over()
    if importlib.util.find_spec("nest") is None:
        raise ModuleNotFoundError(f"NEST is not installed for {sys.executable}: {TO_INSTALL}",
                                  name="nest")
    with_music, with_mpi = _options()
    if not with_music and with_mpi:
        raise HostError("this NEST has MPI, but no MUSIC: it would take all programs of the job for "
                        "its own; use one with both, or with neither (conda-forge: "
                        "nest-simulator=*=nompi*)")
    if with_music:
        library().before_simulators_setup(list(sys.argv))
    else:
        _hidden.hide()
    os.environ.setdefault("PYNEST_QUIET", "1")
    import nest as found
    if with_music:
        with end.fatal():
            library().after_simulators_setup()
    return found, with_music


def _import_nest():
    if "_MUSIC_CONFIG_" in os.environ or "--music-config" in sys.argv:
        return _import_under_music()
    import nest as found
    return found, found.ll_api.sli_func("statusdict/have_music ::")


_hidden = _Hidden()
nest, WITH_MUSIC = _import_nest()

from .nest_ports import Generators, Proxies  # noqa: E402


class NestTick(Tick):
    """A Tick whose spikes are NEST's."""

    def spikes(self, port):
        raise HostError(f"tick.spikes('{port}'): the spikes of a port go into NEST; write  "
                        f"nest.Connect(host.input('{port}'), ...)")

    def send(self, port, times, channels):
        raise HostError(f"tick.send('{port}', ...): the spikes of a port come from NEST; write  "
                        f"host.output('{port}', neurons)")

    def signal(self, port):
        return self._host.exchange.signal(self, port)

    def write(self, port, values):
        self._host.exchange.write(self, port, values)


class NestHost(Host):
    """A Host with NEST's kernel in it.

    with_music: whether NEST exchanges spikes itself, because it was built with MUSIC.
    """

    _tick_type = NestTick
    with_music = WITH_MUSIC

    def __init__(self, **arguments):
        _hidden.show()  # for MPI
        super().__init__(**arguments)
        _hidden.hide()
        if WITH_MUSIC:
            sys.argv[1:] = shlex.split(" ".join(sys.argv[1:]))
        nest.set_verbosity("M_ERROR")  # or it speaks in every tick
        self.exchange = Proxies(self) if WITH_MUSIC else Generators(self)
        self._prepared = False

    def input(self, port, precise=False):
        """The nodes of a spike input, one a channel, to connect from: a NodeCollection. Set
        nest.resolution, and call nest.ResetKernel(), before.

        precise: for neurons with precise spike times, such as iaf_psc_delta_ps: times to the
        microsecond instead of the grid.
        """
        self._check_port("input", port, "spikes", True)
        return self.exchange.input(port, precise)

    def output(self, port, neurons):
        """The spikes of these neurons, one a channel, are those of a spike output.

        neurons: a NodeCollection with as many nodes as the port has channels.
        """
        self._check_port("output", port, "spikes", False)
        self._check_count("output", port, neurons)
        self.exchange.output(port, neurons)

    def record(self, port, neurons, variable):
        """What a multimeter would record of these neurons, one a channel, is a continuous output:
        its value at the end of every tick. variable: such as "V_m"."""
        self._check_port("record", port, "signal", False)
        self._check_count("record", port, neurons)
        if variable not in neurons[0].get("recordables"):
            known = ", ".join(str(name) for name in neurons[0].get("recordables"))
            raise HostError(f"host.record('{port}', ..., '{variable}'): {neurons[0].model} has no "
                            f"'{variable}'; write one of: {known}")
        self.exchange.record(port, neurons, variable)

    def rate_input(self, port):
        """The nodes of a continuous input, one a channel, whose rates are its values: to connect
        from by rate_connection_instantaneous or rate_connection_delayed."""
        self._check_port("rate_input", port, "signal", True)
        return self.exchange.rate_input(port)

    def rate_output(self, port, neurons):
        """The rates of these rate neurons, one a channel, are a continuous output."""
        self._check_port("rate_output", port, "signal", False)
        self._check_count("rate_output", port, neurons)
        self.exchange.rate_output(port, neurons)

    def run(self):
        """The loop to the end of the run."""
        for tick in self:
            self.advance(tick)

    def advance(self, tick):
        """NEST's part of a tick, for a loop of one's own: spikes go in, the network advances to
        tick.end_s, spikes go out."""
        if not self._prepared:
            self._check_time(tick)
            self.exchange.begin(self._tick_ns)
            self._prepared = True
        self.exchange.advance(tick)

    def _finish(self):
        if self._prepared:
            self._prepared = False
            self.exchange.end()
        super()._finish()

    def _check_time(self, tick):
        threads = nest.local_num_threads
        if WITH_MUSIC and threads > 1:
            # Spikes from MUSIC reach several threads of NEST at once, and it dies (NEST 3.9).
            raise HostError(f"nest.local_num_threads is {threads}: a NEST with MUSIC takes spikes "
                            "with one thread only; write 1, or use a NEST without MUSIC")
        now_ms = nest.biological_time
        if tick.begin_ns or now_ms:
            raise HostError(f"NEST's time is {now_ms:g} ms at {tick.begin_s:g} s of the run; let "
                            "host.advance(tick) be what advances it, in every tick")
        step_ns = round(nest.resolution * 1e6)
        if self._tick_ns % step_ns:
            raise HostError(f"the tick of {self._tick_ns / 1e6:g} ms is not a multiple of NEST's step "
                            f"of {nest.resolution:g} ms; choose another nest.resolution")

    def _check_port(self, call, port, kind, is_input):
        known = self._ports[kind, is_input]
        if port not in known:
            group = ("spikes" if kind == "spikes" else "signals") + ("_in" if is_input else "_out")
            raise HostError(f"host.{call}('{port}'): {group} has no '{port}'; known: "
                            f"{', '.join(known) or 'none'}")

    def _check_count(self, call, port, neurons):
        width = self.widths[port]
        if len(neurons) != width:
            raise HostError(f"host.{call}('{port}', ...) got {len(neurons)} neurons, but the port "
                            f"has {width} channels; write as many, as in neurons[:{width}]")


def music(**arguments):
    """As spikeloop.music, with a NestHost."""
    return NestHost(**arguments)
