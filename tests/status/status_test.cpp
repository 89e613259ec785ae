// The status channel between the processes of a job and the launcher.
#include "spikeloop/status/status.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <thread>

#include "spikeloop/core/error.hpp"
#include "spikeloop/processes/scratch_folder.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::status {
namespace {

using test::Fault;
using namespace std::chrono_literals;
using nlohmann::json;

/// A socket in a directory of its own, named in the environment.
class Status : public testing::Test {
 protected:
  void SetUp() override {
    path_ = directory_.path() + "/status";
    setenv(kSocketVariable, path_.c_str(), 1);
    receiver_ = std::make_unique<Receiver>(path_);
  }
  void TearDown() override {
    receiver_.reset();
    unsetenv(kSocketVariable);
  }
  /// A busy machine may take long to send a large report.
  json next() { return receiver_->next(60s).value_or(json()); }

  const ScratchFolder directory_;
  std::string path_;
  std::unique_ptr<Receiver> receiver_;
};

TEST_F(Status, BringsEveryMessage) {
  const Sender sender("encoder");
  sender.started();
  sender.first_tick();
  sender.progress({1'500'000'000, 1'600'000'000, 3}, {{"age_s", 0.02}});
  sender.report({{"late", 2}}, {{"scans", 7}}, Reached{2'000'000'000, 2'500'000'000, 4});
  sender.failure(2, "tau is -1; write a time above 0");
  EXPECT_EQ(next(), (json{{"type", "started"}, {"process", "encoder"}, {"pid", getpid()}}));
  EXPECT_EQ(next(), (json{{"type", "first_tick"}, {"process", "encoder"}}));
  EXPECT_EQ(next(), (json{{"type", "progress"},
                          {"process", "encoder"},
                          {"simulated_s", 1.5},
                          {"wall_s", 1.6},
                          {"overruns", 3},
                          {"age_s", 0.02}}));
  EXPECT_EQ(next(), (json{{"type", "report"},
                          {"process", "encoder"},
                          {"simulated_s", 2.0},
                          {"wall_s", 2.5},
                          {"overruns", 4},
                          {"counters", {{"late", 2}}},
                          {"summary", {{"scans", 7}}}}));
  EXPECT_EQ(next(), (json{{"type", "failure"},
                          {"process", "encoder"},
                          {"exit_code", 2},
                          {"message", "tau is -1; write a time above 0"}}));
  EXPECT_FALSE(receiver_->next(0ms));
}

TEST_F(Status, NothingGivenIsAnEmptyObject) {
  Sender("a").report(json(), json());
  EXPECT_EQ(next(), (json{{"type", "report"},
                          {"process", "a"},
                          {"counters", json::object()},
                          {"summary", json::object()}}));
}

TEST_F(Status, TextThatIsNotUtf8AndNumbersThatAreNotFiniteDoNotThrow) {
  const Sender sender("a");
  sender.failure(1, "bad byte \xff");
  sender.report({}, {{"speed", std::numeric_limits<double>::quiet_NaN()}});
  EXPECT_EQ(next()["message"], "bad byte \xef\xbf\xbd");
  EXPECT_TRUE(next()["summary"]["speed"].is_null());
}

TEST_F(Status, WithoutALauncherNothingHappens) {
  unsetenv(kSocketVariable);
  const Sender sender("a");
  sender.started();
  sender.first_tick();
  sender.progress({});
  sender.report({}, {});
  sender.failure(1, "x");
  EXPECT_FALSE(receiver_->next(0ms));
}

TEST_F(Status, APathThatLeadsNowhereIsNoLauncher) {
  for (const std::string& path :
       {std::string(), directory_.path() + "/nobody", std::string(200, 'x')}) {
    setenv(kSocketVariable, path.c_str(), 1);
    Sender("a").failure(1, "x");
  }
  EXPECT_FALSE(receiver_->next(0ms));
}

TEST_F(Status, AFullSocketDropsProgressAndDelaysTheReport) {
  const Sender sender("a");
  for (int i = 0; i < 10'000; ++i) {
    sender.progress({i, i, 0});
  }
  std::thread reporter([&sender] { sender.report({}, {{"last", true}}); });
  std::size_t progress = 0;
  json message = next();
  while (message["type"] == "progress") {
    ++progress;
    message = next();
  }
  reporter.join();
  EXPECT_GE(progress, 1u);
  EXPECT_LT(progress, 10'000u);
  EXPECT_EQ(message["summary"]["last"], true);
}

TEST_F(Status, AReceiverThatNeverReadsHoldsNobodyForLong) {
  const Sender sender("a");
  for (int i = 0; i < 10'000; ++i) {
    sender.progress({i, i, 0});
  }
  sender.report({}, {});
  sender.failure(1, "x");
  EXPECT_EQ(next()["type"], "progress");
}

TEST_F(Status, AReceiverThatHasGoneIsNoError) {
  const Sender sender("a");
  sender.started();
  receiver_.reset();
  EXPECT_FALSE(std::filesystem::exists(path_));
  sender.progress({});
  sender.report({}, {});
  sender.failure(1, "x");
}

TEST_F(Status, ALargeReportArrivesWhole) {
  json summary;
  for (int i = 0; i < 8000; ++i) {
    summary["key_" + std::to_string(i)] = i;
  }
  ASSERT_GT(summary.dump().size(), 100'000u);
  std::thread reporter([&summary] { Sender("a").report({}, summary); });
  EXPECT_EQ(next()["summary"], summary);
  reporter.join();
}

TEST_F(Status, AReportThatDoesNotFitSaysHowLargeItWas) {
  std::thread reporter([] { Sender("a").report({}, {{"text", std::string(8'000'000, 'x')}}); });
  const json report = next();
  reporter.join();
  EXPECT_EQ(report["summary"], json::object());
  EXPECT_GT(report["too_large"], 8'000'000);
}

TEST_F(Status, ALongFailureIsCut) {
  Sender("a").failure(1, std::string(1'000'000, 'x'));
  EXPECT_EQ(next()["message"].get<std::string>().size(), 64u * 1024u);
}

TEST_F(Status, PassesOverWhatIsNoMessage) {
  const int fd = socket(AF_UNIX, SOCK_DGRAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path_.copy(address.sun_path, sizeof address.sun_path - 1);
  const std::string deep = R"({"type":"report","process":"a","summary":)" +
                           std::string(50'000, '[') + std::string(50'000, ']') + "}";
  for (const std::string& text : {std::string(), std::string("nonsense"), std::string("[1]"), deep,
                                  std::string("{\"type\":1,\"process\":\"a\"}")}) {
    EXPECT_EQ(sendto(fd, text.data(), text.size(), 0, reinterpret_cast<sockaddr*>(&address),
                     sizeof address),
              static_cast<ssize_t>(text.size()));
  }
  close(fd);
  Sender("a").first_tick();
  EXPECT_EQ(next()["type"], "first_tick");
}

TEST_F(Status, InvalidDatagramsDoNotBlockANonWaitingCaller) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path_.copy(address.sun_path, sizeof address.sun_path - 1);
  std::atomic<bool> ended{false};
  std::thread flood([&] {
    const int fd = socket(AF_UNIX, SOCK_DGRAM, 0);
    while (!ended) {
      sendto(fd, "nonsense", 8, MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&address),
             sizeof address);
    }
    close(fd);
  });
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(receiver_->next(0ms), std::nullopt);
  }
  ended = true;
  flood.join();
}

TEST(StatusSummary, CountsAddUpAndTheLargestTimeCounts) {
  json sum = json::object();
  add_summary({{"commands", 3}, {"latency_median_ms", 2.5}, {"age_max_ms", nullptr}, {"a", 1}},
              sum);
  add_summary({{"commands", 4}, {"latency_median_ms", 2.0}, {"age_max_ms", 7.0}, {"b", 2}}, sum);
  add_summary({{"latency_median_ms", nullptr}, {"a", 5}}, sum);
  EXPECT_EQ(
      sum,
      (json{{"commands", 7}, {"latency_median_ms", 2.5}, {"age_max_ms", 7.0}, {"a", 5}, {"b", 2}}));
  add_summary({{"commands", "many"}}, sum);
  EXPECT_EQ(sum["commands"], 7) << "what a process sends may be anything";
}

TEST(StatusReceiver, SaysWhySocketCannotBeMade) {
  const auto message_of = [](const std::string& path) -> std::string {
    try {
      Receiver receiver(path);
    } catch (const FileError& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_THAT(message_of("/nowhere/status"),
              Fault("cannot make the status socket '/nowhere/status': ... [SL0109]"));
  const std::string long_path(108, 'x');
  EXPECT_EQ(message_of(long_path),
            "cannot make the status socket '" + long_path + "': File name too long [SL0109]");
}

}  // namespace
}  // namespace spikeloop::status
