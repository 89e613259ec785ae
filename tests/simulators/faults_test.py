#!/usr/bin/python3
"""However a script goes wrong, the job ends, and says why."""

import os
import pathlib
import signal
import subprocess
import sys
import unittest

import jobs

WITH = """#!/usr/bin/python3
import numpy as np
import spikeloop{module}
with spikeloop{module}.music(spikes_in={{"in": {width}}}, spikes_out={{"out": {width}}}, gain=1.0) as host:
    {prepare}
    for tick in host:
        {body}
"""


def script(body="pass", *, prepare="pass", width="None", module=""):
    return WITH.format(body=body, prepare=prepare, width=width, module=module)


def living(folder):
    """Processes that run in this folder."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and os.readlink(entry / "cwd") == str(folder):
                found.append(entry.name)
        except OSError:
            pass
    return found


class Faults(unittest.TestCase):
    def check(self, text, *expected, code, keys=""):
        """The job of this script ends with this exit code, and says all of this."""
        with jobs.Job("brain.py", 4, text=text, duration_s=0.3, keys=keys, short=True) as job:
            said = job.run(code=code, timeout=90)
            jobs.assert_says(said, *expected)
            self.assertEqual(living(job.folder), [])
            return said

    def test_an_exception_in_the_loop(self):
        said = self.check(script("1 / (tick.begin_ns - 100_000_000)"), "brain: Traceback ",
                          "brain.py:7: ZeroDivisionError: division by zero", code=5)
        self.assertIn("ZeroDivisionError", said.splitlines()[-1])

    def test_an_exception_before_the_loop(self):
        self.check(script(prepare="open('weights.npy')"), "brain.py:5: FileNotFoundError", code=5)

    def test_an_exception_in_a_library_is_told_with_the_scripts_line(self):
        said = self.check(script("import json; json.loads('{')"), "/json/decoder.py\", line ",
                          "brain.py:7: JSONDecodeError: Expecting property name", code=5)
        self.assertIn("brain.py:7: JSONDecodeError", said.splitlines()[-1])

    def test_an_exception_outside_with(self):
        text = script().replace("with ", "host = ").replace(" as host:", "").replace("\n    ", "\n")
        self.check(text.replace("pass", "raise OSError(\"lost\")", 1), "OSError: lost", code=5)

    def test_wrong_widths(self):
        self.check(script(width="7"), "job.music:18:1: ... 'brain.in' ... 4 ... brain.py ... 7 ... [7] ... "
                   "None ... [SL0306]", code=2)

    def test_a_port_without_width_and_connection(self):
        text = script().replace('{"in": None}', '{"in": None, "more": None}')
        self.check(text, "job.music:8:1: port 'brain.more' is not connected; write  SENDER.out -> "
                   "brain.more [WIDTH], or a width in the script, with which it stays silent [SL0305]",
                   code=2)
        text = script().replace('{"out": None}', '{"out": None, "more": None}')
        self.check(text, "write  brain.more -> RECEIVER.in [WIDTH], or ... goes nowhere [SL0305]", code=2)

    def test_a_port_that_the_script_does_not_have(self):
        text = script().replace('spikes_in={"in": None}, ', "")
        self.check(text, "'brain' ... 'in' ... [SL0302]", code=2)

    def test_a_wrong_value_in_the_section(self):
        self.check(script(), "job.music:12:3: key 'gain': 'loud' ... [SL0201]", code=2, keys="gain=loud")

    def test_several_processes(self):
        self.check(script(), "job.music:12:3: np=2 asks for 2 processes, but brain.py runs in one; write  np=1 "
                   "[SL0602]", code=2, keys="np=2")

    def parallel(self, *expected, code, keys):
        with jobs.Job("repeat_neuron_parallel.py", 4, duration_s=0.3, keys="np=2\n  " + keys,
                      short=True) as job:
            jobs.assert_says(job.run(code=code, timeout=90), *expected)
            self.assertEqual(living(job.folder), [])

    def test_one_of_several_processes_fails(self):
        for process in ("0", "1"):
            self.parallel("brain: Traceback ", f"RuntimeError: nothing in process {process}", code=5,
                          keys=f"fail_in={process}")

    def test_one_of_several_processes_leaves_its_loop(self):
        for process in ("0", "1"):
            self.parallel("one of its 2 processes has left the loop at 0.1 s of simulated time, and the others wait "
                          "for it; leave no loop before its end", code=5, keys=f"leave_in={process}")

    def test_cells_that_every_process_makes(self):
        self.parallel("channel 0 of 'out' is connected in the processes 0 and 1, and would send "
                      "each spike twice; make a cell in one process:  for gid in "
                      "range(int(pc.id()), CELLS, int(pc.nhost())): ...", code=5, keys="twice=true")

    def test_several_processes_and_a_wrong_value(self):
        self.parallel("key 'fail_in': 'none'", code=2, keys="fail_in=none")

    def test_times_outside_the_interval_end_the_job(self):
        self.check(script("tick.send('out', tick.end_s + 1e-6, 0)"),
                   "brain.py:7: tick.send('out', ...) ... 0.001001 s ... (0, 0.001] s", code=5)

    def test_a_script_that_ends_early(self):
        self.check(script("if tick.begin_s >= 0.1: break"),
                   "'brain' (brain.py) ... 0.1 s ... 0.3 s", code=3)

    def test_a_script_that_exits(self):
        self.check(script("if tick.begin_s >= 0.1: raise SystemExit(3)"),
                   "the script has ended itself by sys.exit", code=3)
        self.check(script("if tick.begin_s >= 0.1: raise SystemExit('no reward')"),
                   "the script has ended itself by sys.exit: no reward", code=1)

    def test_a_script_that_is_interrupted(self):
        self.check(script("raise KeyboardInterrupt"), "brain: stopped by Ctrl-C", code=130)

    def test_a_script_without_a_loop(self):
        self.check(script().split("    for tick")[0],
                   "the script has left `with spikeloop.music(...)` without its loop", code=5)
        text = script().split("    for tick")[0].replace("with ", "host = ")
        self.check(text.replace(" as host:", "").replace("    pass", ""),
                   "the script has ended without its loop", code=5)

    def test_a_script_that_never_calls_its_host(self):
        self.check("#!/usr/bin/python3\nimport spikeloop\n",
                   "'brain' (brain.py)", "ended without MUSIC's ", code=3)

    def test_a_script_that_prepares_itself_for_long_is_waited_for(self):
        text = script(prepare="import time; time.sleep(14)")
        stuck = script("if tick.begin_s > 0.01: import time; time.sleep(50)")
        with jobs.Job("brain.py", 4, text=text, duration_s=0.1, short=True) as job:
            job.run("--start-timeout", "10")
        with jobs.Job("brain.py", 4, text=stuck, short=True) as job:
            jobs.assert_says(job.run("--stall-timeout", "3", code=3), "'brain' (brain.py) does not come ")

    def test_an_interpreter_as_the_program(self):
        with jobs.Job("brain.py", 4, text=script(), short=True) as job:
            text = job.file.read_text()
            job.file.write_text(text.replace("binary=./brain.py", "binary=python3\n  args=brain.py"))
            jobs.assert_says(job.run(code=2), ".music ... 'brain.py'")

    def test_without_music(self):
        with jobs.Job("brain.py", 4, text=script()) as job:
            done = subprocess.run(["./brain.py"], cwd=job.folder, capture_output=True, text=True,
                                  env={**os.environ, "PYTHONPATH": str(jobs.PACKAGE)}, check=False)
            self.assertEqual(done.returncode, 2)
            jobs.assert_says(done.stderr, "./brain.py: ... binary=./brain.py ... np=1 ... spikeloop run FILE.music")

    def test_without_the_library(self):
        with jobs.Job("brain.py", 4, text=script()) as job:
            sources = jobs.HERE.parents[1] / "python"
            done = subprocess.run(["./brain.py"], cwd=job.folder, capture_output=True, text=True,
                                  env={"PYTHONPATH": str(sources), "PATH": "/usr/bin"}, check=False)
            self.assertIn("ImportError: spikeloop.music needs its library, which is not in: ",
                          done.stderr)
            self.assertIn("start the job with `spikeloop run`", done.stderr)

    def test_with_a_library_of_another_python(self):
        with jobs.Job("brain.py", 4, text=script()) as job:
            (job.folder / "libspikeloop_python_music.so").write_text("of Python 2")
            done = subprocess.run(["./brain.py"], cwd=job.folder, capture_output=True, text=True,
                                  env={"PYTHONPATH": str(jobs.PACKAGE),
                                       "SPIKELOOP_LIBRARY_PATH": str(job.folder)}, check=False)
            self.assertIn("does not open in this Python, /usr/bin/python3 3.", done.stderr)
            self.assertIn("begin the script with #!/usr/bin/python3", done.stderr)

    def test_wrong_calls(self):
        with jobs.Job("misuse.py", 4, duration_s=0.1) as job:
            said = job.run()
        found = [line.split("REFUSED ")[1] for line in said.splitlines() if "REFUSED" in line]
        self.assertEqual(len(found), len(EXPECTED), said)
        for line, expected in zip(found, EXPECTED):
            jobs.assert_says(line, expected)
        self.assertIn("image None", said)

    def stopped(self, number, code):
        """A job without end whose script has older threads than its host, ended by a signal."""
        text = script().replace("import spikeloop", "import threading, time\nimport spikeloop\n"
                                "threading.Thread(target=time.sleep, args=(600,), daemon=True).start()")
        text += "print('saved', flush=True)\n" if code != 128 + signal.SIGTERM else ""
        with jobs.Job("brain.py", 4, text=text, duration_s=1000) as job:
            returncode, said = job.stopped_by(number)
            self.assertEqual(returncode, code, said)
            self.assertEqual(living(job.folder), [])
            return said

    def test_ctrl_c(self):
        said = self.stopped(signal.SIGINT, 130)
        self.assertIn("saved", said)  # the script comes to its own end
        self.assertIn("stopped by Ctrl-C", said)

    def test_sigusr1(self):
        self.assertIn("saved", self.stopped(signal.SIGUSR1, 128 + signal.SIGUSR1))


class NestFaults(unittest.TestCase):
    """What spikeloop.nest says where there is no NEST, or one that does not do."""

    def check(self, package, *expected):
        """package: the text of nest/__init__.py; None: there is none."""
        text = "#!/usr/bin/python3\nimport sys\n"
        text += "sys.modules['nest'] = None\n" if package is None else ""
        with jobs.Job("brain.py", 4, text=text + "import spikeloop.nest\n", short=True) as job:
            if package is not None:
                (job.folder / "nest").mkdir()
                (job.folder / "nest/__init__.py").write_text(package)
            jobs.assert_says(job.run(code=5, timeout=60).splitlines()[-1], *expected)
            self.assertEqual(living(job.folder), [])

    def test_not_installed(self):
        self.check(None, "ModuleNotFoundError: NEST is not installed for /usr/bin/python3: install it "
                   "(conda-forge: nest-simulator, Ubuntu: ppa:nest-simulator/nest, or from source), "
                   "and write the directory that holds its package `nest` into PYTHONPATH")

    def test_not_usable(self):
        self.check("raise ImportError('libnest.so.3: cannot open')", "ImportError: NEST cannot be "
                   "imported by /usr/bin/python3: ImportError: libnest.so.3: cannot open")

    def test_mpi_alone(self):
        self.check("class ll_api:\n    sli_func = staticmethod(lambda text: 'mpi' in text)\n",
                   "this NEST has MPI, but no MUSIC: it would take all programs of the job for its own; "
                   "use one with both, or with neither (conda-forge: nest-simulator=*=nompi*)")


class SimulatorFaults(unittest.TestCase):
    """Those of the hosts of NEURON and Brian2."""

    check = Faults.check

    def test_neuron(self):
        def check(prepare, message, body="host.advance(tick)"):
            text = script(body, prepare="from neuron import h; " + prepare, module=".neuron")
            self.check(text, message, code=5)

        check("h.dt = 0.3; h.finitialize()", "the tick of 1 ms is not a multiple of NEURON's step h.dt "
              "of 0.3 ms; choose another h.dt, or variable steps: h.CVode().active(True)")
        check("h.finitialize(); h.t = 5", "NEURON's time is 5 ms at the first tick; call "
              "h.finitialize() before the loop")
        self.refused(".neuron", "from neuron import h", {
            "host.connect_input('inn', 0, h.IntFire1())": "connect_input('inn', ...): spikes_in has no 'inn'; known: in",
            "host.connect_output('out', 4, h.IntFire1())": "connect_output('out', 4, ...): the port has channels 0 to 3"},
            "the script has left `with spikeloop.music(...)` without its loop")

    def test_brian2(self):
        """It takes seconds to import Brian2."""
        group = "g = b.NeuronGroup(4, 'v : 1', threshold='v > 1'); "
        statements = {
            "host.input('inn')": "host.input('inn'): spikes_in has no 'inn'; known: in",
            group + "host.output('out', g[:3])": "host.output('out', ...) got a group of 3 neurons, but the port has 4 "
            "channels; write as many, as in group[:4]",
            "g = b.NeuronGroup(4, 'v : 1', threshold='v > 1', dt=0.2 * b.ms, name='slow'); "
            "host.output('out', g); host.run()": "'slow' has steps of 0.2 ms, but defaultclock.dt is "
            "0.1 ms; use one",
            group + "host.output('out', g)": "host.output('out', ...) has been called before",
            "b.defaultclock.dt = 0.3 * b.ms; host.run()": "the tick of 1 ms is not a multiple of Brian2's step "
            "of 0.3 ms; choose another defaultclock.dt",
            "b.defaultclock.dt = 0.1 * b.ms; " + group + "n = b.Network(g); n.run(1 * b.ms); "
            "host.run(n)": "the network's time is 0.001 s before the run; let host.run() be its first"}
        # Without what spikeloop.brian leaves out of Brian2's imports, and without compilation: both take longer.
        imports = "import spikeloop.brian; import brian2 as b; b.prefs.codegen.target = 'numpy'"
        self.refused(".brian", imports, statements,
                     "this Brian2 device runs a program of its own; leave set_device() out",
                     last="b.set_device('cpp_standalone'); host.run(b.Network())")

    def refused(self, module, imports, statements, end, last="pass"):
        """A job whose script catches the error of each of these statements (with its text), but not that of the last."""
        said = self.check(STATEMENTS.format(module=module, imports=imports, statements=list(statements), last=last),
                          end, code=5)
        refused = [line.split("REFUSED ")[1] for line in said.splitlines() if "REFUSED" in line]
        self.assertEqual(len(refused), len(statements), refused)
        for message, line in zip(statements.values(), refused):
            jobs.assert_says(line, message)


STATEMENTS = """#!/usr/bin/python3
{imports}
import spikeloop{module}
with spikeloop{module}.music(spikes_in={{"in": None}}, spikes_out={{"out": None}}) as host:
    for statement in {statements}:
        try:
            exec(statement)
        except Exception as error:
            print("REFUSED", error)
    {last}
