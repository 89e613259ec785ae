#include "host.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/script_keys.hpp"
#include "spikeloop/core/unit_demand.hpp"
#include "spikeloop/process/idle_ports.hpp"

namespace spikeloop::python {
namespace {

constexpr const char* kScript = "script";                  // the script's end of the graphs
constexpr const char* kScriptKey = "script";               // of sections that spikeloop-script runs
constexpr const char* kExperimentKey = "experiment_file";  // of those made from an experiment

/// Setup changes them, and MPI keeps pointers to them: they live as long as the program.
struct CommandLine {
  std::vector<std::string> words;
  std::vector<char*> pointers;
  int count = 0;
  char** values = nullptr;

  explicit CommandLine(std::vector<std::string> arguments) : words(std::move(arguments)) {
    for (std::string& word : words) {
      pointers.push_back(word.data());
    }
    pointers.push_back(nullptr);
    count = static_cast<int>(words.size());
    values = pointers.data();
  }
};

/// Endpoints are named as their port, unless the script's end is named so.
std::string endpoint_name(const EndpointPort& port) {
  return port.name == kScript ? "port " + port.name : port.name;
}

}  // namespace

Host::Host(std::vector<std::string> arguments, std::vector<DeclaredPort> ports,
           std::vector<ParameterDescription> parameters, bool many_processes) {
  auto* const line = new CommandLine(std::move(arguments));
  process_ = std::make_unique<music::Process>(
      line->count, line->values,
      music::CommonDefaults{.many_processes = many_processes, .takes_arguments = true});
  arguments_.assign(line->values + std::min(line->count, 1), line->values + line->count);
  try {
    read(parameters);
    open(std::move(ports));
    process_->check();
  } catch (const Error&) {
    process_->let_the_first_speak();
    throw;
  }
}

Host::Host(std::unique_ptr<music::Process> process, std::vector<DeclaredPort> ports,
           std::vector<ParameterDescription> parameters)
    : process_(std::move(process)) {
  for (const auto& [name, value] : process_->written({"args"})) {
    arguments_ = {value.text};
  }
  read(parameters);
  open(std::move(ports));
  process_->check();
}

Host::~Host() = default;

void Host::read(const std::vector<ParameterDescription>& parameters) {
  process_->written({kScriptKey});  // spikeloop-script's, and no slip of the pen
  directory_ = process_->file_directory();
  for (const auto& [name, file] : process_->written({kExperimentKey})) {
    directory_ = std::filesystem::path(file.text).parent_path().lexically_normal().string();
    for (const ParameterDescription& parameter : parameters) {
      for (const auto& [key, value] : process_->written({parameter.name})) {
        demand_unit(fmt::format("node '{}'", process_->label()), parameter, value);
      }
    }
  }
  parameters_ = process_->read(parameters);
}

void Host::open(std::vector<DeclaredPort> ports) {
  receiving_description_.tick = sending_description_.tick = process_->common().music_timestep;
  receiving_description_.seed = sending_description_.seed = process_->common().seed;
  std::vector<std::string> names;
  for (const DeclaredPort& port : ports) {
    names.push_back(port.name);
  }
  process_->declare_ports(names);
  for (const DeclaredPort& port : ports) {
    const bool input = port.direction == Direction::input;
    const bool connected = input ? process_->connected_input(port.name, port.kind)
                                 : process_->connected_output(port.name, port.kind);
    if (connected) {
      check_kind(port);
    }
    const EndpointPort settled{port.name, port.kind, settled_width(port, connected)};
    widths_.push_back(settled.width);
    connected_.push_back(connected);
    input ? open_input(settled, connected) : open_output(settled, connected);
  }
  make_graphs();
}

std::vector<std::uint32_t> Host::widths() const {
  return widths_;
}

/// Of the other kind MUSIC would wait for ever, and say nothing.
void Host::check_kind(const DeclaredPort& port) const {
  const bool spikes = port.kind == PortKind::spikes;
  const char* const declared = script_key(port.kind, port.direction);
  const char* const right =
      script_key(spikes ? PortKind::signal : PortKind::spikes, port.direction);
  const WrittenValues carried = process_->written({declared, right});
  const auto found = carried.find(right);
  if (found != carried.end() &&
      ("," + found->second.text + ",").find("," + port.name + ",") != std::string::npos) {
    throw ConfigurationError(
        process_->where(port.name),
        with_code(Code::kinds_differ, "'{}.{}' carries {}, but {} declares it in {}; write {}",
                  process_->label(), port.name, spikes ? "a continuous signal" : "spikes",
                  process_->program(), declared, right));
  }
}

std::uint32_t Host::settled_width(const DeclaredPort& port, bool connected) const {
  if (!connected && port.width != 0) {
    return port.width;
  }
  if (!connected) {
    throw ConfigurationError(
        process_->where(),
        with_code(Code::not_connected,
                  "port '{0}.{1}' is not connected; write  {2}, or a width in the script, with "
                  "which it {3}",
                  process_->label(), port.name,
                  port.direction == Direction::input
                      ? fmt::format("SENDER.out -> {}.{} [WIDTH]", process_->label(), port.name)
                      : fmt::format("{}.{} -> RECEIVER.in [WIDTH]", process_->label(), port.name),
                  port.direction == Direction::input ? "stays silent" : "goes nowhere"));
  }
  const std::uint32_t width = process_->width(port.name);
  if (port.width != 0 && port.width != width) {
    throw ConfigurationError(
        process_->where(port.name),
        with_code(Code::widths_differ,
                  "the connection of '{}.{}' has the width {}, but {} asks for {}; write [{}], "
                  "or None in the script for as many channels as the file says",
                  process_->label(), port.name, width, process_->program(), port.width,
                  port.width));
  }
  return width;
}

void Host::open_input(const EndpointPort& port, bool connected) {
  inputs_.push_back(port);
  if (!connected) {
    sources_.push_back(music::make_idle_source(port));
  } else {
    sources_.push_back(port.kind == PortKind::spikes ? process_->spike_input(port.name)
                                                     : process_->signal_input(port.name));
  }
  const std::string name = endpoint_name(port);
  receiving_description_.sources.push_back({name, sources_.back().get()});
  receiving_description_.connections.push_back({name + "." + port.name,
                                                fmt::format("{}.{}", kScript, port.name), 0, 0,
                                                process_->where(port.name)});
}

void Host::open_output(const EndpointPort& port, bool connected) {
  outputs_.push_back(port);
  if (!connected) {
    sinks_.push_back(music::make_idle_sink(port));
  } else {
    sinks_.push_back(port.kind == PortKind::spikes ? process_->spike_output(port.name)
                                                   : process_->signal_output(port.name));
  }
  const std::string name = endpoint_name(port);
  sending_description_.sinks.push_back({name, sinks_.back().get()});
  sending_description_.connections.push_back(
      {gathered(port), name + "." + port.name, 0, 0, process_->where(port.name)});
}

/// Where all spikes of an output are: of several processes each has those of its own cells. Of a
/// signal each sends its share of the channels.
std::string Host::gathered(const EndpointPort& port) {
  const std::string script = fmt::format("{}.{}", kScript, port.name);
  if (process_->share().parts == 1 || port.kind == PortKind::signal) {
    return script;
  }
  const std::string name = "gathering of " + port.name;
  gatherings_.push_back(std::make_unique<NodeClass>(process_->gathering(port.kind)));
  sending_description_.nodes.push_back({name, gatherings_.back().get(), {}, {}});
  sending_description_.connections.push_back({script, name + ".in", 0, 0, {}});
  return name + ".out";
}

void Host::make_graphs() {
  inbox_ = std::make_unique<Inbox>(inputs_);
  outbox_ = std::make_unique<Outbox>(outputs_);
  if (!inputs_.empty()) {
    receiving_description_.sinks.push_back({kScript, inbox_.get()});
  }
  if (!outputs_.empty()) {
    sending_description_.sources.push_back({kScript, outbox_.get()});
  }
  process_->attach_recorders(sending_description_);
  receiving_.emplace(receiving_description_);
  sending_.emplace(sending_description_);
}

std::optional<Interval> Host::begin() {
  if (!loop_) {
    loop_ = std::make_unique<music::Process::Loop>(
        *process_, std::vector<const Graph*>{&*receiving_, &*sending_});
  }
  if (!loop_->begin()) {
    return std::nullopt;
  }
  const TimeNs time = receiving_->time();
  receiving_->step();
  return Interval{time, receiving_->time()};
}

void Host::end() {
  sending_->step();
  loop_->exchange();
}

void Host::finish() {
  loop_->finish();
}

}  // namespace spikeloop::python
