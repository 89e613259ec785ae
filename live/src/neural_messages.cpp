#include "spikeloop/live/neural_messages.hpp"

#include <array>
#include <bit>

namespace spikeloop::live {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<std::byte, 4> kLittleEndianCdr{std::byte{0}, std::byte{1}, std::byte{0},
                                                    std::byte{0}};

Channel channel(const std::string& topic, const char* schema_name, const char* schema) {
  return {topic, "cdr", schema_name, "ros2msg", schema};
}

/// A sequence: its length, a gap, its elements. The gap aligns them as counted from behind the
/// four bytes at the begin; a sequence without elements has none.
template <typename Element>
void append(std::span<const Element> elements, std::vector<std::byte>& message) {
  const auto count = static_cast<std::uint32_t>(elements.size());
  const auto head = std::as_bytes(std::span(&count, 1));
  message.insert(message.end(), head.begin(), head.end());
  if (elements.empty()) {
    return;
  }
  while ((message.size() - kLittleEndianCdr.size()) % sizeof(Element) != 0) {
    message.push_back(std::byte{0});
  }
  const auto bytes = std::as_bytes(elements);
  message.insert(message.end(), bytes.begin(), bytes.end());
}

}  // namespace

Channel spike_channel(const std::string& topic) {
  return channel(topic, "spikeloop/msg/Spikes", "int64[] times\nuint32[] channels\n");
}

Channel signal_channel(const std::string& topic) {
  return channel(topic, "spikeloop/msg/Signal", "float64[] values\n");
}

Channel weights_channel(const std::string& topic) {
  return channel(topic, "spikeloop/msg/Weights", "uint64 synapses\nfloat64[] weights\n");
}

void write_spikes(std::span<const std::int64_t> times, std::span<const std::uint32_t> channels,
                  std::vector<std::byte>& message) {
  message.assign(kLittleEndianCdr.begin(), kLittleEndianCdr.end());
  append(times, message);
  append(channels, message);
}

void write_signal(std::span<const double> values, std::vector<std::byte>& message) {
  message.assign(kLittleEndianCdr.begin(), kLittleEndianCdr.end());
  append(values, message);
}

void write_weights(std::uint64_t synapses, std::span<const double> weights,
                   std::vector<std::byte>& message) {
  message.assign(kLittleEndianCdr.begin(), kLittleEndianCdr.end());
  const auto count = std::as_bytes(std::span(&synapses, 1));
  message.insert(message.end(), count.begin(), count.end());
  append(weights, message);
}

}  // namespace spikeloop::live
