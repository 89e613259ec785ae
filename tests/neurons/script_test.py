"""Networks from a Python function: the same as from a file, and what is wrong with one is told."""

import contextlib
import json
import os
import pathlib
import signal
import subprocess
import time
import unittest
import unittest.mock

import numpy as np

import built_in
from built_in import MS

NETWORK = str(built_in.PROGRAMS / "spikeloop-network")

SCRIPT = """\
import numpy as np
import helper  # lies beside it
import spikeloop.network

def make():
    net = spikeloop.network.Network(resolution="0.2 ms")
    net.population("input", "input", helper.INPUTS)
    net.population("cell", "iaf_psc_exp", 4, tau_m="15 ms", I_e=np.float64(390))
    net.population("jump", "iaf_psc_delta", 3)
    net.population("noise", "poisson", 2, rate=[("0 ms", "50 Hz"), ("200 ms", 5)])
    net.population("drive", "signal_input", np.float64(1))
    weights = np.random.default_rng(3).uniform(-200, 400, size=(4, helper.INPUTS))
    net.connect("input", "cell", weights, delay="1.4 ms",
                plasticity={"rule": "stdp", "Wmax": 401, "save": "w.npy"} if helper.LEARN else None)
    net.connect("noise", "jump", ([0, 1, 1], [2, 0, 0], [3.5, 8, 8]), delay=1)  # a pair twice
    net.connect("cell", "jump", ([0, 3], [0, 1], [4, 0]), delay=2)  # a synapse of weight 0
    net.connect("drive", "cell", np.ones((4, 1)))
    net.connect("jump", "cell", rule="file.npy", weight="100 pA", delay=1)
    net.output("cell", "jump")
    net.potential("cell")
    net.record("jump", spikes=True, V_m=[0, 2], interval="4 ms")
    return net
"""

YAML = """\
resolution: 0.2 ms
populations:
  input: {model: input, size: 5}
  cell: {model: iaf_psc_exp, size: 4, parameters: {tau_m: 15 ms, I_e: 390}}
  jump: {model: iaf_psc_delta, size: 3}
  noise: {model: poisson, size: 2, parameters: {rate: [[0 ms, 50 Hz], [200 ms, 5]]}}
  drive: {model: signal_input, size: 1}
connections:
  - {from: input, to: cell, rule: weights.npy, weight: 1 pA, delay: 1.4 ms}
  - {from: noise, to: jump, rule: pairs, pairs: [[0, 2, 3.5], [1, 0, 8], [1, 0, 8]], weight: 1 mV, delay: 1 ms}
  - {from: cell, to: jump, rule: pairs, pairs: [[0, 0, 4], [3, 1, 0]], weight: 1 mV, delay: 2 ms}
  - {from: drive, to: cell, rule: all_to_all, weight: 1 pA}
  - {from: jump, to: cell, rule: file.npy, weight: 100 pA, delay: 1 ms}
output: [cell, jump]
potential: [cell]
record: {jump: {spikes: true, V_m: [0, 2], interval: 4 ms}}
"""


class Case(built_in.FolderCase):
    def write(self, text, name="brain.py"):
        path = self.folder / name
        path.write_text(text)
        return path

    def check(self, path, environment=None):
        return subprocess.run([NETWORK, "--check", str(path)], capture_output=True, text=True,
                              timeout=60, cwd=self.folder,
                              env={**os.environ, **(environment or {})}, check=False)

    def prepare(self):
        self.write(SCRIPT)
        self.write("INPUTS = 5\nLEARN = False\n", "helper.py")
        self.write(YAML, "brain.yaml")
        np.save(self.folder / "weights.npy",
                np.random.default_rng(3).uniform(-200, 400, size=(4, 5)))
        np.save(self.folder / "file.npy", np.arange(12.0).reshape(4, 3) - 5)


