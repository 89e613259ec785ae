// A robot on another vendor's DDS, configured as rmw_fastrtps does: publishes LaserScan on rt/scan
// twenty times a second, and says which Twists come on rt/cmd_vel and how many publishers it has,
// and what is logged on rt/rosout, until SIGTERM.
//
//     fastdds_peer DOMAIN MODE [GID_BYTES]
//
// MODE: subnet (as ROS 2 by default), localhost (ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST),
// localhost-only (ROS_LOCALHOST_ONLY=1 in Humble), or udp (subnet without shared memory, which a
// killed process would leave behind), latched (udp, and Twists that were sent before), best-effort
// (udp, and scans that are not sent again), one-scan (udp, and one scan, transient local), or a
// policy that commands do not offer: deadline, liveliness, lease. With localhost, ROS_STATIC_PEERS
// has an address more. GID_BYTES: says the nodes of ros_discovery_info, too.
#include <signal.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>
#include <string>

#include "fastdds_node.hpp"

namespace fastdds_peer {
namespace {

template <typename Qos>
Qos node_qos(Qos qos, std::size_t gid_bytes) {
  qos = endpoint_qos(qos);
  qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
  const std::string hash = gid_bytes == 16 ? "typehash=RIHS01_ab;" : "";
  qos.user_data().data_vec({hash.begin(), hash.end()});
  return qos;
}

template <std::size_t GidBytes>
std::unique_ptr<DataReaderListener> tell_nodes(Peer& peer) {
  using Info = ParticipantEntitiesInfo<GidBytes>;
  auto listener = std::make_unique<Listener<Info>>([](const Info& info, const SampleInfo&) {
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

class TwistListener final : public Listener<Twist> {
 public:
  using Listener::Listener;
  void on_subscription_matched(DataReader*, const SubscriptionMatchedStatus& status) override {
    std::printf("publishers %d\n", status.current_count);
    std::fflush(stdout);
  }
};

bool is_over(const sigset_t& signals) {
  const timespec tick{0, 50'000'000};
  return ::sigtimedwait(&signals, nullptr, &tick) > 0;
}

/// What the subscriber of commands requests in a mode.
void request(const std::string& mode, DataReaderQos& qos) {
  using eprosima::fastrtps::Duration_t;
  if (mode == "latched") {
    qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
  } else if (mode == "deadline") {
    qos.deadline().period = Duration_t(0.1);
  } else if (mode == "liveliness") {
    qos.liveliness().kind = MANUAL_BY_TOPIC_LIVELINESS_QOS;
  } else if (mode == "lease") {
    qos.liveliness().lease_duration = Duration_t(1.0);
  }
}

int run(int argc, char** argv) {
  if (argc < 3) {
    throw std::runtime_error("write fastdds_peer DOMAIN MODE [GID_BYTES]");
  }
  sigset_t signals;
  ::sigemptyset(&signals);
  ::sigaddset(&signals, SIGTERM);
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  TwistListener twists([](const Twist& twist, const SampleInfo&) {
    std::printf("twist %g %g\n", twist.values[0], twist.values[5]);
  });
  std::unique_ptr<DataReaderListener> nodes;
  Peer peer(static_cast<std::uint32_t>(std::atoi(argv[1])), argv[2]);
  DataWriterQos scan_qos = endpoint_qos(DATAWRITER_QOS_DEFAULT);
  const std::string mode = argv[2];
  if (mode == "best-effort") {
    scan_qos.reliability().kind = BEST_EFFORT_RELIABILITY_QOS;
  } else if (mode == "one-scan") {
    scan_qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
  }
  DataWriter* scans =
      peer.publisher()->create_datawriter(peer.topic<LaserScan>("rt/scan"), scan_qos);
  DataReaderQos twist_qos = endpoint_qos(DATAREADER_QOS_DEFAULT);
  request(mode, twist_qos);
  peer.subscriber()->create_datareader(peer.topic<Twist>("rt/cmd_vel"), twist_qos, &twists);
  Listener<Log> logs([](const Log& log, const SampleInfo&) {
    std::printf("log %d %s: %s\n", log.level, log.name.c_str(), log.text.c_str());
  });
  peer.subscriber()->create_datareader(peer.topic<Log>("rt/rosout"),
                                       node_qos(every_message_qos(), 0), &logs);
  if (argc > 3) {
    nodes = std::string(argv[3]) == "24" ? tell_nodes<24>(peer) : tell_nodes<16>(peer);
  }
  std::printf("ready\n");
  std::fflush(stdout);
  for (int number = 0; !is_over(signals); ++number) {
    LaserScan message = scan(number);
    if (mode != "one-scan" || number == 0) {
      scans->write(&message);
    }
  }
  return 0;
}

}  // namespace
}  // namespace fastdds_peer

int main(int argc, char** argv) {
  return fastdds_peer::run_program("fastdds_peer", fastdds_peer::run, argc, argv);
}
