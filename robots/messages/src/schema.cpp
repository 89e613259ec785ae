#include "spikeloop/messages/schema.hpp"

#include "spikeloop/messages/catalog.hpp"

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

}  // namespace spikeloop::messages
