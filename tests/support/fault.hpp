// What a message says, apart from its wording.
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

namespace spikeloop::test {

/// Whether `value` is in `text`, and not only as a part of a longer word or number.
inline bool holds(std::string_view text, std::string_view value) {
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
      return true;
    }
  }
  return false;
}

/// A message like `pattern`, in which "..." stands for any wording: it begins with what is before
/// the first, ends with what is behind the last, and holds every value in between, in any order.
MATCHER_P(Fault, pattern, std::string(negation ? "is not like: " : "is like: ") + pattern) {
  constexpr std::string_view kAny = "...";
  const std::string wanted = pattern;
  std::string_view rest = wanted;
  std::string_view text = arg;
  const auto missing = [&](std::string_view piece) {
    *result_listener << "without: " << std::string(piece);
    return false;
  };
  auto any = rest.find(kAny);
  const std::string_view begin = rest.substr(0, any);
  if (any == std::string_view::npos ? text != begin : !text.starts_with(begin)) {
    return missing(begin);
  }
  text.remove_prefix(begin.size());
  while (any != std::string_view::npos) {
    rest.remove_prefix(any + kAny.size());
    any = rest.find(kAny);
    const bool last = any == std::string_view::npos;
    std::string_view piece = rest.substr(0, any);
    piece.remove_prefix(std::min(piece.size(), piece.find_first_not_of(' ')));
    if (!last) {
      piece = piece.substr(0, piece.find_last_not_of(' ') + 1);
    }
    if (!piece.empty() && (last ? !text.ends_with(piece) : !holds(text, piece))) {
      return missing(piece);
    }
  }
  return true;
}

}  // namespace spikeloop::test
