// Claims to have been built for another machine.
#include "spikeloop/core/plugin.h"

extern "C" const spikeloop_plugin* spikeloop_plugin_entry(void) {
  static const spikeloop_plugin kPlugin = {
      sizeof(spikeloop_plugin), SPIKELOOP_ABI_VERSION, "m68k-amiga",
      reinterpret_cast<const spikeloop_node_class* const*>(1), 1};
  return &kPlugin;
}
