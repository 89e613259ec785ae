#include "caller.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "spikeloop/core/code.hpp"
#include "spikeloop/experiment/simulators.hpp"

namespace spikeloop::python {
namespace {

class SeenSink : public Sink {
 public:
  SeenSink(Seen& seen, std::string port) : seen_(seen), port_(std::move(port)) {}
  std::vector<EndpointPort> ports() const override { return {{port_, seen_.kind, seen_.width}}; }
  void send(const Step& step) override {
    if (seen_.kind == PortKind::spikes) {
      const auto arrived = step.spike_input().spikes;
      seen_.spikes.insert(seen_.spikes.end(), arrived.begin(), arrived.end());
    } else if (const SignalInput signal = step.signal_input(); signal.valid()) {
      seen_.values.assign(signal.values.begin(), signal.values.end());
    }
  }

 private:
  Seen& seen_;
  std::string port_;
};

class SentSource : public Source {
 public:
  SentSource(Sent& sent, std::string port) : sent_(sent), port_(std::move(port)) {}
  std::vector<EndpointPort> ports() const override { return {{port_, sent_.kind, sent_.width}}; }
  void receive(const Step& step) override {
    if (sent_.kind == PortKind::spikes) {
      const TimeNs tick = step.interval().end - step.interval().begin;
      for (const Spike& spike : sent_.spikes) {
        step.spike_output().emit(spike.time_ns + tick, spike.channel);
      }
      sent_.spikes.clear();
    } else if (sent_.is_new) {
      std::ranges::copy(sent_.values, step.signal_output().values().begin());
      step.signal_output().commit();
      sent_.is_new = false;
    }
  }

 private:
  Sent& sent_;
  std::string port_;
};

template <typename Ends>
auto& find(Ends& ends, const std::string& end, const char* what) {
  const auto found = ends.find(end);
  if (found == ends.end()) {
    std::vector<std::string> names;
    for (const auto& [name, value] : ends) {
      names.push_back(name);
    }
    throw ConfigurationError(with_code(Code::unknown_port, "there is no {} '{}'{}", what, end,
                                       names.empty() ? "" : did_you_mean(end, names)));
  }
  return found->second;
}

}  // namespace

std::uint32_t Caller::delay(const experiment::Connection& edge) const {
  // The source moves spikes by the tick; a value is there a tick later by itself.
  return experiment::is_simulator_end(experiment_, edge.from) ? 1 : 0;
}

std::unique_ptr<Source> Caller::source(const experiment::Connection& edge) {
  if (edge.delay_ticks.value_or(0) < 1) {
    throw ConfigurationError(
        edge.where,
        with_code(Code::delay, "what '{}' answers arrives a tick later; write [delay 1 tick]",
                  experiment::node_of(edge.from)));
  }
  Sent& sent = sent_[edge.from];
  sent.kind = edge.kind;
  sent.width = edge.width;
  return std::make_unique<SentSource>(sent, experiment::port_of(edge.from));
}

std::unique_ptr<Sink> Caller::sink(const experiment::Connection& edge) {
  const std::uint32_t width =
      experiment_.width(experiment::node_of(edge.to), experiment::port_of(edge.to));
  return observe(edge.to, edge.kind, width);
}

std::unique_ptr<Sink> Caller::observe(const std::string& end, PortKind kind, std::uint32_t width) {
  Seen& seen = seen_[end];
  seen.kind = kind;
  seen.width = width;
  return std::make_unique<SeenSink>(seen, experiment::port_of(end));
}

void Caller::forget_spikes() {
  for (auto& [end, seen] : seen_) {
    seen.spikes.clear();
  }
}

const Seen& Caller::seen(const std::string& end) const {
  return find(seen_, end, "output of a node, or input of a simulator,");
}

Sent& Caller::sent(const std::string& end) {
  return find(sent_, end, "output of a simulator");
}

}  // namespace spikeloop::python
