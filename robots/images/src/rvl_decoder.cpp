#include <fmt/format.h>

#include <cstring>

#include "decoders.hpp"
#include "encoding.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::images {
namespace {

[[noreturn]] void fail_rvl(std::string_view reason) {
  throw TransportError(with_code(Code::damaged_message, "its RVL is damaged: {}", reason));
}

/// Numbers of variable length: nibbles of 32-bit words, the highest of a word first. A nibble has
/// three bits of the number, the lowest first, below a bit that is 1 if more follow.
class RvlNumbers {
 public:
  explicit RvlNumbers(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::uint32_t word() {
    if (bytes_.size() < sizeof(std::uint32_t)) {
      fail_rvl("it ends too early");
    }
    std::uint32_t word = 0;
    std::memcpy(&word, bytes_.data(), sizeof word);
    bytes_ = bytes_.subspan(sizeof word);
    return word;
  }

  std::uint32_t number() {
    std::uint32_t number = 0;
    for (unsigned shift = 0; shift < 32; shift += 3) {
      const std::uint32_t nibble = next_nibble();
      number |= (nibble & 7U) << shift;
      if ((nibble & 8U) == 0) {
        return number;
      }
    }
    fail_rvl("a number is too long");
  }

 private:
  std::uint32_t next_nibble() {
    if (nibbles_ == 0) {
      word_ = word();
      nibbles_ = 8;
    }
    --nibbles_;
    return word_ >> (4 * nibbles_) & 15U;
  }

  std::span<const std::byte> bytes_;
  std::uint32_t word_ = 0;
  unsigned nibbles_ = 0;
};

}  // namespace

ImageView decode_rvl(std::span<const std::byte> file, std::vector<std::byte>& pixels) {
  RvlNumbers numbers(file);
  const std::uint32_t width = numbers.word();
  const std::uint32_t height = numbers.word();
  const std::uint64_t area = std::uint64_t{width} * height;
  check_area("its RVL", width, height);
  pixels.assign(area * sizeof(std::uint16_t), std::byte{0});
  std::uint16_t value = 0;
  for (std::uint64_t done = 0; done < area;) {
    done += numbers.number();  // pixels without a reading
    const std::uint32_t readings = numbers.number();
    if (done + readings > area) {
      fail_rvl("it has more pixels than its size");
    }
    for (std::uint32_t i = 0; i < readings; ++i, ++done) {
      const std::uint32_t change = numbers.number();  // 0, -1, 1, -2, 2 ...
      value = static_cast<std::uint16_t>(value + ((change >> 1U) ^ (0U - (change & 1U))));
      std::memcpy(pixels.data() + done * sizeof value, &value, sizeof value);
    }
  }
  return {width, height, 2 * width, "16UC1", /*big_endian=*/false, pixels};
}

}  // namespace spikeloop::images
