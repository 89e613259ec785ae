#include "resources.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "output.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/discovery/discovery.hpp"
#include "spikeloop/launch/programs.hpp"
#include "spikeloop/live/feed.hpp"
#include "spikeloop/processes/scratch_folder.hpp"

namespace spikeloop::app {
namespace {

// Measured with Open MPI 4.1.4 and PMIx 4.2.2 (2026-11-29).

/// Shared memory of a program whose messages are not received: at most 512 messages of 4 kB, and
/// the queues of up to six partners. Programs of typical jobs use 0.1 MB.
constexpr double kMessages_MB = 2.5;
/// mpirun requires so much free shared memory for every program that starts.
constexpr double kSegment_MB = 4.4;
/// Files of mpirun, and more per program. Jobs of 2, 6, 12 and 20 programs start with 35, 51, 75
/// and 107 files, and crash or hang with one less.
constexpr std::size_t kMpirunFiles = 27;
constexpr std::size_t kFilesPerProgram = 4;
/// Files of a program over ROS 2 that records; it is the largest.
constexpr std::size_t kFilesWithoutMpirun = 28;
/// Address space of a program under mpirun (6 threads), and of one with a session of ROS 2 (15
/// threads).
constexpr double kMpiAddresses_MB = 510;
constexpr double kRos2Addresses_MB = 970;

double megabytes(std::uint64_t bytes) {
  return static_cast<double>(bytes) / 1e6;
}

std::string programs_text(const RunNeeds& needs) {
  return count_of(needs.programs, "program") + (needs.feeds > 0 ? " with --live" : "");
}

double shared_memory_need_MB(const RunNeeds& needs) {
  const double messages =
      needs.mpi ? std::max(static_cast<double>(needs.programs) * kMessages_MB, kSegment_MB) : 0;
  return messages + megabytes(needs.feeds * live::kFeedBytes);
}

rlim_t limit_of(__rlimit_resource resource) {
  rlimit limit{};
  getrlimit(resource, &limit);
  return limit.rlim_cur;
}

}  // namespace

RunNeeds needs_of(const MusicFile& file, const launch::JobOptions& options, bool live,
                  const std::function<bool(const std::string& label)>& has_topics) {
  RunNeeds needs{.programs = static_cast<std::size_t>(file.total_processes()),
                 .mpi = !options.alone,
                 .feeds = live ? file.sections.size() : 0};
  bool guarded = false;
  for (const MusicSection& section : file.sections) {
    if (launch::ros_version(file, section) == 2 && has_topics(section.label)) {
      ++needs.participants;
      const launch::Program* program = launch::find_program(file, section);
      guarded = guarded || program->input || program->commands_robot;
    }
  }
  const bool robot = options.robot && needs.participants > 0;
  needs.participants += (guarded ? 1 : 0) + (robot ? 1 : 0);
  return needs;
}

Resource shared_memory(const std::string& directory, const RunNeeds& needs) {
  std::error_code error;
  const auto space = std::filesystem::space(directory, error);
  const double need_MB = shared_memory_need_MB(needs);
  if (error) {
    return {true, fmt::format("the free space of {} is unknown ({})", directory, error.message()),
            ""};
  }
  if (space.capacity == 0) {  // tmpfs without a limit
    return {true, fmt::format("{} has no limit", directory), ""};
  }
  const double free_MB = megabytes(space.available);
  const std::string text =
      fmt::format("{} has {:.0f} MB free, and {} need{} {:.0f} MB", directory, std::floor(free_MB),
                  programs_text(needs), needs.programs == 1 ? "s" : "", std::ceil(need_MB));
  if (free_MB >= need_MB) {
    return {true, text, ""};
  }
  const double size_MB = megabytes(space.capacity) - free_MB + need_MB;
  return {
      false, text,
      fmt::format("remove old files there, or enlarge it: docker run --shm-size={0}m, or mount "
                  "-o remount,size={0}m {1}{2}",
                  std::ceil(size_MB), directory, needs.feeds > 0 ? "; or leave out --live" : "")};
}

Resource open_files(const RunNeeds& needs) {
  const std::size_t need =
      needs.mpi ? kMpirunFiles + kFilesPerProgram * needs.programs : kFilesWithoutMpirun;
  const rlim_t limit = limit_of(RLIMIT_NOFILE);
  const std::string has = limit == RLIM_INFINITY
                              ? "the number of open files has no limit"
                              : fmt::format("the limit of open files is {}", limit);
  const std::string text =
      fmt::format("{}, and a job of {} needs {}", has, count_of(needs.programs, "program"), need);
  return {limit >= need, text, limit >= need ? "" : fmt::format("write  ulimit -n {}", need)};
}

Resource address_space(const RunNeeds& needs) {
  const double need_MB = needs.participants > 0 ? kRos2Addresses_MB
                         : needs.mpi            ? kMpiAddresses_MB
                                                : 0;
  const rlim_t limit = limit_of(RLIMIT_AS);
  const bool enough = limit == RLIM_INFINITY || megabytes(limit) >= need_MB;
  const std::string has = limit == RLIM_INFINITY
                              ? "the address space has no limit"
                              : fmt::format("the limit of the address space is {:.0f} MB",
                                            std::floor(megabytes(limit)));
  return {enough, fmt::format("{}, and each program needs up to {:.0f} MB", has, need_MB),
          enough ? "" : "write  ulimit -v unlimited"};
}

Resource participants(const RunNeeds& needs) {
  if (needs.participants == 0) {
    return {};
  }
  const discovery::Discovery found = discovery::parse(discovery::environment());
  const auto free = discovery::free_participants(found);
  if (!free) {
    return {};
  }
  const bool enough = static_cast<std::size_t>(*free) >= needs.participants;
  return {enough,
          fmt::format("domain {} of ROS 2 has room for {} more of its {} participants on this "
                      "machine, and the job needs {}",
                      found.domain, *free, discovery::kMostParticipants, needs.participants),
          enough
              ? ""
              : "end other programs of the domain, set another ROS_DOMAIN_ID, or put sensors and "
                "commands into fewer processes (layout)"};
}

void require_resources(const RunNeeds& needs) {
  for (const Resource& resource : {shared_memory(scratch_parent(), needs), open_files(needs),
                                   address_space(needs), participants(needs)}) {
    if (!resource.enough) {
      throw TransportError(with_code(Code::resource, "{}; {}", resource.text, resource.remedy));
    }
  }
}

}  // namespace spikeloop::app
