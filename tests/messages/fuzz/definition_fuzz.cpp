// Message definitions under libFuzzer (scripts/fuzz): whatever the bytes are, in either dialect
// there is an error that says something, or a type whose layout, sums and text can be had, and
// messages of it that can be written and read.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/messages/message_writer.hpp"

using namespace spikeloop;
using namespace spikeloop::messages;

namespace {

constexpr const char* kType = "fuzz_msgs/Thing";
constexpr std::size_t kLargest = 100'000;  // bytes; larger messages are slow, not wrong

void need(bool condition) {
  if (!condition) {
    std::abort();
  }
}

std::string sum(const Catalog& catalog) {
  return catalog.dialect() == Dialect::ros1 ? catalog.md5(kType) : catalog.type_hash(kType);
}

/// Fields that nobody sets are there, with values that can be written.
void check_fields(const Catalog& catalog, const TypeLayout& type) {
  std::vector<std::byte> message;
  MessageWriter(catalog, kType, {}).write({}, message);
  need(message.size() >= type.least);
  for (const FieldLayout& field : type.fields) {
    if (field.primitive == Primitive::text || field.primitive == Primitive::message) {
      continue;
    }
    std::vector<double> numbers;
    const FieldReader reader(catalog, kType, field.name);
    need(reader.read(message, numbers) == numbers.size());
    const FieldValue value{numbers, {}};
    std::vector<std::byte> again;
    MessageWriter(catalog, kType, {field.name}).write(std::span(&value, 1), again);
    need(again == message);
  }
}

void check(Dialect dialect, std::string_view text) {
  static Catalog catalogs[] = {Catalog::builtin(Dialect::ros1), Catalog::builtin(Dialect::ros2)};
  Catalog& catalog = catalogs[dialect == Dialect::ros1 ? 0 : 1];
  try {
    catalog.add(kType, text);
    const auto layout = catalog.layout(kType);
    Catalog again(dialect);
    again.add_with_dependencies(kType, catalog.full_text(kType));
    if (text.find("MSG: ") == std::string_view::npos &&
        text.find("===") == std::string_view::npos) {
      need(sum(again) == sum(catalog));
    }
    if (layout->least <= kLargest) {
      check_fields(catalog, *layout);
    }
  } catch (const ConfigurationError& error) {
    need(*error.what() != 0);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  check(Dialect::ros1, text);
  check(Dialect::ros2, text);
  return 0;
}
