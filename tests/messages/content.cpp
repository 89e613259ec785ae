#include "content.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace spikeloop::test {
namespace {

using messages::ArrayKind;
using messages::FieldLayout;
using messages::Primitive;
using messages::TypeLayout;

class Maker {
 public:
  explicit Maker(unsigned seed) : engine_(seed) {}

  void message(const TypeLayout& type, const std::string& prefix) {
    for (const FieldLayout& field : type.fields) {
      std::size_t count = field.array == ArrayKind::fixed ? field.count : 1;
      if (field.array == ArrayKind::variable) {
        count = below(field.primitive == Primitive::message ? 4 : 12);
        count = field.count == 0 ? count : std::min<std::size_t>(count, field.count);
        content.atoms.push_back({static_cast<double>(count), {}});
      }
      elements(field, prefix + field.name, count);
    }
  }

  Content content;

 private:
  void elements(const FieldLayout& field, const std::string& path, std::size_t count) {
    const bool is_time =
        field.primitive == Primitive::time || field.primitive == Primitive::duration;
    if (field.primitive < Primitive::text) {
      content.numbers.emplace_back(path, std::vector<double>{});
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::string element =
          field.array == ArrayKind::none ? path : path + "[" + std::to_string(i) + "]";
      if (field.primitive == Primitive::message) {
        message(*field.message, element + ".");
      } else if (field.primitive == Primitive::text) {
        content.texts.emplace_back(element, text(field.longest_text));
        content.atoms.push_back({0, content.texts.back().second});
      } else if (is_time) {
        content.numbers.emplace_back(element + ".secs",
                                     std::vector<double>{number(Primitive::uint32) / 2});
        content.numbers.back().second[0] = std::floor(content.numbers.back().second[0]);
        content.atoms.push_back({content.numbers.back().second[0], {}});
        content.numbers.emplace_back(
            element + ".nsecs", std::vector<double>{static_cast<double>(below(1'000'000'000))});
        content.atoms.push_back({content.numbers.back().second[0], {}});
      } else {
        const double value = number(field.primitive);
        content.numbers.back().second.push_back(value);
        content.atoms.push_back({value, {}});
      }
    }
  }

  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(engine_);
  }

  double whole(double least, double most) {
    return std::floor(std::uniform_real_distribution<double>(least, most)(engine_));
  }

  double number(Primitive primitive) {
    constexpr double kExact = 9007199254740992.0;  // 2^53
    switch (primitive) {
      case Primitive::boolean:
        return static_cast<double>(below(2));
      case Primitive::int8:
        return whole(-128, 128);
      case Primitive::uint8:
        return whole(0, 256);
      case Primitive::int16:
        return whole(-32768, 32768);
      case Primitive::uint16:
        return whole(0, 65536);
      case Primitive::int32:
        return whole(-2147483648.0, 2147483648.0);
      case Primitive::uint32:
        return whole(0, 4294967296.0);
      case Primitive::int64:
        return whole(-kExact, kExact);
      case Primitive::uint64:
        return whole(0, kExact);
      case Primitive::float32:
        return static_cast<double>(std::normal_distribution<float>(0, 100)(engine_));
      case Primitive::float64:
        return std::normal_distribution<double>(0, 100)(engine_);
      default:
        throw std::logic_error("no number");
    }
  }

  std::string text(std::uint32_t longest) {
    std::string value;
    const std::size_t most = longest == 0 ? 12 : std::min<std::size_t>(12, longest);
    for (std::size_t i = below(most + 1); i > 0; --i) {
      value.push_back(static_cast<char>('a' + below(26)));
    }
    return value;
  }

  std::mt19937 engine_;
};

}  // namespace

Content random_content(const TypeLayout& type, unsigned seed) {
  Maker maker(seed);
  maker.message(type, "");
  return maker.content;
}

}  // namespace spikeloop::test
