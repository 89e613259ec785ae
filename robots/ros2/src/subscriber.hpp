// A topic in over DDS.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "reader.hpp"
#include "session_impl.hpp"
#include "sources.hpp"

namespace spikeloop::ros2 {

class Subscriber final : public topics::RawSubscriber {
 public:
  /// @throws TransportError when Cyclone DDS refuses it.
  Subscriber(Session::Impl& session, const Endpoint& endpoint, topics::Subscription subscription);
  ~Subscriber() override;

  bool has_publishers() const override;
  std::uint64_t dropped_packets() const override { return discovery::dropped_packets(); }
  std::string misfit() const override;
  bool latched() const override { return sources_.all_latched(); }
  std::optional<std::uint64_t> lost() const override;

 private:
  void take(Level level, const TakenMessage& taken);
  void look_at(const Writer& writer, bool alive);
  void look_at_type(const Writer& writer);
  void add_reader(Level level);
  void remove_reader(Level level);
  void refuse(const topics::OtherType& other);

  Session::Impl& session_;
  Endpoint endpoint_;
  topics::Subscription subscription_;
  RawTopic topic_;
  bool complained_ = false;
  mutable Sources sources_;  // it remembers what it has counted
  mutable std::mutex mutex_{};
  /// By level: one from the beginning, others when a writer needs them.
  std::map<Level, std::unique_ptr<Reader>> readers_{};
  Graph::Listener listener_ = 0;
};

}  // namespace spikeloop::ros2
