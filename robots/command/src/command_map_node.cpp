#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "spikeloop/command/mapping.hpp"

namespace spikeloop::command {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

class CommandMapNode : public Node {
 public:
  explicit CommandMapNode(std::vector<CommandField> components)
      : components_(std::move(components)) {}

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
    for (const CommandField& component : components_) {
      const double channel = in.values[component.channel];
      // An infinite channel is a fault, which limits must not hide.
      *value++ = std::isfinite(channel) ? std::clamp(component.scale * channel + component.offset,
                                                     component.minimum.value_or(-kUnlimited),
                                                     component.maximum.value_or(kUnlimited))
                                        : channel;
    }
    out.commit();
  }

 private:
  std::vector<CommandField> components_;
  std::uint64_t revision_ = 0;
};

}  // namespace

NodeClass command_map_class(std::vector<CommandField> components) {
  NodeDescription description;
  description.name = "command_map";
  description.text = "Maps channels to the fields of a command";
  description.ports = {{"in", PortKind::signal, Direction::input, {}, "The channels"},
                       {"out", PortKind::signal, Direction::output, {}, "One value per field"}};
  return {description, [components = std::move(components)](const NodeSetup&) {
            return std::make_unique<CommandMapNode>(components);
          }};
}

}  // namespace spikeloop::command
