// Goes to the elements that a field path means, in the bytes of a message.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <stdexcept>

#include "spikeloop/messages/field_path.hpp"
#include "wire.hpp"

namespace spikeloop::messages {

/// Half-open range [first, last) between the brackets of a path: "7", "0:100" or "3:".
struct Elements {
  std::size_t first = 0;
  std::size_t last = PathStep::kEnd;
  bool has_end = true;  ///< false for "3:"

  bool is_too_far() const { return first >= kMostElements || (has_end && last > kMostElements); }
};
/// nullopt: the text is not such a range.
std::optional<Elements> parse_elements(std::string_view inside);

template <typename Reader>
void skip_fields(Reader& reader, const TypeLayout& type, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    skip_elements(reader, type.fields[i], read_count(reader, type.fields[i]));
  }
}

/// Which text of the array beside is the selected one. @param reader at the message's begin
template <typename Reader>
std::optional<std::size_t> find_text(Reader reader, const TypeLayout& type,
                                     const Selector& selector) {
  skip_fields(reader, type, selector.key);
  const std::size_t count = read_count(reader, type.fields[selector.key]);
  for (std::size_t i = 0; i < count; ++i) {
    if (reader.text() == selector.text) {
      return i;
    }
  }
  return std::nullopt;
}

/// Which element has the selected text. @param reader at the first of `count` elements
template <typename Reader>
std::optional<std::size_t> find_element(Reader reader, const FieldLayout& field, std::size_t count,
                                        const Selector& selector) {
  for (std::size_t i = 0; i < count; ++i) {
    Reader inside = reader;
    skip_fields(inside, *field.message, selector.key);
    if (inside.text() == selector.text) {
      return i;
    }
    skip_element(reader, field);
  }
  return std::nullopt;
}

/// Calls visit(reader, field, count) at the first of `count` elements, for every message that the
/// path leads through and that has such elements.
template <typename Reader, typename Visit>
void walk_path(Reader reader, const FieldPath& path, const TypeLayout& type, std::size_t level,
               const Visit& visit) {
  const PathStep& step = path.steps[level];
  const Reader start = reader;
  skip_fields(reader, type, step.field);
  const FieldLayout& field = type.fields[step.field];
  const std::size_t count = read_count(reader, field);
  std::size_t first = step.first;
  std::size_t last = std::min(count, step.last);
  if (step.selector) {
    const std::optional<std::size_t> found =
        step.selector->within ? find_element(reader, field, count, *step.selector)
                              : find_text(start, type, *step.selector);
    first = found.value_or(count);
    last = std::min(count, first + 1);
  }
  if (first >= last) {
    return;
  }
  skip_elements(reader, field, first);
  if (level + 1 == path.steps.size()) {
    visit(reader, field, last - first);
    return;
  }
  for (std::size_t i = first; i < last; ++i) {
    walk_path(reader, path, *field.message, level + 1, visit);
    if (i + 1 < last) {
      skip_element(reader, field);
    }
  }
}

template <typename Visit>
void walk_path(std::span<const std::byte> message, const FieldPath& path, const Visit& visit) {
  with_reader(path.type->dialect, message,
              [&](const auto& reader) { walk_path(reader, path, *path.type, 0, visit); });
}

}  // namespace spikeloop::messages
