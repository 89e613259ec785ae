// The two older families of programs, where their defaults differ: ros_music_adapter (rma), and
// music-adapters with ros-music-adapters, which is built on it (ma).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/config/music_file.hpp"

namespace spikeloop {

enum class Dialect { rma, ma };

/// The default of `stoptime` in dialect ma, in seconds; in dialect rma it had none.
inline constexpr double kStoptimeOfMa_s = 1;

/// The last part of the section's `binary`; empty when it has none.
std::string program_of(const MusicSection& section);
/// That of every section.
std::vector<std::string> programs_of(const MusicFile& file);

/// What `dialect=auto` means for a job of these programs: ma when one of them was only in
/// music-adapters or ros-music-adapters, else rma. Names that both families have say nothing.
/// @throws ConfigurationError when there are programs that only the one family has, and such of the
/// other.
Dialect dialect_of_job(const std::vector<std::string>& programs);

/// What the text of the key `dialect` means in such a job; rma for any other text.
/// @throws as `dialect_of_job`
Dialect dialect_named(std::string_view text, const std::vector<std::string>& programs);

}  // namespace spikeloop
