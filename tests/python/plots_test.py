"""Drawing: pictures are made, from whole and from incomplete run folders; rates are right."""

import contextlib
import io
import json
import pathlib
import unittest
import unittest.mock

import h5py
import matplotlib.image
import numpy as np

import fake_run
from spikeloop import latency_plot, panels, parts, plots, quantities, spikes_plot, style, sweep_plot
from spikeloop.run_folder import RunFolder, RunFolderError, Signal, Spikes


def drawn(path):
    """Share of the pixels, of a quarter of them, that are not white."""
    return float((matplotlib.image.imread(path)[::2, ::2, :3].min(axis=2) < 0.95).mean())


# For tests of messages: to lay a picture out and to render it takes most of the time.
unrendered = unittest.mock.patch.object(style, "save", lambda figure, path: path.touch())


def run_main(*arguments):
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = plots.main([str(argument) for argument in arguments])
    return code, out.getvalue(), err.getvalue()


class PicturesTest(fake_run.FolderCase):
    def test_a_whole_run_gives_both_pictures(self):
        fake_run.make(self.folder, duration_s=20.0)
        code, out, err = run_main(self.folder)
        pictures = [self.folder / "trajectory.png", self.folder / "spikes.png"]
        self.assertEqual((code, err), (0, ""))
        self.assertEqual(out.split(), [str(picture) for picture in pictures])
        for picture in pictures:
            self.assertGreater(drawn(picture), 0.02)
        shape = matplotlib.image.imread(pictures[0]).shape
        self.assertEqual(shape[:2], (1184, 1280))

    @unrendered
    def test_the_pictures_go_where_they_are_wanted(self):
        fake_run.make(self.folder, duration_s=5.0)
        result = plots.plot_run(self.folder, self.folder / "a" / "b", begin_s=1.0, end_s=2.0)
        self.assertEqual(result.missing, [])
        self.assertEqual([picture.parent for picture in result.pictures],
                         [self.folder / "a" / "b"] * 2)

    def test_many_neurons_two_populations_and_one_neuron_can_be_drawn(self):
        random = np.random.default_rng(1)
        for streams in ([("out", 1000, 70_000)], [("excitatory", 80, 900), ("inhibitory", 20, 0)],
                        [("out", 1, 50)], [("out", 3, 0)]):
            with fake_run.recording(self.folder / "network.h5", "network") as file:
                for name, width, count in streams:
                    fake_run.add_spikes(file, name, np.sort(random.random(count)),
                                        random.integers(0, width, count), width, 1.0)
            spikes_plot.draw(parts.find(RunFolder(self.folder)), self.folder / "spikes.png", (0.0, 1.0))
            self.assertGreater(drawn(self.folder / "spikes.png"), 0.004, streams)

    def test_values_without_an_angle_and_nan_can_be_drawn(self):
        with fake_run.recording(self.folder / "sensor.h5", "sensor") as file:
            values = np.random.default_rng(1).random((50, 4))
            values[20:30, 2] = np.nan
            fake_run.add_signal(file, "out", np.arange(50) * 0.1, values, "m", 5.0)
        with fake_run.recording(self.folder / "command.h5", "command") as file:
            fake_run.add_signal(file, "in", np.empty(0), np.empty((0, 2)), "", 5.0)
        found = parts.find(RunFolder(self.folder))
        spikes_plot.draw(found, self.folder / "spikes.png", (0.0, 5.0))
        self.assertEqual(found.missing, [f"no network in '{self.folder}': recorded: command, sensor; "
                                   "write record=true into its section, or name it with "
                                   "--network LABEL"])
        self.assertGreater(drawn(self.folder / "spikes.png"), 0.02)


