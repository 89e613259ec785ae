// Beams of a sensor_msgs/LaserScan, from right to left, as values in [-1, 1].
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "reading.hpp"
#include "spikeloop/messages/field_path.hpp"

namespace spikeloop::messages {

inline constexpr std::string_view kLaserScan = "sensor_msgs/LaserScan";

class ScanReading : public Reading {
 public:
  ScanReading(const Catalog& catalog, const ScanRule& rule);

  std::optional<std::size_t> width() const override;
  std::string name_of(std::size_t channel) const override;
  std::string length_remedy(std::size_t channels) const override;
  std::string no_value_remedy(bool missing, std::size_t channel) const override;

 private:
  /// Angles of the beams in rad, counterclockwise.
  struct Angles {
    double first = 0;
    double increment = 0;
  };

  bool read(std::span<const std::byte> message, ReadValues& values) override;
  double number(const FieldReader& field, std::span<const std::byte> message);
  /// Distances that become -1 and 1. Limits that a driver has not set are replaced, with a warning.
  /// @throws TransportError if the smallest distance is not below the largest one
  std::pair<double, double> limits(std::span<const std::byte> message);
  /// Replaces beams_: values in [-1, 1], NaN for no reading.
  void read_beams(std::span<const std::byte> message);
  /// Reverses beams_ if the message has them clockwise.
  void order_beams(std::span<const std::byte> message);
  Angles angles_of_beams(std::span<const std::byte> message);
  /// Appends a value per direction of the rule.
  void resample(std::span<const std::byte> message, ReadValues& values);

  ScanRule rule_;
  FieldReader angle_min_;
  FieldReader angle_max_;
  FieldReader angle_increment_;
  FieldReader range_min_;
  FieldReader range_max_;
  FieldReader ranges_;
  std::vector<double> beams_;
  std::vector<double> scratch_;
  bool is_reversed_ = false;  ///< the newest message has its beams clockwise
  bool warned_ = false;
};

}  // namespace spikeloop::messages
