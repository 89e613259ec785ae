// The environment string by which MUSIC's launcher configures a program:
//   NAME:COLOR:N{:LABEL:NP}:PORTS{:PORT:DIRECTION:WIDTH:M{:TO_APP:TO_PORT:CODE:COLOR:NP:HOW:HOW}}
//   {:KEY=VALUE}
// with the application's place in the file as COLOR, and a number CODE for each input port.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "spikeloop/config/music_file.hpp"

namespace spikeloop {

namespace {

struct Port {
  bool is_input = false;
  std::int64_t width = -1;
  std::vector<std::string> connections;
};

std::string escaped(std::string_view value) {
  std::string text;
  for (const char c : value) {
    if (c == ':' || c == '\\') {
      text += '\\';
    }
    text += c;
  }
  return text;
}

std::size_t place(const MusicFile& file, std::string_view label) {
  return static_cast<std::size_t>(&file.section(label) - file.sections.data());
}

std::map<std::string, Port> ports_of(const MusicFile& file, std::string_view label) {
  std::map<std::string, Port> ports;
  std::map<std::string, std::size_t> codes;
  for (const auto& c : file.connections) {
    const auto code = codes.emplace(c.to_app + "." + c.to_port, codes.size()).first->second;
    const bool is_input = c.to_app == label;
    if (!is_input && c.from_app != label) {
      continue;
    }
    const std::string& remote = is_input ? c.from_app : c.to_app;
    const auto [found, is_new] = ports.try_emplace(is_input ? c.to_port : c.from_port);
    if (is_new) {
      found->second.is_input = is_input;
      found->second.width = c.width ? std::int64_t{*c.width} : -1;
    }
    found->second.connections.push_back(fmt::format(
        ":{}:{}:{}:{}:{}:{}:{}", c.to_app, c.to_port, code, place(file, remote),
        file.processes(file.section(remote)), c.communication == Communication::collective ? 0 : 1,
        c.processing == Processing::tree ? 0 : 1));
  }
  return ports;
}

void append_keys(const std::vector<MusicKey>& keys, const std::vector<MusicKey>* without,
                 std::string& text) {
  std::map<std::string_view, std::string_view> sorted;
  for (const auto& key : keys) {
    if (without == nullptr || find_key(*without, key.name) == nullptr) {
      sorted[key.name] = key.value;
    }
  }
  for (const auto& [name, value] : sorted) {
    text += fmt::format(":{}={}", name, escaped(value));
  }
}

}  // namespace

std::string music_environment(const MusicFile& file, std::string_view label) {
  const MusicSection& own = file.section(label);
  std::string text = fmt::format("{}:{}:{}", label, place(file, label), file.sections.size());
  for (const auto& section : file.sections) {
    text += fmt::format(":{}:{}", escaped(section.label), file.processes(section));
  }
  const auto ports = ports_of(file, label);
  text += fmt::format(":{}", ports.size());
  for (const auto& [name, port] : ports) {
    text += fmt::format(":{}:{}:{}:{}", name, port.is_input ? 1 : 0, port.width,
                        port.connections.size());
    for (const auto& connection : port.connections) {
      text += connection;
    }
  }
  append_keys(own.keys, nullptr, text);
  append_keys(file.globals, &own.keys, text);
  return text;
}

}  // namespace spikeloop
