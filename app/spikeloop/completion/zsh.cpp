#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model.hpp"

namespace spikeloop::app::completion {
namespace {

/// Inside of [...] and between ':' of a specification of _arguments.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char letter : text) {
    const bool special = letter == '[' || letter == ']' || letter == ':' || letter == '\\';
    result += special ? std::string{'\\', letter} : std::string(1, letter);
  }
  return result;
}

std::string action_of(const Value& value) {
  switch (value.kind) {
    case Kind::path:
      return "_files";
    case Kind::input:
      return fmt::format("_files -g \"*.({})\"", fmt::join(kInputEndings, "|"));
    case Kind::node_class:
      return "_spikeloop_nodes";
    case Kind::choice:
      return fmt::format("({})", fmt::join(value.choices, " "));
    default:
      return " ";
  }
}

std::string specification(const std::string& name, const Option& option) {
  const bool is_long = name.starts_with("--");
  return option.takes_value
             ? fmt::format("{}{}[{}]:{}:{}", name, is_long ? "=" : "+", escaped(option.text),
                           escaped(option.value.name), action_of(option.value))
             : fmt::format("{}[{}]", name, escaped(option.text));
}

std::string option_lines(const Command& command, const char* indent) {
  std::string text;
  for (const Option& option : command.options) {
    for (const std::string& name : option.names) {
      text += fmt::format(" \\\n{}{}", indent, in_quotes(specification(name, option)));
    }
  }
  return text;
}

std::string branch(const Command& command) {
  std::string text = fmt::format("        {})\n          _arguments", command.name);
  text += option_lines(command, "            ");
  for (std::size_t i = 0; i < command.places.size(); ++i) {
    text += fmt::format(" \\\n            {}",
                        in_quotes(fmt::format("{}:{}:{}", i + 1, escaped(command.places[i].name),
                                              action_of(command.places[i]))));
  }
  return text + "\n          ;;\n";
}

}  // namespace

std::string zsh_script(const std::vector<Command>& commands) {
  std::string names;
  std::string branches;
  for (const Command& command : commands) {
    if (!command.name.empty()) {
      names += fmt::format("        {}\n", in_quotes(command.name + ":" + escaped(command.text)));
      branches += branch(command);
    }
  }
  return fmt::format(
      R"zsh(#compdef spikeloop
# zsh completion for spikeloop, printed by: spikeloop completion zsh
# Try it with: source <(spikeloop completion zsh)

_spikeloop_nodes() {{
  local -a nodes
  nodes=(${{(f)"$(spikeloop describe --names 2>/dev/null)"}})
  compadd -a nodes
}}

_spikeloop() {{
  local curcontext="$curcontext" state
  local -a line commands
  _arguments -C{} \
    '1:command:->command' \
    '*::argument:->argument'
  case $state in
    command)
      commands=(
{}      )
      _describe command commands
      ;;
    argument)
      case $line[1] in
{}      esac
      ;;
  esac
}}

if [ "$funcstack[1]" = "_spikeloop" ]; then
  _spikeloop "$@"
else
  compdef _spikeloop spikeloop
fi
)zsh",
      option_lines(commands.front(), "    "), names, branches);
}

}  // namespace spikeloop::app::completion
