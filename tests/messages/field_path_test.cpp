#include "spikeloop/messages/field_path.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "tests/support/fault.hpp"

namespace field_path_test {
namespace {

using spikeloop::test::Fault;
using namespace spikeloop::messages;
using testing::ElementsAre;

Catalog test_catalog() {
  Catalog catalog = Catalog::builtin(Dialect::ros1);
  catalog.add("my_msgs/All",
              "bool truth\nint8 a\nuint8 b\nint16 c\nuint16 d\nint32 e\nuint32 f\nint64 g\n"
              "uint64 h\nfloat32 i\nfloat64 j\ntime k\nduration l\nstring m\nstring[] n\n"
              "geometry_msgs/Point[] points\nstd_msgs/String[2] names\nint16[3] fixed\n"
              "std_msgs/Empty[] nothing\nfloat64 last\nsensor_msgs/Joy[] nested");
  return catalog;
}

std::string error_of(std::string_view path, std::string_view type = "my_msgs/All") {
  const Catalog catalog = test_catalog();
  try {
    FieldReader(catalog, type, path);
  } catch (const spikeloop::ConfigurationError& error) {
    return error.what();
  }
  return "no error";
}

std::vector<std::byte> write(std::vector<std::string> paths,
                             const std::vector<std::vector<double>>& numbers) {
  const Catalog catalog = test_catalog();
  std::vector<FieldValue> values;
  for (const auto& each : numbers) {
    values.push_back({each, {}});
  }
  std::vector<std::byte> bytes;
  MessageWriter(catalog, "my_msgs/All", std::move(paths)).write(values, bytes);
  return bytes;
}

std::vector<double> read(std::string_view path, std::span<const std::byte> bytes) {
  const Catalog catalog = test_catalog();
  std::vector<double> values;
  FieldReader(catalog, "my_msgs/All", path).read(bytes, values);
  return values;
}

TEST(FieldPath, every_number_type_keeps_its_range) {
  const std::vector<std::pair<std::string, std::pair<double, double>>> ranges = {
      {"truth", {0, 1}},
      {"a", {-128, 127}},
      {"b", {0, 255}},
      {"c", {-32768, 32767}},
      {"d", {0, 65535}},
      {"e", {-2147483648.0, 2147483647.0}},
      {"f", {0, 4294967295.0}},
      {"g", {-9223372036854775808.0, 9223372036854775807.0}},
      {"h", {0, 18446744073709551615.0}},
  };
  for (const auto& [path, range] : ranges) {
    if (path != "truth") {
      EXPECT_THAT(read(path, write({path}, {{-1e300}})), ElementsAre(range.first)) << path;
    }
    EXPECT_THAT(read(path, write({path}, {{1e300}})), ElementsAre(range.second)) << path;
    EXPECT_THAT(read(path, write({path}, {{std::nan("")}})), ElementsAre(0)) << path;
  }
  EXPECT_THAT(read("e", write({"e"}, {{2.6}})), ElementsAre(3));
}

TEST(FieldPath, times_are_seconds_or_their_parts) {
  EXPECT_THAT(read("k", write({"k"}, {{12.25}})), ElementsAre(12.25));
  EXPECT_THAT(read("k.secs", write({"k"}, {{12.25}})), ElementsAre(12));
  EXPECT_THAT(read("k.nsecs", write({"k"}, {{12.25}})), ElementsAre(250000000));
  EXPECT_THAT(read("l", write({"l"}, {{-1.25}})), ElementsAre(-1.25));
  EXPECT_THAT(read("l.secs", write({"l.secs", "l.nsecs"}, {{-2}, {750000000}})), ElementsAre(-2));
  EXPECT_THAT(read("k", write({"k"}, {{0.9999999999}})), ElementsAre(1.0));
}

TEST(FieldPath, elements) {
  const auto bytes =
      write({"points[0].x", "points[2].y", "fixed", "last"}, {{1}, {2}, {7, 8, 9}, {42}});
  EXPECT_THAT(read("points.x", bytes), ElementsAre(1, 0, 0));
  EXPECT_THAT(read("points[1:].y", bytes), ElementsAre(0, 2));
  EXPECT_THAT(read("points[2].y", bytes), ElementsAre(2));
  EXPECT_THAT(read("points[5].y", bytes), ElementsAre());
  EXPECT_THAT(read("points[1:9].y", bytes), ElementsAre(0, 2));
  EXPECT_THAT(read("fixed[1:3]", bytes), ElementsAre(8, 9));
  EXPECT_THAT(read("fixed[:2]", bytes), ElementsAre(7, 8));
  EXPECT_THAT(read("last", bytes), ElementsAre(42));
  EXPECT_EQ(compile_path(test_catalog(), "my_msgs/All", "fixed[1:]").width(), 2u);
  EXPECT_EQ(compile_path(test_catalog(), "my_msgs/All", "points[0:4].x").width(), 4u);
  EXPECT_EQ(compile_path(test_catalog(), "my_msgs/All", "points.x").width(), std::nullopt);
}

TEST(FieldPath, errors_say_what_to_write) {
  EXPECT_EQ(error_of("rangs", "sensor_msgs/LaserScan"),
            "field path 'rangs' of sensor_msgs/LaserScan: sensor_msgs/LaserScan has no field "
            "'rangs'; did you mean 'ranges'? [SL0504]");
  EXPECT_EQ(error_of("linear", "Twist"),
            "field path 'linear' of geometry_msgs/Twist: 'linear' is a geometry_msgs/Vector3, no "
            "number; go on with one of its fields: x, y, z [SL0504]");
  EXPECT_EQ(error_of("j.x"),
            "field path 'j.x' of my_msgs/All: 'j' is a single value without fields; end the path "
            "there [SL0504]");
  EXPECT_THAT(error_of("j[0]"), Fault("field path 'j[0]' of my_msgs/All: 'j' is not an array; "
                                      "write it without '[0]' [SL0504]"));
  EXPECT_EQ(error_of("fixed[x]"),
            "field path 'fixed[x]' of my_msgs/All: '[x]' selects nothing; write [index], "
            "[first:end] or [name=text] [SL0504]");
  EXPECT_EQ(error_of("fixed[]"),
            "field path 'fixed[]' of my_msgs/All: '[]' selects nothing; write [index], "
            "[first:end] or [name=text] [SL0504]");
  EXPECT_EQ(error_of("fixed[2:2]"),
            "field path 'fixed[2:2]' of my_msgs/All: '[2:2]' is empty; the end comes after the "
            "first element [SL0504]");
  EXPECT_EQ(error_of("fixed[3]"),
            "field path 'fixed[3]' of my_msgs/All: 'fixed' has 3 elements; the first one is [0] "
            "[SL0504]");
  EXPECT_EQ(error_of("k.seconds"),
            "field path 'k.seconds' of my_msgs/All: a time has no field 'seconds'; write k.secs, "
            "k.nsecs or k (seconds) [SL0504]");
  EXPECT_THAT(error_of("m"), Fault("field path 'm' of my_msgs/All: a text is not a number; name a "
                                   "field with a number type [SL0504]"));
}

TEST(FieldPath, nobody_reaches_for_more_elements_than_a_port_has_channels) {
  const auto refusal = [](const std::string& path, const std::string& what) {
    return "field path '" + path + "' of std_msgs/Float64MultiArray: '" + what +
           "' reaches beyond the first 16777216 elements; no path takes more [SL0504]";
  };
  for (const std::string what : {"[16777216]", "[0:16777217]", "[4294967295]", "[16777216:]",
                                 "[18446744073709551615]", "[0:18446744073709551615]"}) {
    EXPECT_EQ(error_of("data" + what, "std_msgs/Float64MultiArray"), refusal("data" + what, what));
  }
  const std::string nothing = "no error";
  EXPECT_EQ(error_of("data[16777215]", "std_msgs/Float64MultiArray"), nothing);
  EXPECT_EQ(error_of("data[0:16777216]", "std_msgs/Float64MultiArray"), nothing);
  EXPECT_EQ(error_of("data[16777215:]", "std_msgs/Float64MultiArray"), nothing);
  EXPECT_EQ(error_of("nested[0:10000].axes[0:10000]"),
            "field path 'nested[0:10000].axes[0:10000]' of my_msgs/All: "
            "'nested[0:10000].axes[0:10000]' reaches beyond the first 16777216 elements; no path "
            "takes more [SL0504]");
}

TEST(FieldPath, hostile_lengths_end_at_once) {
  Catalog catalog = test_catalog();
  catalog.add("my_msgs/Hostile", "string[] texts\nstd_msgs/Empty[] nothing\nfloat64 last");
  const FieldReader reader(catalog, "my_msgs/Hostile", "last");
  const auto message = [](std::initializer_list<unsigned> bytes) {
    std::vector<std::byte> made;
    for (const unsigned byte : bytes) {
      made.push_back(static_cast<std::byte>(byte));
    }
    return made;
  };
  std::vector<double> values;
  try {
    reader.read(message({0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0}), values);
    FAIL();
  } catch (const spikeloop::TransportError& error) {
    EXPECT_THAT(error.what(),
                Fault("message of 8 bytes is shorter than its type says (at byte 4) [SL0509]"));
  }
  // Four thousand million elements of nothing are skipped in no time.
  EXPECT_EQ(
      reader.read(message({0, 0, 0, 0, 0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0, 0, 0, 0, 0}), values),
      1u);
}

}  // namespace
}  // namespace field_path_test
