// Topics of ROS for an experiment in one process.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "odometry_log.hpp"
#include "spikeloop/fused/transport.hpp"
#include "spikeloop/status/signals.hpp"
#include "spikeloop/topics/rosout.hpp"
#include "spikeloop/topics/session.hpp"
#include "stepping_link.hpp"
#include "waiting.hpp"

namespace spikeloop {

class RosTransport : public fused::Transport {
 public:
  /// @param process name of the process
  /// @param ros_arguments arguments in the format of read_ros_arguments()
  /// @param folder folder for the path of a robot that we do not simulate. Empty: no file
  /// @param failures receives failed writes of the files in `folder`
  /// @throws TransportError without a ROS master.
  RosTransport(const experiment::Experiment& experiment, const std::string& process,
               const std::string& ros_arguments, const std::string& folder, WriteFailures& failures,
               const LoopSurroundings& surroundings);

  topics::Session& session(const experiment::Node& /*node*/) override { return *session_; }
  std::string whole_topic(const std::string& topic) const override {
    return session_->whole_topic(topic);
  }
  command::CommandClock clock() const override;
  void arrived() override;
  void add(const std::string& topic, const topics::TopicSource& sensor) override;
  void add(const std::string& topic, ros_command::CommandEndpoint& command) override;
  void endpoints_added() override;
  std::unique_ptr<Pacer> pacer() override;
  void begin(TimeNs time) override;
  void end(TimeNs time) override;
  void finish() override;
  nlohmann::json summary() const override;
  topics::Rosout& rosout() { return rosout_; }

 private:
  const experiment::Experiment& experiment_;
  std::unique_ptr<topics::Session> session_;
  status::TerminationHook on_termination_{[this] { session_->leave(); }};  // the last of all
  topics::Rosout rosout_;
  Waiting waiting_;
  std::string folder_;
  WriteFailures& failures_;
  std::optional<OdometryLog> odometry_;
  std::optional<SteppingLink> robot_;  ///< with sync: lockstep
  std::vector<ros_command::CommandEndpoint*> commands_;
};

}  // namespace spikeloop
