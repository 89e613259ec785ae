// What the guard says when it cannot do its work.
#include <gmock/gmock.h>
#include <sys/socket.h>

#include <algorithm>

#include "guarded_job.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/guard/link.hpp"
#include "spikeloop/status/address.hpp"
#include "tests/support/fault.hpp"

namespace {

using namespace spikeloop::test;
namespace guard = spikeloop::guard;
namespace status = spikeloop::status;
using ros_peer::eventually;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kAlone = ". Nothing stops the robot when this program is killed or stopped";

/// spikeloop-guard as a user starts it, and adapters played by the test.
class GuardErrorTest : public testing::Test {
 protected:
  GuardErrorTest() {
    spikeloop::log::set_sink(
        [this](spikeloop::log::Level, std::string_view text) { said_.emplace_back(text); });
    ::setenv(guard::kSocketVariable, socket_.c_str(), 1);
    ::setenv("ROS_HOSTNAME", "localhost", 0);
  }
  ~GuardErrorTest() override {
    ::unsetenv(guard::kSocketVariable);
    spikeloop::log::set_sink({});
  }

  static std::string binary(const std::string& name) {
    return std::string(SPIKELOOP_BIN) + "/" + name;
  }
  static Command guard_command(const std::vector<std::string>& arguments) {
    Command made;
    made.arguments = {binary("spikeloop-guard")};
    made.arguments.insert(made.arguments.end(), arguments.begin(), arguments.end());
    return made;
  }
  std::unique_ptr<Child> started() const {
    auto child = std::make_unique<Child>(guard_command({"--socket", socket_}));
    EXPECT_TRUE(eventually(10, [&] { return somebody_listens(); }));
    return child;
  }
  /// A socket is there a moment before somebody listens at it.
  bool somebody_listens() const {
    const spikeloop::Descriptor probe{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)};
    const auto address = status::socket_address(socket_);
    return ::connect(probe.get(), status::generic(*address), sizeof *address) == 0;
  }
  static guard::Hello hello(const std::string& master_uri) {
    guard::Hello made;
    made.process = "command";
    made.topic = "/cmd_vel";
    made.message_type = "std_msgs/Empty";
    made.place = {{"ROS_MASTER_URI", master_uri}};
    made.watchdog = 100'000'000;
    return made;
  }

  TemporaryDirectory directory_;
  std::string socket_ = (directory_.path() / "guard").string();
  std::vector<std::string> said_;
};

TEST_F(GuardErrorTest, no_master) {
  const auto child = started();
  const spikeloop::ReservedPort port;
  const std::string uri = "http://localhost:" + port.text();
  const guard::Link link(hello(uri));
  EXPECT_THAT(
      said_,
      ElementsAre(Fault("the guard refuses this adapter: ... " + uri +
                        " ... 3 s (Connection refused) ... ROS_MASTER_URI ... [SL0701]" + kAlone)));
}

TEST_F(GuardErrorTest, a_master_that_hangs) {
  const auto child = started();
  const SilentHost host;
  const guard::Link link(hello(host.uri()));
  EXPECT_THAT(said_, ElementsAre(Fault("... " + host.uri() + " ... [SL0701] ...")));
  child->signal(SIGTERM);
  EXPECT_EQ(child->wait().exit_code, 0);
}

TEST_F(GuardErrorTest, unknown_type) {
  const auto child = started();
  const RosCore core;
  auto strange = hello(core.uri());
  strange.message_type = "geometry_msgs/Twits";
  const guard::Link link(strange);
  EXPECT_THAT(said_,
              ElementsAre(HasSubstr("the guard refuses this adapter: unknown message type")));
}

TEST_F(GuardErrorTest, another_version) {
  const auto child = started();
  auto strange = hello("http://localhost:1");
  strange.protocol = guard::kProtocol + 1;
  const guard::Link link(strange);
  EXPECT_THAT(
      said_,
      ElementsAre(std::string("the guard refuses this adapter: guard and command "
                              "adapter are of different versions of Spikeloop; use those of one") +
                  kAlone));
}

TEST_F(GuardErrorTest, a_second_master) {
  const auto child = started();
  const RosCore first;
  const RosCore second;
  const guard::Link good(hello(first.uri()));
  EXPECT_TRUE(good.guarded()) << testing::PrintToString(said_);
  const guard::Link other(hello(second.uri()));
  EXPECT_THAT(said_, ElementsAre("the guard refuses this adapter: the guard uses ROS_MASTER_URI=" +
                                 first.uri() + ", not ROS_MASTER_URI=" + second.uri() +
                                 "; start another guard for this one" + kAlone));
}

