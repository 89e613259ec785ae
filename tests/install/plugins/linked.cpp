// Two plug-ins without a shared library: the encoder runs for a second in a graph of the program's.
#include <cstdio>
#include <spikeloop/core/graph.hpp>
#include <spikeloop/core/registry.hpp>

namespace {

using namespace spikeloop;

class Zero : public Source {
 public:
  std::vector<EndpointPort> ports() const override { return {{"out", PortKind::signal, 1}}; }
  void receive(const Step& step) override {
    if (step.interval().begin == 0) {
      step.signal_output().values()[0] = 0.0;
      step.signal_output().commit();
    }
  }
};

class Count : public Sink {
 public:
  std::vector<EndpointPort> ports() const override { return {{"in", PortKind::spikes, 1}}; }
  void send(const Step& step) override { spikes += step.spike_input().spikes.size(); }
  std::size_t spikes = 0;
};

}  // namespace

int main() {
  Registry registry;
  for (const std::string& name : registry.add_linked_plugins()) {
    std::printf("%s\n", name.c_str());
  }
  const NodeClass& encoder = registry.find("my_rate_encoder");
  Zero zero;
  Count count;
  GraphDescription description;
  description.tick = 1'000'000;
  description.nodes = {{"encoder", &encoder, resolve(encoder.description.parameters, {}, {}), {}}};
  description.sources = {{"zero", &zero}};
  description.sinks = {{"count", &count}};
  description.connections = {{"zero", "encoder"}, {"encoder", "count"}};
  Graph graph(description);
  for (int i = 0; i < 1000; ++i) {
    graph.step();
  }
  std::printf("%zu spikes in a second at 50 Hz\n", count.spikes);
  return count.spikes == 50 && registry.contains("thrower") ? 0 : 1;
}
