#include "spikeloop/core/registry.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "foreign_node.hpp"
#include "plugin_loader.hpp"
#include "shared_library.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/plugin.hpp"
#include "spikeloop/core/plugin_path.hpp"

namespace spikeloop {

struct Registry::Impl {
  std::vector<SharedLibrary> libraries;  // outlive the classes: destroyed last
  std::map<std::string, NodeClass, std::less<>> classes;
};

Registry::Registry() : impl_(std::make_unique<Impl>()) {}
Registry::~Registry() = default;

void Registry::add(NodeClass node_class) {
  const std::string name = node_class.description.name;
  if (!impl_->classes.emplace(name, std::move(node_class)).second) {
    throw ConfigurationError(
        with_code(Code::duplicate_name,
                  "there is already a node class '{}'; give the second one another name", name));
  }
}

const NodeClass& Registry::find(std::string_view name) const {
  const auto found = impl_->classes.find(name);
  if (found == impl_->classes.end()) {
    throw ConfigurationError(with_code(Code::unknown_class, "unknown node class '{}'{}", name,
                                       did_you_mean(name, names())));
  }
  return found->second;
}

bool Registry::contains(std::string_view name) const {
  return impl_->classes.find(name) != impl_->classes.end();
}

std::vector<std::string> Registry::names() const {
  std::vector<std::string> all;
  for (const auto& [name, node_class] : impl_->classes) {
    all.push_back(name);
  }
  return all;
}

std::vector<std::string> Registry::add_linked_plugins() {
  std::vector<std::string> added;
  for (const plugin::MakeClass make_class : plugin::linked_classes()) {
    NodeClass node_class = make_class();
    added.push_back(node_class.description.name);
    add(std::move(node_class));
  }
  return added;
}

std::vector<std::string> Registry::load_plugin(const std::string& path) {
  if (std::error_code unknown; std::filesystem::exists(path, unknown)) {
    require_regular_file(path, "plug-in");
  }
  if (has_loader(path)) {
    return add_classes(path, load_by_loader(path));
  }
  SharedLibrary library(path);
  auto added = add_classes(path, library.checked_plugin());
  impl_->libraries.push_back(std::move(library));
  return added;
}

std::vector<std::string> Registry::add_classes(const std::string& path,
                                               const spikeloop_plugin& plugin) {
  std::vector<NodeClass> loaded;
  for (std::uint64_t i = 0; i < plugin.class_count; ++i) {
    loaded.push_back(foreign_node_class(path, plugin.classes[i]));
  }
  std::vector<std::string> added;
  for (const NodeClass& node_class : loaded) {
    const std::string& name = node_class.description.name;
    if (contains(name) || std::ranges::find(added, name) != added.end()) {
      throw ConfigurationError(with_code(
          Code::duplicate_name,
          "plug-in '{}': there is already a node class '{}'; give it another name", path, name));
    }
    added.push_back(name);
  }
  for (NodeClass& node_class : loaded) {
    add(std::move(node_class));
  }
  return added;
}

std::vector<std::string> Registry::load_plugin_path(std::string_view directories) {
  std::vector<std::string> added;
  for (const std::string& directory : path_list(directories)) {
    std::error_code error;
    const std::vector<std::string> paths = plugin_files(directory, error);
    if (error) {
      throw FileError("read plug-in directory", directory, error.value());
    }
    for (const std::string& path : paths) {
      const auto names = load_plugin(path);
      added.insert(added.end(), names.begin(), names.end());
    }
  }
  return added;
}

}  // namespace spikeloop
