#include "spikeloop/command/command_map_node.hpp"

#include <algorithm>
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
    std::ranges::copy(map_.map(in.values), out.values().begin());
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
