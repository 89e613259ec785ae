#include "video.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"

extern char** environ;

namespace spikeloop::pictures {
namespace {

std::vector<std::string> arguments_for(const std::string& path, const Size& size, double rate_hz) {
  std::vector<std::string> arguments{"ffmpeg",     "-loglevel",
                                     "error",      "-y",
                                     "-f",         "rawvideo",
                                     "-pix_fmt",   "rgb24",
                                     "-s",         fmt::format("{}x{}", size.width, size.height),
                                     "-framerate", fmt::format("{}", rate_hz),
                                     "-i",         "-"};
  if (path.ends_with(".gif")) {
    arguments.insert(arguments.end(), {"-vf", "split[a][b];[a]palettegen[p];[b][p]paletteuse"});
  } else {  // players want half as many colours as pixels, so an even number of these
    arguments.insert(arguments.end(),
                     {"-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"});
  }
  // A name that begins with '-' is an option otherwise.
  arguments.push_back(path.find('/') == std::string::npos ? "./" + path : path);
  return arguments;
}

}  // namespace

// A socket, not a pipe: writing to one whose reader has died can be told not to signal.
Video::Video(const std::string& path, const Size& size, double rate_hz) : path_(path) {
  make_empty_file(path);  // ffmpeg would write to the target of a link
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw FileError("write", path, errno);
  }
  input_ = ends[0];
  auto arguments = arguments_for(path, size, rate_hz);
  std::vector<char*> pointers;
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  // Ctrl-C is for us: it ends a film that has its last picture and its index.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int error =
      ::posix_spawnp(&process_, "ffmpeg", &actions, &attributes, pointers.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  if (error != 0) {
    process_ = -1;
    ::close(input_);
    ::unlink(path.c_str());
    throw ConfigurationError(fmt::format(
        "cannot write '{}': ffmpeg, which makes films, is not installed; write a directory for "
        "single pictures, or install it:  apt-get install ffmpeg",
        path));
  }
}

Video::~Video() {
  if (input_ >= 0) ::close(input_);
  if (process_ > 0) ::waitpid(process_, nullptr, 0);
}

void Video::write(const Image& image) {
  for (std::size_t sent = 0; sent < image.rgb.size();) {
    const ssize_t count =
        ::send(input_, image.rgb.data() + sent, image.rgb.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail();
    sent += static_cast<std::size_t>(count);
  }
}

void Video::finish() {
  if (input_ < 0) return;
  ::close(input_);
  input_ = -1;
  int status = 0;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail();
}

void Video::fail() {
  throw FileError(
      fmt::format("cannot write '{}': ffmpeg has ended with an error, see above; write "
                  "another name, or a directory for single pictures",
                  path_));
}

}  // namespace spikeloop::pictures
