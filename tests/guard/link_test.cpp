// What a command adapter says and hears, with a guard played by the test.
#include "spikeloop/guard/link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <sys/socket.h>

#include <filesystem>
#include <functional>
#include <mutex>
#include <random>
#include <string>
#include <thread>

#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/guard/guard_timer.hpp"
#include "spikeloop/status/address.hpp"
#include "tests/support/error_of.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace spikeloop;
using namespace spikeloop::guard;
using testing::ElementsAre;

constexpr const char* kAlone = ". Nothing stops the robot when this program is killed or stopped";

Hello example() {
  return {.process = "command",
          .topic = "/cmd_vel",
          .message_type = "geometry_msgs/Twist",
          .ros = 2,
          .place = {{"ROS_DOMAIN_ID", "7"}},
          .watchdog = 100'000'000,
          .stop = {std::byte{0}, std::byte{255}, std::byte{7}}};
}

TEST(Protocol, a_hello_arrives_as_it_was) {
  const auto hello = read_hello(to_packet(example()));
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->protocol, kProtocol);
  EXPECT_EQ(hello->process, "command");
  EXPECT_EQ(hello->topic, "/cmd_vel");
  EXPECT_EQ(hello->message_type, "geometry_msgs/Twist");
  EXPECT_EQ(hello->ros, 2);
  EXPECT_EQ(hello->place, example().place);
  EXPECT_EQ(hello->watchdog, 100'000'000);
  EXPECT_EQ(hello->stop, example().stop);
}

TEST(Protocol, what_is_no_hello_is_none) {
  EXPECT_FALSE(read_hello(Packet{"hello"}));
  EXPECT_FALSE(read_hello(Packet{"beat"}));
  EXPECT_FALSE(read_hello({}));
  auto packet = to_packet(example());
  packet.fields["watchdog"] = "soon";
  EXPECT_FALSE(read_hello(packet));
}

TEST(Protocol, decoding_corrupt_bytes_never_fails) {
  const std::string bytes = encode(to_packet(example()));
  EXPECT_EQ(decode(bytes).fields, to_packet(example()).fields);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Packet cut = decode(std::string_view(bytes).substr(0, size));  // perhaps between fields
    EXPECT_LT(cut.fields.size(), decode(bytes).fields.size()) << size;
  }
  std::mt19937 engine(1);
  for (int i = 0; i < 20000; ++i) {
    std::string other = bytes;
    for (int changes = 1 + static_cast<int>(engine() % 4); changes > 0; --changes) {
      other[engine() % other.size()] = static_cast<char>(engine());
    }
    read_hello(decode(other));
  }
  EXPECT_EQ(decode("\xbb\xff\xff\xff\xff\xff\xff\xff\xf0").type, "");
  EXPECT_EQ(decode(std::string(30000, '\x81')).type, "");
}

class LinkTest : public testing::Test {
 protected:
  LinkTest() {
    log::set_sink([this](log::Level, std::string_view text) {
      const std::lock_guard lock(mutex_);
      said_.emplace_back(text);
    });
    ::setenv(kSocketVariable, path_.c_str(), 1);
  }
  ~LinkTest() override {
    ::unsetenv(kSocketVariable);
    log::set_sink({});
  }