"""
EXPECTED = [
    'a host without ports; write  spikeloop.music(spikes_in={"in": 100})',
    "ports are ['in']; write a dict such as {'in': 100}, or {'in': None} for as many channels as the file says",
    "port 'in' has the width 0; ... from 1, or None for as many channels as the file says",
    "two ports are named 'in'",
    "a port is named 3; write a name, such as 'in'",
    "parameter 'weights' is a table; take its file's name, as weights=spikeloop.Parameter(type=str), "
    "and read it with numpy.load",
    "'spikes_ou' is a dict, but not an argument for ports; did you mean 'spikes_out'?",
    "'gain': ... list; ... spikeloop.Weights",
    "spikeloop.music has been called before; a script has one host",
    "tick.spikes('inn'): spikes_in of spikeloop.music has no 'inn'; did you mean 'in'?",
    "tick.spikes('image'): spikes_in of spikeloop.music has no 'image'; known: in",
    "tick.send('in'): spikes_out of spikeloop.music has no 'in'; known: out",
    "tick.send('out', ...) got the time nan; write seconds",
    "tick.send('out', ...) got a spike at 0.01 s, outside of the interval (0.01, 0.011] s; write times "
    "after tick.begin_s, and up to tick.end_s",
    "tick.send('out', ...) ... 0.011000001 s ... (0.01, 0.011] s; ... tick.begin_s ... tick.end_s",
    "tick.send('out', ...) got channel 5, but the port has channels 0 to 3",
    "tick.send('out', ...) ... -1 ... 0 ... 3",
    "tick.send('out', ...) got 2 times and 3 channels; write as many times as channels",
    "tick.send('out', ...) got channels that are 1 values of type float64; write times in seconds and whole "
    "channels, one a spike",
    "tick.send('out', ...) ... times ... type <U3",
    "tick.send('out', ...) ... times ... 1 values of type float64 in 2 dimensions",
    "tick.write('level', ...) ... 3 values of type int64 ... 2 channels; write 2 numbers, or one for all of them",
    "tick.write('level', ...) ... values of type <U1 ... 2 channels",
    "the tick is over; use it inside its turn of the loop only",
    "the loop has been begun before; write one  for tick in host: ...",
]

if __name__ == "__main__":
    sys.exit(unittest.main())
