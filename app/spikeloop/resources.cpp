#include "resources.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "output.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/discovery/discovery.hpp"
#include "spikeloop/launch/programs.hpp"
#include "spikeloop/live/feed.hpp"
#include "spikeloop/processes/scratch_folder.hpp"
#include "spikeloop/session/rclcpp.hpp"

namespace spikeloop::app {
namespace {

// Measured with Open MPI 4.1.4 and PMIx 4.2.2 (2026-11-29).

/// Shared memory of a program whose messages are not received: at most 512 messages of 4 kB, and
/// the queues of up to six partners.
constexpr double kMostMessages_MB = 2.5;
/// Shared memory of a program of a typical job: 0.1 MB, and a reserve.
constexpr double kTypicalMessages_MB = 0.2;
/// mpirun requires so much free shared memory for every program that starts.
constexpr double kSegment_MB = 4.4;
/// Files of mpirun, and more per program. Jobs of 2, 6, 12 and 20 programs start with 35, 51, 75
/// and 107 files, and crash or hang with one less.
constexpr std::size_t kMpirunFiles = 27;
constexpr std::size_t kFilesPerProgram = 4;
/// Files of a program over ROS 2 that records; it is the largest.
constexpr std::size_t kFilesWithoutMpirun = 28;
/// Address space of a program under mpirun (6 threads), and of one with a session of ROS 2 (15
/// threads). Most of it are malloc's arenas of the threads. Programs run without some of them, but
/// those over ROS 2 fail with 615 MB and less.
constexpr double kMpiAddresses_MB = 510;
constexpr double kRos2Addresses_MB = 970;
constexpr double kLeastAddresses_MB = 700;

/// Other programs of a job have no live view.
constexpr std::string_view kProgramWithFeed = "spikeloop-fused";

double megabytes(std::uint64_t bytes) {
  return static_cast<double>(bytes) / 1e6;
}

std::string programs_text(const RunNeeds& needs) {
  return count_of(needs.programs, "program") + (needs.feeds > 0 ? " with --live" : "");
}

/// Jobs of typical programs start with the least need. If messages are not received, programs use
/// up to the most.
struct Need {
  double least_MB = 0;
  double most_MB = 0;
};

Need shared_memory_need(const RunNeeds& needs) {
  const double feeds_MB = megabytes(needs.feeds * live::kFeedBytes);
  if (!needs.mpi) {
    return {feeds_MB, feeds_MB};
  }
  const auto programs = static_cast<double>(needs.programs);
  const double least_MB = kSegment_MB + programs * kTypicalMessages_MB;
  return {feeds_MB + least_MB, feeds_MB + std::max(least_MB, programs * kMostMessages_MB)};
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
                 .feeds = 0};
  bool guarded = false;
  for (const MusicSection& section : file.sections) {
    const launch::Program* program = launch::find_program(file, section);
    needs.feeds += live && program != nullptr && program->name == kProgramWithFeed ? 1 : 0;
    if (launch::ros_version(file, section) == 2 && has_topics(section.label)) {
      ++needs.participants;
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
  const Need need = shared_memory_need(needs);
  if (error) {
    return {true, fmt::format("the free space of {} is unknown ({})", directory, error.message()),
            ""};
  }
  if (space.capacity == 0) {  // tmpfs without a limit
    return {true, fmt::format("{} has no limit", directory), ""};
  }
  const double free_MB = megabytes(space.available);
  const std::string text = fmt::format("{} has {:.0f} MB free, and {} need{} up to {:.0f} MB",
                                       directory, std::floor(free_MB), programs_text(needs),
                                       needs.programs == 1 ? "s" : "", std::ceil(need.most_MB));
  if (free_MB >= need.most_MB) {
    return {true, text, ""};
  }
  const double size_MB = megabytes(space.capacity) - free_MB + need.most_MB;
  return {
      free_MB >= need.least_MB, text,
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
  const double limit_MB = megabytes(limit);
  const bool enough = limit == RLIM_INFINITY || limit_MB >= need_MB;
  const std::string has =
      limit == RLIM_INFINITY
          ? "the address space has no limit"
          : fmt::format("the limit of the address space is {:.0f} MB", std::floor(limit_MB));
  return {enough || limit_MB >= kLeastAddresses_MB,
          fmt::format("{}, and each program needs up to {:.0f} MB", has, need_MB),
          enough ? "" : "write  ulimit -v unlimited"};
}

Resource participants(const RunNeeds& needs) {
  const char* const transport = std::getenv(session::kTransportVariable);
  if (needs.participants == 0 ||
      (transport != nullptr && transport == std::string_view(session::kRclcpp))) {
    return {};  // Another middleware may have other ports.
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
                      found.domain, *free, discovery::most_participants(found.domain),
                      needs.participants),
          enough
              ? ""
              : "end other programs of the domain, set another ROS_DOMAIN_ID, or put sensors and "
                "commands into fewer processes (layout)"};
}

void warn_of_participants(std::size_t needed) {
  const Resource resource = participants({.participants = needed});
  if (!resource.enough) {
    put(stderr, fmt::format("spikeloop: warning: {}; {}\n", resource.text, resource.remedy));
  }
}

void require_resources(const RunNeeds& needs) {
  for (const Resource& resource : {shared_memory(scratch_parent(), needs), open_files(needs),
                                   address_space(needs), participants(needs)}) {
    if (!resource.enough) {
      throw TransportError(with_code(Code::resource, "{}; {}", resource.text, resource.remedy));
    }
    if (!resource.remedy.empty()) {
      log::warning("{}; if a program fails, {}", resource.text, resource.remedy);
    }
  }
}

}  // namespace spikeloop::app
