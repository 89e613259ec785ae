// Resources of this machine that a run needs. `spikeloop run` checks them before it starts
// programs; `spikeloop doctor` prints them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "spikeloop/launch/job.hpp"

namespace spikeloop::app {

struct RunNeeds {
  std::size_t programs = 1;
  bool mpi = true;               ///< false: a single program without mpirun
  std::size_t feeds = 0;         ///< files of the live view: one per spikeloop-fused
  std::size_t participants = 0;  ///< participants in the ROS 2 domain
};

/// Needs of a job on this machine. @param live true if the run has a live view
/// @param has_topics returns true if a section of ROS 2 subscribes or publishes
RunNeeds needs_of(const MusicFile& file, const launch::JobOptions& options, bool live,
                  const std::function<bool(const std::string& label)>& has_topics);

struct Resource {
  bool enough = true;    ///< false if the job cannot start
  std::string text{};    ///< what is available, and the largest need
  std::string remedy{};  ///< empty if the largest need is met
};

/// @param directory file system of the shared memory
Resource shared_memory(const std::string& directory, const RunNeeds& needs);
Resource open_files(const RunNeeds& needs);
Resource address_space(const RunNeeds& needs);
Resource participants(const RunNeeds& needs);

/// Warns if the domain has too few free participants. This is not an error, because `check` may run
/// on another machine, or before other programs have ended.
void warn_of_participants(std::size_t needed);

/// Warns if the largest need of a resource is not met.
/// @throws TransportError for the first resource of which there is not enough
void require_resources(const RunNeeds& needs);

}  // namespace spikeloop::app
