#!/usr/bin/python3
"""What `spikeloop import` says, file, line and column, and what it leaves out."""

import pathlib
import sys
import tempfile

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from calls import assert_says, refused, spikeloop  # noqa: E402

# As ros_music_adapter's example of a vehicle: a PyNEST script between the adapters.
VEHICLE = """music_timestep=0.01
[sensor]
  np=1
  binary=./ros_sensor_adapter
  ros_topic=/laser_scan
  message_type=Laserscan
  sensor_update_rate=20
[encoder]
  np=1
  binary=./rate_encoder
  rate_max=10
[nest]
  np=1
  binary=./nest_script.py
  args=-t 10
[decoder]
  np=1
  binary=./linear_readout_decoder
  tau=0.02
  weights_filename=weights.dat
[command]
  np=1
  binary=./ros_command_adapter
  ros_topic=/cmd_vel
  message_mapping_filename=twist.dat
sensor.out -> encoder.in [20]
encoder.out -> nest.in [20]
nest.out -> decoder.in [2]
decoder.out -> command.in [2]
"""
IMPORTED = """# Imported from vehicle.music by  spikeloop import.
#
# The delays are those of a MUSIC job: a tick a continuous connection, none for spikes.
experiment: vehicle
tick: 10 ms
seed: 1
sync: realtime
ros: 1

nodes:
  sensor:
    node: ros_sensor
    topic: /laser_scan
    message: sensor_msgs/LaserScan
  encoder:
    node: rate_encoder
    rate_max: 10 Hz
  # nest: what an experiment cannot do; see what  spikeloop import  said
  decoder:
    node: linear_readout
    tau: 20 ms
    weights: weights.dat
  command:
    node: ros_command
    topic: /cmd_vel
    message: geometry_msgs/Twist
    fields:
      linear.x: {channel: 0, min: -1, max: 1}
      angular.z: {channel: 1, scale: 0.5, min: -1, max: 1}
    command_rate: 10 Hz

connections:
  - sensor -> encoder [20, delay 1 tick]
  # - encoder -> nest.in [20, delay 0 ticks]
  # - nest.out -> decoder [2, delay 0 ticks]
  - decoder -> command [2, delay 1 tick]
"""
PAIR = "[a]\nnp=1\nbinary={a}\n{keys}[b]\nnp=1\nbinary={b}\n{more}a.{out} -> b.in [2]\n"


def a_foreign_program(folder):
    (folder / "vehicle.music").write_text(VEHICLE)
    (folder / "weights.dat").write_text("[[0.5, 0], [0, 0.5]]")
    (folder / "twist.dat").write_text(
        '{"message_type": "Twist", "mapping": {"linear.x": 0, '
        '"angular.z": {"channel": 1, "scale": 0.5}}, "min": -1, "max": 1}')
    out, said = spikeloop("import", "vehicle.music", code=1, cwd=folder)
    assert out == IMPORTED, out
    assert ("error: vehicle.music:12:1: [nest] runs nest_script.py, which is none of Spikeloop's "
            "programs: an experiment cannot start it; keep  spikeloop run vehicle.music [SL0603]\n"
            "   12 | [nest]\n        ^\n"
            "spikeloop: vehicle.music: 1 error; the experiment is not complete\n") in said, said
    # Whole without the script.
    text = VEHICLE.replace("./nest_script.py\n  args=-t 10", "spikeloop-network\n  network=n.yaml")
    (folder / "vehicle.music").write_text("strict=true\nstoptime=2\nrtf=0.5\n" + text)
    (folder / "n.yaml").write_text(
        "populations: {i: {model: input, size: 20}, o: {model: repeater, size: 2}}\n"
        "connections: [{from: i, to: o, rule: all_to_all, delay: 1 ms}]\noutput: [o]\n")
    _, said = spikeloop("import", "vehicle.music", "--out", "v.yaml", cwd=folder)
    assert said == "", said
    text = (folder / "v.yaml").read_text()
    assert "duration: 2 s\n" in text and "real_time_factor: 0.5\n" in text, text
    assert "network: n.yaml\n" in text, text
    spikeloop("check", "v.yaml", cwd=folder)


def pair(a, b="rate_encoder", keys="", more="", out="out"):
    return PAIR.format(a=a, b=b, keys=keys, more=more, out=out)


