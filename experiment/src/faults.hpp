// Faults are collected, so that one check tells all of them.
#pragma once

#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/experiment/experiment.hpp"

namespace spikeloop::experiment {

class Faults {
 public:
  explicit Faults(std::vector<Fault>& list) : list_(list) {}

  void add(const Error& error) { list_.push_back({error.what(), error.where(), error.exit_code()}); }
  void add(const Location& where, const std::string& message) {
    add(ConfigurationError(where, message));
  }
  /// Whether `work` did not throw; errors without a place get this one.
  template <typename Work>
  bool attempt(const Location& where, Work&& work) {
    try {
      located_at(where, [&] { return work(), 0; });
      return true;
    } catch (const Error& error) {
      add(error);
      return false;
    }
  }
  bool none() const { return list_.empty(); }

 private:
  std::vector<Fault>& list_;
};

/// A node's class, keys and files. False when it cannot take part in further checks.
bool resolve_part(const ExperimentNode& node, const Kinds& kinds, const std::string& directory,
                  Experiment& experiment, Faults& faults);
/// Widths along every connection; makes every node once.
void resolve_links(const ExperimentFile& file, Experiment& experiment, Faults& faults);

/// Keys whose declaration has a unit are written with it.
/// @throws ConfigurationError for the first number without one, an unknown or a missing key.
Parameters resolve_keys(const std::vector<ParameterDescription>& declared,
                        const WrittenValues& written, const WeightLoader& load_weights,
                        const std::string& what, const Location& where);

}  // namespace spikeloop::experiment
