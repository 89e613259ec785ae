// Pictures for tests, and what should be made of them.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/images/image_conversion.hpp"

namespace spikeloop::test {

template <typename T>
std::vector<std::byte> bytes_of(const std::vector<T>& samples) {
  std::vector<std::byte> bytes(samples.size() * sizeof(T));
  if (!bytes.empty()) {
    std::memcpy(bytes.data(), samples.data(), bytes.size());
  }
  return bytes;
}

/// A picture with its bytes.
struct Picture {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::string encoding = "mono8";
  std::vector<std::byte> bytes;
  std::uint32_t step = 0;  ///< 0: rows without gaps
  bool big_endian = false;

  images::ImageView view() const {
    const auto row = static_cast<std::uint32_t>(bytes.size() / height);
    return {width, height, step == 0 ? row : step, encoding, big_endian, bytes};
  }
};

/// value(x, y) from 0 to 255, as mono8.
inline Picture grey_picture(std::uint32_t width, std::uint32_t height,
                            const std::function<int(int, int)>& value) {
  std::vector<std::uint8_t> samples;
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      samples.push_back(static_cast<std::uint8_t>(value(static_cast<int>(x), static_cast<int>(y))));
    }
  }
  return {width, height, "mono8", bytes_of(samples)};
}

inline std::vector<double> converted(const images::ImageSettings& settings,
                                     const images::ImageView& image) {
  images::ImageConversion conversion(settings);
  const auto values = conversion.convert(image);
  return {values.begin(), values.end()};
}

/// What the kind of error says, with the kind's first letter before it.
inline std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const ConfigurationError& error) {
    return std::string("C: ") + error.what();
  } catch (const TransportError& error) {
    return std::string("T: ") + error.what();
  }
  return "no error";
}

inline void expect_near(const std::vector<double>& values, const std::vector<double>& expected,
                        double tolerance) {
  ASSERT_EQ(values.size(), expected.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    ASSERT_NEAR(values[i], expected[i], tolerance) << "value " << i;
  }
}

}  // namespace spikeloop::test
