// Processes that end, or lose their disk, while they record.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <sstream>
#include <string>
#include <thread>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/record/reader.hpp"
#include "steps.hpp"
#include "tests/support/child.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop {
namespace {

class DoomedProcess : public testing::Test {
 protected:
  std::string file() const { return (directory_.path() / "x.h5").string(); }
  /// Waits until the file shows so many spikes; it is being written meanwhile.
  bool wait_for_spikes(std::size_t count) const {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < end) {
      try {
        if (record::read_spikes(file(), "out").spikes.size() >= count) {
          return true;
        }
      } catch (const Error&) {  // not made yet, or caught in the middle of a flush
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }
  /// Number of spikes in the file, all of them the doomed process's first ones.
  std::size_t whole_prefix() const {
    const auto read = record::read_spikes(file(), "out");
    for (std::size_t k = 0; k < read.spikes.size(); ++k) {
      const Spike expected = test::nth_spike(static_cast<TimeNs>(k));
      if (read.spikes[k].time_ns != expected.time_ns ||
          read.spikes[k].channel != expected.channel) {
        ADD_FAILURE() << "spike " << k << " is wrong";
        break;
      }
    }
    return read.spikes.size();
  }
  std::size_t whole_signal_prefix() const {
    const auto read = record::read_signal(file(), "value");
    for (std::size_t k = 0; k < read.times.size(); ++k) {
      const auto value = static_cast<double>(k);
      if (read.times[k] != test::tick(static_cast<TimeNs>(k)).end || read.row(k)[0] != value ||
          read.row(k)[1] != -value) {
        ADD_FAILURE() << "row " << k << " is wrong";
        break;
      }
    }
    return read.times.size();
  }
  test::TemporaryDirectory directory_;
};

/// What a doomed process printed at its end.
struct Printed {
  explicit Printed(const std::string& text) {
    std::istringstream in(text);
    in >> spikes >> spikes_dropped >> rows >> rows_dropped >> std::ws;
    std::getline(in, error);
  }
  std::uint64_t spikes = 0;
  std::uint64_t spikes_dropped = 0;
  std::uint64_t rows = 0;
  std::uint64_t rows_dropped = 0;
  std::string error;
};

TEST_F(DoomedProcess, FullDiskEndsTheRecordingNotTheRun) {
  const auto outcome = test::run({.arguments = {DOOMED_PROCESS, "full", file()}});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(outcome.err, "");
  const Printed printed(outcome.out);
  EXPECT_EQ(printed.spikes + printed.spikes_dropped, 40'000u);
  EXPECT_EQ(printed.rows + printed.rows_dropped, 40'000u);
  EXPECT_GT(printed.spikes, 0u);
  EXPECT_GT(printed.spikes_dropped, 0u);
  EXPECT_EQ(printed.error, "cannot write '" + file() + "': File too large; the recording ends at " +
                               format_time(record::read_spikes(file(), "out").until) +
                               " of simulated time, " + std::to_string(printed.spikes_dropped) +
                               " spikes and " + std::to_string(printed.rows_dropped) +
                               " signal rows are lost [SL0109]");
  EXPECT_EQ(whole_prefix(), printed.spikes);
  EXPECT_EQ(whole_signal_prefix(), printed.rows);
  EXPECT_EQ(record::read_spikes(file(), "out").dropped, printed.spikes_dropped);
  EXPECT_EQ(record::read_signal(file(), "value").dropped, printed.rows_dropped);
  EXPECT_FALSE(record::read_info(file()).complete);
}

TEST_F(DoomedProcess, DiskThatGoesAwayEndsTheRecordingNotTheRun) {
  const auto outcome = test::run({.arguments = {DOOMED_PROCESS, "broken", file()}});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(outcome.err, "");
  const Printed printed(outcome.out);
  EXPECT_EQ(printed.spikes + printed.spikes_dropped, 40'000u);
  EXPECT_GT(printed.spikes, 0u);
  EXPECT_GT(printed.spikes_dropped, 0u);
  EXPECT_THAT(printed.error, testing::StartsWith("cannot write '" + file() + "': "));
  EXPECT_EQ(whole_prefix(), printed.spikes);
  EXPECT_EQ(whole_signal_prefix(), printed.rows);
}

TEST_F(DoomedProcess, KilledProcessLeavesAReadableFile) {
  test::Child child({.arguments = {DOOMED_PROCESS, "steady", file()}});
  ASSERT_TRUE(wait_for_spikes(1000)) << child.output();
  child.signal(SIGKILL);
  child.wait();
  EXPECT_GE(whole_prefix(), 1000u);
  EXPECT_GE(whole_signal_prefix(), 1000u);
  const auto read = record::read_spikes(file(), "out");
  EXPECT_GE(read.until, test::tick(999).end);
  EXPECT_FALSE(record::read_info(file()).complete);
}

TEST_F(DoomedProcess, SigtermFlushesEverythingOfAWaitingLoop) {
  test::Child child({.arguments = {DOOMED_PROCESS, "waits", file()}});
  ASSERT_TRUE(child.wait_for("sent", std::chrono::seconds(60)));
  child.signal(SIGTERM);
  EXPECT_EQ(child.wait().exit_code, 143);
  EXPECT_EQ(whole_prefix(), 500u);
  EXPECT_EQ(whole_signal_prefix(), 500u);
  EXPECT_TRUE(record::read_info(file()).complete);
}

TEST_F(DoomedProcess, SigtermFlushesInTheMiddleOfALoop) {
  test::Child child({.arguments = {DOOMED_PROCESS, "busy", file()}});
  ASSERT_TRUE(child.wait_for("sending", std::chrono::seconds(60)));
  child.signal(SIGTERM);
  EXPECT_EQ(child.wait().exit_code, 143);
  const std::size_t spikes = whole_prefix();
  const std::size_t rows = whole_signal_prefix();
  EXPECT_GT(spikes, 100u);
  EXPECT_LE(spikes - rows, 1u);  // the handler may stand between the two
  EXPECT_TRUE(record::read_info(file()).complete);
}

}  // namespace
}  // namespace spikeloop
