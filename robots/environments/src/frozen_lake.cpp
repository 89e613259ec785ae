// Gymnasium's FrozenLake-v1 with its map of 4 x 4.
#include <algorithm>
#include <string_view>

#include "base.hpp"

namespace spikeloop::environments {
namespace {

class FrozenLake final : public Base<1> {
 public:
  explicit FrozenLake(bool slippery)
      : Base({.name = "frozen_lake",
              .text = "A walk over a frozen lake of 4 x 4 fields with four holes, from the upper "
                      "left to the lower right (action: 0 left, 1 down, 2 right, 3 up)",
              .source = "Gymnasium's FrozenLake-v1",
              .observation = {{"field", 0, 15}},
              .action = {{"direction", 0, 3}},
              .actions = 4,
              .step = kNsPerSecond / 10,
              .max_steps = 100}),
        slippery_(slippery) {}

 private:
  /// Start, frozen, hole, goal; row by row.
  static constexpr std::string_view kFields = "SFFFFHFHFFFHHFFG";

  State start() override { return {0}; }

  Outcome advance(double action) override {
    auto direction = static_cast<std::uint64_t>(action);
    if (slippery_) {
      direction = (direction + 3 + random_.choice(3)) % 4;
    }
    const int field = moved(static_cast<int>(state_[0]), direction);
    state_[0] = field;
    const bool goal = kFields[field] == 'G';
    return {
        .reward = goal ? 1.0 : 0.0, .terminated = goal || kFields[field] == 'H', .success = goal};
  }

  static int moved(int field, std::uint64_t direction) {
    int row = field / 4;
    int column = field % 4;
    switch (direction) {
      case 0:
        column = std::max(column - 1, 0);
        break;
      case 1:
        row = std::min(row + 1, 3);
        break;
      case 2:
        column = std::min(column + 1, 3);
        break;
      default:
        row = std::max(row - 1, 0);
    }
    return row * 4 + column;
  }

  bool slippery_;
};

}  // namespace

std::unique_ptr<Environment> make_frozen_lake(const Options& options) {
  return std::make_unique<FrozenLake>(options.slippery);
}

}  // namespace spikeloop::environments
