// This process as a node of ROS 2 by rclcpp: over every middleware that is installed
// (RMW_IMPLEMENTATION).

#include "spikeloop/topics/session.hpp"

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <rclcpp/rclcpp.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "conventions.hpp"
#include "publisher.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/session/rclcpp.hpp"
#include "spikeloop/topics/blocked_signals.hpp"
#include "spikeloop/topics/names.hpp"
#include "subscriber.hpp"

namespace spikeloop::ros {
namespace {

constexpr const char* kDomain = "ROS_DOMAIN_ID";

/// rclcpp does not say when a publisher knows us; it does by then, as it has been here for so long.
constexpr std::chrono::milliseconds kAcquaintance{500};

/// A context of its own: no signal handlers, no files of logs, not the process's arguments.
std::shared_ptr<rclcpp::Context> context_of(const topics::Place& place) {
  rclcpp::InitOptions options;
  options.auto_initialize_logging(false);
  options.shutdown_on_signal = false;
  if (const auto domain = place.find(kDomain); domain != place.end()) {
    options.set_domain_id(std::stoul(domain->second));
  }
  auto context = std::make_shared<rclcpp::Context>();
  context->init(0, nullptr, options);
  return context;
}

std::shared_ptr<rclcpp::Node> node_of(const topics::SessionSettings& settings,
                                      const std::shared_ptr<rclcpp::Context>& context) {
  std::vector<std::string> words = {"--ros-args"};
  for (const auto& [name, value] : settings.arguments) {
    words.insert(words.end(), {"-r", (name == "__name" ? "__node" : name) + ":=" + value});
  }
  rclcpp::NodeOptions options;
  options.context(context).use_global_arguments(false).arguments(words);
  return std::make_shared<rclcpp::Node>(settings.node_name, options);
}

rclcpp::ExecutorOptions executor_options(const std::shared_ptr<rclcpp::Context>& context) {
  rclcpp::ExecutorOptions options;
  options.context = context;
  return options;
}

/// What rclcpp throws, as ours.
template <typename Work>
auto translated(Work&& work) {
  try {
    return work();
  } catch (const rclcpp::exceptions::NameValidationError& error) {
    throw ConfigurationError(error.what());
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw TransportError(std::string("rclcpp: ") + error.what());
  }
}

/// The same for an endpoint; what is not an error of rcl's is a type that it does not find.
template <typename Work>
auto translated(const std::string& type, Work&& work) {
  return translated([&] {
    try {
      return work();
    } catch (const rclcpp::exceptions::RCLErrorBase&) {
      throw;
    } catch (const std::runtime_error& error) {
      throw ConfigurationError("rclcpp does not find the message type " + type + " (" +
                               error.what() +
                               "); source the setup.bash of a workspace that has its package");
    }
  });
}

class Session final : public topics::Session {
 public:
  Session(const topics::SessionSettings& settings, session::FullType full_type)
      : full_type_(full_type),
        context_(context_of(settings.place)),
        node_(node_of(settings, context_)),
        executor_(executor_options(context_)) {
    executor_.add_node(node_);
    thread_ = std::thread([this] { spin(); });
  }
  ~Session() override {
    context_->shutdown("the session ends");
    thread_.join();
  }

  messages::Dialect dialect() const override { return messages::Dialect::ros2; }
  std::string node_name() const override { return node_->get_fully_qualified_name(); }
  bool alive() const override { return context_->is_valid(); }
  void require_alive() const override {
    if (!alive()) {
      const std::lock_guard lock(mutex_);
      throw TransportError("ROS 2 has shut down node '" + node_name() + "'" + why_);
    }
  }
  topics::Place place() const override {
    return {{kDomain, std::to_string(context_->get_domain_id())},
            {session::kTransportVariable, session::kRclcpp}};
  }
  std::string whole_topic(const std::string& topic) const override {
    return translated(
        [&] { return node_->get_node_topics_interface()->resolve_topic_name(topic); });
  }

  std::unique_ptr<topics::RawPublisher> publisher(const std::string& topic,
                                                  const std::string& message_type,
                                                  std::uint32_t queue, bool latched) override {
    const std::string type = full_type_(message_type);
    return translated(type, [&] {
      return std::make_unique<Publisher>(node_, topic, ros2_type(type),
                                         reliable_qos(queue, latched));
    });
  }
  std::unique_ptr<topics::RawSubscriber> subscriber(topics::Subscription subscription) override {
    const std::string type = full_type_(subscription.message_type);
    return translated(
        type, [&] { return std::make_unique<Subscriber>(node_, std::move(subscription), type); });
  }
  bool has_publishers(const std::string& topic) const override {
    return node_->count_publishers(topic) > 0;
  }
  std::vector<topics::Partner> subscribers(const std::string& topic) const override {
    std::vector<topics::Partner> partners;
    for (const auto& subscriber : node_->get_subscriptions_info_by_topic(topic)) {
      partners.push_back(
          {.node = node_name_of(subscriber), .type = plain_type(subscriber.topic_type())});
    }
    return partners;
  }
  bool publishers_are_connected(const std::string& topic) const override {
    const auto now = std::chrono::steady_clock::now();
    const std::lock_guard lock(mutex_);
    Seen& seen = seen_[topic];
    if (const std::size_t publishers = node_->count_publishers(topic);
        publishers != seen.publishers) {
      seen = {publishers, now};
    }
    return seen.publishers > 0 && now - seen.since >= kAcquaintance;
  }

 private:
  struct Seen {
    std::size_t publishers = 0;
    std::chrono::steady_clock::time_point since{};
  };

  /// Nothing that a callback throws may end the process.
  void spin() {
    try {
      executor_.spin();
    } catch (const std::exception& error) {
      {
        const std::lock_guard lock(mutex_);
        why_ = std::string(": ") + error.what();
      }
      context_->shutdown(error.what());
    }
  }

  session::FullType full_type_;
  std::shared_ptr<rclcpp::Context> context_;
  std::shared_ptr<rclcpp::Node> node_;
  rclcpp::executors::SingleThreadedExecutor executor_;
  std::thread thread_;
  mutable std::mutex mutex_;
  mutable std::map<std::string, Seen> seen_{};  ///< by topic
  std::string why_{};                           ///< the executor has ended before its time
};

}  // namespace
}  // namespace spikeloop::ros

extern "C" spikeloop::topics::Session* spikeloop_rclcpp_session_4(
    const spikeloop::topics::SessionSettings& settings, spikeloop::session::FullType full_type) {
  const spikeloop::topics::BlockedSignals blocked;
  return spikeloop::ros::translated(
      [&] { return new spikeloop::ros::Session(settings, full_type); });
}
