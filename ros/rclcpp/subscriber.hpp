// A topic in, by rclcpp.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <rclcpp/rclcpp.hpp>
#include <set>
#include <string>

#include "spikeloop/topics/closable.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros {

class Subscriber final : public topics::RawSubscriber {
 public:
  /// @param type "sensor_msgs/LaserScan". @throws what rclcpp throws
  Subscriber(std::shared_ptr<rclcpp::Node> node, topics::Subscription subscription,
             const std::string& type);
  ~Subscriber() override;

  bool has_publishers() const override;
  bool latched() const override { return latched_; }

 private:
  using Take = topics::Closable<const rclcpp::SerializedMessage&>;

  void subscribe();
  void look();
  void refuse(const std::string& topic, const std::string& type,
              const rclcpp::TopicEndpointInfo& publisher);
  std::shared_ptr<rclcpp::GenericSubscription> subscriber() const;

  std::shared_ptr<rclcpp::Node> node_;
  topics::Subscription subscription_;
  std::string type_;
  bool reliable_;
  bool late_ = false;                ///< requests what was published before
  std::set<std::string> refused_{};  ///< types
  std::atomic<bool> latched_{false};
  std::shared_ptr<Take> take_;  ///< the executor may hold a subscription for longer than we live
  mutable std::mutex mutex_;
  std::shared_ptr<rclcpp::GenericSubscription> subscriber_{};
  std::shared_ptr<topics::Closable<>> look_;
  std::shared_ptr<rclcpp::TimerBase> looking_{};
};

}  // namespace spikeloop::ros
