#include "spikeloop/process/music_main.hpp"

#include <fmt/format.h>
#include <mpi.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <system_error>

#include "job_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/status/signals.hpp"
#include "spikeloop/status/status.hpp"

namespace spikeloop::music {
namespace {

constexpr int kUsage = 2;
constexpr int kInternal = 70;
constexpr const char* kLimitAdvice =
    "look at ulimit -v and ulimit -u, and at the limits of the container";
constexpr const char* kCheckOption = "--check-section";
constexpr std::string_view kAloneOption = "--alone";

using Body = std::function<int(Process&)>;

void print(std::FILE* stream, const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
}

// A line a fault; the file's name comes with most of them.
int check_section(const SectionCheck& section, const ProgramText& text, const Body& body) {
  log::set_sink([](log::Level level, std::string_view message) {
    if (level == log::Level::warning) {
      print(stderr, fmt::format("warning: {}\n", message));
    }
  });
  Location where;
  try {
    Process process(section, text.defaults);
    where = process.where();
    return body(process);
  } catch (const Error& error) {
    // What has no line of its own is somewhere in the section.
    const bool located = where.line == 0 || error.located();
    const std::string place = located ? "" : where.text() + ": ";
    const char* const kind = error.exit_code() == 0 ? "warning" : "error";
    print(stderr, fmt::format("{}: {}{}\n", kind, place, error.what()));
    return error.exit_code();
  } catch (const std::bad_alloc&) {
    print(stderr, "error: there is not enough memory; look for a width that is too large\n");
    return kUsage;
  }
}

int answer(int argc, char** argv, const ProgramText& text, const Body& body) {
  if (argc < 2) {
    print(
        stderr,
        fmt::format("{0}: is started by MUSIC; write a section with binary={0} into FILE.music and "
                    "run  spikeloop run FILE.music  or  mpirun -np N music FILE.music; see  {0} "
                    "--help\n",
                    text.name));
    return kUsage;
  }
  const std::string argument = argv[1];
  if (argument == "--help" || argument == "-h") {
    print(stdout, help_text(text));
    return 0;
  }
  if (argument == "--version") {
    print(stdout, fmt::format("{} (Spikeloop) {}\n", text.name, SPIKELOOP_VERSION));
    return 0;
  }
  if (argument == kCheckOption) {
    if (argc != 4) {
      print(stderr, fmt::format("{0}: {1} takes a file and a section; write  {0} {1} FILE.music "
                                "LABEL\n",
                                text.name, kCheckOption));
      return kUsage;
    }
    return check_section({argv[2], argv[3]}, text, body);
  }
  if (const auto option = text.options.find(argument); option != text.options.end()) {
    print(stdout, option->second.print());
    return 0;
  }
  std::vector<std::string> known{"--help", "--version", kCheckOption};
  for (const auto& [name, option] : text.options) {
    known.push_back(name);
  }
  print(stderr, fmt::format("{}: unknown argument '{}'{}\n", text.name, argument,
                            did_you_mean(argument, known)));
  return kUsage;
}

// What the program does without MUSIC.
int standalone(int argc, char** argv, const ProgramText& text, const Body& body) {
  log_to_standard_error(text.name);
  try {
    return answer(argc, argv, text, body);
  } catch (const Error& error) {
    print(stderr, fmt::format("{}: {}\n", text.name, error.what()));
    return error.exit_code();
  }
}

int run_body(int argc, char** argv, const ProgramText& text,
             const std::function<int(Process&)>& body) {
  Process process(argc, argv, text.defaults);
  int exit_code = 0;
  try {
    exit_code = body(process);
  } catch (...) {
    process.let_the_first_speak();
    throw;
  }
  int finalized = 0;
  MPI_Finalized(&finalized);
  if (finalized == 0) {
    throw std::logic_error("the program ended without having run");
  }
  return exit_code;
}

}  // namespace

std::string called_as(int argc, char** argv) {
  return argc > 0 ? basename_of(argv[0]) : "";
}

void log_to_standard_error(const std::string& label) {
  log::set_sink([label](log::Level level, std::string_view message) {
    const char* kind = level == log::Level::warning ? "warning: " : "";
    print(stderr, fmt::format("{}: {}{}\n", label, kind, message));
  });
}

int end_job(const std::string& label, int exit_code, const std::string& message) {
  print(stderr, fmt::format("{}: {}\n", label, message));
  status::Sender(label).failure(exit_code, message);
  int initialized = 0;
  int finalized = 0;
  MPI_Initialized(&initialized);
  MPI_Finalized(&finalized);
  if (initialized != 0 && finalized == 0) {
    MPI_Abort(MPI_COMM_WORLD, exit_code);
  }
  return exit_code;
}

bool started_by_music(int argc, char** argv) {
  if (std::getenv("_MUSIC_CONFIG_") != nullptr) {
    return true;
  }
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--music-config") == 0) {
      return true;
    }
  }
  return false;
}

SimulatorsMusic before_simulators_setup(int argc, char** argv) {
  mend_music_config();
  return {JobFile::path(argc, argv), section_label(argc, argv)};
}

int music_main(int argc, char** argv, const ProgramText& text,
               const std::function<int(Process&)>& body) {
  const bool alone = argc == 4 && argv[1] == kAloneOption && text.may_run_alone;
  if (!alone && !started_by_music(argc, argv)) {
    return standalone(argc, argv, text, body);
  }
  const std::string label = alone ? argv[3] : section_label(argc, argv);
  const status::SignalThread signals;
  log_to_standard_error(label);
  try {
    if (alone) {
      Process process(SectionAlone{argv[2], label}, text.defaults);
      return body(process);
    }
    return run_body(argc, argv, text, body);
  } catch (const Error& error) {
    return end_job(label, error.exit_code(), error.what());
  } catch (const std::bad_alloc&) {
    return end_job(label, TransportError::kExitCode,
                   with_code(Code::resource, "there is not enough memory; {}", kLimitAdvice));
  } catch (const std::system_error& error) {
    return end_job(label, TransportError::kExitCode,
                   with_code(Code::resource, "a thread cannot be started ({}); {}", error.what(),
                             kLimitAdvice));
  } catch (const std::exception& error) {
    return end_job(label, kInternal, fmt::format("internal error: {}", error.what()));
  }
}

}  // namespace spikeloop::music
