// Point clouds under libFuzzer (scripts/fuzz). The first byte says the dialect, the rest is a
// sensor_msgs/PointCloud2: whatever it says of its points, their numbers come from its bytes, or it
// is counted as malformed.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"

using namespace spikeloop;
using namespace spikeloop::messages;

namespace {

constexpr const char* kType = "sensor_msgs/PointCloud2";

void need(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void check(Dialect dialect, const SensorRule& rule, std::span<const std::byte> message) {
  constexpr std::uint32_t kWidth = 12;
  const Catalog& catalog = Catalog::builtin(dialect);
  SensorConversion conversion(catalog, kType, rule, kWidth, false);
  bool good = false;
  try {
    good = conversion.convert(message);
  } catch (const ConfigurationError&) {
    return;
  }
  need(conversion.channels().size() == kWidth);
  need(conversion.counts().messages == 1 &&
       (good || conversion.counts().malformed == 1 || conversion.counts().without_reading == 1));
  try {
    // A value is at least a byte of the message.
    need(SensorConversion::count(catalog, kType, rule, message) <= 3 * message.size() + kWidth);
  } catch (const TransportError&) {
    need(!good);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  const Dialect dialect = (data[0] & 1) == 0 ? Dialect::ros1 : Dialect::ros2;
  // A copy of exactly this size, so that whatever lies behind it is not the message's.
  const std::vector<std::uint8_t> exact(data + 1, data + size);
  const auto message = std::as_bytes(std::span(exact));
  check(dialect, plain_fields({"points.x", "points.y[1:3]", "height"}), message);
  check(dialect, {.fields = {{.path = "points.z", .not_a_number = NotANumber::hold}}}, message);
  check(dialect, {.fields = {{.path = "points.x[2]", .not_a_number = NotANumber::skip}}}, message);
  return 0;
}
