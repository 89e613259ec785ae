// Printing that never ends a run, nor holds it up.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace spikeloop::app {

/// Whoever reads our output may have gone, or the disk be full: what cannot be written is left out.
void put(std::FILE* stream, std::string_view text) noexcept;

/// For output that somebody asked for, as a file. @throws FileError when it cannot be written.
void put_result(std::string_view text);

/// Whether the program, run in a shell's way, took the text at its standard input and ended with 0.
bool feed(const std::vector<std::string>& words, std::string_view text);

/// "1 spike", "2 spikes".
std::string count_of(std::uint64_t number, std::string_view what);

/// While it lives, put() only queues, and a thread writes: a terminal that is held (Ctrl-S) or a
/// pipe that nobody reads must not keep the launcher from its job. What is queued beyond 1 MB is
/// left out. Its end waits until all is written.
class BackgroundOutput {
 public:
  BackgroundOutput();
  ~BackgroundOutput();
  BackgroundOutput(const BackgroundOutput&) = delete;
  BackgroundOutput& operator=(const BackgroundOutput&) = delete;

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::app
