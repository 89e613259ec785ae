// Jobs of raw_music programs and ours, and the logs of the former.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/music_job.hpp"

namespace spikeloop::test {

/// "event K SECONDS ID": K is the first tick whose step can use it.
struct LoggedEvent {
  int tick = 0;
  double seconds = 0;
  int id = 0;
  bool operator==(const LoggedEvent&) const = default;
};
inline void PrintTo(const LoggedEvent& event, std::ostream* out) {
  *out << "tick " << event.tick << ": " << event.id << " at " << event.seconds;
}

/// A job in a directory of its own.
class Job {
 public:
  /// A section of a raw_music program.
  Job& raw(const std::string& label, const std::string& keys = "") {
    return section(label,
                   std::string("binary=") + RAW_MUSIC + "\n  log=" + label + ".log\n" + keys);
  }
  /// A section of one of our programs, in so many processes.
  Job& ours(const std::string& label, const std::string& program, const std::string& keys = "",
            int processes = 1) {
    return section(label, std::string("binary=") + PROGRAMS + "/" + program + "\n" + keys,
                   processes);
  }
  /// A section of a node class of the test plug-in.
  Job& node(const std::string& label, const std::string& node_class, const std::string& keys = "") {
    return ours(label, "spikeloop-node",
                "node=" + node_class + "\nplugin=" + TEST_NODES + "\n" + keys);
  }
  Job& connect(const std::string& line) {
    connections_ += line + "\n";
    return *this;
  }
  Job& global(const std::string& line) {
    globals_ += line + "\n";
    return *this;
  }

  /// "FILE:LINE:1" of the first line with these words.
  std::string place(const std::string& words) const {
    const auto all = text();
    const auto before = all.substr(0, all.find(words));
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    return (directory.path() / "job.music").string() + ":" + std::to_string(line) + ":1";
  }

  std::string text() const { return globals_ + sections_ + connections_; }
  Command command() const { return music_job(directory, processes_, text()); }
  Outcome run() const { return test::run(command()); }

  std::vector<LoggedEvent> events(const std::string& label) const {
    std::vector<LoggedEvent> result;
    std::istringstream log(directory.read(label + ".log"));
    for (std::string line; std::getline(log, line);) {
      std::istringstream words(line);
      std::string kind;
      LoggedEvent event;
      if (words >> kind >> event.tick >> event.seconds >> event.id && kind == "event") {
        result.push_back(event);
      }
    }
    return result;
  }
  /// values_in before each tick.
  std::vector<std::vector<double>> values(const std::string& label) const {
    std::vector<std::vector<double>> result;
    std::istringstream log(directory.read(label + ".log"));
    for (std::string line; std::getline(log, line);) {
      std::istringstream words(line);
      std::string kind;
      int tick = 0;
      if (words >> kind >> tick && kind == "value") {
        result.emplace_back();
        for (std::string word; words >> word;) {
          result.back().push_back(std::stod(word));
        }
      }
    }
    return result;
  }

  TemporaryDirectory directory;

 private:
  Job& section(const std::string& label, const std::string& keys, int processes = 1) {
    sections_ += "[" + label + "]\n  np=" + std::to_string(processes) + "\n  " + keys + "\n";
    processes_ += processes;
    return *this;
  }

  std::string globals_;
  std::string sections_;
  std::string connections_;
  int processes_ = 0;
};

/// Everything went well and nothing stayed behind.
inline void expect_clean(const Outcome& outcome) {
  EXPECT_FALSE(outcome.timed_out) << outcome.text();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0);
}

}  // namespace spikeloop::test
