// Claims another ABI version; its classes must never be looked at.
#include "spikeloop/core/plugin.h"

extern "C" const spikeloop_plugin* spikeloop_plugin_entry(void) {
  static const spikeloop_plugin kPlugin = {sizeof(spikeloop_plugin), 0, SPIKELOOP_BUILD,
                                           reinterpret_cast<const spikeloop_node_class* const*>(1),
                                           1};
  return &kPlugin;
}
