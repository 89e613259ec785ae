#include "spikeloop/launch/job.hpp"
#include "spikeloop/core/file.hpp"

#include <filesystem>

#include "job_run.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/folders.hpp"
#include "spikeloop/launch/hostfile.hpp"

namespace spikeloop::launch {
namespace {

EffectiveFile checked(const MusicFile& file, const JobOptions& options) {
  if (!options.alone) {
    check_structure(file);
  }
  return make_effective(file, options.run);
}

}  // namespace

Job::Job(const MusicFile& file, JobOptions options)
    : options_(std::move(options)),
      effective_(checked(file, options_)),
      directory_(directory_of(file.path)) {
  if (!options_.hostfile.empty()) {
    check_hostfile(options_.hostfile);
    // mpirun runs in the file's directory.
    options_.hostfile = std::filesystem::absolute(options_.hostfile).string();
  }
}

std::string Job::command() const {
  const std::string folder = options_.folder.empty() ? "." : options_.folder;
  return shell_text(mpirun_command(effective_.file, folder + "/effective.music",
                                   {.scratch = {},
                                    .hostfile = options_.hostfile,
                                    .variables = variables_of_job(effective_.file)}));
}

JobResult Job::run(const JobEvents& events) {
  JobRun run(effective_, options_, directory_, events);
  try {
    run.run();
  } catch (const Error& error) {
    run.fail(error.exit_code(), error.what());
  }
  JobResult result = run.result();
  if (!options_.folder.empty()) {
    try {
      write_file(options_.folder + "/summary.json", result.summary.dump(2) + "\n");
    } catch (const Error& error) {  // the reason for an earlier end is more important
      if (result.exit_code == 0) {
        result.exit_code = error.exit_code();
        result.reason = error.what();
      }
    }
  }
  return result;
}

}  // namespace spikeloop::launch
