// Experiment files whose simulators are wrong, and every word that is said about them.
#include "tests/experiment/wrong_file.hpp"

namespace spikeloop::test {
namespace {

constexpr const char* kBuiltin = "{simulator: builtin, network: net.yaml}";
constexpr const char* kBrain = "{simulator: python, script: brain.py}";
constexpr const char* kScript = "import spikeloop\n";

class WrongSimulators : public testing::TestWithParam<WrongFile> {};

TEST_P(WrongSimulators, AreExplained) {
  expect_faults(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Table, WrongSimulators,
    testing::Values(
        WrongFile{"nothing", {{kBuiltin, kBrain}}, {}, {{"brain.py", kScript}}},
        WrongFile{"no script",
                  {{kBuiltin, "{simulator: nest}"}},
                  {"x.yaml:8:3: node 'brain': key 'script' is missing (Python file; other keys "
                   "are its parameters); write  script: ... [SL0104]"}},
        WrongFile{"script that is not there",
                  {{kBuiltin, kBrain}},
                  {"x.yaml:8:38: key 'script': there is no script 'brain.py' ... [SL0108]"}},
        WrongFile{"script that Windows wrote",
                  {{kBuiltin, kBrain}},
                  {},
                  {{"brain.py", "\xEF\xBB\xBFimport spikeloop\r\nimport numpy\r\n"}}},
        WrongFile{"lines that Windows ended",
                  {{kBuiltin, kBrain}},
                  {},
                  {{"brain.py", "import numpy\r\nimport numpy, spikeloop\r\n"}}},
        // Not even the superuser reads what lies at its begin.
        WrongFile{
            "script that cannot be read",
            {{kBuiltin, "{simulator: python, script: /proc/self/mem}"}},
            {"x.yaml:8:38: key 'script': cannot read '/proc/self/mem': Input/output error; write "
             "the path of a file that you can read, or let yourself read it (chmod u+r) [SL0404]"}},
        WrongFile{"script that takes no part",
                  {{kBuiltin, "{simulator: brian2, script: brain.py}"}},
                  {"x.yaml:8:38: key 'script': 'brain.py' does not take part in an experiment; "
                   "write  import spikeloop.brian  into it (docs/simulators.md) [SL0404]"},
                  {{"brain.py", "import brian2\n"}}},
        WrongFile{"NEST's script",
                  {{kBuiltin, kBrain}},
                  {"x.yaml:8:38: key 'script': 'brain.py' imports spikeloop.nest, whose times are "
                   "rounded; write  simulator: nest [SL0404]"},
                  {{"brain.py", "import spikeloop.nest\n"}}},
        WrongFile{
            "parameter with the name of a key of all programs",
            {{kBuiltin, "{simulator: python, script: brain.py, seed: 3, wd: x}"}},
            {"x.yaml:8:48: node 'brain': 'seed' is the name of a key of every program, and no "
             "parameter of a script; give it another name [SL0106]",
             "x.yaml:8:57: node 'brain': 'wd' ... [SL0106]"},
            {{"brain.py", kScript}}},
        WrongFile{"processes",
                  {{kBuiltin, "{simulator: brian2, script: brain.py, np: 2}"}},
                  {"x.yaml:8:52: key 'np': 2 processes are for NEURON's ParallelContext; a script "
                   "with simulator: brian2 has one: ... [SL0203]"},
                  {{"brain.py", kScript}}},
        WrongFile{"class of a simulator",
                  {{kBuiltin, "{node: neuron, script: brain.py}"}},
                  {"x.yaml:8:17: unknown node class 'neuron'; known: argmax, clip, connect, delay, "
                   "discretize, disturb_signal, disturb_spikes, function, linear_readout, "
                   "low_pass, nef_encoder, network, "
                   "normalise, poisson_encoder, population_encoder, population_vector, "
                   "rate_encoder, rate_window, ros_command, ros_event_sensor, ros_sensor, sigmoid, "
                   "signal_playback, spike_playback, step_forward_encoder, "
                   "temporal_contrast_encoder, threshold, "
                   "time_to_first_spike_encoder, winner_take_all [SL0401]"},
                  {{"brain.py", kScript}}},
        WrongFile{"port in both directions",
                  {{kBuiltin, kBrain},
                   {"brain [3] -> decoder [3]", "brain.x [3]\n  - brain.x -> decoder [3]"}},
                  {"x.yaml:13:5: 'brain.x' is an input here and an output there, and MUSIC has one "
                   "port of a name; give the script's two ports two names [SL0404]"},
                  {{"brain.py", kScript}}},
        WrongFile{
            "simulator connected to itself",
            {{kBuiltin, kBrain}, {"-> wheels [2]", "-> wheels [2]\n  - brain -> brain.back [3]"}},
            {"x.yaml:13:14: 'brain.out' is connected to 'brain.back' of the same script; "
             "connect its cells within the script, or put another node between its ports [SL0404]"},
            {{"brain.py", kScript}}},
        WrongFile{"output of two kinds",
                  {{kBuiltin, kBrain},
                   {"-> wheels [2]", "-> wheels [2]\n  - brain.out -> other"},
                   {"  decoder:", "  other: {node: sigmoid}\n  decoder:"}},
                  {"x.yaml:14:18: spike output 'brain.out' cannot drive continuous input "
                   "'other.in'; put a decoder between them [SL0303]"},
                  {{"brain.py", kScript}}},
        WrongFile{
            "width that nobody says",
            {{kBuiltin, kBrain},
             {"encoder [3] -> brain [3] -> decoder [3]",
              "encoder -> "
              "brain -> decoder"},
             {"weights: w.json", "tau: 30 ms"},
             {"tau: 30 ms, ", ""}},
            {"x.yaml:12:13: ... 'scan.out' -> 'encoder.in' is unknown ... [10] ... [SL0307]",
             "x.yaml:12:24: ... 'encoder.out' -> 'brain.in' is unknown ... [10] ... [SL0307]",
             "x.yaml:12:33: ... 'brain.out' -> 'decoder.in' is unknown ... [10] ... [SL0307]"},
            {{"brain.py", kScript}}},
        WrongFile{"simulator that is not connected",
                  {{"  decoder:", "  cells: {simulator: python, script: brain.py}\n  decoder:"}},
                  {"x.yaml:9:3: node 'cells' ... 'connections' ... [SL0305]"},
                  {{"brain.py", kScript}}}),
    [](const auto& row) { return "row" + std::to_string(row.index); });

}  // namespace
}  // namespace spikeloop::test
