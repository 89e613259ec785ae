// Hangs, exits or crashes while it is loaded, as SPIKELOOP_BROKEN_PLUGIN says.
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

namespace {

__attribute__((constructor)) void when_loaded() {
  const char* const how = getenv("SPIKELOOP_BROKEN_PLUGIN");
  if (how != nullptr && strcmp(how, "hangs") == 0) {
    sleep(1000);
  } else if (how != nullptr && strcmp(how, "exits") == 0) {
    _exit(0);
  }
  raise(SIGSEGV);
}

}  // namespace
