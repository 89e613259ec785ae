// The other end of a ZeroMQ adapter, as a gym-like environment: publishes one message again and
// again and keeps what it hears. Shares no code with the adapters.
#pragma once

#include <zmq.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

namespace spikeloop::test {

class ZmqPeer {
 public:
  /// Publishes `message()` every 10 ms at one port, and listens at the other.
  ZmqPeer(int publish_port, int listen_port, std::function<nlohmann::json()> message)
      : message_(std::move(message)) {
    const std::string bind = "tcp://127.0.0.1:" + std::to_string(publish_port);
    const std::string connect = "tcp://127.0.0.1:" + std::to_string(listen_port);
    const int linger = 0;
    zmq_setsockopt(publisher_, ZMQ_LINGER, &linger, sizeof linger);
    bound_ = zmq_bind(publisher_, bind.c_str()) == 0;
    zmq_setsockopt(subscriber_, ZMQ_SUBSCRIBE, "", 0);
    zmq_connect(subscriber_, connect.c_str());
    thread_ = std::thread([this] { work(); });
  }
  ~ZmqPeer() {
    running_ = false;
    thread_.join();
    zmq_close(publisher_);
    zmq_close(subscriber_);
    zmq_ctx_term(context_);
  }
  ZmqPeer(const ZmqPeer&) = delete;
  ZmqPeer& operator=(const ZmqPeer&) = delete;

  bool bound() const { return bound_; }
  std::vector<nlohmann::json> heard() const {
    const std::lock_guard lock(mutex_);
    return heard_;
  }

 private:
  void work() {
    while (running_) {
      const std::string text = message_().dump();
      zmq_send(publisher_, text.data(), text.size(), ZMQ_DONTWAIT);
      std::string buffer(65536, '\0');
      int size = 0;
      while ((size = zmq_recv(subscriber_, buffer.data(), buffer.size(), ZMQ_DONTWAIT)) >= 0) {
        const std::lock_guard lock(mutex_);
        heard_.push_back(nlohmann::json::parse(buffer.substr(0, static_cast<std::size_t>(size)),
                                               nullptr, false));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  std::function<nlohmann::json()> message_;
  void* context_ = zmq_ctx_new();
  void* publisher_ = zmq_socket(context_, ZMQ_PUB);
  void* subscriber_ = zmq_socket(context_, ZMQ_SUB);
  bool bound_ = false;
  std::atomic<bool> running_{true};
  mutable std::mutex mutex_;
  std::vector<nlohmann::json> heard_;
  std::thread thread_;
};

}  // namespace spikeloop::test
