// Gymnasium's MountainCar-v0: the same operations in the same order.
#include <algorithm>
#include <cmath>

#include "base.hpp"

namespace spikeloop::environments {
namespace {

class MountainCar final : public Base<2> {
 public:
  MountainCar()
      : Base({.name = "mountain_car",
              .text = "A car too weak for the hill swings in the valley until it reaches the top "
                      "(action: 0 push left, 1 none, 2 push right)",
              .source = "Gymnasium's MountainCar-v0, after Moore (1990), Efficient Memory-based "
                        "Learning for Robot Control, University of Cambridge, UCAM-CL-TR-209",
              .observation = {{"position", kLeft, kRight}, {"velocity", -kMaxSpeed, kMaxSpeed}},
              .action = {{"push", 0, 2}},
              .actions = 3,
              .step = kNsPerSecond / 50,
              .max_steps = 200}) {}

 private:
  static constexpr double kForce = 0.001;
  static constexpr double kGravity = 0.0025;
  static constexpr double kMaxSpeed = 0.07;
  static constexpr double kLeft = -1.2;
  static constexpr double kRight = 0.6;
  static constexpr double kGoal = 0.5;

  State start() override { return {random_.uniform(-0.6, -0.4), 0}; }

  Outcome advance(double action) override {
    auto& [position, velocity] = state_;
    velocity += (action - 1) * kForce + std::cos(3 * position) * -kGravity;
    velocity = std::clamp(velocity, -kMaxSpeed, kMaxSpeed);
    position = std::clamp(position + velocity, kLeft, kRight);
    if (position == kLeft && velocity < 0) {
      velocity = 0;
    }
    const bool reached = position >= kGoal && velocity >= 0;
    return {.reward = -1, .terminated = reached, .success = reached};
  }
};

}  // namespace

std::unique_ptr<Environment> make_mountain_car(const Options& /*options*/) {
  return std::make_unique<MountainCar>();
}

}  // namespace spikeloop::environments
