#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "spikeloop/config/data_file.hpp"
#include "spikeloop/config/mapping_file.hpp"
#include "tests/config/helpers.hpp"
#include "tests/support/repetitions.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop {
namespace {

using test::Fault;
using test::message_of;
using testing::ElementsAre;

const std::string kExample =
    "{\"message_type\": \"Twist\", \"mapping\": {\"linear.x\": 0, \"angular.z\": 1}}";

MappingOptions lax() {
  MappingOptions options;
  options.strict = false;
  return options;
}

std::string twist(const std::string& mapping, const std::string& more = "") {
  return "{\"message_type\": \"Twist\", \"mapping\": " + mapping + more + "}";
}

std::string error(const std::string& text) {
  return message_of([&] { parse_mapping(text, "m"); });
}

TEST(MessageType, AcceptsTheSpellingsOfAllPrograms) {
  for (const char* text :
       {"Laserscan", "LaserScan", "sensor_msgs/LaserScan", "sensor_msgs/msg/LaserScan"}) {
    EXPECT_EQ(canonical_message_type(text), "sensor_msgs/LaserScan");
  }
  for (const char* text : {"Twist", "geometry_msgs/Twist", "geometry_msgs/msg/Twist"}) {
    EXPECT_EQ(canonical_message_type(text), "geometry_msgs/Twist");
  }
  for (const char* text : {"FloatArray", "Float64MultiArray", "std_msgs/Float64MultiArray"}) {
    EXPECT_EQ(canonical_message_type(text), "std_msgs/Float64MultiArray");
  }
  for (const char* text : {"Odom", "Odometry", "nav_msgs/Odometry"}) {
    EXPECT_EQ(canonical_message_type(text), "nav_msgs/Odometry");
  }
  EXPECT_EQ(canonical_message_type("my_robot/Wheels"), "my_robot/Wheels");
  EXPECT_EQ(canonical_message_type("my_robot/msg/Wheels"), "my_robot/Wheels");
}

TEST(MessageType, FilesAreFoundFromWhereTheyAreNamed) {
  const test::TemporaryDirectory directory;
  const std::string file = directory.write("Wheels.msg", "float64 left\n");
  EXPECT_EQ(canonical_message_type("Wheels.msg", directory.path()), file);
  EXPECT_EQ(canonical_message_type(file), file);
  EXPECT_EQ(message_of([&] { canonical_message_type("Nothing.msg", directory.path()); }),
            "there is no message definition 'Nothing.msg' in " +
                data_file_places(directory.path()) + "; write its path [SL0502]");
  directory.write("wheels.json", R"({"message_type": "./Wheels.msg", "mapping": {"left": 0}})");
  EXPECT_EQ(read_mapping("wheels.json", {.base_directory = directory.path()}).message_type, file);
}

TEST(MessageType, SuggestsForUnknownOnes) {
  EXPECT_EQ(message_of([] { canonical_message_type("Twsit"); }),
            "unknown message type 'Twsit'; did you mean 'Twist'? [SL0502]");
  for (const char* text : {"Image", "a/b/c", "/Image", "Image/"}) {
    EXPECT_EQ(message_of([&] { canonical_message_type(text); }),
              std::string("unknown message type '") + text +
                  "'; write package/Type, or the path of a .msg file [SL0502]");
  }
}

TEST(MappingFile, ReadsAnOlderFile) {
  const CommandMapping mapping = read_mapping(test::data_path_of("twist.json"));
  EXPECT_EQ(mapping.message_type, "geometry_msgs/Twist");
  EXPECT_FALSE(mapping.all_channels);
  ASSERT_EQ(mapping.fields.size(), 2u);
  EXPECT_EQ(mapping.fields[0].field, "angular.z");
  EXPECT_EQ(mapping.fields[0].channel, 1u);
  EXPECT_EQ(mapping.fields[0].scale, 1.0);
  EXPECT_EQ(mapping.fields[0].offset, 0.0);
  EXPECT_EQ(mapping.fields[1].field, "linear.x");
  EXPECT_EQ(mapping.fields[1].minimum, -1.0);
  EXPECT_EQ(mapping.fields[1].maximum, 1.0);
  const CommandMapping array = read_mapping(test::data_path_of("array.json"));
  EXPECT_EQ(array.message_type, "std_msgs/Float64MultiArray");
  EXPECT_TRUE(array.all_channels);
}

TEST(MappingFile, ReadsFieldsWithScaleOffsetAndLimits) {
  const CommandMapping mapping =
      parse_mapping(twist(R"({"linear.x": {"channel": 3, "scale": 0.5, "offset": -1, "max": 0.25},
                "angular.z": {"channel": 0}})",
                          ", \"min\": -2"),
                    "m");
  ASSERT_EQ(mapping.fields.size(), 2u);
  EXPECT_EQ(mapping.fields[0].channel, 3u);
  EXPECT_EQ(mapping.fields[0].scale, 0.5);
  EXPECT_EQ(mapping.fields[0].offset, -1.0);
  EXPECT_EQ(mapping.fields[0].minimum, -2.0);
  EXPECT_EQ(mapping.fields[0].maximum, 0.25);
  EXPECT_EQ(mapping.fields[1].minimum, -2.0);
  EXPECT_EQ(mapping.fields[1].maximum, std::nullopt);
}