class IncompleteTest(fake_run.FolderCase):
    def test_what_is_there_is_drawn_and_what_is_missing_is_said(self):
        fake_run.make(self.folder, duration_s=5.0)
        for name in ("world.json", "sensor.h5", "summary.json"):
            (self.folder / name).unlink()
        code, out, err = run_main(self.folder)
        self.assertEqual(code, 1)
        self.assertEqual(len(out.split()), 2)
        *missing, sensor = err.splitlines()
        self.assertEqual([line.split(" is missing")[0] for line in missing],
                         [f"spikeloop: '{self.folder}/{name}.json'" for name in ("world", "summary")])
        self.assertEqual(sensor, f"spikeloop: no sensor in '{self.folder}': recorded: command, network; write "
                         "record=true into its section, or name it with --sensor LABEL")

    def test_recordings_without_a_robot(self):
        fake_run.make(self.folder, duration_s=5.0)
        (self.folder / "trajectory.csv").unlink()
        code, out, err = run_main(self.folder)
        self.assertEqual((code, out), (1, f"{self.folder}/spikes.png\n"))
        self.assertIn(f"spikeloop: trajectory.png is not drawn: '{self.folder}/trajectory.csv' ", err)
        self.assertEqual(err.count("\n"), 1, err)

    def test_a_trajectory_of_no_time(self):
        (self.folder / "trajectory.csv").write_text(
            "t_s,x_m,y_m,theta_rad,v_m_s,w_rad_s,collisions\n")
        _, _, err = run_main(self.folder)
        self.assertIn(f"trajectory.png is not drawn: '{self.folder}/trajectory.csv' has no line "
                      "below its header: the robot never moved on\n", err)

    @unrendered
    def test_coverage_may_be_unknown(self):
        fake_run.make(self.folder, duration_s=5.0)
        (self.folder / "summary.json").write_text('{"collisions": 1}')
        result = plots.plot_run(self.folder)
        self.assertEqual(result.missing, [])
        self.assertEqual(len(result.pictures), 2)

    def test_an_empty_folder(self):
        code, out, err = run_main(self.folder)
        self.assertEqual((code, out), (4, ""))
        self.assertEqual(err, f"spikeloop: '{self.folder}' is not a run folder: it has neither a "
                         "recording (*.h5) nor resolved.json, effective.music, summary.json, "
                         "trajectory.csv or world.json; name the folder that `spikeloop run` "
                         "wrote\n")

    def test_a_folder_without_recordings(self):
        (self.folder / "summary.json").write_text("{}")
        code, out, err = run_main(self.folder)
        self.assertEqual((code, out), (4, ""))
        self.assertIn(f"no sensor in '{self.folder}': nothing is recorded;", err)
        self.assertIn("spikes.png is not drawn: neither sensor, spikes nor command is recorded", err)

    @unrendered
    def test_a_damaged_recording(self):
        fake_run.make(self.folder, duration_s=5.0)
        with h5py.File(self.folder / "network.h5", "a") as file:
            del file["spikes/out/node_ids"]
        code, out, err = run_main(self.folder, "--network", "network")
        self.assertEqual((code, len(out.split())), (1, 2))
        self.assertIn("network.h5' is damaged:", err)
        self.assertIn("was the run killed while it wrote?", err)

    def test_no_folder(self):
        code, out, err = run_main(self.folder / "none")
        self.assertEqual((code, out), (4, ""))
        self.assertTrue(err.startswith(f"spikeloop: '{self.folder}/none' "), err)

    @unrendered
    def test_a_label_that_is_not_there(self):
        fake_run.make(self.folder, duration_s=5.0)
        code, _, err = run_main(self.folder, "--network", "netwrk")
        self.assertEqual(code, 1)
        self.assertRegex(err, "netwrk.h5' .* 'network'")
        code, _, err = run_main(self.folder, "--network", "sensor")
        self.assertEqual(code, 1)
        self.assertIn("sensor.h5' has no spikes\n", err)

    @unrendered
    def test_an_empty_part_of_the_run(self):
        fake_run.make(self.folder, duration_s=5.0)
        code, _, err = run_main(self.folder, "--from", 7)
        self.assertEqual(code, 1)
        self.assertIn("spikes.png is not drawn: there is nothing to draw from 7 s to 5 s: the "
                      "recordings go to 5 s\n", err)


