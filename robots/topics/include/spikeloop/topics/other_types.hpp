// Reports of topics that carry another type than that of the subscription.
#pragma once

#include <cstdint>
#include <list>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "spikeloop/core/time.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::topics {

/// Collects the reports of `Subscription::refuse` until the loop logs them. Thread-safe.
class OtherTypes {
 public:
  void add(const OtherType& other);
  /// Returns and removes the oldest report, with the publisher's node in its text. A report waits
  /// until the name of the node is known, for 500 ms at most. Each text is returned once.
  std::optional<OtherType> take();
  std::uint64_t count() const;  ///< reports added, repeated ones included

 private:
  mutable std::mutex mutex_;
  std::list<std::pair<OtherType, TimeNs>> waiting_;  ///< with the wall time of add()
  std::set<std::string> taken_;
  std::uint64_t count_ = 0;
};

}  // namespace spikeloop::topics
