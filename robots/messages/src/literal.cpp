#include "literal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <stdexcept>
#include <type_traits>

#include "spikeloop/messages/number.hpp"

namespace spikeloop::messages {
namespace {

bool is_mark(char c) {
  return c == '"' || c == '\'';
}

/// The first of `wanted` outside of quotation marks; npos when there is none.
/// A mark within a word is an apostrophe: a text begins behind a blank, a bracket, ',' or '='.
std::size_t find_unquoted(std::string_view text, char wanted, bool& open) {
  char mark = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (mark != 0) {
      if (c == '\\') {
        ++i;
      } else if (c == mark) {
        mark = 0;
      }
    } else if (c == wanted) {
      open = false;
      return i;
    } else if (is_mark(c) &&
               (i == 0 || std::string_view(" \t[,=").find(text[i - 1]) != std::string_view::npos)) {
      mark = c;
    }
  }
  open = mark != 0;
  return std::string_view::npos;
}

template <typename Whole>
double whole_number(std::string_view text) {
  Whole value = 0;
  const bool hexadecimal = text.starts_with("0x") && text.size() > 2 && text[2] != '-';
  const char* const begin = text.data() + (hexadecimal ? 2 : 0);
  const auto [end, error] =
      std::from_chars(begin, text.data() + text.size(), value, hexadecimal ? 16 : 10);
  if (error == std::errc{} && end == text.data() + text.size()) {
    return static_cast<double>(value);
  }
  double number = 0;
  const auto [stop, wrong] =
      std::from_chars(begin, text.data() + text.size(), number,
                      hexadecimal ? std::chars_format::hex : std::chars_format::general);
  if ((wrong == std::errc{} || wrong == std::errc::result_out_of_range) && !text.empty() &&
      stop == text.data() + text.size()) {
    throw std::invalid_argument(
        fmt::format("which {}int{} cannot hold; write a whole number from {} to {}",
                    std::is_signed_v<Whole> ? "" : "u", 8 * sizeof(Whole),
                    std::numeric_limits<Whole>::min(), std::numeric_limits<Whole>::max()));
  }
  throw std::invalid_argument("which is not a number");
}

double truth(std::string_view text) {
  if (text == "true" || text == "True" || text == "1") {
    return 1.0;
  }
  if (text == "false" || text == "False" || text == "0") {
    return 0.0;
  }
  throw std::invalid_argument("which is neither true nor false");
}

double real_number(std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) {
    throw std::invalid_argument("which is not a number");
  }
  return number;
}

}  // namespace

std::string_view trim(std::string_view text) {
  constexpr std::string_view kAround = " \t\r";
  const auto first = text.find_first_not_of(kAround);
  return first == std::string_view::npos
             ? std::string_view{}
             : text.substr(first, text.find_last_not_of(kAround) - first + 1);
}

double parse_number_literal(std::string_view text, Primitive primitive) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') {
    text.remove_prefix(1);
  }
  return with_number(primitive, [&]<typename T>(T /*type*/) {
    if constexpr (std::is_same_v<T, bool>) {
      return truth(text);
    } else if constexpr (std::is_floating_point_v<T>) {
      return real_number(text);
    } else {
      return whole_number<T>(text);
    }
  });
}

std::string parse_text_literal(std::string_view text) {
  if (text.empty() || !is_mark(text.front())) {
    return std::string(text);
  }
  const char mark = text.front();
  std::string value;
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (text[i] == mark) {
      if (i + 1 != text.size()) {
        break;
      }
      return value;
    }
    if (text[i] == '\\' && i + 1 < text.size() && (is_mark(text[i + 1]) || text[i + 1] == '\\')) {
      ++i;
    }
    value += text[i];
  }
  throw std::invalid_argument("which does not end with its quotation mark");
}

std::vector<std::string_view> split_list_literal(std::string_view text) {
  if (text.size() < 2 || text.front() != '[' || text.back() != ']') {
    throw std::invalid_argument("which is not a list; write [value, value]");
  }
  std::string_view rest = text.substr(1, text.size() - 2);
  std::vector<std::string_view> elements;
  while (!trim(rest).empty()) {
    bool open = false;
    const auto comma = find_unquoted(rest, ',', open);
    if (open) {
      throw std::invalid_argument("which lacks a closing quotation mark");
    }
    elements.push_back(trim(rest.substr(0, comma)));
    rest = comma == std::string_view::npos ? std::string_view{} : rest.substr(comma + 1);
  }
  return elements;
}

std::size_t find_comment(std::string_view line) {
  bool open = false;
  const auto found = find_unquoted(line, '#', open);
  if (found != std::string_view::npos) {
    return found;
  }
  // An apostrophe that opens nothing hides no comment.
  return open ? std::min(line.find('#'), line.size()) : line.size();
}

}  // namespace spikeloop::messages
