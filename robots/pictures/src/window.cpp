#include "spikeloop/pictures/window.hpp"

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <future>
#include <mutex>
#include <optional>
#include <thread>

#include "scene.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/open_library.hpp"

namespace spikeloop::pictures {
namespace {

constexpr int kWidth = 960;
constexpr int kHeight = 720;
constexpr std::chrono::milliseconds kEvents{30};  // how often the mouse is heard at rest

const char* display_name() {
  for (const char* variable : {"DISPLAY", "WAYLAND_DISPLAY"}) {
    const char* value = std::getenv(variable);
    if (value != nullptr && *value != '\0') return value;
  }
  return nullptr;
}

/// The functions of GLFW that are used here.
struct Glfw {
  OpenLibrary library{"libglfw.so.3", "open a window", "install it:  apt-get install libglfw3"};
#define SPIKELOOP_GLFW(name) decltype(&::name) name = library.function<decltype(&::name)>(#name)
  SPIKELOOP_GLFW(glfwInit);
  SPIKELOOP_GLFW(glfwGetError);
  SPIKELOOP_GLFW(glfwWindowHint);
  SPIKELOOP_GLFW(glfwCreateWindow);
  SPIKELOOP_GLFW(glfwDestroyWindow);
  SPIKELOOP_GLFW(glfwMakeContextCurrent);
  SPIKELOOP_GLFW(glfwSwapInterval);
  SPIKELOOP_GLFW(glfwSwapBuffers);
  SPIKELOOP_GLFW(glfwPollEvents);
  SPIKELOOP_GLFW(glfwWindowShouldClose);
  SPIKELOOP_GLFW(glfwGetFramebufferSize);
  SPIKELOOP_GLFW(glfwGetCursorPos);
  SPIKELOOP_GLFW(glfwGetMouseButton);
  SPIKELOOP_GLFW(glfwSetScrollCallback);
  SPIKELOOP_GLFW(glfwSetKeyCallback);
  SPIKELOOP_GLFW(glfwSetWindowUserPointer);
  SPIKELOOP_GLFW(glfwGetWindowUserPointer);
#undef SPIKELOOP_GLFW

  std::string why() const {
    const char* text = nullptr;
    glfwGetError(&text);
    return text == nullptr ? "no reason given" : text;
  }
};

/// What mouse and keys have asked for; GLFW's callbacks find it through the window.
struct Wishes {
  double zoom = 0;
  int views = 0;
};

}  // namespace

class Window::Impl {
 public:
  Impl(const vehicle::Simulation& robot, const std::string& title) : newest_(robot) {
    if (display_name() == nullptr) {
      throw TransportError(
          "cannot open a window: there is no display (DISPLAY is not set); leave --view out, or "
          "write  --render FILE.mp4  for a film");
    }
    std::promise<void> opened;
    auto result = opened.get_future();
    thread_ = std::thread([this, &robot, title, &opened] {
      try {
        Picture picture(robot, title);
        open_ = true;
        opened.set_value();
        run(picture);
      } catch (...) {
        if (!open_) opened.set_exception(std::current_exception());
      }
      open_ = false;
    });
    try {
      result.get();
    } catch (...) {
      thread_.join();
      throw;
    }
  }

  ~Impl() {
    stop_ = true;
    come_.notify_one();
    if (thread_.joinable()) thread_.join();
  }

  void show(const vehicle::Simulation& robot) {
    if (!open_ || !drawn_) return;
    {
      const std::lock_guard lock(mutex_);
      newest_.take(robot);
      drawn_ = false;
    }
    come_.notify_one();
  }

  std::uint64_t pictures() const { return pictures_; }
  bool open() const { return open_; }

 private:
  /// Window and scene, of the thread that draws.
  class Picture {
   public:
    Picture(const vehicle::Simulation& robot, const std::string& title) {
      if (glfw_.glfwInit() == GLFW_FALSE) refuse();
      glfw_.glfwWindowHint(GLFW_SAMPLES, 4);
      window_ = glfw_.glfwCreateWindow(kWidth, kHeight, title.c_str(), nullptr, nullptr);
      if (window_ == nullptr) refuse();
      glfw_.glfwMakeContextCurrent(window_);
      glfw_.glfwSwapInterval(1);
      glfw_.glfwSetWindowUserPointer(window_, &wishes_);
      listen();
      scene_.emplace(robot, SceneOptions{.buffer = {kWidth, kHeight}, .samples = 0});
      mjr_setBuffer(mjFB_WINDOW, const_cast<mjrContext*>(&scene_->context()));
      look_from(View::above);
    }
    ~Picture() {
      scene_.reset();
      if (window_ != nullptr) glfw_.glfwDestroyWindow(window_);
    }
    Picture(const Picture&) = delete;
    Picture& operator=(const Picture&) = delete;

