#include "raw_publisher.hpp"

#include <netinet/tcp.h>
#include <ros/connection_manager.h>
#include <ros/poll_manager.h>
#include <sys/socket.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>

#include "ask.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop::ros1 {
namespace {

constexpr auto kLongestDrain = std::chrono::milliseconds(500);

/// roscpp sets TCP_NODELAY only if the subscriber requests it, which drivers rarely do: a command
/// soon after another one would wait up to 40 ms for the other side's delayed acknowledgement. This
/// function sets it on every connection to roscpp's port.
void send_without_delay() {
  const auto port = static_cast<std::uint16_t>(ros::ConnectionManager::instance()->getTCPPort());
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    const int descriptor =
        static_cast<int>(std::strtol(entry.path().filename().c_str(), nullptr, 10));
    if (port_of(descriptor, ::getsockname) == port) {
      const int on = 1;
      ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    }
  }
}

bool begins_with_header(const messages::TypeLayout& type) {
  return !type.fields.empty() && type.fields.front().message != nullptr &&
         type.fields.front().message->name == "std_msgs/Header";
}

}  // namespace

RawPublisher::RawPublisher(ros::NodeHandle& node, const std::string& topic,
                           const std::string& message_type, std::uint32_t queue, bool latched) {
  topics::check_topic(messages::Dialect::ros1, topic);
  const auto& catalog = messages::Catalog::for_type(messages::Dialect::ros1, message_type);
  const std::string type = catalog.full_name(message_type);
  ros::AdvertiseOptions options(
      topic, queue, catalog.md5(type), type, catalog.full_text(type),
      [](const ros::SingleSubscriberPublisher&) { send_without_delay(); });
  options.latch = latched;
  options.has_header = begins_with_header(*catalog.layout(type));
  publisher_ = node.advertise(options);
}

void RawPublisher::publish(std::span<const std::byte> message) {
  message_.bytes.assign(message.begin(), message.end());
  publisher_.publish(message_);
}

bool RawPublisher::has_subscribers() const {
  return publisher_.getNumSubscribers() != 0;
}

// roscpp's network thread works in rounds: it takes published messages, then writes to the sockets
// that are ready. After two whole rounds the kernel has all messages.
void RawPublisher::drain() const {
  const auto rounds = std::make_shared<std::atomic<int>>(0);
  const auto& network = ros::PollManager::instance();
  boost::signals2::connection listening = network->addPollThreadListener([rounds] { ++*rounds; });
  const auto end = std::chrono::steady_clock::now() + kLongestDrain;
  // Wait for three rounds, because the first one may have begun before.
  while (rounds->load() < 3 && std::chrono::steady_clock::now() < end) {
    network->getPollSet().signal();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  network->removePollThreadListener(listening);
}

}  // namespace spikeloop::ros1
