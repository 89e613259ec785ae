// The programs without MUSIC.
#include "job.hpp"

namespace spikeloop::test {
namespace {

Outcome run_program(const std::string& name, const std::vector<std::string>& arguments = {},
                    const std::map<std::string, std::string>& environment = {}) {
  Command command;
  command.arguments = {std::string(PROGRAMS) + "/" + name};
  command.arguments.insert(command.arguments.end(), arguments.begin(), arguments.end());
  command.environment = environment;
  return test::run(command);
}

TEST(Standalone, EveryNameHasItsHelp) {
  for (const std::string name :
       {"rate_encoder", "poisson_encoder", "connect_adapter", "cont_cont_adapter",
        "threshold_adapter", "sigmoid_adapter", "argmax_adapter", "discretize_adapter",
        "linear_readout_decoder", "linear_decoder", "spikeloop-node"}) {
    const auto outcome = run_program(name, {"--help"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(outcome.out.rfind(name + ": ", 0), 0u) << outcome.out;
    for (const char* words : {"stoptime", "barrier=false", "binary=", "Ports:", "Example:"}) {
      EXPECT_TRUE(outcome.says(words)) << name << " " << words;
    }
  }
  EXPECT_TRUE(run_program("rate_encoder", {"--help"}).says("rate_max"));
  EXPECT_TRUE(run_program("linear_readout_decoder", {"--help"}).says("readout_weights.dat"));
  EXPECT_TRUE(run_program("connect_adapter", {"--help"}).says("connection_weights.dat"));
  EXPECT_TRUE(run_program("cont_cont_adapter", {"--help"}).says("weights.json"));
  EXPECT_TRUE(run_program("discretize_adapter", {"--help"}).says("grid_positions.json"));
}

TEST(Standalone, SaysItsVersion) {
  const auto outcome = run_program("poisson_encoder", {"--version"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.out.rfind("poisson_encoder (Spikeloop) ", 0), 0u);
}

TEST(Standalone, ListsNodeClassesAlsoOfPlugins) {
  const auto plugins = std::filesystem::path(TEST_NODES).parent_path().string();
  EXPECT_TRUE(run_program("spikeloop-node", {"--list"}).says("rate_encoder "));
  const TemporaryDirectory directory;
  std::filesystem::copy(TEST_NODES, directory.path() / "nodes.so");
  const auto outcome = run_program("spikeloop-node", {"--list"},
                                   {{"SPIKELOOP_PLUGIN_PATH", directory.path().string()}});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(outcome.says("edge_spiker ")) << outcome.text();
}

TEST(Standalone, ABrokenPluginIsAnErrorInOneLine) {
  const TemporaryDirectory directory;
  directory.write("broken.so", "no library");
  const auto outcome = run_program("spikeloop-node", {"--list"},
                                   {{"SPIKELOOP_PLUGIN_PATH", directory.path().string()}});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err.rfind("spikeloop-node: ", 0), 0u) << outcome.err;
  EXPECT_NE(outcome.err.find("broken.so"), std::string::npos);
}

TEST(Standalone, AnUnknownArgumentIsAnError) {
  const auto outcome = run_program("rate_encoder", {"--hlp"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err, "rate_encoder: unknown argument '--hlp'; did you mean '--help'?\n");
  EXPECT_EQ(outcome.out, "");
}

TEST(Standalone, SaysHowToStartIt) {
  const auto outcome = run_program("rate_encoder");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err,
            "rate_encoder: is started by MUSIC; write a section with binary=rate_encoder into "
            "FILE.music and run  spikeloop run FILE.music  or  mpirun -np N music FILE.music; see  "
            "rate_encoder --help\n");
}

}  // namespace
}  // namespace spikeloop::test