TEST(MappingFile, ASliceStandsForItsElements) {
  const CommandMapping mapping = parse_mapping(
      twist(R"({"data[2:5]": {"channel": 7, "scale": 3}, "points[0].positions[0:2]": 1})"), "m");
  std::vector<std::pair<std::string, std::uint32_t>> fields;
  for (const CommandField& field : mapping.fields) {
    fields.emplace_back(field.field, field.channel);
  }
  EXPECT_THAT(fields, ElementsAre(std::pair("data[2]", 7), std::pair("data[3]", 8),
                                  std::pair("data[4]", 9), std::pair("points[0].positions[0]", 1),
                                  std::pair("points[0].positions[1]", 2)));
  EXPECT_EQ(mapping.fields[2].scale, 3);
  EXPECT_THAT(error(twist("{\"data[5:5]\": 0}")),
              Fault("m:1:39: 'mapping.data[5:5]' ... 100000 ... [0:3] ... [SL0504]"));
  // What is not a slice is left to those who know the message.
  EXPECT_EQ(parse_mapping(twist("{\"a[name=x:y]\": 0}"), "m").fields.at(0).field, "a[name=x:y]");
}

// The older programs took absent limits for 0 and 0, and the robot never moved.
TEST(MappingFile, AbsentLimitsLimitNothing) {
  const CommandMapping mapping = parse_mapping(kExample, "m", lax());
  EXPECT_EQ(mapping.fields.at(0).minimum, std::nullopt);
  EXPECT_EQ(mapping.fields.at(0).maximum, std::nullopt);
  test::LogCapture log;
  EXPECT_EQ(
      parse_mapping(twist("{\"linear.x\": 0}", ", \"min\": 0, \"max\": 0"), "m").fields.size(), 1u);
  EXPECT_THAT(log.messages, ElementsAre("m:1:65: 'min' and 'max' are both 0; every field is 0"));
}

TEST(MappingFile, ChannelsMustBeOnThePort) {
  const CommandMapping mapping = parse_mapping(twist("{\"linear.x\": 0, \"angular.z\": 2}"), "m");
  EXPECT_NO_THROW(check_channels(mapping, 3));
  EXPECT_THAT(message_of([&] { check_channels(mapping, 2); }),
              Fault("m:1:54: 'mapping.angular.z' reads channel 2 ... 2 (0 to 1) ... [SL0505]"));
  EXPECT_NO_THROW(check_channels(parse_mapping(test::data_text("array.json"), "m"), 0));
}

struct Case {
  std::string text;
  std::string message;
};