class RolesTest(fake_run.FolderCase):
    def test_parts_are_found_by_name_and_content(self):
        for name in ("laser_sensor", "decoder", "encoder"):
            fake_run.recording(self.folder / f"{name}.h5", name).close()
        for name in ("laser_sensor", "decoder"):
            with fake_run.recording(self.folder / f"{name}.h5", name) as file:
                fake_run.add_signal(file, "out", [0.0], np.ones((1, 2)), "", 1.0)
        with fake_run.recording(self.folder / "encoder.h5", "encoder") as file:
            fake_run.add_spikes(file, "out", [0.5], [0], 1, 1.0)
        found = parts.find(RunFolder(self.folder))
        self.assertEqual([stream.label for stream in found.sensors + found.spikes + found.commands],
                         ["laser_sensor", "encoder", "decoder"])


class ExperimentTest(fake_run.FolderCase):
    """Nodes have any names: resolved.json says what they are."""

    def make(self, nodes, connections, ros="2", sync="realtime"):
        ends = [{"from": a, "to": b} for a, b in connections]
        (self.folder / "resolved.json").write_text(json.dumps(
            {"nodes": {name: {"node": kind} for name, kind in nodes.items()},
             "connections": ends, "ros": ros, "sync": sync}))

    def signal(self, label, stream="out", width=2, **more):
        with self.file(label) as file:
            fake_run.add_signal(file, stream, np.arange(10) * 0.1, np.ones((10, width)), "1", 1.0,
                                **more)

    def file(self, label):
        path = self.folder / f"{label}.h5"
        return h5py.File(path, "a") if path.exists() else fake_run.recording(path, label)

    def test_parts_follow_from_the_nodes_in_the_order_of_the_data(self):
        self.make({"command": "rate_encoder", "a": "network", "network": "ros_sensor",
                   "sensor": "ros_command", "z": "linear_readout"},
                  [("network.out", "command.in"), ("command.out", "a.in"), ("a.out", "z.in"),
                   ("z.out", "sensor.in")])
        for label, stream in (("network", "out"), ("z", "out"), ("sensor", "command"),
                              ("sensor", "latency")):
            self.signal(label, stream, width=1 if stream == "latency" else 2)
        for label in ("a", "command"):
            with self.file(label) as file:
                fake_run.add_spikes(file, "out", [0.5], [0], 1, 1.0)
        found = parts.find(RunFolder(self.folder))
        self.assertEqual([[part.label for part in row] for row in (
            found.sensors, found.spikes, found.signals, found.commands, found.latencies)],
            [["network"], ["command", "a"], ["z"], ["sensor"], ["sensor"]])
        self.assertEqual((found.notes, found.missing), ([], []))
        code, out, err = run_main(self.folder)
        self.assertEqual(code, 0, err)
        self.assertEqual([pathlib.Path(line).name for line in out.splitlines()],
                         ["spikes.png", "signals.png", "latency.png"])
        self.assertIn("trajectory.png is not drawn", err)

    @unrendered
    def test_latencies_of_the_simulation_are_not_drawn(self):
        self.signal("wheels", "command")
        self.signal("wheels", "latency", width=1)
        for ros, sync, names in (("none", "realtime", ["spikes.png"]), ("2", "lockstep", ["spikes.png"]),
                                 ("2", "realtime", ["spikes.png", "latency.png"])):
            self.make({"wheels": "ros_command"}, [], ros, sync)
            _, out, err = run_main(self.folder)
            self.assertEqual([pathlib.Path(line).name for line in out.splitlines()], names)
            self.assertNotIn("latency", err)

    @unrendered
    def test_a_robot_of_a_model_has_no_path(self):
        self.signal("motors", "command")
        for robot, words in (({"world": "arena.xml"}, 1), ({"model": "arm.xml"}, 0)):
            self.make({"motors": "ros_command"}, [])
            resolved = json.loads((self.folder / "resolved.json").read_text())
            (self.folder / "resolved.json").write_text(json.dumps({**resolved, "robot": robot}))
            _, out, err = run_main(self.folder)
            self.assertTrue(out.endswith("spikes.png\n"), out)
            self.assertEqual(err.count("trajectory.png is not drawn"), words)

    def test_episodes_of_a_run_and_of_a_sweep(self):
        rows = "".join(f"{n},{n},{n + .5},10,{-200 / n},{int(n > 5)},terminated\n" for n in range(1, 31))
        for run in ("001", "002", "003"):
            (self.folder / run).mkdir()
            (self.folder / run / "episodes.csv").write_text(
                "episode,begin_s,end_s,steps,return,success,end\n" + rows + "31,3")  # cut short
            (self.folder / run / "summary.json").write_text('{"episodes": 30}')
        table = RunFolder(self.folder / "001").episodes()
        self.assertEqual((len(table["return"]), table["return"][1], table["success"].sum()), (30, -100, 25))
        code, out, _ = run_main(self.folder / "001")
        self.assertIn(str(self.folder / "001" / "episodes.png"), out.split())
        self.assertGreater(drawn(self.folder / "001" / "episodes.png"), 0.02)
        (self.folder / "results.csv").write_text("run,seed,exit_code,exit_reason\n001,1,0,finished\n")
        code, out, err = run_main(self.folder)
        self.assertEqual((code, out.split()), (0, [str(self.folder / "episodes.png")]), err)
        with self.assertRaisesRegex(RunFolderError, "the experiment has no episodes"):
            RunFolder(self.folder).episodes()

    def test_sections_of_a_music_job_are_known_by_their_programs(self):
        (self.folder / "effective.music").write_text(
            "stoptime=1\n[b]\nbinary=/usr/bin/ros_command_adapter\n[a]\n"
            "binary=ros_sensor_adapter\n\na.out -> b.in [2]\na.data_stamp -> b.data_stamp [1]\n")
        self.signal("a")
        self.signal("b", "command")
        self.signal("b", "data_stamp", width=1)
        found = parts.find(RunFolder(self.folder))
        self.assertEqual([signal.label for signal in found.sensors + found.commands], ["a", "b"])
        self.assertEqual((found.signals, found.spikes), ([], []))
        self.assertEqual(found.notes, ["no spikes among what is recorded: a, b"])

    def test_a_damaged_resolved_file(self):
        for text, expected in (("{", "is not JSON: line 1, column 2"),
                               ("{}", "has no 'nodes': it is not what `spikeloop run` wrote")):
            (self.folder / "resolved.json").write_text(text)
            code, _, err = run_main(self.folder)
            self.assertEqual(code, 4)
            self.assertIn(expected, err)

    def test_one_damaged_recording_leaves_the_others(self):
        self.make({"a": "ros_sensor", "b": "clip"}, [("a.out", "b.in")])
        self.signal("a")
        (self.folder / "b.h5").write_text("nothing")
        code, out, err = run_main(self.folder)
        self.assertEqual((code, out), (1, f"{self.folder}/spikes.png\n"))
        self.assertIn("b.h5' cannot be read:", err)

    def test_other_formats(self):
        self.make({"a": "ros_sensor"}, [])
        self.signal("a")
        for suffix, magic in (("svg", b"<?xml"), ("pdf", b"%PDF")):
            code, out, _ = run_main(self.folder, "--format", suffix)
            self.assertEqual((code, out), (0, f"{self.folder}/spikes.{suffix}\n"))
            self.assertEqual((self.folder / f"spikes.{suffix}").read_bytes()[:len(magic)], magic)

    @unrendered
    def test_many_signals_are_cut_and_wide_ones_are_images(self):
        names = [f"n{i:02}" for i in range(14)]
        self.make({"scan": "ros_sensor", **dict.fromkeys(names, "clip")}, [])
        self.signal("scan")
        for i, name in enumerate(names):
            self.signal(name, width=1 + 3 * (i % 3))
        result = plots.plot_run(self.folder)
        self.assertEqual(result.missing, [f"signal '{name}.out' is left out of signals.png: it "
                                          "shows 12" for name in names[12:]])


