// Finds repeated messages in a library's log.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <set>
#include <string>
#include <string_view>

namespace spikeloop::topics {

/// Finds the first message of each kind. Messages that differ in numbers alone are of one kind: a
/// library reports the same of every port and of every attempt.
class MessageKinds {
 public:
  bool is_new(std::string_view text) {
    std::string kind;
    std::ranges::copy_if(text, std::back_inserter(kind), [](char c) { return c < '0' || c > '9'; });
    return known_.size() < kMost && known_.insert(std::move(kind)).second;
  }
  void clear() { known_.clear(); }

 private:
  static constexpr std::size_t kMost = 1000;
  std::set<std::string> known_;
};

}  // namespace spikeloop::topics