TEST_F(GuardErrorTest, paths_that_cannot_be_sockets) {
  const auto taken = run(guard_command({"--socket", directory_.write("file", "")}));
  EXPECT_EQ(taken.exit_code, 4);
  EXPECT_EQ(taken.err, "spikeloop-guard: cannot make the socket '" + directory_.path().string() +
                           "/file': Address already in use [SL0109]\n");
  const auto nowhere = run(guard_command({"--socket", "/no/such/folder/guard"}));
  EXPECT_EQ(nowhere.exit_code, 4);
  EXPECT_THAT(nowhere.err, Fault("... '/no/such/folder/guard': ... [SL0109]\n"));
  const auto longer = run(guard_command({"--socket", "/tmp/" + std::string(120, 'x')}));
  EXPECT_EQ(longer.exit_code, 4);
  EXPECT_THAT(longer.err, HasSubstr("File name too long"));
}

TEST_F(GuardErrorTest, a_second_guard_and_one_that_was_killed) {
  const auto child = started();
  const auto second = run(guard_command({"--socket", socket_}));
  EXPECT_EQ(second.exit_code, 4);
  EXPECT_EQ(second.err, "spikeloop-guard: another guard listens at '" + socket_ +
                            "'; give another path with --socket\n");
  child->signal(SIGKILL);
  child->wait();
  ASSERT_TRUE(std::filesystem::exists(socket_));
  Child third(guard_command({"--socket", socket_}));
  const RosCore core;
  EXPECT_TRUE(eventually(10, [&] { return guard::Link(hello(core.uri())).guarded(); }));
  third.signal(SIGHUP);
  EXPECT_EQ(third.wait().exit_code, 0);
}

TEST_F(GuardErrorTest, command_line) {
  const auto help = run(guard_command({"--help"}));
  EXPECT_EQ(help.exit_code, 0);
  for (const char* words : {"--socket", "SPIKELOOP_GUARD=/tmp/guard mpirun", "Exit codes: 0"}) {
    EXPECT_THAT(help.out, HasSubstr(words));
  }
  const auto without = run(guard_command({}));
  EXPECT_EQ(without.exit_code, 2);
  EXPECT_THAT(without.err, HasSubstr("--socket is required"));
  const auto unknown = run(guard_command({"--socket", "x", "--sokcet"}));
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("--sokcet"));
  EXPECT_EQ(run(guard_command({"--version"})).out.find("spikeloop-guard "), 0u);
}

/// A launcher without our guard beside it.
class NoGuardTest : public GuardedJob {
 protected:
  /// Runs a job to its end; returns what was said.
  std::string text_with_guard(const std::string& script, const std::string& global = "stoptime=0.5",
                              const std::string& command_keys = "") {
    const auto launcher = directory_.path() / "spikeloop";
    std::filesystem::copy_file(binary("spikeloop"), launcher);
    if (!script.empty()) {
      std::filesystem::permissions(directory_.write("spikeloop-guard", script),
                                   std::filesystem::perms::owner_all);
    }
    Command made = launched(scan_to_twist(global, command_keys));
    made.arguments[0] = launcher.string();
    const auto outcome = run(made);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
    EXPECT_EQ(outcome.left_behind, 0);
    return outcome.text();
  }
  const std::string end_ =
      "; nothing stops the robot when its command adapter is killed or stopped [SL0703]\n";
};

/// A job whose guard is played by the test.
class StrangeGuardTest : public GuardedJob {
 protected:
  /// Sends ready and beats, and nothing more.
  void play_guard() {
    guard_thread_ = std::thread([this] {
      const spikeloop::Descriptor listener{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0)};
      const auto address = status::socket_address(socket_);
      ASSERT_EQ(::bind(listener.get(), status::generic(*address), sizeof *address), 0);
      ASSERT_EQ(::listen(listener.get(), 1), 0);
      listens_ = true;
      ASSERT_TRUE(guard::wait_readable(listener.get(), 60 * spikeloop::kNsPerSecond));
      adapter_ = spikeloop::Descriptor{::accept4(listener.get(), nullptr, nullptr, SOCK_CLOEXEC)};
      ASSERT_TRUE(guard::wait_readable(adapter_.get(), 10 * spikeloop::kNsPerSecond));
      ready_at_ = ros_peer::monotonic_now();
      guard::send_packet(adapter_.get(), {"ready"});
      while (!ended_) {
        guard::send_beat(adapter_.get());
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
    });
  }
  ~StrangeGuardTest() override {
    ended_ = true;
    guard_thread_.join();
  }

