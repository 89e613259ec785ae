// Random contents of messages of any type: for two serializers to agree on.
#pragma once

#include <random>
#include <string>
#include <utility>
#include <vector>

#include "reference_messages.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::test {

struct Content {
  /// Everything in the order of the message: numbers of elements, numbers, texts. What a serializer
  /// needs that knows the type; a time is two numbers.
  std::vector<reference::Atom> atoms;
  /// The same by field paths. Arrays of numbers have one path; other elements one each.
  std::vector<std::pair<std::string, std::vector<double>>> numbers;
  std::vector<std::pair<std::string, std::string>> texts;
};

/// Values from all of each type's range, but whole numbers that a double can hold.
Content random_content(const messages::TypeLayout& type, unsigned seed);

}  // namespace spikeloop::test