  void listen() {
    listener_ = Descriptor{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)};
    const auto address = status::socket_address(path_);
    ASSERT_EQ(::bind(listener_.get(), status::generic(*address), sizeof *address), 0);
    ASSERT_EQ(::listen(listener_.get(), 5), 0);
  }
  Descriptor accept() const {
    return Descriptor{::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC)};
  }
  /// Reads a packet of this type, which is what comes next.
  static void expect(const Descriptor& adapter, const char* type) {
    ASSERT_TRUE(wait_readable(adapter.get(), 10 * kNsPerSecond));
    EXPECT_EQ(receive_packet(adapter.get()).packet.type, type);
  }
  /// An adapter that has introduced itself, and been told that we are ready.
  Descriptor welcome() const {
    Descriptor adapter = accept();
    expect(adapter, "hello");
    send_packet(adapter.get(), {"ready"});
    return adapter;
  }

  /// A link whose guard is ready; socket_ is the guard's end.
  Link guarded_link() {
    listen();
    const std::jthread guard([this] { socket_ = welcome(); });
    return Link(example());
  }
  /// The guard ends, and the link asks the next one.
  void ask_next_guard(Link& link, TimeNs now) {
    socket_.reset();
    link.beat(now);                 // reads that the guard has ended
    link.beat(now + kNsPerSecond);  // asks the next one
  }
  /// Sends beats until `reached`, for 10 s at most.
  static void beat_until(Link& link, const std::function<bool()>& reached) {
    const TimeNs end = wall_now() + 10 * kNsPerSecond;
    do {
      link.beat(wall_now());
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    } while (!reached() && wall_now() < end);
  }

  test::TemporaryDirectory directory_;
  Descriptor socket_;
  std::string path_ = (directory_.path() / "guard").string();
  Descriptor listener_;
  std::mutex mutex_;
  std::vector<std::string> said_;
};

TEST_F(LinkTest, hello_beats_and_done) {
  listen();
  std::thread adapter([] {
    Link link(example());
    EXPECT_TRUE(link.guarded());
    const TimeNs now = wall_now();
    EXPECT_EQ(link.beat(now), now + kBeatPeriod);
    link.done();
    EXPECT_EQ(link.beat(now), kNever) << "nothing follows";
  });
  const Descriptor socket = welcome();
  expect(socket, "beat");
  expect(socket, "done");
  adapter.join();
  EXPECT_TRUE(receive_packet(socket.get()).closed);
  EXPECT_THAT(said_, ElementsAre());
}

TEST_F(LinkTest, the_guard_receives_the_stop_command_when_it_changes) {
  listen();
  const std::vector<std::byte> held = {std::byte{4}, std::byte{2}};
  std::atomic<bool> received{false};
  std::thread adapter([&] {
    Link link(example());
    link.set_stop(example().stop);  // which the hello has
    link.beat(wall_now());
    link.set_stop(held);
    beat_until(link, [&] { return received.load(); });
    link.done();
  });
  const Descriptor socket = welcome();
  expect(socket, "beat");
  Packet packet{"beat"};
  while (packet.type == "beat") {  // a beat that is not read yet delays the stop command
    ASSERT_TRUE(wait_readable(socket.get(), 10 * kNsPerSecond));
    packet = receive_packet(socket.get()).packet;
  }
  EXPECT_EQ(packet.type, "stop");
  EXPECT_EQ(stop_message(packet), held);
  received = true;
  adapter.join();
}

TEST_F(LinkTest, is_notified_when_the_guard_reaches_a_subscriber) {
  listen();
  std::thread guard([this] {
    const Descriptor socket = welcome();
    expect(socket, "beat");
    send_packet(socket.get(), {"of a later version"});
    send_packet(socket.get(), {"reaches"});
    std::string type;
    for (type = "beat"; type == "beat"; type = receive_packet(socket.get()).packet.type) {
      ASSERT_TRUE(wait_readable(socket.get(), 10 * kNsPerSecond));
    }
    EXPECT_EQ(type, "done");
  });
  Link link(example());
  EXPECT_FALSE(link.reaches_robot());
  beat_until(link, [&] { return link.reaches_robot(); });
  EXPECT_TRUE(link.reaches_robot());
  link.done();
  guard.join();
}

TEST_F(LinkTest, a_guard_that_has_ended_is_not_waited_for) {
  Link link = guarded_link();
  socket_.reset();
  link.beat(0);
  EXPECT_FALSE(link.guarded());
  EXPECT_TRUE(link.reaches_robot());
}

TEST_F(LinkTest, connects_again_to_a_guard_that_was_started_again) {
  Link link = guarded_link();
  socket_.reset();
  listener_.reset();
  std::filesystem::remove(path_);
  TimeNs now = wall_now();
  now = link.beat(now);
  EXPECT_FALSE(link.guarded());
  for (int i = 0; i < 20; ++i) {
    now = link.beat(now);
  }
  EXPECT_THAT(said_, ElementsAre(std::string("the guard has ended") + kAlone)) << "once";
  listen();
  std::thread second([&] { socket_ = welcome(); });
  beat_until(link, [&] { return link.guarded(); });
  second.join();
  EXPECT_TRUE(link.guarded());
  EXPECT_EQ(said_.back(), "the guard watches over /cmd_vel again");
  link.done();
  EXPECT_EQ(link.beat(now), kNever);
}