class SameNetwork(Case):
    def test_the_tables_of_check(self):
        self.prepare()
        tables = []
        for name in ("brain.py", "brain.py:make", "brain.yaml"):
            done = self.check(name)
            self.assertEqual(done.returncode, 0, done.stderr)
            # Rules are arrays, files or pairs.
            lines = [line.split() for line in done.stdout.splitlines()[1:]]
            tables.append([[word for word in line if word not in (
                "array", "weights.npy", "pairs", "all_to_all")] for line in lines])
        self.assertEqual(tables[0], tables[2])
        self.assertEqual(tables[1], tables[2])
        rules = [line.split()[2] for line in
                 self.check("brain.py").stdout.split("weight\n")[1].splitlines()]
        self.assertEqual(rules, ["array", "pairs", "array", "array", "file.npy"])
        self.assertIn("[5], port out [7], port signal [1], port potential [4]",
                      self.check("brain.py").stdout.splitlines()[0])

    def test_the_spikes_and_potentials_of_a_run(self):
        self.prepare()
        given = built_in.random_spikes(np.random.default_rng(4), 5, 900, 60)
        signal = (np.array([0.3]), np.array([[120.0]]))
        runs = [built_in.run(self.folder / name, str(self.folder / file), 1.0, given, 5,
                             signal=signal, arguments=arguments)
                for name, file, arguments in (("script", "brain.py:make", ()),
                                              ("file", "brain.yaml", ()),
                                              ("apart", "brain.py:make", ("--layout", "separate")))]
        for stream in ("out", "jump_spikes"):
            trains = [run.stream(stream) for run in runs]
            self.assertGreater(len(trains[0].times_ns), 8)
            np.testing.assert_array_equal(trains[0].times_ns, trains[1].times_ns)
            np.testing.assert_array_equal(trains[0].channels, trains[1].channels)
        for stream in ("potential", "jump_V_m"):
            np.testing.assert_array_equal(runs[0].signal(stream)[1], runs[1].signal(stream)[1])
        # Under MUSIC the signal comes a tick later; it is the same network till then.
        apart, own = (run.stream("out") for run in (runs[2], runs[0]))
        first = own.times_ns <= 300 * MS
        self.assertGreater(first.sum(), 10)
        np.testing.assert_array_equal(own.times_ns[first], apart.times_ns[:first.sum()])

    def test_the_run_folder_names_the_file_and_no_temporary_one(self):
        self.prepare()
        temporary = self.folder / "tmp"
        temporary.mkdir()
        with unittest.mock.patch.dict(os.environ, {"TMPDIR": str(temporary)}):
            built_in.run(self.folder / "run", str(self.folder / "brain.py:make"), 0.01,
                         built_in.spikes([]), 5, signal=(np.array([0.0]), np.array([[0.0]])))
        resolved = json.loads((self.folder / "run" / "run" / "resolved.json").read_text())
        names = sorted(pathlib.Path(path).name for path in resolved["files"])
        self.assertEqual(names, ["brain.py", "file.npy", "helper.py", "inputs.h5"])
        self.assertEqual(list(temporary.iterdir()), [])

    def test_a_change_is_seen_at_once(self):
        self.prepare()
        for inputs in (5, 6, 7):
            self.write(f"INPUTS = {inputs}\nLEARN = False\n", "helper.py")
            self.write(SCRIPT.replace('"cell", "iaf_psc_exp", 4', f'"cell", "iaf_psc_exp", {inputs}')
                       .replace("size=(4,", f"size=({inputs},").replace("np.ones((4", f"np.ones(({inputs}")
                       .replace('    net.connect("jump", "cell", rule="file.npy", weight="100 pA", delay=1)\n', ""))
            self.assertIn(f"port in [{inputs}], port out [{inputs + 3}]", self.check("brain.py").stdout)

    def test_a_replay_from_another_directory_has_no_doubts(self):
        self.write("import spikeloop.network\n\ndef make():\n"
                   "    net = spikeloop.network.Network()\n"
                   "    net.population('p', 'poisson', 2, rate='50 Hz')\n    net.output('p')\n"
                   "    return net\n")
        self.write(json.dumps({"experiment": "e", "duration": "0.2 s", "sync": "unpaced", "nodes": {
            "brain": {"simulator": "builtin", "network": "brain.py:make"},
            "rate": {"node": "rate_window"}}, "connections": ["brain -> rate [2]"]}), "e.yaml")
        for arguments, folder in ((("run", "e.yaml", "--out", "run"), self.folder),
                                  (("replay", str(self.folder / "run")), "/")):
            _, said = built_in.spikeloop(*arguments, cwd=folder)
            self.assertNotIn("warning", said)
            self.assertNotIn("differ", said)

    def test_warnings_and_prints_are_shown(self):
        self.prepare()
        text = SCRIPT.replace("def make():", "import warnings\ndef make():\n    print('hello')\n"
                                             "    warnings.warn('strange')")
        self.write(text)
        done = self.check("brain.py")
        self.assertEqual(done.returncode, 0)
        self.assertNotIn("hello", done.stdout)
        self.assertIn("hello", done.stderr)
        self.assertIn("UserWarning: strange", done.stderr)


