#include "job_file.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "spikeloop/config/dialect.hpp"

namespace spikeloop::music {
namespace {

std::optional<std::string> option(int argc, char** argv, std::string_view name) {
  for (int i = 1; i + 1 < argc; ++i) {
    if (argv[i] == name) {
      return argv[i + 1];
    }
  }
  return std::nullopt;
}

// The launcher changes into the section's `wd` before it starts the program, but leaves PWD.
std::vector<std::filesystem::path> places(const std::string& name) {
  std::vector<std::filesystem::path> result{name};
  if (const char* directory = std::getenv("PWD"); directory != nullptr) {
    result.push_back(std::filesystem::path(directory) / name);
  }
  return result;
}

std::string directory_of(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::absolute(path, ignored).parent_path().string();
}

// A launcher runs a file that it has made from the user's.
JobFile with_origin(MusicFile file) {
  const char* const path = std::getenv(kOriginVariable);
  if (path == nullptr) {
    return JobFile(std::move(file));
  }
  const char* const shown_as = std::getenv(kOriginNameVariable);
  try {
    return {std::move(file), read_music_file(path, shown_as == nullptr ? path : shown_as),
            directory_of(path)};
  } catch (const Error&) {
    return JobFile(std::move(file));  // it has gone, or was changed, since
  }
}

}  // namespace

JobFile::JobFile(MusicFile file) : file_(std::move(file)), directory_(directory_of(file_->path)) {}

JobFile::JobFile(MusicFile file, const MusicFile& origin, std::string directory)
    : file_(std::move(file)), directory_(std::move(directory)) {
  adopt_locations(*file_, origin);
}

JobFile JobFile::read(const std::string& path) {
  return with_origin(read_music_file(path));
}

std::string basename_of(std::string_view path) {
  return std::string(path.substr(path.rfind('/') + 1));
}

std::string JobFile::path(int argc, char** argv) {
  auto name = option(argc, argv, "--music-config");
  if (!name && std::getenv("_MUSIC_CONFIG_") != nullptr && argc > 1) {
    name = argv[argc - 1];
  }
  if (!name) {
    return "";
  }
  for (const auto& path : places(*name)) {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) {
      return path;
    }
  }
  return "";
}

JobFile JobFile::find(int argc, char** argv) {
  const std::string found = path(argc, argv);
  try {
    return found.empty() ? JobFile{} : read(found);
  } catch (const Error&) {
    // MUSIC itself has read it: our reader is the stricter one, and the launcher's to use.
    return {};
  }
}

std::string JobFile::directory() const {
  return directory_;
}

std::optional<std::string> JobFile::key(const std::string& label, const std::string& name) const {
  const auto* section = file_ ? file_->find_section(label) : nullptr;
  const auto* found = section != nullptr ? file_->find_key(*section, name) : nullptr;
  return found != nullptr ? std::optional(found->value) : std::nullopt;
}

int JobFile::processes(const std::string& label) const {
  return file_ ? file_->processes(file_->section(label)) : 1;
}

Location JobFile::where(const std::string& label, const std::string& key) const {
  const auto* section = file_ ? file_->find_section(label) : nullptr;
  const auto* found = section != nullptr ? file_->find_key(*section, key) : nullptr;
  return found != nullptr ? found->where : Location{};
}

Location JobFile::section_where(const std::string& label) const {
  const auto* section = file_ ? file_->find_section(label) : nullptr;
  return section != nullptr ? section->where : Location{};
}

std::vector<std::string> JobFile::own_keys(const std::string& label) const {
  std::vector<std::string> names;
  if (const auto* section = file_ ? file_->find_section(label) : nullptr) {
    for (const auto& key : section->keys) {
      names.push_back(key.name);
    }
  }
  return names;
}

std::vector<std::string> JobFile::programs() const {
  return file_ ? programs_of(*file_) : std::vector<std::string>{};
}

std::vector<PortUse> JobFile::ports(const std::string& label) const {
  std::vector<PortUse> result;
  if (file_) {
    for (const auto& connection : file_->connections) {
      if (connection.from_app == label) {
        result.push_back({connection.from_port, Direction::output, &connection});
      }
      if (connection.to_app == label) {
        result.push_back({connection.to_port, Direction::input, &connection});
      }
    }
  }
  return result;
}

std::optional<PortUse> JobFile::port(const std::string& label, const std::string& port) const {
  const auto uses = ports(label);
  const auto found =
      std::find_if(uses.begin(), uses.end(), [&](const PortUse& use) { return use.port == port; });
  return found == uses.end() ? std::nullopt : std::optional(*found);
}

std::string label_in_environment(std::string_view music_config) {
  // APPLICATION:COLOUR:...; the name is written as it is, so it cannot hold a colon.
  return std::string(music_config.substr(0, music_config.find(':')));
}

std::string with_one_digit_color(std::string_view music_config) {
  const auto label = music_config.find(':');
  const auto color = label == std::string_view::npos ? label : music_config.find(':', label + 1);
  if (color == std::string_view::npos || color - label <= 2) {
    return std::string(music_config);
  }
  return std::string(music_config.substr(0, label)) + ":0" +
         std::string(music_config.substr(color));
}

void mend_music_config() {
  if (const char* config = std::getenv("_MUSIC_CONFIG_"); config != nullptr) {
    ::setenv("_MUSIC_CONFIG_", with_one_digit_color(config).c_str(), 1);
  }
}

std::string section_label(int argc, char** argv) {
  if (const char* config = std::getenv("_MUSIC_CONFIG_"); config != nullptr) {
    return label_in_environment(config);
  }
  if (const auto label = option(argc, argv, "--app-label")) {
    return *label;
  }
  return argc > 0 ? basename_of(argv[0]) : "";
}

}  // namespace spikeloop::music
