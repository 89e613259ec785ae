// A Morris water maze.
#include <cmath>
#include <iterator>
#include <numbers>

#include "base.hpp"

namespace spikeloop::environments {
namespace {

class WaterMaze final : public Base<2> {
 public:
  WaterMaze()
      : Base({.name = "water_maze",
              .text = "A Morris water maze: a swimmer in a round pool of radius 1 m searches a "
                      "hidden platform of radius 0.1 m at x = y = 0.35 m; start north, east, south "
                      "or west at the wall (action: heading, 0 rad is east; 0.2 m/s; Gymnasium has "
                      "no water maze)",
              .source = "The task: Morris (1984), J. Neurosci. Methods 11:47-60. Tasks like it, "
                        "learnt by spiking neurons: Vasilaki et al. (2009), PLoS Comput. Biol. "
                        "5:e1000586; Frémaux et al. (2013), PLoS Comput. Biol. 9:e1003024. Sizes "
                        "and speed are Spikeloop's",
              .observation = {{"x_m", -kPool, kPool}, {"y_m", -kPool, kPool}},
              .action = {{"heading_rad", -std::numbers::pi, std::numbers::pi}},
              .actions = 0,
              .step = kNsPerSecond / 10,
              .max_steps = 600}) {}

 private:
  static constexpr double kPool = 1;
  static constexpr double kPlatform = 0.1;
  /// Near the middle of the north-east quadrant.
  static constexpr double kPlatformX = 0.35;
  static constexpr double kPlatformY = 0.35;
  static constexpr double kSpeed = 0.2;
  static constexpr double kStep = 0.1;

  State start() override {
    constexpr State kPlaces[] = {{0, kPool}, {kPool, 0}, {0, -kPool}, {-kPool, 0}};
    return kPlaces[random_.choice(std::size(kPlaces))];
  }

  Outcome advance(double heading) override {
    auto& [x, y] = state_;
    x += kSpeed * kStep * std::cos(heading);
    y += kSpeed * kStep * std::sin(heading);
    const double distance = std::hypot(x, y);
    if (distance > kPool) {
      x *= kPool / distance;
      y *= kPool / distance;
    }
    const bool reached = std::hypot(x - kPlatformX, y - kPlatformY) <= kPlatform;
    return {.reward = reached ? 1.0 : 0.0, .terminated = reached, .success = reached};
  }
};

}  // namespace

std::unique_ptr<Environment> make_water_maze(const Options& /*options*/) {
  return std::make_unique<WaterMaze>();
}

}  // namespace spikeloop::environments
