// Every message about rate neurons in a network file.
#include "network_case.hpp"

namespace spikeloop::test {
namespace {

class RateFault : public testing::TestWithParam<NetworkCase> {};

TEST_P(RateFault, SaysWhatWhereAndWhatToWrite) {
  expect_its_message(GetParam());
}

// Line 9 is what follows.
constexpr const char* kRates =
    "populations:\n"
    "  input: {model: input, size: 2}\n"
    "  cell: {model: iaf_psc_exp, size: 2}\n"
    "  noise: {model: noise_current, size: 2, parameters: {std: 1}}\n"
    "  drive: {model: signal_input, size: 2}\n"
    "  a: {model: lin_rate_ipn, size: 2}\n"
    "  b: {model: threshold_lin_rate_ipn, size: 2}\n"
    "  reward: {model: lin_rate_ipn, size: 1}\n";

std::string one(const std::string& population) {
  return "populations:\n  a: " + population + "\nrates: [a]\n";
}

std::string joined(const std::string& connection) {
  return std::string(kRates) + "connections:\n  - {" + connection + "}\nrates: [b]\n";
}

std::string hebbian(const std::string& keys) {
  return joined("from: a, to: b, rule: all_to_all, weight: 0.5, plasticity: {" + keys + "}");
}

INSTANTIATE_TEST_SUITE_P(
    File, RateFault,
    testing::Values(
        NetworkCase{"unknown_parameter",
                    one("{model: lin_rate_ipn, size: 1, parameters: {taus: 1}}"),
                    "net.yaml:2:56: unknown key 'taus'; did you mean 'tau'? [SL0103]"},
        NetworkCase{"alpha_of_lin", one("{model: lin_rate_ipn, size: 1, parameters: {alpha: 1}}"),
                    "net.yaml:2:57: unknown key 'alpha'; known: tau, lambda, sigma, mu, g, theta, "
                    "rate [SL0103]"},
        NetworkCase{"beta_of_threshold_lin",
                    one("{model: threshold_lin_rate_ipn, size: 1, parameters: {beta: 1}}"),
                    "net.yaml:2:66: unknown key 'beta'; known: tau, lambda, sigma, mu, g, theta, "
                    "rate, alpha [SL0103]"},
        NetworkCase{"tau", one("{model: lin_rate_ipn, size: 1, parameters: {tau: 0}}"),
                    "net.yaml:2:55: key 'tau': 0 ... 0.001 ms ... [SL0203]"},
        NetworkCase{"lambda", one("{model: lin_rate_ipn, size: 1, parameters: {lambda: -1}}"),
                    "net.yaml:2:58: key 'lambda': -1 ... 0 ... [SL0203]"},
        NetworkCase{"sigma", one("{model: sigmoid_rate_ipn, size: 1, parameters: {sigma: -1}}"),
                    "net.yaml:2:61: key 'sigma': -1 ... 0 ... [SL0203]"},
        NetworkCase{"alpha",
                    one("{model: threshold_lin_rate_ipn, size: 1, parameters: {alpha: -1}}"),
                    "net.yaml:2:67: key 'alpha': -1 ... 0 ... [SL0203]"},
        NetworkCase{"unit", one("{model: lin_rate_ipn, size: 1, parameters: {mu: 1 pA}}"),
                    "net.yaml:2:54: key 'mu': '1 pA': ... 'pA' ... 1 ... [SL0202]"},
        NetworkCase{"off", "resolution: off\n" + one("{model: lin_rate_ipn, size: 1}"),
                    "net.yaml:3:14: population 'a': model lin_rate_ipn ... resolution: 0.1 ms ... "
                    "[SL0207]"},
        NetworkCase{
            "spikes_to_rate", joined("from: input, to: a, rule: one_to_one"),
            "net.yaml:10:12: connection 1: rate neurons take rates and signals, but 'input' is of "
            "model input; write a population of rate neurons or a signal_input [SL0405]"},
        NetworkCase{"membrane_to_rate", joined("from: cell, to: a, rule: one_to_one, delay: 1"),
                    "net.yaml:10:12: connection 1: ... but 'cell' is of model iaf_psc_exp ... "
                    "signal_input ... [SL0405]"},
        NetworkCase{"noise_to_rate", joined("from: noise, to: a, rule: one_to_one"),
                    "net.yaml:10:12: connection 1: ... but 'noise' ... noise_current ... "
                    "signal_input ... [SL0405]"},
        NetworkCase{"rate_to_spikes", joined("from: a, to: cell, rule: one_to_one, delay: 1"),
                    "net.yaml:10:19: connection 1: 'cell' ... iaf_psc_exp, which takes no rate ... "
                    "lin_rate_ipn, threshold_lin_rate_ipn or sigmoid_rate_ipn ... [SL0405]"},
        NetworkCase{"rate_to_source", joined("from: a, to: drive, rule: one_to_one"),
                    "net.yaml:10:19: connection 1: 'drive' is a signal_input ... [SL0405]"},
        NetworkCase{"signal_delay", joined("from: drive, to: a, rule: one_to_one, delay: 1"),
                    "net.yaml:10:51: connection 1: the signal of 'drive' ... [SL0310]"},
        NetworkCase{
            "weight_unit", joined("from: a, to: b, rule: one_to_one, weight: 1 mV"),
            "net.yaml:10:48: connection 1: key 'weight': '1 mV': ... 'mV' ... 1 ... [SL0202]"},
        NetworkCase{
            "signal_weight_unit", joined("from: drive, to: b, rule: one_to_one, weight: 1 pA"),
            "net.yaml:10:52: connection 1: key 'weight': '1 pA': ... 'pA' ... 1 ... [SL0202]"},
        NetworkCase{"delay_grid", joined("from: a, to: b, rule: one_to_one, delay: 0.05"),
                    "net.yaml:10:47: delay 50 us ... 100 us ... 100 us ... [SL0207]"},
        NetworkCase{"delay_negative", joined("from: a, to: b, rule: one_to_one, delay: -1"),
                    "net.yaml:10:47: connection 1: delay '-1' is not a whole number of nanoseconds "
                    "from 1 ns to 1e9 ms; write for example 1 ms [SL0207]"},
        NetworkCase{"delay_long", joined("from: a, to: b, rule: one_to_one, delay: 1 h"),
                    "net.yaml:10:47: delay 3600 s is 36000000 steps of 100 us for each of 2 "
                    "sources ... NEST, NEURON or Brian2 ... [SL0310]"},
        NetworkCase{"rates_of_spikes", std::string(kRates) + "rates: [cell]\n",
                    "net.yaml:9:9: key 'rates': 'cell' is of model iaf_psc_exp, which has no rate; "
                    "write a population of model lin_rate_ipn, threshold_lin_rate_ipn or "
                    "sigmoid_rate_ipn [SL0405]"},
        NetworkCase{
            "rates_twice", std::string(kRates) + "rates: [a, a]\n",
            "net.yaml:9:12: key 'rates': population 'a' is named twice; write it once [SL0102]"},
        NetworkCase{"output_rate", std::string(kRates) + "output: [a]\n",
                    "net.yaml:9:10: key 'output': 'a' is a lin_rate_ipn ... [SL0405]"},
        NetworkCase{"potential_rate", std::string(kRates) + "potential: [a]\n",
                    "net.yaml:9:13: key 'potential': 'a' is a lin_rate_ipn ... iaf_psc_delta or "
                    "iaf_psc_exp ... [SL0405]"},
        NetworkCase{"nothing_leaves", kRates,
                    "net.yaml:1:1: network file: key 'output' is missing; write  output: [name of "
                    "a population] [SL0104]"},
        NetworkCase{"rule_of_spikes", hebbian("rule: stdp"),
                    "net.yaml:10:72: connection 1: plasticity: rule stdp is for spikes; write  "
                    "rule: reward_hebbian [SL0405]"},
        NetworkCase{"rule_of_rates",
                    joined("from: input, to: cell, rule: one_to_one, weight: 1, delay: 1, "
                           "plasticity: {rule: reward_hebbian, reward: reward}"),
                    "net.yaml:10:87: connection 1: plasticity: rule reward_hebbian is for rate "
                    "neurons; write  rule: stdp [SL0405]"},
        NetworkCase{"signal_learns",
                    joined("from: drive, to: a, rule: one_to_one, plasticity: {rule: "
                           "reward_hebbian, reward: reward}"),
                    "net.yaml:10:56: connection 1: plasticity: a signal does not learn; leave "
                    "'plasticity' out [SL0405]"},
        NetworkCase{"reward_missing", hebbian("rule: reward_hebbian"),
                    "net.yaml:10:65: connection 1: plasticity: key 'reward' is missing; write  "
                    "reward: NAME [SL0104]"},
        NetworkCase{"reward_unknown", hebbian("rule: reward_hebbian, reward: rewards"),
                    "net.yaml:10:96: connection 1: plasticity: unknown population 'rewards'; did "
                    "you mean 'reward'? [SL0301]"},
        NetworkCase{"reward_size", hebbian("rule: reward_hebbian, reward: a"),
                    "net.yaml:10:96: connection 1: plasticity: reward 'a' is a lin_rate_ipn of "
                    "size 2; write a population of one rate neuron [SL0405]"},
        NetworkCase{"reward_signal", hebbian("rule: reward_hebbian, reward: drive"),
                    "net.yaml:10:96: connection 1: plasticity: reward 'drive' is a signal_input of "
                    "size 2 ... [SL0405]"},
        NetworkCase{"reward_of_dopamine",
                    joined("from: input, to: cell, rule: one_to_one, weight: 1, delay: 1, "
                           "plasticity: {rule: stdp_dopamine, reward: reward}"),
                    "net.yaml:10:110: connection 1: plasticity: reward 'reward' is a lin_rate_ipn "
                    "... signal_input ... [SL0405]"},
        NetworkCase{"key_of_spikes", hebbian("rule: reward_hebbian, reward: reward, tau_plus: 20"),
                    "net.yaml:10:114: unknown key 'tau_plus'; known: rule, save, reward, A, theta, "
                    "Wmin, Wmax, trace_delay [SL0103]"},
        NetworkCase{"trace_short",
                    hebbian("rule: reward_hebbian, reward: reward, trace_delay: 0.01"),
                    "net.yaml:10:117: connection 1: plasticity: trace_delay 10 us ... 100 us ... "
                    "100 us ... [SL0310]"},
        NetworkCase{"trace_grid",
                    hebbian("rule: reward_hebbian, reward: reward, trace_delay: 0.15"),
                    "net.yaml:10:117: connection 1: plasticity: trace_delay 150 us ... 100 us ... "
                    "100 us or 200 us ... [SL0207]"},
        NetworkCase{"trace_long", hebbian("rule: reward_hebbian, reward: reward, trace_delay: 1 h"),
                    "net.yaml:10:117: connection 1: plasticity: trace_delay 3600 s is 36000000 "
                    "steps of 100 us ... 2 members ... NEST, NEURON or Brian2 ... [SL0310]"},
        NetworkCase{"bounds_order", hebbian("rule: reward_hebbian, reward: reward, Wmin: 1"),
                    "net.yaml:10:65: connection 1: plasticity: Wmin 1 is not below Wmax 1; write a "
                    "Wmin below Wmax [SL0206]"},
        NetworkCase{
            "weight_outside", hebbian("rule: reward_hebbian, reward: reward, Wmax: 0.4"),
            "net.yaml:10:5: connection 1: plasticity: the weight 0.5 ... 0 to 0.4 ... [SL0203]"},
        NetworkCase{"save_suffix", hebbian("rule: reward_hebbian, reward: reward, save: w"),
                    "net.yaml:10:110: connection 1: plasticity: save 'w' ends in neither .npy nor "
                    ".json; write for example  save: learned.npy [SL0405]"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace spikeloop::test