class LatencyTest(unittest.TestCase):
    def test_nearest_rank(self):
        self.assertEqual(latency_plot.statistics(np.arange(1.0, 201.0)[::-1]), (100.0, 198.0))
        self.assertEqual(latency_plot.statistics(np.array([3.0])), (3.0, 3.0))

    def test_a_few_far_values_do_not_hide_the_others(self):
        usual = np.full(200, 4.0)
        self.assertAlmostEqual(latency_plot.upper_limit(usual, 4.0), 4.6)
        self.assertAlmostEqual(latency_plot.upper_limit(np.append(usual, 90.0), 4.0), 5.98)
        self.assertEqual(latency_plot.upper_limit(np.zeros(3), 0.0), 1.0)


class ThinningTest(unittest.TestCase):
    def test_at_most_so_many_neurons_are_drawn(self):
        for rows, stride in ((1, 1), (1000, 1), (1001, 2), (3000, 3), (100_000, 100)):
            self.assertEqual(spikes_plot.every_nth(rows), stride)


class QuantityTest(fake_run.FolderCase):
    """What stands at the axes follows from the message."""

    def described(self, width, message, channels=(), world=None, **keys):
        signal = Signal("x", "out", np.zeros(1), np.ones((1, width)), "1", list(channels), 1.0)
        quantities.describe(signal, message, keys, world or {})
        return signal

    def test_quantities_follow_from_the_fields(self):
        velocity, turn, position = ("velocity", "m/s"), ("angular velocity", "rad/s"), ("position", "m")
        for message, width, fields, names, expected in (
                ("geometry_msgs/Twist", 2, "", ["linear.x", "angular.z"], [velocity, turn]),
                ("nav_msgs/Odometry", 2, "", ["x", "y"], [position] * 2),
                ("nav_msgs/Odometry", 2, '["twist.twist.linear.x", {"path": "pose.pose.position.x", "scale": 2}]',
                 ["twist.twist.linear.x", "x"], [velocity, ("position", "")]),
                ("sensor_msgs/Imu", 1, '["angular_velocity.z"]', ["angular_velocity.z"], [turn]),
                ("JointState", 1, "position[0]", ["position[0]"], [("joint position", "rad or m")]),
                ("a/B", 1, '["c"]', ["c"], [("value", "")])):
            signal = self.described(width, message, fields=fields)
            self.assertEqual((signal.channels, signal.quantities), (names, expected), message)

    def test_commands_have_the_names_of_their_recording(self):
        signal = self.described(2, "geometry_msgs/Twist", ["angular.z", "arm"], fields='{"angular.z": 1, "arm": 0}')
        self.assertEqual(signal.quantities, [("angular velocity", "rad/s"), ("value", "")])

    def test_light_of_the_simulated_robot_is_in_lux(self):
        for topic, world, known in (("/light", {"lamps": [{"x_m": 0, "y_m": 0}]}, True), ("/light", {}, False),
                                    ("/other", {"lamps": [{"x_m": 0, "y_m": 0}]}, False)):
            signal = self.described(2, "std_msgs/Float64MultiArray", world=world, topic=topic)
            self.assertEqual(signal.channels, ["left", "right"] if known else [])
            self.assertEqual(signal.quantities, [("illuminance", "lux")] * 2 if known else [])

    def test_beams_have_the_angles_of_the_robots_laser(self):
        laser = {"angle_min_rad": -np.pi / 2, "angle_increment_rad": np.pi / 4}
        for count, known in ((7, True), (5, True), (4, False)):  # a longer scan was cropped
            signal = self.described(5, "sensor_msgs/LaserScan", world={"laser": {"beams": count, **laser}})
            np.testing.assert_allclose(signal.beams or (), (-90, 45) if known else ())
        self.assertIsNone(self.described(2, "nav_msgs/Odometry", world={"laser": {"beams": 100, **laser}}).beams)

    def test_a_panel_a_quantity_with_lines_or_an_image(self):
        with style.styled():
            for signal, expected in (
                    (self.described(3, "a/B", fields='["linear.x", "linear.y", "angular.z"]'),
                     [("velocity\n(m/s)", ["linear.x", "linear.y"]), ("angular.z\n(rad/s)", [])]),
                    (self.described(5, "a/B"), [("channel (index)", [])])):
                found = []
                for _, draw in panels.of_signal(signal, "x", (0.0, 1.0)):
                    figure = style.new_figure(4, 2)
                    axes = figure.subplots()
                    draw(figure, axes)
                    legend = axes.get_legend()
                    found.append((axes.get_ylabel(), [text.get_text() for text in legend.texts] if legend else []))
                    self.assertEqual(len(axes.images), int(signal.width == 5))
                self.assertEqual(found, expected)


