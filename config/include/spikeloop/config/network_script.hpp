// Networks from a Python function: `network: brain.py:make`. The function runs in a separate Python
// (/usr/bin/python3, or the one that $PYTHON names), which leaves a network file and weights in a
// folder that is gone when they have been read; no program links Python for it. For a function with
// arguments Python runs twice: first it leaves their declarations, then it gets their values.
#pragma once

#include <string>
#include <vector>

#include "spikeloop/config/network_file.hpp"
#include "spikeloop/core/parameters.hpp"

namespace spikeloop {

/// The file of "brain.py:make"; any other text as it is.
std::string network_source(const std::string& written);

/// Whether `written` is FILE.py or FILE.py:FUNCTION.
bool is_network_script(const std::string& written);

/// A Python function that makes a network. Its arguments are keys of the network's node or section.
/// What it prints goes to the error stream, its warnings to the log.
class NetworkScript {
 public:
  /// Loads the file; `make` where no function is named. One without arguments runs now.
  /// @throws FileError when there is no such file; TransportError without a Python;
  /// ConfigurationError with the file, the line and Python's traceback when it fails, and as
  /// parse_network.
  explicit NetworkScript(const std::string& written);

  /// Its arguments, declared as parameters of a script are (docs/python-nodes.md).
  const std::vector<ParameterDescription>& parameters() const { return parameters_; }

  /// The network that the function returns for the arguments among `values`. Call it once.
  /// @throws as the constructor
  NetworkFile network(const Parameters& values);

 private:
  void run(const std::string& values);

  std::string written_;
  std::vector<ParameterDescription> parameters_;
  NetworkFile network_;
};

}  // namespace spikeloop
