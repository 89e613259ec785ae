// Pictures to ffmpeg, which makes a film of them.
#pragma once

#include <sys/types.h>

#include <string>

#include "spikeloop/pictures/image.hpp"

namespace spikeloop::pictures {

class Video {
 public:
  /// @throws ConfigurationError when ffmpeg is not installed.
  Video(const std::string& path, const Size& size, double rate_hz);
  ~Video();
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  /// @throws FileError when ffmpeg has ended; it has said why on the screen.
  void write(const Image& image);
  /// Waits for ffmpeg. @throws FileError when it has failed.
  void finish();

 private:
  [[noreturn]] void fail();

  std::string path_;
  int input_ = -1;
  pid_t process_ = -1;
};

}  // namespace spikeloop::pictures