class SweepTest(fake_run.FolderCase):
    def table(self, header, rows, samples=None):
        lines = [header, *rows]
        (self.folder / "results.csv").write_text("\n".join(lines) + "\n")
        (self.folder / "sweep.json").write_text(json.dumps({"samples": samples}))

    def test_medians_and_quartiles_over_the_seeds(self):
        header = "run,seed,encoder.rate_max,exit_code,exit_reason,wall_s,coverage"
        self.table(header, [f"{n},{seed},{rate} Hz,0,finished,{seed},{rate * seed / 1000}" for n, (rate, seed) in
                            enumerate((rate, seed) for rate in (100, 50) for seed in (1, 2, 3, 4, 9))]
                   + ["99,1,70 Hz,3,failed,,"])
        keys, measures, rows = sweep_plot._read(self.folder)
        self.assertEqual((keys, len(rows)), (["seed", "encoder.rate_max"], 10))
        with style.styled():
            figure = style.new_figure(4, 3)
            axes = figure.subplots()
            sweep_plot._draw(axes, rows, "encoder.rate_max", [], "coverage", True)
            sweep_plot._finish_column([axes], rows, "encoder.rate_max")
        (container,) = axes.containers
        line, _, (bars,) = container.lines
        np.testing.assert_allclose(line.get_xydata(), [(50, 15), (100, 30)])  # %
        np.testing.assert_allclose([bar[:, 1] for bar in bars.get_segments()], [(10, 20), (20, 40)])
        self.assertEqual(axes.get_xlabel(), "encoder.rate_max (Hz)")
        self.assertEqual(sweep_plot._statistics(rows, ["encoder.rate_max"]), "Median and quartiles of 5 runs")
        self.assertEqual(sweep_plot._statistics(rows[1:], ["encoder.rate_max"]),
                         "Median and quartiles of up to 5 runs")
        self.assertEqual(sweep_plot._statistics(rows, keys), "")
        code, out, err = run_main(self.folder)
        self.assertEqual((code, out, err), (0, f"{self.folder}/sweep.png\n", ""))
        self.assertEqual(matplotlib.image.imread(out.strip()).shape[0], round(2.6 * style.DPI))  # one measure

    def test_names_curves_and_random_designs(self):
        header = "run,layout,a.gain,exit_code,exit_reason,distance_m,a.spikes"
        rows = [f"{n},{layout},{gain},0,finished,{n},{n * n}" for n, (layout, gain) in
                enumerate((layout, gain) for layout in ("fused", "separate", "two") for gain in (1, 2))]
        for samples, width in ((None, 7.0), (6, 11.5)):
            self.table(header, rows, samples)
            code, out, err = run_main(self.folder)
            self.assertEqual((code, err), (0, ""))
            shape = matplotlib.image.imread(out.strip()).shape
            self.assertEqual(shape[:2], (round(4.4 * style.DPI), round(width * style.DPI)))
        self.assertEqual(sweep_plot._places([{"k": "5 ms"}, {"k": "1 s"}], "k"), ({"5 ms": 0, "1 s": 1}, "", False))

    def test_what_cannot_be_drawn(self):
        for header, row, expected in (
                ("run,seed,exit_code,exit_reason,distance_m", "1,{0},0,finished,{0}", "no key but the seed"),
                ("run,k,exit_code,exit_reason,distance_m", "1,{0},0,finished,5", "no measure differs"),
                ("run,k", "1,{0}", "results.csv' cannot be read")):
            self.table(header, [row.format(n) for n in range(3)])
            code, out, err = run_main(self.folder)
            self.assertEqual((code, out), (4, ""))
            self.assertIn(f"sweep.png is not drawn: {expected}" if "no " in expected else expected, err)


