// What our programs say of their sections, before anything runs: `PROGRAM --check-section`.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <set>
#include <string>

#include "process_group.hpp"
#include "spikeloop/launch/check.hpp"

namespace spikeloop::launch {

/// What programs are started with, so that they find our other programs, and name the lines of the
/// file that the user wrote.
std::map<std::string, std::string> origin_environment(const std::string& file);

class SectionChecks {
 public:
  struct Places {
    std::string effective_file;
    std::string directory;  ///< where the programs will run
    int kept;               ///< as ProgramStart::kept
    bool experiment;        ///< that the caller has checked: its parts need no check of their own
  };
  /// Starts all of them. The references must outlive it.
  SectionChecks(ProcessGroup& group, const MusicFile& file, const Places& places);

  /// Waits until all have answered, or `stopped()`: then it ends them. One that does not answer is
  /// an error.
  Diagnostics run(const std::function<bool()>& stopped);

 private:
  struct Section {
    std::string label;
    Process* process = nullptr;
    Diagnostics diagnostics{};
    std::string last_error{};  ///< a line without "error: " before it
  };

  void start(const MusicSection& section, const Places& places);
  Diagnostic diagnostic(const Section& section, std::string text, int exit_code) const;
  void take(Section& section, const OutputLine& line) const;
  /// What its end means.
  static void finish(Section& section);
  void drop_repeated(Section& section);

  ProcessGroup& group_;
  const MusicFile& file_;
  std::deque<Section> sections_;  // handlers refer to them
  std::set<std::string> said_;    ///< of places in the file
};

}  // namespace spikeloop::launch
