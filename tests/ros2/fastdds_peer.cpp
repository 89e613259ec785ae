// A robot on another vendor's DDS, configured as rmw_fastrtps does: publishes LaserScan on rt/scan
// twenty times a second, and says which Twists come on rt/cmd_vel, until SIGTERM.
//
//     fastdds_peer DOMAIN MODE [GID_BYTES]
//
// MODE: subnet (as ROS 2 by default), localhost (ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST),
// localhost-only (ROS_LOCALHOST_ONLY=1 in Humble), or udp (subnet without shared memory, which a
// killed process would leave behind), latched (udp, and Twists that were sent before), best-effort
// (udp, and scans that are not sent again). With localhost, ROS_STATIC_PEERS has an address more.
// GID_BYTES: says the nodes of ros_discovery_info, too.
#include <signal.h>

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "fastdds_types.hpp"

namespace fastdds_peer {
namespace {

using namespace eprosima::fastdds::dds;
using eprosima::fastdds::rtps::SharedMemTransportDescriptor;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;

constexpr std::uint32_t kPeersRange = 32;  // ports tried on the peer, as rmw_fastrtps

Locator_t locator_of(const std::string& address) {
  Locator_t locator;
  IPLocator::setIPv4(locator, address);
  return locator;
}

DomainParticipantQos participant_qos(const std::string& mode) {
  DomainParticipantQos qos = PARTICIPANT_QOS_DEFAULT;
  const std::string enclave = "enclave=/;";
  qos.user_data().data_vec({enclave.begin(), enclave.end()});
  if (mode == "subnet") {
    return qos;
  }
  const auto udp = std::make_shared<UDPv4TransportDescriptor>();
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  if (mode != "udp" && mode != "latched" && mode != "best-effort") {
    qos.transport().user_transports.push_back(std::make_shared<SharedMemTransportDescriptor>());
  }
  if (mode == "localhost-only") {
    udp->interfaceWhiteList.emplace_back("127.0.0.1");
  } else if (mode == "localhost") {
    udp->maxInitialPeersRange = kPeersRange;
    // A list of its own, with any port, takes the place of the default one with its multicast.
    qos.wire_protocol().builtin.metatrafficUnicastLocatorList.push_back(Locator_t());
    auto& peers = qos.wire_protocol().builtin.initialPeersList;
    peers.push_back(locator_of("127.0.0.1"));
    if (const char* peer = std::getenv("ROS_STATIC_PEERS"); peer != nullptr) {
      peers.push_back(locator_of(peer));
    }
  }
  return qos;
}

template <typename Qos>
Qos endpoint_qos(Qos qos) {
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = VOLATILE_DURABILITY_QOS;
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 10;
  qos.endpoint().history_memory_policy =
      eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
  return qos;
}

template <typename Qos>
Qos node_qos(Qos qos, std::size_t gid_bytes) {
  qos = endpoint_qos(qos);
  qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
  const std::string hash = gid_bytes == 16 ? "typehash=RIHS01_ab;" : "";
  qos.user_data().data_vec({hash.begin(), hash.end()});
  return qos;
}

template <typename Message>
class Listener : public DataReaderListener {
 public:
  explicit Listener(std::function<void(const Message&)> hear) : hear_(std::move(hear)) {}

  void on_data_available(DataReader* reader) override {
    Message message;
    SampleInfo info;
    try {
      while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
        if (info.valid_data) {
          hear_(message);
        }
      }
    } catch (const std::exception& error) {
      std::printf("cannot read %s: %s\n", Message::type(), error.what());
    }
    std::fflush(stdout);
  }

 private:
  std::function<void(const Message&)> hear_;
};

class Peer {
 public:
  Peer(std::uint32_t domain, const std::string& mode)
      : participant_(DomainParticipantFactory::get_instance()->create_participant(
            domain, participant_qos(mode))) {
    if (participant_ == nullptr) {
      throw std::runtime_error("no participant");
    }
    publisher_ = participant_->create_publisher(PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(SUBSCRIBER_QOS_DEFAULT);
  }
  ~Peer() {
    participant_->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  template <typename Message>
  Topic* topic(const char* name) {
    TypeSupport(new Type<Message>).register_type(participant_);
    return participant_->create_topic(name, Message::type(), TOPIC_QOS_DEFAULT);
  }
  Publisher* publisher() { return publisher_; }
  Subscriber* subscriber() { return subscriber_; }

 private:
  DomainParticipant* participant_;
  Publisher* publisher_ = nullptr;
  Subscriber* subscriber_ = nullptr;
};

template <std::size_t GidBytes>
std::unique_ptr<DataReaderListener> tell_nodes(Peer& peer) {
  using Info = ParticipantEntitiesInfo<GidBytes>;
  auto listener = std::make_unique<Listener<Info>>([](const Info& info) {
    for (const auto& node : info.nodes) {
      std::printf("node %s %s readers %zu writers %zu\n", node.space.c_str(), node.name.c_str(),
                  node.readers.size(), node.writers.size());
    }
  });
  Topic* topic = peer.topic<Info>("ros_discovery_info");
  DataWriter* writer =
      peer.publisher()->create_datawriter(topic, node_qos(DATAWRITER_QOS_DEFAULT, GidBytes));
  Info own;
  writer->write(&own);
  peer.subscriber()->create_datareader(topic, node_qos(DATAREADER_QOS_DEFAULT, GidBytes),
                                       listener.get());
  return listener;
}

LaserScan scan(int number) {
  LaserScan message;
  message.sec = number;
  message.frame_id = "laser";
  message.range_max = 8;
  message.ranges = {0.5F, 1.5F, 2.5F};
  return message;
}

bool is_over(const sigset_t& signals) {
  const timespec tick{0, 50'000'000};
  return ::sigtimedwait(&signals, nullptr, &tick) > 0;
}

int run(int argc, char** argv) {
  if (argc < 3) {
    throw std::runtime_error("write fastdds_peer DOMAIN MODE [GID_BYTES]");
  }
  sigset_t signals;
  ::sigemptyset(&signals);
  ::sigaddset(&signals, SIGTERM);
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  Listener<Twist> twists(
      [](const Twist& twist) { std::printf("twist %g %g\n", twist.values[0], twist.values[5]); });
  std::unique_ptr<DataReaderListener> nodes;
  Peer peer(static_cast<std::uint32_t>(std::atoi(argv[1])), argv[2]);
  DataWriterQos scan_qos = endpoint_qos(DATAWRITER_QOS_DEFAULT);
  if (std::string(argv[2]) == "best-effort") {
    scan_qos.reliability().kind = BEST_EFFORT_RELIABILITY_QOS;
  }
  DataWriter* scans =
      peer.publisher()->create_datawriter(peer.topic<LaserScan>("rt/scan"), scan_qos);
  DataReaderQos twist_qos = endpoint_qos(DATAREADER_QOS_DEFAULT);
  if (std::string(argv[2]) == "latched") {
    twist_qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
  }
  peer.subscriber()->create_datareader(peer.topic<Twist>("rt/cmd_vel"), twist_qos, &twists);
  if (argc > 3) {
    nodes = std::string(argv[3]) == "24" ? tell_nodes<24>(peer) : tell_nodes<16>(peer);
  }
  std::printf("ready\n");
  std::fflush(stdout);
  for (int number = 0; !is_over(signals); ++number) {
    LaserScan message = scan(number);
    scans->write(&message);
  }
  return 0;
}

}  // namespace
}  // namespace fastdds_peer

int main(int argc, char** argv) {
  try {
    return fastdds_peer::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fastdds_peer: %s\n", error.what());
    return 1;
  }
}