class Imported(Case):
    def test_a_job_with_a_function_as_an_experiment(self):
        self.prepare()
        self.write("stoptime=0.1\nmusic_timestep=0.001\n[source]\nbinary=spike_playback\nnp=1\n"
                   "file=in.h5\nstream=out\n[brain]\nbinary=spikeloop-network\nnp=1\n"
                   "network=brain.py:make\nsource.out -> brain.in [5]\n", "job.music")
        built_in.write_inputs(self.folder, built_in.spikes([]), 5, None, 0.1, 0.001)
        (self.folder / "inputs.h5").rename(self.folder / "in.h5")
        self.assertIn('network: "brain.py:make"\n', built_in.spikeloop("import", "job.music", cwd=self.folder)[0])


class Page(Case):
    def test_the_networks_of_the_page(self):
        page = (built_in.HERE.parents[1] / "docs/network-file.md").read_text()
        blocks = [block.split("```")[0] for block in page.split("```python\n")[1:]]
        self.write(blocks[0])
        done = self.check("brain.py:make")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("port in [100], port out [2]", done.stdout)
        self.write(page.split("```yaml\n")[1].split("```")[0], "brain.yaml")
        self.write(json.dumps([[1.0] * 100] * 2), "weights.json")
        done = self.check("brain.yaml")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("port in [100], port out [102]", done.stdout)


class Stopped(Case):
    """Neither Python nor its folder outlives the program that waits for it."""

    def setUp(self):
        super().setUp()
        (self.folder / "tmp").mkdir()
        self.write("import pathlib\nimport time\n\ndef make():\n"
                   "    pathlib.Path('runs').touch()\n    time.sleep(1000)\n")
        self.write(json.dumps({"experiment": "e", "duration": "1 s", "nodes": {
            "brain": {"simulator": "builtin", "network": "brain.py"}}, "connections": []}), "e.yaml")

    def stop(self, arguments, number):
        """Sends the signal when the function runs; what the program ended with."""
        program = subprocess.Popen(arguments, cwd=self.folder, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, start_new_session=True,
                                   env={**os.environ, "TMPDIR": str(self.folder / "tmp")})
        try:
            while not (self.folder / "runs").exists():
                self.assertIsNone(program.poll(), "it ended by itself")
                time.sleep(0.01)
            (self.folder / "runs").unlink()
            program.send_signal(number)
            output = program.communicate(timeout=30)[0].decode()  # whose end is Python's, too
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(program.pid, signal.SIGKILL)
            program.wait()
        return program.returncode, output

    def assert_nothing_left(self):
        """Soon: what watches over Python ends it and removes the folder."""
        for _ in range(500):
            if not list((self.folder / "tmp").iterdir()):
                return
            time.sleep(0.02)
        self.fail(list((self.folder / "tmp").iterdir()))

    def test_by_a_signal(self):
        for arguments in ([built_in.SPIKELOOP, "run", "e.yaml"],
                          [built_in.SPIKELOOP, "check", "e.yaml"], [NETWORK, "--check", "brain.py"]):
            for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP):
                with self.subTest(arguments=arguments[1:], number=number):
                    code, output = self.stop(arguments, number)
                    self.assertEqual(code, -number, output)
                    self.assert_nothing_left()

    def test_by_the_signal_that_nobody_can_hold(self):
        code, output = self.stop([NETWORK, "--check", "brain.py"], signal.SIGKILL)
        self.assertEqual((code, output), (-signal.SIGKILL, ""))
        self.assert_nothing_left()


