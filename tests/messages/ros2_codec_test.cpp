// What ROS 2's bytes and fields have of their own; codec_test.cpp has the rest.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "tests/support/fault.hpp"

namespace ros2_codec_test {
namespace {

using spikeloop::test::Fault;
using namespace spikeloop::messages;
using testing::ElementsAre;

using Bytes = std::vector<std::byte>;

Bytes bytes(std::initializer_list<int> values) {
  Bytes made;
  for (const int value : values) {
    made.push_back(static_cast<std::byte>(value));
  }
  return made;
}

Catalog own(std::string_view text) {
  Catalog catalog = Catalog::builtin(Dialect::ros2);
  catalog.add("my_msgs/Thing", text);
  return catalog;
}

std::vector<double> read(const Catalog& catalog, std::string_view path, const Bytes& message) {
  std::vector<double> numbers;
  FieldReader(catalog, "my_msgs/Thing", path).read(message, numbers);
  return numbers;
}

std::string error_of_reading(const Bytes& message) {
  try {
    read(own("string text\nuint16 number"), "number", message);
  } catch (const spikeloop::TransportError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Ros2Codec, encapsulation_and_padding) {
  const Catalog catalog = own("uint8 a\nuint16 b");
  EXPECT_THAT(read(catalog, "b", bytes({0, 1, 0, 0, 7, 0, 1, 2})), ElementsAre(0x0201));
  // Two bytes of padding behind the message, as the options say, belong to no field.
  EXPECT_THAT(read(catalog, "b", bytes({0, 1, 0, 2, 7, 0, 1, 2, 0, 0})), ElementsAre(0x0201));
  EXPECT_THROW(read(catalog, "b", bytes({0, 1, 0, 2, 7, 0, 1, 2})), spikeloop::TransportError);
  // One without the padding that it had.
  EXPECT_THAT(read(own("uint16 a\nuint8 b"), "b", bytes({0, 1, 0, 1, 1, 2, 7})), ElementsAre(7));
  // Some transports pad without saying so.
  EXPECT_THAT(read(catalog, "b", bytes({0, 1, 0, 0, 7, 0, 1, 2, 0, 0})), ElementsAre(0x0201));
}

TEST(Ros2Codec, errors_say_what_is_wrong) {
  EXPECT_EQ(error_of_reading({}),
            "message of 0 bytes is too short to say how it is encoded [SL0509]");
  EXPECT_THAT(error_of_reading(bytes({0, 1, 0})), Fault("message of 3 ... [SL0509]"));
  EXPECT_EQ(error_of_reading(bytes({0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 5})),
            "message of 12 bytes has encoding 0, not 1 (plain CDR in little endian), the one that "
            "ROS 2 has [SL0509]");
  EXPECT_EQ(error_of_reading(bytes({0, 7, 0, 0, 1, 0, 0, 0, 0, 0, 5, 0})),
            "message of 12 bytes has encoding 7, not 1 (plain CDR in little endian), the one that "
            "ROS 2 has [SL0509]");
  EXPECT_EQ(
      error_of_reading(bytes({0, 1, 0, 0, 2, 0, 0, 0, 'a', 'b', 5, 0})),
      "message of 12 bytes has a text that does not end in a zero byte (before byte 10) [SL0509]");
  EXPECT_THAT(error_of_reading(bytes({0, 1, 0, 0, 2, 0, 0, 0, 'a', 0, 5})),
              Fault("message of 11 ... (at byte 10) ... [SL0509]"));
  EXPECT_THAT(error_of_reading(bytes({0, 1, 0, 0, 255, 255, 255, 255, 'a', 0, 5})),
              Fault("message of 11 ... (at byte 8) ... [SL0509]"));
}

TEST(Ros2Codec, a_text_of_no_bytes_is_empty) {
  const Catalog catalog = own("string text\nuint16 number");
  const Bytes message = bytes({0, 1, 0, 0, 0, 0, 0, 0, 5, 0});
  EXPECT_THAT(read(catalog, "number", message), ElementsAre(5));
  std::vector<std::string_view> texts;
  TextField(catalog, "my_msgs/Thing", "text").read(message, texts);
  EXPECT_THAT(texts, ElementsAre(""));
}

TEST(Ros2Codec, empty_messages_have_one_byte) {
  Bytes message;
  MessageWriter(Catalog::builtin(Dialect::ros2), "std_msgs/Empty", {}).write({}, message);
  EXPECT_EQ(message, bytes({0, 1, 0, 0, 0}));
}

TEST(Ros2Codec, fields_that_nobody_sets_have_their_default_values) {
  const Catalog catalog =
      own("float64 x 1.5\nint8[3] list [1, 2, 3]\nint8[] more [4, 5]\nstring text 'abc'\n"
          "string[] texts [a, b]\ngeometry_msgs/Quaternion turn\nint8 zero");
  Bytes message;
  const MessageWriter writer(catalog, "my_msgs/Thing", {"list[1]"});
  const double value[] = {9};
  const FieldValue values[] = {{value, {}}};
  writer.write(values, message);
  EXPECT_THAT(read(catalog, "x", message), ElementsAre(1.5));
  EXPECT_THAT(read(catalog, "list", message), ElementsAre(1, 9, 3));
  EXPECT_THAT(read(catalog, "more", message), ElementsAre(4, 5));
  EXPECT_THAT(read(catalog, "turn.w", message), ElementsAre(1));
  EXPECT_THAT(read(catalog, "turn.x", message), ElementsAre(0));
  EXPECT_THAT(read(catalog, "zero", message), ElementsAre(0));
  std::vector<std::string_view> texts;
  TextField(catalog, "my_msgs/Thing", "text").read(message, texts);
  TextField(catalog, "my_msgs/Thing", "texts").read(message, texts);
  EXPECT_THAT(texts, ElementsAre("abc", "a", "b"));
}

TEST(Ros2Codec, times_have_the_names_of_both_dialects) {
  const Catalog catalog = own("std_msgs/Header header\nbuiltin_interfaces/Duration wait");
  Bytes message;
  const MessageWriter writer(catalog, "my_msgs/Thing", {"header.stamp", "wait"});
  const double stamp[] = {12.25};
  const double wait[] = {-1.25};
  const FieldValue values[] = {{stamp, {}}, {wait, {}}};
  writer.write(values, message);
  EXPECT_THAT(read(catalog, "header.stamp", message), ElementsAre(12.25));
  EXPECT_THAT(read(catalog, "header.stamp.sec", message), ElementsAre(12));
  EXPECT_THAT(read(catalog, "header.stamp.secs", message), ElementsAre(12));
  EXPECT_THAT(read(catalog, "header.stamp.nanosec", message), ElementsAre(250'000'000));
  EXPECT_THAT(read(catalog, "header.stamp.nsecs", message), ElementsAre(250'000'000));
  EXPECT_THAT(read(catalog, "wait", message), ElementsAre(-1.25));
  EXPECT_THAT(read(catalog, "wait.sec", message), ElementsAre(-2));
  try {
    compile_path(catalog, "my_msgs/Thing", "wait.seconds");
    ADD_FAILURE() << "no error";
  } catch (const spikeloop::ConfigurationError& error) {
    EXPECT_THAT(error.what(), Fault("field path 'wait.seconds' of my_msgs/Thing: ... 'seconds' ... "
                                    "wait.sec, wait.nanosec or wait (seconds) ... [SL0504]"));
  }
}

TEST(Ros2Codec, bounds_are_kept) {
  const Catalog catalog = own("string<=3 text\nint8[<=2] list");
  const auto error_of = [&](const std::vector<std::string>& paths, const FieldValue& value) {
    try {
      Bytes message;
      MessageWriter(catalog, "my_msgs/Thing", paths).write(std::span(&value, 1), message);
    } catch (const spikeloop::ConfigurationError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const double three[] = {1, 2, 3};
  EXPECT_EQ(error_of({"text"}, {{}, "abcd"}),
            "field 'text' of my_msgs/Thing takes at most 3 bytes, not the 4 of 'abcd' [SL0203]");
  EXPECT_EQ(error_of({"text"}, {{}, "abc"}), "no error");
  EXPECT_EQ(error_of({"list"}, {three, {}}),
            "field 'list' of my_msgs/Thing takes at most 2 values, not 3 [SL0203]");
  EXPECT_EQ(error_of({"list[1:]"}, {std::span(three).first(2), {}}),
            "field 'list[1:]' of my_msgs/Thing takes at most 1 values, not 2 [SL0203]");
  EXPECT_THAT(error_of({"list[2]"}, {std::span(three).first(1), {}}),
              Fault("field path 'list[2]' of my_msgs/Thing: 'list' has at most 2 elements ... [0] "
                    "... [SL0504]"));
}

// The layout skips what has no gaps as a whole, and goes through what has.
TEST(Ros2Codec, layouts_know_what_has_no_gaps) {
  const Catalog catalog =
      own("geometry_msgs/Pose[] poses\nbuiltin_interfaces/Time[2] times\nMixed mixed");
  Catalog whole = catalog;
  whole.add("my_msgs/Mixed", "uint8 a\nfloat64 b");
  const auto layout = whole.layout("my_msgs/Thing");
  EXPECT_EQ(layout->fields[0].element_bytes, 56u);
  EXPECT_EQ(layout->fields[0].alignment, 8u);
  EXPECT_EQ(layout->fields[1].element_bytes, 8u);
  EXPECT_EQ(layout->fields[1].alignment, 4u);
  EXPECT_EQ(layout->fields[2].element_bytes, std::nullopt);
  EXPECT_EQ(whole.layout("std_msgs/Empty")->bytes, 1u);
}

}  // namespace
}  // namespace ros2_codec_test
