#include "spikeloop/sensing/sensor_keys.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "config/src/json_text.hpp"
#include "spikeloop/config/sensor_mapping_file.hpp"
#include "spikeloop/core/error.hpp"
#include "tests/support/fault.hpp"

namespace {

using spikeloop::test::Fault;
using namespace spikeloop;
using messages::NotANumber;
using messages::SensorField;
using messages::SensorRule;

constexpr double kInf = std::numeric_limits<double>::infinity();

WrittenValue written(const std::string& text, int line) {
  const Location where{"x.yaml", line, 5};
  return text.find_first_of("[{") == 0
             ? json_text::written_value(nlohmann::ordered_json::parse(text), where)
             : WrittenValue{text, where};
}

SensorRule rule_of(const std::string& fields, const std::string& image = "") {
  WrittenValues keys;
  if (!fields.empty()) {
    keys["fields"] = written(fields, 3);
  }
  if (!image.empty()) {
    keys["image"] = written(image, 4);
  }
  return sensing::sensor_rule(resolve(sensing::sensor_parameters(), keys, {}));
}

std::string error_of(const std::string& fields, const std::string& image = "") {
  try {
    rule_of(fields, image);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "no error";
}

TEST(SensorKeys, paths) {
  EXPECT_TRUE(rule_of("").fields.empty());
  EXPECT_EQ(rule_of("ranges[0:4]").fields.at(0).path, "ranges[0:4]");
  const SensorRule rule = rule_of(R"(["a.b", "c"])");
  ASSERT_EQ(rule.fields.size(), 2u);
  EXPECT_EQ(rule.fields[1].path, "c");
  EXPECT_EQ(rule.fields[1].scale, 1);
  EXPECT_EQ(rule.fields[1].offset, 0);
  EXPECT_EQ(rule.fields[1].minimum, -kInf);
  EXPECT_EQ(rule.fields[1].maximum, kInf);
  EXPECT_EQ(rule.fields[1].not_a_number, NotANumber::pass);
}

TEST(SensorKeys, scale_offset_and_limits) {
  const SensorField field =
      rule_of(R"([{"path": "a", "scale": 2, "offset": -1, "min": -0.5, "max": 0.75}])").fields[0];
  EXPECT_EQ(field.scale, 2);
  EXPECT_EQ(field.offset, -1);
  EXPECT_EQ(field.minimum, -0.5);
  EXPECT_EQ(field.maximum, 0.75);
}

TEST(SensorKeys, a_range_becomes_minus_one_to_one) {
  const SensorField field = rule_of(R"([{"path": "a", "range": [2, 6]}])").fields[0];
  EXPECT_EQ(field.scale * 2 + field.offset, -1);
  EXPECT_EQ(field.scale * 6 + field.offset, 1);
  EXPECT_EQ(field.minimum, -1);
  EXPECT_EQ(field.maximum, 1);
}

TEST(SensorKeys, what_is_not_a_number) {
  const auto policy = [](const std::string& nan) {
    return rule_of(R"([{"path": "a", "nan": )" + nan + "}]").fields[0];
  };
  EXPECT_EQ(policy("\"pass\"").not_a_number, NotANumber::pass);
  EXPECT_EQ(policy("\"hold\"").not_a_number, NotANumber::hold);
  EXPECT_EQ(policy("\"skip\"").not_a_number, NotANumber::skip);
  EXPECT_EQ(policy("\"zero\"").not_a_number, NotANumber::number);
  EXPECT_EQ(policy("\"zero\"").instead, 0);
  EXPECT_EQ(policy("-1").not_a_number, NotANumber::number);
  EXPECT_EQ(policy("-1").instead, -1);
}

TEST(SensorKeys, image) {
  EXPECT_FALSE(rule_of("").image);
  EXPECT_TRUE(rule_of("", "{}").image);
  const SensorRule rule = rule_of("", R"({"crop": [1, 2, 3, 4], "filter": "on_off", "gain": 2.5})");
  EXPECT_EQ(rule.image->crop->height, 4u);
  EXPECT_EQ(rule.image->filter, images::Filter::on_off);
  EXPECT_EQ(rule.image->gain, 2.5);
}

TEST(SensorKeys, wrong_fields_are_explained) {
  const std::string at = "x.yaml:3:5: key 'fields': ";
  EXPECT_EQ(error_of(R"({"path": "a"})"),
            at + R"('{"path":"a"}' is not a list; write  fields: [pose.pose.position.x] [SL0105])");
  EXPECT_EQ(error_of("[]"),
            at + "'[]' is an empty list; write  fields: [pose.pose.position.x] [SL0105]");
  EXPECT_EQ(error_of("[[7]]"),
            at + "entry 1: '[7]' is not a map; write  fields: [{path: ranges, scale: 2}] [SL0105]");
  EXPECT_EQ(error_of(R"([{"scale": 2}])"),
            at + "entry 1: key 'path' is missing (Path of the field); write  fields: [{path: "
                 "ranges, scale: 2}] [SL0104]");
  EXPECT_EQ(error_of(R"(["b", {"path": "a", "scal": 2}])"),
            at + "entry 2: unknown key 'scal'; did you mean 'scale'? [SL0103]");
  EXPECT_THAT(error_of(R"([{"path": "a", "scale": "two"}])"),
              Fault(at + "entry 1: key 'scale': 'two' ... 0.5 ... [SL0201]"));
  EXPECT_THAT(error_of(R"([{"path": "a", "min": 2, "max": 1}])"),
              Fault(at + "'min' is 2 and 'max' is 1 ... [SL0206]"));
  EXPECT_THAT(error_of(R"([{"path": "a", "range": [4]}])"),
              Fault(at + "entry 1: key 'range': '[4]' ... 2 ... range: [0, 4] ... [SL0105]"));
  EXPECT_THAT(error_of(R"([{"path": "a", "range": [4, 0]}])"),
              Fault(at + "minimum 4 is not below maximum 0; write  range: [0, 4] [SL0206]"));
  EXPECT_THAT(error_of(R"([{"path": "a", "range": [0, 4], "max": 1}])"),
              Fault(at + "'range' says what 'max' says ... [SL0208]"));
  EXPECT_EQ(error_of(R"([{"path": "a", "nan": "holt"}])"),
            at + "'nan' is 'holt'; did you mean 'hold'?; write one of: pass, hold, skip, zero, or "
                 "a number [SL0205]");
  EXPECT_EQ(error_of(R"([{"path": "a", "nan": true}])"),
            at + "'nan' is 'true'; write one of: pass, hold, skip, zero, or a number [SL0205]");
}

TEST(SensorKeys, wrong_images_are_explained) {
  const std::string at = "x.yaml:4:5: key 'image': ";
  EXPECT_EQ(error_of("", "small"),
            at + "'small' is not a map; write  image: {resize: [40, 30]} [SL0105]");
  EXPECT_EQ(error_of("", R"({"resiz": [40, 30]})"),
            at + "unknown key 'resiz'; did you mean 'resize'? [SL0103]");
  EXPECT_THAT(
      error_of("", R"({"channel": "gray"})"),
      Fault(at + "key 'channel': 'gray' ... 'grey' ... grey, red, green, blue, rgb ... [SL0205]"));
  EXPECT_THAT(error_of("", R"({"resize": 40})"),
              Fault(at + "key 'resize': '40' ... 2 ... resize: [40, 30] ... [SL0105]"));
  EXPECT_EQ(error_of("height", "{}"),
            at + "a picture and fields are not taken at once; leave 'image' or 'fields' out, and "
                 "write a second sensor [SL0208]");
}

/// A file that is gone at the end.
class MappingFile : public testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::temp_directory_path() /
            ("sensor_mapping_" + std::to_string(::getpid()) + ".json");
  }
  void TearDown() override { std::filesystem::remove(path_); }

