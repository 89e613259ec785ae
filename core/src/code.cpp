#include "spikeloop/core/code.hpp"

#include <algorithm>

namespace spikeloop {
namespace {

constexpr std::string_view kBegin = " [SL";
constexpr std::size_t kLength = std::string_view(" [SL0103]").size();

/// Where a code begins, at `from` or behind it. Texts may be long: what a user wrote is in them.
std::size_t find_code(std::string_view text, std::size_t from = 0) {
  for (auto at = text.find(kBegin, from); at != text.npos; at = text.find(kBegin, at + 1)) {
    const std::string_view digits = text.substr(at + kBegin.size(), 4);
    if (text.substr(at).size() >= kLength && text[at + kLength - 1] == ']' &&
        std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; })) {
      return at;
    }
  }
  return text.npos;
}

}  // namespace

std::string code_text(Code code) {
  return fmt::format("SL{:04}", static_cast<int>(code));
}

std::string with_code(Code code, std::string_view message) {
  std::string text(message);
  for (auto at = find_code(text); at != text.npos; at = find_code(text, at)) {
    text.erase(at, kLength);
  }
  return fmt::format("{} [{}]", text, code_text(code));
}

std::string lengthened(std::string_view message, std::string_view more) {
  std::string text(message);
  const bool ends_with_code =
      text.size() >= kLength && find_code(text, text.size() - kLength) != text.npos;
  return text.insert(ends_with_code ? text.size() - kLength : text.size(), more);
}

}  // namespace spikeloop
