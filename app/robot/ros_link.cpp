#include "ros_link.hpp"

#include <fmt/format.h>
#include <ros/callback_queue.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/names.h>
#include <ros/network.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "raw_message.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::robot {
namespace {

constexpr const char* kMasterVariable = "ROS_MASTER_URI";
constexpr const char* kDefaultMaster = "http://localhost:11311";

// roscpp ends the process with abort() when the variable is missing or malformed.
std::string master_uri() {
  const char* written = std::getenv(kMasterVariable);
  if (written == nullptr) {
    ::setenv(kMasterVariable, kDefaultMaster, 1);
    return kDefaultMaster;
  }
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(written, host, port)) {
    throw ConfigurationError(fmt::format("{} is '{}'; write http://host:port, as in {}",
                                         kMasterVariable, written, kDefaultMaster));
  }
  return written;
}

void check_topic(const std::string& name) {
  std::string reason;
  if (!ros::names::validate(name, reason)) {
    throw ConfigurationError(fmt::format(
        "'{}' is no name of a ROS topic ({}); write letters, digits, '_' and '/'", name, reason));
  }
}

void start_ros(int argc, char** argv, const RunOptions& options) {
  try {
    ros::init(argc, argv, options.node_name,
              ros::init_options::NoSigintHandler | ros::init_options::NoRosout);
  } catch (const ros::InvalidNodeNameException& error) {
    throw ConfigurationError(fmt::format("--node-name '{}': {}; write letters, digits and '_'",
                                         options.node_name, error.what()));
  }
}

void await_master(const std::string& uri, double timeout_s, const std::atomic<bool>& stop) {
  const TimeNs end = wall_now() + from_seconds(timeout_s);
  while (!ros::master::check()) {
    if (stop) return;
    if (wall_now() >= end) {
      throw TransportError(
          fmt::format("no ROS master answers at {} ({}) within {} s; start roscore, or set {}", uri,
                      kMasterVariable, timeout_s, kMasterVariable));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

ros::AdvertiseOptions advertise_options(const std::string& topic, const char* type,
                                        bool has_header) {
  check_topic(topic);
  const auto& catalog = messages::Catalog::builtin();
  constexpr std::uint32_t kQueue = 10;
  ros::AdvertiseOptions options(topic, kQueue, catalog.md5(type), type, catalog.full_text(type));
  options.has_header = has_header;  // roscpp numbers the messages
  return options;
}

void send(const ros::Publisher& publisher, const std::vector<std::byte>& bytes) {
  if (publisher.getNumSubscribers() == 0) return;
  publisher.publish(boost::make_shared<RawMessage>(RawMessage{bytes}));
}

}  // namespace

class RosLink::Impl {
 public:
  explicit Impl(const RunOptions& options) : spinner_(1, &queue_) {
    node_.setCallbackQueue(&queue_);
    auto scan = advertise_options(options.topic(options.scan_topic), kScanType, true);
    auto odometry = advertise_options(options.topic(options.odometry_topic), kOdometryType, true);
    auto clock = advertise_options(options.topic(options.clock_topic), kClockType, false);
    subscribe(options.topic(options.command_topic));
    scan_publisher_ = node_.advertise(scan);
    odometry_publisher_ = node_.advertise(odometry);
    clock_publisher_ = node_.advertise(clock);
    spinner_.start();
  }
  ~Impl() {
    spinner_.stop();
    subscriber_.shutdown();
    ros::shutdown();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void publish(const vehicle::LaserScan& scan) { send(scan_publisher_, scan_.write(scan)); }
  void publish(const vehicle::Odometry& odometry) {
    send(odometry_publisher_, odometry_.write(odometry));
  }
  void publish_clock(TimeNs time) { send(clock_publisher_, clock_.write(time)); }

  std::optional<Command> take_command() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(newest_, std::nullopt);
  }
  std::uint64_t commands() const { return commands_; }

 private:
  void subscribe(const std::string& topic) {
    check_topic(topic);
    ros::SubscribeOptions options;
    options.init<RawMessage>(topic, 1, [this](const boost::shared_ptr<const RawMessage>& message) {
      receive(*message);
    });
    options.md5sum = messages::Catalog::builtin().md5(kTwistType);
    options.datatype = kTwistType;
    options.transport_hints = ros::TransportHints().tcpNoDelay();
    subscriber_ = node_.subscribe(options);
  }

  void receive(const RawMessage& message) {
    try {
      const Command command = twist_.read(message.bytes);
      const std::scoped_lock lock(mutex_);
      newest_ = command;
      ++commands_;
    } catch (const Error& error) {
      log::warning("a command was left out: {}", error.what());
    }
  }

  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  ScanMessage scan_;
  OdometryMessage odometry_;
  ClockMessage clock_;
  TwistReader twist_;
  std::mutex mutex_;
  std::optional<Command> newest_;
  std::atomic<std::uint64_t> commands_ = 0;
  ros::Publisher scan_publisher_;
  ros::Publisher odometry_publisher_;
  ros::Publisher clock_publisher_;
  ros::Subscriber subscriber_;
  ros::AsyncSpinner spinner_;
};

RosLink::RosLink(int argc, char** argv, const RunOptions& options, const std::atomic<bool>& stop) {
  const std::string uri = master_uri();
  start_ros(argc, argv, options);
  await_master(uri, options.master_timeout_s, stop);
  if (!stop) impl_ = std::make_unique<Impl>(options);
}
RosLink::~RosLink() = default;

void RosLink::publish(const vehicle::LaserScan& scan) {
  impl_->publish(scan);
}
void RosLink::publish(const vehicle::Odometry& odometry) {
  impl_->publish(odometry);
}
void RosLink::publish_clock(TimeNs time) {
  impl_->publish_clock(time);
}
std::optional<Command> RosLink::take_command() {
  return impl_->take_command();
}
std::uint64_t RosLink::commands() const {
  return impl_ ? impl_->commands() : 0;
}
bool RosLink::alive() const {
  return ros::ok();
}

}  // namespace spikeloop::robot
