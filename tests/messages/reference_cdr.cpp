#include "reference_cdr.hpp"

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <map>
#include <stdexcept>

namespace reference {
namespace {

using eprosima::fastcdr::Cdr;
using spikeloop::messages::ArrayKind;
using spikeloop::messages::Catalog;
using spikeloop::messages::FieldDefinition;

constexpr std::size_t kLongest = 1 << 17;  // bytes

template <typename Number>
void put(Cdr& cdr, const Atom& atom) {
  cdr << static_cast<Number>(atom.number);
}

using Put = void (*)(Cdr&, const Atom&);

const std::map<std::string, Put> kPrimitives = {
    {"bool", [](Cdr& cdr, const Atom& atom) { cdr << (atom.number != 0); }},
    {"byte", put<std::uint8_t>},
    {"char", put<std::uint8_t>},
    {"int8", put<std::int8_t>},
    {"uint8", put<std::uint8_t>},
    {"int16", put<std::int16_t>},
    {"uint16", put<std::uint16_t>},
    {"int32", put<std::int32_t>},
    {"uint32", put<std::uint32_t>},
    {"int64", put<std::int64_t>},
    {"uint64", put<std::uint64_t>},
    {"float32", put<float>},
    {"float64", put<double>},
    {"string", [](Cdr& cdr, const Atom& atom) { cdr << atom.text; }},
};

class Serializer {
 public:
  Serializer(const Catalog& catalog, Cdr& cdr, const std::vector<Atom>& atoms)
      : catalog_(catalog), cdr_(cdr), atoms_(atoms) {}

  void message(const std::string& type) {
    const auto& fields = catalog_.find(type).fields;
    if (fields.empty()) {
      cdr_ << std::uint8_t{0};
    }
    for (const FieldDefinition& field : fields) {
      std::size_t count = field.array == ArrayKind::fixed ? field.count : 1;
      if (field.array == ArrayKind::variable) {
        count = static_cast<std::size_t>(take().number);
        cdr_ << static_cast<std::uint32_t>(count);
      }
      const auto primitive = kPrimitives.find(field.type);
      for (std::size_t i = 0; i < count; ++i) {
        if (primitive == kPrimitives.end()) {
          message(field.type);
        } else {
          primitive->second(cdr_, take());
        }
      }
    }
  }

  bool at_end() const { return next_ == atoms_.size(); }

 private:
  const Atom& take() { return atoms_.at(next_++); }

  const Catalog& catalog_;
  Cdr& cdr_;
  const std::vector<Atom>& atoms_;
  std::size_t next_ = 0;
};

}  // namespace

std::vector<std::uint8_t> serialize_cdr(const Catalog& catalog, const std::string& type,
                                        const std::vector<Atom>& atoms) {
  std::vector<char> memory(kLongest);  // zero, where numbers are aligned
  eprosima::fastcdr::FastBuffer buffer(memory.data(), memory.size());
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  Serializer serializer(catalog, cdr, atoms);
  serializer.message(type);
  if (!serializer.at_end()) {
    throw std::logic_error("the message has fewer fields than it was given");
  }
  const auto* const begin = reinterpret_cast<const std::uint8_t*>(buffer.getBuffer());
  return {begin, begin + cdr.getSerializedDataLength()};
}

}  // namespace reference
