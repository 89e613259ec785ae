// Messages of given fields in both dialects, and conversions of them.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"

namespace sensor_rule_test {

using namespace spikeloop::messages;

/// A field of a message under test.
struct Field {
  std::string path;
  std::vector<double> numbers{};
  std::string text{};
};

class SensorRules : public testing::TestWithParam<Dialect> {
 protected:
  const Catalog& catalog() const { return Catalog::builtin(GetParam()); }

  std::vector<std::byte> message(std::string_view type, const std::vector<Field>& fields) const {
    std::vector<std::string> paths;
    std::vector<FieldValue> values;
    for (const Field& field : fields) {
      paths.push_back(field.path);
      values.push_back({field.numbers, field.text});
    }
    std::vector<std::byte> bytes;
    MessageWriter(catalog(), type, paths).write(values, bytes);
    return bytes;
  }

  std::vector<std::byte> scan(const std::vector<double>& ranges) const {
    return message("sensor_msgs/LaserScan", {{"header.frame_id", {}, "lidar"}, {"ranges", ranges}});
  }

  SensorConversion conversion(std::string_view type, const SensorRule& rule, std::uint32_t width,
                              bool strict = false) const {
    return {catalog(), type, rule, width, strict};
  }

  std::string error_of(std::string_view type, const SensorRule& rule,
                       std::uint32_t width = 1) const {
    try {
      conversion(type, rule, width, true);
    } catch (const spikeloop::ConfigurationError& error) {
      return error.what();
    }
    return "no error";
  }
};

/// All warnings of a conversion.
inline std::vector<std::string> warnings_of(SensorConversion& c) {
  std::vector<std::string> warnings;
  for (auto text = c.take_warning(); !text.empty(); text = c.take_warning()) {
    warnings.push_back(text);
  }
  return warnings;
}

}  // namespace sensor_rule_test
