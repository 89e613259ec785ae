#include "spikeloop/messages/columns.hpp"

#include <algorithm>
#include <optional>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "wire.hpp"

namespace spikeloop::messages {
namespace {

/// The fields of a message that are read.
struct Part {
  std::optional<std::size_t> column{};  ///< of a number or text
  std::vector<Part> fields{};           ///< of a message; one per field of its type

  bool is_read() const {
    return column || std::ranges::any_of(fields, [](const Part& part) { return part.is_read(); });
  }
};

bool is_below(std::string_view path, std::string_view above) {
  return path.starts_with(above) && (path.size() == above.size() || path[above.size()] == '.');
}

}  // namespace

struct ColumnReader::Impl {
  std::shared_ptr<const TypeLayout> type;
  Part root;
  std::vector<Column> columns;

  Part part_of(const TypeLayout& layout, const std::string& prefix, std::size_t arrays,
               const std::vector<std::string>& paths) {
    Part part;
    for (const FieldLayout& field : layout.fields) {
      const std::string path = prefix + field.name;
      const std::size_t depth = arrays + (field.array == ArrayKind::none ? 0 : 1);
      if (field.primitive == Primitive::message) {
        part.fields.push_back(part_of(*field.message, path + ".", depth, paths));
        continue;
      }
      part.fields.emplace_back();
      known.push_back(path);
      if (paths.empty() || std::ranges::any_of(paths, [&](const std::string& wanted) {
            return is_below(path, wanted);
          })) {
        part.fields.back().column = columns.size();
        columns.push_back({.path = path, .primitive = field.primitive, .counts = {}});
        columns.back().counts.resize(depth);
      }
    }
    return part;
  }

  template <typename Reader>
  void read_message(Reader& reader, const TypeLayout& layout, const Part& part,
                    std::size_t arrays) {
    for (std::size_t i = 0; i < layout.fields.size(); ++i) {
      const FieldLayout& field = layout.fields[i];
      const Part& below = part.fields[i];
      const std::size_t count = read_count(reader, field);
      if (!below.is_read()) {
        skip_elements(reader, field, count);
        continue;
      }
      if (field.array != ArrayKind::none) {
        note_count(below, arrays, static_cast<std::uint32_t>(count));
      }
      const std::size_t depth = arrays + (field.array == ArrayKind::none ? 0 : 1);
      if (field.primitive != Primitive::message) {
        read_values(reader, field, count, columns[*below.column]);
        continue;
      }
      for (std::size_t element = 0; element < count; ++element) {
        read_message(reader, *field.message, below, depth);
      }
    }
  }

  /// Of an array, for all columns below it.
  void note_count(const Part& part, std::size_t level, std::uint32_t count) {
    if (part.column) {
      columns[*part.column].counts[level].push_back(count);
    }
    for (const Part& field : part.fields) {
      note_count(field, level, count);
    }
  }

  template <typename Reader>
  static void read_values(Reader& reader, const FieldLayout& field, std::size_t count,
                          Column& column) {
    if (field.primitive == Primitive::text) {
      for (std::size_t i = 0; i < count; ++i) {
        column.texts.emplace_back(reader.text());
      }
    } else if (is_time(field.primitive)) {
      for (std::size_t i = 0; i < count; ++i) {
        const double seconds = reader.number(field.primitive);
        const auto bytes = std::as_bytes(std::span(&seconds, 1));
        column.numbers.insert(column.numbers.end(), bytes.begin(), bytes.end());
      }
    } else if (count != 0) {
      reader.align(field.alignment);
      const auto bytes = reader.take_bytes(count * *field.element_bytes);
      column.numbers.insert(column.numbers.end(), bytes.begin(), bytes.end());
    }
  }

  std::vector<std::string> known;  // paths of all numbers and texts
};

ColumnReader::ColumnReader(std::shared_ptr<const TypeLayout> type,
                           const std::vector<std::string>& paths)
    : impl_(std::make_unique<Impl>()) {
  impl_->type = std::move(type);
  impl_->root = impl_->part_of(*impl_->type, "", 0, paths);
  for (const std::string& path : paths) {
    if (std::ranges::none_of(impl_->known,
                             [&](const std::string& field) { return is_below(field, path); })) {
      throw ConfigurationError(with_code(Code::field_path, "{} has no field '{}'{}",
                                         impl_->type->name, path,
                                         did_you_mean(path, impl_->known)));
    }
  }
}

ColumnReader::~ColumnReader() = default;

void ColumnReader::read(std::span<const std::byte> message) {
  with_reader(impl_->type->dialect, message,
              [&](auto& reader) { impl_->read_message(reader, *impl_->type, impl_->root, 0); });
}

std::vector<Column> ColumnReader::take_columns() {
  return std::move(impl_->columns);
}

}  // namespace spikeloop::messages
