// A job as a user of an older family starts it: files written as theirs are, our programs in PATH,
// stand-ins for their scripts beside the file.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/music_job.hpp"

namespace spikeloop::test {

inline void expect_clean(const Outcome& outcome) {
  EXPECT_FALSE(outcome.timed_out) << outcome.text();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0);
}

/// Every line with a warning, without what stands before the word. What is said of a robot's stops
/// is left out: a busy machine can cause one; the commands show how many there were.
inline std::vector<std::string> warnings(const Outcome& outcome) {
  std::vector<std::string> found;
  std::istringstream lines(outcome.text());
  for (std::string line; std::getline(lines, line);) {
    const auto place = line.find("warning: ");
    if (place != std::string::npos && line.find("warning: the robot is ") == std::string::npos) {
      found.push_back(line.substr(place));
    }
  }
  return found;
}

class OlderJob {
 public:
  /// `example` is where the file lies below the directory; scripts lie beside it.
  explicit OlderJob(const std::string& example = ".") : example_(example) {
    std::filesystem::create_directories(here());
  }

  std::filesystem::path here() const { return directory.path() / example_; }
  /// The script of this name, relative to the example.
  void stand_in(const std::string& name) const {
    std::filesystem::create_symlink(SPIKELOOP_STAND_IN, here() / name);
  }
  /// One of our programs where an older file expects its own, relative to the example.
  void program(const std::string& name, const std::string& place) const {
    std::filesystem::create_symlink(std::string(SPIKELOOP_BIN) + "/" + name,
                                    (here() / place).lexically_normal());
  }
  void write(const std::string& name, const std::string& text) const {
    directory.write(example_ + "/" + name, text);
  }
  /// `spikeloop run old.music`, typed in the example's directory.
  Command command(const std::string& text, const std::vector<std::string>& more = {}) const {
    write("old.music", text);
    Command made;
    made.arguments = {std::string(SPIKELOOP_BIN) + "/spikeloop", "run",    "old.music", "--out",
                      (directory.path() / "run").string(),       "--force"};
    made.arguments.insert(made.arguments.end(), more.begin(), more.end());
    made.environment = mpi_environment(directory);
    made.environment["PATH"] = std::string(SPIKELOOP_BIN) + ":" + getenv("PATH");
    made.directory = here().string();
    made.timeout = std::chrono::seconds(120);
    return made;
  }

  TemporaryDirectory directory;

 private:
  std::string example_;
};

}  // namespace spikeloop::test
