// An event camera in a real job: roscpp's publisher and a master, or ROS 2; MUSIC, and a program
// that is not ours at the other end.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <sstream>

#include "robot_job.hpp"
#include "spikeloop/ros2/session.hpp"
#include "tests/ros2/domain.hpp"
#include "tests/support/fault.hpp"

namespace {

using namespace spikeloop::test;
using ros_peer::CameraEvent;
using testing::HasSubstr;
using testing::Not;

constexpr int kWidth = 8;
constexpr int kHeight = 6;
constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kSensor = 1'700'000'000'000 * kMs;
constexpr const char* kNothing = "no message on topic '/events' for 2 s";

struct Received {
  std::int64_t time_ns = 0;
  int channel = 0;
  bool operator==(const Received&) const = default;
};
void PrintTo(const Received& event, std::ostream* out) {
  *out << event.channel << " at " << event.time_ns;
}

using ChannelOf = std::function<std::optional<int>(const CameraEvent&)>;

/// Fields of a ROS 2 message as XCDR1 has them: numbers at multiples of their sizes, little endian.
class Cdr {
 public:
  template <typename Number>
  void add(Number number) {
    bytes_.resize(kHead +
                  (bytes_.size() - kHead + sizeof number - 1) / sizeof number * sizeof number);
    const auto* begin = reinterpret_cast<const std::byte*>(&number);
    bytes_.insert(bytes_.end(), begin, begin + sizeof number);
  }
  void add_time(std::int64_t time_ns) {
    add(static_cast<std::int32_t>(time_ns / (1000 * kMs)));
    add(static_cast<std::uint32_t>(time_ns % (1000 * kMs)));
  }
  const std::vector<std::byte>& message() const { return bytes_; }

