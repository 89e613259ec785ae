#include "spikeloop/process/idle_ports.hpp"

#include <vector>

namespace spikeloop::music {
namespace {

class IdleSource : public Source {
 public:
  explicit IdleSource(EndpointPort port) : port_(std::move(port)) {}
  std::vector<EndpointPort> ports() const override { return {port_}; }
  void receive(const Step&) override {}

 private:
  EndpointPort port_;
};

class IdleSink : public Sink {
 public:
  explicit IdleSink(EndpointPort port) : port_(std::move(port)) {}
  std::vector<EndpointPort> ports() const override { return {port_}; }
  void send(const Step&) override {}

 private:
  EndpointPort port_;
};

}  // namespace

std::unique_ptr<Source> make_idle_source(const EndpointPort& port) {
  return std::make_unique<IdleSource>(port);
}
std::unique_ptr<Sink> make_idle_sink(const EndpointPort& port) {
  return std::make_unique<IdleSink>(port);
}

}  // namespace spikeloop::music
