// Experiment files that are wrong in what a sensor takes of its messages, or a command writes.
#include "tests/experiment/wrong_file.hpp"

namespace spikeloop::test {
namespace {

class WrongSensors : public testing::TestWithParam<WrongFile> {};

TEST_P(WrongSensors, AreExplained) {
  expect_faults(GetParam());
}

/// The good file's scan with other keys, over ROS.
WrongFile sensor(const char* what, const std::string& keys, std::vector<std::string> faults) {
  return {what,
          {{"message: LaserScan", keys}, {"robot: {simulator: mujoco}", "ros: 1"}},
          std::move(faults)};
}

/// Its command.
WrongFile command(const char* what, const std::string& keys, std::vector<std::string> faults) {
  return {what,
          {{"message: Twist, fields: {linear.x: 0, angular.z: 1}", keys},
           {"robot: {simulator: mujoco}", "ros: 1"}},
          std::move(faults)};
}

INSTANTIATE_TEST_SUITE_P(
    Table, WrongSensors,
    testing::Values(
        sensor("unknown option of a field",
               "message: LaserScan, fields: [{path: \"ranges[0:3]\", scal: 2}]",
               {"x.yaml:6:99: key 'fields': entry 1: unknown key 'scal'; did you mean 'scale'? "
                "[SL0103]"}),
        sensor("option of a field as a key of the sensor", "message: LaserScan, nan: 0",
               {"... node 'scan': unknown key 'nan'; it is a key of an entry of 'fields': write  "
                "fields: [{path: ..., nan: VALUE}] [SL0103]"}),
        sensor("range and scale",
               "message: LaserScan, fields: [{path: ranges, range: [0, 1], scale: 2}]",
               {"x.yaml:6:93: key 'fields': 'range' says what 'scale' says; leave one of them "
                "out [SL0208]"}),
        sensor("wrong policy", "message: LaserScan, fields: [{path: ranges, nan: skp}]",
               {"x.yaml:6:91: key 'fields': 'nan' is 'skp'; did you mean 'skip'?; write "
                "one of: pass, hold, skip, zero, or a number [SL0205]"}),
        sensor("no such field with options",
               "message: LaserScan, fields: [{path: rangs, scale: 2}]",
               {"x.yaml:6:70: field path 'rangs' of sensor_msgs/LaserScan: sensor_msgs/LaserScan "
                "has no field 'rangs'; did you mean 'ranges'? [SL0504]"}),
        sensor("unknown key of a picture", "message: sensor_msgs/Image, image: {resiz: [3, 1]}",
               {"x.yaml:6:85: key 'image': unknown key 'resiz'; did you mean 'resize'? [SL0103]"}),
        sensor("picture of another size", "message: sensor_msgs/Image, image: {resize: [2, 2]}",
               {"x.yaml:6:77: a sensor_msgs/Image gives 4 values ... 3 channels ... [4] in its "
                "connection ... [SL0505]"}),
        sensor(
            "picture of a scan", "message: LaserScan, image: {resize: [3, 1]}",
            {"x.yaml:6:69: 'image' is for sensor_msgs/Image and sensor_msgs/CompressedImage, not "
             "for sensor_msgs/LaserScan; write 'fields' with the fields to take [SL0504]"}),
        sensor("picture that is not a map", "message: sensor_msgs/Image, image: small",
               {"x.yaml:6:77: key 'image': 'small' is not a map; write  image: {resize: [40, 30]} "
                "[SL0105]"}),
        sensor(
            "type without a rule", "message: sensor_msgs/JointState",
            {"x.yaml:6:51: message type sensor_msgs/JointState has no default fields; list them, "
             "as in  fields: [PATH, PATH] ('spikeloop describe sensor_msgs/JointState' prints the "
             "paths) [SL0504]"}),
        command("unknown type of a command", "message: sensor_msgs/JointStat, fields: {a: 0}",
                {"x.yaml:10:57: unknown message type 'sensor_msgs/JointStat'; did you mean "
                 "'sensor_msgs/JointState'? [SL0502]"}),
        command(
            "no such field of a named element",
            "message: sensor_msgs/JointState, fields: {\"positon[name=left]\": 0}",
            {"x.yaml:10:112: field path 'positon[name=left]' of sensor_msgs/JointState: "
             "sensor_msgs/JointState has no field 'positon'; did you mean 'position'? [SL0504]"}),
        command(
            "empty slice of a command",
            "message: sensor_msgs/JointState, fields: {\"position[2:2]\": 0}",
            {"x.yaml:10:89: 'fields.position[2:2]' names no elements, or more than 100000; write "
             "the first one and the one behind the last, as in data[0:3] [SL0504]"}),
        command(
            "channel of a slice that the port does not have",
            "message: sensor_msgs/JointState, fields: {\"position[0:3]\": 0}",
            {"x.yaml:10:89: 'fields.position[2]' reads channel 2 ... 2 (0 to 1) ... [SL0505]"})),
    [](const auto& row) { return "row" + std::to_string(row.index); });

}  // namespace
}  // namespace spikeloop::test
