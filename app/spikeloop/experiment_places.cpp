#include "experiment_places.hpp"

#include <cstdio>
#include <map>

namespace spikeloop::app {
namespace {

using Lines = std::map<int, Location>;

/// The place behind "PATH:" as it is written, and in the origin.
struct Place {
  std::size_t length = 0;  ///< 0: not there
  std::string origin;
};

Place place_at(const char* text, const Lines& lines) {
  int line = 0;
  int column = 0;
  int length = 0;
  if (std::sscanf(text, "%d:%d%n", &line, &column, &length) != 2 || !lines.contains(line)) {
    return {};
  }
  return {static_cast<std::size_t>(length), lines.at(line).text()};
}

std::string translated(const std::string& text, const std::string& path, const Lines& lines) {
  const std::string named = path + ":";
  std::string result;
  std::size_t at = 0;
  for (auto begin = text.find(named); begin != std::string::npos; begin = text.find(named, at)) {
    const Place place = place_at(&text[begin + named.size()], lines);
    result += text.substr(at, begin - at) + (place.length == 0 ? named : place.origin);
    at = begin + named.size() + place.length;
  }
  return result + text.substr(at);
}

Lines lines_of(const MusicFile& written, const MusicFile& origin) {
  MusicFile located = written;
  adopt_locations(located, origin);
  Lines lines;
  const auto add = [&lines](const auto& item, const auto& from) {
    lines.emplace(item.where.line, from.where);
  };
  for (std::size_t i = 0; i < written.sections.size(); ++i) {
    const MusicSection& section = written.sections[i];
    add(section, located.sections[i]);
    for (std::size_t k = 0; k < section.keys.size(); ++k) {
      add(section.keys[k], located.sections[i].keys[k]);
    }
  }
  for (std::size_t i = 0; i < written.connections.size(); ++i) {
    add(written.connections[i], located.connections[i]);
  }
  return lines;
}

}  // namespace

std::function<std::string(const std::string&)> places_of(const MusicFile& written,
                                                         const MusicFile& origin) {
  return [path = written.path, lines = lines_of(written, origin)](const std::string& text) {
    return translated(text, path, lines);
  };
}

}  // namespace spikeloop::app
