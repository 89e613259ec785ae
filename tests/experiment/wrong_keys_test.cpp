// Experiment files that are wrong, and every word that is said about them. Keys and their values.
#include "tests/experiment/wrong_file.hpp"

namespace spikeloop::test {
namespace {

class WrongKeys : public testing::TestWithParam<WrongFile> {};

TEST_P(WrongKeys, AreExplained) {
  expect_faults(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Table, WrongKeys,
    testing::Values(
        WrongFile{
            "unknown top key",
            {{"duration", "durations"}},
            {"x.yaml:2:1: experiment: unknown key 'durations'; did you mean 'duration'? [SL0103]"}},
        WrongFile{
            "two unknown keys",
            {{"duration", "durations"}, {"tick", "tack"}},
            {"x.yaml:2:1: experiment: unknown key 'durations'; did you mean 'duration'? [SL0103]",
             "x.yaml:3:1: experiment: unknown key 'tack'; did you mean 'tick'? [SL0103]"}},
        WrongFile{"record is no word of its own",
                  {{"rate_max: 200 Hz", "record: never"}},
                  {"x.yaml:7:41: key 'record': 'never' is not a truth value; write true or false "
                   "[SL0205]"}},
        WrongFile{"top key twice",
                  {{"tick: 1 ms", "tick: 1 ms\ntick: 2 ms"}},
                  {"x.yaml:4:1: experiment: duplicate key 'tick'; the first "
                   "is at x.yaml:3:1 [SL0102]"}},
        WrongFile{"key without value",
                  {{"tick: 1 ms", "tick:"}},
                  {"x.yaml:3:1: experiment: key 'tick' has no value; write one value behind it, or "
                   "leave the key out [SL0105]"}},
        WrongFile{"key that is a list",
                  {{"tick: 1 ms", "tick: [1 ms]"}},
                  {"x.yaml:3:7: experiment: key 'tick' has a list ... [SL0105]"}},
        WrongFile{"no nodes",
                  {{"", "connections: [a -> b]\n"}},
                  {"x.yaml:1:1: experiment: key 'nodes' is missing; write  nodes: {encoder: {node: "
                   "rate_encoder}} [SL0104]"}},
        WrongFile{"empty nodes",
                  {{"", "nodes:\nconnections: [a -> b]\n"}},
                  {"x.yaml:1:1: key 'nodes': there are no nodes; write  nodes: {encoder: {node: "
                   "rate_encoder}} [SL0105]"}},
        WrongFile{"nodes as a list",
                  {{"", "nodes: [scan, encoder]\nconnections: [scan -> encoder]\n"}},
                  {"x.yaml:1:1: key 'nodes': expected a map of nodes; write  nodes: {encoder: "
                   "{node: rate_encoder}} [SL0105]"}},
        WrongFile{
            "no connections",
            {{"connections:\n  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
              ""}},
            {"x.yaml:1:1: experiment: key 'connections' is missing; write  connections: [\"scan -> "
             "encoder [100] -> brain [100]\"] [SL0104]"}},
        WrongFile{"empty connections",
                  {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n", ""}},
                  {"x.yaml:11:1: key 'connections': there are no connections; write lines of  - "
                   "scan -> encoder [100] -> brain [SL0105]"}},
        WrongFile{
            "connections as a text",
            {{"connections:\n  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
              "connections: scan -> encoder\n"}},
            {"x.yaml:11:1: key 'connections': expected a list; write lines of  - scan -> encoder "
             "[100] -> brain [SL0105]"}},
        WrongFile{"node twice",
                  {{"  encoder: {node: rate_encoder, rate_max: 200 Hz}\n",
                    "  encoder: {node: rate_encoder, rate_max: 200 Hz}\n  encoder: {node: "
                    "poisson_encoder}\n"}},
                  {"x.yaml:8:3: key 'nodes': duplicate key 'encoder' ... x.yaml:7:3 ... [SL0102]"}},
        WrongFile{"node without keys",
                  {{"{node: rate_encoder, rate_max: 200 Hz}", "rate_encoder"}},
                  {"x.yaml:7:3: node 'encoder' has no keys; write  encoder: {node: rate_encoder} "
                   "[SL0104]"}},
        WrongFile{"node without class",
                  {{"node: rate_encoder, ", ""}},
                  {"x.yaml:7:3: node 'encoder' says neither 'node' nor 'simulator'; write  node: "
                   "rate_encoder, or  simulator: builtin [SL0104]"}},
        WrongFile{"both node and simulator",
                  {{"simulator: builtin", "simulator: builtin, node: network"}},
                  {"x.yaml:8:3: node 'brain' says both 'node' and 'simulator'; write  node: "
                   "rate_encoder, or  simulator: builtin [SL0208]"}},
        WrongFile{"unknown class",
                  {{"rate_encoder", "rate_encodr"}},
                  {"x.yaml:7:19: unknown node class 'rate_encodr'; did you mean 'rate_encoder'? "
                   "[SL0401]"}},
        WrongFile{"unknown simulator",
                  {{"simulator: builtin", "simulator: nueron"}},
                  {"x.yaml:8:22: node 'brain': simulator 'nueron' is unknown; did you mean "
                   "'neuron'? [SL0403]"}},
        WrongFile{"simulator nobody has",
                  {{"simulator: builtin", "simulator: spice"}},
                  {"x.yaml:8:22: node 'brain': simulator 'spice' is unknown; known: builtin, nest, "
                   "neuron, brian2, python [SL0403]"}},
        WrongFile{"node without a name",
                  {{"nodes:\n", "nodes:\n  : {node: sigmoid}\n  \"\": {node: sigmoid}\n"}},
                  {"x.yaml:6:3: key 'nodes': nothing stands where a name has to; write  name: "
                   "value [SL0105]",
                   "x.yaml:7:3: key 'nodes': ... name: value ... [SL0105]"}},
        WrongFile{"list in place of a name",
                  {{"nodes:\n", "nodes:\n  [a]: {node: sigmoid}\n"}},
                  {"x.yaml:6:3: key 'nodes': ... name: value ... [SL0105]"}},
        WrongFile{"bad node name",
                  {{"  encoder:", "  my-encoder:"}},
                  {"x.yaml:7:3: 'my-encoder' is not a valid node name; write letters, digits and "
                   "'_' [SL0106]"}},
        WrongFile{
            "key twice in a node",
            {{"rate_max: 200 Hz", "rate_max: 200 Hz, rate_max: 100 Hz"}},
            {"x.yaml:7:51: node 'encoder': duplicate key 'rate_max' ... x.yaml:7:33 ... [SL0102]"}},
        WrongFile{"unknown key",
                  {{"rate_max", "rate_mix"}},
                  {"x.yaml:7:33: node 'encoder': unknown key 'rate_mix'; did you mean 'rate_min'? "
                   "[SL0103]"}},
        WrongFile{"missing required key",
                  {{"topic: /scan, ", ""}},
                  {"x.yaml:6:3: node 'scan': key 'topic' is missing; write for example  topic: "
                   "/scan [SL0104]"}},
        WrongFile{
            "misspelt required key",
            {{"topic: /scan", "tpoic: /scan"}},
            {"x.yaml:6:28: node 'scan': unknown key 'tpoic'; did you mean 'topic'? [SL0103]"}},
        WrongFile{"required key without value",
                  {{"topic: /scan", "topic: "}},
                  {"x.yaml:6:28: node 'scan': key 'topic' ... [SL0105]"}},
        WrongFile{"wrong unit",
                  {{"200 Hz", "200 mV"}},
                  {"x.yaml:7:43: key 'rate_max': '200 mV': 'mV' ... Hz, kHz, MHz ... [SL0202]"}},
        WrongFile{"missing unit",
                  {{"200 Hz", "200"}},
                  {"x.yaml:7:43: node 'encoder': key 'rate_max': 200 has no unit; write for "
                   "example  rate_max: 200 Hz [SL0202]"}},
        WrongFile{"missing unit of the tick",
                  {{"tick: 1 ms", "tick: 0.001"}},
                  {"x.yaml:3:7: experiment: key 'tick': 0.001 has no unit; write for example  "
                   "tick: 0.001 s [SL0202]"}},
        WrongFile{"a word as a number",
                  {{"200 Hz", "fast"}},
                  {"x.yaml:7:43: key 'rate_max': 'fast' is not a number; write for example 0.5 Hz "
                   "[SL0201]"}},
        WrongFile{"out of bounds",
                  {{"200 Hz", "-3 Hz"}},
                  {"x.yaml:7:43: key 'rate_max': -3 is out of bounds; write a value from 0 to "
                   "1000000 Hz [SL0203]"}},
        WrongFile{"not finite",
                  {{"200 Hz", ".inf Hz"}},
                  {"x.yaml:7:43: key 'rate_max': '.inf Hz' ... 0.5 Hz ... [SL0201]"}},
        WrongFile{"not finite, in words",
                  {{"200 Hz", "nan Hz"}},
                  {"x.yaml:7:43: key 'rate_max': 'nan Hz' is not a finite number; write for "
                   "example 0.5 Hz [SL0201]"}},
        WrongFile{"a list as a number",
                  {{"200 Hz", "[200 Hz]"}},
                  {"x.yaml:7:43: key 'rate_max': '[\"200 Hz\"]' ... 0.5 Hz ... [SL0201]"}},
        WrongFile{"tick of zero",
                  {{"tick: 1 ms", "tick: 0 ms"}},
                  {"x.yaml:3:7: key 'tick': 0 ... 1e-09 to 1000 s ... [SL0203]"}},
        WrongFile{"tick below a nanosecond",
                  {{"tick: 1 ms", "tick: 1.5 ns"}},
                  {"x.yaml:3:7: a tick of 1.5e-09 s ... 0 ... 2e-09 s ... [SL0207]"}},
        WrongFile{"negative duration",
                  {{"1 s", "-1 s"}},
                  {"x.yaml:2:11: key 'duration': -1 ... 0 to 9000000000 s ... [SL0203]"}},
        WrongFile{"duration of nothing",
                  {{"1 s", "0 s"}},
                  {"x.yaml:2:11: key 'duration': a run of 0 s does nothing; write for example 1 "
                   "ms, or leave it out: then the run goes on until it is stopped [SL0203]"}},
        WrongFile{"duration below a tick",
                  {{"1 s", "0.3 ms"}},
                  {"x.yaml:2:11: key 'duration': 300 us ... 1 ms ... 1 ms ... [SL0207]"}},
        WrongFile{"duration between two ticks",
                  {{"1 s", "1 s"}, {"tick: 1 ms", "tick: 7 ms"}},
                  {"x.yaml:2:11: key 'duration': 1 s ... 7 ms ... 994 ms or 1.001 s ... [SL0207]"}},
        WrongFile{"seed that is not a number",
                  {{"tick: 1 ms", "seed: one"}},
                  {"x.yaml:3:7: key 'seed': 'one' ... write a whole number from 0 to "
                   "9223372036854775807 ... [SL0204]"}},
        WrongFile{"negative seed",
                  {{"tick: 1 ms", "seed: -1"}},
                  {"x.yaml:3:7: key 'seed': -1 ... 0 to 9223372036854775807 ... [SL0203]"}},
        WrongFile{"seed that no integer holds",
                  {{"tick: 1 ms", "seed: 99999999999999999999"}},
                  {"x.yaml:3:7: key 'seed': 99999999999999999999 ... 0 to 9223372036854775807 ... "
                   "[SL0203]"}},
        WrongFile{"wrong choice of sync",
                  {{"tick: 1 ms", "sync: lockstp"}},
                  {"x.yaml:3:7: key 'sync': 'lockstp' is not a choice; did you mean 'lockstep'?; "
                   "write one of: realtime, unpaced, lockstep, sim_time [SL0205]"}},
        WrongFile{"sync without meaning",
                  {{"tick: 1 ms", "sync: fast"}},
                  {"x.yaml:3:7: key 'sync': 'fast' ... realtime, unpaced, lockstep, sim_time ... "
                   "[SL0205]"}},
        WrongFile{"a name that is a path",
                  {{"experiment: table", "experiment: ../table"}},
                  {"x.yaml:1:13: key 'experiment': '../table' is not a valid experiment name; "
                   "write up to 100 letters, digits, '_' and '-' [SL0106]"}},
        WrongFile{"two senders to one topic",
                  {{"connections:",
                    "  more: {node: ros_command, topic: /cmd_vel, message: Twist, "
                    "fields: {linear.x: 0}}\nconnections:\n  - decoder -> more [2]"}},
                  {"x.yaml:11:36: key 'topic': 'wheels' and 'more' both send to /cmd_vel, and the "
                   "robot would obey both in turn; write one node with all fields, or another "
                   "topic [SL0506]"}},
        WrongFile{
            "sim_time",
            {{"tick: 1 ms", "sync: sim_time"}},
            {"x.yaml:3:7: key 'sync': sim_time follows the topic /clock, and there is no "
             "ROS; write  ros: 2,  or  sync: lockstep  for the robot in this process [SL0208]"}},
        WrongFile{"lockstep without robot",
                  {{"tick: 1 ms", "sync: lockstep"}, {"robot: {simulator: mujoco}\n", ""}},
                  {"x.yaml:3:7: key 'sync': lockstep has no robot to step; write  robot: "
                   "{simulator: mujoco},  ros: 2  for a robot that can be stepped "
                   "(docs/stepping.md), or  sync: unpaced [SL0208]",
                   "x.yaml:5:3: node 'scan': no robot provides topic /scan; write  "
                   "ros: 2, or  robot: {simulator: mujoco} [SL0507]",
                   "x.yaml:9:3: node 'wheels': ... /cmd_vel ... ros: 2, or  robot: {simulator: "
                   "mujoco} ... [SL0507]"}},
        WrongFile{
            "robot that is not a map",
            {{"{simulator: mujoco}", "mujoco"}},
            {"x.yaml:4:8: key 'robot': expected a map; write  robot: {simulator: mujoco, "
             "world: arena.xml}, or  robot: {bag: FILE}, or leave it out if the robot is reached "
             "over ROS [SL0105]"}},
        WrongFile{"unknown robot key",
                  {{"mujoco}", "mujoco, wrld: a.xml}"}},
                  {"x.yaml:4:28: robot: unknown key 'wrld'; did you mean 'world'? [SL0103]"}},
        WrongFile{"unknown robot simulator",
                  {{"mujoco}", "gazebo}"}},
                  {"x.yaml:4:20: key 'simulator': 'gazebo' ... mujoco ... [SL0205]"}},
        WrongFile{"robot without simulator",
                  {{"{simulator: mujoco}", "{world: arena.xml}"}},
                  {"x.yaml:4:1: robot: key 'simulator' is missing; write for example  "
                   "simulator: mujoco [SL0104]"}},
        WrongFile{"plugins that are no list",
                  {{"tick: 1 ms", "plugins: x.so"}},
                  {"x.yaml:3:10: key 'plugins': expected a list of files; write  plugins: "
                   "[my_encoder.so] [SL0105]"}},
        WrongFile{"several faults of a node",
                  {{"rate_max: 200 Hz", "rate_max: 200, rate_min: 1 mV, sede: 3"}},
                  {"x.yaml:7:43: node 'encoder': key 'rate_max': 200 has no unit; write for "
                   "example  rate_max: 200 Hz [SL0202]",
                   "x.yaml:7:58: key 'rate_min': '1 mV': 'mV' ... Hz, kHz, MHz ... [SL0202]",
                   "x.yaml:7:64: node 'encoder': unknown key 'sede'; known: rate_min, rate_max, "
                   "initial, out_of_range, not_finite, initial_phase [SL0103]"}},
        WrongFile{"faults of several nodes",
                  {{"200 Hz", "200"}, {"30 ms", "30"}, {"tick: 1 ms", "tick: fast"}},
                  {"x.yaml:3:7: key 'tick': 'fast' ... 0.5 s ... [SL0201]",
                   "x.yaml:7:43: node 'encoder': key 'rate_max': 200 has no unit; write for "
                   "example  rate_max: 200 Hz [SL0202]",
                   "x.yaml:9:40: node 'decoder': key 'tau': 30 has no unit; write for example  "
                   "tau: 30 ms [SL0202]"}}),
    [](const auto& row) { return "row" + std::to_string(row.index); });

}  // namespace
}  // namespace spikeloop::test
