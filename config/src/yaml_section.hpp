// A YAML map read key by key, with the place of everything for error messages.
#pragma once

#include <yaml-cpp/yaml.h>

#include <map>
#include <string>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/error_handler.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop::yaml_text {

/// The only document of a text. `what` is what a file holds one of.
/// @throws ConfigurationError at the place where it is not YAML, or a second document begins.
YAML::Node load(const std::string& text, const std::string& path, const std::string& what);

/// The place of a YAML node; yaml-cpp counts lines and columns from 0.
Location place(const std::string& file, const YAML::Node& node);

/// Where the text of a plain value begins: behind its quote, if it has one.
Location text_place(const std::string& file, const YAML::Node& node);

/// Text of a plain value.
/// @throws ConfigurationError when it is a list, a map or empty.
std::string scalar(const std::string& file, const std::string& key, const YAML::Node& node);

/// A map whose keys are known beforehand, or free names (`known` empty).
class Section {
 public:
  /// @throws ConfigurationError: not a map, a key twice, a key that is not known (did you mean).
  Section(std::string file, std::string what, const YAML::Node& node,
          const std::vector<std::string>& known);
  /// Tells of keys that are not known or stand there twice, and leaves them out.
  /// @throws ConfigurationError: not a map, a key that is not a plain value.
  Section(std::string file, std::string what, const YAML::Node& node,
          const std::vector<std::string>& known, const ErrorHandler& report);

  bool has(const std::string& key) const { return entries_.count(key) != 0; }
  /// @throws ConfigurationError when the key is missing; `example` says what to write.
  const YAML::Node& at(const std::string& key, const std::string& example) const;
  std::string text(const std::string& key, const std::string& example) const;
  /// The value in `unit`, with the place in the message when it is none.
  double quantity(const std::string& key, const std::string& unit,
                  const std::string& example) const;
  /// A whole number of nanoseconds, written in ms or with a unit.
  TimeNs time(const std::string& key, const std::string& example) const;

  Location where() const { return where_; }
  Location where(const std::string& key) const;
  /// Where the key itself stands, not its value.
  Location where_name(const std::string& key) const { return key_places_.at(key); }
  const std::string& what() const { return what_; }
  const std::string& file() const { return file_; }
  /// In the file's order.
  const std::vector<std::string>& keys() const { return keys_; }

 private:
  std::string file_;
  std::string what_;
  Location where_;
  std::vector<std::string> keys_;
  std::map<std::string, YAML::Node> entries_;
  std::map<std::string, Location> key_places_;
};

/// The keys of a section as declared parameters. @throws ConfigurationError as resolve().
Parameters resolve_section(const Section& section,
                           const std::vector<ParameterDescription>& declared);

}  // namespace spikeloop::yaml_text
