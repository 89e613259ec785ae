#include "spikeloop/topics/rosout.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "spikeloop/core/log.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/topics/blocked_signals.hpp"

namespace spikeloop::topics {
namespace {

using std::chrono::system_clock;

constexpr const char* kTopic = "/rosout";
constexpr std::uint32_t kKept = 1000;  // as in rclcpp
constexpr int kMostPerSecond = 50;

struct Line {
  log::Level level;
  std::string text;
  system_clock::time_point time = system_clock::now();
};

/// Format of messages on /rosout.
struct Form {
  const char* type;
  const char* stamp;               ///< path of the stamp
  std::array<double, 4> levels{};  ///< number of each log::Level
};

const Form& form_of(messages::Dialect dialect) {
  static const Form ros1{"rosgraph_msgs/Log", "header.stamp", {1, 2, 4, 8}};
  static const Form ros2{"rcl_interfaces/Log", "stamp", {10, 20, 30, 40}};
  return dialect == messages::Dialect::ros1 ? ros1 : ros2;
}

/// Name of a node's logger as in rclcpp: "arena.brain" of "/arena/brain"; in ROS 1 the name of the
/// node.
std::string logger_of(const Session& session) {
  std::string node = session.node_name();
  if (session.dialect() == messages::Dialect::ros1) {
    return node;
  }
  node.erase(0, node.starts_with('/') ? 1 : 0);
  std::ranges::replace(node, '/', '.');
  return node;
}

}  // namespace

/// Publishes in a separate thread: a call of the log must not wait for DDS, which also writes to
/// the log.
class Rosout::Impl {
 public:
  explicit Impl(Session& session)
      : form_(form_of(session.dialect())),
        logger_(logger_of(session)),
        publisher_(session.publisher(kTopic, form_.type, kKept, true)),
        writer_(messages::Catalog::builtin(session.dialect()), form_.type,
                {form_.stamp, "level", "name", "msg"}) {
    const BlockedSignals blocked;
    thread_ = std::thread([this] { publish(); });
    listener_.emplace([this](log::Level level, std::string_view text) {
      add({level, std::string(text)});
    });
  }
  ~Impl() {
    listener_.reset();
    {
      const std::lock_guard lock(mutex_);
      ending_ = true;
    }
    come_.notify_one();
    thread_.join();
    publisher_->drain();
  }

  void add(Line line) {
    {
      const std::lock_guard lock(mutex_);
      if (line.level != log::Level::error && !has_room(line.time)) {
        ++left_out_;
        return;
      }
      if (left_out_ > 0) {
        lines_.push_back({log::Level::warning,
                          fmt::format("{} messages before this one are not on {}: there were more "
                                      "than {} in a second",
                                      std::exchange(left_out_, 0), kTopic, kMostPerSecond)});
      }
      lines_.push_back(std::move(line));
    }
    come_.notify_one();
  }

 private:
  bool has_room(system_clock::time_point now) {
    if (now - second_ >= std::chrono::seconds(1) || now < second_) {
      second_ = now;
      count_ = 0;
    }
    return ++count_ <= kMostPerSecond;
  }

  void publish() {
    std::unique_lock lock(mutex_);
    while (true) {
      come_.wait(lock, [this] { return ending_ || !lines_.empty(); });
      if (lines_.empty()) {
        return;
      }
      const Line line = std::move(lines_.front());
      lines_.pop_front();
      lock.unlock();
      publish(line);
      lock.lock();
    }
  }

  void publish(const Line& line) {
    const double stamp = std::chrono::duration<double>(line.time.time_since_epoch()).count();
    const double level = form_.levels[static_cast<std::size_t>(line.level)];
    writer_.write(std::array<messages::FieldValue, 4>{{{.numbers = {&stamp, 1}},
                                                       {.numbers = {&level, 1}},
                                                       {.text = logger_},
                                                       {.text = line.text}}},
                  message_);
    publisher_->publish(message_);
  }

  const Form& form_;
  std::string logger_;
  std::unique_ptr<RawPublisher> publisher_;
  messages::MessageWriter writer_;
  std::vector<std::byte> message_;
  std::mutex mutex_;
  std::condition_variable come_;
  std::deque<Line> lines_;
  int left_out_ = 0;
  int count_ = 0;
  system_clock::time_point second_{};
  bool ending_ = false;
  std::thread thread_;
  std::optional<log::Listener> listener_;
};

Rosout::Rosout(Session& session)
    : impl_(session.local() ? nullptr : std::make_unique<Impl>(session)) {}

Rosout::~Rosout() = default;

void Rosout::error(const std::string& text) {
  if (impl_) {
    impl_->add({log::Level::error, text});
  }
}

}  // namespace spikeloop::topics
