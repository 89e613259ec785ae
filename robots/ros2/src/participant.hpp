// This process in a domain of DDS.
#pragma once

#include <dds/dds.h>

#include <cstdint>

#include "spikeloop/discovery/discovery.hpp"

namespace spikeloop::ros2 {

/// A domain's machinery, for one participant: two of a process meet over the network.
class Domain {
 public:
  /// @throws TransportError with what Cyclone DDS says.
  explicit Domain(const discovery::Discovery& where);
  ~Domain();
  Domain(const Domain&) = delete;
  Domain& operator=(const Domain&) = delete;

  dds_entity_t entity() const { return entity_; }
  dds_domainid_t number() const { return number_; }  ///< within this process

 private:
  dds_domainid_t number_;
  dds_entity_t entity_ = 0;
};

class Participant {
 public:
  /// @throws TransportError with what Cyclone DDS says.
  Participant(const Domain& domain, const discovery::Discovery& where);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  dds_entity_t entity() const { return entity_; }

 private:
  dds_entity_t entity_ = 0;
};

}  // namespace spikeloop::ros2
