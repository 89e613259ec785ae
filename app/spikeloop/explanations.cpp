#include "explanations.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace spikeloop::app {
namespace {

constexpr Explanation kExplanations[] = {
    {Code::syntax, "The file cannot be parsed",
     "A bracket, a quote or an indentation does not match, or the text is not YAML, JSON or a "
     ".music file at all. The place in the message is where reading stopped; the mistake may be in "
     "the line above it.",
     "encoder: {node: rate_encoder", "encoder: {node: rate_encoder}"},
    {Code::duplicate_key, "A key or an entry is written twice",
     "One of the two values would be lost. Keep one of them.",
     "encoder: {node: rate_encoder, rate_max: 200 Hz, rate_max: 100 Hz}",
     "encoder: {node: rate_encoder, rate_max: 200 Hz}"},
    {Code::unknown_key, "A key is not known",
     "Usually a misspelling. `spikeloop describe NODE` lists the keys of a node class, and "
     "`spikeloop describe --experiment` those of an experiment.",
     "encoder: {node: rate_encoder, rate_mx: 200 Hz}",
     "encoder: {node: rate_encoder, rate_max: 200 Hz}"},
    {Code::missing_key, "A required key is missing",
     "The key has no default value. The message shows an example.",
     "scan: {node: ros_sensor, message: sensor_msgs/LaserScan}",
     "scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}"},
    {Code::wrong_shape, "A list, a map or a single value is expected",
     "The key has a value of another kind than it takes.", "plugins: my_encoder.so",
     "plugins: [my_encoder.so]"},
    {Code::invalid_name, "A name has characters that it must not have",
     "Names of nodes, ports and processes are also names of files and of MUSIC's ports: letters, "
     "digits and '_'; in the name of an experiment '-' as well.",
     "experiment: my loop", "experiment: my_loop"},
    {Code::duplicate_name, "Two things have the same name",
     "Names identify the nodes of an experiment, the sections of a .music file, the node classes "
     "of "
     "plug-ins and the hosts of a hostfile. Rename one of them."},
    {Code::missing_file, "A file that a key names does not exist",
     "A relative path begins at the folder of the file that names it.",
     "readout: {node: linear_readout, weights: no.json}",
     "readout: {node: linear_readout, weights: uniform}"},
    {Code::no_access, "A file or folder cannot be read or written",
     "The message has the path and the reason of the operating system. Look at its permissions and "
     "format, at "
     "the free space of the disk, and whether another run writes there."},

    {Code::not_a_number, "A number is expected",
     "Write a number, with a unit where the key has one. Text in place of a number is not guessed.",
     "encoder: {node: rate_encoder, rate_max: fast}",
     "encoder: {node: rate_encoder, rate_max: 200 Hz}"},
    {Code::wrong_unit, "The unit is missing or of another dimension",
     "Quantities of experiments have units, so that 30 is never read as 30 s where 30 ms is meant.",
     "readout: {node: linear_readout, weights: uniform, tau: 30 mV}",
     "readout: {node: linear_readout, weights: uniform, tau: 30 ms}"},
    {Code::out_of_bounds, "A value is outside its bounds",
     "The message has the bounds. They are those within which the results are correct, or within "
     "which a run fits into memory.",
     "encoder: {node: rate_encoder, rate_max: -1 Hz}",
     "encoder: {node: rate_encoder, rate_max: 200 Hz}"},
    {Code::not_whole, "A whole number is expected", "The key takes whole numbers only.",
     "seed: 1.5", "seed: 1"},
    {Code::unknown_choice, "The value is not one of the choices",
     "The key takes one of a few words, which the message lists. Truth values are true and false.",
     "sync: realtme", "sync: realtime"},
    {Code::wrong_order, "A minimum is above its maximum",
     "Two keys, or the two numbers of a pair, are the ends of a range: the first has to be the "
     "lower one.",
     "scan: {node: ros_sensor, topic: /scan, message: LaserScan, fields: [{path: ranges, min: 4, "
     "max: 0}]}",
     "scan: {node: ros_sensor, topic: /scan, message: LaserScan, fields: [{path: ranges, min: 0, "
     "max: 4}]}"},
    {Code::off_grid, "A time is not a whole number of ticks or steps",
     "Ticks, delays and the steps of a network have to meet. The message has the nearest times "
     "that "
     "do.",
     "duration: 1.5 ms", "duration: 2 ms"},
    {Code::conflicting_keys, "Two keys exclude each other",
     "Both decide the same thing, or one needs what the other excludes. Change or remove one of "
     "them.",
     "scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan, fields: [ranges], "
     "image: {resize: [4, 3]}}",
     "scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan, fields: [ranges]}"},
    {Code::expression, "An expression cannot be computed",
     "The node class `function` takes expressions in x0, x1, ..., one for each output, "
     "separated by ';'.",
     "encoder: {node: function, function: \"min(x0\"}",
     "encoder: {node: function, function: \"min(x0, 1)\"}"},

    {Code::unknown_node, "A node that does not exist is named",
     "A connection, a layout or a network names a node or population that is not there: usually a "
     "misspelling, or a name that was changed.",
     "- scan -> encodr [100]", "- scan -> encoder [100]"},
    {Code::unknown_port, "A node has no such port",
     "`spikeloop describe NODE` lists the ports of a node class. A node with one input and one "
     "output needs no port name.",
     "- scan -> encoder.inn [100]", "- scan -> encoder.in [100]"},
    {Code::kinds_differ, "Spikes and continuous signals cannot be connected directly",
     "An encoder makes spikes of a signal, and a decoder a signal of spikes: put one between the "
     "two nodes.",
     "- scan -> readout [100]", "- scan -> encoder [100]"},
    {Code::two_senders, "Two connections lead to one input",
     "An input has one connection. Remove one of the two. In an experiment file one connection may "
     "have several senders: 'left, right -> brain' has their channels one after another, 'left + "
     "right -> brain' their sum.",
     "- scan -> wheels [2]", "- scan -> encoder [100]"},
    {Code::not_connected, "An input or output is not connected",
     "A node without its inputs computes nothing, and MUSIC waits forever for a port that is not "
     "connected.",
     "# - scan -> encoder [100]", "- scan -> encoder [100]"},
    {Code::widths_differ, "The two ends of a connection have different widths",
     "The width is the number of channels, in brackets behind the connection. A node that joins "
     "channel by channel needs the same width at both of its ports.",
     "- encoder -> readout [90]", "- encoder -> readout [100]"},
    {Code::unknown_width, "The width of a connection is not known or not valid",
     "Write the number of channels in brackets behind the connection, when no node of it has a "
     "width of its own.",
     "- readout -> wheels [two]", "- readout -> wheels [2]"},
    {Code::weights_differ, "The weights do not fit the ports",
     "A table of weights has one row for each output channel and one column for each input "
     "channel.",
     "readout: {node: linear_readout, weights: one_to_one}",
     "readout: {node: linear_readout, weights: uniform}"},
    {Code::weight_file, "A weight file cannot be used",
     "A weight file is JSON, [[0.1, 0.2], [0.3, 0.4]] with one row for each output, or sparse as "
     "{\"rows\": 2, \"columns\": 2, \"entries\": [[0, 1, 0.5]]}, or a .npy file of two "
     "dimensions. spikeloop fit writes {\"tau_s\": 0.03, \"weights\": [[0.1, 0.2]]}, which is for "
     "a "
     "readout with this tau."},
    {Code::delay, "A delay is not valid or cannot be kept",
     "A cycle of nodes needs a delay, and so do some connections between processes. "
     "docs/experiment-file.md, \"Layouts\", has the smallest delays.",
     "- scan -> encoder [100, delay soon]", "- scan -> encoder [100, delay 2 ticks]"},

    {Code::unknown_class, "A node class is not known",
     "`spikeloop describe` lists the classes. Those of a plug-in need its file, under `plugins:` "
     "or "
     "in a directory of SPIKELOOP_PLUGIN_PATH.",
     "encoder: {node: rate_encodr}", "encoder: {node: rate_encoder}"},
    {Code::plug_in, "A plug-in cannot be loaded, or has failed",
     "The message has the reason of the plug-in or of the loader. A plug-in built for another "
     "version of Spikeloop has to be built again (docs/plugins.md)."},
    {Code::unknown_simulator, "A simulator is not known",
     "The simulators are builtin, nest, neuron, brian2 and python. `spikeloop doctor` shows which "
     "of them are installed.",
     "encoder: {simulator: bultin, network: network.yaml}",
     "encoder: {simulator: builtin, network: network.yaml}"},
    {Code::script, "A script does not do what its simulator expects",
     "docs/simulators.md has a script for each simulator to begin with."},
    {Code::network, "A network file asks for what its models cannot do",
     "Inputs only receive, currents do not learn, repeaters have no membrane. docs/network-file.md "
     "has what each model can do."},

    {Code::invalid_topic, "A name or address of a topic is not valid",
     "Topics of ROS have letters, digits, '_' and '/', and no part begins with a digit.",
     "wheels: {node: ros_command, topic: \"/cmd vel\", message: geometry_msgs/Twist, fields: "
     "{linear.x: 0, angular.z: 1}}",
     "wheels: {node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, fields: "
     "{linear.x: 0, angular.z: 1}}"},
    {Code::unknown_message, "A message type is not known",
     "`spikeloop describe --messages` lists the types that Spikeloop knows. Types of your own come "
     "from the path of their .msg file (docs/messages.md).",
     "scan: {node: ros_sensor, topic: /scan, message: LaserScam}",
     "scan: {node: ros_sensor, topic: /scan, message: LaserScan}"},
    {Code::message_definition, "A .msg file is not valid",
     "The message has the line. ROS 1 and ROS 2 differ: bounds and default values are of ROS 2 "
     "alone."},
    {Code::field_path, "A message has no such field, or no default fields",
     "`spikeloop describe TYPE` prints the fields of a message. A path goes from field to field by "
     "dots, and to elements of an array by [index], [first:end] or [name=text].",
     "scan: {node: ros_sensor, topic: /scan, message: LaserScan, fields: [rangs]}",
     "scan: {node: ros_sensor, topic: /scan, message: LaserScan, fields: [ranges]}"},
    {Code::fields_differ, "Fields and channels have different numbers",
     "Each value of a message goes to one channel, and each field of a command reads one.",
     "wheels: {node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, fields: "
     "{linear.x: 0, angular.z: 5}}",
     "wheels: {node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, fields: "
     "{linear.x: 0, angular.z: 1}}"},
    {Code::topic_conflict, "Two uses of a topic exclude each other",
     "Two senders of commands would move the robot in turn, and a stop must not come on the topic "
     "of the commands. Give one of them another topic.",
     "wheels: {node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, fields: "
     "{linear.x: 0, angular.z: 1}, emergency_stop: /cmd_vel}",
     "wheels: {node: ros_command, topic: /cmd_vel, message: geometry_msgs/Twist, fields: "
     "{linear.x: 0, angular.z: 1}, emergency_stop: /emergency_stop}"},
    {Code::no_such_topic, "The robot or the bag has no such topic",
     "The message lists the topics there are. Over ROS any topic is possible: write `ros: 1` or "
     "`ros: 2`.",
     "scan: {node: ros_sensor, topic: /laser, message: sensor_msgs/LaserScan}",
     "scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}"},
    {Code::wrong_message, "A topic carries another type of message",
     "Write the type that the topic has, or the topic that is meant.",
     "scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/JointState}",
     "scan: {node: ros_sensor, topic: /scan, message: sensor_msgs/LaserScan}"},
    {Code::damaged_message, "A message cannot be read",
     "It is shorter than its type, or its sizes, encoding or times contradict each other. The "
     "program that sends it has to be corrected; the message is left out."},
    {Code::ros_setting, "A setting of ROS is not valid",
     "ROS_MASTER_URI, ROS_DOMAIN_ID and other variables of the environment, arguments behind "
     "--ros-args, or the configuration of Cyclone DDS. docs/ros2.md has those that are read."},
    {Code::image_encoding, "Images or event packets have an encoding that cannot be read",
     "docs/images.md lists those that can be read. Change the setting of the camera driver, or "
     "convert the images in a node between driver and sensor, for example with 'image_transport "
     "republish'."},

    {Code::layout, "The processes of a layout do not fit the experiment",
     "Each node is in one process, and a simulator has a process of its own. Without ROS, and with "
     "lockstep and sim_time, one process has all sensors and commands. docs/experiment-file.md, "
     "\"Layouts\", has the rules.",
     "layout: {front: [scan, encoder]}", "layout: {front: [scan, encoder, readout, wheels]}"},
    {Code::music_job, "MUSIC cannot run the .music file",
     "Ticks, process numbers, barriers or ports of its applications do not fit together, and the "
     "job would hang or lose data. The message says what to change."},
    {Code::program, "A program that a job starts cannot be started",
     "Its file is missing, is not executable, or names an interpreter that is not there. "
     "`scripts/build` builds a missing program of Spikeloop; `spikeloop doctor` lists the missing "
     "ones."},

    {Code::resource, "This machine has too little of a resource for the run",
     "Shared memory, open files, address space or participants of a ROS 2 domain. Programs would "
     "crash or hang during the run. The message names the requirement and the remedy; `spikeloop "
     "doctor` lists all resources."},

    {Code::no_ros_master, "No ROS master answers",
     "Start one by roscore, or set ROS_MASTER_URI to the address of one that runs."},
    {Code::partner_missing, "A robot or simulator is missing",
     "A run in lockstep waits for its robot. Start it, and compare the topics of both sides."},
    {Code::partner_failed, "A program of the run has ended or does not answer",
     "The message has its last words. The robot was stopped."},
    {Code::node_failed, "A node has failed while it ran",
     "The message has the node and the reason. The robot was stopped; the recordings end with the "
     "last tick."},

    {Code::world, "The world file does not describe a world",
     "A world is a file in MuJoCo's format, MJCF, with a vehicle and a few named parts "
     "(docs/robot.md)."},
};

}  // namespace

std::span<const Explanation> explanations() {
  return kExplanations;
}

const Explanation* find_explanation(std::string text) {
  std::erase_if(text, [](unsigned char c) { return std::isalnum(c) == 0; });  // "[SL0103]"
  if (text.size() > 2 && std::toupper(text[0]) == 'S' && std::toupper(text[1]) == 'L') {
    text.erase(0, 2);
  }
  const bool digits =
      !text.empty() && text.size() <= 4 &&
      std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c) != 0; });
  const auto* const found =
      std::ranges::find(kExplanations, digits ? std::atoi(text.c_str()) : 0,
                        [](const Explanation& each) { return static_cast<int>(each.code); });
  return found == std::end(kExplanations) ? nullptr : found;
}

}  // namespace spikeloop::app
