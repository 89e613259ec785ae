#include "music_processes.hpp"

#include <utility>

#include "spikeloop/experiment/music_job.hpp"
#include "spikeloop/experiment/simulators.hpp"

namespace spikeloop {
namespace {

std::vector<EndpointPort> named(std::vector<EndpointPort> ports, const std::string& name) {
  ports.front().name = name;
  return ports;
}

/// A port of MUSIC's under the name that the node at its other end has for it.
class NamedSource : public Source {
 public:
  NamedSource(std::shared_ptr<Source> source, std::string name)
      : source_(std::move(source)), name_(std::move(name)) {}
  std::vector<EndpointPort> ports() const override { return named(source_->ports(), name_); }
  void receive(const Step& step) override { source_->receive(step); }
  std::vector<Counter> counters() const override { return source_->counters(); }

 private:
  std::shared_ptr<Source> source_;
  std::string name_;
};

class NamedSink : public Sink {
 public:
  NamedSink(std::shared_ptr<Sink> sink, std::string name)
      : sink_(std::move(sink)), name_(std::move(name)) {}
  std::vector<EndpointPort> ports() const override { return named(sink_->ports(), name_); }
  void send(const Step& step) override { sink_->send(step); }
  std::vector<Counter> counters() const override { return sink_->counters(); }

 private:
  std::shared_ptr<Sink> sink_;
  std::string name_;
};

}  // namespace

std::unique_ptr<Source> MusicProcesses::source(const experiment::Connection& edge) {
  const std::string port = experiment::process_port(edge.from);
  sources_.push_back(edge.kind == PortKind::spikes ? process_.spike_input(port)
                                                   : process_.signal_input(port));
  return std::make_unique<NamedSource>(sources_.back(), experiment::port_of(edge.from));
}

std::unique_ptr<Sink> MusicProcesses::sink(const experiment::Connection& edge) {
  const std::string& end = is_simulator_end(experiment_, edge.to) ? edge.to : edge.from;
  const std::string port = experiment::process_port(end);
  sinks_.push_back(edge.kind == PortKind::spikes ? process_.spike_output(port)
                                                 : process_.signal_output(port));
  return std::make_unique<NamedSink>(sinks_.back(), experiment::port_of(end));
}

void MusicProcesses::meet() {
  music::Process::LoopHooks hooks;
  hooks.clock_report = [this] {
    Pacer::Report report;
    report.wall_time = progress_.wall;
    report.overruns = progress_.overruns;
    return report;
  };
  hooks.counters = [this] { return summary_.value("counters", nlohmann::json::object()); };
  hooks.summary = [this] {
    auto rest = summary_;
    rest.erase("counters");
    return rest;
  };
  loop_ = std::make_unique<music::Process::Loop>(process_, std::vector<const Graph*>{}, hooks);
  process_.enter(status::Phase::computing);
}

void MusicProcesses::finish(const nlohmann::json& summary) {
  summary_ = summary;
  if (loop_ != nullptr) {
    loop_->finish();
  }
}

}  // namespace spikeloop
