// Claims an entry structure that lacks its last members.
#include "spikeloop/core/plugin.h"

extern "C" const spikeloop_plugin* spikeloop_plugin_entry(void) {
  static const spikeloop_plugin kPlugin = {16, SPIKELOOP_ABI_VERSION, SPIKELOOP_BUILD,
                                           reinterpret_cast<const spikeloop_node_class* const*>(1),
                                           1};
  return &kPlugin;
}
