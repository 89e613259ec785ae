#include "spikeloop/ros1/publisher.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <ros/connection_manager.h>
#include <ros/poll_manager.h>
#include <sys/socket.h>
#include <topic_tools/shape_shifter.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <thread>

#include "session_impl.hpp"
#include "spikeloop/messages/message_writer.hpp"

namespace spikeloop::ros1 {
namespace {

using topic_tools::ShapeShifter;

constexpr auto kLongestDrain = std::chrono::milliseconds(500);

std::uint16_t local_port(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
    return 0;
  }
  if (address.ss_family == AF_INET) {
    return ntohs(reinterpret_cast<const sockaddr_in&>(address).sin_port);
  }
  return address.ss_family == AF_INET6
             ? ntohs(reinterpret_cast<const sockaddr_in6&>(address).sin6_port)
             : std::uint16_t{0};
}

/// roscpp sets TCP_NODELAY only where the subscriber asks for it, and drivers rarely do: a command
/// that follows another one closely would then wait up to 40 ms for the other side's delayed
/// acknowledgement. So we set it on every connection to roscpp's port.
void send_without_delay() {
  const auto port = static_cast<std::uint16_t>(ros::ConnectionManager::instance()->getTCPPort());
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) {
    const int descriptor =
        static_cast<int>(std::strtol(entry.path().filename().c_str(), nullptr, 10));
    if (local_port(descriptor) == port) {
      const int on = 1;
      ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    }
  }
}

}  // namespace

struct Publisher::Impl {
  Impl(const std::string& message_type, const std::vector<std::string>& fields)
      : writer(messages::Catalog::builtin(), message_type, fields) {
    const auto& catalog = messages::Catalog::builtin();
    one_array = fields.size() == 1 &&
                !messages::compile_path(catalog, message_type, fields.front()).width().has_value();
    const std::string& type = writer.type().name;
    shifter.morph(catalog.md5(type), type, catalog.full_text(type), "");
  }

  messages::MessageWriter writer;
  bool one_array = false;
  ShapeShifter shifter;
  std::vector<messages::FieldValue> values;
  std::vector<std::byte> bytes;
  ros::Publisher publisher;
};

Publisher::Publisher(Session& session, const std::string& topic, const std::string& message_type,
                     const std::vector<std::string>& fields)
    : impl_(std::make_unique<Impl>(message_type, fields)) {
  check_topic(topic);
  // The queue holds what is published before roscpp's thread runs: commands, then a zero.
  constexpr std::uint32_t kQueue = 10;
  impl_->publisher =
      impl_->shifter.advertise(*session.impl().node, topic, kQueue, false,
                               [](const ros::SingleSubscriberPublisher&) { send_without_delay(); });
}

Publisher::~Publisher() = default;

void Publisher::publish(std::span<const double> values) {
  impl_->values.clear();
  if (impl_->one_array) {
    impl_->values.push_back({values, {}});
  } else {
    for (const double& value : values) {
      impl_->values.push_back({std::span(&value, 1), {}});
    }
  }
  impl_->writer.write(impl_->values, impl_->bytes);
  ros::serialization::IStream stream(reinterpret_cast<std::uint8_t*>(impl_->bytes.data()),
                                     static_cast<std::uint32_t>(impl_->bytes.size()));
  impl_->shifter.read(stream);
  impl_->publisher.publish(impl_->shifter);
}

// roscpp's network thread goes round: it takes what was published, then writes to the sockets that
// are ready, then starts again. After two whole rounds everything is with the kernel.
void Publisher::drain() const {
  const auto rounds = std::make_shared<std::atomic<int>>(0);
  const auto& network = ros::PollManager::instance();
  boost::signals2::connection listening = network->addPollThreadListener([rounds] { ++*rounds; });
  const auto end = std::chrono::steady_clock::now() + kLongestDrain;
  // The round that is under way when we come counts once more.
  while (rounds->load() < 3 && std::chrono::steady_clock::now() < end) {
    network->getPollSet().signal();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  network->removePollThreadListener(listening);
}

}  // namespace spikeloop::ros1
