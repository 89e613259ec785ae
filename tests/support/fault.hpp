// What a message says, apart from its wording.
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace spikeloop::test {

/// [begin, end) of `text` is not a part of a longer word or number.
inline bool is_whole(std::string_view text, std::size_t begin, std::size_t end) {
  const auto in_word = [&](std::size_t at, std::string_view signs) {
    return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 ||
                                signs.find(text[at]) != std::string_view::npos);
  };
  const bool begun_before = in_word(begin, "_") && in_word(begin - 1, "_.-");
  const bool goes_on =
      in_word(end - 1, "_") && (in_word(end, "_") || (in_word(end, ".") && in_word(end + 1, "")));
  return !begun_before && !goes_on;
}

/// The pieces of a pattern between "...", without the spaces around.
inline std::vector<std::string> pieces_of(std::string_view pattern) {
  constexpr std::string_view kAny = "...";
  std::vector<std::string> pieces;
  for (bool last = false; !last;) {
    const auto any = pattern.find(kAny);
    last = any == std::string_view::npos;
    std::string piece(pattern.substr(0, any));
    if (!last) {
      piece.erase(piece.find_last_not_of(' ') + 1);
      pattern.remove_prefix(any + kAny.size());
    }
    if (!pieces.empty()) {
      piece.erase(0, std::min(piece.size(), piece.find_first_not_of(' ')));
    }
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

/// The first piece that is missing: the text begins with the first and ends with the last, and
/// those in between follow in one line. Empty: none.
inline std::string missing_piece(std::string_view text, const std::vector<std::string>& pieces) {
  std::size_t end = 0;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const std::string& piece = pieces[i];
    const bool last = i + 1 == pieces.size();
    if (last && piece.empty()) {
      break;
    }
    const std::size_t least =
        last && text.size() > end + piece.size() && i > 0 ? text.size() - piece.size() : end;
    auto at = text.find(piece, least);
    while (at != std::string_view::npos && !is_whole(text, at, at + piece.size())) {
      at = text.find(piece, at + 1);
    }
    const bool found = at != std::string_view::npos && (i > 0 || at == 0) &&
                       text.substr(end, at - end).find('\n') == std::string_view::npos;
    end = at + piece.size();
    if (!found || (last && end != text.size())) {
      return piece;
    }
  }
  return {};
}

/// A message like `pattern`, in which "..." stands for any wording; at its begin and end for other
/// lines, too. Words and numbers are whole.
MATCHER_P(Fault, pattern, std::string(negation ? "is not like: " : "is like: ") + pattern) {
  const auto pieces = pieces_of(pattern);
  std::string_view text = arg;
  std::string missing = missing_piece(text, pieces);
  while (!missing.empty() && pieces.front().empty() && text.find('\n') != std::string_view::npos) {
    text.remove_prefix(text.find('\n') + 1);
    missing = missing_piece(text, pieces);
  }
  *result_listener << (missing.empty() ? "" : "without: " + missing);
  return missing.empty();
}

}  // namespace spikeloop::test
