// C++ types of the numbers of messages.
#pragma once

#include <cstdint>
#include <stdexcept>

#include "spikeloop/messages/definition.hpp"

namespace spikeloop::messages {

/// Calls `work` with a value of the type of a number, and returns its result. A boolean is one
/// byte. @throws std::logic_error for a text, a time and a message
template <typename Work>
decltype(auto) with_number(Primitive primitive, Work&& work) {
  static_assert(sizeof(bool) == 1);
  switch (primitive) {
    case Primitive::boolean:
      return work(bool{});
    case Primitive::int8:
      return work(std::int8_t{});
    case Primitive::uint8:
      return work(std::uint8_t{});
    case Primitive::int16:
      return work(std::int16_t{});
    case Primitive::uint16:
      return work(std::uint16_t{});
    case Primitive::int32:
      return work(std::int32_t{});
    case Primitive::uint32:
      return work(std::uint32_t{});
    case Primitive::int64:
      return work(std::int64_t{});
    case Primitive::uint64:
      return work(std::uint64_t{});
    case Primitive::float32:
      return work(float{});
    case Primitive::float64:
      return work(double{});
    default:
      throw std::logic_error("neither a text nor a message is a number");
  }
}

constexpr bool is_time(Primitive primitive) {
  return primitive == Primitive::time || primitive == Primitive::duration;
}

}  // namespace spikeloop::messages
