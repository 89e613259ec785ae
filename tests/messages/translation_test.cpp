// Messages of one ROS as messages of the other, against the codec that writes both.
#include "spikeloop/messages/translation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "content.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/message_writer.hpp"

namespace translation_test {
namespace {

using namespace spikeloop::messages;
using spikeloop::test::Content;

using Bytes = std::vector<std::byte>;

/// The types that both have.
std::vector<std::string> common_types() {
  std::vector<std::string> types = Catalog::builtin(Dialect::ros1).names();
  std::erase_if(types, [](const std::string& type) {
    return !Catalog::builtin(Dialect::ros2).contains(type);
  });
  return types;
}

/// What both can say: no number of a header, no byte with a sign.
Content common_content(const std::string& type, unsigned seed) {
  Content content =
      spikeloop::test::random_content(*Catalog::builtin(Dialect::ros1).layout(type), seed);
  std::erase_if(content.numbers, [](const auto& entry) { return entry.first.ends_with("seq"); });
  for (auto& [path, numbers] : content.numbers) {
    if (type.starts_with("std_msgs/Byte") || path.ends_with("level")) {
      std::ranges::transform(numbers, numbers.begin(),
                             [](double number) { return std::min(std::abs(number), 127.0); });
    }
  }
  return content;
}

Bytes written(const Catalog& catalog, const std::string& type, const Content& content) {
  std::vector<std::string> paths;
  std::vector<FieldValue> values;
  const auto named = [&catalog](std::string path) {
    if (catalog.dialect() == Dialect::ros2) {
      std::ranges::transform(path, path.begin(),
                             [](char c) { return static_cast<char>(std::tolower(c)); });
    }
    return path;
  };
  for (const auto& [path, numbers] : content.numbers) {
    paths.push_back(named(path));
    values.push_back({numbers, {}});
  }
  for (const auto& [path, text] : content.texts) {
    paths.push_back(named(path));
    values.push_back({{}, text});
  }
  Bytes bytes;
  MessageWriter(catalog, type, paths).write(values, bytes);
  return bytes;
}

TEST(Translation, both_ways) {
  const Catalog& ros1 = Catalog::builtin(Dialect::ros1);
  const Catalog& ros2 = Catalog::builtin(Dialect::ros2);
  ASSERT_GT(common_types().size(), 50u);
  for (const std::string& type : common_types()) {
    const Translation there(type, ros1, ros2);
    const Translation back(type, ros2, ros1);
    for (unsigned seed = 0; seed < 10; ++seed) {
      const Content content = common_content(type, seed);
      const Bytes in_ros1 = written(ros1, type, content);
      const Bytes in_ros2 = written(ros2, type, content);
      Bytes result;
      there.translate(in_ros1, result);
      EXPECT_EQ(result, in_ros2) << type << ", seed " << seed;
      back.translate(in_ros2, result);
      EXPECT_EQ(result, in_ros1) << type << ", seed " << seed;
    }
  }
}

TEST(Translation, what_one_of_them_lacks) {
  Catalog ros1(Dialect::ros1);
  Catalog ros2(Dialect::ros2);
  ros1.add("my_msgs/Part", "");
  ros2.add("my_msgs/Part", "");
  ros1.add("my_msgs/Thing", "int32[] gone\nfloat64 kept\nstring also_gone");
  ros2.add("my_msgs/Thing", "string new_text\nPart part\nfloat64 kept\nint16[3] new_numbers");
  Bytes result;
  Translation("my_msgs/Thing", ros1, ros2)
      .translate(written(ros1, "my_msgs/Thing",
                         {.atoms = {},
                          .numbers = {{"gone", {1, 2}}, {"kept", {2.5}}},
                          .texts = {{"also_gone", "x"}}}),
                 result);
  EXPECT_EQ(result, written(ros2, "my_msgs/Thing",
                            {.atoms = {}, .numbers = {{"kept", {2.5}}}, .texts = {}}));
}

TEST(Translation, refuses_fields_that_differ) {
  const auto error_of = [](const char* first, const char* second) -> std::string {
    Catalog ros1(Dialect::ros1);
    Catalog ros2(Dialect::ros2);
    ros1.add("my_msgs/Thing", first);
    ros2.add("my_msgs/Thing", second);
    try {
      Translation("my_msgs/Thing", ros1, ros2);
    } catch (const spikeloop::ConfigurationError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of("byte a", "byte a"), "");
  EXPECT_EQ(error_of("int32 a", "float32 a"),
            "my_msgs/Thing has the field 'a' in both versions of ROS, but of another type; it "
            "cannot be translated [SL0504]");
  EXPECT_EQ(error_of("int32[2] a", "int32[3] a"), error_of("int32 a", "int32[] a"));
  EXPECT_EQ(error_of("int32 a\nint32 b", "int32 b\nint32 a"),
            "my_msgs/Thing has the field 'a' in both versions of ROS, but in another order; it "
            "cannot be translated [SL0504]");
}

TEST(Translation, short_messages) {
  const Catalog& ros1 = Catalog::builtin(Dialect::ros1);
  const Translation there("sensor_msgs/LaserScan", ros1, Catalog::builtin(Dialect::ros2));
  const Bytes whole =
      written(ros1, "sensor_msgs/LaserScan", common_content("sensor_msgs/LaserScan", 3));
  Bytes result;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THROW(there.translate(std::span(whole).first(size), result), spikeloop::TransportError);
  }
}

}  // namespace
}  // namespace translation_test
