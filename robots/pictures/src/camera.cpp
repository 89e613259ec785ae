#include "spikeloop/pictures/camera.hpp"

#include <cmath>
#include <numbers>

#include "offscreen_scene.hpp"

namespace spikeloop::pictures {
namespace {

double half_width_at_1(const CameraOptions& options) {
  return std::tan(options.field_of_view_deg * std::numbers::pi / 360);
}

}  // namespace

class Camera::Impl {
 public:
  Impl(const vehicle::Simulation& robot, const CameraOptions& options)
      : tangent_(half_width_at_1(options)),
        id_(camera_id(robot, options.name)),  // first: a missing camera is no matter of OpenGL
        state_(robot),
        image_{options.size, {}},
        scene_(robot, {.buffer = options.size, .samples = 4, .shadows = false}) {}

  const Image& look(const vehicle::Simulation& robot) {
    state_.take(robot);
    scene_.use([&](Scene& scene) {
      scene.set(state_);
      scene.draw_camera(
          {0, 0, static_cast<int>(image_.size.width), static_cast<int>(image_.size.height)}, id_,
          tangent_);
      scene.read(image_);
    });
    return image_;
  }

 private:
  double tangent_;
  int id_;
  State state_;
  Image image_;
  OffscreenScene scene_;
};

Camera::Camera(const vehicle::Simulation& robot, const CameraOptions& options)
    : impl_(std::make_unique<Impl>(robot, options)) {}
Camera::~Camera() = default;
Camera::Camera(Camera&&) noexcept = default;
Camera& Camera::operator=(Camera&&) noexcept = default;

const Image& Camera::look(const vehicle::Simulation& robot) {
  return impl_->look(robot);
}

double focal_length(const CameraOptions& options) {
  return 0.5 * options.size.width / half_width_at_1(options);
}

}  // namespace spikeloop::pictures
