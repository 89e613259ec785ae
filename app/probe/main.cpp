// A stand-in for the robot that measures the loop from outside: publishes a laser scan at 20 Hz
// whose range steps from minimum to maximum at random moments, and takes the wall time until the
// first command that follows the step. Prints one JSON object.
//
//   spikeloop-latency-probe --ros 2 --scan-topic /scan --command-topic /cmd_vel --trials 100
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <random>
#include <span>
#include <thread>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/session/open.hpp"

namespace {

using spikeloop::TimeNs;
using spikeloop::wall_now;
using spikeloop::topics::Session;
using namespace spikeloop::messages;

constexpr const char* kScan = "sensor_msgs/LaserScan";
constexpr const char* kTwist = "geometry_msgs/Twist";
constexpr double kRangeMin = 0.1;
constexpr double kRangeMax = 5.0;
constexpr TimeNs kPeriod = 50'000'000;  // 20 Hz

struct Options {
  int ros = 1;
  std::string scan_topic = "/scan";
  std::string command_topic = "/cmd_vel";
  int trials = 100;
  std::size_t beams = 1;
  double low_s = 0.4;   // how long the range stays at least at its minimum before a step
  double high_s = 0.3;  // and at its maximum after it
};

// Publishes scans of one range on all beams.
class ScanPublisher {
 public:
  ScanPublisher(Session& session, const Options& options)
      : writer_(Catalog::builtin(session.dialect()), kScan, {"range_min", "range_max", "ranges"}),
        ranges_(options.beams),
        publisher_(session.publisher(options.scan_topic, kScan, 1)) {}

  void publish(double range) {
    std::fill(ranges_.begin(), ranges_.end(), range);
    const double low[] = {kRangeMin};
    const double high[] = {kRangeMax};
    const FieldValue values[] = {{low, {}}, {high, {}}, {ranges_, {}}};
    writer_.write(values, bytes_);
    publisher_->publish(bytes_);
  }

  bool heard() const { return publisher_->has_subscribers(); }

 private:
  MessageWriter writer_;
  std::vector<double> ranges_;
  std::vector<std::byte> bytes_;
  std::unique_ptr<spikeloop::topics::RawPublisher> publisher_;
};

// Waits for the first command whose first component is greater than the one before it: before the
// step the readout only decays.
class CommandWatch {
 public:
  CommandWatch(Session& session, const Options& options)
      : reader_(Catalog::builtin(session.dialect()), kTwist, "linear.x"),
        subscriber_(session.subscriber({.topic = options.command_topic,
                                        .message_type = kTwist,
                                        .queue = 100,
                                        .take = [this](auto message) { take(message); }})) {}

  void arm() {
    const std::lock_guard lock(mutex_);
    risen_at_ = 0;
  }

  // Time of arrival, or 0 when none came before `deadline`.
  TimeNs wait_for_rise(TimeNs deadline) {
    std::unique_lock lock(mutex_);
    const auto patience = std::chrono::nanoseconds(std::max<TimeNs>(0, deadline - wall_now()));
    condition_.wait_for(lock, patience, [this] { return risen_at_ != 0; });
    return risen_at_;
  }

  std::uint64_t received() const { return received_; }

 private:
  void take(std::span<const std::byte> message) {
    const TimeNs now = wall_now();
    std::vector<double> value;
    reader_.read(message, value);
    const std::lock_guard lock(mutex_);
    ++received_;
    if (risen_at_ == 0 && value[0] > last_) {
      risen_at_ = now;
      condition_.notify_all();
    }
    last_ = value[0];
  }

  FieldReader reader_;
  std::mutex mutex_;
  std::condition_variable condition_;
  TimeNs risen_at_ = 0;
  double last_ = 0.0;
  std::atomic<std::uint64_t> received_{0};
  std::unique_ptr<spikeloop::topics::RawSubscriber> subscriber_;
};

void sleep_until(TimeNs wall) {
  std::this_thread::sleep_for(std::chrono::nanoseconds(std::max<TimeNs>(0, wall - wall_now())));
}

// Publishes `range` at 20 Hz until `until`, beginning now.
void publish_until(ScanPublisher& scans, double range, TimeNs until) {
  for (TimeNs next = wall_now(); next < until; next += kPeriod) {
    sleep_until(next);
    scans.publish(range);
  }
  sleep_until(until);
}

bool wait_for_job(ScanPublisher& scans, CommandWatch& commands) {
  const TimeNs deadline = wall_now() + 30 * spikeloop::kNsPerSecond;
  while (wall_now() < deadline) {
    scans.publish(kRangeMin);
    sleep_until(wall_now() + kPeriod);
    if (scans.heard() && commands.received() > 5) {
      return true;
    }
  }
  return false;
}

double quantile(std::vector<double> sorted, double q) {
  std::sort(sorted.begin(), sorted.end());
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(sorted.size())));
  return sorted[std::max<std::size_t>(rank, 1) - 1];
}

// Latencies in ms; a step without an answer counts as lost.
std::vector<double> measure(ScanPublisher& scans, CommandWatch& commands, const Options& options) {
  // A second is many ticks: a shorter range would meet the same phase of a job's ticks again.
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> jitter(0.0, 1.0);
  std::vector<double> latencies;
  for (int i = 0; i < options.trials; ++i) {
    const double low = options.low_s + jitter(random);
    publish_until(scans, kRangeMin, wall_now() + spikeloop::from_seconds(low));
    commands.arm();
    const TimeNs step = wall_now();
    scans.publish(kRangeMax);
    sleep_until(step + kPeriod);
    publish_until(scans, kRangeMax, step + spikeloop::from_seconds(options.high_s));
    if (const TimeNs answer = commands.wait_for_rise(wall_now() + spikeloop::kNsPerSecond)) {
      latencies.push_back(static_cast<double>(answer - step) * 1e-6);
    }
  }
  return latencies;
}

int run(const Options& options) {
  const auto session =
      spikeloop::session::open({{.node_name = "latency_probe", .unique_name = true},
                                options.ros == 1 ? Dialect::ros1 : Dialect::ros2});
  ScanPublisher scans(*session, options);
  CommandWatch commands(*session, options);
  if (!wait_for_job(scans, commands)) {
    std::fprintf(stderr,
                 "spikeloop-latency-probe: no command came within 30 s; is the job running?\n");
    return 3;
  }
  const std::vector<double> latencies = measure(scans, commands, options);
  if (latencies.empty()) {
    std::fprintf(stderr, "spikeloop-latency-probe: no command followed a step\n");
    return 1;
  }
  const nlohmann::json result = {
      {"trials", options.trials},           {"answered", latencies.size()},
      {"latencies_ms", latencies},          {"median_ms", quantile(latencies, 0.5)},
      {"p90_ms", quantile(latencies, 0.9)}, {"p99_ms", quantile(latencies, 0.99)},
      {"min_ms", quantile(latencies, 0.0)}, {"max_ms", quantile(latencies, 1.0)}};
  std::printf("%s\n", result.dump().c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app(
      "Measures the latency from a scan to the first command that follows it, for spikeloop bench",
      "spikeloop-latency-probe");
  app.add_option("--ros", options.ros, "ROS version")->check(CLI::IsMember({1, 2}));
  app.add_option("--scan-topic", options.scan_topic);
  app.add_option("--command-topic", options.command_topic);
  app.add_option("--trials", options.trials)->check(CLI::PositiveNumber);
  app.add_option("--beams", options.beams)->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  try {
    return run(options);
  } catch (const spikeloop::Error& error) {
    std::fprintf(stderr, "spikeloop-latency-probe: %s\n", error.what());
    return 3;
  }
}
