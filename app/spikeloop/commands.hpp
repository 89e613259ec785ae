// The subcommands of `spikeloop`: a file and a namespace each.
#pragma once

#include <functional>

namespace CLI {
class App;
}
namespace spikeloop::topics {
struct CommandLine;
}

namespace spikeloop::app {

/// What the command line asks for; returns the exit code.
using Action = std::function<int()>;

// Each adds its subcommand to `app`, and sets `action` when the command line has that subcommand.

namespace bench_command {
void add(CLI::App& app, Action& action);
}
namespace check_command {
void add(CLI::App& app, Action& action);
}
namespace completion_command {
/// Reads all commands of `app` when the action is called, also those that were added later.
void add(CLI::App& app, Action& action);
}  // namespace completion_command
namespace describe_command {
void add(CLI::App& app, Action& action);
}
namespace doctor_command {
void add(CLI::App& app, Action& action);
}
namespace explain_command {
void add(CLI::App& app, Action& action);
}
namespace export_command {
void add(CLI::App& app, Action& action);
}
namespace fit_command {
void add(CLI::App& app, Action& action);
}
namespace graph_command {
void add(CLI::App& app, Action& action);
}
namespace import_command {
void add(CLI::App& app, Action& action);
}
namespace new_command {
void add(CLI::App& app, Action& action);
}
namespace plot_command {
void add(CLI::App& app, Action& action);
}
namespace replay_command {
void add(CLI::App& app, Action& action);
}
namespace run_command {
/// @param line  the arguments for ROS, which are not the subcommand's options
void add(CLI::App& app, const topics::CommandLine& line, Action& action);
}  // namespace run_command
namespace schema_command {
void add(CLI::App& app, Action& action);
}
namespace summary_command {
void add(CLI::App& app, Action& action);
}
namespace sweep_command {
void add(CLI::App& app, Action& action);
}

namespace view_command {
void add(CLI::App& app, Action& action);
}

}  // namespace spikeloop::app
