#include "commands.hpp"

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>
#include <vector>

#include "option_values.hpp"
#include "output.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "templates.hpp"

namespace spikeloop::app::new_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop new > explorer.yaml && spikeloop run explorer.yaml
  spikeloop new maze > maze.yaml         the same with another name
  spikeloop new --environment mountain_car > car.yaml    one that learns by reward
  spikeloop new --environment cart_pole > pole.yaml      a fixed rule, for a network of your own)";

constexpr const char* kExplorer = "explorer";

const Template& template_of(const std::string& environment) {
  std::vector<std::string> known;
  for (const Template& candidate : templates()) {
    if (candidate.name == environment) {
      return candidate;
    }
    if (candidate.name != kExplorer) {
      known.emplace_back(candidate.name);
    }
  }
  throw ConfigurationError(with_code(
      Code::unknown_choice, "there is no example for the environment '{}'; write one of: {}",
      environment, fmt::join(known, ", ")));
}

std::string named(std::string text, const std::string& name) {
  constexpr std::string_view kPlace = "NAME";
  for (auto at = text.find(kPlace); at != std::string::npos; at = text.find(kPlace, at)) {
    text.replace(at, kPlace.size(), name);
    at += name.size();
  }
  return text;
}

int print_new(const std::string& name, const std::string& environment) {
  const std::string allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  if (name.find_first_not_of(allowed) != std::string::npos) {
    throw ConfigurationError(
        "'" + name + "' is not a valid experiment name; write letters, digits, '_' and '-'");
  }
  const Template& chosen = template_of(environment);
  put_result(named(std::string(chosen.text), name.empty() ? std::string(chosen.name) : name));
  return 0;
}

}  // namespace

void add(CLI::App& app, Action& action) {
  const auto name = std::make_shared<std::string>();
  const auto environment = std::make_shared<std::string>(kExplorer);
  CLI::App* command =
      app.add_subcommand("new", "Print a commented experiment file that is ready to run");
  command->add_option("NAME", *name, "Name of the experiment")->check(app::named("experiment"));
  command->add_option(
      "--environment", *environment,
      "An experiment in this environment; it learns by reward (cart_pole: a fixed rule)");
  command->footer(kFooter);
  command->callback([name, environment, &action] {
    action = [name, environment] { return print_new(*name, *environment); };
  });
}

}  // namespace spikeloop::app::new_command
