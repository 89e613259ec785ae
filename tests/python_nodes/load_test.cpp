// *.py files as plug-ins: what is described of their nodes, and why a file is refused.
#include <signal.h>

#include <filesystem>

#include "python_file.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::testing {
namespace {

using test::Fault;
using ::testing::ElementsAre;
using ::testing::StartsWith;

TEST(PythonFileTest, DescribesItsNodes) {
  const NodeClass encoder = class_in(ENCODER_FILE, "my_rate_encoder");
  const NodeDescription& description = encoder.description;
  EXPECT_EQ(description.text, "Turns each value into regular spikes at a proportional rate");
  EXPECT_EQ(description.source, ENCODER_FILE);
  ASSERT_EQ(description.ports.size(), 2U);
  EXPECT_EQ(description.ports[0].name, "in");
  EXPECT_EQ(description.ports[0].kind, PortKind::signal);
  EXPECT_EQ(description.ports[0].width.kind, WidthRule::Kind::free);
  EXPECT_EQ(description.ports[1].kind, PortKind::spikes);
  EXPECT_EQ(description.ports[1].direction, Direction::output);
  EXPECT_EQ(description.ports[1].width.kind, WidthRule::Kind::same_as);
  EXPECT_EQ(description.ports[1].width.value, 0U);
  EXPECT_EQ(description.ports[1].text, "One neuron a channel");
  ASSERT_EQ(description.parameters.size(), 2U);
  EXPECT_EQ(description.parameters[1].name, "rate_max");
  EXPECT_EQ(description.parameters[1].unit, "Hz");
  EXPECT_EQ(description.parameters[1].default_value, "100");
  EXPECT_EQ(description.parameters[1].minimum, 0);
  EXPECT_EQ(description.parameters[1].text, "Firing rate at the input value 1");
}

TEST(PythonFileTest, ParametersOfAllTypes) {
  const PythonFile file(
      "@spikeloop.node(inputs={'in': spikeloop.Signal(width=3)}, name='it', tau=0.03,\n"
      "    count=spikeloop.Parameter(2, type=int, minimum=1, maximum=9), loud=True, word='hello',\n"
      "    mode=spikeloop.Parameter('a', choices=['a', 'b']), "
      "weights=spikeloop.Weights('uniform'),\n"
      "    needed=spikeloop.Parameter(unit='s'))\n"
      "def something(step, tau, count, loud, word, mode, weights, needed): ...\n");
  const auto parameters = file.node_class().description.parameters;
  ASSERT_EQ(parameters.size(), 7U);
  EXPECT_EQ(parameters[0].default_value, "0.03");
  EXPECT_EQ(parameters[1].type, ParameterType::integer);
  EXPECT_EQ(parameters[1].maximum, 9);
  EXPECT_EQ(parameters[2].type, ParameterType::boolean);
  EXPECT_EQ(parameters[2].default_value, "true");
  EXPECT_EQ(parameters[3].type, ParameterType::text);
  EXPECT_EQ(parameters[4].type, ParameterType::choice);
  EXPECT_THAT(parameters[4].choices, ElementsAre("a", "b"));
  EXPECT_EQ(parameters[5].type, ParameterType::weights);
  EXPECT_EQ(parameters[5].default_value, "uniform");
  EXPECT_FALSE(parameters[6].default_value);
}

TEST(PythonFileTest, SaysWhatIsWrongWithIt) {
  const auto refusal = [](const std::string& text) { return PythonFile(text).refusal(); };
  EXPECT_EQ(refusal("x = (1\n"), "nodes.py:3: SyntaxError: '(' was never closed [SL0402]");
  EXPECT_EQ(refusal("\nimport nothing_here\n"),
            "nodes.py:4: ModuleNotFoundError: No module named 'nothing_here' [SL0402]");
  EXPECT_EQ(refusal("x = 1\n"),
            "plug-in 'nodes.py': defines no node; write @spikeloop.node before a class or a "
            "function [SL0402]");
  const std::string node = "@spikeloop.node(inputs={'in': 'signal'})\ndef it(step): ...\n";
  EXPECT_EQ(refusal(node + "\n" + node),
            "plug-in 'nodes.py': lines 3 and 6 both define the node 'it'; give one another name, "
            "with @spikeloop.node(name=...) [SL0402]");
  EXPECT_THAT(refusal("raise SystemExit('enough')\n"),
              Fault("nodes.py:3: SystemExit: enough ... [SL0402]"));
  EXPECT_EQ(refusal("raise KeyboardInterrupt\n"), "nodes.py:3: KeyboardInterrupt [SL0402]");
  EXPECT_THAT(refusal("x = '\xff'\n"), StartsWith("nodes.py:3: SyntaxError: (unicode error)"));
  EXPECT_EQ(refusal("@spikeloop.node\nclass It:\n    pass\n"),
            "nodes.py:3: class It has no step; write  def step(self, step): ... [SL0402]");
}

TEST(PythonFileTest, AFileThatCannotBeReadOrIsNamedAsAModule) {
  use_python_library();
  Registry registry;
  EXPECT_THAT(message_of([&] { registry.load_plugin("/nowhere/x.py"); }),
              Fault("plug-in '/nowhere/x.py': ... [SL0402]"));
  EXPECT_EQ(message_of([&] { registry.load_plugin("random.py"); }),
            "plug-in 'random.py': has the name of Python's own module 'random', which it would "
            "hide; rename it, for example to random_node.py [SL0402]");
}

TEST(PythonFileTest, TheLoaderIsLookedForBesideTheProgram) {
  setenv("SPIKELOOP_LIBRARY_PATH", ":/nowhere:", 1);
  Registry registry;
  const std::string message = message_of([&] { registry.load_plugin("x.py"); });
  const auto programs = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  EXPECT_EQ(message,
            "plug-in 'x.py': *.py files need libspikeloop_python_nodes.so, which is not in "
            "/nowhere, " +
                programs.string() + ", " + programs.parent_path().string() +
                "/lib/spikeloop; install Spikeloop with it, or write its directory into "
                "SPIKELOOP_LIBRARY_PATH [SL0402]");
}

TEST(PythonFileTest, ALoaderOfAnotherKindIsRefused) {
  const test::TemporaryDirectory directory;
  const std::string library = directory.write("libspikeloop_python_nodes.so", "no library");
  setenv("SPIKELOOP_LIBRARY_PATH", directory.path().c_str(), 1);
  Registry registry;
  EXPECT_THAT(message_of([&] { registry.load_plugin("x.py"); }),
              StartsWith("plug-in '" + library + "': cannot be loaded: "));
}

TEST(PythonFileTest, TheSameNameTwiceIsRefused) {
  use_python_library();
  Registry registry;
  EXPECT_THAT(registry.load_plugin(ENCODER_FILE), ElementsAre("my_rate_encoder"));
  EXPECT_THAT(message_of([&] { registry.load_plugin(ENCODER_FILE); }),
              Fault("... 'my_rate_encoder' ... [SL0107] ..."));
}

TEST(PythonFileTest, ADirectoryMayHoldFilesThatAreNoNodes) {
  use_python_library();
  const test::TemporaryDirectory directory;
  directory.write("plain.py", "raise SystemExit('I am a script')\n");
  directory.write("helper.py", "FACTOR = 3\n");
  directory.write("nodes_a.py",
                  "from spikeloop import node\nimport helper\n"
                  "@node(outputs={'out': 'signal'}, factor=helper.FACTOR)\n"
                  "def thrice(step, factor): ...\n");
  directory.write("nodes_b.py",
                  "import spikeloop as sl\nfrom nodes_a import thrice\n"
                  "@sl.node(outputs={'out': 'signal'})\ndef nothing(step): ...\n");
  Registry registry;
  EXPECT_THAT(registry.load_plugin_path(directory.path().string()),
              ElementsAre("thrice", "nothing"));
  EXPECT_EQ(registry.find("thrice").description.parameters[0].default_value, "3");
}

TEST(PythonFileTest, FilesOfOneNameInTwoDirectoriesAreTwo) {
  use_python_library();
  const PythonFile first("@spikeloop.node(outputs={'o': 'signal'})\ndef one(step): ...\n");
  const PythonFile second("@spikeloop.node(outputs={'o': 'signal'})\ndef two(step): ...\n");
  Registry registry;
  EXPECT_THAT(registry.load_plugin(first.path()), ElementsAre("one"));
  EXPECT_THAT(registry.load_plugin(second.path()), ElementsAre("two"));
}

TEST(PythonFileTest, CtrlCStaysTheProgramsOwn) {
  struct sigaction before {};
  struct sigaction after {};
  signal(SIGINT, SIG_DFL);
  sigaction(SIGINT, nullptr, &before);
  class_in(ENCODER_FILE, "my_rate_encoder");
  sigaction(SIGINT, nullptr, &after);
  EXPECT_EQ(before.sa_handler, after.sa_handler);
}

}  // namespace
}  // namespace spikeloop::testing