TEST_F(LinkTest, a_new_guard_counts_as_soon_as_it_is_connected_to_the_robot) {
  Link link = guarded_link();
  send_packet(socket_.get(), {"reaches"});
  link.beat(wall_now());
  EXPECT_TRUE(link.guards(true));
  socket_.reset();
  std::thread second([&] { socket_ = welcome(); });
  beat_until(link, [&] { return link.guarded(); });
  second.join();
  EXPECT_TRUE(link.guards(false)) << "no robot subscribes";
  EXPECT_FALSE(link.guards(true));
  EXPECT_THAT(said_, ElementsAre(std::string("the guard has ended") + kAlone));
  send_packet(socket_.get(), {"reaches"});
  link.beat(wall_now());
  EXPECT_TRUE(link.guards(true));
  EXPECT_EQ(said_.back(), "the guard watches over /cmd_vel again");
}

TEST_F(LinkTest, a_silent_guard_is_missed_until_it_answers_again) {
  Link link = guarded_link();
  const TimeNs begin = wall_now();
  link.beat(begin + kGuardSilence - kMargin);
  EXPECT_TRUE(link.guarded());
  link.beat(begin + kGuardSilence + kMargin);
  EXPECT_FALSE(link.guarded());
  link.beat(begin + 2 * kGuardSilence);
  send_packet(socket_.get(), {"beat"});
  link.beat(begin + 3 * kGuardSilence);
  EXPECT_TRUE(link.guarded());
  EXPECT_THAT(said_, ElementsAre(std::string("the guard has not answered for 500 ms (stopped by "
                                             "SIGSTOP, or the machine is too busy)") +
                                     kAlone,
                                 "the guard watches over /cmd_vel again"));
}

TEST(Protocol, beats_do_not_fill_a_socket_that_nobody_reads) {
  int ends[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends), 0);
  const Descriptor ours{ends[0]};
  const Descriptor theirs{ends[1]};
  for (int i = 0; i < 1000; ++i) {
    send_beat(ours.get());
  }
  EXPECT_EQ(send_packet(ours.get(), {"stopped"}), 0);
  EXPECT_EQ(receive_packet(theirs.get()).packet.type, "beat");
  EXPECT_EQ(receive_packet(theirs.get()).packet.type, "stopped");
  EXPECT_TRUE(receive_packet(theirs.get()).nothing);
  send_beat(ours.get());
  EXPECT_EQ(receive_packet(theirs.get()).packet.type, "beat");
}

TEST(Protocol, what_was_sent_before_the_end_is_read_although_the_sender_left_packets_unread) {
  int ends[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends), 0);
  Descriptor adapter{ends[0]};
  const Descriptor guard{ends[1]};
  send_beat(guard.get());
  send_packet(adapter.get(), {"done"});
  adapter.reset();
  EXPECT_EQ(receive_packet(guard.get()).packet.type, "done");
  EXPECT_TRUE(receive_packet(guard.get()).closed);
}

TEST_F(LinkTest, without_the_variable_there_is_no_guard) {
  ::unsetenv(kSocketVariable);
  Link link(example());
  EXPECT_FALSE(link.guarded());
  EXPECT_TRUE(link.reaches_robot());
  EXPECT_EQ(link.beat(0), kNever);
  link.done();
  EXPECT_THAT(said_, ElementsAre());
}

TEST_F(LinkTest, nobody_listens) {
  const Link link(example());
  EXPECT_FALSE(link.guarded());
  EXPECT_THAT(said_, ElementsAre("no guard answers at '" + path_ +
                                 "' (No such file or directory); start one with spikeloop-guard "
                                 "--socket " +
                                 path_ + ", or unset SPIKELOOP_GUARD" + kAlone));
}

