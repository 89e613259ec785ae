// `spikeloop describe`, and the page that is made of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/launch/launcher.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

using testing::HasSubstr;
using testing::Not;

Outcome describe(std::vector<std::string> arguments, const std::string& plugins = "") {
  arguments.insert(arguments.begin(), "describe");
  Command command = launcher(arguments);
  command.environment["SPIKELOOP_PLUGIN_PATH"] = plugins;
  return run(command);
}

/// A directory with one good plug-in.
class Plugins {
 public:
  Plugins() { std::filesystem::create_symlink(GOOD_PLUGIN, directory_.path() / "gain.so"); }
  std::string path() const { return directory_.path().string(); }

 private:
  TemporaryDirectory directory_;
};

TEST(Describe, ListsClassesInGroups) {
  const Outcome outcome = describe({});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const std::string& text = outcome.out;
  const auto encoders = text.find("Encoders: continuous signals in, spikes out\n");
  const auto decoders = text.find("Decoders: spikes in, continuous signals out\n");
  const auto adapters = text.find("Adapters: signals to signals, spikes to spikes\n");
  ASSERT_NE(adapters, std::string::npos) << text;
  EXPECT_LT(encoders, text.find("\n  rate_encoder "));
  EXPECT_LT(text.find("\n  rate_encoder "), decoders);
  EXPECT_LT(decoders, text.find("\n  linear_readout "));
  EXPECT_LT(text.find("\n  linear_readout "), adapters);
  EXPECT_LT(adapters, text.find("\n  connect "));
  EXPECT_THAT(
      text,
      HasSubstr(
          "  Encodes each value as regular spikes with a rate that is linear in the value\n"));
}

TEST(Describe, ShowsPortsAndParametersOfAClass) {
  const Outcome outcome = describe({"rate_encoder"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out,
              testing::StartsWith(
                  "rate_encoder: Encodes each value as regular spikes with a rate that is linear "
                  "in the value\n"
                  "Source: Weidel et al. 2016, eq. 1\n\n"
                  "Ports:\n"
                  "  in   input   continuous  any width      Values in [-1, 1], one per channel\n"
                  "  out  output  spikes      as wide as in  One neuron per channel\n\n"
                  "Parameters:\n"
                  "  rate_min "));
  EXPECT_THAT(outcome.out,
              HasSubstr("\nIn an experiment: rate_encoder: {node: rate_encoder}. In a .music "
                        "file: binary=rate_encoder, or binary=spikeloop-node with "
                        "node=rate_encoder. np processes and threads= in each share "
                        "its output channels.\n"));
  const Outcome connect = describe({"connect"});
  EXPECT_THAT(connect.out, HasSubstr("binary=connect_adapter or cont_cont_adapter, or "));
  EXPECT_THAT(connect.out, HasSubstr("Write for weights uniform (1 / inputs), uniform:0.01, "));
  EXPECT_THAT(describe({"discretize"}).out, HasSubstr("Write for grid a file: JSON, "));
}

TEST(Describe, KnowsPlugins) {
  const Plugins plugins;
  EXPECT_THAT(describe({}, plugins.path()).out,
              testing::ContainsRegex("\n  gain +output = gain \\* input, plus a spike"));
  const Outcome outcome = describe({"gain"}, plugins.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\nIn an experiment: gain: {node: gain}. In a .music file: "
                                     "binary=spikeloop-node with node=gain.\n"));
  EXPECT_THAT(outcome.out, HasSubstr("\nSource: " + plugins.path() + "/gain.so\n"));
  EXPECT_THAT(describe({"--markdown"}, plugins.path()).out, Not(HasSubstr("gain * input")));
  const Outcome nowhere = describe({}, "/nowhere");
  EXPECT_EQ(nowhere.exit_code, 4);
  EXPECT_THAT(nowhere.err,
              Fault("spikeloop: cannot read plug-in directory '/nowhere': ... [SL0109]\n"));
}

TEST(Describe, SuggestsANode) {
  const Outcome outcome = describe({"rate_encodr"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err,
            "spikeloop: unknown node class 'rate_encodr'; did you mean 'rate_encoder'?\n");
  EXPECT_EQ(describe({"ros_sensr_adapter"}).err,
            "spikeloop: unknown node class 'ros_sensr_adapter'; did you mean "
            "'ros_sensor_adapter'?\n");
  EXPECT_THAT(describe({"zzzzzzzzzzz"}).err,
              testing::StartsWith("spikeloop: unknown node class 'zzzzzzzzzzz'; known: argmax, "));
}

TEST(Describe, PointsToAProgramsHelp) {
  const Outcome outcome = describe({"ros_sensor_adapter"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err,
            "spikeloop: 'ros_sensor_adapter' is a program, not a node class; see "
            "ros_sensor_adapter --help\n");
  EXPECT_EQ(describe({"connect_adapter"}).err,
            "spikeloop: 'connect_adapter' is a program, not a node class; see connect_adapter "
            "--help, or spikeloop describe connect for what it runs\n");
  EXPECT_THAT(describe({"spikeloop-robot"}).err, HasSubstr("see spikeloop-robot --help\n"));
}

TEST(Describe, SaysWhichArgumentsDoNotGoTogether) {
  EXPECT_EQ(describe({"--markdown", "connect"}).err,
            "spikeloop: NODE excludes --markdown; see spikeloop describe --help\n");
  EXPECT_EQ(describe({""}).err,
            "spikeloop: NODE: the name of the node class is empty; write one; see spikeloop "
            "describe --help\n");
}

TEST(Describe, ThePageOfAllClassesIsUpToDate) {
  std::ifstream file(SPIKELOOP_DOCS "/nodes.md", std::ios::binary);
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  EXPECT_TRUE(describe({"--markdown"}).out == page)
      << "docs/nodes.md is old; renew it with\n"
         "  build/release/bin/spikeloop describe --markdown > docs/nodes.md";
}

}  // namespace
}  // namespace spikeloop::test
