// `spikeloop` as a user starts it, on jobs of test programs.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/child.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::test {

/// The launcher with these arguments. The working directory is not that of the job.
inline Command launcher(const std::vector<std::string>& arguments) {
  Command command;
  command.arguments = {SPIKELOOP_PROGRAM};
  command.arguments.insert(command.arguments.end(), arguments.begin(), arguments.end());
  command.environment = {{"SPIKELOOP_STATUS", ""}, {"SPIKELOOP_OUT", ""}};
  command.directory = "/";
  return command;
}

/// A directory with two programs, a -> b, of which `keys` say more. Ours are known by their names.
class TwoPrograms {
 public:
  explicit TwoPrograms(const std::string& a_keys = "", const std::string& b_keys = "",
                       const std::string& b_binary = "./spikeloop-network") {
    for (const char* name : {"spikeloop-network", "poisson_encoder", "foreign"}) {
      std::filesystem::create_symlink(SPIKELOOP_TEST_PROGRAM, directory_.path() / name);
    }
    file_ = directory_.write(
        "two.music", "stoptime=0.5\n[a]\nnp=1\nbinary=./poisson_encoder\nname=a\ninput=no\n" +
                         a_keys + "\n[b]\nnp=1\nbinary=" + b_binary + "\nname=b\noutput=no\n" +
                         b_keys + "\na.out -> b.in [1]\n");
  }

  const std::string& file() const { return file_; }
  std::string folder() const { return (directory_.path() / "run").string(); }
  const TemporaryDirectory& directory() const { return directory_; }

  /// `spikeloop run FILE --out FOLDER ...`
  Command command(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"run", file_, "--out", folder()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return launcher(arguments);
  }
  /// The same, typed into a shell with `what` behind it.
  Command in_shell(const std::string& what, const std::vector<std::string>& more = {}) const {
    Command shell = command(more);
    std::string line;
    for (const std::string& argument : shell.arguments) {
      line += "'" + argument + "' ";
    }
    shell.arguments = {"bash", "-c", line + what};
    return shell;
  }
  nlohmann::json summary() const {
    return nlohmann::json::parse(directory_.read("run/summary.json"), nullptr, false);
  }

 private:
  TemporaryDirectory directory_;
  std::string file_;
};

inline std::string last_line(std::string text) {
  while (text.ends_with('\n')) {
    text.pop_back();
  }
  return text.substr(text.rfind('\n') + 1);
}

/// Where a running launcher keeps sockets, session files and shared memory; empty when no program
/// of its job runs.
inline std::string scratch_of(const Child& child) {
  const std::string name = "SPIKELOOP_STATUS=";
  for (const pid_t process : child.family()) {
    std::ifstream file("/proc/" + std::to_string(process) + "/environ", std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto place = text.find(name);
    if (place != std::string::npos) {
      const std::filesystem::path socket = text.substr(place + name.size()).c_str();
      return socket.parent_path();
    }
  }
  return "";
}

}  // namespace spikeloop::test