  std::string error_of(const std::string& text) {
    std::ofstream(path_) << text;
    try {
      read_sensor_mapping(path_.string(), {});
    } catch (const ConfigurationError& error) {
      std::string what = error.what();
      for (auto at = what.find(path_.string()); at != std::string::npos;
           at = what.find(path_.string())) {
        what.replace(at, path_.string().size(), "x.json");
      }
      return what;
    }
    return "no error";
  }

  std::filesystem::path path_;
};

TEST_F(MappingFile, is_read) {
  std::ofstream(path_) << R"({"fields": ["a", {"path": "b", "scale": 2}]})";
  const WrittenValues keys = read_sensor_mapping(path_.filename().string(), path_.parent_path());
  ASSERT_TRUE(keys.contains("fields"));
  EXPECT_FALSE(keys.contains("image"));
  EXPECT_EQ(keys.at("fields").where.line, 1);
  const SensorRule rule = sensing::sensor_rule(resolve(sensing::sensor_parameters(), keys, {}));
  EXPECT_EQ(rule.fields.at(1).scale, 2);
}

TEST_F(MappingFile, what_is_wrong_is_explained) {
  EXPECT_EQ(error_of("[]"),
            "x.json: the file holds an array, no object with keys; write {\"fields\": [{\"path\": "
            "\"ranges\", \"scale\": 2}]} [SL0105]");
  EXPECT_THAT(error_of("{}"), Fault("x.json: the file holds an object ... {\"fields\": [{\"path\": "
                                    "\"ranges\", \"scale\": 2}]} ... [SL0105]"));
  EXPECT_EQ(error_of("{\"field\": [\"a\"]}"),
            "x.json:1:2: unknown key 'field'; did you mean 'fields'? [SL0103]");
  try {
    read_sensor_mapping("nowhere.json", "/");
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 45),
              "there is no mapping file 'nowhere.json' in '/");
  }
}

}  // namespace
