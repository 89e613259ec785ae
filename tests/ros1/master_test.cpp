#include "spikeloop/ros1/master.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <atomic>
#include <string_view>
#include <thread>

#include "settings.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/roscore.hpp"

namespace {

using spikeloop::test::Fault;
using namespace spikeloop;
using namespace spikeloop::ros1;
using test::error_of;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Pair;
using testing::StartsWith;

constexpr TimeNs kMs = 1'000'000;

TEST(Master, address) {
  EXPECT_EQ(parse_master_uri("http://robot:11311").host, "robot");
  EXPECT_EQ(parse_master_uri("http://robot:11311/").port, 11311);
  for (const std::string uri : {"", "robot:11311", "http://robot", "http://:11311", "http://r:0",
                                "http://r:99999", "http://r:x", "https://robot:11311"}) {
    EXPECT_EQ(error_of<Error>([&] { parse_master_uri(uri); }),
              "ROS_MASTER_URI is '" + uri +
                  "', which is not an address; write http://HOST:PORT, as in "
                  "http://localhost:11311 [SL0510]");
  }
}

TEST(Master, uri_comes_from_the_arguments_or_the_environment) {
  ::setenv("ROS_MASTER_URI", "http://robot:1234", 1);
  EXPECT_EQ(master_uri(), "http://robot:1234");
  EXPECT_EQ(master_uri({{"__master", "http://other:1"}}), "http://other:1");
  EXPECT_EQ(master_uri({{"__master", ""}}), "http://robot:1234");
  ::unsetenv("ROS_MASTER_URI");
  EXPECT_EQ(master_uri(), "http://localhost:11311");
}

TEST(Master, nobody_there) {
  const ReservedPort port;
  const std::string uri = "http://localhost:" + port.text();
  const TimeNs begin = wall_now();
  EXPECT_EQ(error_of<Error>([&] { require_master(uri, 300 * kMs); }),
            "no ROS master answers at " + uri +
                " within 300 ms (Connection refused); start one with roscore, or set "
                "ROS_MASTER_URI to where it is [SL0701]");
  EXPECT_LT(wall_now() - begin, 3 * kNsPerSecond);
}

TEST(Master, no_such_host) {
  EXPECT_THAT(
      error_of<Error>([&] { require_master("http://no-such-host.invalid:11311", 100 * kMs); }),
      MatchesRegex("no ROS master answers at http://no-such-host.invalid:11311 within "
                   "100 ms: the host name 'no-such-host.invalid' cannot be resolved "
                   "\\([^)]+\\); add the line 'IP-ADDRESS no-such-host.invalid' to "
                   "/etc/hosts, or set ROS_MASTER_URI to where the master is \\[SL0701\\]"));
}

// Something listens but never answers: roscpp would hang.
TEST(Master, silent_host) {
  const test::SilentHost host;
  const TimeNs begin = wall_now();
  EXPECT_THAT(error_of<Error>([&] { require_master(host.uri(), 300 * kMs); }),
              HasSubstr("(no answer)"));
  EXPECT_LT(wall_now() - begin, 3 * kNsPerSecond);
}

// As it happens under load: the kernel has taken the connection, the master never hears of it.
TEST(Master, lost_connection) {
  const test::SilentHost host;
  std::thread master([&host] {
    const int lost = host.accept();
    const int heard = host.accept();
    const std::string_view answer = "HTTP/1.0 200 OK\r\n\r\n";
    EXPECT_EQ(::send(heard, answer.data(), answer.size(), MSG_NOSIGNAL), answer.size());
    ::close(heard);
    ::close(lost);
  });
  EXPECT_EQ(error_of<Error>([&] { require_master(host.uri(), 20 * kNsPerSecond); }), "no error");
  host.stop();
  master.join();
}

TEST(Master, waiting_can_be_cancelled) {
  const test::SilentHost silent;
  const ReservedPort port;
  const std::string closed = "http://localhost:" + port.text();
  for (const std::string& uri : {silent.uri(), closed}) {
    std::atomic<bool> cancelled = false;
    std::thread user([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
      cancelled = true;
    });
    const TimeNs begin = wall_now();
    EXPECT_FALSE(require_master(uri, 60 * kNsPerSecond, &cancelled)) << uri;
    EXPECT_LT(wall_now() - begin, 10 * kNsPerSecond) << uri;
    user.join();
  }
}

TEST(Master, real_one_answers) {
  const test::RosCore core;
  EXPECT_TRUE(require_master(core.uri(), 5 * kNsPerSecond));
  EXPECT_TRUE(require_master(core.uri(), 0)) << "it is asked once";
  const std::atomic<bool> cancelled = true;
  EXPECT_FALSE(require_master(core.uri(), 5 * kNsPerSecond, &cancelled));
}

TEST(Session, names) {
  const test::RosCore core;
  for (const std::string name : {"", "1robot", "a/b", "a b", "~a"}) {
    const std::string text = "'" + name + "' ... [SL0501]";
    EXPECT_THAT(error_of<Error>([&] { Session(test::node_at(core.uri(), name)); }), Fault(text));
    SessionSettings with_argument = test::node_at(core.uri(), "robot");
    with_argument.arguments = {{"__name", name}};
    EXPECT_THAT(error_of<Error>([&] { const Session session(with_argument); }), Fault(text));
  }
  const Session session(test::node_at(core.uri(), "ros_command_node"));
  EXPECT_THAT(session.node_name(), StartsWith("/ros_command_node_"));
  EXPECT_TRUE(session.alive());
  EXPECT_THAT(session.place(), ElementsAre(Pair("ROS_MASTER_URI", core.uri())));
  EXPECT_EQ(session.whole_topic("scan"), "/scan");
  EXPECT_THROW(Session(test::node_at(core.uri(), "second")), std::logic_error);
}

}  // namespace
