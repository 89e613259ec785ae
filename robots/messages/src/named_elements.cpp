#include "named_elements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::messages {
namespace {

/// Where texts are that choose elements: the fields and elements that lead there.
using TextPlace = std::vector<std::size_t>;

struct NamedGroup {
  std::vector<std::string> texts;
  std::vector<NamedText> written;
};

/// An array that is to be as long as the texts beside it.
struct ArrayBeside {
  FieldPath* path;
  std::size_t level;
  const NamedGroup* group;
};

/// The path to the message that holds the array of a level.
TextPlace place_above(const FieldPath& path, std::size_t level) {
  TextPlace place;
  for (std::size_t i = 0; i < level; ++i) {
    place.insert(place.end(), {path.steps[i].field, path.steps[i].first, path.steps[i].last});
  }
  return place;
}

TextPlace place_of(const FieldPath& path, std::size_t level, const Selector& selector) {
  TextPlace place = place_above(path, level);
  if (selector.within) {
    place.push_back(path.steps[level].field);
  }
  place.push_back(selector.key);
  return place;
}

FieldPath path_of_text(const FieldPath& path, std::size_t level, const Selector& selector,
                       std::size_t element) {
  FieldPath text{path.text, path.type, {}, FieldPath::TimePart::whole};
  text.steps.assign(path.steps.begin(), path.steps.begin() + static_cast<std::ptrdiff_t>(level));
  if (selector.within) {
    text.steps.push_back({.field = path.steps[level].field, .first = element, .last = element + 1});
    text.steps.push_back({.field = selector.key, .first = 0, .last = 1});
  } else {
    text.steps.push_back({.field = selector.key, .first = element, .last = element + 1});
  }
  return text;
}

/// The element's place; a text that is new gets the next one.
std::size_t place_element(NamedGroup& group, const FieldPath& path, std::size_t level,
                          const Selector& selector) {
  const auto found = std::ranges::find(group.texts, selector.text);
  const auto element = static_cast<std::size_t>(found - group.texts.begin());
  const FieldLayout& field = path.field(level);
  if (field.count != 0 && element >= field.count) {
    throw ConfigurationError(
        with_code(Code::field_path,
                  "field path '{}' of {}: '{}' has {} elements, and so many have names already",
                  path.text, path.type->name, field.name, field.count));
  }
  if (found == group.texts.end()) {
    group.texts.push_back(selector.text);
    group.written.push_back({path_of_text(path, level, selector, element), selector.text});
  }
  return element;
}

/// Calls `use` with the place and the step of every array of numbers of which the path names
/// elements.
template <typename Use>
void for_each_parallel_array(std::vector<FieldPath>& paths, Use&& use) {
  for (FieldPath& path : paths) {
    bool parallel = has_parallel_arrays(*path.type);
    for (std::size_t level = 0; level < path.steps.size(); ++level) {
      const FieldLayout& field = path.field(level);
      PathStep& step = path.steps[level];
      const bool is_float =
          field.primitive == Primitive::float32 || field.primitive == Primitive::float64;
      if (parallel && is_float && field.array == ArrayKind::variable &&
          step.last != PathStep::kEnd) {
        use(place_above(path, level), step);
      }
      parallel = parallel || (field.message && has_parallel_arrays(*field.message));
    }
  }
}

}  // namespace

bool has_parallel_arrays(const TypeLayout& type) {
  return type.name == "std_msgs/Float32MultiArray" || type.name == "std_msgs/Float64MultiArray" ||
         std::ranges::any_of(type.fields, [](const FieldLayout& field) {
           return field.primitive == Primitive::text && field.array == ArrayKind::variable;
         });
}

void align_parallel_arrays(std::vector<FieldPath>& paths) {
  std::map<TextPlace, std::size_t> lengths;
  for_each_parallel_array(paths, [&](const TextPlace& place, const PathStep& step) {
    lengths[place] = std::max({lengths[place], step.last, step.least_length});
  });
  for_each_parallel_array(
      paths, [&](const TextPlace& place, PathStep& step) { step.least_length = lengths[place]; });
}

std::vector<NamedText> place_named_elements(std::vector<FieldPath>& paths) {
  std::map<TextPlace, NamedGroup> groups;
  std::vector<ArrayBeside> beside;
  for (FieldPath& path : paths) {
    for (std::size_t level = 0; level < path.steps.size(); ++level) {
      PathStep& step = path.steps[level];
      if (!step.selector) {
        continue;
      }
      const Selector selector = *std::exchange(step.selector, std::nullopt);
      NamedGroup& group = groups[place_of(path, level, selector)];
      step.first = place_element(group, path, level, selector);
      step.last = step.first + 1;
      if (!selector.within) {
        beside.push_back({&path, level, &group});
      }
    }
  }
  for (const ArrayBeside& array : beside) {
    array.path->steps[array.level].least_length = array.group->texts.size();
  }
  std::vector<NamedText> texts;
  for (auto& [place, group] : groups) {
    std::ranges::move(group.written, std::back_inserter(texts));
  }
  return texts;
}

}  // namespace spikeloop::messages
