// A camera on the robot.
#pragma once

#include <memory>
#include <string>

#include "spikeloop/pictures/image.hpp"
#include "spikeloop/vehicle/simulation.hpp"

namespace spikeloop::pictures {

struct CameraOptions {
  Size size{64, 48};
  double rate_hz = 20;
  double field_of_view_deg = 80;  ///< from the left to the right edge
  std::string name = "camera";    ///< of the world's <camera>
};

/// A pinhole camera at a camera of the world, drawn off screen by OpenGL: with the world's
/// lights and materials, without shadows. The same world and state give the same bytes with the
/// same Mesa on the same kind of processor. No other object's state is changed.
class Camera {
 public:
  /// @throws ConfigurationError when the world has no such camera; TransportError when OpenGL
  /// without a display (EGL) is missing.
  Camera(const vehicle::Simulation& robot, const CameraOptions& options);
  ~Camera();
  Camera(Camera&&) noexcept;
  Camera& operator=(Camera&&) noexcept;

  /// What it sees now. Holds until the next call. `robot` is the one it was made for.
  const Image& look(const vehicle::Simulation& robot);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Number of a camera in the model. @throws ConfigurationError when there is none of that name.
int camera_id(const vehicle::Simulation& robot, const std::string& name);

/// Focal length in pixels: a thing at angle a to the right of the axis is f tan(a) right of the
/// middle of the picture. Pixels are square.
double focal_length(const CameraOptions& options);

}  // namespace spikeloop::pictures
