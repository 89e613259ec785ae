#include "offscreen.hpp"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>

#include <mutex>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/open_library.hpp"

namespace spikeloop::pictures {
namespace {

constexpr const char* kRemedy =
    "install Mesa's drivers:  apt-get install libegl1 libgl1 libgl1-mesa-dri";

[[noreturn]] void refuse_egl(const char* step, EGLint error) {
  throw TransportError(fmt::format(
      "cannot draw without a display: {} failed with EGL error {:#x}; {}", step, error, kRemedy));
}

}  // namespace

/// EGL has one display of a kind in a process, and ending it ends everybody's contexts.
class Offscreen::Display {
 public:
  Display() : library_("libEGL.so.1", "draw without a display", kRemedy) {
    const auto get_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
        library_.function<decltype(&eglGetProcAddress)>("eglGetProcAddress")(
            "eglGetPlatformDisplayEXT"));
    if (get_display == nullptr) refuse_egl("eglGetPlatformDisplayEXT", EGL_NOT_INITIALIZED);
    display_ = get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    const auto initialize = library_.function<decltype(&eglInitialize)>("eglInitialize");
    if (display_ == EGL_NO_DISPLAY || initialize(display_, nullptr, nullptr) == EGL_FALSE) {
      refuse_egl("eglInitialize", error());
    }
    const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                             EGL_NONE};
    EGLint found = 0;
    const auto choose = library_.function<decltype(&eglChooseConfig)>("eglChooseConfig");
    if (choose(display_, wanted, &config_, 1, &found) == EGL_FALSE || found == 0) {
      refuse_egl("eglChooseConfig", error());
    }
    make_current_ = library_.function<decltype(&eglMakeCurrent)>("eglMakeCurrent");
    destroy_ = library_.function<decltype(&eglDestroyContext)>("eglDestroyContext");
  }

  static std::shared_ptr<const Display> shared() {
    static std::mutex mutex;
    static std::shared_ptr<const Display> display;  // stays: Mesa's threads belong to it
    const std::lock_guard lock(mutex);
    if (!display) display = std::make_shared<const Display>();
    return display;
  }

  EGLContext make_context() const {
    // A thread's own choice; without it contexts are those of OpenGL ES.
    const auto bind = library_.function<decltype(&eglBindAPI)>("eglBindAPI");
    if (bind(EGL_OPENGL_API) == EGL_FALSE) refuse_egl("eglBindAPI", error());
    const auto create = library_.function<decltype(&eglCreateContext)>("eglCreateContext");
    const EGLContext context = create(display_, config_, EGL_NO_CONTEXT, nullptr);
    if (context == EGL_NO_CONTEXT) refuse_egl("eglCreateContext", error());
    return context;
  }
  void destroy(EGLContext context) const { destroy_(display_, context); }
  bool make_current(EGLContext context) const {
    return make_current_(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE;
  }
  EGLint error() const { return library_.function<decltype(&eglGetError)>("eglGetError")(); }

 private:
  OpenLibrary library_;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLConfig config_ = nullptr;
  decltype(&eglMakeCurrent) make_current_ = nullptr;
  decltype(&eglDestroyContext) destroy_ = nullptr;
};

Offscreen::Offscreen() : display_(Display::shared()), context_(display_->make_context()) {}

Offscreen::~Offscreen() {
  display_->destroy(context_);
}

Offscreen::Current::Current(const Offscreen& context) : context_(context) {
  if (!context.display_->make_current(context.context_)) {
    refuse_egl("eglMakeCurrent", context.display_->error());
  }
}

Offscreen::Current::~Current() {
  context_.display_->make_current(EGL_NO_CONTEXT);
}

}  // namespace spikeloop::pictures
