// spikeloop-script: becomes the Python that runs the script of its section's key `script`. MUSIC
// gives a program its arguments too late to say which script, so a script that is a program of a
// job would have to be executable and name its Python.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/processes/python.hpp"
#include "spikeloop/status/status.hpp"

namespace {

using namespace spikeloop;
namespace fs = std::filesystem;

constexpr const char* kName = "spikeloop-script";
constexpr const char* kCheckOption = "--check-section";

constexpr const char* kHelp =
    R"(spikeloop-script: runs a Python script as a program of a MUSIC job

  [brain]
    np=1
    binary=spikeloop-script
    script=brain.py

The script uses the package spikeloop (docs/simulators.md). It need not be executable;
/usr/bin/python3 runs it, or the interpreter in PYTHON.
)";

/// MUSIC's launcher changes into the section's directory, but leaves PWD.
std::string existing(const std::string& path) {
  const char* const directory = std::getenv("PWD");
  return fs::exists(path) || directory == nullptr ? path : (fs::path(directory) / path).string();
}

/// With the places of the user's file, when the launcher says from which it made this one.
MusicFile read_job(const std::string& path) {
  MusicFile job = read_music_file(path);
  const char* const origin = std::getenv("SPIKELOOP_FILE");
  const char* const name = std::getenv("SPIKELOOP_FILE_NAME");
  if (origin != nullptr && name != nullptr && fs::exists(origin)) {
    adopt_locations(job, read_music_file(origin, name));
  }
  return job;
}

/// From where the process is: in the section's directory.
std::string script_of(const std::string& file, const std::string& label) {
  const MusicFile job = read_job(file);
  const MusicSection& section = job.section(label);
  const MusicKey* script = job.find_key(section, "script");
  if (script == nullptr) {
    throw ConfigurationError(section.where,
                             with_code(Code::missing_key,
                                       "key 'script' is missing: a file in Python that {} runs; "
                                       "write  script=brain.py",
                                       kName));
  }
  if (!fs::is_regular_file(script->value)) {
    throw ConfigurationError(
        script->where,
        with_code(Code::missing_file,
                  "key 'script': there is no script '{}', seen from '{}'; write its path from "
                  "there",
                  script->value, fs::current_path().string()));
  }
  return script->value;
}

[[noreturn]] void become(const std::string& script, const std::vector<std::string>& arguments) {
  std::vector<std::string> words{python_name(), script};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const int error = become_program(words);
  throw TransportError(
      with_code(Code::program,
                "cannot start '{}': {}; install it (Debian: apt install python3), or set PYTHON "
                "to another one",
                words.front(), std::strerror(error)));
}

int refuse(const std::string& text) {
  std::fputs(text.c_str(), stderr);
  return 2;
}

int check(const std::string& file, const std::string& label) {
  try {
    script_of(file, label);
    return 0;
  } catch (const Error& error) {
    refuse(fmt::format("error: {}\n", error.what()));
    return error.exit_code();
  }
}

/// Without MUSIC's launcher: `--music-config FILE --app-label LABEL`.
std::string option(const std::vector<std::string>& arguments, const char* name) {
  const auto at = std::find(arguments.begin(), arguments.end(), name);
  return at == arguments.end() || at + 1 == arguments.end() ? "" : *(at + 1);
}

int run(const std::string& file, const std::string& label,
        const std::vector<std::string>& arguments) {
  try {
    become(script_of(existing(file), label), arguments);
  } catch (const Error& error) {
    status::Sender(label).failure(error.exit_code(), error.what());
    refuse(fmt::format("{}: {}\n", label, error.what()));
    return error.exit_code();
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (const char* const section = std::getenv("_MUSIC_CONFIG_")) {
    const std::string text = section;
    return run(arguments.empty() ? "" : arguments.back(), text.substr(0, text.find(':')),
               arguments);
  }
  if (const std::string file = option(arguments, "--music-config"); !file.empty()) {
    return run(file, option(arguments, "--app-label"), arguments);
  }
  if (arguments.size() == 3 && arguments.front() == kCheckOption) {
    return check(arguments[1], arguments[2]);
  }
  if (arguments.size() == 1 && (arguments.front() == "--help" || arguments.front() == "-h")) {
    std::fputs(kHelp, stdout);
    return 0;
  }
  return refuse(
      fmt::format("{0}: is started by MUSIC; write a section with binary={0} and script=FILE.py "
                  "into FILE.music "
                  "and run  spikeloop run FILE.music; see  {0} --help\n",
                  kName));
}
