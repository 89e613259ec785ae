// A scene with an OpenGL context of its own, that no display is needed for.
#pragma once

#include <memory>

#include "offscreen.hpp"
#include "scene.hpp"

namespace spikeloop::pictures {

class OffscreenScene {
 public:
  OffscreenScene(const vehicle::Simulation& robot, const SceneOptions& options) {
    const Offscreen::Current current(context_);
    scene_ = std::make_unique<Scene>(robot, options);
  }
  ~OffscreenScene() {
    try {
      const Offscreen::Current current(context_);
      scene_.reset();
    } catch (const std::exception&) {
      scene_.release();  // it cannot be undone without its context
    }
  }
  OffscreenScene(const OffscreenScene&) = delete;
  OffscreenScene& operator=(const OffscreenScene&) = delete;

  template <typename Work>
  void use(Work&& work) {
    const Offscreen::Current current(context_);
    work(*scene_);
  }

 private:
  Offscreen context_;
  std::unique_ptr<Scene> scene_;
};

}  // namespace spikeloop::pictures
