#include "spikeloop/command/command_map_node.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace spikeloop::command {
namespace {

class CommandMapNode : public Node {
 public:
  explicit CommandMapNode(ComponentMap map) : map_(std::move(map)) {}

  void step(const Step& step) override {
    const SignalInput in = step.signal_input();
    if (in.revision == revision_) {
      return;
    }
    revision_ = in.revision;
    const SignalOutput out = step.signal_output();
    if (!in.valid()) {
      out.invalidate();
      return;
    }
    auto value = out.values().begin();
    for (const Component& component : map_.components()) {
      const double channel = in.values[component.channel];
      // An infinite channel is a fault, which limits must not hide.
      *value++ = std::isfinite(channel) ? std::clamp(component.scale * channel + component.offset,
                                                     component.minimum, component.maximum)
                                        : channel;
    }
    out.commit();
  }

 private:
  ComponentMap map_;
  std::uint64_t revision_ = 0;
};

}  // namespace

NodeClass command_map_class(ComponentMap map) {
  NodeDescription description;
  description.name = "command_map";
  description.text = "Maps channels to the fields of a command";
  description.ports = {{"in", PortKind::signal, Direction::input, {}, "The channels"},
                       {"out", PortKind::signal, Direction::output, {}, "One value per field"}};
  return {description, [map = std::move(map)](const NodeSetup&) {
            return std::make_unique<CommandMapNode>(map);
          }};
}

}  // namespace spikeloop::command
