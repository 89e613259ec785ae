// Every message about sources, currents, outputs and learning in a network file.
#include "network_case.hpp"

namespace spikeloop::test {
namespace {

class NetworkFault : public testing::TestWithParam<NetworkCase> {};

TEST_P(NetworkFault, SaysWhatWhereAndWhatToWrite) {
  expect_its_message(GetParam());
}

// Line 7 is what follows.
constexpr const char* kPopulations =
    "populations:\n"
    "  input: {model: input, size: 2}\n"
    "  cell: {model: iaf_psc_exp, size: 2}\n"
    "  drive: {model: signal_input, size: 1}\n"
    "  wave: {model: sine_current, size: 1, parameters: {amplitude: 1, frequency: 1}}\n"
    "  relay: {model: repeater, size: 2}\n";

std::string alone(const std::string& population) {
  return "populations:\n  a: " + population + "\noutput: [a]\n";
}

std::string connected(const std::string& connection) {
  return std::string(kPopulations) + "connections:\n  - {" + connection + "}\noutput: [cell]\n";
}

std::string learning(const std::string& plasticity,
                     const std::string& connection =
                         "from: input, to: cell, rule: all_to_all, weight: 20, delay: 1") {
  return connected(connection + ", plasticity: {" + plasticity + "}");
}

INSTANTIATE_TEST_SUITE_P(
    File, NetworkFault,
    testing::Values(
        NetworkCase{
            "rate_missing", alone("{model: poisson, size: 1}"),
            "net.yaml:2:6: population 'a': key 'parameters' is missing; write  parameters: {rate: "
            "10 Hz} [SL0104]"},
        NetworkCase{"rate_unknown_key", alone("{model: poisson, size: 1, parameters: {rates: 5}}"),
                    "net.yaml:2:45: population 'a': parameters: unknown key 'rates'; did you mean "
                    "'rate'? [SL0103]"},
        NetworkCase{
            "rate_negative", alone("{model: poisson, size: 1, parameters: {rate: -1}}"),
            "net.yaml:2:51: population 'a': parameters: rate -1 Hz is not from 0 to 1000000 Hz; "
            "write for example  rate: 10 Hz [SL0203]"},
        NetworkCase{"rate_unit", alone("{model: poisson, size: 1, parameters: {rate: 3 ms}}"),
                    "net.yaml:2:51: population 'a': parameters: key 'rate': '3 ms': 'ms' ... Hz, "
                    "kHz, MHz ... [SL0202]"},
        NetworkCase{"steps_entry",
                    alone("{model: poisson, size: 1, parameters: {rate: [[0, 1], 5]}}"),
                    "net.yaml:2:60: population 'a': parameters: rate: an entry is not a time with "
                    "its value; write  rate: [[0 ms, 10 Hz], [100 ms, 20 Hz]] [SL0105]"},
        NetworkCase{"steps_value", alone("{model: poisson, size: 1, parameters: {rate: [[0, x]]}}"),
                    "net.yaml:2:56: population 'a': parameters: rate: 'x' ... 0.5 Hz ... [SL0201]"},
        NetworkCase{
            "steps_list", alone("{model: poisson, size: 1, parameters: {rate: [[0, [1]]]}}"),
            "net.yaml:2:56: population 'a': parameters: rate: expected one value; write  rate: "
            "[[0 ms, 10 Hz], [100 ms, 20 Hz]]"},
        NetworkCase{"steps_time", alone("{model: poisson, size: 1, parameters: {rate: [[-1, 5]]}}"),
                    "net.yaml:2:52: population 'a': parameters: rate: the time -1 ms is not a "
                    "whole number of nanoseconds from 0 to 1e9 ms; write  rate: [[0 ms, 10 Hz], "
                    "[100 ms, 20 Hz]] [SL0207]"},
        NetworkCase{"steps_grid",
                    alone("{model: poisson, size: 1, parameters: {rate: [[0.15 ms, 5]]}}"),
                    "net.yaml:2:52: population 'a': parameters: rate: the time 150 us ... 100 us "
                    "... 100 us or 200 us ... [SL0207]"},
        NetworkCase{
            "steps_order",
            alone("{model: poisson, size: 1, parameters: {rate: [[2 ms, 5], [1 ms, 6]]}}"),
            "net.yaml:2:63: population 'a': parameters: rate: 1 ms does not come after 2 ms; "
            "write the times in their order [SL0206]"},
        NetworkCase{
            "steps_empty", alone("{model: step_current, size: 1, parameters: {values: []}}"),
            "net.yaml:2:58: population 'a': parameters: values is empty; write  values: [[0 ms, "
            "10 pA], [100 ms, 20 pA]] [SL0405]"},
        NetworkCase{"values_missing", alone("{model: step_current, size: 1}"),
                    "net.yaml:2:6: population 'a': key 'parameters' is missing; write  parameters: "
                    "{values: 100 pA} [SL0104]"},
        NetworkCase{"sine_missing", alone("{model: sine_current, size: 1}"),
                    "net.yaml:2:6: population 'a': key 'parameters' is missing; write  parameters: "
                    "{amplitude: 100 pA, frequency: 10 Hz} [SL0104]"},
        NetworkCase{"noise_grid",
                    alone("{model: noise_current, size: 1, parameters: {std: 1, dt: 0.25}}"),
                    "net.yaml:2:63: population 'a': dt 250 us ... 100 us ... 200 us or 300 us ... "
                    "[SL0207]"},
        NetworkCase{
            "signal_parameters", alone("{model: signal_input, size: 1, parameters: {a: 1}}"),
            "net.yaml:2:49: population 'a': model signal_input has no parameters; leave the key "
            "'parameters' out [SL0405]"},
        NetworkCase{
            "current_off",
            "resolution: off\npopulations:\n  a: {model: sine_current, size: 1, parameters: "
            "{amplitude: 1, frequency: 1}}\noutput: [a]\n",
            "net.yaml:3:14: population 'a': model sine_current ... resolution: 0.1 ms ... "
            "[SL0207]"},
        NetworkCase{
            "learning_off",
            "resolution: off\npopulations:\n  a: {model: iaf_psc_delta, size: 1}\nconnections:\n  "
            "- {from: a, to: a, rule: one_to_one, weight: 1, delay: 1, plasticity: {rule: "
            "stdp}}\noutput: [a]\n",
            "net.yaml:5:73: connection 1: plasticity: learning is computed on a grid, but the "
            "resolution is off; write  resolution: 0.1 ms [SL0207]"},
        NetworkCase{"output_current", kPopulations + std::string("output: [wave]\n"),
                    "net.yaml:7:10: key 'output': 'wave' is a sine_current, which has no spikes; "
                    "write a population of neurons, repeaters or a poisson [SL0405]"},
        NetworkCase{"potential_repeater", kPopulations + std::string("potential: [relay]\n"),
                    "net.yaml:7:13: key 'potential': 'relay' is a repeater, which has no membrane "
                    "potential; write a population of model iaf_psc_delta or iaf_psc_exp [SL0405]"},
        NetworkCase{"potential_no_list", kPopulations + std::string("potential: cell\n"),
                    "net.yaml:7:12: key 'potential': ... potential: [name] ... [SL0105]"},
        NetworkCase{"to_source", connected("from: input, to: drive, rule: all_to_all, delay: 1"),
                    "net.yaml:8:23: connection 1: 'drive' is a signal_input, nothing can be "
                    "connected to it ... [SL0405]"},
        NetworkCase{"current_to_repeater", connected("from: wave, to: relay, rule: all_to_all"),
                    "net.yaml:8:22: connection 1: 'relay' is a repeater, which takes no current; "
                    "write a population of model iaf_psc_delta or iaf_psc_exp [SL0405]"},
        NetworkCase{"current_delay",
                    connected("from: wave, to: cell, rule: all_to_all, delay: 1 ms"),
                    "net.yaml:8:53: connection 1: the current of 'wave' acts at once; leave the "
                    "delay out [SL0310]"},
        NetworkCase{
            "signal_weight", connected("from: drive, to: cell, rule: all_to_all"),
            "net.yaml:8:5: connection 1: key 'weight' is missing; write  weight: 100 pA [SL0104]"},
        NetworkCase{"record_unknown",
                    kPopulations + std::string("record: {cells: {spikes: true}}\n"),
                    "net.yaml:7:10: key 'record': unknown population 'cells'; did you mean 'cell'? "
                    "[SL0301]"},
        NetworkCase{
            "record_nothing", kPopulations + std::string("record: {cell: {spikes: false}}\n"),
            "net.yaml:7:16: record of 'cell' has nothing to record; write  spikes: true  or  V_m: "
            "all [SL0405]"},
        NetworkCase{"record_spikes", kPopulations + std::string("record: {cell: {spikes: 3}}\n"),
                    "net.yaml:7:25: record of 'cell': spikes '3' is neither true nor false; write "
                    "one of them [SL0205]"},
        NetworkCase{"record_spikes_of_current",
                    kPopulations + std::string("record: {wave: {spikes: true}}\n"),
                    "net.yaml:7:25: key 'record': 'wave' is a sine_current ... [SL0405]"},
        NetworkCase{"record_spikes_of_input",
                    kPopulations + std::string("record: {input: {spikes: true}}\n"),
                    "net.yaml:7:26: key 'record': 'input' ... repeater's name ... [SL0405]"},
        NetworkCase{"record_potential", kPopulations + std::string("record: {relay: {V_m: all}}\n"),
                    "net.yaml:7:23: key 'record': 'relay' is a repeater ... iaf_psc_delta or "
                    "iaf_psc_exp ... [SL0405]"},
        NetworkCase{"record_members", kPopulations + std::string("record: {cell: {V_m: 0}}\n"),
                    "net.yaml:7:22: record of 'cell': V_m is not a list of members; write  V_m: "
                    "all  or  V_m: [0] [SL0105]"},
        NetworkCase{"record_member", kPopulations + std::string("record: {cell: {V_m: [0, 2]}}\n"),
                    "net.yaml:7:26: record of 'cell': V_m: '2' ... 'cell' ... 0 to 1 ... [SL0405]"},
        NetworkCase{"record_interval",
                    kPopulations + std::string("record: {cell: {spikes: true, interval: 1 ms}}\n"),
                    "net.yaml:7:41: record of 'cell': 'interval' is that of V_m, which is not "
                    "there; write  V_m: all, too [SL0405]"},
        NetworkCase{
            "record_name",
            "populations:\n  a-b: {model: repeater, size: 1}\nrecord: {a-b: {spikes: true}}\n",
            "net.yaml:3:10: key 'record': 'a-b' names ports, so it is made of letters, digits and "
            "'_'; give the population another name [SL0106]"},
        NetworkCase{"rule_missing", learning("tau_plus: 20"),
                    "net.yaml:8:81: connection 1: plasticity: key 'rule' is missing; write  rule: "
                    "stdp [SL0104]"},
        NetworkCase{"rule_unknown", learning("rule: stpd"),
                    "net.yaml:8:88: connection 1: plasticity: unknown rule 'stpd'; did you mean "
                    "'stdp'? [SL0205]"},
        NetworkCase{"key_unknown", learning("rule: stdp, A_plus: 1"),
                    "net.yaml:8:102: unknown key 'A_plus'; did you mean 'tau_plus'? [SL0103]"},
        NetworkCase{"bound", learning("rule: stdp, tau_plus: 0"),
                    "net.yaml:8:104: key 'tau_plus': 0 ... 0.001 ms ... [SL0203]"},
        NetworkCase{"pairing", learning("rule: stdp, pairing: nearby"),
                    "net.yaml:8:103: connection 1: plasticity: unknown pairing 'nearby'; known: "
                    "all_to_all, nearest [SL0205]"},
        NetworkCase{
            "wmax_zero", learning("rule: stdp, Wmax: 0"),
            "net.yaml:8:100: connection 1: plasticity: Wmax 0 leaves weights no room; write  "
            "Wmax: 100 pA [SL0206]"},
        NetworkCase{
            "bounds_order", learning("rule: stdp_dopamine, reward: input, Wmin: 5, Wmax: 4"),
            "net.yaml:8:133: connection 1: plasticity: Wmin 5 pA is not below Wmax 4 pA; write a "
            "Wmin below Wmax [SL0206]"},
        NetworkCase{
            "weight_outside", learning("rule: stdp, Wmax: 10"),
            "net.yaml:8:5: connection 1: plasticity: the weight 20 pA is not from 0 to 10 pA; "
            "write a weight in these bounds, or other bounds [SL0203]"},
        NetworkCase{"weight_sign", learning("rule: stdp, Wmax: -100"),
                    "net.yaml:8:5: connection 1: plasticity: the weight 20 pA ... -100 to 0 pA ... "
                    "[SL0203]"},
        NetworkCase{"repeater_learns",
                    learning("rule: stdp", "from: input, to: relay, rule: one_to_one, delay: 1"),
                    "net.yaml:8:70: connection 1: plasticity: a repeater does not learn; leave "
                    "'plasticity' out, or connect an iaf_psc_delta or iaf_psc_exp [SL0405]"},
        NetworkCase{"current_learns",
                    learning("rule: stdp", "from: wave, to: cell, rule: all_to_all"),
                    "net.yaml:8:58: connection 1: plasticity: a current does not learn; leave "
                    "'plasticity' out [SL0405]"},
        NetworkCase{
            "reward_missing", learning("rule: stdp_dopamine"),
            "net.yaml:8:81: connection 1: plasticity: key 'reward' is missing; write  reward: "
            "NAME [SL0104]"},
        NetworkCase{
            "reward_unknown", learning("rule: stdp_dopamine, reward: inputs"),
            "net.yaml:8:111: connection 1: plasticity: unknown population 'inputs'; did you mean "
            "'input'? [SL0301]"},
        NetworkCase{
            "reward_current", learning("rule: stdp_dopamine, reward: wave"),
            "net.yaml:8:111: connection 1: plasticity: reward 'wave' is a sine_current; write a "
            "population with spikes, or a signal_input [SL0405]"},
        NetworkCase{
            "reward_delay_of_signal",
            learning("rule: stdp_dopamine, reward: drive, reward_delay: 1"),
            "net.yaml:8:132: connection 1: plasticity: the signal 'drive' acts at once; leave "
            "reward_delay out [SL0310]"},
        NetworkCase{"reward_delay_short",
                    learning("rule: stdp_dopamine, reward: input, reward_delay: 0.01"),
                    "net.yaml:8:132: connection 1: plasticity: reward_delay 10 us ... 100 us ... "
                    "100 us ... [SL0310]"},
        NetworkCase{"reward_delay_grid",
                    learning("rule: stdp_dopamine, reward: input, reward_delay: 0.15"),
                    "net.yaml:8:132: connection 1: plasticity: reward_delay 150 us ... 100 us ... "
                    "100 us or 200 us ... [SL0207]"},
        NetworkCase{
            "save_suffix", learning("rule: stdp, save: w.txt"),
            "net.yaml:8:100: connection 1: plasticity: save 'w.txt' ends in neither .npy nor "
            ".json; write for example  save: learned.npy [SL0405]"},
        NetworkCase{"save_path", learning("rule: stdp, save: out/w.npy"),
                    "net.yaml:8:100: connection 1: plasticity: save 'out/w.npy' is a path; write "
                    "the name of a file alone, which comes to lie in the run folder [SL0405]"},
        NetworkCase{
            "save_twice",
            learning("rule: stdp, save: w.npy",
                     "from: input, to: cell, rule: pairs, pairs: [[0, 1], [0, 1]], weight: 20, "
                     "delay: 1"),
            "net.yaml:8:120: connection 1: plasticity: there are two synapses from 0 to 1, which a "
            "table of weights cannot hold; leave 'save' out, or write the pair once [SL0405]"},
        NetworkCase{
            "save_one_name",
            kPopulations +
                std::string("connections:\n  - {from: input, to: cell, rule: all_to_all, weight: "
                            "20, delay: 1, plasticity: {rule: stdp, save: w.npy}}\n  - {from: "
                            "relay, to: cell, rule: all_to_all, weight: 20, delay: 1, plasticity: "
                            "{rule: stdp, save: w.npy}}\noutput: [cell]\n"),
            "net.yaml:9:81: connections 1 and 2 save their weights as 'w.npy'; write another name "
            "for one [SL0405]"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace spikeloop::test
