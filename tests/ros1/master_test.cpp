#include "spikeloop/ros1/master.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/socket.h>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/ros1/session.hpp"
#include "tests/support/roscore.hpp"

namespace {

using namespace spikeloop;
using namespace spikeloop::ros1;
using testing::HasSubstr;
using testing::StartsWith;

constexpr TimeNs kMs = 1'000'000;

template <typename Action>
std::string error_of(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Master, address) {
  EXPECT_EQ(parse_master_uri("http://robot:11311").host, "robot");
  EXPECT_EQ(parse_master_uri("http://robot:11311/").port, 11311);
  for (const std::string uri : {"", "robot:11311", "http://robot", "http://:11311", "http://r:0",
                                "http://r:99999", "http://r:x", "https://robot:11311"}) {
    EXPECT_EQ(error_of([&] { parse_master_uri(uri); }),
              "ROS_MASTER_URI is '" + uri +
                  "', which is no address; write http://HOST:PORT, as in http://localhost:11311");
  }
}

TEST(Master, uri_comes_from_the_environment) {
  ::setenv("ROS_MASTER_URI", "http://robot:1234", 1);
  EXPECT_EQ(master_uri(), "http://robot:1234");
  ::unsetenv("ROS_MASTER_URI");
  EXPECT_EQ(master_uri(), "http://localhost:11311");
}

TEST(Master, nobody_there) {
  const std::string uri = "http://localhost:" + std::to_string(test::free_port());
  const TimeNs begin = wall_now();
  EXPECT_EQ(error_of([&] { require_master(uri, 300 * kMs); }),
            "no ROS master answers at " + uri +
                " within 300 ms (Connection refused); start one with roscore, or set "
                "ROS_MASTER_URI to where it is");
  EXPECT_LT(wall_now() - begin, 3 * kNsPerSecond);
}

TEST(Master, no_such_host) {
  EXPECT_THAT(error_of([&] { require_master("http://no-such-host.invalid:11311", 100 * kMs); }),
              HasSubstr("(no address for host 'no-such-host.invalid': "));
}

// Something listens but never answers: roscpp would hang.
TEST(Master, silent_host) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  ASSERT_EQ(::bind(socket, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(::listen(socket, 5), 0);
  ASSERT_EQ(::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const std::string uri = "http://127.0.0.1:" + std::to_string(ntohs(address.sin_port));
  const TimeNs begin = wall_now();
  EXPECT_THAT(error_of([&] { require_master(uri, 300 * kMs); }), HasSubstr("(no answer)"));
  EXPECT_LT(wall_now() - begin, 3 * kNsPerSecond);
  ::close(socket);
}

TEST(Master, real_one_answers) {
  const test::RosCore core;
  EXPECT_EQ(error_of([&] { require_master(core.uri(), 5 * kNsPerSecond); }), "no error");
}

TEST(Session, names) {
  const test::RosCore core;
  for (const std::string name : {"", "1robot", "a/b", "a b"}) {
    EXPECT_EQ(error_of([&] { Session({.node_name = name, .master_uri = core.uri()}); }),
              "ros_node_name '" + name +
                  "' is no name of a node; write a letter followed by letters, digits and '_'");
  }
  const Session session(
      {.node_name = "ros_command_node", .unique_name = true, .master_uri = core.uri()});
  EXPECT_THAT(session.node_name(), StartsWith("/ros_command_node_"));
  EXPECT_THROW(Session({.node_name = "second", .master_uri = core.uri()}), std::logic_error);
}

}  // namespace
