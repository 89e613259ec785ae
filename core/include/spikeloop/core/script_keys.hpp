// Keys of a script's section that say what its connections carry: an experiment knows that, MUSIC
// does not, and would wait for ever for a script that declares the other kind. They are named as
// the arguments of spikeloop.music, so that no parameter of a script can have such a name.
#pragma once

#include "spikeloop/core/node.hpp"

namespace spikeloop {

/// Its value: names of ports, divided by commas.
constexpr const char* script_key(PortKind kind, Direction direction) {
  return kind == PortKind::spikes ? direction == Direction::input ? "spikes_in" : "spikes_out"
         : direction == Direction::input ? "signals_in"
                                         : "signals_out";
}

}  // namespace spikeloop
