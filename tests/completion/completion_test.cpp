// What the shells themselves suggest after `source <(spikeloop completion SHELL)`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>

#include "tests/launch/launcher.hpp"

namespace spikeloop::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

using Words = std::vector<std::string>;

Words lines_of(const std::string& text) {
  Words lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    lines.push_back(line);
  }
  return lines;
}

bool has_shell(const std::string& shell) {
  Command which;
  which.arguments = {"sh", "-c", "command -v " + shell};
  return run(which).exit_code == 0;
}

/// A folder with files to complete.
class Folder {
 public:
  Folder() {
    for (const char* name : {"loop.music", "my loop.music", "network.yaml", "notes.txt"}) {
      directory_.write(name, "");
    }
    std::filesystem::create_directory(directory_.path() / "runs");
  }
  std::string path() const { return directory_.path().string(); }
  std::string write(const std::string& name, const std::string& text) const {
    return directory_.write(name, text);
  }

  Command shell(const Words& arguments) const {
    Command command;
    command.arguments = arguments;
    command.directory = path();
    const std::string programs = std::filesystem::path(SPIKELOOP_PROGRAM).parent_path();
    command.environment = {{"PATH", programs + ":" + std::getenv("PATH")},
                           {"HOME", path()},
                           {"SPIKELOOP_PLUGIN_PATH", ""}};
    return command;
  }

  /// The words of a line as bash cuts them; the last one is being typed.
  Words bash(const Words& words, const std::string& plugins = "") const {
    Words arguments{"bash", "--norc", "-c",
                    "source <(spikeloop completion bash) && complete -p spikeloop >&2 && "
                    "COMP_WORDS=(\"$@\") COMP_CWORD=$(($# - 1)) && _spikeloop && "
                    "printf '%s\\n' \"${COMPREPLY[@]}\"",
                    "bash"};
    arguments.insert(arguments.end(), words.begin(), words.end());
    Command command = shell(arguments);
    command.environment["SPIKELOOP_PLUGIN_PATH"] = plugins;
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.err, "complete -F _spikeloop spikeloop\n");
    Words suggested = lines_of(outcome.out);
    std::erase(suggested, "");
    return suggested;
  }

 private:
  TemporaryDirectory directory_;
};

TEST(BashCompletion, CompletesCommands) {
  const Folder folder;
  EXPECT_THAT(folder.bash({"spikeloop", "ru"}), ElementsAre("run"));
  EXPECT_THAT(folder.bash({"spikeloop", "d"}), ElementsAre("describe", "doctor"));
  EXPECT_THAT(folder.bash({"spikeloop", ""}), Contains("completion"));
  EXPECT_THAT(folder.bash({"spikeloop", "--v"}), ElementsAre("--version"));
}

TEST(BashCompletion, CompletesOptionsAndTheirValues) {
  const Folder folder;
  EXPECT_THAT(folder.bash({"spikeloop", "run", "--du"}), ElementsAre("--duration"));
  EXPECT_THAT(folder.bash({"spikeloop", "run", "loop.music", "--ro"}),
              ElementsAre("--robot", "--robot-arg", "--ros", "--ros-args", "--roscore"));
  EXPECT_THAT(folder.bash({"spikeloop", "run", "--duration", ""}), IsEmpty());
  EXPECT_THAT(folder.bash({"spikeloop", "run", "--out", "r"}), ElementsAre("runs"));
  EXPECT_THAT(folder.bash({"spikeloop", "run", "--out", "=", "r"}), ElementsAre("runs"));
  EXPECT_THAT(folder.bash({"spikeloop", "run", "--out", "="}), Contains("runs"));
  EXPECT_THAT(folder.bash({"spikeloop", "completion", "z"}), ElementsAre("zsh"));
}

TEST(BashCompletion, LeavesOutWhatIsForNobody) {
  EXPECT_THAT(Folder().bash({"spikeloop", "doctor", "--"}), ElementsAre("--help", "--json"));
}

