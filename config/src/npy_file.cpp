#include "spikeloop/config/npy_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "music_text.hpp"
#include "npy_header.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"

namespace spikeloop {

namespace {

using music_text::shown;

static_assert(std::endian::native == std::endian::little, "what is written is '<f8'");

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kVersionEnd = kMagic.size() + 2;
constexpr std::size_t kAlignment = 64;  // of the data, as numpy.save aligns them

/// Appends the numbers of `data`.
template <typename T>
void decode(std::string_view data, bool swapped, std::vector<double>& values) {
  for (std::size_t at = 0; at < data.size(); at += sizeof(T)) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, data.data() + at, sizeof(T));
    if (swapped) {
      std::reverse(std::begin(bytes), std::end(bytes));
    }
    T number{};
    std::memcpy(&number, bytes, sizeof(T));
    values.push_back(static_cast<double>(number));
  }
}

struct ElementType {
  std::string_view name;  ///< behind the letter of the byte order
  std::size_t size;
  void (*decode)(std::string_view data, bool swapped, std::vector<double>& values);
};

constexpr ElementType kTypes[] = {
    {"f8", 8, decode<double>},        {"f4", 4, decode<float>},
    {"i1", 1, decode<std::int8_t>},   {"i2", 2, decode<std::int16_t>},
    {"i4", 4, decode<std::int32_t>},  {"i8", 8, decode<std::int64_t>},
    {"u1", 1, decode<std::uint8_t>},  {"u2", 2, decode<std::uint16_t>},
    {"u4", 4, decode<std::uint32_t>}, {"u8", 8, decode<std::uint64_t>},
};

/// Null for a type that is not read. '|' says that there is no byte order.
const ElementType* find_type(std::string_view type) {
  const bool ordered = type.starts_with('<') || type.starts_with('>');
  for (const ElementType& known : kTypes) {
    if ((ordered || (type.starts_with('|') && known.size == 1)) && type.substr(1) == known.name) {
      return &known;
    }
  }
  return nullptr;
}

std::string unread_type(const std::string& type) {
  if (type.empty()) {
    return "the array has named fields; write an array of plain numbers";
  }
  if (type.starts_with("|O")) {
    return "the array holds Python objects, as one of rows of different lengths does; write "
           "numbers: numpy.array(weights, dtype=float)";
  }
  return fmt::format(
      "the array holds '{}'; float64, float32 and whole numbers are read: write "
      "weights.astype(float)",
      shown(type));
}

/// The length of the header's text, which stands before it; nothing when the bytes end before.
std::size_t header_length(std::string_view bytes, std::size_t digits) {
  std::size_t length = 0;
  for (std::size_t i = digits; i > 0; --i) {
    length = length << 8 | static_cast<unsigned char>(bytes[kVersionEnd + i - 1]);
  }
  return length;
}

[[noreturn]] void refuse(const std::string& file, const std::string& message) {
  throw ConfigurationError(Location{file}, with_code(Code::weight_file, message));
}

/// The text of the header; `begin` of the data behind it.
std::string_view header_text(std::string_view bytes, const std::string& file, std::size_t& begin) {
  if (!is_npy(bytes)) {
    refuse(file,
           "this is no .npy file, it does not begin with \\x93NUMPY; write it with numpy.save, or "
           "give a JSON file another name");
  }
  const std::string cut_off =
      fmt::format("the file ends within its header, after {} bytes; it was cut off, write it again",
                  bytes.size());
  if (bytes.size() < kVersionEnd) {
    refuse(file, cut_off);
  }
  const int major = static_cast<unsigned char>(bytes[kMagic.size()]);
  const int minor = static_cast<unsigned char>(bytes[kMagic.size() + 1]);
  if (major < 1 || major > 3 || minor != 0) {
    refuse(file, fmt::format("format version {}.{} is not known; write 1.0, 2.0 or 3.0, as "
                             "numpy.save does",
                             major, minor));
  }
  const std::size_t digits = major == 1 ? 2 : 4;
  const std::size_t text = kVersionEnd + digits;
  const std::size_t length = bytes.size() < text ? 0 : header_length(bytes, digits);
  if (bytes.size() < text + length) {
    refuse(file, cut_off);
  }
  begin = text + length;
  return bytes.substr(text, length);
}

