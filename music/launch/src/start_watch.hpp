// Who is missed while a job starts: before MPI knows a program, mpirun does not always notice its
// end, or does not say whose it was.
#pragma once

#include <chrono>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace spikeloop::launch {

class StartWatch {
 public:
  using Clock = std::chrono::steady_clock;

  StartWatch(std::vector<std::string> labels, Clock::time_point now);

  /// Whether it is time to look again: often at first, then once a second.
  bool is_due(Clock::time_point now) const;
  /// Takes who lives, as living_sections() says.
  void take(const std::map<std::string, bool>& living, Clock::time_point now);

  /// Whether one that has lived has been missed for 5 s.
  bool one_has_gone(Clock::time_point now) const;
  /// Who was never seen, else who was the first to go. Nobody, as long as none has been seen.
  std::vector<std::string> missed() const;
  /// All others; true: is stopped.
  std::map<std::string, bool> living() const;

 private:
  std::vector<std::string> labels_;
  Clock::time_point began_;
  Clock::time_point looked_{};
  Clock::time_point complete_;  ///< when all lived that had been seen
  std::set<std::string> seen_;
  std::vector<std::string> first_gone_;
  std::map<std::string, bool> newest_;
};

}  // namespace spikeloop::launch
