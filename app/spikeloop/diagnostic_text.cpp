#include "diagnostic_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <ranges>
#include <string_view>

#include "output.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::app {

namespace {

bool continues(char c) {
  return (static_cast<unsigned char>(c) & 0xC0) == 0x80;  // inside a UTF-8 character
}

/// What stands around the place, when the line is too long for a screen. `at` counts bytes from 0.
std::string window(const std::string& line, std::size_t& at) {
  constexpr std::size_t kBefore = 60;
  constexpr std::size_t kLongest = 150;
  constexpr std::string_view kCut = "... ";
  if (line.size() <= kLongest || at > line.size()) {
    return line;
  }
  std::size_t begin = at > kBefore ? at - kBefore : 0;
  while (begin > 0 && continues(line[begin])) {
    --begin;
  }
  std::size_t end = std::min(line.size(), begin + kLongest);
  while (end < line.size() && continues(line[end])) {
    ++end;
  }
  at -= begin;
  at += begin > 0 ? kCut.size() : 0;
  return fmt::format("{}{}{}", begin > 0 ? kCut : "", line.substr(begin, end - begin),
                     end < line.size() ? " ..." : "");
}

/// The line of the file, and a caret below the place. YAML's columns count bytes.
std::string source_line(const Location& where) {
  if (where.line <= 0) {
    return "";
  }
  std::ifstream file(where.file);
  std::string line;
  for (int i = 0; i < where.line; ++i) {
    if (!std::getline(file, line)) {
      return "";
    }
  }
  line.erase(line.find_last_not_of("\r") + 1);
  std::size_t at = static_cast<std::size_t>(std::max(where.column, 1)) - 1;
  line = one_line(window(line, at));
  std::string text = fmt::format("{:>5} | {}\n", where.line, line);
  if (where.column > 0 && at <= line.size()) {
    const auto characters =
        std::count_if(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(at),
                      [](char c) { return !continues(c); });
    text += fmt::format("{:>{}}\n", "^", characters + 9);
  }
  return text;
}

}  // namespace

std::string text_of(const char* kind, const Diagnostic& diagnostic) {
  return fmt::format("{}: {}\n{}", kind, diagnostic.text(), source_line(diagnostic.where));
}

int print_diagnostics(const std::string& file, const Diagnostics& diagnostics) {
  constexpr std::size_t kMost = 20;
  Diagnostics errors_first = diagnostics;
  std::ranges::stable_partition(errors_first, &Diagnostic::is_error);
  for (const Diagnostic& diagnostic : errors_first | std::views::take(kMost)) {
    put(stderr, text_of(diagnostic.is_error() ? "error" : "warning", diagnostic));
  }
  if (diagnostics.size() > kMost) {
    put(stderr, fmt::format("... and {} more\n", diagnostics.size() - kMost));
  }
  const auto errors =
      static_cast<std::size_t>(std::ranges::count_if(diagnostics, &Diagnostic::is_error));
  const auto first = std::ranges::find_if(diagnostics, &Diagnostic::is_error);
  put(stderr, fmt::format("spikeloop: {}: {}{}\n", file, count_of(errors, "error"),
                          errors == diagnostics.size()
                              ? ""
                              : ", " + count_of(diagnostics.size() - errors, "warning")));
  return first == diagnostics.end() ? 0 : first->exit_code;
}

}  // namespace spikeloop::app
