#include "spikeloop/core/error.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <numeric>
#include <system_error>

namespace spikeloop {

namespace {

std::string lower_case(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

// Damerau-Levenshtein distance (optimal string alignment): a swap of neighbours counts as one slip.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substitution = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, substitution});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before_last[j - 2] + 1);
      }
    }
    before_last = last;
    last = row;
  }
  return last[b.size()];
}

std::string with_place(const Location& where, std::string_view message) {
  const std::string place = where.text();
  return place.empty() ? std::string(message) : fmt::format("{}: {}", place, message);
}

}  // namespace

std::string one_line(std::string_view text) {
  constexpr std::size_t kBegin = 1500;
  constexpr std::size_t kEnd = 500;
  std::string line(text);
  if (line.size() > kBegin + kEnd) {
    line.replace(kBegin, line.size() - kBegin - kEnd, " ... ");  // the remedy is at the end
  }
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      c = c == '\n' || c == '\r' || c == '\t' ? ' ' : '?';
    }
  }
  return line;
}

std::string Location::text() const {
  if (line == 0) {
    return file;
  }
  const std::string place =
      column == 0 ? fmt::format("{}", line) : fmt::format("{}:{}", line, column);
  return file.empty() ? "line " + place : fmt::format("{}:{}", file, place);
}

Error::Error(const Location& where, std::string_view message)
    : std::runtime_error(one_line(with_place(where, message))),
      where_(where.text().empty() ? nullptr : std::make_shared<const Location>(where)) {}

FileError::FileError(std::string_view action, std::string_view path, int error_number)
    : Error(with_code(Code::no_access, "cannot {} '{}': {}", action, path,
                      std::generic_category().message(error_number))) {}

NodeError::NodeError(std::string_view node, std::string_view message)
    : Error(with_code(Code::node_failed, "node '{}': {}", node, message)) {}

void require_code_may_run(std::string_view what) {
  if (std::getenv(kNoCode) != nullptr) {
    throw NotRun(fmt::format("not checked: {} is code, which --no-code does not run", what));
  }
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  const std::string wanted = lower_case(word);
  std::string best;
  // A third of the letters may be wrong, at least one.
  std::size_t best_distance = std::max<std::size_t>(1, wanted.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(wanted, lower_case(candidate));
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates) {
  const std::string best = nearest(word, candidates);
  if (!best.empty()) {
    return fmt::format("; did you mean '{}'?", best);
  }
  return candidates.empty() ? std::string()
                            : fmt::format("; known: {}", fmt::join(candidates, ", "));
}

std::string unresolved_host(std::string_view host, std::string_view reason) {
  return fmt::format(
      "the host name '{0}' cannot be resolved ({1}); add the line '{2} {0}' to /etc/hosts", host,
      reason, host == "localhost" ? "127.0.0.1" : "IP-ADDRESS");
}

}  // namespace spikeloop
