"""Reading: what the C++ recorder wrote, what docs/run-folder.md promises, what the errors say."""

import contextlib
import io
import json
import os
import pathlib
import re
import subprocess
import unittest

import h5py
import numpy as np

import fake_run
from spikeloop.run_folder import RunFolder, RunFolderError


class Folder(fake_run.FolderCase):
    def says(self, action, text):
        with self.assertRaises(RunFolderError) as caught:
            action()
        self.assertEqual(str(caught.exception), text.replace("FOLDER", str(self.folder)))


class RecordingTest(Folder):
    """Files of the C++ recorder: one spike and one signal row a millisecond."""

    def setUp(self):
        super().setUp()
        self.file = self.folder / "doomed.h5"
        ended = subprocess.run([os.environ["SPIKELOOP_RECORDING_PROCESS"], "full", self.file],
                               capture_output=True, text=True, check=True)
        self.spikes, _, self.rows, _ = (int(word) for word in ended.stdout.split()[:4])

    def test_spikes_are_those_that_were_sent(self):
        stream, = RunFolder(self.folder).spikes("doomed")
        k = np.arange(self.spikes)
        self.assertEqual((stream.label, stream.stream, stream.width), ("doomed", "out", 7))
        np.testing.assert_array_equal(np.round(stream.times_s * 1e9),
                                      k * 1_000_000 + 1 + k % 1000)
        np.testing.assert_array_equal(stream.channels, k % 7)
        self.assertAlmostEqual(stream.until_s, self.spikes * 1e-3)

    def test_signal_is_the_one_that_was_sent(self):
        signal = RunFolder(self.folder).signal("doomed", "value")
        k = np.arange(self.rows)
        self.assertEqual((signal.width, signal.unit, signal.channels), (2, "m/s", []))
        np.testing.assert_allclose(signal.times_s, (k + 1) * 1e-3, rtol=1e-12)
        np.testing.assert_array_equal(signal.values, np.stack((k, -k), axis=1))

    def test_the_fake_run_has_the_recorder_s_layout(self):
        def layout(path):
            found = {}

            def visit(name, thing):
                attributes = {key: np.asarray(value).dtype.kind
                              for key, value in thing.attrs.items() if key != "sorting"}
                found[name] = (getattr(thing, "dtype", None), attributes)
            with h5py.File(path, "r") as file:
                file.visititems(visit)
            return found
        with fake_run.recording(self.folder / "fake.h5", "doomed") as file:
            fake_run.add_spikes(file, "out", [0.1], [1], 7, 1.0)
            fake_run.add_signal(file, "value", [0.1], [[1.0, 2.0]], "m/s", 1.0)
        real, fake = layout(self.file), layout(self.folder / "fake.h5")
        self.assertEqual(set(real), set(fake))
        for name, (dtype, attributes) in fake.items():
            self.assertEqual(real[name][0], dtype, name)
            self.assertLessEqual(attributes.items(), real[name][1].items(), name)


class DocumentationTest(Folder):
    def test_the_examples_of_the_page_run(self):
        page = (pathlib.Path(os.environ["SPIKELOOP_DOCS"]) / "run-folder.md").read_text()
        blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
        self.assertEqual(len(blocks), 2)
        fake_run.make(self.folder, duration_s=5.0)
        (self.folder / "network.h5").rename(self.folder / "brain.h5")
        (self.folder / "command.h5").rename(self.folder / "wheels.h5")
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(self.folder)
        for block in blocks:
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(block.replace("runs/explorer-1", "."), {})
            self.assertNotEqual(printed.getvalue(), "", block)


