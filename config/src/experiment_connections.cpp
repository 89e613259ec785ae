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
constexpr const char* kSenders = "write for example  left, right.out  or  left + right.out";
constexpr const char* kRange =
    "write the first channel, counted from 0, and the one behind the last, as  [0:50],  or one "
    "channel, as  [7]";
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

std::optional<std::uint32_t> number_of(std::string_view text) {
  std::uint32_t number = 0;
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, number);
  const bool good = parsed.ec == std::errc() && parsed.ptr == end;
  return good && number <= kMaximumChannels ? std::optional(number) : std::nullopt;
}

std::optional<std::uint32_t> width_of(std::string_view text) {
  const auto width = number_of(text);
  return width && *width > 0 ? width : std::nullopt;
}

/// "[0:50]", "[50:]", "[:50]", "[7]", as in Python.
std::optional<ChannelRange> range_of(std::string_view text) {
  if (text.size() < 3 || text.front() != '[' || text.back() != ']' || text == "[:]") {
    return std::nullopt;
  }
  const std::string_view inside = text.substr(1, text.size() - 2);
  const auto colon = inside.find(':');
  if (colon == std::string_view::npos) {
    const auto channel = number_of(inside);
    return channel ? std::optional(ChannelRange{*channel, *channel + 1}) : std::nullopt;
  }
  const std::string_view last = inside.substr(colon + 1);
  const auto begin = colon == 0 ? 0 : number_of(inside.substr(0, colon));
  const auto end = last.empty() ? 0 : number_of(last);
  const bool good = begin && end && (last.empty() || *begin < *end);
  return good ? std::optional(ChannelRange{*begin, *end}) : std::nullopt;
}

/// The place of a part of a text that begins at `where`.
Location place_in(Location where, std::size_t offset) {
  where.column += where.line > 0 ? static_cast<int>(offset) : 0;
  return where;
}
[[noreturn]] void fail_at(const Location& where, std::size_t offset, const std::string& message) {
  throw ConfigurationError(place_in(where, offset), message);
}

/// One of "left, right.out[0:50]".
ExperimentConnection sender_of(const Piece& piece, const Location& where) {
  const auto bracket = piece.text.find('[');
  const std::string_view name = piece.text.substr(0, bracket);
  if (name.ends_with(' ') || name.ends_with('\t')) {
    fail_at(where, piece.begin + bracket,
            with_code(Code::unknown_width,
                      "a sender has no width; write the width behind the receiver, as  scan -> "
                      "encoder [100],  and a part of the sender's channels without a blank, as  "
                      "scan[0:50] -> encoder"));
  }
  if (!is_end(name)) {
    fail_at(
        where, piece.begin,
        with_code(Code::unknown_node, "'{}' is neither a node nor NODE.PORT; {}", name, kSenders));
  }
  ExperimentConnection sender;
  sender.from = name;
  sender.where_from = place_in(where, piece.begin);
  if (bracket != std::string_view::npos) {
    const auto range = range_of(piece.text.substr(bracket));
    if (!range) {
      fail_at(where, piece.begin + bracket,
              with_code(Code::syntax, "'{}' is not a range of channels; {}",
                        piece.text.substr(bracket), kRange));
    }
    sender.channels = *range;
  }
  return sender;
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
    std::vector<ExperimentConnection> senders = first_senders(stations.front());
    for (std::size_t i = 1; i < stations.size(); ++i) {
      const Piece end = end_of(stations[i]);
      ExperimentConnection arrow;
      read_brackets(stations[i], arrow);
      for (ExperimentConnection& sender : senders) {
        sender.to = end.text;
        sender.where = place(end.begin);
        sender.width = arrow.width;
        sender.delay = arrow.delay;
        arrows.push_back(sender);
      }
      senders = {{}};
      senders.front().from = end.text.substr(0, end.text.find('.'));
      senders.front().where_from = place(end.begin);
    }
    connections.insert(connections.end(), arrows.begin(), arrows.end());
  }

 private:
  Location place(std::size_t offset) const { return place_in(where_, offset); }
  [[noreturn]] void fail(std::size_t offset, const std::string& message) const {
    fail_at(where_, offset, message);
  }
  [[noreturn]] void fail_without_node(const Piece& station) const {
    fail(station.begin, with_code(Code::syntax, "a node is missing beside '->'; {}", kExample));
  }

  std::vector<ExperimentConnection> first_senders(const Piece& station) const {
    if (station.text.empty()) {
      fail_without_node(station);
    }
    return read_senders(std::string(station.text), place(station.begin));
  }

  /// "encoder.in" of "encoder.in [100]".
  Piece end_of(const Piece& station) const {
    const Piece name = trimmed({station.text.substr(0, station.text.find('[')), station.begin});
    if (name.text.empty()) {
      fail_without_node(station);
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
    if (!width && item.text.find(':') != std::string_view::npos) {
      fail(item.begin,
           with_code(Code::unknown_width,
                     "'{}' is neither a width nor a delay; channels are selected where a line "
                     "begins, as  scan[0:50] -> encoder [50]",
                     item.text));
    }
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

std::vector<ExperimentConnection> read_senders(const std::string& text, const Location& where) {
  const bool adds = text.find('+') != std::string::npos;
  if (adds && text.find(',') != std::string::npos) {
    fail_at(where, text.find('+'),
            with_code(Code::syntax,
                      "'{}' has both ',' (channels one after another) and '+' (sum); write one of "
                      "them, and put another node between for the other",
                      text));
  }
  std::vector<ExperimentConnection> senders;
  for (const Piece& piece : split({text, 0}, adds ? "+" : ",")) {
    if (piece.text.empty()) {
      fail_at(where, piece.begin,
              with_code(Code::syntax, "a sender is missing beside '{}'; {}", adds ? '+' : ',',
                        kSenders));
    }
    senders.push_back(sender_of(piece, where));
    senders.back().combination = senders.size() == 1 ? Combination::alone
                                 : adds              ? Combination::added
                                                     : Combination::appended;
  }
  return senders;
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
