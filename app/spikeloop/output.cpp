#include "output.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <string>
#include <thread>

#include "spikeloop/core/background.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/mpirun.hpp"

namespace spikeloop::app {

struct BackgroundOutput::Impl {
  static constexpr std::size_t kMost = 1'000'000;
  struct Piece {
    std::FILE* stream;
    std::string text;
  };

  void queue(std::FILE* stream, std::string_view text) {
    const std::lock_guard lock(mutex);
    if (bytes + text.size() <= kMost) {
      bytes += text.size();
      pieces.push_back({stream, std::string(text)});
      wake.notify_one();
    }
  }

  void run() {
    std::unique_lock lock(mutex);
    while (true) {
      wake.wait(lock, [this] { return ended || !pieces.empty(); });
      if (pieces.empty()) {
        return;
      }
      const Piece piece = std::move(pieces.front());
      pieces.pop_front();
      bytes -= piece.text.size();
      lock.unlock();
      std::fwrite(piece.text.data(), 1, piece.text.size(), piece.stream);
      std::fflush(piece.stream);
      lock.lock();
    }
  }

  std::mutex mutex;
  std::condition_variable wake;
  std::deque<Piece> pieces;
  std::size_t bytes = 0;
  bool ended = false;
  std::thread thread = background_thread([this] { run(); });
};

namespace {

/// Protects `background`: a thread can print while the BackgroundOutput ends.
std::mutex background_mutex;
BackgroundOutput::Impl* background = nullptr;

/// False if no BackgroundOutput exists.
bool queue_in_background(std::FILE* stream, std::string_view text) {
  const std::lock_guard lock(background_mutex);
  if (background == nullptr) {
    return false;
  }
  background->queue(stream, text);
  return true;
}

}  // namespace

BackgroundOutput::BackgroundOutput() {
  impl_ = std::make_unique<Impl>();
  const std::lock_guard lock(background_mutex);
  background = impl_.get();
}

BackgroundOutput::~BackgroundOutput() {
  {
    const std::lock_guard lock(background_mutex);
    background = nullptr;
  }
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->ended = true;
  }
  impl_->wake.notify_one();
  impl_->thread.join();
}

void put(std::FILE* stream, std::string_view text) noexcept {
  try {
    if (queue_in_background(stream, text)) {
      return;
    }
  } catch (const std::bad_alloc&) {
    return;  // like text that cannot be written
  }
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
}

bool feed(const std::vector<std::string>& words, std::string_view text) {
  std::FILE* const program = ::popen(launch::shell_text(words).c_str(), "w");
  if (program == nullptr) {
    return false;
  }
  const bool taken = std::fwrite(text.data(), 1, text.size(), program) == text.size();
  return ::pclose(program) == 0 && taken;
}

std::string count_of(std::uint64_t number, std::string_view what) {
  return fmt::format("{} {}{}", number, what, number == 1 ? "" : "s");
}

void put_result(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    if (errno == EPIPE) {  // the reader, such as head, has enough
      std::_Exit(128 + SIGPIPE);
    }
    throw FileError("write", "standard output", errno);
  }
}

}  // namespace spikeloop::app
