#include "assembly.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "endpoints.hpp"
#include "live_view.hpp"
#include "spikeloop/bag/recorder.hpp"
#include "spikeloop/command/mapping.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/experiment/endpoints.hpp"
#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/experiment/safety.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/record/recorder.hpp"
#include "spikeloop/status/status.hpp"

namespace spikeloop::fused {
namespace {

using experiment::Connection;
using experiment::Experiment;
using experiment::Node;
using experiment::Role;

constexpr std::string_view kSender = " sender";
// No name of a node or a port has such characters.
constexpr std::string_view kRecord = "record: ";
constexpr std::string_view kSent = " ->";

/// A sensor whose errors name its node and its place in the file.
class NamedSource : public Source {
 public:
  NamedSource(std::unique_ptr<Source> source, const Node& node)
      : source_(std::move(source)), node_(node) {}

  std::vector<EndpointPort> ports() const override { return source_->ports(); }
  void receive(const Step& step) override {
    try {
      source_->receive(step);
    } catch (const ConfigurationError& error) {
      throw ConfigurationError(node_.where, fmt::format("node '{}': {}", node_.name, error.what()));
    }
  }
  std::vector<Counter> counters() const override { return source_->counters(); }

 private:
  std::unique_ptr<Source> source_;
  const Node& node_;
};

/// A port of another process's is an element of its own: "brain out", with the end "brain out.out".
std::string element_of(const std::string& end) {
  return fmt::format("{} {}", experiment::node_of(end), experiment::port_of(end));
}

/// Spikes that wait for the writer, per output: at most 256 MB in all, unless there are more than
/// 4000 outputs.
std::size_t spike_capacity(std::size_t outputs) {
  constexpr std::size_t kAll = std::size_t{1} << 24;
  constexpr std::size_t kLeast = std::size_t{1} << 12;
  constexpr std::size_t kUsual = std::size_t{1} << 18;
  return std::clamp(kAll / std::max<std::size_t>(outputs, 1), kLeast, kUsual);
}

std::string sender_of(const std::string& command) {
  return command + std::string(kSender);
}

}  // namespace

bool is_recording(std::string_view element) {
  return element.starts_with(kRecord);
}

bool is_sent(std::string_view end) {
  return end.substr(0, end.find('.')).ends_with(kSent);
}

std::string name_in_file(std::string_view element) {
  std::string name(element);
  if (const auto blank = name.find(' '); blank != std::string::npos) {
    name.erase(blank, name.find('.', blank) - blank);
  }
  return name;
}

Assembly::Assembly(const Experiment& experiment, const Surroundings& surroundings,
                   const RunOptions& options)
    : experiment_(experiment),
      transport_(surroundings.transport),
      others_(surroundings.others),
      process_(surroundings.process),
      view_(surroundings.view),
      folder_(options.record ? options.folder : ""),
      failures_(*options.failures) {
  description_.tick = experiment.tick;
  description_.seed = experiment.seed;
  if (!folder_.empty()) {
    open_bag();
  }
  for (const Node& node : experiment.nodes) {
    if (is_here(node.name)) {
      add_node(node);
    }
  }
  for (const Connection& edge : edges(experiment)) {
    add_edge(edge);
  }
  if (!folder_.empty()) {
    record();
  }
  if (options.observe) {
    observe("observed", options.observe);
  }
  if (view_ != nullptr) {
    show();
  }
  graph_.emplace(description_);
}

Assembly::~Assembly() = default;

void Assembly::add_node(const Node& node) {
  switch (node.role) {
    case Role::node:
      description_.nodes.push_back({.name = node.name,
                                    .node_class = node.node_class,
                                    .parameters = node.parameters,
                                    .where = node.where,
                                    .begins_anew = begins_anew(node)});
      return;
    case Role::source:
      sources_.push_back(
          experiment::takes_messages(node.kind)
              ? std::make_unique<NamedSource>(
                    make_sensor(experiment_, node, transport_, keep_messages(node)), node)
              : experiment::playback(node));
      description_.sources.push_back({node.name, sources_.back().get()});
      return;
    case Role::sink:
      add_command(node);
      return;
    case Role::simulator:
      return;  // is never here
  }
}

bool Assembly::begins_anew(const Node& node) const {
  const auto& episodes = experiment_.episodes;
  return episodes && std::ranges::find(episodes->reset, node.name) != episodes->reset.end();
}

void Assembly::add_command(const Node& node) {
  const std::uint32_t width = experiment_.width(node.name, "in");
  auto components = command::components(node.mapping, width);
  const auto fields = static_cast<std::uint32_t>(components.size());
  commands_.push_back(make_command(experiment_, node, transport_, keep_messages(node)));
  take_latency(node, *commands_.back());
  classes_.push_back(
      std::make_unique<NodeClass>(command::command_map_class(std::move(components))));
  description_.nodes.push_back({node.name, classes_.back().get(), {}, node.where});
  description_.sinks.push_back({sender_of(node.name), &commands_.back()->sink()});
  description_.connections.push_back(
      {node.name + ".out", sender_of(node.name) + ".command", fields, 0, node.where});
}

bool Assembly::is_here(const std::string& end) const {
  return process_of(experiment_, experiment::node_of(end)) == process_;
}

void Assembly::add_edge(const Connection& edge) {
  const bool from_here = is_here(edge.from);
  if (is_here(edge.to)) {
    connect(from_here ? edge.from : source_of(edge), end_here(edge.to), edge, waiting(edge));
  } else if (from_here) {
    send(edge);
  }
}

void Assembly::connect(const std::string& from, const std::string& to, const Connection& edge,
                       std::uint32_t delay) {
  description_.connections.push_back({.from = from,
                                      .to = to,
                                      .delay_ticks = delay,
                                      .where = edge.where,
                                      .channels = edge.channels,
                                      .combination = edge.combination,
                                      .sender_width = edge.width});
}

/// What does not pass of its delay outside.
std::uint32_t Assembly::waiting(const Connection& edge) const {
  const bool inside = is_here(edge.from) && is_here(edge.to);
  return edge.delay_ticks.value_or(0) - (inside ? 0 : others_->delay(edge));
}

/// A command is a node, with the port `in`, and what sends behind it, with all others.
std::string Assembly::end_here(const std::string& end) const {
  const std::string node = experiment::node_of(end);
  const bool to_sender =
      experiment_.node(node).role == Role::sink && experiment::port_of(end) != "in";
  return to_sender ? fmt::format("{}.{}", sender_of(node), experiment::port_of(end)) : end;
}

/// One for all edges that begin there.
std::string Assembly::source_of(const Connection& edge) {
  const std::string element = element_of(edge.from);
  if (outside_.insert(element).second) {
    sources_.push_back(others_->source(edge));
    description_.sources.push_back({element, sources_.back().get()});
  }
  return fmt::format("{}.{}", element, experiment::port_of(edge.from));
}

void Assembly::send(const Connection& edge) {
  const bool to_simulator = is_simulator_end(experiment_, edge.to);
  const std::string& end = to_simulator ? edge.to : edge.from;
  const std::string element = element_of(end) + std::string(to_simulator ? "" : kSent);
  const bool is_new = outside_.insert(element).second;
  if (is_new) {
    sinks_.push_back(others_->sink(edge));
    description_.sinks.push_back({element, sinks_.back().get()});
  }
  const std::string to = fmt::format("{}.{}", element, experiment::port_of(end));
  if (to_simulator) {
    connect(edge.from, to, edge, waiting(edge));
  } else if (is_new) {
    // All channels, once for all receivers; in their graph it waits and is combined.
    description_.connections.push_back({edge.from, to, edge.width, 0, edge.where});
  }
}

/// In the run folder of an experiment whose topics are all here.
void Assembly::open_bag() {
  const auto has_topic = [](const Node& node) { return experiment::has_topic(node.kind); };
  if (std::ranges::any_of(experiment_.nodes, has_topic) && one_meets_robot(experiment_) &&
      meets_robot(experiment_, process_)) {
    bag::RecorderOptions options{.patient = experiment_.sync != experiment::Sync::realtime,
                                 .failures = &failures_};
    if (options.patient) {
      constexpr std::size_t kEnough = std::size_t{4} << 20;  // the loop waits for the writer
      options.capacity_bytes = kEnough;
    }
    messages_ = std::make_unique<bag::Recorder>(folder_ + "/" + kMessagesFile, options);
    if (const std::string resolved = folder_ + "/resolved.json";
        std::filesystem::exists(resolved)) {
      constexpr std::uint64_t kLimit = std::uint64_t{1} << 30;
      messages_->attach("resolved.json", "application/json",
                        read_file(resolved, "resolved.json", kLimit));
    }
  }
}

topics::Keep Assembly::keep_messages(const Node& node) {
  topics::Keep show = view_ != nullptr ? view_->messages(node) : topics::Keep{};
  if (!messages_) {
    return show;
  }
  const std::uint32_t channel =
      messages_->add({node.parameters.text("topic"), node.parameters.text("message"), node.name,
                      experiment_.dialect});
  return [recorder = messages_.get(), channel, show = std::move(show)](
             TimeNs time, std::span<const std::byte> message) {
    recorder->take(channel, time, message);
    if (show) {
      show(time, message);
    }
  };
}

record::Recorder& Assembly::recorder_of(const Node& node) {
  auto& recorder = recorders_[node.name];
  if (!recorder) {
    recorder = std::make_unique<record::Recorder>(
        fmt::format("{}/{}.h5", folder_, node.name), node.name,
        record::RunAttributes{experiment_.seed, experiment_.tick},
        record::RecorderOptions{.spike_capacity = spike_capacity(experiment_.outputs.size()),
                                .patient = experiment_.sync != experiment::Sync::realtime,
                                .failures = &failures_});
  }
  return *recorder;
}

void Assembly::add_recording(const std::string& from, const std::string& name,
                             std::unique_ptr<Sink> sink) {
  description_.sinks.push_back({name, sink.get()});
  description_.connections.push_back({from, name, 0, 0, {}});
  recording_sinks_.push_back(std::move(sink));
}

/// Every output of a node, and the fields of every command, unless the node has  record: false.
void Assembly::record() {
  const auto name_of = [](const std::string& node, const std::string& stream) {
    return fmt::format("{}{} {}", kRecord, node, stream);
  };
  for (const experiment::Output& output : experiment_.outputs) {
    const bool is_recorded = experiment_.node(output.node).record;
    if (output.width == 0 || !is_recorded || !is_here(output.node)) {
      continue;  // its own process records what it puts out
    }
    const std::string end = fmt::format("{}.{}", output.node, output.port);
    const Node& node = experiment_.node(output.node);
    located_at(node.where, [&] {
      add_recording(end, name_of(output.node, output.port),
                    recorder_of(node).output_sink(description_, end,
                                                  {output.port, output.kind, output.width}));
    });
  }
  for (const Node& node : experiment_.nodes) {
    if (node.role != Role::sink || !is_here(node.name) || !node.record) {
      continue;
    }
    const bool all = node.mapping.all_channels;
    const auto paths = command::field_paths(node.mapping);
    const auto width =
        all ? experiment_.width(node.name, "in") : static_cast<std::uint32_t>(paths.size());
    add_recording(node.name + ".out", name_of(node.name, "command"),
                  recorder_of(node).signal_sink("command", width, "1",
                                                all ? std::vector<std::string>{} : paths));
  }
}

void Assembly::observe(std::string_view observer, const Observe& observe) {
  const auto add = [&](const std::string& from, const std::string& name, PortKind kind,
                       std::uint32_t width) {
    if (auto sink = observe(name, kind, width)) {
      add_recording(from, fmt::format("{}{} {}", kRecord, observer, element_of(name)),
                    std::move(sink));
    }
  };
  for (const experiment::Output& output : experiment_.outputs) {
    if (output.width != 0 && is_here(output.node)) {
      const std::string end = fmt::format("{}.{}", output.node, output.port);
      add(end, end, output.kind, output.width);
    }
  }
  for (const Node& node : experiment_.nodes) {
    if (node.role == Role::sink && is_here(node.name)) {
      const auto fields =
          node.mapping.all_channels
              ? experiment_.width(node.name, "in")
              : static_cast<std::uint32_t>(command::field_paths(node.mapping).size());
      add(node.name + ".out", node.name + ".command", PortKind::signal, fields);
    }
  }
}

/// What nodes here put out, and what simulators send here.
void Assembly::show() {
  const auto sink = [this](const std::string& end, PortKind kind, std::uint32_t width) {
    return view_->sink(end, kind, width);
  };
  observe("shown", sink);
  std::set<std::string> shown;
  for (const Connection& edge : edges(experiment_)) {
    if (is_simulator_end(experiment_, edge.from) && is_here(edge.to) &&
        shown.insert(edge.from).second) {
      add_recording(source_of(edge), fmt::format("{}shown {}", kRecord, element_of(edge.from)),
                    sink(edge.from, edge.kind, edge.width));
    }
  }
}

/// How old the data behind the first command of each message are.
void Assembly::take_latency(const Node& node, ros_command::CommandEndpoint& command) {
  if (!experiment::nearest_sensor(experiment_, node.name)) {
    return;
  }
  if (!folder_.empty() && node.record) {
    command.sink().on_latency(recorder_of(node).value_writer("latency", "ms"));
  }
  if (view_ != nullptr) {
    command.sink().on_latency(view_->value(fmt::format("/{}/latency", node.name)));
  }
}

std::vector<ros_command::CommandEndpoint*> Assembly::commands() const {
  std::vector<ros_command::CommandEndpoint*> commands;
  for (const auto& command : commands_) {
    commands.push_back(command.get());
  }
  return commands;
}

void Assembly::stop_robot(command::StopReason reason) {
  for (const auto& command : commands_) {
    command->stop(reason);
  }
}

nlohmann::json Assembly::close_recordings(std::string& error) {
  const auto take = [&](const std::string& problem) {
    if (!problem.empty() && !failures_.any()) {  // failed writes are reported together
      log::warning("{}", problem);
      error = problem;
    }
  };
  for (const auto& [name, recorder] : recorders_) {
    recorder->begin_close();
  }
  std::uint64_t spikes = 0;
  std::uint64_t dropped = 0;
  for (const auto& [name, recorder] : recorders_) {
    const record::Report report = recorder->close();
    spikes += report.spikes_written;
    dropped += report.spikes_dropped + report.signals_dropped;
    take(report.error);
  }
  recorders_.clear();
  nlohmann::json result{{"spikes_recorded", spikes}, {"records_dropped", dropped}};
  if (messages_) {
    const bag::Report report = messages_->close();
    result["messages_recorded"] = report.written;
    result["messages_dropped"] = report.dropped;
    take(report.error);
  }
  return result;
}

nlohmann::json Assembly::summary() const {
  nlohmann::json summary = nlohmann::json::object();
  for (const auto& command : commands_) {
    status::add_summary(command->summary(), summary);
  }
  return summary;
}

}  // namespace spikeloop::fused
