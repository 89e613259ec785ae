#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <utility>

#include "music_text.hpp"

namespace spikeloop {

namespace {

// std::find_if for keys, const or not.
template <typename Keys>
auto* find_in(Keys& keys, std::string_view name) {
  const auto found =
      std::find_if(keys.begin(), keys.end(), [&](const MusicKey& key) { return key.name == name; });
  return found == keys.end() ? nullptr : &*found;
}

std::optional<int> parse_count(std::string_view text) {
  while (!text.empty() && music_text::is_space(text.front())) {
    text.remove_prefix(1);
  }
  while (!text.empty() && music_text::is_space(text.back())) {
    text.remove_suffix(1);
  }
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 1) {
    return std::nullopt;
  }
  return value;
}

}  // namespace

std::variant<int, Diagnostic> music_text::read_processes(const MusicFile& file,
                                                         const MusicSection& section) {
  const MusicKey* key = file.find_key(section, "np");
  if (key == nullptr) {
    return Diagnostic{section.where,
                      with_code(Code::missing_key,
                                "the section '[{}]' has no np, its number of processes; write np=1",
                                shown(section.label))};
  }
  const auto count = parse_count(key->value);
  if (!count) {
    return Diagnostic{key->where,
                      with_code(Code::not_whole,
                                "np of '[{}]' is '{}', no whole number of at least 1; write np=1",
                                shown(section.label), shown(key->value))};
  }
  return *count;
}

const MusicSection* MusicFile::find_section(std::string_view label) const {
  const auto found = std::find_if(sections.begin(), sections.end(),
                                  [&](const MusicSection& s) { return s.label == label; });
  return found == sections.end() ? nullptr : &*found;
}

MusicSection* MusicFile::find_section(std::string_view label) {
  return const_cast<MusicSection*>(std::as_const(*this).find_section(label));
}

const MusicSection& MusicFile::section(std::string_view label) const {
  const MusicSection* found = find_section(label);
  if (found == nullptr) {
    throw ConfigurationError(Location{path},
                             with_code(Code::unknown_node, "there is no section '[{}]'{}",
                                       music_text::shown(label), did_you_mean(label, labels())));
  }
  return *found;
}

MusicSection& MusicFile::section(std::string_view label) {
  return const_cast<MusicSection&>(std::as_const(*this).section(label));
}

std::vector<std::string> MusicFile::labels() const {
  std::vector<std::string> result;
  result.reserve(sections.size());
  for (const auto& section : sections) {
    result.push_back(section.label);
  }
  return result;
}

const MusicKey* MusicFile::find_key(const MusicSection& section, std::string_view name) const {
  const MusicKey* own = find_in(section.keys, name);
  return own != nullptr ? own : find_in(globals, name);
}

int MusicFile::processes(const MusicSection& section) const {
  const auto result = music_text::read_processes(*this, section);
  if (const auto* problem = std::get_if<Diagnostic>(&result)) {
    throw ConfigurationError(problem->where, problem->message);
  }
  return std::get<int>(result);
}

int MusicFile::total_processes() const {
  int total = 0;
  for (const auto& section : sections) {
    total += processes(section);
  }
  return total;
}

const MusicKey* find_key(const std::vector<MusicKey>& keys, std::string_view name) {
  return find_in(keys, name);
}

void set_key(std::vector<MusicKey>& keys, std::string_view name, std::string_view value) {
  if (MusicKey* key = find_in(keys, name); key != nullptr) {
    key->value = value;
  } else {
    keys.push_back({std::string(name), std::string(value), {}});
  }
}

bool operator==(const MusicKey& a, const MusicKey& b) {
  return a.name == b.name && a.value == b.value;
}

bool operator==(const MusicSection& a, const MusicSection& b) {
  return a.label == b.label && a.keys == b.keys;
}

bool operator==(const MusicConnection& a, const MusicConnection& b) {
  return a.from_app == b.from_app && a.from_port == b.from_port && a.to_app == b.to_app &&
         a.to_port == b.to_port && a.width == b.width && a.communication == b.communication &&
         a.processing == b.processing;
}

bool operator==(const MusicFile& a, const MusicFile& b) {
  return a.globals == b.globals && a.sections == b.sections && a.connections == b.connections;
}

bool crashes_music(std::size_t connections) {
  return connections + 3 <= std::bit_ceil(connections);
}

namespace {

void adopt_locations(std::vector<MusicKey>& keys, const std::vector<MusicKey>& origin) {
  for (MusicKey& key : keys) {
    const MusicKey* const found = find_in(origin, key.name);
    key.where = found != nullptr && *found == key ? found->where : Location{};
  }
}

}  // namespace

void adopt_locations(MusicFile& file, const MusicFile& origin) {
  adopt_locations(file.globals, origin.globals);
  for (MusicSection& section : file.sections) {
    if (const MusicSection* const found = origin.find_section(section.label)) {
      section.where = found->where;
      adopt_locations(section.keys, found->keys);
    }
  }
  for (MusicConnection& connection : file.connections) {
    const auto found = std::find(origin.connections.begin(), origin.connections.end(), connection);
    connection.where = found != origin.connections.end() ? found->where : Location{};
  }
}

MusicFile read_music_file(const std::filesystem::path& path) {
  return read_music_file(path, path.string());
}

MusicFile read_music_file(const std::filesystem::path& path, const std::string& shown_as) {
  // Far more than any job needs; comments count here, though MUSIC does not pass them on.
  constexpr std::uint64_t kLimit = 4'000'000;
  return parse_music(read_file(path, ".music file", kLimit), shown_as);
}

std::string describe(const MusicConnection& connection) {
  return fmt::format("{}.{} -> {}.{}", connection.from_app, connection.from_port, connection.to_app,
                     connection.to_port);
}

}  // namespace spikeloop