 private:
  static constexpr std::size_t kHead = 4;
  std::vector<std::byte> bytes_{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
};

/// dvs_msgs/EventArray of ROS 2.
std::vector<std::byte> event_array(const std::vector<CameraEvent>& events) {
  Cdr cdr;
  cdr.add_time(events.empty() ? 0 : events.front().stamp_ns);
  cdr.add(std::uint32_t{1});  // the frame: a NUL
  cdr.add(char{0});
  cdr.add(std::uint32_t{kHeight});
  cdr.add(std::uint32_t{kWidth});
  cdr.add(static_cast<std::uint32_t>(events.size()));
  for (const CameraEvent& event : events) {
    cdr.add(static_cast<std::uint16_t>(event.x));
    cdr.add(static_cast<std::uint16_t>(event.y));
    cdr.add_time(event.stamp_ns);
    cdr.add(static_cast<std::uint8_t>(event.on));
  }
  return cdr.message();
}

/// /events of kWidth x kHeight pixels over ROS 2.
struct Ros2Camera {
  FreeDomain domain{};
  spikeloop::ros2::Session session{{.node_name = "camera", .place = domain.place()}};
  std::unique_ptr<spikeloop::topics::RawPublisher> events =
      session.publisher("/events", "dvs_msgs/EventArray", 100);
};

std::string program(const std::string& name) {
  return std::string(SPIKELOOP_BIN) + "/" + name;
}

/// A camera adapter with these keys, and who receives its spikes.
std::string chain(const std::string& label, const std::string& keys, int width) {
  return fmt::format(
      "[{0}]\nbinary={1}\nnp=1\nros_topic=/events\nstamp_guard=false\n{2}\n"
      "[{0}_sink]\nbinary={3}\nnp=1\nlog={0}.log\n{0}.out -> {0}_sink.spikes_in [{4}]\n",
      label, program("ros_event_sensor_adapter"), keys, RAW_MUSIC, width);
}

/// Over ROS 1 or 2.
class EventAdapterTest : public RobotJob, public testing::WithParamInterface<int> {
 protected:
  EventAdapterTest() {
    if (GetParam() == 2) {
      camera_ = std::make_unique<Ros2Camera>();
    }
  }
  void publish_events(const std::vector<CameraEvent>& events) {
    if (camera_) {
      camera_->events->publish(event_array(events));
    } else {
      robot_.publish_events("/events", kWidth, kHeight, events);
    }
  }
  void start_job(const std::string& chains, int processes, double seconds) {
    publish_events({});  // so that it is advertised
    Command made = command(processes, fmt::format("music_timestep=0.002\nstoptime={}\nros={}\n{}",
                                                  seconds, GetParam(), chains));
    if (camera_) {
      made.environment.merge(camera_->domain.place());
    }
    child_ = std::make_unique<Child>(made);
  }
  /// 40 messages of 10 ms each with 25 events, no two at the same time; ends when all are out.
  std::vector<CameraEvent> film(std::int64_t begin_ns) {
    std::vector<CameraEvent> all;
    auto due = std::chrono::steady_clock::now();
    for (int k = 0; k < 40; ++k) {
      std::vector<CameraEvent> events;
      for (int i = 0; i < 25; ++i) {
        const std::int64_t stamp =
            begin_ns + (10 * k * 25 + 10 * i) * kMs / 25 + static_cast<int>(random_() % 399'999);
        events.push_back({static_cast<int>(random_() % kWidth),
                          static_cast<int>(random_() % kHeight), random_() % 2 == 0, stamp});
      }
      all.insert(all.end(), events.begin(), events.end());
      std::this_thread::sleep_until(due += std::chrono::milliseconds(10));
      publish_events(events);
    }
    return all;
  }
  std::vector<Received> received(const std::string& label) const {
    std::vector<Received> events;
    std::istringstream log(directory_.read(label + ".log"));
    for (std::string line; std::getline(log, line);) {
      std::istringstream words(line);
      std::string kind;
      int tick = 0;
      double seconds = 0;
      int channel = 0;
      if (words >> kind >> tick >> seconds >> channel && kind == "event") {
        EXPECT_LE(tick, 1 + static_cast<int>(seconds / 0.002)) << "late: " << line;
        events.push_back({std::llround(seconds * 1e9), channel});
      }
    }
    std::ranges::sort(events, {}, &Received::time_ns);
    return events;
  }
  /// What should be received, when the first of all is sent at this time.
  static std::vector<Received> expected(const std::vector<CameraEvent>& events,
                                        const ChannelOf& channel_of, std::int64_t first_at) {
    std::vector<Received> result;
    for (const CameraEvent& event : events) {
      if (const auto channel = channel_of(event)) {
        result.push_back({event.stamp_ns, *channel});
      }
    }
    const std::int64_t offset = first_at - result.at(0).time_ns;
    for (Received& event : result) {
      event.time_ns += offset;
    }
    return result;
  }

  std::mt19937 random_{4};
  std::unique_ptr<Ros2Camera> camera_;  ///< of ROS 2 alone
};

INSTANTIATE_TEST_SUITE_P(OverRos, EventAdapterTest, testing::Values(1, 2));

TEST_P(EventAdapterTest, every_event_comes_once_on_its_channel_and_at_its_time) {
  const std::map<std::string, ChannelOf> channels = {
      {"whole", [](const CameraEvent& e) { return std::optional(e.y * kWidth + e.x); }},
      {"split",
       [](const CameraEvent& e) {
         return std::optional((e.on ? 0 : kWidth * kHeight) + e.y * kWidth + e.x);
       }},
      {"part", [](const CameraEvent& e) {
         const bool in = e.on && e.x >= 2 && e.x < 7 && e.y >= 1 && e.y < 5;
         return in ? std::optional((e.y - 1) / 2 * 3 + (e.x - 2) / 2) : std::nullopt;
       }}};
  // So much later may a busy machine bring what it should bring now.
  start_job(chain("whole", "latency=2", 48) + chain("split", "latency=2\npolarity=split", 96) +
                chain("part", "latency=2\nroi=2,1,5,4\ndownsample=2\npolarity=on", 6),
            6, 8);
  for (const auto& [label, channel_of] : channels) {
    // The loop runs, so nothing that comes is from before the run.
    ASSERT_TRUE(child_->wait_for(label + ": warning: " + kNothing, std::chrono::seconds(60)))
        << child_->output();
  }
  const auto first = film(kSensor);
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  const auto again = film(kSensor - 100'000 * kMs);  // as a bag that begins again
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_THAT(outcome.text(), Not(HasSubstr("too late")));
  for (const auto& [label, channel_of] : channels) {
    const std::vector<Received> events = received(label);
    const auto count = static_cast<std::ptrdiff_t>(
        std::ranges::count_if(first, [&](const auto& e) { return channel_of(e).has_value(); }));
    ASSERT_GT(std::ssize(events), count) << label;
    EXPECT_GT(count, 80) << label;
    const std::vector<Received> before(events.begin(), events.begin() + count);
    const std::vector<Received> after(events.begin() + count, events.end());
    EXPECT_EQ(before, expected(first, channel_of, before[0].time_ns)) << label;
    EXPECT_EQ(after, expected(again, channel_of, after[0].time_ns)) << label;
  }
}

TEST_P(EventAdapterTest, what_comes_too_late_is_sent_all_the_same) {
  start_job(chain("late", "latency=0", 48), 2, 4);
  ASSERT_TRUE(child_->wait_for(kNothing, std::chrono::seconds(60))) << child_->output();
  const auto all = film(kSensor);
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_THAT(outcome.text(), HasSubstr("too late for latency=0 and are sent at once; "
                                        "write latency=0.01 to send them at their own times"));
  EXPECT_EQ(received("late").size(), all.size());
}

TEST_P(EventAdapterTest, the_camera_must_fit_the_port) {
  start_job(chain("camera", "", 47), 2, 60);
  ros_peer::eventually(60, [&] {
    publish_events({});
    return child_->wait_for("pixels", std::chrono::milliseconds(20));
  });
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text();
  EXPECT_THAT(outcome.text(), Fault(fmt::format("... camera: {}/job.music:14:1: a camera of 8 x 6 "
                                                "pixels ... 48 ... 47 ... [48] ... [SL0505] ...",
                                                directory_.path().string())));
}

class EventErrorTest : public RobotJob {};

TEST_F(EventErrorTest, another_type_on_the_topic) {
  robot_.publish_twist("/events", 1, 2);
  child_ = std::make_unique<Child>(
      command(2, "music_timestep=0.002\nstoptime=60\n" + chain("camera", "", 48)));
  ros_peer::eventually(60, [&] {
    robot_.publish_twist("/events", 1, 2);
    return child_->wait_for("carries", std::chrono::milliseconds(20));
  });
  const auto outcome = child_->wait();
  EXPECT_EQ(outcome.exit_code, 3) << outcome.text();
  EXPECT_THAT(outcome.text(), HasSubstr("camera: topic '/events' carries geometry_msgs/Twist, not "
                                        "dvs_msgs/EventArray; node /"));
  EXPECT_THAT(outcome.text(), HasSubstr(" publishes it; write another topic [SL0508]\n"));
}

TEST_F(EventErrorTest, sections_are_checked_without_ros) {
  const auto error = [&](const std::string& keys, int width) {
    const std::string file = directory_.write("check.music", chain("camera", keys, width));
    return run({.arguments = {binary("ros_event_sensor_adapter"), "--check-section", file,
                              "camera"}})
        .err;
  };
  EXPECT_EQ(error("sensor_update_rate=100\nlatency=20 ms", 48), "");
  EXPECT_THAT(error("roi=0,0,4", 48), Fault("... check.music:6:1: key 'roi': '0,0,4' ... 4 ... "
                                            "roi: [100, 60, 128, 128] ... [SL0105] ..."));
  EXPECT_THAT(error("roi=0,0,4,4\ndownsample=2", 48),
              Fault("... a region of 4 x 4 pixels ... 4 ... 48 ... [4] ... [SL0505] ..."));
  EXPECT_THAT(error("message_type=event_camera_msgs/EventPackt", 48),
              Fault("... 'event_camera_msgs/EventPackt' ... 'event_camera_msgs/EventPacket' ... "
                    "[SL0502] ..."));
  EXPECT_THAT(error("message_type=geometry_msgs/Twist", 48),
              Fault("... message type 'geometry_msgs/Twist' ... [SL0504] ..."));
  EXPECT_THAT(error("polarity=spilt", 48), HasSubstr("did you mean 'split'?"));
  EXPECT_THAT(error("downsample=0", 48), HasSubstr("downsample"));
  const std::string file = directory_.write(
      "topic.music", fmt::format("[camera]\nbinary={0}\nnp=1\n[sink]\nbinary={1}\nnp=1\n"
                                 "camera.out -> sink.in [3]\n",
                                 binary("ros_event_sensor_adapter"), RAW_MUSIC));
  EXPECT_THAT(
      run({.arguments = {binary("ros_event_sensor_adapter"), "--check-section", file, "camera"}})
          .err,
      HasSubstr("key 'ros_topic' is missing; write for example  ros_topic=/dvs/events"));
}

}  // namespace