class SignalTest(Folder):
    def test_rows_hold_until_the_next_one(self):
        with fake_run.recording(self.folder / "sensor.h5", "sensor") as file:
            fake_run.add_signal(file, "out", [1.0, 3.0], [[10.0], [30.0]], "m", 5.0)
        values = RunFolder(self.folder).signal("sensor").at([0.5, 1.0, 2.9, 3.0, 5.0, 5.1])
        np.testing.assert_array_equal(values[:, 0], [np.nan, 10, 10, 30, 30, np.nan])

    def test_the_widest_signal_beside_data_stamp_is_meant(self):
        with fake_run.recording(self.folder / "sensor.h5", "sensor") as file:
            fake_run.add_signal(file, "narrow", [0.0], np.ones((1, 1)), "", 1.0)
            for measured in ("data_stamp", "pace"):
                fake_run.add_signal(file, measured, [0.0], np.ones((1, 9)), "s", 1.0)
            fake_run.add_signal(file, "wide", [0.0], np.ones((1, 3)), "", 1.0,
                                channels=("a", "b", "c"))
        signal = RunFolder(self.folder).signal("sensor")
        self.assertEqual(signal.stream, "wide")
        self.assertEqual(signal.channels, ["a", "b", "c"])

    def test_datasets_of_a_killed_process_may_differ_in_length(self):
        with fake_run.recording(self.folder / "x.h5", "x") as file:
            fake_run.add_spikes(file, "out", [0.1, 0.2], [1, 2], 3, 1.0)
            del file["spikes/out/node_ids"]
            file["spikes/out"].create_dataset("node_ids", data=np.array([1], dtype=np.uint64))
        stream, = RunFolder(self.folder).spikes("x")
        np.testing.assert_array_equal(stream.channels, [1])
        np.testing.assert_allclose(stream.times_s, [0.1])


