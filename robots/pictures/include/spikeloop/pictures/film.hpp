// A drive as pictures in files.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "spikeloop/pictures/image.hpp"
#include "spikeloop/vehicle/simulation.hpp"

namespace spikeloop::pictures {

/// The whole arena from above; from behind the vehicle; what its camera sees.
enum class View { above, chase, camera };

struct FilmOptions {
  /// FILE.png: one picture, of the end. FILE.mp4, .webm, .mkv, .gif: a film, which ffmpeg writes.
  /// Another name: a directory of frame_000001.png and so on.
  std::string path;
  std::vector<View> views{View::above};  ///< side by side
  Size size{960, 720};                   ///< of a picture, for all views
  double rate_hz = 25;                   ///< pictures in a simulated second
  std::string camera = "camera";         ///< of View::camera
};

/// "above", "chase", "camera", or several joined by '+'. @throws ConfigurationError.
std::vector<View> views_named(std::string_view names);
/// "960x720". @throws ConfigurationError.
Size size_named(std::string_view text);

/// Draws the world with the path that the vehicle has come.
class Film {
 public:
  /// @throws ConfigurationError: no such kind of file, ffmpeg is not installed, the view of a
  /// camera that is not there; FileError when the directory cannot be made or has frames;
  /// TransportError when OpenGL without a display is missing.
  Film(const vehicle::Simulation& robot, const FilmOptions& options);
  /// What has been taken is finished.
  ~Film();
  Film(Film&&) noexcept;
  Film& operator=(Film&&) noexcept;

  /// Takes the picture that is due at the vehicle's time, if one is; otherwise does nothing.
  /// @throws FileError when it cannot be written.
  void take(const vehicle::Simulation& robot);
  /// When the next picture is due.
  TimeNs next() const;
  /// Ends the file; with FILE.png, takes the picture. @throws FileError.
  void finish(const vehicle::Simulation& robot);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::pictures
