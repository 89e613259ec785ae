// A window on the simulated world.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "spikeloop/vehicle/simulation.hpp"

namespace spikeloop::pictures {

/// Draws in a thread of its own, as often as the machine can: the simulation waits for no picture.
/// The mouse turns (left button), moves (right) and zooms (wheel); Tab goes from one view to the
/// next. Closed by its user, it stays closed.
class Window {
 public:
  /// @throws TransportError when there is no display, no GLFW or no OpenGL.
  Window(const vehicle::Simulation& robot, const std::string& title);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// The vehicle has moved: copies its state when the one before has been drawn.
  void show(const vehicle::Simulation& robot);
  std::uint64_t pictures() const;  ///< drawn so far
  bool open() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::pictures
