// Whether the programs of a job can be started.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

#include "spikeloop/config/dialect.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/check.hpp"
#include "spikeloop/launch/effective_file.hpp"
#include "spikeloop/launch/mpirun.hpp"
#include "spikeloop/launch/programs.hpp"
#include "spikeloop/processes/python.hpp"

namespace spikeloop::launch {
namespace {

namespace fs = std::filesystem;

/// They take their script from the command line, which is (music, FILE) until MUSIC's Setup.
bool is_interpreter(const std::string& program) {
  constexpr std::array kNames{"python", "bash", "sh", "perl", "ruby", "julia", "octave", "node"};
  std::string stem = program.substr(0, program.find_first_of("0123456789."));
  return std::find(kNames.begin(), kNames.end(), stem) != kNames.end();
}

/// Names of our own programs, to suggest one.
std::vector<std::string> own_programs() {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(own_directory(), ignored)) {
    names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class ProgramCheck {
 public:
  ProgramCheck(const MusicFile& file, const std::string& directory)
      : file_(file), directory_(directory), path_(program_environment()["PATH"]) {}

  Diagnostics run() {
    need("mpirun", "openmpi-bin");
    need("music", "music-bin");
    for (const MusicSection* section : in_written_order(file_)) {
      if (const MusicKey* binary = file_.find_key(*section, "binary")) {
        check(*section, *binary);
      }
    }
    return std::move(diagnostics_);
  }

 private:
  void need(const char* program, const char* package) {
    if (find_executable(program, "", path_).empty()) {
      diagnostics_.push_back({{},
                              fmt::format("cannot find '{}' in PATH; install it (Debian: apt "
                                          "install {})",
                                          program, package),
                              TransportError::kExitCode});
    }
  }

  void add(const MusicSection& section, const MusicKey& key, const std::string& message) {
    diagnostics_.push_back(
        error_at(key.where, fmt::format("section '{}': {}", section.label, message)));
  }

  void check(const MusicSection& section, const MusicKey& binary) {
    const MusicKey* wd = file_.find_key(section, "wd");
    const std::string from = working_directory(file_, section, directory_);
    if (std::error_code ignored; !fs::is_directory(from, ignored)) {
      add(section, wd == nullptr ? binary : *wd,
          with_code(Code::program, "there is no directory '{}' to run in; make it, or leave out wd",
                    from));
      return;
    }
    const std::string found = find_executable(binary.value, from, path_);
    if (found.empty()) {
      missing(section, binary, from);
    } else if (const MusicKey* args = file_.find_key(section, "args");
               args != nullptr && !args->value.empty() && is_interpreter(program_of(section))) {
      add(section, binary,
          with_code(Code::program,
                    "binary={} would run the .music file instead of '{}', because MUSIC hands a "
                    "program its args only later; write  binary=./{}  and make that file begin "
                    "with '#!/usr/bin/env {}' and executable (chmod +x)",
                    binary.value, args->value, args->value.substr(0, args->value.find(' ')),
                    program_of(section)));
    } else {
      check_script(section, binary, found);
    }
  }

  void missing(const MusicSection& section, const MusicKey& binary, const std::string& from) {
    const std::string& name = binary.value;
    if (name.find('/') == std::string::npos) {
      const std::string suggestion = nearest(name, own_programs());
      add(section, binary,
          with_code(Code::program, "there is no program '{}' in PATH; {}", name,
                    suggestion.empty() ? fmt::format("install it, or write its path (./{})", name)
                                       : fmt::format("did you mean '{}'?", suggestion)));
      return;
    }
    const fs::path whole = fs::path(from) / name;
    if (std::error_code ignored; fs::is_regular_file(whole, ignored)) {
      add(section, binary,
          with_code(Code::program, "'{0}' is there, but is not executable; write  chmod +x {0}",
                    name));
    } else {
      const std::string own = whole.filename().string();
      add(section, binary,
          with_code(Code::program, "there is no program '{}', seen from '{}'; write {}", name, from,
                    std::ranges::count(own_programs(), own) > 0
                        ? fmt::format("binary={}, which Spikeloop has", own)
                        : "a path from there, or a name that is in PATH"));
    }
  }

  /// What execvp cannot start it gives to /bin/sh, which makes a mess of it.
  void check_script(const MusicSection& section, const MusicKey& binary, const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::string line;
    std::getline(file, line);
    if (line.starts_with("\x7f"
                         "ELF") ||
        !file) {
      return;
    }
    if (!line.starts_with("#!")) {
      add(section, binary,
          with_code(Code::program,
                    "'{}' is neither a program nor a script that says what runs it; write a first "
                    "line like '#!/usr/bin/python3'",
                    binary.value));
      return;
    }
    if (line.ends_with('\r')) {
      add(section, binary,
          with_code(Code::program,
                    "the first line of '{0}' ends as on Windows, and its interpreter will not be "
                    "found; write  sed -i 's/\\r$//' {0}",
                    binary.value));
      return;
    }
    const std::size_t begin = line.find_first_not_of(" \t", 2);
    const std::string interpreter =
        begin == std::string::npos ? ""
                                   : line.substr(begin, line.find_first_of(" \t", begin) - begin);
    if (access(interpreter.c_str(), X_OK) != 0) {
      add(section, binary,
          with_code(Code::program,
                    "the first line of '{}' names '{}', which is not there; install it, or write "
                    "'#!/usr/bin/python3'",
                    binary.value, interpreter));
    }
  }

  const MusicFile& file_;
  const std::string& directory_;
  std::string path_;
  Diagnostics diagnostics_;
};

}  // namespace

Diagnostics check_programs(const MusicFile& file, const std::string& directory) {
  return ProgramCheck(file, directory).run();
}

}  // namespace spikeloop::launch
