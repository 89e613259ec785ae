#include "spikeloop/messages/schema.hpp"

#include <algorithm>
#include <sstream>

#include "spikeloop/messages/recorded_type.hpp"

namespace spikeloop::messages {

Schema schema_of(Dialect dialect, std::string_view type) {
  const Catalog& catalog = Catalog::for_type(dialect, type);
  const std::string name = catalog.full_name(type);
  const std::string text = catalog.full_text(name);
  if (dialect == Dialect::ros1) {
    return {std::string(kRos1), name, std::string(kRos1Definition), text};
  }
  std::string in_ros2 = name;
  in_ros2.insert(name.find('/'), "/msg");
  return {std::string(kRos2), in_ros2, std::string(kRos2Definition), text};
}

std::string definition_for(const Schema& schema, const TypeLayout& type,
                           std::span<const std::byte> message) {
  const std::vector<std::string> missing = compare_message(message, type).missing;
  std::istringstream lines(schema.definition);
  std::string definition;
  bool in_first_part = true;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind;
    std::string name;
    words >> kind >> name;
    in_first_part &= !kind.starts_with("===");
    if (!in_first_part || kind.starts_with('#') ||
        std::ranges::find(missing, name) == missing.end()) {
      definition += line + '\n';
    }
  }
  return missing.empty() ? schema.definition : definition;
}

}  // namespace spikeloop::messages
