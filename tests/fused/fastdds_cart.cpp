// The cart of docs/stepping.md on another vendor's DDS, for run after run, until SIGTERM.
//
//     fastdds_cart DOMAIN
#include <signal.h>

#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <vector>

#include "tests/ros2/fastdds_node.hpp"

namespace fastdds_peer {
namespace {

class Cart {
 public:
  explicit Cart(Peer& peer)
      : sensor_(peer.publisher()->create_datawriter(peer.topic<Float64MultiArray>("rt/where"),
                                                    endpoint_qos(DATAWRITER_QOS_DEFAULT))),
        stepped_(peer.publisher()->create_datawriter(peer.topic<String>("rt/spikeloop/stepped"),
                                                     endpoint_qos(DATAWRITER_QOS_DEFAULT))) {
    peer.subscriber()->create_datareader(peer.topic<Float64MultiArray>("rt/go"),
                                         every_message_qos(), &commands_listener_);
    peer.subscriber()->create_datareader(peer.topic<String>("rt/spikeloop/step"),
                                         every_message_qos(), &requests_listener_);
  }

 private:
  void take_command(double speed) {
    const std::lock_guard lock(mutex_);
    commands_.push_back(speed);
    answer_those_that_can_be();
  }
  void take_request(const std::string& text) {
    const std::lock_guard lock(mutex_);
    const auto request = nlohmann::json::parse(text);
    if (request.contains("begin")) {
      requests_.clear();  // what a run that was killed has left
    }
    requests_.push_back(request);
    answer_those_that_can_be();
  }
  void answer_those_that_can_be() {
    while (!requests_.empty() && commands_.size() >= sent_before(requests_.front())) {
      const nlohmann::json request = requests_.front();
      requests_.pop_front();
      if (request.contains("end")) {
        continue;
      }
      if (!request.contains("begin")) {
        advance_to(request.at("to_ns"));
      } else if (request.at("run") != run_) {
        begin(request.at("run"));
      }  // else the answer was lost
      answer();
    }
  }
  static std::size_t sent_before(const nlohmann::json& request) {
    return request.contains("sent") ? request.at("sent").value("/go", 0) : 0;
  }
  void begin(std::int64_t run) {
    run_ = run;
    commands_.clear();
    x_ = 1.0;
    v_ = 0.0;
    time_ns_ = published_ = 0;
    publish();
  }
  void advance_to(std::int64_t time_ns) {
    x_ += v_ * static_cast<double>(time_ns - time_ns_) * 1e-9;
    v_ = commands_.empty() ? 0.0 : commands_.back();
    time_ns_ = time_ns;
    publish();
  }
  void publish() {
    Float64MultiArray where{{x_}};
    sensor_->write(&where);
    ++published_;
  }
  void answer() {
    String text{
        nlohmann::json{{"time_ns", time_ns_}, {"published", {{"/where", published_}}}}.dump()};
    stepped_->write(&text);
  }

  DataWriter* sensor_;
  DataWriter* stepped_;
  std::mutex mutex_;
  double x_ = 1.0, v_ = 0.0;
  std::int64_t run_ = 0, time_ns_ = 0, published_ = 0;
  std::deque<nlohmann::json> requests_;
  std::vector<double> commands_;
  Listener<Float64MultiArray> commands_listener_{
      [this](const Float64MultiArray& command, const SampleInfo&) {
        take_command(command.data.at(0));
      }};
  Listener<String> requests_listener_{
      [this](const String& request, const SampleInfo&) { take_request(request.data); }};
};

int run(int argc, char** argv) {
  if (argc != 2) {
    throw std::runtime_error("write fastdds_cart DOMAIN");
  }
  sigset_t signals;
  ::sigemptyset(&signals);
  ::sigaddset(&signals, SIGTERM);
  ::sigaddset(&signals, SIGINT);
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  Peer peer(static_cast<std::uint32_t>(std::stoi(argv[1])), "udp");
  Cart cart(peer);
  int signal = 0;
  ::sigwait(&signals, &signal);
  return 0;
}

}  // namespace
}  // namespace fastdds_peer

int main(int argc, char** argv) {
  return fastdds_peer::run_program("fastdds_cart", fastdds_peer::run, argc, argv);
}
