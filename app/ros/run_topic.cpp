// What all adapters have in common that read a topic.
#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "programs.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop {

int run_topic(music::Process& process, const Section& section, Source& sensor, Sink& out,
              GraphDescription more, music::Process::LoopHooks hooks) {
  GraphDescription description = std::move(more);
  description.tick = process.common().music_timestep;
  description.seed = process.common().seed;
  description.sources.insert(description.sources.begin(), {"topic", &sensor});
  description.sinks.insert(description.sinks.begin(), {"out", &out});
  description.connections.insert(description.connections.begin(),
                                 {"topic.out", "out.out", 0, 0, {}});
  process.attach_recorders(description);
  Graph graph(description);
  hooks.after_loop = [&] {
    const std::vector<Counter> counters = sensor.counters();
    const bool other_type = std::ranges::any_of(counters, [](const Counter& counter) {
      return std::string_view(counter.name) == "wrong_type" && counter.value != 0;
    });
    if (counters.front().value == 0 && !other_type) {
      log::warning("no message arrived on topic '{}'; '{} list' shows what there is",
                   topics::renamed(section.node.parameters.text("topic"), section.ros.arguments),
                   topics::topic_command(section.ros.ros));
    }
  };
  return process.run(graph, hooks);
}

}  // namespace spikeloop
