#include "spikeloop/messages/definition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/core/error.hpp"
#include "tests/support/fault.hpp"

namespace definition_test {
namespace {

using namespace spikeloop::messages;
using spikeloop::test::Fault;
using testing::HasSubstr;
using testing::StrEq;

std::string error_of(std::string_view text, std::string_view name = "my_msgs/Thing") {
  try {
    parse_definition(name, text, Dialect::ros1);
  } catch (const spikeloop::ConfigurationError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Definition, fields_of_all_kinds) {
  const Definition definition =
      parse_definition("my_msgs/Thing",
                       "# a comment\n\n  float64[36]   covariance # another\nHeader header\n"
                       "Part[] parts\r\ngeometry_msgs/Point[2] ends\nbyte b\nchar c\n"
                       "string name\nduration wait",
                       Dialect::ros1);
  ASSERT_EQ(definition.fields.size(), 8u);
  EXPECT_EQ(definition.fields[0].written_type, "float64[36]");
  EXPECT_EQ(definition.fields[0].type, "float64");
  EXPECT_EQ(definition.fields[0].array, ArrayKind::fixed);
  EXPECT_EQ(definition.fields[0].count, 36u);
  EXPECT_EQ(definition.fields[1].type, "std_msgs/Header");
  EXPECT_EQ(definition.fields[2].type, "my_msgs/Part");
  EXPECT_EQ(definition.fields[2].array, ArrayKind::variable);
  EXPECT_EQ(definition.fields[3].type, "geometry_msgs/Point");
  EXPECT_EQ(definition.fields[4].primitive, Primitive::int8);
  EXPECT_EQ(definition.fields[5].primitive, Primitive::uint8);
  EXPECT_EQ(definition.fields[6].primitive, Primitive::text);
  EXPECT_EQ(definition.fields[7].primitive, Primitive::duration);
}

TEST(Definition, constants) {
  const Definition definition =
      parse_definition("my_msgs/Thing",
                       "uint8 OK = 0 # fine\nstring GREETING=  a # b = c  \nbool YES=True\n"
                       "float32 HALF=0.5\nint8 value",
                       Dialect::ros1);
  ASSERT_EQ(definition.constants.size(), 4u);
  EXPECT_EQ(definition.constants[0].name, "OK");
  EXPECT_EQ(definition.constants[0].value, "0");
  EXPECT_EQ(definition.constants[1].value, "a # b = c");
  EXPECT_EQ(definition.constants[2].value, "True");
  EXPECT_EQ(definition.constants[3].value, "0.5");
  EXPECT_EQ(definition.fields.size(), 1u);
}

TEST(Definition, errors_say_what_to_write) {
  EXPECT_THAT(error_of("float64 x", "Thing"),
              StrEq("message type 'Thing' has no package; write package/Type, as in "
                    "sensor_msgs/LaserScan [SL0502]"));
  EXPECT_THAT(error_of("\nfloat64"),
              Fault("my_msgs/Thing.msg:2: 'float64' ... 'type name' ... [SL0503]"));
  EXPECT_THAT(
      error_of("float64[<=3] x"),
      Fault("... bounded type 'float64[<=3]' ... ROS 1; write it without '<=' ... [SL0503] ..."));
  EXPECT_THAT(error_of("string<=3 x"),
              Fault("... bounded type 'string<=3' ... ROS 1 ... [SL0503] ..."));
  EXPECT_THAT(error_of("float64[x] x"),
              HasSubstr("'[x]' is not an array length; write [] or [number]"));
  EXPECT_THAT(error_of("float64[3 x"), Fault("... '[3' ... [SL0503] ..."));
  EXPECT_THAT(error_of("a//b x"),
              HasSubstr("'a//b' is not a type; write a built-in type, Type or package/Type"));
  EXPECT_THAT(
      error_of("float64 1x"),
      Fault("... '1x' ... write a letter followed by letters, digits and '_' ... [SL0503] ..."));
  EXPECT_THAT(error_of("float64 x y"), Fault("... 'x y' ... [SL0503] ..."));
  EXPECT_THAT(error_of("float64 x\nfloat32 x"),
              HasSubstr("my_msgs/Thing.msg:2: field 'x' is there twice; give one of them another "
                        "name"));
  EXPECT_THAT(error_of("time NOW=0"),
              HasSubstr("a constant cannot have type 'time'; write a number type or string"));
  EXPECT_THAT(error_of("int8 N=one"), Fault("... 'N' ... 'one' ... [SL0503]"));
}

}  // namespace
}  // namespace definition_test
