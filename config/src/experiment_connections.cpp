#include "experiment_connections.hpp"

#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <string_view>

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

class Line {
 public:
  Line(const std::string& text, const Location& where) : text_(text), where_(where) {}

  void read(std::vector<ExperimentConnection>& connections) const {
    const auto stations = split({text_, 0}, "->");
    if (stations.size() < 2) {
      fail(0, fmt::format("'{}' is no connection; {}", text_, kExample));
    }
    std::string from = std::string(end_of(stations.front(), false).text);
    for (std::size_t i = 1; i < stations.size(); ++i) {
      const Piece end = end_of(stations[i], true);
      ExperimentConnection connection{from, std::string(end.text), 0, {}, place(end.begin)};
      read_brackets(stations[i], connection);
      connections.push_back(connection);
      from = connection.to;
    }
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
           fmt::format("the first node of a connection has no width; {}", kExample));
    }
    const Piece name = trimmed({station.text.substr(0, bracket), station.begin});
    if (name.text.empty()) {
      fail(station.begin, fmt::format("a node is missing beside '->'; {}", kExample));
    }
    const auto bad = name.text.find_first_of(" \t,]>-");
    if (bad != std::string_view::npos) {
      fail(name.begin + bad, fmt::format("'{}' is no name of a node; {}", name.text, kExample));
    }
    return name;
  }

  void read_brackets(const Piece& station, ExperimentConnection& connection) const {
    const auto open = station.text.find('[');
    if (open == std::string_view::npos) {
      return;
    }
    if (station.text.back() != ']') {
      fail(station.begin + open, fmt::format("'{}' has no closing bracket at its end; {}",
                                             station.text.substr(open), kExample));
    }
    const Piece inside{station.text.substr(open + 1, station.text.size() - open - 2),
                       station.begin + open + 1};
    for (const Piece& item : split(inside, ",")) {
      read_item(item, connection);
    }
  }

  void read_item(const Piece& item, ExperimentConnection& connection) const {
    constexpr std::string_view kDelay = "delay ";
    if (item.text.starts_with(kDelay)) {
      const Piece time = trimmed({item.text.substr(kDelay.size()), item.begin + kDelay.size()});
      connection.delay = {std::string(time.text), place(time.begin)};
      return;
    }
    constexpr std::uint32_t kMostChannels = 16'777'216;
    std::uint32_t width = 0;
    const char* const end = item.text.data() + item.text.size();
    const auto parsed = std::from_chars(item.text.data(), end, width);
    if (parsed.ec != std::errc() || parsed.ptr != end || width == 0 || width > kMostChannels) {
      fail(item.begin, fmt::format("'{}' is neither a width from 1 to {} nor a delay; {}",
                                   item.text, kMostChannels, kExample));
    }
    connection.width = width;
  }

  const std::string& text_;
  const Location& where_;
};

}  // namespace

void read_connections(const std::string& text, const Location& where,
                      std::vector<ExperimentConnection>& connections) {
  Line(text, where).read(connections);
}

}  // namespace spikeloop::experiment_text