def messages(folder):
    (folder / "empty.json").write_text('{"message_type": "Twist", "mapping": {}}')
    (folder / "bad.py").write_text("nonsense(")
    sensor = "ros_topic=/scan\nmessage_type=Laserscan\n"
    for text, code, expected in (
            (pair("zmq_cont_adapter"), 1,
             "x.music:1:1: [a] runs zmq_cont_adapter, which no node of an experiment does; keep  "
             "spikeloop run x.music"),
            (pair("ros_event_sensor_adapter", "linear_decoder"), 1,
             "x.music:1:1: key 'ros_topic' is missing; write for example  "
             "ros_topic=/dvs/events"),
            (pair("ros_event_sensor_adapter", "linear_decoder", "ros_topic=/e\nroi=1,2\n"), 1,
             "x.music:5:1: key 'roi': '1,2' ... 4"),
            (pair("ros_sensor_adapter"), 1,
             "x.music:1:1: key 'ros_topic' is missing; write for example  ros_topic=/scan"),
            (pair("ros_sensor_adapter", keys="ros_topic=/scan\n"), 1,
             "x.music:1:1: key 'message_type' is missing; write for example  "
             "message_type=sensor_msgs/LaserScan"),
            (pair("ros_sensor_adapter", keys="ros_topic=/s\nmessage_type=Scan\n"), 1,
             "x.music:5:1: ... 'Scan' ... [SL0502]"),
            (pair("ros_sensor_adapter", "ros_command_adapter", sensor), 1,
             "x.music:6:1: key 'ros_topic' is missing; write for example  ros_topic=/cmd_vel"),
            (pair("ros_sensor_adapter", "cont_ros_adapter", sensor,
                  "message_mapping_filename=empty.json\n"), 1,
             "x.music:9:1: the mapping 'empty.json' has no field: all that it sends is 0; map a "
             "field"),
            (pair("ros_sensor_adapter", "cont_ros_adapter", sensor + "strict=true\n",
                  "strict=true\n"), 1, "'mapping.json'"),
            (pair("ros_sensor_adapter", "connect_adapter", sensor, "strict=true\n"), 1,
             "there is no weights file 'connection_weights.dat'"),
            (pair("ros_sensor_adapter", "discretize_adapter", sensor), 1,
             "there is no grid file 'grid_positions.json'"),
            (pair("spike_playback", "linear_decoder", "file=none.h5\n"), 1,
             "x.music:4:1: there is no recording 'none.h5'"),
            (pair("spike_playback", "linear_decoder"), 1, "section 'a' has no file; write file="),
            (pair("spike_playback", "spikeloop-network"), 1,
             "x.music:4:1: section 'b' has no network; write network=brain.yaml"),
            (pair("ros_sensor_adapter", "spikeloop-node", sensor, "node=rate_encodr\n"), 1,
             "x.music:9:1: ... 'rate_encodr'; ... 'rate_encoder'? ... [SL0401]"),
            (pair("ros_sensor_adapter", "spikeloop-node", sensor), 1,
             "x.music:6:1: section 'b' has no node; write node=rate_encoder"),
            (pair("ros_sensor_adapter", "spikeloop-node", sensor, "node=n\nplugin=none.py\n"), 1,
             "x.music:10:1: there is no plug-in 'none.py'"),
            (pair("ros_sensor_adapter", "spikeloop-node", sensor, "node=n\nplugin=bad.py\n"), 1,
             "x.music:10:1: "),
            (pair("ros_sensor_adapter", keys=sensor + "seed=3\n", more="seed=4\n"), 1,
             "x.music:10:1: section 'b' has seed=4, another one 3: an experiment has one; write "
             "the same in all"),
            (pair("ros_sensor_adapter", "ros_command_adapter", sensor + "ros=2\n",
                  "message_mapping_filename=twist.dat\nros_topic=/cmd_vel\n"), 1,
             "x.music:7:1: section 'b' speaks ROS 1, another one ROS 2: an experiment has one version; "
             "write  ros=2  in all"),
            (pair("ros_sensor_adapter", "ros_command_adapter", sensor,
                  "message_mapping_filename=twist.dat\nros_topic=/cmd_vel\nros=2\n"), 1,
             "section 'b' speaks ROS 2, another one ROS 1: an experiment has one version; write  ros=1  in all"),
            (pair("ros_sensor_adapter", "ros_command_adapter", sensor,
                  "ros_topic=/c\nsensor_mapping_filename=none.json\n"), 0,
             "key 'sensor_mapping_filename' has no counterpart in an experiment"),
            (pair("ros_sensor_adapter", keys=sensor, more="rate_mox=3\n"), 0,
             "warning: x.music:9:1: key 'rate_mox' has no counterpart in an experiment and is left out"),
            (pair("ros_sensor_adapter", keys=sensor).replace("[b]", "[b-1]")
             .replace("b.in", "b-1.in"), 0,
             "'b-1' ... 'b_1': random numbers depend on the name"),
            (pair("spike_playback", "linear_decoder", "file=r.h5\n", "accept_latency=0.002\n"), 0,
             "the spikes of a.out -> b.in come 2 ticks late in the job, and have their own times"),
            (pair("ros_sensor_adapter", keys="np=x\n"), 2, "x.music:4:1: "),
            ("[a]\nnp=1\n", 2, "x.music:1:1: "),
            ("a = \n[", 2, "x.music:2:")):
        (folder / "r.h5").write_text("")
        (folder / "x.music").write_text(text)
        assert_says(spikeloop("import", "x.music", code=code, cwd=folder)[1], expected)


def command_line(folder):
    (folder / "x.music").write_text(VEHICLE)
    for arguments, code, expected in (
            (("none.music",), 4, "none.music"),
            (("x.yaml",), 2, "'x.yaml' is an experiment already; write  spikeloop run x.yaml"),
            (("x.music", "--out", "x.txt"), 2,
             "--out: 'x.txt' is not a valid experiment file name; write one that ends in .yaml"),
            (("x.music", "--out", "/proc/none/x.yaml"), 4, "/proc/none/x.yaml"),
            ((), 2, "FILE is required")):
        refused(expected, "import", *arguments, code=code, cwd=folder)


def main():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        a_foreign_program(folder)
        messages(folder)
        command_line(folder)


if __name__ == "__main__":
    main()
