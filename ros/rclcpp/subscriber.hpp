// A topic in, by rclcpp.
#pragma once

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

 private:
  using Take = topics::Closable<const rclcpp::SerializedMessage&>;

  void subscribe();
  void look();
  std::shared_ptr<rclcpp::GenericSubscription> subscriber() const;

  std::shared_ptr<rclcpp::Node> node_;
  topics::Subscription subscription_;
  std::string type_;
  bool reliable_;
  std::set<std::string> refused_{};  ///< types
  std::shared_ptr<Take> take_;  ///< the executor may hold a subscription for longer than we live
  mutable std::mutex mutex_;
  std::shared_ptr<rclcpp::GenericSubscription> subscriber_{};
  std::shared_ptr<topics::Closable<>> look_;
  std::shared_ptr<rclcpp::TimerBase> looking_{};
};

}  // namespace spikeloop::ros
