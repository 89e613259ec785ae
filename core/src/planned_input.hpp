// The connections into one input of a plan: one, or several that are combined.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "spikeloop/core/graph_plan.hpp"

namespace spikeloop {

/// Sets a width that was unknown; says whether anything changed.
bool settle(std::uint32_t& width, std::uint32_t other);

class PlannedInput {
 public:
  /// Of the connections that begin with this one.
  PlannedInput(GraphPlan& plan, const GraphDescription& description, std::size_t begin);

  /// Where the next input's connections begin.
  std::size_t end() const { return end_; }
  /// From what is written and from the senders; of one whole output also back to the sender. Says
  /// whether anything changed.
  bool settle_input();
  /// From the input back to the senders that nothing else settles.
  bool settle_senders();
  /// Unknown widths, channels that a sender does not have, widths that differ: the first of them.
  void check_widths(const ErrorHandler& report) const;

 private:
  const PlannedConnection& connection(std::size_t i) const { return plan_.connections[i]; }
  std::uint32_t& width_of(const PlannedPortAddress& address) const {
    return plan_.elements[address.element].ports[address.port].width;
  }
  std::uint32_t& sender(std::size_t i) const { return width_of(connection(i).from); }
  std::uint32_t count(std::size_t i) const { return connection(i).channels.count(sender(i)); }
  std::uint32_t written() const { return description_.connections[begin_].width; }
  bool is_plain() const { return end_ - begin_ == 1 && connection(begin_).channels.all(); }
  bool adds() const;
  std::uint64_t total() const;
  std::string text(std::size_t i) const;
  std::string text() const;
  bool check_sender(std::size_t i, const ErrorHandler& report) const;

  GraphPlan& plan_;
  const GraphDescription& description_;
  std::size_t begin_;
  std::size_t end_;
};

}  // namespace spikeloop
