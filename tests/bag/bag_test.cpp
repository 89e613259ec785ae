// What a run writes is what a reader finds.
#include <gmock/gmock.h>

#include <algorithm>

#include "spikeloop/bag/reader.hpp"
#include "spikeloop/bag/recorder.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/recorded_type.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// std_msgs/Float64: its eight bytes.
std::vector<std::byte> number(double value) {
  std::vector<std::byte> bytes(sizeof value);
  std::copy_n(reinterpret_cast<const std::byte*>(&value), sizeof value, bytes.begin());
  return bytes;
}

using Numbers = std::vector<std::pair<TimeNs, double>>;

Numbers numbers_of(bag::Stream stream) {
  Numbers result;
  while (const auto message = stream.next()) {
    EXPECT_THAT(message->bytes, SizeIs(sizeof(double)));
    double value = 0;
    std::copy_n(message->bytes.begin(), sizeof value, reinterpret_cast<std::byte*>(&value));
    result.emplace_back(message->time, value);
  }
  return result;
}

class Bag : public testing::Test {
 protected:
  std::string file() const { return (directory_.path() / "messages.mcap").string(); }

  test::TemporaryDirectory directory_;
};

TEST_F(Bag, GivesMessagesBackInOrderAndAtTheirTimes) {
  bag::Recorder recorder(file());
  const auto left = recorder.add({"/left", "std_msgs/Float64", "a"});
  const auto right = recorder.add({"/right", "std_msgs/Float64", "b"});
  recorder.take(left, 0, number(1));
  recorder.take(left, 0, number(2));
  recorder.take(right, 2, number(3));
  recorder.take(left, 5'000'000'000, number(4));
  recorder.take(left, 5'000'000'000, number(-4));
  recorder.take(left, 5'000'000'000, number(0));
  const bag::Report report = recorder.close();
  EXPECT_EQ(report.written, 6u);
  EXPECT_EQ(report.dropped, 0u);
  EXPECT_EQ(report.error, "");

  const bag::Reader reader(file());
  EXPECT_TRUE(reader.is_of_a_run());
  EXPECT_EQ(reader.end(), 5'000'000'000);
  EXPECT_EQ(reader.end_of("/right"), 2);
  EXPECT_EQ(reader.end_of("/middle"), std::nullopt);
  EXPECT_EQ(numbers_of(reader.stream("/left", "a")),
            (Numbers{{0, 1}, {0, 2}, {5'000'000'000, 4}, {5'000'000'000, -4}, {5'000'000'000, 0}}));
  EXPECT_EQ(numbers_of(reader.stream("/right", "b")), (Numbers{{2, 3}}));
  EXPECT_THAT(numbers_of(reader.stream("/middle", "b")), IsEmpty());
}

TEST_F(Bag, KeepsTypesAndDefinitions) {
  bag::Recorder recorder(file());
  recorder.take(recorder.add({"/cmd_vel", "Twist", "wheels"}), 1, std::vector<std::byte>(48));
  recorder.close();
  const bag::Reader reader(file());
  ASSERT_THAT(reader.connections(), SizeIs(1));
  const bag::Connection& connection = reader.connections().front();
  EXPECT_EQ(connection.topic, "/cmd_vel");
  EXPECT_EQ(connection.type, "geometry_msgs/Twist");
  EXPECT_EQ(connection.dialect, messages::Dialect::ros1);
  EXPECT_EQ(messages::compare_types(connection.schema, connection.version,
                                    messages::Catalog::builtin(messages::Dialect::ros1),
                                    "geometry_msgs/Twist")
                .fit,
            messages::Fit::same);
  EXPECT_EQ(connection.node, "wheels");
}

TEST_F(Bag, KeepsAnyDefinition) {
  const messages::Schema schema{"cdr", "spikeloop/msg/Signal", "ros2msg", "float64[] values\n"};
  bag::Recorder recorder(file());
  recorder.take(recorder.add_channel({"/brain/out", schema, "brain"}), 1, number(1));
  recorder.take(recorder.add({"/x", "std_msgs/Float64", "x"}), 1, number(1));
  recorder.close();
  const bag::Reader reader(file());
  ASSERT_THAT(reader.connections(), SizeIs(2));
  const bag::Connection& connection = reader.connections().front();
  EXPECT_EQ(connection.schema.type, schema.type);
  EXPECT_EQ(connection.schema.definition, schema.definition);
  EXPECT_EQ(connection.schema.encoding, schema.encoding);
  EXPECT_EQ(connection.schema.definition_encoding, schema.definition_encoding);
  EXPECT_EQ(connection.node, "brain");
  EXPECT_EQ(reader.dialect(), messages::Dialect::ros1) << "that of the robot";
}

TEST_F(Bag, KeepsNodesOfOneTopicApart) {
  bag::Recorder recorder(file());
  const auto early = recorder.add({"/x", "std_msgs/Float64", "early"});
  const auto late = recorder.add({"/x", "std_msgs/Float64", "late"});
  recorder.take(early, 1000, number(7));
  recorder.take(late, 2000, number(7));
  recorder.close();
  const bag::Reader reader(file());
  EXPECT_EQ(numbers_of(reader.stream("/x", "early")), (Numbers{{1000, 7}}));
  EXPECT_EQ(numbers_of(reader.stream("/x", "late")), (Numbers{{2000, 7}}));
  // A node of another experiment gets no message twice.
  EXPECT_EQ(numbers_of(reader.stream("/x", "somebody")), (Numbers{{1000, 7}}));
}

TEST_F(Bag, StreamOutlivesItsReader) {
  bag::Recorder recorder(file());
  recorder.take(recorder.add({"/x", "std_msgs/Float64", "a"}), 10, number(5));
  recorder.close();
  std::optional<bag::Stream> stream;
  {
    const bag::Reader reader(file());
    stream = reader.stream("/x", "a");
  }
  EXPECT_EQ(numbers_of(std::move(*stream)), (Numbers{{10, 5}}));
}

TEST_F(Bag, OfARunWithoutMessagesIsEmpty) {
  bag::Recorder recorder(file());
  recorder.add({"/x", "std_msgs/Float64", "a"});
  recorder.close();
  const bag::Reader reader(file());
  EXPECT_THAT(reader.connections(), IsEmpty());
  EXPECT_EQ(reader.end(), 0);
  EXPECT_THAT(numbers_of(reader.stream("/x", "a")), IsEmpty());
}

/// Several chunks, from a loop that never waits to one that does.
TEST_F(Bag, PatientRecorderLosesNothing) {
  constexpr int kMessages = 5'000;
  bag::Recorder recorder(file(), {.capacity_bytes = 1, .patient = true});
  const auto connection = recorder.add({"/x", "std_msgs/Float64", "a"});
  for (int i = 0; i < kMessages; ++i) {
    recorder.take(connection, i, number(i));
  }
  const bag::Report report = recorder.close();
  EXPECT_EQ(report.written, static_cast<std::uint64_t>(kMessages));
  EXPECT_EQ(report.dropped, 0u);
  const Numbers read = numbers_of(bag::Reader(file()).stream("/x", "a"));
  ASSERT_THAT(read, SizeIs(kMessages));
  for (int i = 0; i < kMessages; ++i) {
    ASSERT_EQ(read[static_cast<std::size_t>(i)].second, i);
  }
}

TEST_F(Bag, WhatFindsNoRoomIsCounted) {
  bag::Recorder recorder(file(), {.capacity_bytes = 8});
  const auto connection = recorder.add({"/x", "std_msgs/Float64", "a"});
  std::uint64_t sent = 0;
  while (sent < 100'000) {
    recorder.take(connection, static_cast<TimeNs>(++sent), number(1));
  }
  const bag::Report report = recorder.close();
  EXPECT_GT(report.dropped, 0u);
  EXPECT_EQ(report.written + report.dropped, sent);
  EXPECT_EQ(report.error, "'" + file() + "' is incomplete: " + std::to_string(report.dropped) +
                              " messages are lost, because the disk is slower than the data; write "
                              "to a faster disk");
  EXPECT_THAT(numbers_of(bag::Reader(file()).stream("/x", "a")), SizeIs(report.written));
}

TEST_F(Bag, WhatComesAfterTheEndIsCounted) {
  bag::Recorder recorder(file(), {.patient = true});
  const auto connection = recorder.add({"/x", "std_msgs/Float64", "a"});
  recorder.take(connection, 1, number(1));
  EXPECT_EQ(recorder.close().dropped, 0u);
  recorder.take(connection, 2, number(2));
  EXPECT_EQ(recorder.close().dropped, 1u);
  EXPECT_EQ(recorder.close().written, 1u);
}

TEST_F(Bag, TypeThatIsUnknownIsRefused) {
  bag::Recorder recorder(file());
  EXPECT_THROW(recorder.add({"/x", "std_msgs/Float65", "a"}), ConfigurationError);
}

}  // namespace
}  // namespace spikeloop
