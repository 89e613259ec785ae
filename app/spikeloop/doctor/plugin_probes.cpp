// Plug-ins in SPIKELOOP_PLUGIN_PATH, libraries and Python files alike. Every node program loads all
// of them, and one that is refused ends it: so they are needed.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <memory>
#include <sstream>

#include "self.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/plugin_path.hpp"
#include "spikeloop/core/registry.hpp"
#include "spikeloop/nodes/register.hpp"

namespace spikeloop::app::doctor {
namespace {

/// A library is built, a file of another kind is written.
const char* remedy_for(const std::string& path) {
  return path.ends_with(".so")
             ? "rebuild it with this Spikeloop (docs/plugins.md), or take it out of "
               "SPIKELOOP_PLUGIN_PATH"
             : "correct it (docs/python-nodes.md), or take it out of SPIKELOOP_PLUGIN_PATH";
}

/// Which plug-in has given a class its name; filled while findings are judged, in order.
using Owners = std::map<std::string, std::string>;

Finding without_clash(Finding finding, const std::string& path, Owners& owners) {
  if (finding.status != Status::ok) {
    return finding;
  }
  std::istringstream names(finding.text);
  for (std::string name; names >> name;) {
    const auto [owner, is_new] = owners.emplace(name, path);
    if (!is_new) {
      return missing(fmt::format("there is already a node class '{}', of {}", name, owner->second),
                     "give it another name, or take one of the two out of SPIKELOOP_PLUGIN_PATH");
    }
  }
  return ok(fmt::format("node={}", finding.text));
}

Probe plugin_probe(const std::string& path, const std::shared_ptr<Owners>& owners) {
  Probe probe = child_probe(path, true, {"plugin", path}, [path](const std::string& failure) {
    return missing(fmt::format("cannot be loaded: {}", failure), remedy_for(path));
  });
  probe.judge = [judge = std::move(probe.judge), path, owners](const auto& answers) {
    return without_clash(judge(answers), path, *owners);
  };
  return probe;
}

Probe directory_probe(const std::string& directory, std::size_t plugins, std::error_code error) {
  return fact(directory, true, [=] {
    return error ? missing(fmt::format("cannot be read: {}", error.message()),
                           "make the directory, or take it out of SPIKELOOP_PLUGIN_PATH")
                 : ok(fmt::format("{} plug-in{}", plugins == 0 ? "no" : std::to_string(plugins),
                                  plugins == 1 ? "" : "s"));
  });
}

std::vector<Probe> directory_probes(const std::string& directory,
                                    const std::shared_ptr<Owners>& owners) {
  std::error_code error;
  std::vector<std::string> paths;
  try {
    paths = plugin_files(directory, error);
  } catch (const Error& fault) {  // nobody can say whether a *.py file is a plug-in
    return {fact(directory, true, [text = std::string(fault.what())] {
      return missing(text, "install Spikeloop with Python's node library");
    })};
  }
  std::vector<Probe> probes{directory_probe(directory, paths.size(), error)};
  for (const std::string& path : paths) {
    probes.push_back(plugin_probe(path, owners));
  }
  return probes;
}

}  // namespace

Finding look_at_plugin(const std::string& path) {
  Registry registry;
  register_nodes(registry);
  try {
    return ok(fmt::format("{}", fmt::join(registry.load_plugin(path), " ")));
  } catch (const Error& error) {
    std::string_view reason = error.what();
    const std::string prefix = fmt::format("plug-in '{}': ", path);
    if (reason.starts_with(prefix)) {  // the path is the item's name
      reason.remove_prefix(prefix.size());
    }
    return missing(std::string(reason), remedy_for(path));
  }
}

std::vector<Probe> plugin_probes() {
  const auto owners = std::make_shared<Owners>();
  std::vector<Probe> probes;
  for (const std::string& directory : path_list(plugin_path())) {
    for (Probe& probe : directory_probes(directory, owners)) {
      probes.push_back(std::move(probe));
    }
  }
  if (probes.empty()) {
    probes.push_back(
        fact("plug-ins", false, [] { return ok("SPIKELOOP_PLUGIN_PATH is not set"); }));
  }
  return probes;
}

}  // namespace spikeloop::app::doctor
