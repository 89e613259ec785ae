#include "spikeloop/messages/message_writer.hpp"

#include <fmt/format.h>

#include <algorithm>

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

bool takes(const FieldPath& path, std::size_t level, std::size_t field) {
  return level < path.steps.size() && path.steps[level].field == field;
}

std::size_t array_length(const FieldLayout& field, std::size_t level, const Active& active) {
  if (field.array != ArrayKind::variable) {
    return field.array == ArrayKind::fixed ? field.count : 1;
  }
  std::size_t length = 0;
  for (const Progress* progress : active) {
    const PathStep& step = progress->path->steps[level];
    length =
        std::max(length, step.last != PathStep::kEnd ? step.last
                                                     : step.first + progress->value.numbers.size());
  }
  return length;
}

double next_number(Progress& progress) {
  return progress.value.numbers[progress.written++];
}

void write_primitive(Ros1Writer& writer, const FieldLayout& field, const Active& active) {
  if (field.primitive == Primitive::text) {
    writer.text(active.empty() ? std::string_view{} : active.front()->value.text);
    return;
  }
  const bool in_parts =
      !active.empty() && active.front()->path->time_part != FieldPath::TimePart::whole;
  if (!in_parts) {
    writer.number(field.primitive, active.empty() ? 0.0 : next_number(*active.front()));
    return;
  }
  double seconds = 0;
  double nanoseconds = 0;
  for (Progress* progress : active) {
    (progress->path->time_part == FieldPath::TimePart::secs ? seconds : nanoseconds) =
        next_number(*progress);
  }
  const bool is_signed = field.primitive == Primitive::duration;
  const Primitive half = is_signed ? Primitive::int32 : Primitive::uint32;
  writer.number(half, seconds);
  writer.number(half, nanoseconds);
}

void write_message(Ros1Writer& writer, const TypeLayout& type, std::size_t level,
                   const Active& active);

void write_field(Ros1Writer& writer, const FieldLayout& field, std::size_t level,
                 const Active& active) {
  const std::size_t length = array_length(field, level, active);
  if (field.array == ArrayKind::variable) {
    writer.length(length);
  }
  Active here;
  for (std::size_t i = 0; i < length; ++i) {
    here.clear();
    for (Progress* progress : active) {
      const PathStep& step = progress->path->steps[level];
      if (i >= step.first && i < step.last) {
        here.push_back(progress);
      }
    }
    if (field.primitive == Primitive::message) {
      write_message(writer, *field.message, level + 1, here);
    } else {
      write_primitive(writer, field, here);
    }
  }
}

void write_message(Ros1Writer& writer, const TypeLayout& type, std::size_t level,
                   const Active& active) {
  Active within;
  for (std::size_t i = 0; i < type.fields.size(); ++i) {
    within.clear();
    for (Progress* progress : active) {
      if (takes(*progress->path, level, i)) {
        within.push_back(progress);
      }
    }
    write_field(writer, type.fields[i], level, within);
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
  for (const std::string& text : paths) {
    FieldPath path = compile_path(catalog, type, text);
    for (std::size_t i = 0; i < path.steps.size(); ++i) {
      const bool is_last = i + 1 == path.steps.size();
      if (path.steps[i].last == PathStep::kEnd && (!is_last || path.is_text())) {
        throw ConfigurationError(fmt::format(
            "field path '{}' of {}: the array's length is not known; name its elements, as in [0]",
            text, type_->name));
      }
    }
    for (const FieldPath& other : paths_) {
      if (overlap(path, other)) {
        throw ConfigurationError(
            fmt::format("field paths '{}' and '{}' of {} set the same value; leave one of them out",
                        other.text, text, type_->name));
      }
    }
    paths_.push_back(std::move(path));
  }
}

void MessageWriter::check(std::span<const FieldValue> values) const {
  if (values.size() != paths_.size()) {
    throw std::logic_error("MessageWriter::write needs a value for each path");
  }
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    const auto width = paths_[i].width();
    if (!paths_[i].is_text() && width && *width != values[i].numbers.size()) {
      throw ConfigurationError(fmt::format("field '{}' of {} takes {} values, not {}",
                                           paths_[i].text, type_->name, *width,
                                           values[i].numbers.size()));
    }
  }
}

void MessageWriter::write(std::span<const FieldValue> values,
                          std::vector<std::byte>& message) const {
  check(values);
  message.clear();
  std::vector<Progress> progress;
  for (std::size_t i = 0; i < paths_.size(); ++i) {
    progress.push_back({&paths_[i], values[i], 0});
  }
  Active active;
  for (Progress& each : progress) {
    active.push_back(&each);
  }
  Ros1Writer writer(message);
  write_message(writer, *type_, 0, active);
}

}  // namespace spikeloop::messages
