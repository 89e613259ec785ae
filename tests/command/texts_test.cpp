// Every sentence that says why a robot stands, or that its values are cut.
#include <gtest/gtest.h>

#include "spikeloop/command/command_sink.hpp"

namespace spikeloop::command {
namespace {

class TextsTest : public testing::Test {
 protected:
  TextsTest() {
    settings_.gate.deadband = {0};
    settings_.max_age = 1'000'000'000;
    settings_.watchdog = 100'000'000;
    settings_.spike_timeout = 2'000'000'000;
    settings_.sensors = {{"/scan", 500'000'000}};
    settings_.emergency_stop.topic = "/stop";
    settings_.fields = {"linear.x"};
    settings_.bounds = {{-1, 1}};
  }
  std::string cause(StopReason reason) const { return stop_cause(reason, settings_, 0); }

  CommandSettings settings_;
  CommandChannel channel_{{.gate = {{0}}}, [](auto) {}};
};

TEST_F(TextsTest, every_reason_has_its_cause) {
  EXPECT_EQ(cause(StopReason::no_value), "there is no value to send");
  EXPECT_EQ(cause(StopReason::not_finite), "a command has a value that is not a finite number");
  EXPECT_EQ(cause(StopReason::stale), "the data are older than max_age, 1 s");
  EXPECT_EQ(cause(StopReason::sensor_silent),
            "no message with a reading on topic '/scan' for 500 ms");
  EXPECT_EQ(cause(StopReason::spikes_silent), "no spike for spike_timeout, 2 s");
  EXPECT_EQ(cause(StopReason::silent), "no tick for 100 ms");
  EXPECT_EQ(cause(StopReason::continued),
            "a program of the job has died, or this one had been stopped (SIGCONT)");
  settings_.driver = "decoder.out";
  EXPECT_EQ(cause(StopReason::not_finite), "a value from 'decoder.out' is not a finite number");
  EXPECT_EQ(cause(StopReason::no_value), "there is no value from 'decoder.out' to send (NaN)");
  EXPECT_EQ(cause(StopReason::terminated), "the run is over");
  EXPECT_EQ(cause(StopReason::ended), "the run is over");
}

TEST_F(TextsTest, the_emergency_stop_says_which_topic) {
  EXPECT_EQ(cause(StopReason::emergency), "emergency stop on topic '/stop'");
  EXPECT_EQ(cause(StopReason::stop_button), "STOP is pressed in the live view");
  EXPECT_EQ(cause(StopReason::suspended), "the run is suspended (Ctrl-Z); fg continues it");
  EXPECT_EQ(cause(StopReason::unsupervised),
            "the launcher or mpirun is stopped (SIGSTOP), or the machine is too busy");
  EXPECT_EQ(cause(StopReason::unguarded), "no guard answers, and guard_required is true");
  EXPECT_EQ(cause(StopReason::emergency_unknown),
            "the emergency stop's topic '/stop' has no publisher");
  settings_.emergency_stop.latched = true;
  settings_.emergency_stop.timeout = 200'000'000;
  EXPECT_EQ(cause(StopReason::emergency),
            "emergency stop on topic '/stop', until the end of the run");
  EXPECT_EQ(cause(StopReason::emergency_unknown),
            "the emergency stop's topic '/stop' has no publisher, or no message for 200 ms");
}

TEST_F(TextsTest, a_cut_value_says_what_to_write) {
  EXPECT_EQ(cut_warning({0, 1.5}, settings_),
            "the value 1.5 of field 'linear.x' is beyond its limits [-1, 1] and is cut, as others "
            "may be; to drive faster, write  limits: {linear.x: [MIN, MAX]}");
}

TEST_F(TextsTest, counters_have_the_reasons_names) {
  const char* names[] = {"without_value", "not_finite",     "data_too_old",
                         "sensor_silent", "no_spike",       "no_tick",
                         "continued",     "emergency_stop", "emergency_stop_unknown",
                         "stop_button",   "suspended",      "unsupervised",
                         "unguarded",     "terminated",     "ended"};
  const auto counters = channel_.counters();
  ASSERT_EQ(counters.size(), 5 + kStopReasons);
  for (std::size_t i = 0; i < kStopReasons; ++i) {
    EXPECT_EQ(counters[5 + i].name, std::string("stops_") + names[i]);
  }
}

}  // namespace
}  // namespace spikeloop::command
