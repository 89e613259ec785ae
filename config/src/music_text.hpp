// Characters of `.music` files as MUSIC's parser sees them.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "spikeloop/config/music_file.hpp"

namespace spikeloop::music_text {

/// A form feed ends a line, too.
inline bool is_line_end(int c) {
  return c == '\r' || c == '\f' || c == '\n';
}
inline bool is_blank(int c) {
  return c == ' ' || c == '\t';
}
inline bool is_space(int c) {
  return is_blank(c) || is_line_end(c) || c == '\v';
}

inline void strip_trailing(std::string& text) {
  while (!text.empty() && is_space(text.back())) {
    text.pop_back();
  }
}

/// For error messages: at most 60 bytes, no control characters.
std::string shown(std::string_view text);

/// The reason why MUSIC's launcher would garble a name on its way through the environment, or
/// empty. `kind`: "label", "port", "key".
std::string unportable_name(std::string_view kind, std::string_view name);

/// What is wrong with a line that has neither '[', '=' nor an arrow, which MUSIC takes for a key.
std::string no_entry_message(std::string_view line);

/// The number of processes of a section, or what is wrong with it.
std::variant<int, Diagnostic> read_processes(const MusicFile& file, const MusicSection& section);

}  // namespace spikeloop::music_text
