// Small nodes and endpoints for tests of the graph, and the text of what an action throws.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "spikeloop/core/graph.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {

/// The message of the ErrorType that `action` throws; fails the test when it throws another thing.
template <typename ErrorType>
std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const ErrorType& error) {
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "another exception: " << error.what();
    return {};
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

/// A node made of a function.
class FunctionNode : public Node {
 public:
  explicit FunctionNode(std::function<void(const Step&)> function)
      : function_(std::move(function)) {}
  void step(const Step& step) override { function_(step); }

 private:
  std::function<void(const Step&)> function_;
};

inline NodeClass function_class(std::vector<PortDescription> ports,
                                std::function<void(const Step&)> function) {
  NodeClass node_class;
  node_class.description.name = "function";
  node_class.description.ports = std::move(ports);
  node_class.create = [function = std::move(function)](const NodeSetup&) {
    return std::make_unique<FunctionNode>(function);
  };
  return node_class;
}

class FunctionSource : public Source {
 public:
  FunctionSource(PortKind kind, std::uint32_t width, std::function<void(const Step&)> function)
      : ports_{{"out", kind, width}}, function_(std::move(function)) {}
  std::vector<EndpointPort> ports() const override { return ports_; }
  void receive(const Step& step) override { function_(step); }

 private:
  std::vector<EndpointPort> ports_;
  std::function<void(const Step&)> function_;
};

class FunctionSink : public Sink {
 public:
  FunctionSink(PortKind kind, std::uint32_t width, std::function<void(const Step&)> function)
      : ports_{{"in", kind, width}}, function_(std::move(function)) {}
  std::vector<EndpointPort> ports() const override { return ports_; }
  void send(const Step& step) override { function_(step); }

 private:
  std::vector<EndpointPort> ports_;
  std::function<void(const Step&)> function_;
};

inline PortDescription port(std::string name, PortKind kind, Direction direction,
                            WidthRule width = {}) {
  return {std::move(name), kind, direction, width, ""};
}

}  // namespace spikeloop::test
