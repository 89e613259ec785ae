// A node of Fast DDS, configured as rmw_fastrtps does: what the robots of these tests are made of.
#pragma once

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

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

#include "fastdds_types.hpp"

namespace fastdds_peer {

using namespace eprosima::fastdds::dds;
using eprosima::fastdds::rtps::SharedMemTransportDescriptor;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;

constexpr std::uint32_t kPeersRange = 32;  // ports tried on the peer, as rmw_fastrtps

inline Locator_t locator_of(const std::string& address) {
  Locator_t locator;
  IPLocator::setIPv4(locator, address);
  return locator;
}

/// @param mode as fastdds_peer.cpp has it
inline DomainParticipantQos participant_qos(const std::string& mode) {
  DomainParticipantQos qos = PARTICIPANT_QOS_DEFAULT;
  const std::string enclave = "enclave=/;";
  qos.user_data().data_vec({enclave.begin(), enclave.end()});
  if (mode == "subnet") {
    return qos;
  }
  const auto udp = std::make_shared<UDPv4TransportDescriptor>();
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  if (mode == "localhost" || mode == "localhost-only") {
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

/// Of a subscriber that takes every message, however late it comes to it.
inline DataReaderQos every_message_qos() {
  DataReaderQos qos = endpoint_qos(DATAREADER_QOS_DEFAULT);
  qos.history().kind = KEEP_ALL_HISTORY_QOS;
  return qos;
}

template <typename Message>
class Listener : public DataReaderListener {
 public:
  using Hear = std::function<void(const Message&, const SampleInfo&)>;
  explicit Listener(Hear hear) : hear_(std::move(hear)) {}

  void on_data_available(DataReader* reader) override {
    Message message;
    SampleInfo info;
    try {
      while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
        if (info.valid_data) {
          hear_(message, info);
        }
      }
    } catch (const std::exception& error) {
      std::printf("cannot read %s: %s\n", Message::type(), error.what());
    }
    std::fflush(stdout);
  }

 private:
  Hear hear_;
};

class Peer {
 public:
  Peer(std::uint32_t domain, const std::string& mode) : Peer(domain, participant_qos(mode)) {}
  Peer(std::uint32_t domain, const DomainParticipantQos& qos)
      : participant_(DomainParticipantFactory::get_instance()->create_participant(domain, qos)) {
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

/// @throws std::runtime_error whatever @p word is that a test has written to a program
[[noreturn]] inline void refuse_word(const std::string& word) {
  throw std::runtime_error("unknown word '" + word + "'");
}

/// What main() is: @p run, and its error as a line of @p program.
/// @return the exit code
inline int run_program(const char* program, int (*run)(int, char**), int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", program, error.what());
    return 1;
  }
}

}  // namespace fastdds_peer