class RateTest(unittest.TestCase):
    def test_regular_spikes_have_their_rate_up_to_the_ends(self):
        for rate in (20.0, 100.0):
            times = np.arange(0.5 / rate, 10.0, 1.0 / rate)
            group = spikes_plot.Population("", np.repeat(times, 3), np.zeros(3 * len(times)), 3)
            _, shown = spikes_plot.population_rate(group, (0.0, 10.0), 0.05)
            np.testing.assert_allclose(shown, rate, rtol=0.15)
            np.testing.assert_allclose(shown[50:-50], rate, rtol=1e-2)

    def test_a_single_spike_is_a_gaussian_of_area_one(self):
        group = spikes_plot.Population("", np.array([5.005]), np.zeros(1), 1)
        times, shown = spikes_plot.population_rate(group, (0.0, 10.0), 0.05)
        sigma = 0.05
        expected = np.exp(-0.5 * ((times - 5.005) / sigma) ** 2) / (sigma * np.sqrt(2 * np.pi))
        np.testing.assert_allclose(shown, expected, atol=1e-3 * expected.max())
        self.assertAlmostEqual(shown.sum() * (times[1] - times[0]), 1.0, places=3)

    def test_kernels_suit_the_window(self):
        for length, expected in ((0.1, 0.005), (2.0, 0.05), (4.0, 0.05), (20.0, 0.2), (60.0, 0.5), (3600.0, 1.0)):
            self.assertAlmostEqual(spikes_plot.kernel_width_s((1.0, 1.0 + length)), expected)

    def test_populations_have_the_names_of_the_network_and_stand_once(self):
        streams = [Spikes("brain", "left_spikes", np.arange(2.0), np.array([0, 1]), 2, 5.0, [("left", 2)]),
                   Spikes("brain", "other_spikes", np.arange(1.0), np.array([0]), 1, 5.0, [("other", 1)]),
                   Spikes("brain", "out", np.arange(5.0), np.arange(5), 5, 5.0, [("left", 2), ("right", 3)])]
        found = [(population.name, list(population.rows), list(population.times_s), population.size)
                 for population in spikes_plot.populations(streams)]
        self.assertEqual(found, [("left", [0, 1], [0, 1], 2), ("right", [2, 3, 4], [2, 3, 4], 3),
                                 ("other", [5], [0], 1)])

    def test_without_names_a_node_or_a_stream_is_one_population(self):
        first = Spikes("network", "a", np.arange(2.0), np.array([0, 1]), 2, 5.0)
        second = Spikes("network", "b", np.arange(1.0), np.array([2]), 3, 5.0)
        for streams, expected in (([first], [("network", [0, 1], 2)]),
                                  ([first, second], [("a", [0, 1], 2), ("b", [4], 3)])):
            self.assertEqual([(population.name, list(population.rows), population.size)
                              for population in spikes_plot.populations(streams)], expected)


if __name__ == "__main__":
    unittest.main()
