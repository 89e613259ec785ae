// What a network file says when it is right.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <fstream>

#include "run_network.hpp"
#include "spikeloop/config/npy_file.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::test {
namespace {

using testing::ElementsAre;

constexpr const char* kExample = R"(
resolution: 0.1 ms
populations:
  input: {model: input, size: 3}
  relay: {model: repeater, size: 3}
  motor:
    model: iaf_psc_exp
    size: 2
    parameters: {tau_m: 20 ms, C_m: 0.5 nF, V_th: -0.05 V, tau_syn_ex: 3000 us}
connections:
  - {from: input, to: relay, rule: one_to_one, weight: 1, delay: 1 ms}
  - {from: relay, to: motor, rule: all_to_all, weight: 0.1 nA, delay: 1500 us}
  - from: motor
    to: motor
    rule: pairs
    pairs: [[1, 0], [0, 1, -0.5]]
    weight: 40
    delay: 2
output: [relay, motor]
)";

TEST(NetworkFile, IsReadWithItsUnits) {
  const NetworkFile network = parse(kExample);
  EXPECT_EQ(network.resolution, 100'000);
  ASSERT_EQ(network.populations.size(), 3u);
  EXPECT_EQ(network.populations[1].name, "relay");
  EXPECT_EQ(network.populations[1].model, NeuronModel::repeater);
  const NetworkPopulation& motor = network.populations[2];
  EXPECT_EQ(motor.model, NeuronModel::iaf_psc_exp);
  EXPECT_EQ(motor.size, 2u);
  EXPECT_DOUBLE_EQ(motor.parameters.tau_m, 20.0);
  EXPECT_DOUBLE_EQ(motor.parameters.C_m, 500.0);
  EXPECT_DOUBLE_EQ(motor.parameters.V_th, -50.0);
  EXPECT_DOUBLE_EQ(motor.parameters.tau_syn_ex, 3.0);
  EXPECT_EQ(motor.where.text(), "net.yaml:7:5");
  EXPECT_THAT(network.output, ElementsAre(1u, 2u));
  EXPECT_EQ(network.input_width(), 3u);
  EXPECT_EQ(network.output_width(), 5u);
}

TEST(NetworkFile, GroupsSynapsesBySource) {
  const NetworkFile network = parse(kExample);
  ASSERT_EQ(network.projections.size(), 3u);
  const NetworkProjection& all = network.projections[1];
  EXPECT_EQ(all.from, 1u);
  EXPECT_EQ(all.to, 2u);
  EXPECT_EQ(all.delay, 1'500'000);
  EXPECT_THAT(all.row_start, ElementsAre(0u, 2u, 4u, 6u));
  EXPECT_THAT(all.target, ElementsAre(0u, 1u, 0u, 1u, 0u, 1u));
  EXPECT_THAT(all.weight, testing::Each(testing::DoubleEq(100.0)));
  const NetworkProjection& pairs = network.projections[2];
  EXPECT_EQ(pairs.delay, 2'000'000);
  EXPECT_THAT(pairs.row_start, ElementsAre(0u, 1u, 2u));
  EXPECT_THAT(pairs.target, ElementsAre(1u, 0u));
  EXPECT_THAT(pairs.weight, ElementsAre(-20.0, 40.0));
}

TEST(NetworkFile, DefaultsAreThoseOfNest) {
  const NetworkFile network = parse(
      "populations:\n"
      "  d: {model: iaf_psc_delta, size: 1}\n"
      "  e: {model: iaf_psc_exp, size: 1, parameters: {E_L: -65}}\n"
      "output: [d]\n");
  EXPECT_EQ(network.resolution, 100'000);
  const NeuronParameters& d = network.populations[0].parameters;
  EXPECT_EQ(d.C_m, 250.0);
  EXPECT_EQ(d.tau_m, 10.0);
  EXPECT_EQ(d.t_ref, 2.0);
  EXPECT_EQ(d.E_L, -70.0);
  EXPECT_EQ(d.V_reset, -70.0);
  EXPECT_EQ(d.V_th, -55.0);
  EXPECT_EQ(d.V_m, -70.0);
  EXPECT_EQ(d.I_e, 0.0);
  EXPECT_EQ(d.V_min, -std::numeric_limits<double>::infinity());
  const NeuronParameters& e = network.populations[1].parameters;
  EXPECT_EQ(e.tau_syn_ex, 2.0);
  EXPECT_EQ(e.tau_syn_in, 2.0);
  EXPECT_EQ(e.V_m, -65.0) << "the membrane starts at rest";
}

TEST(NetworkFile, ResolutionOffMeansNoGrid) {
  const NetworkFile network =
      parse("resolution: off\npopulations:\n  r: {model: repeater, size: 1}\noutput: [r]\n");
  EXPECT_EQ(network.resolution, 0);
}

TEST(NetworkFile, AWeightFileIsLookedUpBesideIt) {
  std::string asked;
  const NetworkFile network = parse_network(
      "populations:\n"
      "  input: {model: input, size: 3}\n"
      "  cell: {model: iaf_psc_exp, size: 2}\n"
      "connections:\n"
      "  - {from: input, to: cell, rule: w.json, weight: 10 pA, delay: 1 ms}\n"
      "output: [cell]\n",
      "some/where/net.yaml", [&](const std::string& path) {
        asked = path;
        return WeightTable::dense(2, 3, {1, 0, 2, 0, -3, 4});
      });
  EXPECT_EQ(asked, "some/where/w.json");
  const NetworkProjection& projection = network.projections[0];
  EXPECT_THAT(projection.row_start, ElementsAre(0u, 1u, 2u, 4u));
  EXPECT_THAT(projection.target, ElementsAre(0u, 1u, 0u, 1u));
  EXPECT_THAT(projection.weight, ElementsAre(10.0, -30.0, 20.0, 40.0));
}

TEST(NetworkFile, AConnectionMayHoldItsTable) {
  const NetworkFile network = parse(
      "populations:\n"
      "  input: {model: input, size: 3}\n"
      "  cell: {model: iaf_psc_exp, size: 2}\n"
      "connections:\n"
      "  - {from: input, to: cell, rule: [[1, 0, 2], [0, -3, 4]], weight: 10 pA, delay: 1 ms}\n"
      "output: [cell]\n");
  const NetworkProjection& projection = network.projections[0];
  EXPECT_THAT(projection.row_start, ElementsAre(0u, 1u, 2u, 4u));
  EXPECT_THAT(projection.target, ElementsAre(0u, 1u, 0u, 1u));
  EXPECT_THAT(projection.weight, ElementsAre(10.0, -30.0, 20.0, 40.0));
}

TEST(NetworkFile, IsReadFromDiskWithItsWeightFile) {
  const TemporaryDirectory directory;
  std::ofstream(directory.path() / "w.json") << "[[1, 0], [0.5, -2]]\n";
  const std::string path = (directory.path() / "net.yaml").string();
  std::ofstream(path) << "populations:\n"
                         "  input: {model: input, size: 2}\n"
                         "  cell: {model: iaf_psc_delta, size: 2}\n"
                         "connections:\n"
                         "  - {from: input, to: cell, rule: w.json, weight: 3 mV, delay: 1 ms}\n"
                         "output: [cell]\n";
  const NetworkFile network = read_network_file(path);
  EXPECT_EQ(network.path, path);
  EXPECT_THAT(network.projections.at(0).row_start, ElementsAre(0u, 2u, 3u));
  EXPECT_THAT(network.projections[0].target, ElementsAre(0u, 1u, 1u));
  EXPECT_THAT(network.projections[0].weight, ElementsAre(3.0, 1.5, -6.0));
}

TEST(NetworkFile, TakesNumpysWeightFiles) {
  const TemporaryDirectory directory;
  write_npy(directory.path() / "w.npy", 2, 2, std::vector<double>{1, 0, 0.5, -2});
  const std::string path =
      directory.write("net.yaml",
                      "populations:\n"
                      "  input: {model: input, size: 2}\n"
                      "  cell: {model: iaf_psc_delta, size: 2}\n"
                      "connections:\n"
                      "  - {from: input, to: cell, rule: w.npy, weight: 3 mV, delay: 1 ms}\n"
                      "output: [cell]\n");
  const NetworkFile network = read_network_file(path);
  EXPECT_THAT(network.projections.at(0).target, ElementsAre(0u, 1u, 1u));
  EXPECT_THAT(network.projections[0].weight, ElementsAre(3.0, 1.5, -6.0));
}

}  // namespace
}  // namespace spikeloop::test
