// Who watches a drive: a film, a window.
#pragma once

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "spikeloop/pictures/film.hpp"
#include "spikeloop/pictures/window.hpp"
#include "spikeloop/vehicle/simulation.hpp"

namespace spikeloop::robot {

struct SpectatorOptions {
  std::optional<pictures::FilmOptions> film{};
  bool window = false;
};

/// The same as a command line says it.
struct SpectatorWords {
  std::string render{};  ///< a path, as pictures::FilmOptions has it; empty: no film
  std::string view = "above";
  std::string size = "960x720";
  double rate_hz = 25;
  bool window = false;

  bool any() const { return window || !render.empty(); }
  /// @throws ConfigurationError: no such view, no size.
  SpectatorOptions options() const;
  /// For the command line of spikeloop-robot, which may run in another directory.
  std::vector<std::string> arguments() const;
};

/// What they see changes nothing.
class Spectators {
 public:
  /// @throws Error as pictures::Film and pictures::Window.
  Spectators(const vehicle::Simulation& robot, const SpectatorOptions& options) {
    if (options.window) window_ = std::make_unique<pictures::Window>(robot, "Spikeloop");
    if (options.film) film_.emplace(robot, *options.film);
    look(robot);
  }

  /// After the robot has moved.
  void look(const vehicle::Simulation& robot) {
    if (film_) film_->take(robot);
    if (window_) window_->show(robot);
  }
  /// When they want to look next.
  TimeNs next() const { return film_ ? film_->next() : std::numeric_limits<TimeNs>::max(); }
  /// @throws FileError.
  void finish(const vehicle::Simulation& robot) {
    if (film_) film_->finish(robot);
  }

 private:
  std::unique_ptr<pictures::Window> window_;
  std::optional<pictures::Film> film_;
};

}  // namespace spikeloop::robot
