// doomed_process MODE FILE: records one spike and one signal row a millisecond of simulated time.
//   steady  sends for ever, one tick about every 0.1 ms
//   waits   sends 500 ticks, says "sent", then waits; closes the file on SIGTERM
//   busy    as steady; closes the file on SIGTERM, wherever the loop is
//   broken  as full, but the disk goes away: every write fails
//   full    sends until files may not grow beyond 500 kB, as on a full disk, then reports
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <thread>

#include "spikeloop/record/recorder.hpp"
#include "steps.hpp"

namespace {

using namespace spikeloop;

record::Recorder* g_recorder = nullptr;

extern "C" void on_terminate(int) {
  _exit(g_recorder->flush_and_close_from_signal(20 * kNsPerSecond) ? 143 : 1);
}

struct Sinks {
  explicit Sinks(record::Recorder& recorder)
      : spikes(recorder.spike_sink("out", 7)), signal(recorder.signal_sink("value", 2, "m/s")) {}
  void send(TimeNs k) const {
    test::send_spikes(*spikes, test::tick(k), {test::nth_spike(k)});
    const auto value = static_cast<double>(k);
    test::send_signal(*signal, test::tick(k), {value, -value}, static_cast<std::uint64_t>(k + 1));
  }
  std::unique_ptr<Sink> spikes;
  std::unique_ptr<Sink> signal;
};

void pause_for(int microseconds) {
  std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
}

[[noreturn]] void send_for_ever(const Sinks& sinks) {
  for (TimeNs k = 0;; ++k) {
    sinks.send(k);
    if (k == 100) {
      fmt::print("sending\n");
      std::fflush(stdout);
    }
    pause_for(100);
  }
}

/// Puts a device that refuses every byte in the place of the open file.
void break_the_disk(const std::string& path) {
  const int device = ::open("/dev/full", O_RDWR);
  const auto target = std::filesystem::canonical(path);
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    if (std::filesystem::read_symlink(entry.path(), gone) == target) {
      ::dup2(device, std::stoi(entry.path().filename()));
    }
  }
}

void limit_the_disk() {
  signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{500'000, 500'000};
  setrlimit(RLIMIT_FSIZE, &limit);
}

int send_and_report(record::Recorder& recorder, const Sinks& sinks,
                    const std::function<void()>& half_way) {
  constexpr TimeNs kTicks = 40'000;
  for (TimeNs k = 0; k < kTicks; ++k) {
    sinks.send(k);
    if (k == kTicks / 2) {
      half_way();
    }
    if (k % 2000 == 0) {
      pause_for(120'000);  // some batches get through before the disk is full
    }
  }
  const auto report = recorder.close();
  fmt::print("{} {} {} {}\n{}\n", report.spikes_written, report.spikes_dropped,
             report.signals_written, report.signals_dropped, report.error);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    return 2;
  }
  const std::string_view mode = argv[1];
  record::RecorderOptions options;
  options.flush_every = mode == "waits" ? 1000 * kNsPerSecond : kNsPerSecond / 10;
  record::Recorder recorder(argv[2], "doomed", {1, 1'000'000}, options);
  const Sinks sinks(recorder);
  g_recorder = &recorder;
  if (mode == "waits" || mode == "busy") {
    signal(SIGTERM, on_terminate);
  }
  if (mode == "full") {
    limit_the_disk();
    return send_and_report(recorder, sinks, [] {});
  }
  if (mode == "broken") {
    return send_and_report(recorder, sinks, [&] {
      pause_for(500'000);  // HDF5 cannot read a file of which half a flush is missing
      break_the_disk(argv[2]);
    });
  }
  if (mode == "waits") {
    for (TimeNs k = 0; k < 500; ++k) {
      sinks.send(k);
    }
    fmt::print("sent\n");
    std::fflush(stdout);
    for (;;) {
      pause();
    }
  }
  send_for_ever(sinks);
}
