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

TextPlace place_of(const FieldPath& path, std::size_t level, const Selector& selector) {
  TextPlace place;
  for (std::size_t i = 0; i < level; ++i) {
    place.insert(place.end(), {path.steps[i].field, path.steps[i].first, path.steps[i].last});
  }
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

}  // namespace

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