TEST(MappingFile, SaysWhatIsWrong) {
  const Case cases[] = {
      {"", "m: the file is empty; write a JSON object [SL0101]"},
      {"[1]", "m: the file holds an array, no object; write " + kExample + " [SL0105]"},
      {"3", "m: the file holds 3, no object; write " + kExample + " [SL0105]"},
      {"{}", "m: 'message_type' is missing; write " + kExample + " [SL0104]"},
      {"{\"message_type\": 3}",
       "m:1:2: 'message_type' is 3, no text; write " + kExample + " [SL0105]"},
      {"{\"message_type\": \"Twits\"}",
       "m:1:2: 'message_type': unknown message type 'Twits'; did you mean 'Twist'? [SL0502]"},
      {"{\"message_type\": \"Twist\"}", "m: 'mapping' is missing; write " + kExample + " [SL0104]"},
      {"{\"message_typ\": \"Twist\"}",
       "m:1:2: unknown key 'message_typ'; did you mean 'message_type'? [SL0103]"},
      {twist("{}"), "m:1:27: 'mapping' is empty; write " + kExample + " [SL0105]"},
      {twist("3"), "m:1:27: 'mapping' is 3, no object; write " + kExample + " [SL0105]"},
      {twist("{\"x\": 0, \"x\": 1}"), "m:1:47: the key 'x' is given twice; remove one [SL0102]"},
      {twist("{\"x\": 0.5}"), "m:1:39: 'mapping.x' is 0.5, no channel ... 0 ... [SL0505]"},
      {twist("{\"x\": -2}"), "m:1:39: 'mapping.x' is -2, no channel ... 0 ... [SL0505]"},
      {twist("{\"x\": \"0\"}"), "m:1:39: 'mapping.x' is \"0\", no channel ... 0 ... [SL0505]"},
      {twist("{\"x\": -1}"), "m:1:39: 'mapping.x' is -1, no channel; remove the field [SL0505]"},
      {twist("{\"x\": {}}"), "m:1:39: 'mapping.x' has no channel; write {\"channel\": 0} [SL0104]"},
      {twist("{\"x\": {\"chanel\": 0}}"),
       "m:1:45: unknown key 'mapping.x.chanel'; did you mean 'channel'? [SL0103]"},
      {twist("{\"x\": {\"channel\": []}}"),
       "m:1:45: 'mapping.x.channel' is an array, no channel ... 0 ... [SL0505]"},
      {twist("{\"x\": {\"channel\": 0, \"scale\": \"a\"}}"),
       "m:1:59: 'mapping.x.scale' is \"a\", no finite number; write a number [SL0201]"},
      {twist("{\"x\": {\"channel\": 0, \"offset\": null}}"),
       "m:1:59: 'mapping.x.offset' is null, no finite number; write a number [SL0201]"},
      {twist("{\"x\": {\"channel\": 0, \"slew\": 0}}"),
       "m:1:59: 'mapping.x.slew' is 0 ... 0 ... [SL0203]"},
      {twist("{}", ", \"min\": true"),
       "m:1:42: 'min' is true, no finite number; write a number [SL0201]"},
      {twist("{}", ", \"max\": {}"),
       "m:1:42: 'max' is an object, no finite number; write a number [SL0201]"},
      {twist("{}", ", \"min\": 1, \"max\": -1"),
       "m:1:52: 'min' is 1 and 'max' is -1; write a minimum that is not above the maximum "
       "[SL0206]"},
      {twist("{\"x\": {\"channel\": 0, \"max\": -1}}", ", \"min\": 0.5"),
       "m:1:59: 'mapping.x.min' is 0.5 and 'mapping.x.max' is -1 ... [SL0206]"},
      {"{\"message_type\": \"FloatArray\", \"min\": 0}",
       "m:1:32: 'min' and 'max' do not hold for a Float64MultiArray without mapping; remove them, "
       "or "
       "map "
       "every element: {\"mapping\": {\"data[0]\": 0}} [SL0208]"},
  };
  for (const auto& [text, message] : cases) {
    EXPECT_THAT(error(text), Fault(message)) << text;
  }
  EXPECT_THAT(error("{\"message_type\":\n x}"),
              testing::StartsWith("m:2:2: not JSON: invalid literal; last read: "));
  EXPECT_EQ(error(twist("{}", ", \"min\": 1e999")),
            "m: not JSON: number overflow parsing '1e999' [SL0101]");
}

TEST(MappingFile, NamesTheLine) {
  EXPECT_EQ(
      error("{\"message_type\": \"Twist\",\n \"mapping\": {\n  \"linear.x\": 0,\n  "
            "\"angular.z\": {\"channel\": 1, \"scale\": []}}}"),
      "m:4:31: 'mapping.angular.z.scale' is an array, no finite number; write a number [SL0201]");
}