  std::string socket_ = (directory_.path() / "guard").string();
  spikeloop::Descriptor adapter_;
  std::atomic<bool> listens_{false};
  std::atomic<bool> ended_{false};
  std::int64_t ready_at_ = 0;
  std::thread guard_thread_;
};

TEST_F(StrangeGuardTest, one_that_reaches_nobody_is_waited_for_and_missed) {
  play_guard();
  ASSERT_TRUE(eventually(10, [&] { return listens_.load(); }));
  publish_scans();
  robot_.listen_twist("/cmd_vel");
  Command made = command(3, scan_to_twist(""));
  made.environment[guard::kSocketVariable] = socket_;
  child_ = std::make_unique<Child>(made);
  ASSERT_TRUE(drives());
  // A busy machine that is late with a tick may have the robot stopped before.
  const auto twists = robot_.twists();
  const auto driven =
      std::ranges::find_if(twists, [](const auto& each) { return !each.is_zero(); });
  EXPECT_GE(1e-9 * static_cast<double>(driven->time_ns - ready_at_), 3);
  child_->signal(SIGTERM);
  EXPECT_THAT(
      child_->wait().text(),
      HasSubstr("the guard has no subscriber on topic '/cmd_vel' after 3 s; the robot is "
                "driven nevertheless. Until the guard is connected, nothing stops the robot "
                "when this program is killed or stopped"));
}

TEST_F(NoGuardTest, is_not_installed) {
  EXPECT_THAT(text_with_guard(""), HasSubstr("spikeloop: warning: cannot start 'spikeloop-guard': "
                                             "No such file or directory" +
                                             end_));
}

TEST_F(NoGuardTest, ends_at_once) {
  EXPECT_THAT(text_with_guard("#!/bin/sh\nexit 1\n"),
              HasSubstr("spikeloop: warning: cannot start 'spikeloop-guard': it ended before it "
                        "listened" +
                        end_));
}

TEST_F(NoGuardTest, hangs) {
  const std::string text = text_with_guard(
      "#!/usr/bin/python3\nimport socket, struct, sys, time\n"
      "owner = socket.socket(fileno=int(sys.argv[sys.argv.index('--owner') + 1]))\n"
      "owner.send(struct.pack('=I', 9) + b'listening')\ntime.sleep(1000)\n",
      "stoptime=3");
  EXPECT_THAT(text,
              HasSubstr("spikeloop: warning: spikeloop-guard hangs; it is started again. Until "
                        "then nothing stops the robot when its command adapter is killed or "
                        "stopped\n"));
}

TEST_F(NoGuardTest, is_started_again_after_a_restart_that_failed) {
  const std::string text = text_with_guard(
      "#!/usr/bin/python3\nimport socket, struct, sys\n"
      "with open(__file__ + '.starts', 'a') as starts:\n    starts.write('x')\n"
      "    starts.flush()\n    start = starts.tell()\n"
      "if start != 2:\n"
      "    owner = socket.socket(fileno=int(sys.argv[sys.argv.index('--owner') + 1]))\n"
      "    owner.send(struct.pack('=I', 9) + b'listening')\n",
      "stoptime=5");
  EXPECT_THAT(text, HasSubstr("it ended before it listened" + end_));
  EXPECT_GE(std::filesystem::file_size(directory_.path() / "spikeloop-guard.starts"), 3u);
}

TEST_F(NoGuardTest, is_required) {
  publish_scans();
  robot_.listen_twist("/cmd_vel");
  const std::string text = text_with_guard("", "stoptime=2", "guard_required=true");
  EXPECT_THAT(text,
              HasSubstr("the robot is stopped: no guard answers, and guard_required is true"));
  EXPECT_FALSE(robot_.twists().empty());
  EXPECT_TRUE(std::ranges::all_of(robot_.twists(), &ros_peer::Twist::is_zero));
}

TEST_F(NoGuardTest, never_listens) {
  EXPECT_THAT(text_with_guard("#!/bin/sh\nexec sleep 1000\n"),
              HasSubstr("spikeloop: warning: cannot start 'spikeloop-guard': it does not listen "
                        "within 5 s" +
                        end_));
}

}  // namespace
