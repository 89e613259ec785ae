#include "spikeloop/core/registry.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <unistd.h>

#include "support.hpp"

namespace spikeloop {
namespace {

using test::Fault;
using test::FunctionSink;
using test::FunctionSource;
using test::message_of;

std::string plugin_path(const std::string& name) {
  return std::string(PLUGIN_DIRECTORY) + "/" + name;
}

WeightTable uniform_weights(const WrittenValue&) {
  return WeightTable::uniform();
}

Parameters gain_parameters(const NodeClass& node_class, const WrittenValues& written) {
  return resolve(node_class.description.parameters, written, uniform_weights);
}

TEST(Registry, FindsWhatWasAddedAndSuggestsOtherwise) {
  Registry registry;
  NodeClass node_class = test::function_class({}, [](const Step&) {});
  registry.add(node_class);
  EXPECT_TRUE(registry.contains("function"));
  EXPECT_EQ(message_of<ConfigurationError>([&] { registry.find("functon"); }),
            "unknown node class 'functon'; did you mean 'function'? [SL0401]");
  EXPECT_EQ(message_of<ConfigurationError>([&] { registry.add(node_class); }),
            "there is already a node class 'function'; give the second one another name [SL0107]");
}

class Plugin : public testing::Test {
 protected:
  Plugin() { registry_.load_plugin(plugin_path("good_plugin.so")); }
  Registry registry_;
};

TEST_F(Plugin, DescribesItselfAcrossTheBorder) {
  const NodeDescription& description = registry_.find("gain").description;
  EXPECT_EQ(description.text, "output = gain * input, plus a spike for every negative value");
  ASSERT_EQ(description.ports.size(), 3U);
  EXPECT_EQ(description.ports[2].kind, PortKind::spikes);
  EXPECT_EQ(description.ports[1].width.kind, WidthRule::Kind::same_as);
  ASSERT_EQ(description.parameters.size(), 3U);
  EXPECT_EQ(description.parameters[0].default_value, "2");
  EXPECT_EQ(description.parameters[0].maximum, 10);
  EXPECT_EQ(description.parameters[1].choices,
            (std::vector<std::string>{"plain", "fail", "miscount"}));
}

TEST_F(Plugin, RunsInAGraph) {
  const NodeClass& gain = registry_.find("gain");
  FunctionSource source(PortKind::signal, 2, [](const Step& step) {
    if (step.interval().begin == 0) {
      step.signal_output().values()[0] = 3;
      step.signal_output().values()[1] = -1;
      step.signal_output().commit();
    }
  });
  std::vector<double> values;
  FunctionSink sink(PortKind::signal, 2, [&](const Step& step) {
    values.assign(step.signal_input().values.begin(), step.signal_input().values.end());
  });
  std::vector<Spike> spikes;
  FunctionSink spike_sink(PortKind::spikes, 2, [&](const Step& step) {
    const auto in = step.spike_input().spikes;
    spikes.insert(spikes.end(), in.begin(), in.end());
  });
  GraphDescription description;
  description.tick = 1000;
  description.nodes = {{"gain", &gain, gain_parameters(gain, {{"gain", {"-4", {}}}}), {}}};
  description.sources = {{"source", &source}};
  description.sinks = {{"sink", &sink}, {"spikes", &spike_sink}};
  description.connections = {{"source", "gain"}, {"gain.out", "sink"}, {"gain.negative", "spikes"}};
  Graph graph(description);
  graph.step();
  graph.step();
  EXPECT_EQ(values, (std::vector<double>{-12, 4}));
  ASSERT_EQ(spikes.size(), 1U);
  EXPECT_EQ(spikes[0].time_ns, 1000);
  EXPECT_EQ(spikes[0].channel, 1);
  // The uniform weights took the ports' widths: 2 x 2 entries of 1/2.
  EXPECT_EQ(graph.counters()[0].name, "gain.revisions");
  EXPECT_EQ(graph.counters()[0].value, 1U);
  EXPECT_EQ(graph.counters()[1].value, 2U);
}

TEST_F(Plugin, ItsErrorsComeBackAsSentences) {
  const NodeClass& gain = registry_.find("gain");
  NodeSetup setup{"gain", 1, gain_parameters(gain, {}), {5, 5, 5}};
  const std::string whose = " (plug-in '" + plugin_path("good_plugin.so") + "')";
  EXPECT_EQ(message_of<ConfigurationError>([&] { gain.create(setup); }),
            "at most 4 channels" + whose + " [SL0402]");
  setup.widths = {1, 1, 1};
  setup.parameters = gain_parameters(gain, {{"mode", {"fail", {}}}});
  const auto node = gain.create(setup);
  const spikeloop_step data{};
  EXPECT_EQ(message_of<std::runtime_error>([&] { node->step(Step(data)); }),
            "asked to fail" + whose);
  setup.parameters = gain_parameters(gain, {{"mode", {"miscount", {}}}});
  EXPECT_EQ(message_of<std::runtime_error>([&] { gain.create(setup)->counters(); }),
            "asked to miscount" + whose);
}

TEST_F(Plugin, TheSameNameTwiceIsRefused) {
  const std::string path = plugin_path("good_plugin.so");
  EXPECT_THAT(message_of<ConfigurationError>([&] { registry_.load_plugin(path); }),
              Fault("plug-in '" + path + "': there is already a node class 'gain' ... [SL0107]"));
}

TEST(PluginFile, MayStandInTheWorkingDirectory) {
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(PLUGIN_DIRECTORY);
  Registry registry;
  EXPECT_EQ(registry.load_plugin("good_plugin.so"), (std::vector<std::string>{"gain"}));
  std::filesystem::current_path(before);
}

// Two sources of plug-ins, the one that is loaded elsewhere among them, are linked into this
// program.
TEST(LinkedPlugins, AreNodeClassesLikeOthers) {
  Registry registry;
  auto names = registry.add_linked_plugins();
  std::ranges::sort(names);
  EXPECT_EQ(names, (std::vector<std::string>{"gain", "offset", "scale"}));
  const NodeClass& gain = registry.find("gain");
  const NodeSetup setup{"gain", 1, gain_parameters(gain, {{"mode", {"fail", {}}}}), {1, 1, 1}};
  const auto node = gain.create(setup);
  const spikeloop_step data{};
  EXPECT_EQ(message_of<std::runtime_error>([&] { node->step(Step(data)); }), "asked to fail");
}

TEST(LinkedPlugins, TheSameNameTwiceIsRefused) {
  Registry registry;
  registry.load_plugin(plugin_path("good_plugin.so"));
  EXPECT_THAT(message_of<ConfigurationError>([&] { registry.add_linked_plugins(); }),
              Fault("... 'gain' ... [SL0107]"));
}

std::string refusal(const std::string& name) {
  Registry registry;
  const std::string text =
      message_of<ConfigurationError>([&] { registry.load_plugin(plugin_path(name)); });
  return text.substr(std::min(text.size(), text.find(": ") + 2));
}

TEST(BrokenPlugin, IsRefusedBeforeAnythingInItIsCalled) {
  EXPECT_EQ(refusal("old_plugin.so"),
            "was built for plug-in ABI 0, this Spikeloop has 2; rebuild it [SL0402]");
  EXPECT_EQ(refusal("short_plugin.so"),
            "its entry structure has 16 bytes, this Spikeloop needs 40; rebuild it [SL0402]");
  EXPECT_EQ(refusal("foreign_plugin.so"),
            "was built for 'm68k-amiga', this machine is '" SPIKELOOP_BUILD
            "'; rebuild it [SL0402]");
  EXPECT_EQ(
      refusal("empty_plugin.so"),
      "is not a Spikeloop plug-in (it has no spikeloop_plugin_entry); write SPIKELOOP_PLUGIN(...) "
      "in one of its sources [SL0402]");
  EXPECT_TRUE(refusal("missing.so").starts_with("cannot be loaded: "));
}

TEST(PluginPath, LoadsEveryLibraryOfItsDirectories) {
  const auto directory =
      std::filesystem::temp_directory_path() /
      ("spikeloop_plugins_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
       "_" + std::to_string(static_cast<long>(getpid())));
  std::filesystem::create_directories(directory);
  std::filesystem::copy_file(plugin_path("good_plugin.so"), directory / "gain.so");
  std::ofstream(directory / "README.txt") << "not a library";
  Registry registry;
  EXPECT_EQ(registry.load_plugin_path(":" + directory.string() + ":"),
            (std::vector<std::string>{"gain"}));
  std::filesystem::remove_all(directory);
  EXPECT_THAT(message_of<FileError>([&] { registry.load_plugin_path("/nowhere/at/all"); }),
              Fault("cannot read plug-in directory '/nowhere/at/all': ... [SL0109]"));
}

}  // namespace
}  // namespace spikeloop
