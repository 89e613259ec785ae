#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model.hpp"

namespace spikeloop::app::completion {
namespace {

/// fish escapes a quote and a backslash inside of quotes, and nothing else.
std::string fish_quotes(std::string_view text) {
  std::string result = "'";
  for (const char letter : text) {
    result += letter == '\'' || letter == '\\' ? std::string{'\\', letter} : std::string(1, letter);
  }
  return result + "'";
}

/// -x: a value and no files; -r -F: a value, and files.
std::string value_text(const Value& value) {
  switch (value.kind) {
    case Kind::path:
      return "-r -F";
    case Kind::input: {
      std::string words;
      for (const char* ending : kInputEndings) {
        words += fmt::format("{}(__spikeloop_files .{})", words.empty() ? "" : " ", ending);
      }
      return "-x -a " + fish_quotes(words);
    }
    case Kind::node_class:
      return "-x -a '(spikeloop describe --names 2>/dev/null)'";
    case Kind::choice:
      return "-x -a " + fish_quotes(fmt::format("{}", fmt::join(value.choices, " ")));
    default:
      return "-x";
  }
}

std::string condition(const Command& command) {
  return command.name.empty() ? "__fish_use_subcommand"
                              : "__fish_seen_subcommand_from " + command.name;
}

std::string option_line(const Command& command, const Option& option) {
  std::string text = fmt::format("complete -c spikeloop -n {}", fish_quotes(condition(command)));
  for (const std::string& name : option.names) {
    text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  }
  return fmt::format("{}{} -d {}\n", text, option.takes_value ? " " + value_text(option.value) : "",
                     fish_quotes(option.text));
}

std::string lines_of(const Command& command) {
  std::string text;
  if (!command.name.empty()) {
    text += fmt::format("\ncomplete -c spikeloop -n __fish_use_subcommand -a {} -d {}\n",
                        command.name, fish_quotes(command.text));
  }
  for (const Option& option : command.options) {
    text += option_line(command, option);
  }
  if (!command.places.empty() && command.places.front().kind != Kind::none) {
    text += fmt::format("complete -c spikeloop -n {} {}\n", fish_quotes(condition(command)),
                        value_text(command.places.front()));
  }
  return text;
}

}  // namespace

std::string fish_script(const std::vector<Command>& commands) {
  std::string text =
      "# fish completion for spikeloop, printed by: spikeloop completion fish\n"
      "# Try it with: spikeloop completion fish | source\n"
      "\n"
      "# Files of one ending, and folders\n"
      "function __spikeloop_files\n"
      "  __fish_complete_path (commandline -ct) | string match -r "
      "\"^(?:.*/|.*\\\\$argv[1])(?:\\t.*)?\\$\"\n"
      "end\n"
      "\n"
      "complete -c spikeloop -f\n";
  for (const Command& command : commands) {
    text += lines_of(command);
  }
  return text;
}

}  // namespace spikeloop::app::completion
