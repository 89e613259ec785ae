// OpenGL without a display: EGL on no surface, which Mesa draws on the processor where there is no
// graphics card.
#pragma once

#include <memory>

namespace spikeloop::pictures {

class Offscreen {
 public:
  /// @throws TransportError when EGL, or a driver for it, is missing.
  Offscreen();
  ~Offscreen();
  Offscreen(const Offscreen&) = delete;
  Offscreen& operator=(const Offscreen&) = delete;

  /// While one lives, this thread's OpenGL calls go here. One at a time in a thread.
  class Current {
   public:
    explicit Current(const Offscreen& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    const Offscreen& context_;
  };

 private:
  class Display;
  std::shared_ptr<const Display> display_;
  void* context_ = nullptr;
};

}  // namespace spikeloop::pictures