    bool closed() const { return glfw_.glfwWindowShouldClose(window_) != 0; }

    void draw(const State& state, const Trail& trail) {
      glfw_.glfwPollEvents();
      scene_->set(state);
      obey();
      int width = 0;
      int height = 0;
      glfw_.glfwGetFramebufferSize(window_, &width, &height);
      if (width > 0 && height > 0) {
        const mjrRect where{0, 0, width, height};
        scene_->follow(view_, camera_);
        scene_->draw(where, camera_, &trail);
        scene_->write(where, fmt::format("{:.1f} s", to_seconds(state.time)));
      }
      glfw_.glfwSwapBuffers(window_);
    }

   private:
    [[noreturn]] void refuse() const {
      throw TransportError(
          fmt::format("cannot open a window on display '{}': {}; leave --view out, "
                      "or write  --render FILE.mp4  for a film",
                      display_name(), glfw_.why()));
    }

    void listen() {
      // Callbacks have no object: the functions that they need are found once more.
      static const auto wishes_of = glfw_.glfwGetWindowUserPointer;
      glfw_.glfwSetScrollCallback(window_, [](GLFWwindow* window, double, double y) {
        static_cast<Wishes*>(wishes_of(window))->zoom += y;
      });
      glfw_.glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
        if (key == GLFW_KEY_TAB && action == GLFW_PRESS) {
          ++static_cast<Wishes*>(wishes_of(window))->views;
        }
      });
    }

    void look_from(View view) {
      view_ = view;
      camera_ = scene_->camera(view, static_cast<double>(kWidth) / kHeight);
    }

    void obey() {
      for (; wishes_.views > 0; --wishes_.views) {
        look_from(view_ == View::above ? View::chase : View::above);
      }
      double x = 0;
      double y = 0;
      glfw_.glfwGetCursorPos(window_, &x, &y);
      const auto pressed = [&](int button) {
        return glfw_.glfwGetMouseButton(window_, button) == GLFW_PRESS;
      };
      const double right = (x - x_) / kHeight;
      const double down = (y - y_) / kHeight;
      if (pressed(GLFW_MOUSE_BUTTON_LEFT)) move(mjMOUSE_ROTATE_H, right, down);
      if (pressed(GLFW_MOUSE_BUTTON_LEFT)) move(mjMOUSE_ROTATE_V, right, down);
      if (pressed(GLFW_MOUSE_BUTTON_RIGHT)) move(mjMOUSE_MOVE_H, right, down);
      if (wishes_.zoom != 0) move(mjMOUSE_ZOOM, 0, -0.05 * wishes_.zoom);
      wishes_.zoom = 0;
      x_ = x;
      y_ = y;
    }

    void move(int action, double right, double down) {
      mjv_moveCamera(&scene_->model(), action, right, down, &scene_->abstract(), &camera_);
    }

    Glfw glfw_;
    GLFWwindow* window_ = nullptr;
    Wishes wishes_;
    std::optional<Scene> scene_;
    View view_ = View::above;
    mjvCamera camera_{};
    double x_ = 0;
    double y_ = 0;
  };

  void run(Picture& picture) {
    State state = newest_;
    Trail trail;
    while (!stop_ && !picture.closed()) {
      {
        std::unique_lock lock(mutex_);
        come_.wait_for(lock, kEvents, [this] { return stop_ || !drawn_; });
        if (!drawn_) state = newest_;
        drawn_ = true;
      }
      trail.go_on(state.pose);
      picture.draw(state, trail);
      ++pictures_;
    }
  }

  std::mutex mutex_;
  std::condition_variable come_;
  State newest_;
  std::atomic<bool> drawn_{true};  // written under the mutex
  std::atomic<bool> stop_{false};
  std::atomic<bool> open_{false};
  std::atomic<std::uint64_t> pictures_{0};
  std::thread thread_;
};

Window::Window(const vehicle::Simulation& robot, const std::string& title)
    : impl_(std::make_unique<Impl>(robot, title)) {}
Window::~Window() = default;

void Window::show(const vehicle::Simulation& robot) {
  impl_->show(robot);
}
std::uint64_t Window::pictures() const {
  return impl_->pictures();
}
bool Window::open() const {
  return impl_->open();
}

}  // namespace spikeloop::pictures
