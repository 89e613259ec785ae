#include "../commands.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "../output.hpp"
#include "model.hpp"

namespace spikeloop::app::completion_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  source <(spikeloop completion bash)    in ~/.bashrc
  source <(spikeloop completion zsh)     in ~/.zshrc, after compinit

cmake --install installs the script for bash.)";

}  // namespace

void add(CLI::App& app, Action& action) {
  const auto shell = std::make_shared<std::string>();  // both have the same script
  CLI::App* command = app.add_subcommand("completion", "Print a shell script for completion (Tab)");
  command->add_option("SHELL", *shell, "Shell")->required()->check(CLI::IsMember({"bash", "zsh"}));
  command->footer(kFooter);
  command->callback([shell, &app, &action] {
    action = [&app] {
      put_result(completion::script(completion::read_commands(app)));
      return 0;
    };
  });
}

}  // namespace spikeloop::app::completion_command
