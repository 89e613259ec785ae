#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <filesystem>
#include <memory>
#include <thread>

#include "commands.hpp"
#include "console.hpp"
#include "live_server.hpp"
#include "option_values.hpp"
#include "output.hpp"
#include "run_export.hpp"
#include "run_player.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/launch/folders.hpp"
#include "spikeloop/live/feed.hpp"

namespace spikeloop::app::view_command {
namespace {

constexpr const char* kFooter = R"(Examples:
  spikeloop view runs/explorer-1                    shows the run; open the printed address
  spikeloop view runs/explorer-1 --live-port 0      at any free port
  spikeloop view runs/explorer-1 --out run.mcap     writes all of it as one MCAP file, for Foxglove

The page is that of 'spikeloop run --live', with a time bar: pause, speed, single ticks. Ctrl-C ends it.

Exit codes: 0 ended by Ctrl-C, or the file is written, 2 no run that can be shown, 4 a file cannot be
read or written, 130 Ctrl-C: no file is written)";

constexpr int kInterrupted = 130;

volatile std::sig_atomic_t stopped = 0;

struct ViewArguments {
  std::string folder;
  std::string out;
  bool force = false;
  LiveOptions live;
};

void stop_at_signals() {
  std::signal(SIGINT, [](int /*number*/) { stopped = 1; });
  std::signal(SIGTERM, [](int /*number*/) { stopped = 1; });
}

int show(const RunRecordings& run, const std::string& folder, const LiveOptions& options) {
  LiveServer server(options, folder, run.experiment, true);
  stop_at_signals();
  RunPlayer player(run, live::folder_from_environment());
  while (stopped == 0) {
    player.advance(wall_now());
    server.require_alive();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return 0;
}

void check_out(const ViewArguments& arguments) {
  const std::string& file = arguments.out;
  if (!file.ends_with(".mcap")) {
    throw ConfigurationError(
        fmt::format("--out {}: the file is an MCAP file; write a name with .mcap", file));
  }
  const auto messages = std::filesystem::path(arguments.folder) / fused::kMessagesFile;
  launch::refuse_to_overwrite(messages.string(), file);
  const bool exists = std::filesystem::exists(file);
  if (exists && !std::filesystem::is_regular_file(file)) {
    throw ConfigurationError(with_code(
        Code::no_access, "'{}' is not a regular file; write another name with --out", file));
  }
  if (exists && !arguments.force) {
    throw ConfigurationError(with_code(
        Code::no_access,
        "there is a file '{}'; write --force to replace it, or another name with --out", file));
  }
}

int write_mcap(const RunRecordings& run, const ViewArguments& arguments) {
  stop_at_signals();
  Console console(Console::Volume::normal, nullptr, false);
  const bool written = export_run(run, arguments.folder, arguments.out, [&](TimeNs time) {
    console.progress({.simulated_s = to_seconds(time), .total_s = to_seconds(run.end)});
    return stopped == 0;
  });
  console.end({.exit_code = written ? 0 : kInterrupted,
               .reason = "stopped: no file is written",
               .summary = {}},
              {.simulated_s = to_seconds(run.end), .total_s = to_seconds(run.end)});
  if (written) {
    put_result(arguments.out + "\n");
  }
  return written ? 0 : kInterrupted;
}

int view(const ViewArguments& arguments) {
  if (!arguments.out.empty()) {
    check_out(arguments);
  }
  const RunRecordings run = read_recordings(arguments.folder);
  return arguments.out.empty() ? show(run, arguments.folder, arguments.live)
                               : write_mcap(run, arguments);
}

}  // namespace

void add(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("view", "Show a run that has ended in the browser");
  const auto arguments = std::make_shared<ViewArguments>();
  command->add_option("RUN", arguments->folder, "Run folder of an experiment")
      ->required()
      ->check(named("run folder"));
  auto* out = command->add_option("--out", arguments->out, "Write an MCAP file; show nothing")
                  ->check(named("file"));
  command->add_flag("--force", arguments->force, "Replace that file")->needs(out);
  add_address_options(*command, arguments->live);
  command->footer(kFooter);
  command->callback([arguments, &action] { action = [arguments] { return view(*arguments); }; });
}

}  // namespace spikeloop::app::view_command