std::string shape_text(const std::vector<std::uint64_t>& shape, const std::string& type) {
  return fmt::format("shape ({}{}) of '{}'", fmt::join(shape, ", "), shape.size() == 1 ? "," : "",
                     type);
}

}  // namespace

bool is_npy(std::string_view bytes) {
  return bytes.starts_with(kMagic);
}

NpyArray::NpyArray(std::string_view bytes, std::string file) : file_(std::move(file)) {
  std::size_t begin = 0;
  const auto header = npy::parse_header(header_text(bytes, file_, begin));
  if (!header) {
    refuse(file_,
           "the header is not a dictionary of 'descr', 'fortran_order' and 'shape'; write the file "
           "with numpy.save");
  }
  const ElementType* const type = find_type(header->type);
  if (type == nullptr) {
    refuse(file_, unread_type(header->type));
  }
  if (header->shape.empty() || header->shape.size() > 2) {
    refuse(file_, fmt::format("the array has {} dimensions; write 2, [output, input], or 1 for a "
                              "single row",
                              header->shape.size()));
  }
  type_ = header->type;
  by_columns_ = header->by_columns;
  rows_ = header->shape.size() == 1 ? 1 : header->shape.front();
  columns_ = header->shape.back();
  data_ = bytes.substr(begin);
  // Divided, because the product of what a broken file says may be beyond 64 bits.
  if (columns_ != 0 && rows_ > data_.size() / type->size / columns_) {
    refuse(file_, fmt::format("the file has {} bytes of data, too few for {}; it was cut off, "
                              "write it again",
                              data_.size(), shape_text(header->shape, type_)));
  }
  const std::size_t used = rows_ * columns_ * type->size;
  surplus_ = data_.size() - used;
  data_ = data_.substr(0, used);
}

std::vector<double> NpyArray::values() const {
  std::vector<double> values;
  values.reserve(rows_ * columns_);
  find_type(type_)->decode(data_, type_.starts_with('>'), values);
  if (by_columns_ && rows_ > 1 && columns_ > 1) {
    const std::vector<double> written = values;
    for (std::size_t i = 0; i < written.size(); ++i) {
      values[i % rows_ * columns_ + i / rows_] = written[i];
    }
  }
  const auto wrong =
      std::ranges::find_if(values, [](double value) { return !std::isfinite(value); });
  if (wrong != values.end()) {
    const auto i = static_cast<std::size_t>(wrong - values.begin());
    refuse(file_, fmt::format("row {}, column {} is {}; write a finite number", i / columns_,
                              i % columns_, *wrong));
  }
  return values;
}

void write_npy(const std::filesystem::path& path, std::uint64_t rows, std::uint64_t columns,
               std::span<const double> values) {
  if (values.size() != rows * columns) {
    throw std::logic_error(fmt::format("{} values are no table of {} rows and {} columns",
                                       values.size(), rows, columns));
  }
  std::string header =
      fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {}), }}", rows, columns);
  const std::size_t before = kVersionEnd + 2;
  header.append(kAlignment - 1 - (before + header.size()) % kAlignment, ' ');
  header += '\n';
  std::ofstream stream = create_stream(path);
  errno = 0;
  stream << kMagic << '\x01' << '\0' << static_cast<char>(header.size())
         << static_cast<char>(header.size() >> 8) << header;
  stream.write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size_bytes()));
  stream.close();
  if (!stream) {
    throw FileError("write", path.string(), errno);
  }
}

}  // namespace spikeloop
