#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <memory>
#include <thread>

#include "commands.hpp"
#include "live_server.hpp"
#include "option_values.hpp"
#include "output.hpp"
#include "recorded_run.hpp"
#include "run_player.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/live/feed.hpp"

namespace spikeloop::app::view_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop view runs/explorer-1                    shows the run at http://127.0.0.1:8765/
  spikeloop view runs/explorer-1 --live-port 0      at any free port

The page is that of 'spikeloop run --live', with a time bar: pause, speed, single ticks. Ctrl-C ends it.

Exit codes: 0 ended by Ctrl-C, 2 no run that can be shown, 4 a file cannot be read)";

volatile std::sig_atomic_t stopped = 0;

int view(const std::string& folder, const LiveOptions& options) {
  RunPlayer player(folder);
  const LiveServer server(options, folder, player.name(), true);
  std::signal(SIGINT, [](int /*number*/) { stopped = 1; });
  std::signal(SIGTERM, [](int /*number*/) { stopped = 1; });
  player.open(live::folder_from_environment());
  while (stopped == 0) {
    player.advance(wall_now());
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return 0;
}

}  // namespace

void add(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("view", "Show a run that has ended in the browser");
  const auto folder = std::make_shared<std::string>();
  const auto options = std::make_shared<LiveOptions>();
  command->add_option("RUN", *folder, "Run folder of an experiment")
      ->required()
      ->check(named("run folder"));
  add_address_options(*command, *options);
  command->footer(kFooter);
  command->callback([folder, options, &action] {
    action = [folder, options] { return view(*folder, *options); };
  });
}

}  // namespace spikeloop::app::view_command
