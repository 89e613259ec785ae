// Every message of the network file's parser: place, value and remedy.
#include <fmt/format.h>

#include "network_case.hpp"

namespace spikeloop::test {
namespace {

class NetworkError : public testing::TestWithParam<NetworkCase> {};

WeightTable weights(const std::string& path) {
  if (path == "none.json") {
    throw ConfigurationError("there is no file 'none.json'; write its name");
  }
  return path == "half.json" ? WeightTable::dense(2, 2, {1, 0, 0, 0.5})
                             : WeightTable::dense(3, 2, std::vector<double>(6, 1.0));
}

TEST_P(NetworkError, SaysWhatWhereAndWhatToWrite) {
  expect_its_message(GetParam(), weights);
}

std::string with_population(const std::string& population) {
  return "populations:\n  a: " + population + "\noutput: [a]\n";
}

// Line 6 is the connection.
std::string with_connection(const std::string& connection,
                            const std::string& resolution = "0.1 ms") {
  return "resolution: " + resolution +
         "\npopulations:\n"
         "  input: {model: input, size: 2}\n"
         "  relay: {model: repeater, size: 3}\n"
         "connections:\n"
         "  - {" +
         connection + "}\noutput: [relay]\n";
}

std::string with_cell(const std::string& connection) {
  return "populations:\n"
         "  input: {model: input, size: 2}\n"
         "  cell: {model: iaf_psc_exp, size: 2}\n"
         "connections:\n"
         "  - {from: input, to: cell, " +
         connection + "}\noutput: [cell]\n";
}

INSTANTIATE_TEST_SUITE_P(
    File, NetworkError,
    testing::Values(
        NetworkCase{"not_yaml", "populations: [\n",
                    "net.yaml:2:1: ... YAML: end of sequence flow not found ... [SL0101]"},
        NetworkCase{"comma_first", " , a\n", "net.yaml:1:2: ... YAML: ... key: value ... [SL0101]"},
        NetworkCase{
            "two_documents", "output: [a]\n---\noutput: [b]\n",
            "net.yaml:3:1: ... write one network a file, without '---' inside it ... [SL0101]"},
        NetworkCase{
            "no_map", "- 1\n",
            "net.yaml:1:1: network file must be a map; write  key: value  lines, for example  "
            "resolution: ... [SL0105]"},
        NetworkCase{"unknown_key", "popullations: {}\n",
                    "net.yaml:1:1: network file: unknown key 'popullations'; did you mean "
                    "'populations'? [SL0103]"},
        NetworkCase{
            "twice", "output: [a]\noutput: [a]\n",
            "net.yaml:2:1: network file: duplicate key 'output' ... net.yaml:1:1 ... [SL0102]"},
        NetworkCase{
            "no_populations", "output: [a]\n",
            "net.yaml:1:1: network file: key 'populations' is missing; write  populations: {relay: "
            "{model: repeater, size: 1}} [SL0104]"},
        NetworkCase{
            "populations_list", "populations: [a]\noutput: [a]\n",
            "net.yaml:1:14: key 'populations' ... key: value  lines ... name: ... [SL0105]"},
        NetworkCase{
            "resolution_word", "resolution: fine\n",
            "net.yaml:1:13: network file: key 'resolution': 'fine' ... 0.5 ms ... [SL0201]"},
        NetworkCase{"resolution_zero", "resolution: 0\n",
                    "net.yaml:1:13: network file: resolution '0' ... 1 ns to 1e9 ms ... 0.1 ms ... "
                    "[SL0207]"},
        NetworkCase{"resolution_unit", "resolution: 3 mV\n",
                    "net.yaml:1:13: network file: key 'resolution': '3 mV': 'mV' ... ns, us, ms, "
                    "s, min, h ... [SL0202]"},
        NetworkCase{"resolution_list", "resolution: [1]\n",
                    "net.yaml:1:13: key 'resolution': expected one value, found a list [SL0105]"},
        NetworkCase{"resolution_empty", "resolution:\npopulations: {}\n",
                    "net.yaml:1:1: network file: key 'resolution' has no value; write  resolution: "
                    "0.1 ms [SL0104]"},
        NetworkCase{"output_empty_name",
                    "populations:\n  a: {model: repeater, size: 1}\noutput: ['']\n",
                    "net.yaml:3:10: key 'output': expected one value, found nothing [SL0105]"},
        NetworkCase{
            "connections_map", "populations:\n  a: {model: repeater, size: 1}\nconnections: {}\n",
            "net.yaml:3:14: key 'connections': expected a list; write lines of  - {from: a, to: b, "
            "rule: one_to_one, weight: 1, delay: 1 ms} [SL0105]"},
        NetworkCase{
            "no_output", "populations:\n  a: {model: repeater, size: 1}\n",
            "net.yaml:1:1: network file: key 'output' is missing; write  output: [name of a "
            "population] [SL0104]"},
        NetworkCase{"output_word", "populations:\n  a: {model: repeater, size: 1}\noutput: a\n",
                    "net.yaml:3:9: key 'output': expected a list of populations; write  output: "
                    "[name] [SL0105]"},
        NetworkCase{"output_unknown",
                    "populations:\n  relay: {model: repeater, size: 1}\noutput: [rellay]\n",
                    "net.yaml:3:10: key 'output': unknown population 'rellay'; did you mean "
                    "'relay'? [SL0301]"},
        NetworkCase{
            "output_input", "populations:\n  a: {model: input, size: 1}\noutput: [a]\n",
            "net.yaml:3:10: key 'output': 'a' is an input; connect it to a repeater and write the "
            "repeater's name [SL0405]"},
        NetworkCase{
            "output_twice", "populations:\n  a: {model: repeater, size: 1}\noutput: [a, a]\n",
            "net.yaml:3:13: key 'output': population 'a' is named twice; write it once [SL0102]"}),
    [](const auto& test) { return std::string(test.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Population, NetworkError,
    testing::Values(
        NetworkCase{"no_map", with_population("5"),
                    "net.yaml:2:6: population 'a' ... key: value  lines ... model: ... [SL0105]"},
        NetworkCase{
            "unknown_key", with_population("{modell: repeater, size: 1}"),
            "net.yaml:2:7: population 'a': unknown key 'modell'; did you mean 'model'? [SL0103]"},
        NetworkCase{"no_model", with_population("{size: 1}"),
                    "net.yaml:2:6: population 'a': key 'model' is missing; write  model: repeater "
                    "[SL0104]"},
        NetworkCase{
            "no_size", with_population("{model: repeater}"),
            "net.yaml:2:6: population 'a': key 'size' is missing; write  size: 100 [SL0104]"},
        NetworkCase{"unknown_model", with_population("{model: iaf_psc_alpha, size: 1}"),
                    "net.yaml:2:14: population 'a': unknown model 'iaf_psc_alpha'; did you mean "
                    "'iaf_psc_delta'? [SL0205]"},
        NetworkCase{"foreign_model", with_population("{model: hodgkin_huxley, size: 1}"),
                    "net.yaml:2:14: population 'a': unknown model 'hodgkin_huxley'; known: input, "
                    "repeater, iaf_psc_delta, iaf_psc_exp, poisson, signal_input, step_current, "
                    "sine_current, noise_current, lin_rate_ipn, threshold_lin_rate_ipn, "
                    "sigmoid_rate_ipn [SL0205]"},
        NetworkCase{"size_zero", with_population("{model: repeater, size: 0}"),
                    "net.yaml:2:30: population 'a': size 0 ... 1 to 10000000; larger models belong "
                    "in NEST, NEURON or Brian2 ... [SL0203]"},
        NetworkCase{"size_part", with_population("{model: repeater, size: 1.5}"),
                    "net.yaml:2:30: population 'a': size 1.5 ... 1 to 10000000 ... NEST, NEURON or "
                    "Brian2 ... [SL0203]"},
        NetworkCase{"size_word", with_population("{model: repeater, size: many}"),
                    "net.yaml:2:30: population 'a': key 'size': 'many' ... 0.5 ... [SL0201]"},
        NetworkCase{
            "size_total",
            "populations:\n  a: {model: repeater, size: 6000000}\n  b: {model: repeater, size: "
            "6000000}\noutput: [a]\n",
            "net.yaml:2:3: the populations have 12000000 members together, more than the 10000000 "
            "that "
            "this network takes; larger models ... NEST, NEURON or Brian2 ... [SL0203]"},
        NetworkCase{
            "repeater_parameters",
            with_population("{model: repeater, size: 1, parameters: {C_m: 1}}"),
            "net.yaml:2:45: population 'a': model repeater has no parameters; leave the key "
            "'parameters' out [SL0405]"},
        NetworkCase{
            "unknown_parameter",
            with_population("{model: iaf_psc_exp, size: 1, parameters: {tau_syn_exc: 1 ms}}"),
            "net.yaml:2:62: unknown key 'tau_syn_exc'; did you mean 'tau_syn_ex'? [SL0103]"},
        NetworkCase{
            "parameter_of_other_model",
            with_population("{model: iaf_psc_exp, size: 1, parameters: {V_min: -80}}"),
            "net.yaml:2:56: unknown key 'V_min'; known: C_m, tau_m, t_ref, E_L, V_reset, V_th, "
            "V_m, I_e, tau_syn_ex, tau_syn_in [SL0103]"},
        NetworkCase{
            "parameter_unit",
            with_population("{model: iaf_psc_exp, size: 1, parameters: {tau_m: 10 mV}}"),
            "net.yaml:2:56: key 'tau_m': '10 mV': 'mV' ... ns, us, ms, s, min, h ... [SL0202]"},
        NetworkCase{"parameter_bounds",
                    with_population("{model: iaf_psc_exp, size: 1, parameters: {tau_m: 0 ms}}"),
                    "net.yaml:2:56: key 'tau_m': 0 ... 0.001 ms ... [SL0203]"},
        NetworkCase{
            "reset_above_threshold",
            with_population("{model: iaf_psc_exp, size: 1, parameters: {V_reset: -50 mV}}"),
            "net.yaml:2:58: population 'a': V_reset -50 mV is not below V_th -55 mV, so the neuron "
            "would never stop firing; write a V_reset below V_th [SL0206]"},
        NetworkCase{"threshold_below_reset",
                    with_population("{model: iaf_psc_delta, size: 1, parameters: {V_th: -70 mV}}"),
                    "net.yaml:2:57: population 'a': V_reset -70 mV ... V_th -70 mV ... V_reset "
                    "below V_th ... [SL0206]"},
        NetworkCase{
            "lower_bound",
            with_population("{model: iaf_psc_delta, size: 1, parameters: {V_min: -60 mV}}"),
            "net.yaml:2:58: population 'a': V_min -60 mV is above V_reset -70 mV; write a V_min at "
            "or below V_reset [SL0206]"},
        NetworkCase{
            "needs_grid", "resolution: off\n" + with_population("{model: iaf_psc_exp, size: 1}"),
            "net.yaml:3:14: population 'a': model iaf_psc_exp is computed on a grid, but the "
            "resolution is off; write  resolution: 0.1 ms [SL0207]"}),
    [](const auto& test) { return std::string(test.param.name); });

INSTANTIATE_TEST_SUITE_P(
    Connection, NetworkError,
    testing::Values(
        NetworkCase{
            "unknown_key", with_connection("form: input"),
            "net.yaml:6:6: connection 1: unknown key 'form'; did you mean 'from'? [SL0103]"},
        NetworkCase{
            "no_from", with_connection("to: relay"),
            "net.yaml:6:5: connection 1: key 'from' is missing; write  from: input [SL0104]"},
        NetworkCase{"no_to", with_connection("from: input"),
                    "net.yaml:6:5: connection 1: key 'to' is missing; write  to: relay [SL0104]"},
        NetworkCase{"unknown_from", with_connection("from: inptu, to: relay"),
                    "net.yaml:6:12: connection 1: unknown population 'inptu'; did you mean "
                    "'input'? [SL0301]"},
        NetworkCase{"unknown_to", with_connection("from: input, to: motor"),
                    "net.yaml:6:23: connection 1: unknown population 'motor'; known: input, relay "
                    "[SL0301]"},
        NetworkCase{
            "to_input", with_connection("from: relay, to: input"),
            "net.yaml:6:23: connection 1: 'input' is an input, it only gets what arrives at port "
            "'in'; write a population of neurons or repeaters [SL0405]"},
        NetworkCase{
            "no_delay", with_connection("from: input, to: relay, rule: all_to_all"),
            "net.yaml:6:5: connection 1: key 'delay' is missing; write  delay: 1 ms [SL0104]"},
        NetworkCase{"delay_word",
                    with_connection("from: input, to: relay, rule: all_to_all, delay: short"),
                    "net.yaml:6:55: connection 1: key 'delay': 'short' ... 0.5 ms ... [SL0201]"},
        NetworkCase{
            "delay_negative",
            with_connection("from: input, to: relay, rule: all_to_all, delay: -1 ms"),
            "net.yaml:6:55: connection 1: delay '-1 ms' ... 1 ns to 1e9 ms ... 1 ms ... [SL0207]"},
        NetworkCase{"delay_short",
                    with_connection("from: input, to: relay, rule: all_to_all, delay: 50 us"),
                    "net.yaml:6:55: delay 50 us is below the resolution 100 us; write at least 100 "
                    "us [SL0310]"},
        NetworkCase{"delay_off_grid",
                    with_connection("from: input, to: relay, rule: all_to_all, delay: 0.25 ms"),
                    "net.yaml:6:55: delay 250 us ... 100 us ... 200 us or 300 us ... [SL0207]"},
        NetworkCase{
            "delay_long",
            with_connection("from: input, to: relay, rule: all_to_all, delay: 1 h", "1 us"),
            "net.yaml:6:55: delay 3600 s is 3600000000 steps of 1 us, too much to buffer; write a "
            "shorter delay or a coarser resolution ... NEST, NEURON or Brian2 ... [SL0310]"},
        NetworkCase{
            "no_rule", with_connection("from: input, to: relay, delay: 1 ms"),
            "net.yaml:6:5: connection 1: key 'rule' is missing; write  rule: one_to_one [SL0104]"},
        NetworkCase{"unknown_rule",
                    with_connection("from: input, to: relay, rule: all_to_al, delay: 1"),
                    "net.yaml:6:36: unknown rule 'all_to_al'; did you mean 'all_to_all'?; write "
                    "one_to_one, all_to_all, pairs, a table of weights or a weight file that ends "
                    "in .json or "
                    ".npy [SL0205]"},
        NetworkCase{
            "table_of_odd_rows",
            with_connection("from: input, to: relay, rule: [[1, 1], [1], [1, 1]], delay: 1 ms"),
            "net.yaml:6:36: key 'rule': table: row 1 has 1 weights, but row 0 has 2 ... [SL0309]"},
        NetworkCase{
            "table_of_another_size",
            with_connection("from: input, to: relay, rule: [[1, 1]], delay: 1 ms"),
            "net.yaml:6:36: 'table' has 1 rows and 2 columns, but 'relay' has 3 neurons and "
            "'input' has 2; write one row a target and one column a source [SL0308]"},
        NetworkCase{"one_to_one_sizes",
                    with_connection("from: input, to: relay, rule: one_to_one, delay: 1 ms"),
                    "net.yaml:6:36: rule one_to_one needs populations of one size, but 'input' has "
                    "2 and 'relay' has 3; write all_to_all, pairs or a weight file [SL0308]"},
        NetworkCase{
            "repeater_weight",
            with_connection("from: input, to: relay, rule: all_to_all, weight: 2, delay: 1 ms"),
            "net.yaml:6:56: weight 2 into repeater 'relay': a repeater repeats every spike once, "
            "whatever its weight; write 1 or leave the weight out [SL0405]"},
        NetworkCase{
            "repeater_weight_unit",
            with_connection("from: input, to: relay, rule: all_to_all, weight: 1 pA, delay: 1 ms"),
            "net.yaml:6:56: connection 1: key 'weight': '1 pA': ... 'pA' ... 1 ... [SL0202]"},
        NetworkCase{
            "no_weight", with_cell("rule: all_to_all, delay: 1 ms"),
            "net.yaml:5:5: connection 1: key 'weight' is missing; write  weight: 100 pA [SL0104]"},
        NetworkCase{"weight_unit", with_cell("rule: all_to_all, delay: 1 ms, weight: 3 mV"),
                    "net.yaml:5:68: connection 1: key 'weight': '3 mV': 'mV' ... pA, nA, uA, mA, A "
                    "... [SL0202]"},
        NetworkCase{"no_pairs", with_cell("rule: pairs, delay: 1 ms, weight: 3 pA"),
                    "net.yaml:5:5: connection 1: key 'pairs' is missing; write  pairs: [[0, 0], "
                    "[1, 0]] [SL0104]"},
        NetworkCase{"pairs_unused",
                    with_cell("rule: all_to_all, pairs: [], delay: 1 ms, weight: 3 pA"),
                    "net.yaml:5:54: key 'pairs' is read with rule pairs only, but the rule is "
                    "'all_to_all'; write  rule: pairs [SL0208]"},
        NetworkCase{
            "pairs_word", with_cell("rule: pairs, pairs: 3, delay: 1 ms, weight: 3 pA"),
            "net.yaml:5:49: key 'pairs': expected a list; write  pairs: [[0, 0], [1, 0]] [SL0105]"},
        NetworkCase{
            "pair_short", with_cell("rule: pairs, pairs: [[0]], delay: 1 ms, weight: 3 pA"),
            "net.yaml:5:50: pairs: an entry is not a pair; write [source, target] or [source, "
            "target, factor], for example [0, 1] or [0, 1, -0.5] [SL0105]"},
        NetworkCase{"pair_range",
                    with_cell("rule: pairs, pairs: [[0, 2]], delay: 1 ms, weight: 3 pA"),
                    "net.yaml:5:54: pairs: '2' is not a member of 'cell' ... 0 to 1 ... [SL0405]"},
        NetworkCase{"pair_negative",
                    with_cell("rule: pairs, pairs: [[-1, 0]], delay: 1 ms, weight: 3 pA"),
                    "net.yaml:5:51: pairs: '-1' ... 'input' ... 0 to 1 ... [SL0405]"},
        NetworkCase{"pair_factor",
                    with_cell("rule: pairs, pairs: [[0, 1, x]], delay: 1 ms, weight: 3 pA"),
                    "net.yaml:5:57: pairs: 'x' ... 0.5 ... [SL0201]"},
        NetworkCase{
            "repeater_factor",
            with_connection("from: input, to: relay, rule: pairs, pairs: [[0, 1, 2]], delay: 1 ms"),
            "net.yaml:6:58: weight 2 into repeater 'relay': ... 1 ... [SL0405]"},
        NetworkCase{"weight_file", with_cell("rule: none.json, delay: 1 ms, weight: 3 pA"),
                    "net.yaml:5:35: key 'rule': there is no file 'none.json'; write its name"},
        NetworkCase{"weight_file_size", with_cell("rule: three.json, delay: 1 ms, weight: 3 pA"),
                    "net.yaml:5:35: 'three.json' has 3 rows and 2 columns, but 'cell' has 2 "
                    "neurons and 'input' has 2 ... [SL0308]"},
        NetworkCase{
            "weight_file_repeater",
            "populations:\n  a: {model: repeater, size: 2}\nconnections:\n  - {from: a, to: a, "
            "rule: half.json, delay: 1 ms}\noutput: [a]\n",
            "net.yaml:4:28: weight 0.5 into repeater 'a': ... 1 ... [SL0405]"},
        NetworkCase{
            "too_many",
            "populations:\n  a: {model: repeater, size: 20000}\nconnections:\n  - {from: a, to: a, "
            "rule: all_to_all, delay: 1 ms}\noutput: [a]\n",
            "net.yaml:4:28: 400000000 synapses are more than the 100000000 ... NEST, NEURON or "
            "Brian2 ... [SL0203]"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace spikeloop::test
