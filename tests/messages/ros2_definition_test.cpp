// What ROS 2's definition language has of its own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/definition.hpp"
#include "tests/support/fault.hpp"

namespace {

using namespace spikeloop::messages;
using spikeloop::test::Fault;
using testing::ElementsAre;

Definition parse(std::string_view text) {
  return parse_definition("my_msgs/Thing", text, Dialect::ros2);
}

FieldDefinition field(std::string_view line) {
  return parse(line).fields.at(0);
}

TEST(Ros2Definition, times_are_messages_of_builtin_interfaces) {
  EXPECT_EQ(field("builtin_interfaces/Time t").primitive, Primitive::time);
  EXPECT_EQ(field("builtin_interfaces/Time t").type, "builtin_interfaces/Time");
  EXPECT_EQ(field("builtin_interfaces/Duration[] t").primitive, Primitive::duration);
  const Definition within =
      parse_definition("builtin_interfaces/Span", "Time begin\nTime end", Dialect::ros2);
  EXPECT_EQ(within.fields[1].primitive, Primitive::time);
}

TEST(Ros2Definition, types_differ_from_ros_1) {
  EXPECT_EQ(field("byte b").primitive, Primitive::uint8);
  EXPECT_EQ(field("char c").primitive, Primitive::uint8);
  EXPECT_EQ(field("Header h").type, "my_msgs/Header");
}

TEST(Ros2Definition, bounds) {
  const FieldDefinition text = field("string<=10 s");
  EXPECT_EQ(text.type, "string");
  EXPECT_EQ(text.longest_text, 10u);
  const FieldDefinition sequence = field("int8[<=7] s");
  EXPECT_EQ(sequence.array, ArrayKind::variable);
  EXPECT_EQ(sequence.count, 7u);
  const FieldDefinition texts = field("string<=10[<=7] s");
  EXPECT_EQ(texts.primitive, Primitive::text);
  EXPECT_EQ(texts.longest_text, 10u);
  EXPECT_EQ(texts.count, 7u);
  EXPECT_EQ(field("string<=10[7] s").array, ArrayKind::fixed);
}

TEST(Ros2Definition, default_values) {
  EXPECT_THAT(field("float64 x 1.5").otherwise.numbers, ElementsAre(1.5));
  EXPECT_THAT(field("int8 x -2 # two").otherwise.numbers, ElementsAre(-2));
  EXPECT_THAT(field("uint16 x 0xFF").otherwise.numbers, ElementsAre(255));
  EXPECT_THAT(field("bool x true").otherwise.numbers, ElementsAre(1));
  EXPECT_THAT(field("int32[3] x [1, +2,3]").otherwise.numbers, ElementsAre(1, 2, 3));
  EXPECT_THAT(field("int32[<=3] x []").otherwise.numbers, ElementsAre());
  EXPECT_THAT(field("string s \"a # b\" # c").otherwise.texts, ElementsAre("a # b"));
  EXPECT_THAT(field("string s 'it\\'s'").otherwise.texts, ElementsAre("it's"));
  EXPECT_THAT(field("string s plain").otherwise.texts, ElementsAre("plain"));
  EXPECT_THAT(field("string s \"a=b\"").otherwise.texts, ElementsAre("a=b"));
  EXPECT_THAT(field("string[] s ['a, b', \"c]\"]").otherwise.texts, ElementsAre("a, b", "c]"));
}

TEST(Ros2Definition, constants) {
  const Definition definition = parse(
      "uint8 A = 0 # it's fine\nstring B=\"a # b\"\nstring C='c'\nstring D=d e # f\nbool E=true");
  ASSERT_EQ(definition.constants.size(), 5u);
  EXPECT_EQ(definition.constants[0].value, "0");
  EXPECT_EQ(definition.constants[1].value, "a # b");
  EXPECT_EQ(definition.constants[2].value, "c");
  EXPECT_EQ(definition.constants[3].value, "d e");
  EXPECT_EQ(definition.constants[4].value, "true");
}

struct Wrong {
  const char* text;
  const char* message;
};

class WrongRos2Definition : public testing::TestWithParam<Wrong> {};

TEST_P(WrongRos2Definition, says_what_to_write) {
  try {
    parse(GetParam().text);
    ADD_FAILURE() << "no error";
  } catch (const spikeloop::ConfigurationError& error) {
    EXPECT_THAT(error.what(), Fault(std::string("my_msgs/Thing.msg:1: ") + GetParam().message));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Lines, WrongRos2Definition,
    testing::Values(
        Wrong{"time t", "'time' ... ROS 2 ... builtin_interfaces/Time ... [SL0503]"},
        Wrong{"duration[3] t", "'duration' ... ROS 2 ... builtin_interfaces/Duration ... [SL0503]"},
        Wrong{"wstring s",
              "texts of type 'wstring' are not read here, and hardly used; write string [SL0503]"},
        Wrong{"string<=x s", "'string<=x' bounds no text; write string<=number [SL0503]"},
        Wrong{"string<=0 s", "'string<=0' bounds no text; write string<=number [SL0503]"},
        Wrong{"int8<=3 s", "'int8<=3' ... built-in type, Type or package/Type ... [SL0503]"},
        Wrong{"int8[<=0] s", "'[<=0]' ... [], [number] or [<=number] ... [SL0503]"},
        Wrong{"int8[0] s", "'[0]' ... [], [number] or [<=number] ... [SL0503]"},
        Wrong{"int8[3 s", "'[3' ... [], [number] or [<=number] ... [SL0503]"},
        Wrong{"int8[99999999999] s", "'[99999999999]' ... [], [number] or [<=number] ... [SL0503]"},
        Wrong{"int8 x 200",
              "field 'x' has default value '200', which int8 cannot hold; write a whole number "
              "from -128 to 127 [SL0503]"},
        Wrong{"uint8 x 1.5",
              "field 'x' ... '1.5', which uint8 cannot hold ... 0 to 255 ... [SL0503]"},
        Wrong{"uint64 x 1e99",
              "field 'x' ... '1e99', which uint64 cannot hold ... 0 to 18446744073709551615 ... "
              "[SL0503]"},
        Wrong{"float64 x one", "field 'x' ... 'one' ... [SL0503]"},
        Wrong{"bool x maybe",
              "field 'x' has default value 'maybe', which is neither true nor false [SL0503]"},
        Wrong{
            "int8[2] x 1",
            "field 'x' has default value '1', which is not a list; write [value, value] [SL0503]"},
        Wrong{"int8[2] x [1]",
              "field 'x' has default value '[1]', which has 1 elements; write 2 [SL0503]"},
        Wrong{"int8[<=2] x [1,2,3]",
              "field 'x' has default value '[1,2,3]', which has 3 elements; write at most 2 "
              "[SL0503]"},
        Wrong{"string[] x ['a]",
              "field 'x' has default value '['a]', which lacks a closing "
              "quotation mark [SL0503]"},
        Wrong{"string x \"a",
              "field 'x' has default value '\"a', which does not end with its quotation mark "
              "[SL0503]"},
        Wrong{"string<=2 x abc",
              "field 'x' has default value 'abc', which is longer than 2 bytes [SL0503]"},
        Wrong{"Part x 1",
              "field 'x' is a my_msgs/Part, which has no default value; take '1' out [SL0503]"},
        Wrong{"int8 A=200",
              "constant 'A' has value '200', which int8 cannot hold ... -128 to 127 ... [SL0503]"},
        Wrong{"string A='x", "constant 'A' has value ''x' ... [SL0503]"},
        Wrong{"Part A=1", "... 'Part' ... [SL0503]"},
        Wrong{"int8 =3", "'' ... digits and '_' ... [SL0503]"}),
    [](const testing::TestParamInfo<Wrong>& each) { return "row" + std::to_string(each.index); });

}  // namespace
