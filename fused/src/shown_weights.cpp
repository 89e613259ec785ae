#include "shown_weights.hpp"

#include <algorithm>

#include "spikeloop/live/neural_messages.hpp"

namespace spikeloop::fused {
namespace {

constexpr std::size_t kMost = 256;  // of a projection: what the view costs does not grow with it

}  // namespace

ShownWeights::ShownWeights(live::Feed& feed, const Graph& graph) : feed_(feed), graph_(graph) {
  for (const LearningWeights& projection : graph.learning_weights()) {
    channels_.push_back(feed.add(live::weights_channel("/" + projection.name)));
  }
}

void ShownWeights::publish(TimeNs time) {
  if (channels_.empty()) {
    return;
  }
  const auto projections = graph_.learning_weights();
  for (std::size_t i = 0; i < projections.size(); ++i) {
    const std::span<const double> all = projections[i].weights;
    const std::size_t count = std::min(all.size(), kMost);
    chosen_.clear();
    for (std::size_t k = 0; k < count; ++k) {
      chosen_.push_back(all[k * all.size() / count]);
    }
    live::write_weights(all.size(), chosen_, message_);
    feed_.publish(channels_[i], time, message_);
  }
}

}  // namespace spikeloop::fused
