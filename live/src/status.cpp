#include "spikeloop/live/status.hpp"

namespace spikeloop::live {
namespace {

constexpr const char* kStatusTopic = "/spikeloop/status";
constexpr const char* kStatusSchema = R"({"type": "object", "properties": {
  "process": {"type": "string"}, "simulated_s": {"type": "number"}, "wall_s": {"type": "number"},
  "overruns": {"type": "integer"}, "paused": {"type": "boolean"}, "ended": {"type": "boolean"},
  "changeable": {"type": "array"}, "commands": {"type": "array"}, "spikes": {"type": "object"}}})";

}  // namespace

Channel status_channel() {
  return {kStatusTopic, "json", "spikeloop.Status", "jsonschema", kStatusSchema};
}

}  // namespace spikeloop::live
