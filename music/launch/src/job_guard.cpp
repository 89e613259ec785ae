// The part of a run that stops the robot when nothing else does.
#include <fmt/format.h>

#include <algorithm>

#include "guard_process.hpp"
#include "job_run.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::launch {
namespace {

constexpr const char* kUnguarded =
    "nothing stops the robot when its command adapter is killed or stopped";

bool commands_robot(const MusicFile& file) {
  return std::any_of(file.sections.begin(), file.sections.end(), [&file](const auto& section) {
    const Program* program = find_program(file, section);
    return program != nullptr && program->ros && (program->input || program->commands_robot);
  });
}

}  // namespace

void JobRun::start_guard() {
  if (!commands_robot(effective_.file)) {
    return;
  }
  try {
    guard_ = std::make_unique<GuardProcess>(scratch_, with_environment({}).environment,
                                            [this](log::Level level, const std::string& text) {
                                              log_ << "guard: " << text << std::endl;
                                              log::write(level, text);
                                            });
    ros_environment_[guard::kSocketVariable] = guard_socket(scratch_.path());
  } catch (const TransportError& error) {
    log::warning("{}", lengthened(error.what(), fmt::format("; {}", kUnguarded)));
  }
}

void JobRun::watch_guard() {
  if (guard_ && !guard_->read()) {
    guard_.reset();
    log::warning("spikeloop-guard has ended; {}", kUnguarded);
  }
}

void JobRun::end_guard() {
  guard_.reset();
}

}  // namespace spikeloop::launch
