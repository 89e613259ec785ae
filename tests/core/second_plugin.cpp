// Two classes in one line, in a program that has another source of a plug-in.
#include "spikeloop/core/plugin.hpp"

namespace {

using namespace spikeloop;

class Scale : public Node {
 public:
  static NodeDescription describe() { return {.name = "scale"}; }
  explicit Scale(const NodeSetup&) {}
  void step(const Step&) override {}
};

class Offset : public Node {
 public:
  static NodeDescription describe() { return {.name = "offset"}; }
  explicit Offset(const NodeSetup&) {}
  void step(const Step&) override {}
};

}  // namespace

SPIKELOOP_PLUGIN(Scale, Offset)