TEST_F(LinkTest, a_path_that_is_too_long) {
  ::setenv(kSocketVariable, std::string(200, 'x').c_str(), 1);
  const Link link(example());
  EXPECT_THAT(said_, ElementsAre(testing::HasSubstr("(File name too long)")));
}

TEST_F(LinkTest, a_guard_that_refuses) {
  listen();
  std::thread adapter([] { EXPECT_FALSE(Link(example()).guarded()); });
  const Descriptor socket = accept();
  expect(socket, "hello");
  send_packet(socket.get(), {"refused", {{"reason", "no ROS master"}}});
  adapter.join();
  EXPECT_THAT(said_,
              ElementsAre(std::string("the guard refuses this adapter: no ROS master") + kAlone));
}

TEST_F(LinkTest, a_guard_without_a_node_ends_the_run) {
  listen();
  std::string error;
  std::thread adapter(
      [&] { error = test::error_of<TransportError>([] { const Link link(example()); }); });
  const Descriptor socket = accept();
  expect(socket, "hello");
  send_packet(socket.get(),
              {"refused", {{"reason", "the domain is full [SL0604]"}, {kEndsRun, "1"}}});
  adapter.join();
  EXPECT_EQ(error,
            "the guard of /cmd_vel cannot become a node of ROS 2, so that nothing would stop the "
            "robot: the domain is full [SL0604]");
}

TEST_F(LinkTest, a_new_guard_that_refuses_is_asked_again) {
  Link link = guarded_link();
  const TimeNs now = wall_now();
  ask_next_guard(link, now);
  socket_ = accept();
  expect(socket_, "hello");
  send_packet(socket_.get(), {"refused"});
  link.beat(now + kNsPerSecond);
  EXPECT_FALSE(link.guarded());
  EXPECT_LT(link.beat(now + 2 * kNsPerSecond), kNever);
  link.beat(now + 7 * kNsPerSecond);
  socket_ = welcome();
  link.beat(now + 7 * kNsPerSecond);
  EXPECT_TRUE(link.guarded());
}

TEST_F(LinkTest, a_run_that_ends_before_the_answer_is_done) {
  Link link = guarded_link();
  ask_next_guard(link, wall_now());
  link.done();
  socket_ = accept();
  expect(socket_, "hello");
  expect(socket_, "done");
}

TEST_F(LinkTest, a_guard_that_ends_before_it_answers) {
  listen();
  std::thread adapter([] { EXPECT_FALSE(Link(example()).guarded()); });
  {
    const Descriptor socket = accept();
    expect(socket, "hello");
  }
  adapter.join();
  EXPECT_THAT(said_, ElementsAre(std::string("the guard has ended") + kAlone));
}

TEST_F(LinkTest, a_guard_that_ends_later_is_missed_once) {
  listen();
  std::thread adapter([this] {
    Link link(example());
    listener_.reset();
    TimeNs now = 0;
    while (link.guarded()) {
      now = link.beat(now);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    link.beat(now + kNsPerSecond);
    link.done();
  });
  {
    const Descriptor socket = welcome();
    expect(socket, "beat");
  }
  adapter.join();
  EXPECT_THAT(said_, ElementsAre(std::string("the guard has ended") + kAlone));
}

TEST_F(LinkTest, a_guard_that_does_not_answer) {
  listen();
  const Link link(example());
  EXPECT_FALSE(link.guarded());
  EXPECT_THAT(said_, ElementsAre(std::string("the guard does not answer within 5 s") + kAlone));
}

TEST_F(LinkTest, a_message_that_is_too_large) {
  listen();
  Hello hello = example();
  hello.stop.resize(64u << 20);
  const Link link(hello);
  EXPECT_THAT(said_, ElementsAre(std::string("cannot register /cmd_vel with the guard (Message too "
                                             "long)") +
                                 kAlone));
}

TEST_F(LinkTest, a_guard_that_is_late_does_not_stop_the_beats) {
  listen();
  std::thread adapter([] {
    Link link(example());
    for (int i = 0; i < 20000; ++i) {
      EXPECT_EQ(link.beat(0), kBeatPeriod);
    }
  });
  const Descriptor socket = welcome();
  adapter.join();
  EXPECT_THAT(said_, ElementsAre());
}

}  // namespace