class Faults(Case):
    def told(self, text, name="brain.py", **options):
        self.write(text)
        done = self.check(name, **options)
        self.assertEqual(done.stdout, "")
        return done.returncode, done.stderr.removeprefix("spikeloop-network: ")

    def refused(self, body):
        """A function of this body; line 5 is the first."""
        lines = "".join(f"    {line}\n" for line in body.splitlines())
        code, text = self.told("import numpy as np\nfrom spikeloop.network import Network\n\n"
                               f"def make():\n{lines}")
        self.assertEqual(code, 2, text)
        return text

    NET = "net = Network()\nnet.population('a', 'input', 2)\nnet.population('b', 'repeater', 3)\n"

    def test_an_error_has_its_line_and_traceback(self):
        code, text = self.told("def make():\n    return deeper()\n\ndef deeper():\n    return 1 / 0\n")
        self.assertEqual(code, 2)
        self.assertTrue(text.startswith(
            "brain.py:5:1: Python says: ZeroDivisionError: division by zero; at line 5 in deeper, "
            "called at line 2 in make [SL0404]\n"), text)

    def test_an_error_in_another_file_has_the_line_that_led_there(self):
        self.write("def half(x):\n    return [][x]\n", "helper.py")
        code, text = self.told("from helper import half\n\ndef make():\n    return half(3)\n")
        self.assertEqual(code, 2)
        self.assertEqual(text, "brain.py:4:1: Python says: IndexError: list index out of range; at "
                               f"line 2 of {self.folder}/helper.py in half, called at line 4 in "
                               "make [SL0404]\n")

    def test_a_file_that_is_no_python(self):
        code, text = self.told("def make(:\n")
        self.assertEqual(code, 2)
        self.assertTrue(text.startswith("brain.py:1:1: Python says: "), text)
        self.assertIn("SyntaxError", text)

    def test_a_function_that_is_not_there(self):
        code, text = self.told("def build():\n    pass\n", "brain.py:make")
        self.assertEqual((code, text),
                         (2, "brain.py: there is no function 'make'; known: build [SL0404]\n"))
        code, text = self.told("x = 1\n", "brain.py:other")
        self.assertEqual((code, text),
                         (2, "brain.py: there is no function 'other'; write  def other(): [SL0404]\n"))

    def test_something_else_returned(self):
        self.assertEqual(self.refused("return {}"),
                         "brain.py:4:1: the function 'make' returned dict, no "
                         "spikeloop.network.Network; write  return net [SL0404]\n")

    def test_a_file_that_is_not_there(self):
        done = self.check("nowhere.py:make")
        self.assertEqual(done.returncode, 4)
        built_in.assert_says(done.stderr, "nowhere.py ... [SL0109]")

    def test_an_experiment_names_the_file(self):
        run = built_in.run(self.folder / "run", "nowhere.py:make", 0.1, built_in.spikes([]), 1,
                           expect=2)
        built_in.assert_says(run.output, "key 'network': ... nowhere.py ... [SL0108]")

    def test_no_python(self):
        code, text = self.told("", environment={"PYTHON": "/nowhere/python3"})
        self.assertEqual(code, 3)
        self.assertIn("/nowhere/python3", text)

    def test_a_python_that_ends(self):
        for code in (7, 0):
            text = self.refused("import os\nimport sys\nprint('bye', file=sys.stderr, flush=True)\n"
                                f"os._exit({code})")
            self.assertTrue(text.startswith("bye\n"))
            self.assertIn(f"brain.py: Python ended with exit code {code} before the function 'make' "
                          "was over; what it said stands above [SL0404]\n", text)

    def test_a_function_that_ends_python(self):
        for value, said in (("0", "SystemExit: 0"), ("", "SystemExit"), ("'no'", "SystemExit: no")):
            self.assertEqual(self.refused(f"import sys\nsys.exit({value})"),
                             "brain.py:6:1: Python was ended before the function was over: "
                             f"{said}; at line 6 in make [SL0404]\n")

    def test_what_the_network_file_refuses_has_the_line_of_the_call(self):
        for line, wanted in (
                ("net.population('c', 'iaf_psc_exp', 1, tau=3)", "... 'tau' ... [SL0103]"),
                ("net.connect('a', 'b', rule='one_to_one', delay=1)", "... one_to_one ... [SL0308]"),
                ("net.record('b', V_m='all')", "key 'record': 'b' ... repeater, ... [SL0405]"),
                ("net.potential('b')", "key 'potential': 'b' ... repeater, ... [SL0405]")):
            text = self.refused(self.NET + line + "\nnet.output('b')\nreturn net")
            built_in.assert_says(text, f"brain.py:8:1: {wanted}")

    def test_the_methods(self):
        for line, wanted in (
                ("net.population('a', 'input', 2)",
                 "there are two populations 'a'; give each a name of its own"),
                ("net.connect('a', 'x', np.ones((1, 1)))",
                 "there is no population 'x'; call population() first"),
                ("net.connect('a', 'b', delay=1)", "a -> b: write either weights or a rule"),
                ("net.connect('a', 'b', np.ones((2, 3)), delay=1)",
                 "a -> b: the weights have the shape (2, 3), but there are 3 targets and 2 sources; "
                 "make them (3, 2)"),
                ("net.connect('a', 'b', np.full((3, 2), np.nan), delay=1)",
                 "a -> b: the weights hold nan; they must be finite"),
                ("net.population('k', 'input', 2.5)", "the size of 'k' is 2.5; write a whole number"),
                ("net.population('k', 'input', '3')", "the size of 'k' is 3; write a whole number"),
                ("net.population('k', 'input', np.inf)", "the size of 'k' is inf; write a whole number"),
                ("net.record('b', V_m=[0, np.float32(1.5)])",
                 "a member of 'b' is 1.5; write a whole number"),
                ("net.connect('a', 'b', ([0], [0.5], [1]), delay=1)",
                 "a -> b: a target is 0.5; write a whole number"),
                ("net.connect('a', 'b', np.full((3, 2), 1 + 2j), delay=1)",
                 "a -> b: the weights are complex numbers; write real ones, such as weights.real"),
                ("net.connect('a', 'b', ([0], [0], [1j]), delay=1)",
                 "a -> b: the weights are complex numbers; write real ones, such as weights.real"),
                ("net.connect('a', 'b', ([0], [0, 1], [1]), delay=1)",
                 "a -> b: weights are no triple of equally long lists; write (sources, targets, "
                 "weights)"),
                ("net.connect('a', 'b', ([2], [0], [1]), delay=1)",
                 "a -> b: there is no source 2; they count from 0 to 1"),
                ("net.connect('a', 'b', ([0], [-1], [1]), delay=1)",
                 "a -> b: there is no target -1; they count from 0 to 2")):
            text = self.refused(self.NET + line)
            self.assertTrue(text.startswith(f"brain.py:8:1: Python says: ValueError: {wanted}; at line 8 in "
                                            "make [SL0404]\n"),
                            text)


if __name__ == "__main__":
    unittest.main()
