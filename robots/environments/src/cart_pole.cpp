// Gymnasium's CartPole-v1: the same operations in the same order. Sine and cosine are the C
// library's, as in Gymnasium until it took NumPy's, whose last digit can differ.
#include <cmath>
#include <numbers>

#include "base.hpp"

namespace spikeloop::environments {
namespace {

class CartPole final : public Base<4> {
 public:
  /// The ranges of position and angle are those within which an episode goes on: the observation
  /// that ends it is outside, by a step at most. Those of the velocities, which have no bounds,
  /// hold in nearly all episodes.
  CartPole()
      : Base({.name = "cart_pole",
              .text = "A cart balances a pole (action: 0 push left, 1 push right)",
              .source = "Gymnasium's CartPole-v1, after Barto, Sutton & Anderson (1983), IEEE "
                        "Trans. Syst. Man Cybern. SMC-13:834-846",
              .observation = {{"position_m", -kMaxPosition, kMaxPosition},
                              {"velocity_m_s", -3, 3},
                              {"angle_rad", -kMaxAngle, kMaxAngle},
                              {"angular_velocity_rad_s", -3.5, 3.5}},
              .action = {{"push", 0, 1}},
              .actions = 2,
              .step = kNsPerSecond / 50,
              .max_steps = 500,
              .lasts = true}) {}

 private:
  static constexpr double kGravity = 9.8;
  static constexpr double kMassOfPole = 0.1;
  static constexpr double kMass = kMassOfPole + 1.0;
  static constexpr double kHalfLength = 0.5;
  static constexpr double kForce = 10;
  static constexpr double kStep = 0.02;
  static constexpr double kMaxPosition = 2.4;
  static constexpr double kMaxAngle = 12 * 2 * std::numbers::pi / 360;

  State start() override {
    State state;
    for (double& value : state) {
      value = random_.uniform(-0.05, 0.05);
    }
    return state;
  }

  Outcome advance(double action) override {
    auto& [x, v, angle, w] = state_;
    const double force = action == 1 ? kForce : -kForce;
    const double cosine = std::cos(angle);
    const double sine = std::sin(angle);
    constexpr double kMoment = kMassOfPole * kHalfLength;
    const double push = (force + kMoment * (w * w) * sine) / kMass;
    const double angular_acceleration =
        (kGravity * sine - cosine * push) /
        (kHalfLength * (4.0 / 3.0 - kMassOfPole * (cosine * cosine) / kMass));
    const double acceleration = push - kMoment * angular_acceleration * cosine / kMass;
    x += kStep * v;
    v += kStep * acceleration;
    angle += kStep * w;
    w += kStep * angular_acceleration;
    const bool fallen = std::abs(x) > kMaxPosition || std::abs(angle) > kMaxAngle;
    return {.reward = 1, .terminated = fallen, .success = false};
  }
};

}  // namespace

std::unique_ptr<Environment> make_cart_pole(const Options& /*options*/) {
  return std::make_unique<CartPole>();
}

}  // namespace spikeloop::environments
