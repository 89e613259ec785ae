#include "spikeloop/pictures/camera.hpp"

#include <cmath>
#include <numbers>

#include "offscreen_scene.hpp"

namespace spikeloop::pictures {
namespace {

double half_width_at_1(const CameraOptions& options) {
  return std::tan(options.field_of_view_deg * std::numbers::pi / 360);
}

// Before a scene is made: a vehicle without camera is no matter of OpenGL.
const vehicle::Vehicle& with_camera(const vehicle::Vehicle& vehicle) {
  robot_camera(vehicle);
  return vehicle;
}

}  // namespace

class Camera::Impl {
 public:
  Impl(const vehicle::Vehicle& vehicle, const CameraOptions& options)
      : tangent_(half_width_at_1(options)),
        state_(with_camera(vehicle)),
        image_{options.size, {}},
        scene_(vehicle, {.buffer = options.size, .samples = 4, .shadows = false}) {}

  const Image& look(const vehicle::Vehicle& vehicle) {
    state_.take(vehicle);
    scene_.use([&](Scene& scene) {
      scene.set(state_);
      scene.draw_camera(
          {0, 0, static_cast<int>(image_.size.width), static_cast<int>(image_.size.height)},
          tangent_);
      scene.read(image_);
    });
    return image_;
  }

 private:
  double tangent_;
  State state_;
  Image image_;
  OffscreenScene scene_;
};

Camera::Camera(const vehicle::Vehicle& vehicle, const CameraOptions& options)
    : impl_(std::make_unique<Impl>(vehicle, options)) {}
Camera::~Camera() = default;
Camera::Camera(Camera&&) noexcept = default;
Camera& Camera::operator=(Camera&&) noexcept = default;

const Image& Camera::look(const vehicle::Vehicle& vehicle) {
  return impl_->look(vehicle);
}

double focal_length(const CameraOptions& options) {
  return 0.5 * options.size.width / half_width_at_1(options);
}

}  // namespace spikeloop::pictures
