#include "commands.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <sstream>

#include "explanations.hpp"
#include "output.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::app::explain_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop explain                lists all codes
  spikeloop explain SL0103         explains the error, with an example
  spikeloop explain --markdown     the page docs/errors.md)";

std::string example(const Explanation& each) {
  return *each.wrong == '\0'
             ? ""
             : fmt::format("\nWrong:\n\n    {}\n\nRight:\n\n    {}\n", each.wrong, each.right);
}

/// Lines of at most 80 columns.
std::string wrapped(std::string_view text) {
  std::istringstream words{std::string(text)};
  std::string lines;
  std::size_t column = 0;
  for (std::string word; words >> word; column += word.size() + 1) {
    if (column + word.size() > 80) {
      lines += "\n";
      column = 0;
    } else if (column > 0) {
      lines += " ";
    }
    lines += word;
  }
  return lines;
}

/// Without its heading.
std::string body(const Explanation& each) {
  return fmt::format("{}\n{}", wrapped(each.text), example(each));
}

std::string list() {
  std::string text;
  for (const Explanation& each : explanations()) {
    text += fmt::format("{}  {}\n", code_text(each.code), each.title);
  }
  return text;
}

std::string page() {
  std::string text =
      "# Errors\n\n"
      "Errors about files, connections, topics and runs end with a code. This page lists all of "
      "them.\n\n"
      "    spikeloop explain SL0103         prints one\n"
      "    spikeloop explain --markdown     prints this page\n\n"
      "Mistakes on a command line have no code; see `--help`.\n\n"
      "`spikeloop run` ends with the exit code\n\n"
      "| code | meaning |\n"
      "|---|---|\n"
      "| 0 | finished |\n"
      "| 2 | the file or an option is invalid |\n"
      "| 3 | a program, the robot or the ROS master is missing, stalls or ends too early |\n"
      "| 4 | a file cannot be read or written |\n"
      "| 5 | a node failed |\n"
      "| 7 | messages arrived, and none of them was usable |\n"
      "| 128 + N | stopped by signal N, or a program was killed by it: 130 is Ctrl-C |\n"
      "| other | exit code of the first program that failed |\n";
  for (const Explanation& each : explanations()) {
    text += fmt::format("\n## {}: {}\n\n{}", code_text(each.code), each.title, body(each));
  }
  return text;
}

int explain(const std::string& code, bool markdown) {
  if (markdown || code.empty()) {
    put_result(markdown ? page() : list());
    return 0;
  }
  const Explanation* found = find_explanation(code);
  if (found == nullptr) {
    throw ConfigurationError(
        fmt::format("unknown code '{}'; write one that 'spikeloop explain' lists", code));
  }
  put_result(fmt::format("{}: {}\n\n{}", code_text(found->code), found->title, body(*found)));
  return 0;
}

}  // namespace

void add(CLI::App& app, Action& action) {
  struct Arguments {
    std::string code;
    bool markdown = false;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("explain", "Explain the code of an error");
  auto* code = command->add_option("CODE", arguments->code,
                                   "Code of an error, such as SL0103; not given: all codes");
  command->add_flag("--markdown", arguments->markdown, "Print the page of all codes")
      ->excludes(code);
  command->footer(kFooter);
  command->callback([arguments, &action] {
    action = [arguments] { return explain(arguments->code, arguments->markdown); };
  });
}

}  // namespace spikeloop::app::explain_command
