#!/usr/bin/python3
"""However a script of NEST's goes wrong, the job ends, and says why."""

import signal
import unittest

import faults_test
import jobs
import nest_jobs

SCRIPT = """#!/usr/bin/python3
import spikeloop.nest
import nest
{early}
with spikeloop.nest.music(spikes_in={{"in": {width}}}, spikes_out={{"out": None}}{ports}) as host:
    cells = nest.Create("parrot_neuron", host.widths["out"])
    nest.Connect(host.input("in"), cells, "one_to_one", {{"delay": 1.0}})
    host.output("out", cells)
    {prepare}
    for tick in host:
        {body}
"""


def script(body="host.advance(tick)", *, prepare="pass", early="", width="None", ports=""):
    return SCRIPT.format(body=body, prepare=prepare, early=early, width=width, ports=ports)


class Faults(unittest.TestCase):
    def check(self, text, *expected, code=5, keys="", tick_s=0.001):
        with jobs.Job("brain.py", 4, text=text, encoder="rate_encoder", duration_s=0.3, keys=keys,
                      tick_s=tick_s) as job:
            said = job.run(code=code, timeout=90)
            jobs.assert_says(said, *expected)
            self.assertEqual(faults_test.living(job.folder), [])
            return said

    def test_before_the_loop(self):
        said = self.check(script(prepare="open('weights.npy')"), "brain: Traceback",
                          "brain.py:9: FileNotFoundError")
        self.assertIn("FileNotFoundError", said.splitlines()[-1])

    def test_before_the_host(self):
        self.check(script(early="open('weights.npy')"), "FileNotFoundError")
        self.check(script(early="raise SystemExit(3)"), "without its loop")

    def test_in_the_loop(self):
        self.check(script("1 / (tick.begin_ns - 100_000_000)"), "brain.py:11: ZeroDivisionError")

    def test_without_a_host(self):
        self.check("#!/usr/bin/python3\nimport spikeloop.nest\n",
                   "without its loop")

    def test_wrong_widths_keys_and_processes(self):
        self.check(script(width=7), "job.music:24:1: ... 'brain.in' ... 4 ... 7 ... [7] ... [SL0306]", code=2)
        self.check(script(ports=", gain=1.0"), "job.music:18:3: key 'gain': 'loud' ... [SL0201]", code=2,
                   keys="gain=loud")
        self.check(script(), "job.music:18:3: np=2 ... brain.py ... np=1 [SL0602]", code=2, keys="np=2")

    def test_nest_refuses(self):
        self.check(script(prepare="nest.Create('iaf_psc_nothing')"), 'brain.py", line 9, in <module>',
                   "iaf_psc_nothing is not a known model name")

    def test_ports(self):
        for prepare, message in (
                ("host.input('inn')", "host.input('inn'): spikes_in has no 'inn'; known: in"),
                ("host.output('in', cells)", "host.output('in'): spikes_out has no 'in'; known: out"),
                ("host.output('out', cells)", "host.output('out', ...) ... before; write one group a port"),
                ("host.output('out', cells[:3])",
                 "host.output('out', ...) got 3 neurons, but the port has 4 channels; write as many, as in "
                 "neurons[:4]"),
                ("host.rate_input('v')", "host.rate_input('v'): signals_in has no 'v'; known: none"),
                ("host.rate_output('v', cells)", "host.rate_output('v'): signals_out has no 'v'; "
                 "known: none"),
                ("host.record('v', cells, 'V_m')", "host.record('v'): signals_out has no 'v'; known: "
                 "none")):
            with self.subTest(message):
                self.check(script(prepare=prepare), message)
        self.check(script(prepare="host.record('v', nest.Create('iaf_psc_exp'), 'voltage')",
                          ports=', signals_out={"v": 1}'),
                   "host.record('v', ..., 'voltage'): iaf_psc_exp has no 'voltage'; write one of: ",
                   "V_m")
        self.check(script("tick.spikes('in')"), "tick.spikes('in'): the spikes of a port go into NEST; "
                   "write  nest.Connect(host.input('in'), ...)")
        self.check(script("tick.send('out', 0.1, 0)"), "tick.send('out', ...): the spikes of a port "
                   "come from NEST; write  host.output('out', neurons)")

    def test_time(self):
        self.check(script(prepare="nest.resolution = 0.3"), "brain.py:9: NESTErrors.", code=5)
        text = script(early="nest.resolution = 0.3").replace('"delay": 1.0', '"delay": 1.2')
        self.check(text, "the tick of 1 ms is not a multiple of NEST's step of 0.3 ms; choose another nest.resolution")
        self.check(script("host.advance(tick) if tick.begin_s >= 0.1 else None"),
                   "NEST's time is 0 ms at 0.1 s of the run; let host.advance(tick) be what advances "
                   "it, in every tick")
        self.check(script(), "finished", code=0)

    def test_stopped(self):
        for number, code in ((signal.SIGINT, 130), (signal.SIGUSR1, 128 + signal.SIGUSR1)):
            with self.subTest(number), \
                    jobs.Job("brain.py", 4, text=script() + "print('saved', flush=True)\n",
                             duration_s=1000) as job:
                returncode, said = job.stopped_by(number)
                self.assertEqual(returncode, code, said)
                self.assertIn("saved", said)  # the script comes to its own end
                self.assertEqual(faults_test.living(job.folder), [])

    def test_a_program_that_hangs_is_told(self):
        with jobs.Job("brain.py", 4, text=script(
                "host.advance(tick) if tick.begin_s < 0.01 else __import__('time').sleep(50)")) as job:
            jobs.assert_says(job.run("--stall-timeout", "5", code=3), "'brain' (brain.py) does not come ")


