#include "spikeloop/pictures/film.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <optional>

#include "offscreen_scene.hpp"
#include "spikeloop/core/error.hpp"
#include "video.hpp"

namespace spikeloop::pictures {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::pair<std::string_view, View>, 3> kViews{
    {{"above", View::above}, {"chase", View::chase}, {"camera", View::camera}}};
constexpr std::uint32_t kLargest = 4096;   // pixels, each way
constexpr double kCameraHalfWidth = 0.84;  // at distance 1: 80 degrees from edge to edge

enum class Kind { frames, last, video };

Kind kind_of(const std::string& path) {
  const std::string extension = fs::path(path).extension().string();
  if (extension == ".png") return Kind::last;
  if (extension == ".mp4" || extension == ".webm" || extension == ".mkv" || extension == ".gif") {
    return Kind::video;
  }
  if (!extension.empty()) {
    throw ConfigurationError(
        fmt::format("cannot write '{}': no film has the ending '{}'; write .mp4, .webm, .mkv or "
                    ".gif, .png for a "
                    "picture of the end, or a directory's name for single pictures",
                    path, extension));
  }
  return Kind::frames;
}

void make_empty_directory(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw FileError("make directory", path, error.value());
  for (const auto& entry : fs::directory_iterator(path)) {
    if (entry.path().filename().string().starts_with("frame_")) {
      throw FileError(
          fmt::format("cannot write pictures into '{}': it has '{}' already; remove "
                      "them, or write another directory",
                      path, entry.path().filename().string()));
    }
  }
}

/// The picture of the final state is written after the drive: too late to report that it cannot be
/// written.
void try_to_write(const std::string& path) {
  const fs::path folder = fs::absolute(path).parent_path();
  if (::access(folder.c_str(), W_OK | X_OK) != 0) throw FileError("write", path, errno);
  if (fs::is_directory(path)) throw FileError("write", path, EISDIR);
}

std::uint32_t pixels(std::string_view text, std::string_view whole) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 1 || value > kLargest) {
    throw ConfigurationError(
        fmt::format("'{}' is not a size of a picture; write WIDTHxHEIGHT in pixels, at most {} "
                    "each, as 960x720",
                    whole, kLargest));
  }
  return value;
}

}  // namespace

std::vector<View> views_named(std::string_view names) {
  std::vector<View> views;
  for (std::size_t begin = 0; begin <= names.size();) {
    const std::size_t end = std::min(names.find('+', begin), names.size());
    const std::string_view name = names.substr(begin, end - begin);
    const auto* found =
        std::ranges::find(kViews, name, [](const auto& view) { return view.first; });
    if (found == kViews.end()) {
      throw ConfigurationError(fmt::format(
          "unknown view '{}'; write above, chase, camera, or several of them as above+chase",
          name));
    }
    views.push_back(found->second);
    begin = end + 1;
  }
  return views;
}

Size size_named(std::string_view text) {
  const std::size_t cross = std::min(text.find('x'), text.size());
  const std::string_view height = cross == text.size() ? "" : text.substr(cross + 1);
  return {pixels(text.substr(0, cross), text), pixels(height, text)};
}

class Film::Impl {
 public:
  Impl(const vehicle::Simulation& robot, const FilmOptions& options)
      : options_(options), kind_(kind_of(options.path)), state_(robot) {
    if (std::ranges::count(options.views, View::camera) > 0) {
      camera_ = camera_id(robot, options.camera);
    }
    scene_.emplace(robot, SceneOptions{.buffer = options.size});
    image_.size = options.size;
    if (kind_ == Kind::last) try_to_write(options.path);
    if (kind_ == Kind::frames) make_empty_directory(options.path);
    if (kind_ == Kind::video) video_.emplace(options.path, options.size, options.rate_hz);
    scene_->use([&](Scene& scene) {
      for (const View view : options.views) cameras_.push_back(scene.camera(view, aspect()));
    });
  }

  void take(const vehicle::Simulation& robot) {
    if (robot.time() < next()) return;
    state_.take(robot);
    trail_.go_on(state_.pose);
    if (kind_ != Kind::last) {
      draw();
      write();
    }
    // Pictures that a long step has passed are those that hold until now.
    ++count_;
  }

  TimeNs next() const { return std::llround(static_cast<double>(count_) * 1e9 / options_.rate_hz); }

  void finish(const vehicle::Simulation& robot) {
    if (finished_) return;
    finished_ = true;
    if (kind_ == Kind::last) {
      state_.take(robot);
      trail_.go_on(state_.pose);
      draw();
      write_png(options_.path, image_);
    }
    if (video_) video_->finish();
  }

 private:
  int width_of_view() const {
    return static_cast<int>(options_.size.width / options_.views.size());
  }
  double aspect() const {
    return static_cast<double>(width_of_view()) / static_cast<double>(options_.size.height);
  }

  void draw() {
    scene_->use([&](Scene& scene) {
      scene.set(state_);
      for (std::size_t i = 0; i < options_.views.size(); ++i) {
        const mjrRect where{static_cast<int>(i) * width_of_view(), 0, width_of_view(),
                            static_cast<int>(options_.size.height)};
        const View view = options_.views[i];
        scene.follow(view, cameras_[i]);
        if (view == View::camera) {
          scene.draw_camera(where, camera_, kCameraHalfWidth);
        } else {
          scene.draw(where, cameras_[i], &trail_);
        }
      }
      scene.read(image_);
    });
  }

  void write() {
    if (video_) {
      video_->write(image_);
    } else {
      write_png((fs::path(options_.path) / fmt::format("frame_{:06}.png", count_ + 1)).string(),
                image_);
    }
  }

  FilmOptions options_;
  Kind kind_;
  State state_;
  Trail trail_;
  int camera_ = -1;  // for View::camera
  Image image_;
  std::optional<OffscreenScene> scene_;
  std::vector<mjvCamera> cameras_;
  std::optional<Video> video_;
  std::uint64_t count_ = 0;
  bool finished_ = false;
};

Film::Film(const vehicle::Simulation& robot, const FilmOptions& options)
    : impl_(std::make_unique<Impl>(robot, options)) {}
Film::~Film() = default;
Film::Film(Film&&) noexcept = default;
Film& Film::operator=(Film&&) noexcept = default;

void Film::take(const vehicle::Simulation& robot) {
  impl_->take(robot);
}
TimeNs Film::next() const {
  return impl_->next();
}
void Film::finish(const vehicle::Simulation& robot) {
  impl_->finish(robot);
}

}  // namespace spikeloop::pictures
