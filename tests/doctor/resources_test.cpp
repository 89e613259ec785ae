// Resources that a run needs, and what is missing.
#include "app/spikeloop/resources.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/discovery/discovery.hpp"
#include "spikeloop/processes/descriptor.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::app {
namespace {

using testing::HasSubstr;

/// A soft limit of this process during a test.
class Limit {
 public:
  Limit(__rlimit_resource resource, rlim_t value) : resource_(resource) {
    getrlimit(resource_, &before_);
    const rlimit lowered{value, before_.rlim_max};
    setrlimit(resource_, &lowered);
  }
  ~Limit() { setrlimit(resource_, &before_); }
  Limit(const Limit&) = delete;
  Limit& operator=(const Limit&) = delete;

 private:
  __rlimit_resource resource_;
  rlimit before_{};
};

TEST(Resources, SharedMemoryIsNeededByProgramsAndLiveView) {
  const Resource messages = shared_memory("/tmp", {.programs = 5});
  EXPECT_THAT(messages.text, HasSubstr(", and 5 programs need up to 13 MB"));
  EXPECT_THAT(shared_memory("/tmp", {.programs = 5, .feeds = 5}).text,
              HasSubstr(", and 5 programs with --live need up to 107 MB"));
  EXPECT_THAT(shared_memory("/tmp", {.mpi = false, .feeds = 1}).text,
              HasSubstr(", and 1 program with --live needs up to 19 MB"));
  const Resource too_little = shared_memory("/tmp", {.programs = 1'000'000'000, .feeds = 1});
  EXPECT_FALSE(too_little.enough);
  EXPECT_THAT(too_little.remedy, HasSubstr("--shm-size="));
  EXPECT_THAT(too_little.remedy, HasSubstr("leave out --live"));
}

TEST(Resources, OpenFilesDependOnTheNumberOfPrograms) {
  const Limit limit(RLIMIT_NOFILE, 51);
  EXPECT_TRUE(open_files({.programs = 6}).enough);
  const Resource seven = open_files({.programs = 7});
  EXPECT_FALSE(seven.enough);
  EXPECT_EQ(seven.text, "the limit of open files is 51, and a job of 7 programs needs 55");
  EXPECT_EQ(seven.remedy, "write  ulimit -n 55");
  EXPECT_TRUE(open_files({.mpi = false}).enough);
  EXPECT_THROW(require_resources({.programs = 7}), TransportError);
}

TEST(Resources, AddressSpaceDependsOnRos2) {
  {
    const Limit least(RLIMIT_AS, 450'000'000);
    EXPECT_FALSE(address_space({.programs = 2}).enough);
  }
  {
    const Limit more(RLIMIT_AS, 600'000'000);
    EXPECT_EQ(address_space({.programs = 2}).remedy, "");
    EXPECT_FALSE(address_space({.programs = 2, .participants = 1}).enough);
  }
  const Limit limit(RLIMIT_AS, 800'000'000);
  const Resource over_ros = address_space({.programs = 2, .participants = 1});
  EXPECT_TRUE(over_ros.enough) << "a warning";
  EXPECT_EQ(over_ros.text,
            "the limit of the address space is 800 MB, and each program needs up to 970 MB");
  EXPECT_EQ(over_ros.remedy, "write  ulimit -v unlimited");
  EXPECT_TRUE(address_space({.mpi = false}).enough);
}

/// Binds the UDP port of a participant of the domain.
Descriptor take_port(unsigned domain, unsigned index) {
  Descriptor port{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(7410 + 250 * domain + 2 * index));
  EXPECT_EQ(::bind(port.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  return port;
}

TEST(Resources, ParticipantsOfADomainAreCountedOnThisMachine) {
  constexpr unsigned kDomain = 87;  // its ports are below the ephemeral range
  discovery::Discovery found{.domain = kDomain};
  const int before = discovery::free_participants(found).value();
  const Descriptor first = take_port(kDomain, 0);
  const Descriptor last = take_port(kDomain, 119);
  EXPECT_EQ(discovery::free_participants(found), before - 2);
  found.range = discovery::Range::off;
  EXPECT_FALSE(discovery::free_participants(found));
  found.range = discovery::Range::subnet;
  const test::TemporaryDirectory folder;
  const std::string settings = (folder.path() / "cyclone.xml").string();
  write_file(settings, "<Discovery><ParticipantIndex>none</ParticipantIndex></Discovery>");
  found.cyclone = "file://" + settings;
  EXPECT_FALSE(discovery::free_participants(found));
  const Resource too_many = participants({.participants = 130});
  EXPECT_FALSE(too_many.enough);
  EXPECT_THAT(too_many.text, HasSubstr("120 participants on this machine, and the job needs 130"));
  EXPECT_THAT(too_many.remedy, HasSubstr("ROS_DOMAIN_ID"));
  ::setenv("SPIKELOOP_ROS2", "rclcpp", 1);
  EXPECT_TRUE(participants({.participants = 130}).enough);
  ::unsetenv("SPIKELOOP_ROS2");
}

}  // namespace
}  // namespace spikeloop::app
