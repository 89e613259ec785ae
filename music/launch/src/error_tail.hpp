// What of a program's output says why it ended.
#pragma once

#include <string>

#include "spikeloop/launch/mpirun.hpp"

namespace spikeloop::launch {

class ErrorTail {
 public:
  void take(const OutputLine& line);
  /// The reason that roslaunch gave, else the last line that is not blank, of standard error if
  /// there was any; without colours.
  const std::string& text() const;

 private:
  std::string reason_;
  std::string last_out_;
  std::string last_error_;
};

}  // namespace spikeloop::launch
