#include "spikeloop/messages/translation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "wire.hpp"

namespace spikeloop::messages {
namespace {

struct CdrSize {
  std::size_t bytes = 0;
  std::size_t alignment = 1;
};

CdrSize cdr_size_of(Primitive primitive) {
  switch (primitive) {
    case Primitive::boolean:
    case Primitive::int8:
    case Primitive::uint8:
      return {1, 1};
    case Primitive::int16:
    case Primitive::uint16:
      return {2, 2};
    case Primitive::int32:
    case Primitive::uint32:
    case Primitive::float32:
      return {4, 4};
    case Primitive::int64:
    case Primitive::uint64:
    case Primitive::float64:
      return {8, 8};
    case Primitive::time:
    case Primitive::duration:
      return {8, 4};
    default:
      throw std::logic_error("neither a text nor a message has a size");
  }
}

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// The field of this name, which ROS 2 writes in small letters; past the end when there is none.
std::size_t find_field(const TypeLayout& type, const std::string& name) {
  const auto found = std::ranges::find_if(type.fields, [&name](const FieldLayout& field) {
    return std::ranges::equal(field.name, name, {}, lower, lower);
  });
  return static_cast<std::size_t>(found - type.fields.begin());
}

/// ROS 2 calls byte what ROS 1 calls int8.
bool alike(const FieldLayout& a, const FieldLayout& b) {
  const auto is_byte = [](Primitive primitive) {
    return primitive == Primitive::int8 || primitive == Primitive::uint8;
  };
  const bool same_type =
      a.primitive == b.primitive || (is_byte(a.primitive) && is_byte(b.primitive));
  return same_type && a.array == b.array && (a.array != ArrayKind::fixed || a.count == b.count);
}

void check(const TypeLayout& from, const TypeLayout& to) {
  std::size_t next = 0;
  for (const FieldLayout& field : to.fields) {
    const std::size_t place = find_field(from, field.name);
    if (place == from.fields.size()) {
      continue;
    }
    if (place < next || !alike(from.fields[place], field)) {
      throw ConfigurationError(
          with_code(Code::field_path,
                    "{} has the field '{}' in both versions of ROS, but {}; it cannot be "
                    "translated",
                    to.name, field.name, place < next ? "in another order" : "of another type"));
    }
    next = place + 1;
    if (field.primitive == Primitive::message) {
      check(*from.fields[place].message, *field.message);
    }
  }
}

template <typename Reader, typename Writer>
class Walk {
 public:
  Walk(Reader& reader, Writer& writer) : reader_(reader), writer_(writer) {}

  void message(const TypeLayout& from, const TypeLayout& to) {
    if (from.fields.empty()) {
      skip_message(reader_, from);
    }
    write_nothing(to);
    std::size_t next = 0;
    for (const FieldLayout& field : to.fields) {
      const std::size_t place = find_field(from, field.name);
      if (place == from.fields.size()) {
        make_empty(field);
        continue;
      }
      skip(from, next, place);
      copy(from.fields[place], field);
      next = place + 1;
    }
    skip(from, next, from.fields.size());
  }

 private:
  void skip(const TypeLayout& from, std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      skip_elements(reader_, from.fields[i], read_count(reader_, from.fields[i]));
    }
  }

  void copy(const FieldLayout& from, const FieldLayout& to) {
    const std::size_t count = read_count(reader_, from);
    if (to.array == ArrayKind::variable) {
      writer_.length(count);
    }
    if (to.primitive != Primitive::message && to.primitive != Primitive::text) {
      copy_numbers(to.primitive, count);
      return;
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (to.primitive == Primitive::text) {
        writer_.text(reader_.text());
      } else {
        message(*from.message, *to.message);
      }
    }
  }

  void copy_numbers(Primitive primitive, std::size_t count) {
    if (count > 0) {
      const CdrSize size = cdr_size_of(primitive);
      reader_.align(size.alignment);
      writer_.bytes(reader_.take_bytes(count * size.bytes), size.alignment);
    }
  }

  void make_empty(const FieldLayout& field) {
    if (field.array == ArrayKind::variable) {
      writer_.length(0);
      return;
    }
    const std::size_t count = field.array == ArrayKind::fixed ? field.count : 1;
    for (std::size_t i = 0; i < count; ++i) {
      if (field.primitive == Primitive::text) {
        writer_.text({});
      } else if (field.primitive == Primitive::message) {
        write_nothing(*field.message);
        std::ranges::for_each(field.message->fields,
                              [this](const FieldLayout& part) { make_empty(part); });
      } else {
        writer_.number(field.primitive, 0);
      }
    }
  }

  /// ROS 2 has a byte in place of no fields.
  void write_nothing(const TypeLayout& to) {
    if (to.fields.empty() && to.dialect == Dialect::ros2) {
      writer_.number(Primitive::uint8, 0);
    }
  }

  Reader& reader_;
  Writer& writer_;
};

}  // namespace

Translation::Translation(std::string_view type, const Catalog& from, const Catalog& to)
    : from_(from.layout(from.full_name(type))), to_(to.layout(to.full_name(type))) {
  check(*from_, *to_);
}

void Translation::translate(std::span<const std::byte> message,
                            std::vector<std::byte>& result) const {
  result.clear();
  with_reader(from_->dialect, message, [&](auto& reader) {
    const auto walk = [&](auto writer) { Walk(reader, writer).message(*from_, *to_); };
    if (to_->dialect == Dialect::ros2) {
      walk(WireWriter<Dialect::ros2>(result));
    } else {
      walk(WireWriter<Dialect::ros1>(result));
    }
  });
}

}  // namespace spikeloop::messages
