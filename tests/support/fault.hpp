// What a message says, apart from its wording.
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

namespace spikeloop::test {

/// Where `value` ends in `text`, or npos: not as a part of a longer word or number.
inline std::size_t end_of_value(std::string_view text, std::string_view value) {
  const auto in_word = [&](std::size_t at, std::string_view signs) {
    return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 ||
                                signs.find(text[at]) != std::string_view::npos);
  };
  for (auto at = text.find(value); at != std::string_view::npos; at = text.find(value, at + 1)) {
    const auto end = at + value.size();
    const bool begun_before = in_word(at, "_") && in_word(at - 1, "_.-");
    const bool goes_on =
        in_word(end - 1, "_") && (in_word(end, "_") || (in_word(end, ".") && in_word(end + 1, "")));
    if (!begun_before && !goes_on) {
      return end;
    }
  }
  return std::string_view::npos;
}

/// A message like `pattern`, in which "..." stands for any wording: it begins with what is before
/// the first, holds the values in between, and ends with what is behind the last.
MATCHER_P(Fault, pattern, std::string(negation ? "is not like: " : "is like: ") + pattern) {
  constexpr std::string_view kAny = "...";
  const std::string wanted = pattern;
  std::string_view text = arg;
  for (std::size_t at = 0; at <= wanted.size();) {
    const auto any = std::min(wanted.find(kAny, at), wanted.size());
    std::string_view piece = std::string_view(wanted).substr(at, any - at);
    const bool first = at == 0;
    const bool last = any == wanted.size();
    if (!first) {
      piece.remove_prefix(std::min(piece.size(), piece.find_first_not_of(' ')));
    }
    if (!last) {
      piece = piece.substr(0, piece.find_last_not_of(' ') + 1);
    }
    const auto end = first ? (text.starts_with(piece) ? piece.size() : std::string_view::npos)
                           : end_of_value(text, piece);
    if (end == std::string_view::npos || (last && !text.ends_with(piece)) ||
        (first && last && end != text.size())) {
      *result_listener << "without: " << std::string(piece);
      return false;
    }
    text.remove_prefix(end);
    at = any + kAny.size();
  }
  return true;
}

}  // namespace spikeloop::test