TEST(MappingFile, SaysWhereItLookedForAMissingFile) {
  const test::TemporaryDirectory directory;
  MappingOptions options;
  const std::string here = std::filesystem::current_path().string();
  EXPECT_EQ(message_of([&] { read_mapping("none.json", options); }),
            "there is no mapping file 'none.json' in '" + here + "'; write its path [SL0108]");
  options.base_directory = directory.path();
  EXPECT_EQ(message_of([&] { read_mapping("none.json", options); }),
            "there is no mapping file 'none.json' in '" + here + "' or '" +
                directory.path().string() + "'; write its path [SL0108]");
  directory.write("there.json", kExample);
  EXPECT_EQ(read_mapping("there.json", options).fields.size(), 2u);
}

TEST(MappingFile, OlderProgramsSendEverythingWithoutAFile) {
  test::LogCapture log;
  const CommandMapping missing = read_mapping("none.json", lax());
  EXPECT_EQ(missing.message_type, "std_msgs/Float64MultiArray");
  EXPECT_TRUE(missing.all_channels);
  EXPECT_TRUE(parse_mapping("{", "m", lax()).all_channels);
  const test::TemporaryDirectory directory;
  EXPECT_TRUE(read_mapping(directory.path().string(), lax()).all_channels);
  EXPECT_THROW(read_mapping(directory.path().string(), {}), FileError);
  ASSERT_EQ(log.messages.size(), 3u);
  for (const auto& message : log.messages) {
    EXPECT_THAT(message, testing::HasSubstr("; all channels are sent as a Float64MultiArray [SL"));
  }
}

TEST(MappingFile, OlderProgramsIgnoreSomeMistakes) {
  test::LogCapture log;
  EXPECT_EQ(
      parse_mapping(twist("{\"x\": -1, \"y\": 0}", ", \"ros_topic\": 1"), "m", lax()).fields.size(),
      1u);
  EXPECT_TRUE(parse_mapping("{\"message_type\": \"Twist\"}", "m", lax()).fields.empty());
  EXPECT_TRUE(parse_mapping("{\"message_type\": \"Float64MultiArray\", \"max\": 1}", "m", lax())
                  .all_channels);
  EXPECT_TRUE(parse_mapping("{\"message_type\": \"Float64MultiArray\", \"mapping\": {\"a\": 0}}",
                            "m", lax())
                  .all_channels);
  ASSERT_EQ(log.messages.size(), 5u);
  EXPECT_THAT(log.messages[0], testing::EndsWith("; it is ignored [SL0103]"));
  EXPECT_EQ(log.messages[1],
            "m:1:39: 'mapping.x' is -1, no channel; remove the field; the field is 0 [SL0505]");
  EXPECT_THAT(log.messages[2], testing::EndsWith("; every field is 0 [SL0104]"));
  EXPECT_THAT(log.messages[3], testing::EndsWith("; they are ignored [SL0208]"));
  EXPECT_THAT(log.messages[4], Fault("m:1:39: 'mapping' does not hold for a Float64MultiArray; "
                                     "remove it; all channels are sent [SL0208]"));
}

TEST(MappingFile, MutatedFilesAreReadOrRefused) {
  std::mt19937 random(5);
  const std::string original = twist(R"({"linear.x": {"channel": 1, "min": -1}, "angular.z": 0})",
                                     ", \"min\": -1, \"max\": 1");
  for (int i = 0; i < test::repetitions(5000); ++i) {
    std::string text = original;
    for (unsigned k = 0; k < 1 + random() % 4; ++k) {
      text[random() % text.size()] = static_cast<char>(random() % 256);
    }
    try {
      parse_mapping(text, "m", i % 2 == 0 ? lax() : MappingOptions{});
    } catch (const ConfigurationError&) {
    }
  }
  EXPECT_THAT(error(std::string(200'000, '[')), testing::HasSubstr("not JSON: unexpected end"));
  const std::string deep = std::string(200'000, '[') + std::string(200'000, ']');
  EXPECT_EQ(error(deep), "m: the file holds an array, no object; write " + kExample + " [SL0105]");
}

}  // namespace
}  // namespace spikeloop
