// Who publishes in this domain, and of which type.
#pragma once

#include <dds/dds.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "dispatcher.hpp"
#include "qos.hpp"
#include "spikeloop/topics/closable.hpp"

namespace spikeloop::ros2 {

/// Writer of any participant, as discovery reports it.
struct Writer {
  std::string topic;      ///< in DDS
  std::string type;       ///< in DDS
  std::string user_data;  ///< ROS 2 since Iron: "typehash=RIHS01_...;"
  bool reliable = true;
  std::string misfit{};  ///< what it offers and no reader of ours takes; empty if nothing
  bool latched =
      false;  ///< reliable, and sends its newest messages to late readers that ask for them
  dds_instance_handle_t handle = 0;  ///< the publication handle of its messages
  dds_guid_t guid{};
  dds_guid_t participant{};
};

/// Reader of any participant.
struct OtherReader {
  std::string topic;    ///< in DDS
  std::string type;     ///< in DDS
  Requests requests{};  ///< beyond what every writer of ours offers
  dds_guid_t guid{};
};

bool is_same(const dds_guid_t& a, const dds_guid_t& b);

class Graph {
 public:
  using Seen = std::function<void(const Writer&, bool alive)>;
  using Listener = std::uint64_t;

  Graph(dds_entity_t participant, Dispatcher& dispatcher);
  ~Graph();
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;

  /// Calls `seen` in the session's thread for every writer of a topic, also for the existing ones,
  /// and with `alive` false when a writer has left.
  Listener listen(const std::string& dds_topic, Seen seen);
  /// Waits for a call that is running; none runs afterwards.
  void forget(Listener listener);

  std::vector<Writer> writers(const std::string& dds_topic) const;
  std::vector<OtherReader> readers(const std::string& dds_topic) const;

 private:
  struct Listening {
    std::string topic;
    std::shared_ptr<topics::Closable<const Writer&, bool>> seen;
    bool fresh = true;  ///< has not been told of those that were there before
  };

  void take_news();
  void take_readers();
  void record(const dds_builtintopic_endpoint_t& endpoint, const dds_sample_info_t& info,
              std::vector<std::pair<Writer, bool>>& news);
  void tell(const Writer& writer, bool alive);
  void tell_fresh();

  Dispatcher& dispatcher_;
  dds_entity_t reader_;
  dds_entity_t news_;  ///< a read condition
  dds_entity_t subscriptions_;
  dds_entity_t readers_news_;  ///< a read condition
  dds_entity_t fresh_;         ///< a guard condition
  mutable std::mutex mutex_;
  std::map<dds_instance_handle_t, Writer> writers_;
  std::map<dds_instance_handle_t, OtherReader> readers_;
  Listener last_ = 0;
  std::map<Listener, Listening> listeners_;
  Dispatcher::Ticket news_ticket_;
  Dispatcher::Ticket readers_ticket_;
  Dispatcher::Ticket fresh_ticket_;
};

}  // namespace spikeloop::ros2
