// A shared library that is not a plug-in.
extern "C" int spikeloop_is_not_here(void) {
  return 0;
}
