#include "music_text.hpp"

#include <fmt/format.h>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::music_text {

std::string shown(std::string_view text) {
  constexpr std::size_t kLimit = 60;
  const std::string result = one_line(text.substr(0, kLimit));
  return text.size() > kLimit ? result + "..." : result;
}

// The launcher writes "label:...:port:...:key=value": labels and ports without escapes, keys too.
std::string unportable_name(std::string_view kind, std::string_view name) {
  const std::string_view reserved = kind == "key" ? "=\\" : ":\\";
  const auto found = name.find_first_of(reserved);
  if (found == std::string_view::npos) {
    return {};
  }
  return with_code(Code::invalid_name,
                   "the {} '{}' contains '{}', which MUSIC loses on the way to the program; "
                   "write letters, digits and '_'",
                   kind, shown(name), name[found]);
}

std::string no_entry_message(std::string_view line) {
  std::string remedy = fmt::format("write '{}=value', or '#' before a comment", shown(line));
  if (line.starts_with(";") || line.starts_with("//") || line.starts_with("%")) {
    remedy = "write '#' before a comment";
  } else if (line.find_first_of("<>") != std::string_view::npos) {
    remedy = "write a connection as 'A.out -> B.in [width]'";
  } else if (const auto colon = line.find(':'); colon != std::string_view::npos && colon > 0) {
    remedy = fmt::format("write '{}=...' with '='", shown(line.substr(0, colon)));
  } else if (line.ends_with("]")) {
    remedy = "write '[label]' for a section and 'A.out -> B.in [width]' for a connection";
  } else if (const auto blank = line.find_first_of(" \t"); blank != std::string_view::npos) {
    remedy = fmt::format("write '{}={}', or '#' before a comment", shown(line.substr(0, blank)),
                         shown(line.substr(line.find_first_not_of(" \t", blank))));
  }
  return fmt::format("'{}' is neither a section nor a key nor a connection; {}", shown(line),
                     remedy);
}

}  // namespace spikeloop::music_text
