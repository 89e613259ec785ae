// Experiment files that are wrong, and every word that is said about them. Topics, weights,
// networks, recordings.
#include "tests/experiment/wrong_file.hpp"

namespace spikeloop::test {
namespace {

/// The good file with an arm. @param fields value of the command's key `fields`, and more keys
WrongFile arm_file(const char* what, const std::string& fields, const std::string& fault) {
  return {what,
          {{"mujoco}", "mujoco, model: arm.xml}"},
           {"topic: /scan, message: LaserScan", "topic: /sensors/tip, message: Float64MultiArray"},
           {"topic: /cmd_vel, message: Twist, fields: {linear.x: 0, angular.z: 1}",
            "topic: /joint_commands, message: sensor_msgs/JointState, fields: " + fields}},
          {fault}};
}

class WrongNodes : public testing::TestWithParam<WrongFile> {};

TEST_P(WrongNodes, AreExplained) {
  expect_faults(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Table, WrongNodes,
    testing::Values(
        WrongFile{"no robot for a topic",
                  {{"robot: {simulator: mujoco}\n", ""}},
                  {"x.yaml:5:3: node 'scan': ... /scan ... ros: 2, or  robot: {simulator: mujoco} "
                   "... [SL0507]",
                   "x.yaml:9:3: node 'wheels': ... /cmd_vel ... ros: 2, or  robot: {simulator: "
                   "mujoco} ... [SL0507]"}},
        WrongFile{"topic unknown to the robot",
                  {{"/scan", "/scann"}},
                  {"x.yaml:6:35: key 'topic': the robot has no topic /scann there; did you mean "
                   "'/scan'?; with  ros: 2  any topic is possible [SL0507]"}},
        WrongFile{
            "a camera that is off",
            {{"topic: /scan, message: LaserScan",
              "topic: /camera/image_raw, message: sensor_msgs/Image"}},
            {"x.yaml:6:35: key 'topic': the robot's camera, which sends /camera/image_raw, is "
             "off; write  robot: {simulator: mujoco, camera: {width: 64, height: 48}} [SL0507]"}},
        WrongFile{"a world and another robot at once",
                  {{"mujoco}", "mujoco, world: arena, model: arm.xml}"}},
                  {"x.yaml:4:35: robot: key 'world' is for the vehicle, and 'model' replaces it; "
                   "leave one of the two out [SL0208]"}},
        WrongFile{"a keyframe of the vehicle",
                  {{"mujoco}", "mujoco, keyframe: home}"}},
                  {"x.yaml:4:38: robot: key 'keyframe' is for a robot with  model: FILE; leave it "
                   "out [SL0208]"}},
        arm_file("an actuator that the robot does not have",
                 "{'effort[name=elbow]': 0, 'effort[name=sholder]': 1}",
                 "x.yaml:10:146: ... 'effort[name=sholder]' of its topic /joint_commands ... "
                 "'effort[name=shoulder]' ... [SL0504]"),
        arm_file("an actuator of another kind",
                 "{'effort[name=elbow]': 0, 'velocity[name=shoulder]': 1}",
                 "x.yaml:10:149: ... 'velocity[name=shoulder]' ... did you mean "
                 "'effort[name=shoulder]'? [SL0504]"),
        arm_file("a held joint that the robot does not have",
                 "{'effort[name=elbow]': 0, 'effort[name=shoulder]': 1}, "
                 "stop: {'effort[name=elbow]': hold elbw}",
                 "... key 'stop': the robot has no joint 'elbw' to hold; did you mean 'elbow'? "
                 "[SL0504]"),
        arm_file("joint positions on a topic that the robot does not have",
                 "{'effort[name=elbow]': 0, 'effort[name=shoulder]': 1}, "
                 "stop: {'effort[name=elbow]': hold elbow}, joint_states: /joint_state",
                 "... key 'joint_states': the robot sends no joint positions on /joint_state; did "
                 "you mean '/joint_states'? [SL0507]"),
        WrongFile{
            "a held joint without measured positions",
            {{"angular.z: 1}", "angular.z: 1}, stop: {linear.x: hold left}, joint_states: none"}},
            {"... key 'joint_states' is none, but 'linear.x' holds the measured position of "
             "joint 'left' ... [SL0208]"}},
        WrongFile{
            "a camera that is not a map",
            {{"mujoco}", "mujoco, camera: on}"}},
            {"x.yaml:4:36: key 'camera': 'on' is not a map; write  camera: {width: 64, height: "
             "48} [SL0105]"}},
        WrongFile{
            "a camera's keys",
            {{"mujoco}", "mujoco, camera: {wdth: 64, fov: 200 deg, rate: 20}}"}},
            {"x.yaml:4:43: key 'camera': unknown key 'wdth'; did you mean 'width'? [SL0103]"}},
        WrongFile{
            "a camera without a unit",
            {{"mujoco}", "mujoco, camera: {rate: 20}}"}},
            {"x.yaml:4:43: key 'camera': key 'rate': 20 has no unit; write for example  rate: "
             "20 Hz [SL0202]"}},
        WrongFile{"a camera that sees too much",
                  {{"mujoco}", "mujoco, camera: {fov: 200 deg}}"}},
                  {"x.yaml:4:42: key 'camera': key 'fov': 200 ... 1 to 170 deg ... [SL0203]"}},
        WrongFile{"command topic unknown to the robot",
                  {{"/cmd_vel", "/motor"}},
                  {"x.yaml:10:38: key 'topic': ... /motor there ... /cmd_vel; with  ros: 2 ... "
                   "[SL0507]"}},
        WrongFile{
            "unknown message type",
            {{"LaserScan", "LaserScann"}},
            {"x.yaml:6:51: unknown message type 'LaserScann'; did you mean 'LaserScan'? [SL0502]"}},
        WrongFile{
            "wrong message type",
            {{"message: LaserScan", "message: Odometry"}},
            {"x.yaml:6:51: key 'message': the robot's topic /scan carries sensor_msgs/LaserScan, "
             "not nav_msgs/Odometry; write  message: sensor_msgs/LaserScan [SL0508]"}},
        WrongFile{
            "wrong message types over ROS",
            {{"robot: {simulator: mujoco}", "robot: {simulator: mujoco}\nros: 2"},
             {"message: LaserScan", "message: Odometry, fields: [pose.pose.position.x]"},
             {"message: Twist, fields: {linear.x: 0, angular.z: 1}",
              "message: TwistStamped, fields: {twist.linear.x: 0, twist.angular.z: 1}"}},
            {"x.yaml:7:51: key 'message': the robot's topic /scan carries sensor_msgs/LaserScan, "
             "not nav_msgs/Odometry; write  message: sensor_msgs/LaserScan [SL0508]",
             "x.yaml:11:57: key 'message': the robot's topic /cmd_vel carries geometry_msgs/Twist, "
             "not geometry_msgs/TwistStamped; write  message: geometry_msgs/Twist [SL0508]"}},
        WrongFile{"unknown field of a message",
                  {{"linear.x: 0", "liner.x: 0"}},
                  {"x.yaml:10:82: field path 'liner.x' of geometry_msgs/Twist: geometry_msgs/Twist "
                   "has no field 'liner'; did you mean 'linear'? [SL0504]"}},
        WrongFile{"unknown field of a sensor",
                  {{"message: LaserScan", "message: LaserScan, fields: [rangs]"}},
                  {"x.yaml:6:70: field path 'rangs' of sensor_msgs/LaserScan: "
                   "sensor_msgs/LaserScan has no field 'rangs'; did you mean 'ranges'? [SL0504]"}},
        WrongFile{"fields that are no paths",
                  {{"message: LaserScan", "message: LaserScan, fields: [[3]]"}},
                  {"x.yaml:6:71: key 'fields': entry 1: '[3]' is not a map; write  fields: [{path: "
                   "ranges, scale: 2}] [SL0105]"}},
        WrongFile{"fields of a sensor that are a map",
                  {{"message: LaserScan", "message: LaserScan, fields: {ranges: 0}"}},
                  {"x.yaml:6:70: key 'fields': '{\"ranges\":0}' is not a list; write  fields: "
                   "[pose.pose.position.x] [SL0105]"}},
        WrongFile{"fields that are no map",
                  {{"{linear.x: 0, angular.z: 1}", "[linear.x]"}},
                  {"x.yaml:10:72: key 'fields': '[\"linear.x\"]' is not a map; write  fields: "
                   "{linear.x: 0, angular.z: 1} [SL0105]"}},
        WrongFile{"field with an unknown key",
                  {{"linear.x: 0", "linear.x: {chanel: 0}"}},
                  {"x.yaml:10:92: key 'fields': 'linear.x': unknown key 'chanel'; did you mean "
                   "'channel'? [SL0103]"}},
        WrongFile{
            "no fields",
            {{", fields: {linear.x: 0, angular.z: 1}", ""}},
            {"x.yaml:10:57: key 'fields' is missing: a geometry_msgs/Twist has to know which "
             "channel is which; write for example  fields: {linear.x: 0, angular.z: 1} [SL0104]"}},
        WrongFile{"channel out of range",
                  {{"angular.z: 1", "angular.z: 2"}},
                  {"x.yaml:10:97: 'fields.angular.z' reads channel 2, but the port has 2 (0 to 1); "
                   "write one of these or widen the connection [SL0505]"}},
        WrongFile{"negative channel",
                  {{"angular.z: 1", "angular.z: -1"}},
                  {"x.yaml:10:97: key 'fields': 'angular.z': key 'channel': -1 ... 0 to 16777215 "
                   "... [SL0203]"}},
        WrongFile{"limits of an unknown field",
                  {{"angular.z: 1}", "angular.z: 1}, limits: {linear.y: [0, 1]}"}},
                  {"x.yaml:10:120: key 'limits': 'linear.y' is not one of the fields; did you mean "
                   "'linear.x'? If not, write it into  fields, too [SL0504]"}},
        WrongFile{
            "limits that are no pair",
            {{"angular.z: 1}", "angular.z: 1}, limits: {linear.x: 1}"}},
            {"x.yaml:10:120: key 'limits': 'linear.x': '1' ... 2 ... [-0.5, 0.5] ... [SL0105]"}},
        WrongFile{
            "limits the wrong way round",
            {{"angular.z: 1}", "angular.z: 1}, limits: {linear.x: [1, 0]}"}},
            {"x.yaml:10:120: key 'limits': minimum 1 of 'linear.x' is greater than maximum 0; "
             "write  linear.x: [0, 1] [SL0206]"}},
        WrongFile{"stop of an unknown field",
                  {{"angular.z: 1}", "angular.z: 1}, stop: {linear.y: hold}"}},
                  {"x.yaml:10:118: key 'stop': 'linear.y' ... fields, too ... [SL0504]"}},
        WrongFile{
            "stop with an unknown word",
            {{"angular.z: 1}", "angular.z: 1}, stop: {linear.x: hodl}"}},
            {"x.yaml:10:118: key 'stop': hodl is no value for a stop; write a number, or hold, "
             "or hold and the name of a joint [SL0201]"}},
        WrongFile{"stop that is another word",
                  {{"angular.z: 1}", "angular.z: 1}, stop: keep"}},
                  {"... key 'stop': 'keep' is neither zero nor hold nor a map; write  zero, hold, "
                   "or a map such as  stop: {FIELD: 0} [SL0105]"}},
        WrongFile{"slew of an unknown field",
                  {{"angular.z: 1}", "angular.z: 1}, slew: {linear.y: 1}"}},
                  {"x.yaml:10:118: key 'slew': 'linear.y' ... fields, too ... [SL0504]"}},
        WrongFile{"slew that is not a rate",
                  {{"angular.z: 1}", "angular.z: 1}, slew: {linear.x: 0}"}},
                  {"x.yaml:10:118: key 'slew': 0 of 'linear.x' is not a rate of change; write a "
                   "number above 0, as  linear.x: 1.0, in units a second [SL0203]"}},
        WrongFile{
            "slew that is not a map",
            {{"angular.z: 1}", "angular.z: 1}, slew: 1"}},
            {"x.yaml:10:107: key 'slew': '1' is not a map; write  slew: {linear.x: 1.0} [SL0105]"}},
        WrongFile{
            "slew of a field that is none",
            {{"linear.x: 0,", "linear.x: {channel: 0, slew: -1},"}},
            {"x.yaml:10:72: 'fields.linear.x.slew' is -1, no rate of change ... 0 ... [SL0203]"}},
        WrongFile{"emergency stop with an unknown key",
                  {{"angular.z: 1}", "angular.z: 1}, emergency_stop: {latchd: true}"}},
                  {"x.yaml:10:126: key 'emergency_stop': unknown key 'latchd'; did you mean "
                   "'latched'? [SL0103]"}},
        WrongFile{"emergency stop without a unit",
                  {{"angular.z: 1}", "angular.z: 1}, emergency_stop: {timeout: 1}"}},
                  {"x.yaml:10:127: key 'emergency_stop': key 'timeout': 1 has no unit; write for "
                   "example  timeout: 1 ms  or  timeout: 1 s [SL0202]"}},
        WrongFile{"emergency stop that is not a truth value",
                  {{"angular.z: 1}", "angular.z: 1}, emergency_stop: {required: often}"}},
                  {"x.yaml:10:128: key 'emergency_stop': key 'required': 'often' ... true or false "
                   "... [SL0205]"}},
        WrongFile{"emergency stop of an unknown message",
                  {{"angular.z: 1}", "angular.z: 1}, emergency_stop: {message: std_msgs/Bol}"}},
                  {"x.yaml:10:127: key 'emergency_stop': unknown message type 'std_msgs/Bol'; did "
                   "you mean 'std_msgs/Bool'? [SL0502]"}},
        WrongFile{"emergency stop of an unknown field",
                  {{"angular.z: 1}", "angular.z: 1}, emergency_stop: {field: dat}"}},
                  {"x.yaml:10:125: key 'emergency_stop': field path 'dat' of std_msgs/Bool: "
                   "std_msgs/Bool has no field 'dat'; did you mean 'data'? [SL0504]"}},
        WrongFile{"emergency stop that is a list",
                  {{"angular.z: 1}", "angular.z: 1}, emergency_stop: [/stop]"}},
                  {"x.yaml:10:117: key 'emergency_stop': '[\"/stop\"]' is not a map; write  "
                   "emergency_stop: {topic: /stop, required: true} [SL0105]"}},
        WrongFile{"emergency stop on the commands' topic",
                  {{"angular.z: 1}", "angular.z: 1}, emergency_stop: /cmd_vel"}},
                  {"x.yaml:10:117: key 'emergency_stop': /cmd_vel is the topic of the commands "
                   "themselves; write another one, or none [SL0506]"}},
        WrongFile{"emergency stop without a topic",
                  {{"angular.z: 1}", "angular.z: 1}, emergency_stop: \"\""}},
                  {"x.yaml:10:117: node 'wheels': key 'emergency_stop' ... [SL0105]"}},
        WrongFile{"commands to what is not a topic",
                  {{"topic: /cmd_vel", "topic: a-b"}},
                  {"x.yaml:10:38: 'a-b' ... ROS topic name; write letters, digits, '_' and '/', "
                   "beginning with a letter or '/', as in /cmd_vel ... [SL0501]"}},
        WrongFile{"emergency stop on what is not a topic",
                  {{"angular.z: 1}", "angular.z: 1}, emergency_stop: \"a b\""}},
                  {"x.yaml:10:117: 'a b' ... ROS topic name; write letters, digits, '_' and '/' "
                   "... '/', as in /cmd_vel ... [SL0501]"}},
        WrongFile{"override on what is not a topic",
                  {{"angular.z: 1}", "angular.z: 1}, override: 1by_hand"}},
                  {"x.yaml:10:111: '1by_hand' ... ROS topic name; write letters, digits, '_' and "
                   "'/' ... '/', as in /cmd_vel ... [SL0501]"}},
        WrongFile{"time that no clock has",
                  {{"angular.z: 1}", "angular.z: 1}, sensor_timeout: 1e30 s"}},
                  {"x.yaml:10:117: a time of 1e+30 s cannot be represented; write a finite number "
                   "of seconds below 9e+09 [SL0203]"}},
        WrongFile{"override on the topic of the emergency stop",
                  {{"angular.z: 1}", "angular.z: 1}, override: /emergency_stop"}},
                  {"x.yaml:10:111: key 'override': /emergency_stop ... or none ... [SL0506]"}},
        WrongFile{"override without time",
                  {{"angular.z: 1}", "angular.z: 1}, override: {timeout: 0 s}"}},
                  {"x.yaml:10:121: key 'override': key 'timeout': 0 ... write a value of at least "
                   "0.001 s ... [SL0203]"}},
        WrongFile{"spike timeout that is none",
                  {{"angular.z: 1}", "angular.z: 1}, spike_timeout: -1 s"}},
                  {"x.yaml:10:116: key 'spike_timeout': -1 ... 0 s ... [SL0203]"}},
        WrongFile{
            "spike timeout without spikes",
            {{"connections:",
              "  other: {node: ros_command, topic: /out, message: Float64MultiArray, "
              "spike_timeout: 1 s}\nconnections:\n  - scan -> other [3]"},
             {"robot: {simulator: mujoco}\n", "ros: 1\n"}},
            {"x.yaml:11:86: key 'spike_timeout': no spikes are on the way to 'other'; leave it "
             "out [SL0208]"}},
        WrongFile{"initial value that is none",
                  {{"message: LaserScan", "message: LaserScan, initial: zero"}},
                  {"x.yaml:6:71: key 'initial': 'zero' is neither a number nor 'none'; write for "
                   "example 0 [SL0201]"}},
        WrongFile{"weights file missing",
                  {{"w.json", "v.json"}},
                  {"x.yaml:9:56: key 'weights': there is no weight file 'v.json' in 'CWD' or "
                   "'DIR'; write its path, 'uniform', 'one_to_one' or 'blocks' [SL0108]"}},
        WrongFile{
            "weights of the wrong shape",
            {},
            {"x.yaml:9:56: key 'weights': the weights have 2 rows and 2 columns, but the ports "
             "have 2 outputs and 3 inputs; write one row an output and one column an input "
             "[SL0308]"},
            {{"w.json", "[[1, 0], [0, 1]]"}}},
        WrongFile{"weights file that is not JSON",
                  {},
                  {"x.yaml:9:56: key 'weights': w.json:1:3: not JSON: unexpected number literal; "
                   "expected end of input [SL0101]"},
                  {{"w.json", "1 0 0"}}},
        WrongFile{"inline weights of the wrong shape",
                  {{"w.json", "[[1, 0], [0, 1]]"}},
                  {"x.yaml:9:56: key 'weights': ... 2 rows and 2 columns ... 2 outputs and 3 "
                   "inputs ... [SL0308]"}},
        WrongFile{"inline weights ragged",
                  {{"w.json", "[[1, 0, 0], [0, 1]]"}},
                  {"x.yaml:9:56: key 'weights': row 1 has 2 weights, but row 0 has 3; write one "
                   "weight an input in every row [SL0309]"}},
        WrongFile{"inline weights with a word",
                  {{"w.json", "[[1, 0, x], [0, 1, 0]]"}},
                  {"x.yaml:9:56: key 'weights': row 0, column 2 is \"x\" ... [SL0309]"}},
        WrongFile{"inline weights not finite",
                  {{"w.json", "[[1, 0, .inf], [0, 1, 0]]"}},
                  {"x.yaml:9:56: key 'weights': row 0, column 2 is \".inf\" ... [SL0309]"}},
        WrongFile{
            "inline weights with an unknown key",
            {{"w.json", "{rows: 2, colums: 3, entries: []}"}},
            {"x.yaml:9:56: key 'weights': unknown key 'colums'; did you mean 'columns'? [SL0309]"}},
        WrongFile{"empty inline weights",
                  {{"w.json", "[]"}},
                  {"x.yaml:9:56: key 'weights': the table has no weights; write [[0.1, 0.2], [0.3, "
                   "0.4]] ... or 'uniform' in place of the file ... [SL0309]"}},
        WrongFile{"network file missing",
                  {{"net.yaml", "nat.yaml"}},
                  {"x.yaml:8:40: key 'network': there is no network file 'nat.yaml'; write its "
                   "path, from where this file lies [SL0108]"}},
        WrongFile{"network key missing",
                  {{", network: net.yaml", ""}},
                  {"x.yaml:8:3: node 'brain': key 'network' is missing (Network file (YAML), "
                   "or FILE.py:FUNCTION); write  network: ... [SL0104]"}},
        WrongFile{
            "network file wrong",
            {},
            {"net.yaml:1:30: population 'input': unknown model 'inptu'; did you mean 'input'? "
             "[SL0205]"},
            {{"net.yaml", "populations: {input: {model: inptu, size: 3}}\noutput: [input]\n"}}},
        WrongFile{"network in place wrong",
                  {{"net.yaml", "{populations: {r: {model: reepeater, size: 3}}, output: [r]}"}},
                  {"x.yaml:8:66: key 'network': population 'r': unknown model 'reepeater'; did you "
                   "mean 'repeater'? [SL0205]"}},
        WrongFile{"network in place with an unknown key",
                  {{"net.yaml", "{population: {r: {model: repeater, size: 3}}, output: [r]}"}},
                  {"x.yaml:8:53: key 'network': network file: unknown key 'population'; did you "
                   "mean 'populations'? [SL0103]"}},
        WrongFile{"network width against connection width",
                  {{"encoder [3] -> brain [3]", "encoder [4] -> brain [4]"}},
                  {"x.yaml:12:28: widths differ: 'encoder.out' has 4 channels, 'brain.in' has 3, "
                   "the connection says [4] [SL0306]"}},
        WrongFile{"network output width",
                  {{"brain [3] -> decoder [3]", "brain [3] -> decoder [4]"}},
                  {"x.yaml:12:41: widths differ: 'brain.out' has 3 channels, 'decoder.in' has 4, "
                   "the connection says [4] [SL0306]"}},
        WrongFile{"tick that is not a multiple of the resolution",
                  {{"tick: 1 ms", "tick: 0.25 ms"}},
                  {"net.yaml: the tick 250 us is not a whole number of the network's resolution "
                   "100 us; write a tick of 200 us or another resolution [SL0207]"}},
        WrongFile{"network without input",
                  {{"net.yaml",
                    "{populations: {n: {model: iaf_psc_exp, size: 3, parameters: {I_e: 500 pA}}}, "
                    "output: [n]}"}},
                  {"x.yaml:12:28: 'brain' has no input port; turn the connection round or leave it "
                   "out [SL0302]"}},
        WrongFile{
            "recording without file",
            {{"{node: ros_sensor, topic: /scan, message: LaserScan}", "{node: signal_playback}"}},
            {"x.yaml:6:3: node 'scan': key 'file' is missing (Recording in a run folder, e.g. "
             "run1/encoder.h5); write  file: ... [SL0104]"}},
        WrongFile{"recording that is none",
                  {{"{node: ros_sensor, topic: /scan, message: LaserScan}",
                    "{node: spike_playback, file: w.json}"}},
                  {"x.yaml:6:38: cannot read 'w.json': not an HDF5 file, or damaged [SL0109]"}},
        WrongFile{
            "unknown message type of a sensor with fields",
            {{"message: LaserScan", "message: nowhere/LaserScan, fields: [ranges]"},
             {"robot: {simulator: mujoco}", "ros: 1"}},
            {"x.yaml:6:51: unknown message type 'nowhere/LaserScan'; write one that 'spikeloop "
             "describe --messages' lists, or the path of a .msg file [SL0502]"}},
        WrongFile{"message definition missing",
                  {{"message: LaserScan", "message: my_robot/msg/Arm.msg, fields: [angle]"},
                   {"robot: {simulator: mujoco}", "ros: 1"}},
                  {"x.yaml:6:51: there is no message definition 'my_robot/msg/Arm.msg' in 'CWD' or "
                   "'DIR'; write its path [SL0502]"}},
        WrongFile{
            "message definition with a wrong line",
            {{"message: LaserScan", "message: my_robot/msg/Arm.msg, fields: [angle]"},
             {"robot: {simulator: mujoco}", "ros: 1"}},
            {"my_robot/msg/Arm.msg:2: 'angle' has a type but no name; write 'type name' [SL0503]"},
            {{"my_robot/msg/Arm.msg", "float64 angle\nangle\n"}}},
        WrongFile{"recording missing",
                  {{"{node: ros_sensor, topic: /scan, message: LaserScan}",
                    "{node: signal_playback, file: a.h5}"}},
                  {"x.yaml:6:39: key 'file': there is no recording 'a.h5' ... [SL0108]"}}),
    [](const auto& row) { return "row" + std::to_string(row.index); });

}  // namespace
}  // namespace spikeloop::test
