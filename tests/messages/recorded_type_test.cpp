// Definitions and messages of recordings, compared with those of Spikeloop.
#include <gmock/gmock.h>

#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/messages/recorded_type.hpp"

namespace spikeloop::messages {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const Catalog& ros2() {
  return Catalog::builtin(Dialect::ros2);
}

Comparison compare(const std::string& type, const std::string& text,
                   const std::string& version = "", const std::string& encoding = "ros2msg") {
  return compare_types({"cdr", type, encoding, text}, version, ros2(), type);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(RecordedType, EveryDefinitionFitsItself) {
  for (const Dialect dialect : {Dialect::ros1, Dialect::ros2}) {
    const Catalog& catalog = Catalog::builtin(dialect);
    for (const std::string& name : catalog.names()) {
      const Schema schema = schema_of(dialect, name);
      EXPECT_EQ(compare_types(schema, "", catalog, name).fit, Fit::same) << name;
      Schema windows = schema;
      windows.definition.clear();
      for (const char c : schema.definition) {
        windows.definition += c == '\n' ? "\r\n" : std::string(1, c);
      }
      EXPECT_EQ(compare_types(windows, "", catalog, name).fit, Fit::same) << name;
    }
  }
}

/// Wherever a text is cut off, it is not taken for another version.
TEST(RecordedType, DefinitionThatIsCutOff) {
  for (const char* const type :
       {"sensor_msgs/LaserScan", "nav_msgs/Odometry", "geometry_msgs/Pose2D"}) {
    const std::string whole = ros2().full_text(type);
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_NE(compare(type, whole.substr(0, size)).fit, Fit::other) << type << " " << size;
    }
  }
}

TEST(RecordedType, OtherVersions) {
  const std::string whole = ros2().full_text("sensor_msgs/Range");
  const Comparison older =
      compare("sensor_msgs/Range", replaced(whole, "float32 variance\n", "\n"));
  EXPECT_EQ(older.fit, Fit::shorter);
  EXPECT_THAT(older.missing, ElementsAre("variance"));
  EXPECT_EQ(compare("sensor_msgs/Range",
                    replaced(whole, "float32 variance\n", "float32 variance\nfloat32 more\n"))
                .fit,
            Fit::longer);
  const Comparison renamed =
      compare("sensor_msgs/Range", replaced(whole, "min_range", "least_range"));
  EXPECT_EQ(renamed.fit, Fit::other);
  EXPECT_EQ(renamed.detail, "its field 4 is 'least_range', ours is 'min_range'");
  EXPECT_EQ(
      compare("sensor_msgs/Range", replaced(whole, "float32 range\n", "float64 range\n")).detail,
      "its field 'range' has another type");
  EXPECT_EQ(
      compare("sensor_msgs/Range", replaced(whole, "uint8 ULTRASOUND=0", "uint8 OTHER=7")).fit,
      Fit::same)
      << "constants are in no message";
}

TEST(RecordedType, DefinitionThatCannotBeRead) {
  const std::string type = "sensor_msgs/LaserScan";
  EXPECT_EQ(compare(type, "").detail, "it is empty");
  EXPECT_EQ(compare(type, " \r\n").detail, "it is empty");
  EXPECT_EQ(compare(type, "Definition of sensor_msgs/LaserScan").detail,
            "its line 1 cannot be read");
  EXPECT_EQ(compare(type, "module", "", "ros2idl").detail, "it is in the format 'ros2idl'");
  EXPECT_EQ(compare("std_msgs/Empty", "").fit, Fit::same);
  EXPECT_EQ(compare(type, "module", ros2().type_hash(type), "ros2idl").fit, Fit::same)
      << "the hash is enough";
}

/// ROS 1 has the md5 sum of the publisher, and sometimes no text.
TEST(RecordedType, Md5Sums) {
  const Catalog& ros1 = Catalog::builtin(Dialect::ros1);
  const Schema none{"ros1", "sensor_msgs/Imu", "ros1msg", ""};
  EXPECT_EQ(compare_types(none, ros1.md5("sensor_msgs/Imu"), ros1, "sensor_msgs/Imu").fit,
            Fit::same);
  const Schema whole = schema_of(Dialect::ros1, "sensor_msgs/Imu");
  EXPECT_EQ(compare_types(whole, "0123", ros1, "sensor_msgs/Imu").fit, Fit::other);
  Catalog constants(Dialect::ros1);
  const std::string text = "uint8 MORE=1\n" + whole.definition;
  constants.add_with_dependencies("sensor_msgs/Imu", text);
  EXPECT_EQ(compare_types({"ros1", "sensor_msgs/Imu", "ros1msg", text},
                          constants.md5("sensor_msgs/Imu"), ros1, "sensor_msgs/Imu")
                .fit,
            Fit::same);
}

TEST(RecordedType, Messages) {
  for (const Dialect dialect : {Dialect::ros1, Dialect::ros2}) {
    const Catalog& catalog = Catalog::builtin(dialect);
    std::vector<std::byte> message;
    MessageWriter(catalog, "geometry_msgs/Pose2D", {}).write({}, message);
    const std::span<const std::byte> bytes = message;
    const auto layout = catalog.layout("geometry_msgs/Pose2D");
    const TypeLayout& type = *layout;
    EXPECT_EQ(compare_message(bytes, type).fit, Fit::same);
    const Comparison shorter = compare_message(bytes.first(bytes.size() - 8), type);
    EXPECT_EQ(shorter.fit, Fit::shorter);
    EXPECT_THAT(shorter.missing, ElementsAre("theta"));
    EXPECT_EQ(compare_message(bytes.first(bytes.size() - 4), type).fit, Fit::other);
    std::vector<std::byte> longer(bytes.begin(), bytes.end());
    longer.resize(longer.size() + 8);
    EXPECT_EQ(compare_message(longer, type).fit, Fit::longer);
    EXPECT_EQ(compare_message({}, type).fit, Fit::other);
  }
}

}  // namespace
}  // namespace spikeloop::messages