class OwnMusic(unittest.TestCase):
    """Of a NEST that has MUSIC."""

    check = Faults.check

    def setUp(self):
        if not nest_jobs.WITH_MUSIC:
            self.skipTest("of a NEST with MUSIC")

    def test_delays_shorter_than_the_tick(self):
        self.check(script(), "the shortest delay in NEST is 1 ms, that of a connection from "
                   "music_event_in_proxy to parrot_neuron, but the tick is 10 ms, and NEST's own MUSIC "
                   "ticks at its shortest delay; write  tick: 1 ms  in the experiment "
                   "(music_timestep=0.001 in a .music file), or delays of at least 10 ms", tick_s=0.01)

    def test_threads(self):
        self.check(script(early="nest.local_num_threads = 2"), "nest.local_num_threads is 2: a NEST "
                   "with MUSIC takes spikes with one thread only")

    def test_outputs_without_values(self):
        text = script(ports=', signals_out={"v": 1}')
        with jobs.Job("brain.py", 4, text=text, duration_s=0.3) as job:
            job.file.write_text(job.file.read_text() + "[other]\nnp=1\nbinary=connect_adapter\n"
                                "weights=uniform\nbrain.v -> other.in [1]\n")
            self.assertIn("the output 'v' is connected, but has no values; write  host.record('v', "
                          "neurons, \"V_m\")", job.run(code=5, timeout=90))

    def test_what_it_cannot(self):
        self.check(script("tick.write('v', 1)", ports=', signals_out={"v": 1}'), "tick.write('v', ...): "
                   "NEST's own MUSIC sends what NEST records; write  host.record('v', neurons, \"V_m\")"
                   "  before the loop")
        self.check(script(), "1 ms of delay are asked for on the way out of NEST (spike_delay=",
                   keys="spike_delay=1")
        self.check(script(), "spikes may come 2 ms late, more than the tick of 1 ms, and then their delay is over; "
                   "write accept_latency=0.001 or less, in an experiment a longer tick", keys="accept_latency=0.002")


if __name__ == "__main__":
    nest_jobs.main()
