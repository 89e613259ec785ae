#include "spikeloop/robot/spectators.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace spikeloop::robot {

SpectatorOptions SpectatorWords::options() const {
  SpectatorOptions options;
  options.window = window;
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
