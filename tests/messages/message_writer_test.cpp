#include "spikeloop/messages/message_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <span>

#include "spikeloop/core/error.hpp"
#include "tests/support/fault.hpp"

namespace message_writer_test {
namespace {

using spikeloop::test::Fault;
using testing::ElementsAre;
using namespace spikeloop::messages;

std::string error_of(std::string_view type, std::vector<std::string> paths) {
  try {
    MessageWriter(Catalog::builtin(Dialect::ros1), type, std::move(paths));
  } catch (const spikeloop::ConfigurationError& error) {
    return error.what();
  }
  return "no error";
}

TEST(MessageWriter, fields_that_are_not_named_are_zero) {
  const MessageWriter writer(Catalog::builtin(Dialect::ros1), "Twist", {"angular.z"});
  const std::vector<double> turn = {0.5};
  const std::vector<FieldValue> values = {{turn, {}}};
  std::vector<std::byte> bytes(3);
  writer.write(values, bytes);
  ASSERT_EQ(bytes.size(), 48u);
  EXPECT_TRUE(std::all_of(bytes.begin(), bytes.begin() + 40,
                          [](std::byte byte) { return byte == std::byte{0}; }));
  std::vector<double> read;
  FieldReader(Catalog::builtin(Dialect::ros1), "Twist", "angular.z").read(bytes, read);
  EXPECT_EQ(read, turn);
}

TEST(MessageWriter, arrays_are_as_long_as_their_values) {
  const MessageWriter writer(Catalog::builtin(Dialect::ros1), "Float64MultiArray", {"data"});
  std::vector<std::byte> bytes;
  for (const std::size_t count : {0u, 1u, 7u}) {
    const std::vector<double> numbers(count, 0.25);
    writer.write(std::vector<FieldValue>{{numbers, {}}}, bytes);
    EXPECT_EQ(bytes.size(), 4 + 4 + 4 + 8 * count);
    std::vector<double> read;
    FieldReader(Catalog::builtin(Dialect::ros1), "Float64MultiArray", "data").read(bytes, read);
    EXPECT_EQ(read, numbers);
  }
}

TEST(MessageWriter, bytes_are_the_same_as_their_numbers) {
  for (const Dialect dialect : {Dialect::ros1, Dialect::ros2}) {
    const MessageWriter writer(Catalog::builtin(dialect), "Image", {"height", "data"});
    const double height = 2;
    std::vector<double> numbers;
    std::vector<std::byte> pixels;
    for (int i = 0; i < 300; ++i) {
      numbers.push_back(i % 256);
      pixels.push_back(static_cast<std::byte>(i));
    }
    std::vector<std::byte> one;
    std::vector<std::byte> other;
    writer.write(std::vector<FieldValue>{{{&height, 1}}, {numbers}}, one);
    writer.write(std::vector<FieldValue>{{{&height, 1}}, {.bytes = pixels}}, other);
    EXPECT_EQ(one, other);
    EXPECT_THROW(writer.write(std::vector<FieldValue>{{.bytes = pixels}, {numbers}}, other),
                 std::logic_error);
  }
}

/// The numbers of `path` in a message of `paths` that are 1, 2, ...
std::vector<double> written(Dialect dialect, const char* type, std::vector<std::string> paths,
                            const char* path) {
  const Catalog& catalog = Catalog::builtin(dialect);
  const MessageWriter writer(catalog, type, paths);
  std::vector<double> numbers(paths.size());
  std::iota(numbers.begin(), numbers.end(), 1);
  std::vector<FieldValue> values;
  for (const double& number : numbers) {
    values.push_back({std::span(&number, 1)});
  }
  std::vector<std::byte> bytes;
  writer.write(values, bytes);
  std::vector<double> read;
  FieldReader(catalog, type, path).read(bytes, read);
  return read;
}

// Isaac Sim and ros2_control read NaN as "not commanded".
TEST(MessageWriter, joints_that_no_path_names_are_not_commanded) {
  const auto no_command = testing::IsNan();
  for (const Dialect dialect : {Dialect::ros1, Dialect::ros2}) {
    const std::vector<std::string> mixed = {"velocity[name=rear]", "position[name=steer]"};
    EXPECT_THAT(written(dialect, "JointState", mixed, "position"), ElementsAre(no_command, 2));
    EXPECT_THAT(written(dialect, "JointState", mixed, "velocity"), ElementsAre(1, no_command));
    EXPECT_THAT(written(dialect, "JointState", mixed, "effort"), ElementsAre());
    const std::vector<std::string> indices = {"velocity[0]", "position[2]"};
    EXPECT_THAT(written(dialect, "JointState", indices, "velocity"),
                ElementsAre(1, no_command, no_command));
    EXPECT_THAT(written(dialect, "JointState", indices, "position"),
                ElementsAre(no_command, no_command, 2));
    EXPECT_THAT(written(dialect, "Float64MultiArray", {"data[0]", "data[2]"}, "data"),
                ElementsAre(1, no_command, 2));
    const std::vector<std::string> point = {"points[0].positions[1]", "points[0].velocities[0]"};
    EXPECT_THAT(written(dialect, "JointTrajectory", point, "points[0].positions"),
                ElementsAre(no_command, 1));
    EXPECT_THAT(written(dialect, "JointTrajectory", point, "points[0].velocities"),
                ElementsAre(2, no_command));
    EXPECT_THAT(written(dialect, "MultiDOFJointState",
                        {"twist[joint_names=b].linear.x", "wrench[joint_names=c].force.x"},
                        "twist.linear.x"),
                ElementsAre(1, no_command));
  }
}

TEST(MessageWriter, other_arrays_are_filled_with_zeros) {
  for (const Dialect dialect : {Dialect::ros1, Dialect::ros2}) {
    EXPECT_THAT(written(dialect, "Joy", {"axes[2]"}, "axes"), ElementsAre(0, 0, 1));
    EXPECT_THAT(written(dialect, "Int32MultiArray", {"data[1]"}, "data"), ElementsAre(0, 1));
  }
}

TEST(MessageWriter, errors_say_what_to_write) {
  EXPECT_THAT(error_of("Twist", {"linear.x", "linear.x"}),
              Fault("field paths 'linear.x' and 'linear.x' of geometry_msgs/Twist set the same "
                    "value ... [SL0504]"));
  EXPECT_THAT(error_of("Clock", {"clock", "clock.secs"}),
              Fault("field paths 'clock' and 'clock.secs' of rosgraph_msgs/Clock ... [SL0504]"));
  EXPECT_EQ(error_of("MultiArrayLayout", {"dim.size"}),
            "field path 'dim.size' of std_msgs/MultiArrayLayout: the array's length is not known; "
            "name its elements, as in [0] [SL0504]");
  EXPECT_EQ(error_of("tf2_msgs/TFMessage", {"transforms[16000000].transform.translation.x"}),
            "field path 'transforms[16000000].transform.translation.x' of tf2_msgs/TFMessage: the "
            "message would be longer than 1 GB; name elements nearer to the first one [SL0504]");
  const MessageWriter writer(Catalog::builtin(Dialect::ros1), "PoseWithCovariance", {"covariance"});
  const std::vector<double> numbers(3);
  std::vector<std::byte> bytes;
  try {
    writer.write(std::vector<FieldValue>{{numbers, {}}}, bytes);
    FAIL();
  } catch (const spikeloop::ConfigurationError& error) {
    EXPECT_STREQ(
        error.what(),
        "field 'covariance' of geometry_msgs/PoseWithCovariance takes 36 values, not 3 [SL0504]");
  }
  EXPECT_THROW(writer.write({}, bytes), std::logic_error);
}

}  // namespace
}  // namespace message_writer_test
