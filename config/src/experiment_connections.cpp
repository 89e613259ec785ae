#include "experiment_connections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <string_view>

#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/core/code.hpp"

namespace spikeloop::experiment_text {
namespace {

constexpr const char* kExample =
    "write for example  scan -> encoder [100] -> brain [100, delay 5 ms]";
constexpr std::string_view kBlank = " \t";

/// A part of a line, and where it begins in the line.
struct Piece {
  std::string_view text;
  std::size_t begin = 0;
};

Piece trimmed(Piece piece) {
  const auto first = piece.text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) {
    return {{}, piece.begin};
  }
  const auto last = piece.text.find_last_not_of(kBlank);
  return {piece.text.substr(first, last - first + 1), piece.begin + first};
}

std::vector<Piece> split(Piece piece, std::string_view at) {
  std::vector<Piece> pieces;
  for (std::size_t begin = 0;;) {
    const auto end = piece.text.find(at, begin);
    pieces.push_back(trimmed({piece.text.substr(begin, end - begin), piece.begin + begin}));
    if (end == std::string_view::npos) {
      return pieces;
    }
    begin = end + at.size();
  }
}

/// NODE or NODE.PORT
bool is_end(std::string_view text) {
  const auto dot = text.find('.');
  const auto is_name = [](std::string_view name) {
    return !name.empty() &&
           std::ranges::all_of(name, [](unsigned char c) { return std::isalnum(c) || c == '_'; });
  };
  return is_name(text.substr(0, dot)) &&
         (dot == std::string_view::npos || is_name(text.substr(dot + 1)));
}

std::optional<std::uint32_t> width_of(std::string_view text) {
  std::uint32_t width = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, width);
  const bool good = parsed.ec == std::errc() && parsed.ptr == end && width > 0;
  return good && width <= kMaximumChannels ? std::optional(width) : std::nullopt;
}

class Line {
 public:
  Line(const std::string& text, const Location& where) : text_(text), where_(where) {}

  void read(std::vector<ExperimentConnection>& connections) const {
    const auto stations = split({text_, 0}, "->");
    std::vector<ExperimentConnection> arrows;
    if (const auto other = text_.find("=>"); other != std::string::npos) {
      fail(other, with_code(Code::syntax, "'=>' is not an arrow; {}", kExample));
    }
    if (stations.size() < 2) {
      fail(0, with_code(Code::syntax, "'{}' is not a connection; {}", text_, kExample));
    }
    Piece from = end_of(stations.front(), false);
    for (std::size_t i = 1; i < stations.size(); ++i) {
      const Piece end = end_of(stations[i], true);
      ExperimentConnection connection{std::string(from.text), std::string(end.text), 0, {},
                                      place(end.begin),       place(from.begin)};
      read_brackets(stations[i], connection);
      arrows.push_back(connection);
      from = {end.text.substr(0, end.text.find('.')), end.begin};
    }
    connections.insert(connections.end(), arrows.begin(), arrows.end());
  }

 private:
  Location place(std::size_t offset) const {
    Location where = where_;
    where.column += where.line > 0 ? static_cast<int>(offset) : 0;
    return where;
  }
  [[noreturn]] void fail(std::size_t offset, const std::string& message) const {
    throw ConfigurationError(place(offset), message);
  }

  /// "encoder.in" of "encoder.in [100]".
  Piece end_of(const Piece& station, bool may_have_brackets) const {
    const auto bracket = station.text.find('[');
    if (bracket != std::string_view::npos && !may_have_brackets) {
      fail(station.begin + bracket,
           with_code(Code::unknown_width, "the first node of a connection has no width; {}",
                     kExample));
    }
    const Piece name = trimmed({station.text.substr(0, bracket), station.begin});
    if (name.text.empty()) {
      fail(station.begin, with_code(Code::syntax, "a node is missing beside '->'; {}", kExample));
    }
    if (!is_end(name.text)) {
      fail(name.begin, with_code(Code::unknown_node, "'{}' is neither a node nor NODE.PORT; {}",
                                 name.text, kExample));
    }
    return name;
  }

  void read_brackets(const Piece& station, ExperimentConnection& connection) const {
    const auto open = station.text.find('[');
    if (open == std::string_view::npos) {
      return;
    }
    if (station.text.back() != ']') {
      fail(station.begin + open,
           with_code(Code::syntax, "'{}' has no closing bracket at its end; {}",
                     station.text.substr(open), kExample));
    }
    const Piece inside{station.text.substr(open + 1, station.text.size() - open - 2),
                       station.begin + open + 1};
    for (const Piece& item : split(inside, ",")) {
      read_item(item, connection);
    }
  }

  void read_item(const Piece& item, ExperimentConnection& connection) const {
    constexpr std::string_view kDelay = "delay";
    const auto once = [&](bool before) {
      if (before) {
        fail(item.begin, with_code(Code::duplicate_key,
                                   "'{}' is the second of its kind here; write one width and one "
                                   "delay",
                                   item.text));
      }
    };
    if (item.text.starts_with(kDelay)) {
      once(!connection.delay.text.empty());
      const Piece time = trimmed({item.text.substr(kDelay.size()), item.begin + kDelay.size()});
      if (time.text.empty() || time.begin == item.begin + kDelay.size()) {
        fail(item.begin,
             with_code(Code::delay,
                       "'{}' is not a delay; write for example  delay 5 ms  or  delay 2 "
                       "ticks",
                       item.text));
      }
      connection.delay = {std::string(time.text), place(time.begin)};
      return;
    }
    const auto width = width_of(item.text);
    if (!width) {
      fail(item.begin,
           with_code(Code::unknown_width, "'{}' is neither a width from 1 to {} nor a delay; {}",
                     item.text, kMaximumChannels, kExample));
    }
    once(connection.width != 0);
    connection.width = *width;
  }

  const std::string& text_;
  const Location& where_;
};

}  // namespace

void read_connections(const std::string& text, const Location& where,
                      std::vector<ExperimentConnection>& connections) {
  Line(text, where).read(connections);
}

std::uint32_t read_width(const std::string& text, const Location& where) {
  const auto width = width_of(text);
  if (!width) {
    throw ConfigurationError(
        where, with_code(Code::unknown_width,
                         "key 'width': '{}' is not a width from 1 to {}; write for example 100",
                         text, kMaximumChannels));
  }
  return *width;
}

void check_end(const std::string& text, const Location& where) {
  if (!is_end(text)) {
    throw ConfigurationError(
        where,
        with_code(Code::unknown_node,
                  "'{}' is neither a node nor NODE.PORT; write for example  encoder.out", text));
  }
}

}  // namespace spikeloop::experiment_text
