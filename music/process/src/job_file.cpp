#include "job_file.hpp"

#include <cstdlib>
#include <filesystem>
#include <string_view>

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

}  // namespace

std::string basename_of(std::string_view path) {
  return std::string(path.substr(path.rfind('/') + 1));
}

JobFile JobFile::find(int argc, char** argv) {
  auto name = option(argc, argv, "--music-config");
  if (!name && std::getenv("_MUSIC_CONFIG_") != nullptr && argc > 1) {
    name = argv[argc - 1];
  }
  if (!name) {
    return {};
  }
  for (const auto& path : places(*name)) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) {
      continue;
    }
    try {
      return JobFile(read_music_file(path));
    } catch (const Error&) {
      // MUSIC itself has read it: our reader is the stricter one, and the launcher's to use.
      return {};
    }
  }
  return {};
}

std::string JobFile::directory() const {
  std::error_code ignored;
  return file_ ? std::filesystem::absolute(file_->path, ignored).parent_path().string() : "";
}

Location JobFile::where(const std::string& label, const std::string& key) const {
  const auto* section = file_ ? file_->find_section(label) : nullptr;
  const auto* found = section != nullptr ? file_->find_key(*section, key) : nullptr;
  return found != nullptr ? found->where : Location{};
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

std::string label_in_environment(std::string_view music_config) {
  // APPLICATION:COLOUR:...; the name is written as it is, so it cannot hold a colon.
  return std::string(music_config.substr(0, music_config.find(':')));
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
