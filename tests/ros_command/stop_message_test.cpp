// The message that stops an arm whose joint states are on a topic.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/ros_command/command_endpoint.hpp"
#include "spikeloop/topics/memory_session.hpp"

namespace spikeloop::ros_command::stop_message_test {
namespace {

using testing::ElementsAre;
using testing::IsNan;
using Dialect = messages::Dialect;

constexpr TimeNs kMs = 1'000'000;
constexpr const char* kType = "sensor_msgs/JointState";

/// An elbow with a position and a wheel with a velocity.
class StopMessageTest : public testing::TestWithParam<Dialect> {
 protected:
  static command::CommandSettings settings() {
    return {.process = "arm",
            .topic = "/joint_commands",
            .message_type = kType,
            .fields = {"position[name=elbow]", "velocity[name=wheel]"},
            .gate = {.deadband = {0, 0}},
            .clock = command::CommandClock::lockstep,
            .stops = {{.hold = true, .joint = "elbow"}, {}},
            .joint_states = "/joint_states"};
  }
  const messages::Catalog& catalog() const { return messages::Catalog::builtin(GetParam()); }

  void report(double elbow) {
    const messages::MessageWriter writer(catalog(), kType,
                                         {"position[name=other]", "position[name=elbow]"});
    const double numbers[] = {7, elbow};
    std::vector<std::byte> bytes;
    writer.write(std::vector<messages::FieldValue>{{std::span(numbers).first(1)},
                                                   {std::span(numbers).last(1)}},
                 bytes);
    states_->publish(bytes);
  }
  static void tick(Sink& sink, TimeNs end) {
    const double values[] = {1.5, 4};
    const spikeloop_signal_input input{values, 1, 2, 0};
    spikeloop_step data{};
    data.begin_ns = end - kMs;
    data.end_ns = end;
    data.signal_inputs = &input;
    data.signal_input_count = 1;
    sink.send(Step(data));
  }
  std::vector<double> last(const std::string& path) const {
    std::vector<double> numbers;
    messages::FieldReader(catalog(), kType, path).read(newest_, numbers);
    return numbers;
  }

  topics::MemorySession session_{GetParam()};
  std::unique_ptr<topics::RawPublisher> states_ = session_.publisher("/joint_states", kType);
  std::vector<std::byte> newest_;
  std::unique_ptr<topics::RawSubscriber> robot_ = session_.subscriber(
      {.topic = "/joint_commands", .message_type = kType, .take = [this](auto message) {
         newest_.assign(message.begin(), message.end());
       }});
  CommandEndpoint command_{session_, settings()};
};

TEST_P(StopMessageTest, holds_the_measured_position) {
  tick(command_.sink(), kMs);
  EXPECT_THAT(last("position"), ElementsAre(1.5, IsNan()));
  EXPECT_THAT(last("velocity"), ElementsAre(IsNan(), 4));
  report(0.4);
  EXPECT_EQ(command_.positions()->received(), 1U);
  command_.stop(command::StopReason::ended);
  EXPECT_THAT(last("position"), ElementsAre(0.4, IsNan()));
  EXPECT_THAT(last("velocity"), ElementsAre(IsNan(), 0));
}

TEST_P(StopMessageTest, holds_the_last_command_of_a_joint_that_nobody_reports) {
  tick(command_.sink(), kMs);
  command_.stop(command::StopReason::ended);
  EXPECT_THAT(last("position"), ElementsAre(1.5, IsNan()));
  EXPECT_THAT(last("velocity"), ElementsAre(IsNan(), 0));
}

TEST_P(StopMessageTest, commands_no_position_before_one_is_known) {
  command_.stop(command::StopReason::ended);
  EXPECT_THAT(last("position"), ElementsAre(IsNan(), IsNan()));
  EXPECT_THAT(last("velocity"), ElementsAre(IsNan(), 0));
}

INSTANTIATE_TEST_SUITE_P(Ros, StopMessageTest, testing::Values(Dialect::ros1, Dialect::ros2));

}  // namespace
}  // namespace spikeloop::ros_command::stop_message_test
