// A job under the real mpirun and MUSIC's own launcher, as MUSIC users start it, and with what
// `spikeloop run` preloads.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "tests/support/child.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::test {

/// What `spikeloop run` preloads: programs that wait leave the processor to the other tests.
inline std::string waiting_library() {
  const auto tests = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  const auto library = tests / "../../lib/spikeloop/libspikeloop_waiting.so";
  return std::filesystem::exists(library) ? library.string() : "";
}

/// What every Open MPI job of a test needs: leave to run as root, a session directory of its own.
inline std::map<std::string, std::string> mpi_environment(const TemporaryDirectory& directory) {
  return {{"OMPI_ALLOW_RUN_AS_ROOT", "1"},
          {"OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"},
          {"OMPI_MCA_orte_tmpdir_base", directory.path().string()},
          {"TMPDIR", directory.path().string()},
          {"LD_PRELOAD", waiting_library()},
          {"SPIKELOOP_STATUS", ""},
          {"SPIKELOOP_OUT", ""},
          {"SPIKELOOP_GUARD", ""}};
}

/// `mpirun -np PROCESSES music FILE` in the temporary directory, where FILE has this text.
inline Command music_job(const TemporaryDirectory& directory, int processes,
                         const std::string& text, const std::string& file = "job.music") {
  Command command;
  command.arguments = {"mpirun",
                       "--oversubscribe",
                       "--mca",
                       "mpi_yield_when_idle",
                       "1",
                       "--bind-to",
                       "none",
                       "-np",
                       std::to_string(processes),
                       "music",
                       directory.write(file, text)};
  command.environment = mpi_environment(directory);
  command.directory = directory.path().string();
  return command;
}

}  // namespace spikeloop::test
