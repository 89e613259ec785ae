// What a shell can complete, read off the program's own commands and options.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace spikeloop::app::completion {

/// What stands in the place of a value.
enum class Kind {
  none,        ///< a number, a time: there is nothing to suggest
  path,        ///< any file or folder
  input,       ///< a file that commands read: kInputEndings
  node_class,  ///< what `spikeloop describe --names` prints
  choice       ///< one of `choices`
};

inline constexpr const char* kInputEndings[] = {"music", "yaml", "yml"};

struct Value {
  Kind kind = Kind::none;
  std::vector<std::string> choices{};  ///< of Kind::choice
};

struct Option {
  std::vector<std::string> names;  ///< "-q", "--quiet"
  bool takes_value = false;
  Value value{};
};

struct Command {
  std::string name;  ///< empty: the program itself
  std::vector<Option> options{};
  std::vector<Value> places{};  ///< its arguments in order
};

/// The program itself, then its commands. What help does not show is left out.
std::vector<Command> read_commands(const CLI::App& app);

/// A script for bash, and for zsh, which has a module for those of bash.
std::string script(const std::vector<Command>& commands);

}  // namespace spikeloop::app::completion
