#include "planned_input.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "spikeloop/core/code.hpp"

namespace spikeloop {

bool settle(std::uint32_t& width, std::uint32_t other) {
  const bool changes = width == 0 && other != 0;
  if (changes) {
    width = other;
  }
  return changes;
}

PlannedInput::PlannedInput(GraphPlan& plan, const GraphDescription& description, std::size_t begin)
    : plan_(plan), description_(description), begin_(begin), end_(begin + 1) {
  while (end_ < plan.connections.size() && connection(end_).combination != Combination::alone) {
    ++end_;
  }
}

bool PlannedInput::adds() const {
  return end_ - begin_ > 1 && connection(begin_ + 1).combination == Combination::added;
}

/// Of the known senders.
std::uint64_t PlannedInput::total() const {
  std::uint64_t sum = 0;
  for (std::size_t i = begin_; i < end_; ++i) {
    sum += count(i);
  }
  return sum;
}

/// "scan.out[0:50]"
std::string PlannedInput::text(std::size_t i) const {
  return plan_.text(connection(i).from) + connection(i).channels.text();
}

std::string PlannedInput::text() const {
  std::string all = text(begin_);
  for (std::size_t i = begin_ + 1; i < end_; ++i) {
    all += ", " + text(i);
  }
  return all;
}

bool PlannedInput::settle_input() {
  std::uint32_t& to = width_of(connection(begin_).to);
  bool changed = false;
  for (std::size_t i = begin_; i < end_; ++i) {
    changed |= settle(sender(i), description_.connections[i].sender_width);
  }
  changed |= is_plain() && settle(sender(begin_), written());
  changed |= settle(to, written());
  changed |= is_plain() && settle(sender(begin_), to);
  bool is_known = total() <= std::numeric_limits<std::uint32_t>::max();
  for (std::size_t i = begin_; i < end_; ++i) {
    changed |= adds() && settle(to, count(i));
    is_known = is_known && count(i) != 0;
  }
  return (is_known && settle(to, static_cast<std::uint32_t>(total()))) || changed;
}

/// Of a sum all are as wide as the input; else one unknown sender has the channels that are left.
bool PlannedInput::settle_senders() {
  const std::uint32_t to = width_of(connection(begin_).to);
  bool changed = false;
  std::size_t unknown = end_;
  for (std::size_t i = begin_; i < end_; ++i) {
    if (count(i) != 0) {
      continue;
    }
    if (adds()) {
      changed |= connection(i).channels.all() && settle(sender(i), to);
    } else if (unknown != end_ || !connection(i).channels.all()) {
      return false;
    } else {
      unknown = i;
    }
  }
  const std::uint64_t known = total();
  return (unknown != end_ && to > known &&
          settle(sender(unknown), to - static_cast<std::uint32_t>(known))) ||
         changed;
}

void PlannedInput::check_widths(const ErrorHandler& report) const {
  for (std::size_t i = begin_; i < end_; ++i) {
    if (!check_sender(i, report)) {
      return;
    }
  }
  const std::uint32_t to = plan_.port(connection(begin_).to).width;
  const std::size_t last = adds() ? end_ : begin_ + 1;  // a row is compared as a whole
  for (std::size_t i = begin_; i < last; ++i) {
    const std::uint64_t from = adds() ? count(i) : total();
    if (from != to || (written() != 0 && written() != to)) {
      report(ConfigurationError(
          connection(i).where,
          with_code(Code::widths_differ, "widths differ: '{}' has {} channel{}, '{}' has {}{}",
                    adds() ? text(i) : text(), from, from == 1 ? "" : "s",
                    plan_.text(connection(i).to), to,
                    written() != 0 ? fmt::format(", the connection says [{}]", written()) : "")));
      return;
    }
  }
}

/// Whether its width is known, and it has the channels.
bool PlannedInput::check_sender(std::size_t i, const ErrorHandler& report) const {
  const ConnectionDescription& from = description_.connections[i];
  const Location& where = from.where_from.text().empty() ? from.where : from.where_from;
  const std::string name = plan_.text(connection(i).from);
  const ChannelRange& channels = connection(i).channels;
  const std::uint32_t width = sender(i);
  if (width == 0 && end_ - begin_ == 1 && channels.all()) {
    report(ConfigurationError(
        from.where,
        with_code(
            Code::unknown_width,
            "the width of '{}' -> '{}' is unknown; write the number of channels, for example [10]",
            name, plan_.text(connection(i).to))));
  } else if (width == 0) {
    report(ConfigurationError(
        where, with_code(Code::unknown_width,
                         "the width of '{0}' is unknown; write it in a connection of all its "
                         "channels:  {0} -> NODE [10]",
                         name)));
  } else if (std::max(channels.begin + 1, channels.end) > width) {
    report(ConfigurationError(
        where, with_code(Code::out_of_bounds,
                         "'{}' has {} channel{}, counted from 0, and {} is not within them; write "
                         "for example  [0:{}]",
                         name, width, width == 1 ? "" : "s", channels.text(), width)));
  } else {
    return true;
  }
  return false;
}

}  // namespace spikeloop
