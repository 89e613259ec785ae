#include "../commands.hpp"

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <string>

#include "../output.hpp"
#include "model.hpp"

namespace spikeloop::app::completion_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  source <(spikeloop completion bash)             in ~/.bashrc; in ~/.zshrc with zsh
  spikeloop completion fish | source              in ~/.config/fish/config.fish

cmake --install puts the scripts where the shells find them by themselves.)";

using Script = std::string (*)(const std::vector<completion::Command>&);

Script script_for(const std::string& shell) {
  const std::map<std::string, Script> scripts{{"bash", completion::bash_script},
                                              {"zsh", completion::zsh_script},
                                              {"fish", completion::fish_script}};
  return scripts.at(shell);
}

}  // namespace

void add(CLI::App& app, Action& action) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("completion", "Print a script for your shell's completion (Tab)");
  command->add_option("SHELL", *shell, "Your shell")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->footer(kFooter);
  command->callback([shell, &app, &action] {
    action = [shell, &app] {
      put_result(script_for(*shell)(completion::read_commands(app)));
      return 0;
    };
  });
}

}  // namespace spikeloop::app::completion_command