class ErrorTest(Folder):
    def test_no_folder(self):
        self.says(lambda: RunFolder("/nowhere/run"), "'/nowhere/run' is not a folder; name the "
                  "folder that `spikeloop run --out` wrote")

    def test_recordings(self):
        with fake_run.recording(self.folder / "sensor.h5", "sensor") as file:
            fake_run.add_signal(file, "out", [0.0], np.ones((1, 1)), "", 1.0)
        fake_run.recording(self.folder / "network.h5", "network").close()
        with h5py.File(self.folder / "future.h5", "w") as file:
            file.attrs["spikeloop_format"] = 2
        run = RunFolder(self.folder)
        self.says(lambda: run.spikes("senor"), "'FOLDER/senor.h5' is missing: write record=true "
                  "into the section 'senor'; did you mean 'sensor'?")
        self.says(lambda: run.spikes("q"), "'FOLDER/q.h5' is missing: write record=true into the "
                  "section 'q'; known: future, network, sensor")
        (self.folder / "resolved.json").write_text("{}")
        self.says(lambda: run.spikes("q"), "'FOLDER' has no recording of 'q'; known: future, network, sensor")
        self.says(lambda: run.signal("sensor", "outt"), "'FOLDER/sensor.h5' has no signal 'outt'; "
                  "did you mean 'out'?")
        self.says(lambda: run.signal("network"), "'FOLDER/network.h5' has no signal")
        self.says(lambda: run.spikes("future"), "'FOLDER/future.h5' is not a recording that this "
                  "version can read: its spikeloop_format is 2, up to 1 is known")

    def test_no_hdf5(self):
        (self.folder / "text.h5").write_text("just a text")
        with self.assertRaisesRegex(RunFolderError, r"text\.h5' cannot be read: .*signature"):
            RunFolder(self.folder).spikes("text")

    def test_trajectory(self):
        run = RunFolder(self.folder)
        file = self.folder / "trajectory.csv"
        self.says(run.trajectory, "'FOLDER/trajectory.csv' is missing: the run started no robot, "
                  "and no message arrived on /odom")
        file.write_text("t_s,x_m\n")
        self.says(run.trajectory, "'FOLDER/trajectory.csv' has no column 'y_m'; its first line "
                  "must be t_s,x_m,y_m,theta_rad,v_m_s,w_rad_s,collisions")
        file.write_text("t_s,x_m,y_m,theta_rad,v_m_s,w_rad_s,collisions\n0,0,0,0,0,zero,0\n")
        self.says(run.trajectory, "'FOLDER/trajectory.csv' holds something that is not a number: "
                  "could not convert string to float: 'zero'")
        for content, error in ((b"x" * 200_000 + b"\n", "field larger than field limit (131072)"),
                               (b"\xff\n", "'utf-8' codec can't decode byte 0xff in position 0: invalid start byte")):
            file.write_bytes(content)
            self.says(run.trajectory, f"'FOLDER/trajectory.csv' is not a table: {error}")

    def test_an_incomplete_last_line_is_ignored(self):
        """A running program has written any number of bytes of its table."""
        run = RunFolder(self.folder)
        text = "t_s,x_m,y_m,theta_rad,v_m_s,w_rad_s,collisions\n0,1,2,3,4,5,0\n0.25,12,13,14,15,16,17\n"
        columns = text.split("\n")[0].split(",")
        rows = ([0, 1, 2, 3, 4, 5, 0], [0.25, 12, 13, 14, 15, 16, 17])
        self.grow("trajectory.csv", text, lambda count: self.assertEqual(
            {name: list(column) for name, column in run.trajectory().items()},
            {name: [row[i] for row in rows[:count]] for i, name in enumerate(columns)}), run.trajectory)
        text = "episode,begin_s,end_s,steps,return,success,end\n1,0,2.5,10,-1.25,1,goal\n2,2.5,3,20,2,0,timeout\n"
        self.grow("episodes.csv", text, lambda count: self.assertEqual(
            (list(run.episodes()["return"]), run.episodes()["end"]),
            ([-1.25, 2][:count], ["goal", "timeout"][:count])), run.episodes)

    def grow(self, name, text, assert_rows, read):
        for length in range(len(text) + 1):
            (self.folder / name).write_text(text[:length])
            with self.subTest(name, length=length):
                if "\n" not in text[:length]:
                    self.says(read, f"'FOLDER/{name}' has no complete line yet: the run has just begun, or was killed")
                else:
                    assert_rows(text[:length].count("\n") - 1)

    def test_json(self):
        run = RunFolder(self.folder)
        self.says(run.world, "'FOLDER/world.json' is missing: arena and obstacles are not drawn")
        self.says(run.summary, "'FOLDER/summary.json' is missing: the run did not end by itself, "
                  "or is under way")
        (self.folder / "world.json").write_text("{\n  \"arena\": }")
        self.says(run.world, "'FOLDER/world.json' is not JSON: line 2, column 12: Expecting value")

    def test_a_world_that_cannot_be_drawn(self):
        arena = {"min_x_m": -3, "min_y_m": -3, "max_x_m": 3, "max_y_m": 3}
        box = {"shape": "box", "x_m": 1, "y_m": 1, "half_x_m": 0.1, "half_y_m": 0.1}
        run = RunFolder(self.folder)
        for fault, world in (
                *(("arena", {"arena": {**arena, "max_x_m": wrong}})
                  for wrong in (float("nan"), float("inf"), 1e20, -3, None, "3", [3])),
                ("arena", {"arena": 3}), ("laser", {"arena": arena, "laser": {"beams": "100"}}),
                ("obstacles", {"obstacles": 3}), ("obstacles", {"obstacles": [None]}),
                ("lanes", {"lanes": [{**box, "half_x_m": None}]}), ("goals", {"goals": [{**box, "shape": []}]}),
                ("goals", {"goals": [{**box, "theta_rad": "0"}]}), ("lamps", {"lamps": [{"x_m": 1}]})):
            (self.folder / "world.json").write_text(json.dumps(world))
            self.says(run.world, f"'FOLDER/world.json' is damaged: invalid or too large value in '{fault}'; "
                                 "arena and obstacles are not drawn")
        world = {"arena": arena, "obstacles": [box], "lamps": [{"x_m": 1, "y_m": 1}]}
        (self.folder / "world.json").write_text(json.dumps(world))
        self.assertEqual(run.world(), world)


if __name__ == "__main__":
    unittest.main()