TEST(BashCompletion, CompletesFiles) {
  const Folder folder;
  const auto files = ElementsAre("loop.music", "my loop.music", "network.yaml", "runs");
  EXPECT_THAT(folder.bash({"spikeloop", "run", ""}), files);
  EXPECT_THAT(folder.bash({"spikeloop", "check", "--strict", ""}), files);
  EXPECT_THAT(folder.bash({"spikeloop", "run", "--seed", "3", "lo"}), ElementsAre("loop.music"));
  EXPECT_THAT(folder.bash({"spikeloop", "run", "loop.music", ""}), IsEmpty());
}

TEST(BashCompletion, CompletesNodeClasses) {
  const Folder folder;
  EXPECT_THAT(folder.bash({"spikeloop", "describe", "rate_"}),
              ElementsAre("rate_encoder", "rate_window"));
  EXPECT_THAT(folder.bash({"spikeloop", "fit", "nef"}), ElementsAre("nef_encoder"));
  const TemporaryDirectory plugins;
  std::filesystem::create_symlink(GOOD_PLUGIN, plugins.path() / "gain.so");
  EXPECT_THAT(folder.bash({"spikeloop", "describe", "ga"}, plugins.path()), ElementsAre("gain"));
  plugins.write("wrong.so", "");
  EXPECT_THAT(folder.bash({"spikeloop", "describe", "rate_e"}, plugins.path()),
              ElementsAre("rate_encoder"));
}

TEST(BashCompletion, KnowsEveryOptionOfEveryCommand) {
  const Folder folder;
  const Words commands = folder.bash({"spikeloop", ""});
  EXPECT_GE(commands.size(), 7U);
  for (const std::string& command : commands) {
    const Outcome help = run(launcher({command, "--help"}));
    const std::regex option("\n  (?:-.,)?(--[a-z-]+)");
    std::set<std::string> in_help;
    for (std::sregex_iterator match(help.out.begin(), help.out.end(), option), end; match != end;
         ++match) {
      in_help.insert((*match)[1]);
    }
    const Words suggested = folder.bash({"spikeloop", command, "--"});
    EXPECT_EQ(std::set<std::string>(suggested.begin(), suggested.end()), in_help) << command;
  }
}

TEST(ZshCompletion, CompletesInAZsh) {
  ASSERT_TRUE(has_shell("zsh")) << "scripts/install-dependencies test  installs it";
  const Folder folder;
  // A zsh in a pseudo-terminal; each line waits for what the other one shows.
  const std::string script =
      folder.write("drive.zsh",
                   "zmodload zsh/zpty || exit 9\n"
                   "zpty inner zsh -f -i\n"
                   "zpty -w inner 'PS1=; autoload -U compinit; compinit -u -D; "
                   "source <(spikeloop completion zsh); print REA\"\"DY'\n"
                   "zpty -r -m inner seen '*READY*' || exit 8\n"
                   "zpty -w -n inner $'spikeloop '$1$'\\t\\t'\n"
                   "zpty -r -m inner seen \"*$2*\" && print found $2\n");
  const auto sees = [&](const std::string& typed, const std::string& suggested) {
    Command command = folder.shell({"zsh", "-f", script, typed, suggested});
    command.timeout = std::chrono::seconds(20);
    return run(command).out;
  };
  EXPECT_EQ(sees("ru", "spikeloop run"), "found spikeloop run\n");
  EXPECT_EQ(sees("describe rate_", "rate_window"), "found rate_window\n");
  EXPECT_EQ(sees("run --du", "--duration"), "found --duration\n");
  EXPECT_EQ(sees("run ", "network.yaml"), "found network.yaml\n");
}

TEST(Completion, SaysWhichShellsItKnows) {
  const Outcome outcome = run(launcher({"completion", "tcsh"}));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err,
            "spikeloop: SHELL: tcsh not in {bash,zsh}; see spikeloop completion --help\n");
  EXPECT_EQ(run(launcher({"completion"})).err,
            "spikeloop: SHELL is required; see spikeloop completion --help\n");
}

}  // namespace
}  // namespace spikeloop::test
