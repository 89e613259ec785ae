#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model.hpp"

namespace spikeloop::app::completion {
namespace {

std::string in_quotes(std::string_view text) {
  std::string result = "'";
  for (const char letter : text) {
    result += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  }
  return result + "'";
}

/// What a value is, in a word that the script's last function knows.
std::string word_of(const Value& value) {
  switch (value.kind) {
    case Kind::path:
      return "path";
    case Kind::input:
      return "input";
    case Kind::node_class:
      return "node";
    case Kind::choice:
      return fmt::format("choice {}", fmt::join(value.choices, " "));
    default:
      return "none";
  }
}

std::string option_lines(const std::vector<Command>& commands) {
  std::string text;
  for (const Command& command : commands) {
    std::vector<std::string> names;
    for (const Option& option : command.options) {
      names.insert(names.end(), option.names.begin(), option.names.end());
    }
    text += fmt::format("    {}) echo {} ;;\n", in_quotes(command.name),
                        in_quotes(fmt::format("{}", fmt::join(names, " "))));
  }
  return text;
}

std::string value_lines(const std::vector<Command>& commands) {
  std::string text;
  for (const Command& command : commands) {
    for (const Option& option : command.options) {
      for (const std::string& name : option.names) {
        text += option.takes_value
                    ? fmt::format("    {}) echo {} ;;\n", in_quotes(command.name + " " + name),
                                  in_quotes(word_of(option.value)))
                    : "";
      }
    }
  }
  return text;
}

std::string place_lines(const std::vector<Command>& commands) {
  std::string text;
  for (const Command& command : commands) {
    for (std::size_t i = 0; i < command.places.size(); ++i) {
      text += fmt::format("    {}) echo {} ;;\n", in_quotes(fmt::format("{} {}", command.name, i)),
                          in_quotes(word_of(command.places[i])));
    }
  }
  return text;
}

std::string command_names(const std::vector<Command>& commands) {
  std::vector<std::string> names;
  for (const Command& command : commands) {
    if (!command.name.empty()) {
      names.push_back(command.name);
    }
  }
  return fmt::format("{}", fmt::join(names, " "));
}

std::string input_lines() {
  std::string text;
  for (const char* ending : kInputEndings) {
    text += fmt::format("      compgen -f -X '!*.{}' -- \"$cur\"\n", ending);
  }
  return text;
}

constexpr const char* kHead =
    R"bash(# Completion for spikeloop in bash and zsh, printed by: spikeloop completion bash
# Try it with: source <(spikeloop completion bash)
[[ -z ${ZSH_VERSION:-} ]] || { autoload -U +X bashcompinit && bashcompinit; }
)bash";

/// Walks over the words before the cursor. bash cuts --out=x into "--out", "=" and "x".
constexpr const char* kWalk = R"bash(
_spikeloop() {
  local cur=${COMP_WORDS[COMP_CWORD]} command= option= word kind i
  local -i place=0
  for ((i = 1; i < COMP_CWORD; ++i)); do
    word=${COMP_WORDS[i]}
    if [[ $word == = ]]; then
      continue
    elif [[ -n $option ]]; then
      option=
    elif [[ $word == -* ]]; then
      [[ -z $(_spikeloop_value "$command $word") ]] || option=$word
    elif [[ -z $command ]]; then
      command=$word
    else
      place+=1
    fi
  done
  [[ $cur != = ]] || cur=
  if [[ -n $option ]]; then
    kind=$(_spikeloop_value "$command $option")
  elif [[ $cur == -* ]]; then
    kind="choice $(_spikeloop_options "$command")"
  elif [[ -z $command ]]; then
    kind="choice $(_spikeloop_commands)"
  else
    kind=$(_spikeloop_place "$command $place")
  fi
  COMPREPLY=()
  while IFS= read -r word; do
    COMPREPLY+=("$word")
  done < <(_spikeloop_suggest "$kind" "$cur" | sort -u)
  [[ $kind != path && $kind != input ]] || compopt -o filenames 2>/dev/null || true
}
complete -F _spikeloop spikeloop
)bash";

std::string function(const char* name, const std::string& lines) {
  return fmt::format("\n{}() {{\n  case \"$1\" in\n{}  esac\n}}\n", name, lines);
}

std::string suggest_function() {
  return fmt::format(
      "\n_spikeloop_suggest() {{\n"
      "  local cur=$2\n"
      "  case \"$1\" in\n"
      "    path) compgen -f -- \"$cur\" ;;\n"
      "    input)\n"
      "{}"
      "      compgen -d -- \"$cur\"\n"
      "      ;;\n"
      "    node) compgen -W \"$(\"${{COMP_WORDS[0]}}\" describe --names 2>/dev/null)\" -- \"$cur\" "
      ";;\n"
      "    choice*) compgen -W \"${{1#choice}}\" -- \"$cur\" ;;\n"
      "  esac\n"
      "}}\n",
      input_lines());
}

}  // namespace

std::string script(const std::vector<Command>& commands) {
  return kHead +
         fmt::format("\n_spikeloop_commands() {{\n  echo {}\n}}\n",
                     in_quotes(command_names(commands))) +
         "\n# The options of a command" + function("_spikeloop_options", option_lines(commands)) +
         "\n# What the value of a command's option is; nothing for a flag" +
         function("_spikeloop_value", value_lines(commands)) +
         "\n# What a command's argument is, counted from 0" +
         function("_spikeloop_place", place_lines(commands)) + suggest_function() + kWalk;
}

}  // namespace spikeloop::app::completion
