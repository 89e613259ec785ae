// mpirun and MUSIC's launcher.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>

#include "probe.hpp"
#include "spikeloop/launch/mpirun.hpp"

namespace spikeloop::app::doctor {
namespace {

constexpr const char* kInstallMpi = "apt-get install openmpi-bin, or add its directory to PATH";
constexpr const char* kInstallMusic = "apt-get install music-bin, or add its directory to PATH";

Probe not_in_path(const char* name, const char* program, const char* remedy) {
  return fact(name, true, [=] {
    const char* const path = std::getenv("PATH");
    return missing(path == nullptr || *path == '\0'
                       ? fmt::format("no {}: PATH is empty", program)
                       : fmt::format("no {} in PATH ({})", program, path),
                   remedy);
  });
}

launch::ProgramStart start_of(std::vector<std::string> arguments) {
  return {std::move(arguments), launch::program_environment(), "", ""};
}

/// "mpirun (Open MPI) 4.1.4"
Finding judge_version(const std::string& path, const Answer& answer) {
  if (const std::string failure = answer.failure(); !failure.empty()) {
    return missing(fmt::format("{}: {}", path, failure), kInstallMpi);
  }
  const std::string line(first_line(answer.out));
  const auto name = line.find("(Open MPI) ");
  if (name == std::string::npos) {
    return missing(fmt::format("{} is not Open MPI's: '{}'", path, line), kInstallMpi);
  }
  return ok(fmt::format("{}, {}", line.substr(name + 11), path));
}

/// More processes than cores, as root if that is who we are, as `spikeloop run` starts them.
launch::ProgramStart two_processes(const std::string& mpirun, const std::string& scratch) {
  launch::ProgramStart start = start_of({mpirun, "-np", "2", "--oversubscribe", "--bind-to", "none",
                                         launch::own_directory() + "/spikeloop", "--version"});
  if (!scratch.empty()) {
    start.environment["OMPI_MCA_orte_tmpdir_base"] = scratch;
    start.scratch = scratch;
  }
  return start;
}

Finding judge_start(const Answer& answer) {
  const std::string failure = answer.failure();
  if (!failure.empty() || answer.out.empty()) {
    return missing(
        fmt::format("cannot start programs: {}", failure.empty() ? "they say nothing" : failure),
        "see what it says: mpirun -np 2 --oversubscribe hostname");
  }
  return ok(fmt::format("started 2 processes in {:.1f} s; --oversubscribe works{}", answer.seconds,
                        geteuid() == 0 ? ", as root too" : ""));
}

std::vector<Probe> mpirun_probes(const std::string& scratch) {
  const std::string path = in_path("mpirun");
  if (path.empty()) {
    return {not_in_path("Open MPI", "mpirun", kInstallMpi)};
  }
  return {answer_of("Open MPI", true, start_of({path, "--version"}),
                    [path](const Answer& answer) { return judge_version(path, answer); }),
          answer_of("mpirun", true, two_processes(path, scratch), judge_start)};
}

Probe music_probe() {
  const std::string path = in_path("music");
  if (path.empty()) {
    return not_in_path("MUSIC launcher", "music", kInstallMusic);
  }
  return answer_of(
      "MUSIC launcher", true, start_of({path, "--version"}), [path](const Answer& answer) {
        const std::string line(first_line(answer.out));
        const std::string failure = answer.failure();
        if (!failure.empty() || !line.starts_with("MUSIC ")) {
          return missing(failure.empty()
                             ? fmt::format("{} is not MUSIC's: its version is '{}'", path, line)
                             : fmt::format("{}: {}", path, failure),
                         kInstallMusic);
        }
        return ok(fmt::format("{}, {}", line.substr(6), path));
      });
}

}  // namespace

std::string in_path(const std::string& program) {
  const char* const path = std::getenv("PATH");
  // An empty PATH finds nothing: an empty entry of one that is not empty is the working directory.
  return path == nullptr || *path == '\0' ? "" : launch::find_executable(program, ".", path);
}

std::vector<Probe> mpi_probes(const std::string& scratch) {
  std::vector<Probe> probes = mpirun_probes(scratch);
  probes.push_back(music_probe());
  return probes;
}

}  // namespace spikeloop::app::doctor
