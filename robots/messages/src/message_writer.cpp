#include "spikeloop/messages/message_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "named_elements.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "wire.hpp"

namespace spikeloop::messages {
namespace {

/// A path on its way through the message: how many of its values are written.
struct Progress {
  const FieldPath* path = nullptr;
  FieldValue value;
  std::size_t written = 0;
};
using Active = std::vector<Progress*>;

/// How numbers are written that no path sets.
struct Unset {
  bool parallel = false;  ///< the message, or one that contains it, has parallel arrays
  bool commanded = true;  ///< false within an element of a parallel array that no path names
};

bool takes(const FieldPath& path, std::size_t level, std::size_t field) {
  return level < path.steps.size() && path.steps[level].field == field;
}

std::size_t count_of(const FieldValue& value) {
  return value.numbers.size() + value.bytes.size();
}

std::size_t array_length(const FieldLayout& field, std::size_t level, const Active& active) {
  if (field.array != ArrayKind::variable) {
    return field.array == ArrayKind::fixed ? field.count : 1;
  }
  if (active.empty()) {
    return std::max(field.otherwise.numbers.size(), field.otherwise.texts.size());
  }
  std::size_t length = 0;
  for (const Progress* progress : active) {
    const PathStep& step = progress->path->steps[level];
    const std::size_t last =
        step.last != PathStep::kEnd ? step.last : step.first + count_of(progress->value);
    length = std::max({length, last, step.least_length});
  }
  return length;
}

double next_number(Progress& progress) {
  return progress.value.numbers[progress.written++];
}

double default_number(const FieldLayout& field, std::size_t element, const Unset& unset) {
  if (element < field.otherwise.numbers.size()) {
    return field.otherwise.numbers[element];
  }
  const bool has_nan =
      field.primitive == Primitive::float32 || field.primitive == Primitive::float64;
  return has_nan && !unset.commanded ? std::numeric_limits<double>::quiet_NaN() : 0.0;
}

std::string_view default_text(const FieldLayout& field, std::size_t element) {
  return element < field.otherwise.texts.size() ? field.otherwise.texts[element]
                                                : std::string_view{};
}

template <typename Writer>
void write_primitive(Writer& writer, const FieldLayout& field, std::size_t element,
                     const Active& active, const Unset& unset) {
  if (field.primitive == Primitive::text) {
    writer.text(active.empty() ? default_text(field, element) : active.front()->value.text);
    return;
  }
  if (active.empty()) {
    writer.number(field.primitive, default_number(field, element, unset));
    return;
  }
  if (active.front()->path->time_part == FieldPath::TimePart::whole) {
    writer.number(field.primitive, next_number(*active.front()));
    return;
  }
  double seconds = 0;
  double nanoseconds = 0;
  for (Progress* progress : active) {
    (progress->path->time_part == FieldPath::TimePart::secs ? seconds : nanoseconds) =
        next_number(*progress);
  }
  writer.number(Writer::Reader::half_of_time(field.primitive, false), seconds);
  writer.number(Writer::Reader::half_of_time(field.primitive, true), nanoseconds);
}

/// True for numbers, and for messages that the paths choose by names in an array beside them.
bool is_one_per_joint(const FieldLayout& field, std::size_t level, const Active& active) {
  return field.primitive != Primitive::message ||
         std::ranges::any_of(active, [level](const Progress* progress) {
           return progress->path->steps[level].least_length != 0;
         });
}

template <typename Writer>
void write_message(Writer& writer, const TypeLayout& type, std::size_t level, const Active& active,
                   Unset unset);

template <typename Writer>
void write_field(Writer& writer, const FieldLayout& field, std::size_t level, const Active& active,
                 const Unset& unset) {
  const std::size_t length = array_length(field, level, active);
  if (field.array == ArrayKind::variable) {
    writer.length(length);
  }
  if (active.size() == 1 && !active.front()->value.bytes.empty()) {
    writer.bytes(active.front()->value.bytes);
    return;
  }
  if (field.element_bytes == std::size_t{0}) {
    return;  // ROS 1's messages without fields: any number of them is nothing
  }
  const bool parallel = unset.parallel && field.array == ArrayKind::variable && !active.empty();
  Active here;
  for (std::size_t i = 0; i < length; ++i) {
    here.clear();
    for (Progress* progress : active) {
      const PathStep& step = progress->path->steps[level];
      if (i >= step.first && i < step.last) {
        here.push_back(progress);
      }
    }
    Unset within = unset;
    if (here.empty() && parallel && is_one_per_joint(field, level, active)) {
      within.commanded = false;
    }
    if (field.primitive == Primitive::message) {
      write_message(writer, *field.message, level + 1, here, within);
    } else {
      write_primitive(writer, field, i, here, within);
    }
  }
}

template <typename Writer>
void write_message(Writer& writer, const TypeLayout& type, std::size_t level, const Active& active,
                   Unset unset) {
  unset.parallel = unset.parallel || has_parallel_arrays(type);
  if (type.fields.empty() && type.dialect == Dialect::ros2) {
    writer.number(Primitive::uint8, 0.0);
  }
  Active within;
  for (std::size_t i = 0; i < type.fields.size(); ++i) {
    within.clear();
    for (Progress* progress : active) {
      if (takes(*progress->path, level, i)) {
        within.push_back(progress);
      }
    }
    write_field(writer, type.fields[i], level, within, unset);
  }
}

/// True when both paths set some same value.
bool overlap(const FieldPath& a, const FieldPath& b) {
  if (a.steps.size() != b.steps.size()) {
    return false;
  }
  for (std::size_t i = 0; i < a.steps.size(); ++i) {
    const PathStep& x = a.steps[i];
    const PathStep& y = b.steps[i];
    if (x.field != y.field || x.first >= y.last || y.first >= x.last) {
      return false;
    }
  }
  return a.time_part == b.time_part || a.time_part == FieldPath::TimePart::whole ||
         b.time_part == FieldPath::TimePart::whole;
}

}  // namespace

MessageWriter::MessageWriter(const Catalog& catalog, std::string_view type,
                             const std::vector<std::string>& paths)
    : type_(catalog.layout(catalog.full_name(type))) {
  std::vector<FieldPath> chosen;
  for (const std::string& text : paths) {
    chosen.push_back(compile_path(catalog, type, text));
  }
  std::vector<NamedText> named = place_named_elements(chosen);
  align_parallel_arrays(chosen);
  for (FieldPath& path : chosen) {
    add(std::move(path));
  }
  for (auto& [path, text] : named) {
    add(std::move(path));
    texts_.push_back(std::move(text));
  }
}

void MessageWriter::add(FieldPath path) {
  for (std::size_t i = 0; i < path.steps.size(); ++i) {
    const bool is_last = i + 1 == path.steps.size();
    if (path.steps[i].last == PathStep::kEnd && (!is_last || path.is_text())) {
      throw ConfigurationError(with_code(
          Code::field_path,
          "field path '{}' of {}: the array's length is not known; name its elements, as in [0]",
          path.text, type_->name));
    }
  }
  check_length(path);
  for (const FieldPath& other : paths_) {
    if (overlap(path, other)) {
      throw ConfigurationError(
          with_code(Code::field_path,
                    "field paths '{}' and '{}' of {} set the same value; leave one of them out",
                    other.text, path.text, type_->name));
    }
  }
  paths_.push_back(std::move(path));
}

void MessageWriter::check_length(const FieldPath& path) const {
  for (std::size_t level = 0; level < path.steps.size(); ++level) {
    const PathStep& step = path.steps[level];
    const std::size_t length = step.last == PathStep::kEnd ? step.first : step.last;
    if (length * path.field(level).element_least > kLargestMessage) {
      throw ConfigurationError(
          with_code(Code::field_path,
                    "field path '{}' of {}: the message would be longer than 1 GB; name elements "
                    "nearer to the first one",
                    path.text, type_->name));
    }
  }
}

void MessageWriter::check_text(const FieldPath& path, std::string_view text) const {
  const std::uint32_t longest = path.target().longest_text;
  if (longest != 0 && text.size() > longest) {
    throw ConfigurationError(with_code(
        Code::out_of_bounds, "field '{}' of {} takes at most {} bytes, not the {} of '{}'",
        path.text, type_->name, longest, text.size(), text));
  }
}

void MessageWriter::check_numbers(const FieldPath& path, const FieldValue& value) const {
  const std::size_t count = count_of(value);
  if (!value.bytes.empty() &&
      (path.target().primitive != Primitive::uint8 || path.target().array != ArrayKind::variable ||
       path.steps.back().first != 0 || path.steps.back().last != PathStep::kEnd)) {
    throw std::logic_error("MessageWriter::write needs numbers for what is not a whole uint8[]");
  }
  const auto width = path.width();
  if (width && *width != count) {
    throw ConfigurationError(with_code(Code::field_path, "field '{}' of {} takes {} values, not {}",
                                       path.text, type_->name, *width, count));
  }
  const FieldLayout& target = path.target();
  const std::size_t most = target.array == ArrayKind::variable ? target.count : 0;
  if (most != 0 && path.steps.back().first + count > most) {
    throw ConfigurationError(
        with_code(Code::out_of_bounds, "field '{}' of {} takes at most {} values, not {}",
                  path.text, type_->name, most - path.steps.back().first, count));
  }
}

void MessageWriter::write(std::span<const FieldValue> values,
                          std::vector<std::byte>& message) const {
  const std::size_t given = paths_.size() - texts_.size();
  if (values.size() != given) {
    throw std::logic_error("MessageWriter::write needs a value for each path");
  }
  message.clear();
  std::vector<Progress> progress;
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    const FieldValue value = i < given ? values[i] : FieldValue{{}, texts_[i - given], {}};
    if (paths_[i].is_text()) {
      check_text(paths_[i], value.text);
    } else {
      check_numbers(paths_[i], value);
    }
    progress.push_back({&paths_[i], value, 0});
  }
  Active active;
  for (Progress& each : progress) {
    active.push_back(&each);
  }
  if (type_->dialect == Dialect::ros2) {
    WireWriter<Dialect::ros2> writer(message);
    write_message(writer, *type_, 0, active, {});
  } else {
    WireWriter<Dialect::ros1> writer(message);
    write_message(writer, *type_, 0, active, {});
  }
}

}  // namespace spikeloop::messages
