#include "spikeloop/robot/spectators.hpp"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "spikeloop/core/error.hpp"

namespace spikeloop::robot {

SpectatorOptions SpectatorWords::options() const {
  SpectatorOptions options;
  options.window = window;
  if (std::isnan(rate_hz)) {
    throw ConfigurationError(
        "--render-rate is nan; write how many pictures a simulated second has");
  }
  if (!render.empty()) {
    options.film = pictures::FilmOptions{.path = render,
                                         .views = pictures::views_named(view),
                                         .size = pictures::size_named(size),
                                         .rate_hz = rate_hz};
  }
  return options;
}

std::vector<std::string> SpectatorWords::arguments() const {
  std::vector<std::string> result;
  if (!render.empty()) {
    result = {"--render=" + std::filesystem::absolute(render).string(), "--render-view=" + view,
              "--render-size=" + size, fmt::format("--render-rate={}", rate_hz)};
  }
  if (window) result.emplace_back("--view");
  return result;
}

}  // namespace spikeloop::robot
