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
  std::string name;                    ///< "FILE", "TIME"
  std::vector<std::string> choices{};  ///< of Kind::choice
};

struct Option {
  std::vector<std::string> names;  ///< "-q", "--quiet"
  std::string text;
  bool takes_value = false;
  Value value{};
};

struct Command {
  std::string name;  ///< empty: the program itself
  std::string text;
  std::vector<Option> options{};
  std::vector<Value> places{};  ///< its arguments in order
};

/// The program itself, then its commands. What help does not show is left out.
std::vector<Command> read_commands(const CLI::App& app);

// The scripts.
std::string bash_script(const std::vector<Command>& commands);
std::string zsh_script(const std::vector<Command>& commands);
std::string fish_script(const std::vector<Command>& commands);

/// In single quotes, for bash and zsh.
std::string in_quotes(std::string_view text);

}  // namespace spikeloop::app::completion
