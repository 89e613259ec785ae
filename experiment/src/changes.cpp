#include "spikeloop/experiment/changes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"

namespace spikeloop::experiment {
namespace {

constexpr std::uint64_t kLargest = std::uint64_t{64} << 20;

template <typename Number>
bool read_number(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

/// "1500000000,encoder.rate_max,80"
bool read_row(std::string_view row, Change& change) {
  const auto first = row.find(',');
  const auto last = row.rfind(',');
  if (first == std::string_view::npos || last == first) {
    return false;
  }
  const std::string_view name = row.substr(first + 1, last - first - 1);
  const auto dot = name.find('.');
  if (dot == std::string_view::npos) {
    return false;
  }
  change.node = name.substr(0, dot);
  change.parameter = name.substr(dot + 1);
  return read_number(row.substr(0, first), change.time) &&
         read_number(row.substr(last + 1), change.value);
}

}  // namespace

std::string to_text(const Change& change) {
  return fmt::format("{},{}.{},{}", change.time, change.node, change.parameter, change.value);
}

std::vector<Change> read_changes(const std::string& path) {
  std::string text = read_file(path, "changes", kLargest);
  // The last line is incomplete while a run writes it, and if the disk was full.
  text.erase(text.rfind('\n') + 1);
  std::istringstream lines(std::move(text));
  std::vector<Change> changes;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    Change change;
    if (line == kChangesHead) {
      continue;  // another process may have written its row before
    }
    if (read_row(line, change)) {
      changes.push_back(std::move(change));
      continue;
    }
    throw ConfigurationError(
        {path, number, 0},
        with_code(Code::syntax, "this is not a row  {}, as a run writes it", kChangesHead));
  }
  // Each process of the run wrote its own in order.
  std::ranges::stable_sort(changes, {}, &Change::time);
  return changes;
}

}  // namespace spikeloop::experiment
