// *.py files of a test, and the classes in them.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "harness.hpp"
#include "spikeloop/core/log.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::testing {

/// The loader is not beside the test's program.
inline void use_python_library() {
  setenv("SPIKELOOP_LIBRARY_PATH", PYTHON_NODES_LIBRARY, 1);
}

/// The class of that name in a file.
inline NodeClass class_in(const std::string& path, const std::string& name) {
  use_python_library();
  Registry registry;
  registry.load_plugin(path);
  return registry.find(name);
}

/// A directory with one file, nodes.py. What it logs is kept.
class PythonFile {
 public:
  explicit PythonFile(const std::string& text)
      : path_(directory_.write("nodes.py", "import numpy as np\nimport spikeloop\n" + text)) {
    log::set_sink([this](log::Level, std::string_view line) { lines.emplace_back(line); });
  }
  ~PythonFile() { log::set_sink({}); }
  PythonFile(const PythonFile&) = delete;
  PythonFile& operator=(const PythonFile&) = delete;

  const std::string& path() const { return path_; }
  NodeClass node_class(const std::string& name = "it") const { return class_in(path_, name); }
  /// What loading it ends with, without the directory.
  std::string refusal() const {
    return without_directory(message_of([&] { node_class(); }));
  }
  std::string without_directory(std::string text) const {
    const std::string directory = directory_.path().string() + "/";
    for (auto at = text.find(directory); at != std::string::npos; at = text.find(directory)) {
      text.erase(at, directory.size());
    }
    // The core adds it where the message does not name the file: registry_test has that.
    constexpr std::string_view kWhose = " (plug-in 'nodes.py')";
    return text.ends_with(kWhose) ? text.substr(0, text.size() - kWhose.size()) : text;
  }

  std::vector<std::string> lines;

 private:
  test::TemporaryDirectory directory_;
  std::string path_;
};

/// A class `It` with a signal and spikes in and out, each two wide; `body` has its methods.
inline std::string class_with(const std::string& body) {
  return "@spikeloop.node\n"
         "class It:\n"
         "    inputs = {'in': spikeloop.Signal(width=2), 'cells': spikeloop.Spikes(width=2)}\n"
         "    outputs = {'out': spikeloop.Signal(width=2), 'spikes': spikeloop.Spikes(width=2)}\n" +
         body;
}
inline const std::vector<std::uint32_t> kTwo = {2, 2, 2, 2};

}  // namespace spikeloop::testing
