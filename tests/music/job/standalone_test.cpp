// The programs without MUSIC.
#include "job.hpp"
#include "tests/support/fault.hpp"

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
        "nef_encoder", "linear_readout_decoder", "linear_decoder", "spikeloop-node"}) {
    const auto outcome = run_program(name, {"--help"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(outcome.out.rfind(name + ": ", 0), 0u) << outcome.out;
    for (const char* words : {"stoptime", "barrier=false", "binary=", "Ports:", "Example:"}) {
      EXPECT_TRUE(outcome.says(words)) << name << " " << words;
    }
  }
  EXPECT_TRUE(run_program("rate_encoder", {"--help"}).says("rate_max"));
  EXPECT_TRUE(run_program("nef_encoder", {"--help"}).says("Defaults in dialect ma: preset=ma.\n"));
  EXPECT_TRUE(
      run_program("nef_encoder", {"--help"}).says("neuron_resolution is the older spelling of"));
  EXPECT_TRUE(run_program("linear_readout_decoder", {"--help"}).says("readout_weights.dat"));
  EXPECT_TRUE(run_program("connect_adapter", {"--help"}).says("connection_weights.dat"));
  EXPECT_TRUE(run_program("cont_cont_adapter", {"--help"}).says("weights.json"));
  EXPECT_TRUE(run_program("discretize_adapter", {"--help"}).says("grid_positions.json"));
}

Outcome check_section(const std::string& name, const std::string& keys,
                      const std::string& connection = "a.out -> b.in [3]") {
  const TemporaryDirectory directory;
  const std::string file =
      directory.write("loop.music", "[a]\nnp=1\nbinary=x\n[b]\nnp=1\nbinary=" + name + "\n" + keys +
                                        "\n" + connection + "\n");
  auto outcome = run_program(name, {"--check-section", file, "b"},
                             {{"SPIKELOOP_FILE", file}, {"SPIKELOOP_FILE_NAME", "mine.music"}});
  EXPECT_EQ(outcome.out, "");
  return outcome;
}

TEST(Standalone, ChecksASectionWithoutStartingAnything) {
  EXPECT_EQ(check_section("rate_encoder", "rate_max=10").exit_code, 0);
  EXPECT_EQ(check_section("rate_encoder", "rate_max=10").err, "");
  EXPECT_EQ(check_section("rate_encoder", "rate_max=ten").exit_code, 2);
  EXPECT_EQ(check_section("rate_encoder", "rate_max=ten").err.rfind("error: mine.music:7:1: ", 0),
            0U);
  EXPECT_EQ(check_section("rate_encoder", "rate_mix=10").err,
            "warning: mine.music:7:1: unknown key 'rate_mix'; did you mean 'rate_max'?; it is "
            "ignored [SL0103]\n");
  EXPECT_EQ(check_section("rate_encoder", "rate_mix=10\nstrict=true").exit_code, 2);
  EXPECT_THAT(check_section("rate_encoder", "", "a.out -> b.inn [3]").err,
              Fault("error: mine.music:8:1: 'b' ... 'inn' ... 'in' ... [SL0302]\n"));
  EXPECT_TRUE(
      check_section("rate_encoder", "", "a.out -> b.in").says("write  a.out -> b.in [100]"));
  EXPECT_TRUE(
      check_section("connect_adapter", "strict=true", "a.out -> b.in [3]\nb.out -> a.in [2]")
          .says("connection_weights.dat"));
}

TEST(Standalone, ChecksASectionOfAFileThatIsThere) {
  EXPECT_EQ(run_program("rate_encoder", {"--check-section", "loop.music"}).err,
            "rate_encoder: --check-section takes a file and a section; write  rate_encoder "
            "--check-section FILE.music LABEL\n");
  const auto missing = run_program("rate_encoder", {"--check-section", "/nowhere.music", "b"});
  EXPECT_EQ(missing.exit_code, 4);
  EXPECT_THAT(missing.err, Fault("error: cannot open '/nowhere.music': ... [SL0109]\n"));
  const TemporaryDirectory directory;
  const std::string file = directory.write("loop.music", "[a]\nnp=1\nbinary=x\n");
  EXPECT_TRUE(run_program("rate_encoder", {"--check-section", file, "c"})
                  .says("there is no section '[c]'"));
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
