#include "model.hpp"

#include <algorithm>
#include <array>
#include <sstream>

namespace spikeloop::app::completion {
namespace {

/// Arguments are known by their names in the help.
struct Named {
  const char* name;
  Kind kind;
};
constexpr std::array kArguments{Named{"FILE", Kind::input}, Named{"RUN", Kind::path},
                                Named{"NODE", Kind::node_class}, Named{"ENCODER", Kind::node_class},
                                Named{"KEY=VALUE", Kind::none}};

/// CLI11 writes a list of choices as "TEXT:{bash,zsh}".
std::vector<std::string> choices_in(const std::string& type) {
  const auto begin = type.find('{');
  const auto end = type.find('}');
  std::vector<std::string> choices;
  if (begin == std::string::npos || end == std::string::npos) {
    return choices;
  }
  std::istringstream text(type.substr(begin + 1, end - begin - 1));
  for (std::string choice; std::getline(text, choice, ',');) {
    choices.push_back(choice);
  }
  return choices;
}

/// Text that is neither an argument of the list above nor a choice is a file's name in most cases.
Value value_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (auto choices = choices_in(type); !choices.empty()) {
    return {Kind::choice, std::move(choices)};
  }
  const auto* const known = std::ranges::find(kArguments, option.get_name(true), &Named::name);
  if (option.get_positional() && known != kArguments.end()) {
    return {known->kind};
  }
  return {type.starts_with("TEXT") ? Kind::path : Kind::none};
}

Option option_of(const CLI::Option& option) {
  Option result;
  for (const std::string& name : option.get_snames()) {
    result.names.push_back("-" + name);
  }
  for (const std::string& name : option.get_lnames()) {
    result.names.push_back("--" + name);
  }
  result.takes_value = option.get_items_expected_max() > 0;
  if (result.takes_value) {
    result.value = value_of(option);
  }
  return result;
}

Command command_of(const CLI::App& app, const std::string& name) {
  Command command{name};
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) {
      continue;
    }
    if (option->get_positional()) {
      command.places.push_back(value_of(*option));
    } else {
      command.options.push_back(option_of(*option));
    }
  }
  return command;
}

}  // namespace

std::vector<Command> read_commands(const CLI::App& app) {
  std::vector<Command> commands{command_of(app, "")};
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!command->get_group().empty()) {
      commands.push_back(command_of(*command, command->get_name()));
    }
  }
  return commands;
}

}  // namespace spikeloop::app::completion
