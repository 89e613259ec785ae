// The loop of a MUSIC process; process.hpp states its algebra.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>

#include "process_impl.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/process/transfer.hpp"
#include "spikeloop/status/signals.hpp"

namespace spikeloop::music {
namespace {

using nlohmann::json;
using status::Phase;

// Tells the launcher how far we are: often from the clock master, else once a second.
class Progress {
 public:
  using Report = std::function<Pacer::Report()>;
  Progress(const status::Sender& sender, Report report, bool clock_master)
      : sender_(sender),
        report_(std::move(report)),
        period_(clock_master ? kNsPerSecond / 4 : kNsPerSecond) {}

  void at(TimeNs time) {
    if (first_) {
      sender_.first_tick();
      first_ = false;
    }
    const TimeNs now = wall_now();
    if (now >= next_) {
      next_ = now + period_;
      tell(time);
    }
  }

  // The run's length is what the last word says.
  void tell(TimeNs time) const {
    const auto report = report_();
    sender_.progress({time, report.wall_time, report.overruns});
  }

 private:
  const status::Sender& sender_;
  Report report_;
  TimeNs period_;
  TimeNs next_ = 0;
  bool first_ = true;
};

/// Those of the node are summed over the processes that share it: a collective call. Sources see
/// the same in all of them.
std::vector<Counter> summed_counters(const std::vector<const Graph*>& graphs,
                                     const std::string& node, const Ranks& ranks) {
  std::vector<Counter> counters;
  for (const Graph* graph : graphs) {
    std::ranges::move(graph->counters(), std::back_inserter(counters));
  }
  if (ranks.count > 1) {
    for (Counter& counter : counters) {
      if (counter.name.starts_with(node + ".")) {
        const std::uint64_t own = counter.value;
        MPI_Reduce(&own, &counter.value, 1, MPI_UINT64_T, MPI_SUM, 0, ranks.communicator);
      }
    }
  }
  return counters;
}

json final_counters(const std::vector<const Graph*>& graphs, const std::vector<Counter>& counted,
                    const Pacer::Report& clock, bool clock_master) {
  json counters = json::object();
  counters["ticks"] = clock.ticks;
  counters["wall_ns"] = clock.wall_time;
  if (clock_master) {
    counters["overruns"] = clock.overruns;
    counters["worst_lateness_ns"] = clock.worst_lateness;
  }
  for (const auto& counter : counted) {
    counters[counter.name] = counter.value;
  }
  for (const Graph* graph : graphs) {
    for (const auto& connection : graph->connections()) {
      if (connection.spikes > 0) {
        const std::string name = connection.from + "->" + connection.to;
        counters[name + ".spikes"] = connection.spikes;
        counters[name + ".late"] = connection.late;
      }
    }
  }
  return counters;
}

/// What the first process of the section says; so all leave the loop at the same tick.
bool first_says(const Ranks& ranks, bool here) {
  if (ranks.count == 1) {
    return here;
  }
  int word = here ? 1 : 0;
  MPI_Bcast(&word, 1, MPI_INT, 0, ranks.communicator);
  return word != 0;
}

std::unique_ptr<Pacer> make_pacer(const CommonKeys& keys) {
  return keys.clock_master && !keys.unpaced ? make_realtime_pacer(keys.rtf, keys.music_timestep)
                                            : make_unpaced_pacer();
}

}  // namespace

struct Process::Loop::State {
  Process::Impl& process;
  const CommonKeys& keys;
  std::vector<const Graph*> graphs;
  LoopHooks hooks;
  std::unique_ptr<Pacer> pacer;
  Progress progress;
  /// When something throws, it is left alone: its destructor would talk to programs that MPI_Abort
  /// is about to end. Null beside a simulator that has MUSIC.
  MUSIC::Runtime* runtime = nullptr;
  TimeNs time = 0;

  State(Process::Impl& of, const CommonKeys& its_keys, std::vector<const Graph*> stepped,
        LoopHooks given)
      : process(of),
        keys(its_keys),
        graphs(std::move(stepped)),
        hooks(std::move(given)),
        pacer(of.ranks.rank == 0 ? make_pacer(its_keys) : make_unpaced_pacer()),
        progress(
            *of.status, [this] { return clock_report(); }, its_keys.clock_master) {}

  Pacer::Report clock_report() const {
    return hooks.clock_report ? hooks.clock_report() : pacer->report();
  }

  void meet() {
    process.heartbeat->enter(Phase::meeting);
    if (keys.barrier && process.launched) {
      MPI_Barrier(MPI_COMM_WORLD);
    }
    MUSIC::Setup* const setup = std::exchange(process.setup, nullptr);
    // All programs meet here; handlers already run inside this constructor. The wall clock starts
    // afterwards.
    if (setup != nullptr) {
      runtime = new MUSIC::Runtime(setup, music_seconds(keys.music_timestep));
    }
    pacer->start();
    process.running = true;
  }

  void report(const Pacer::Report& clock) const {
    process.status->report(
        hooks.counters
            ? hooks.counters()
            : final_counters(graphs, summed_counters(graphs, process.label, process.ranks), clock,
                             keys.clock_master),
        hooks.summary ? hooks.summary() : json::object(),
        status::Reached{time, clock.wall_time, clock.overruns});
  }
};

Process::Loop::Loop(Process& process, std::vector<const Graph*> graphs, LoopHooks hooks) {
  const CommonKeys& keys = process.common();
  for (const Graph* graph : graphs) {
    if (graph->tick() != keys.music_timestep) {
      throw std::logic_error("the graph's tick is not music_timestep");
    }
  }
  process.check();
  if (!process.impl_->without_setup) {
    process.impl_->open_setup();
  }
  state_ = std::make_unique<State>(*process.impl_, keys, std::move(graphs), std::move(hooks));
  state_->meet();
}

Process::Loop::~Loop() = default;

bool Process::Loop::begin() {
  State& own = *state_;
  if (own.process.recording) {
    own.process.recording->check(own.keys.on_write_failure);
  }
  const bool goes_on =
      !status::stop_requested() && (!own.keys.stoptime || own.time < *own.keys.stoptime);
  if (!first_says(own.process.ranks, goes_on)) {
    return false;
  }
  own.process.heartbeat->enter(Phase::waiting);
  own.pacer->wait_until(own.time);
  own.process.heartbeat->enter(Phase::computing);
  if (own.hooks.before_step) {
    own.hooks.before_step(own.time, own.time + own.keys.music_timestep);
  }
  return true;
}

void Process::Loop::exchange() {
  State& own = *state_;
  const TimeNs begin = std::exchange(own.time, own.time + own.keys.music_timestep);
  own.process.heartbeat->enter(Phase::exchanging);
  if (own.runtime != nullptr) {
    own.runtime->tick();
  }
  if (own.hooks.after_step) {
    own.hooks.after_step(begin, own.time);
  }
  own.process.heartbeat->at(own.time);
  own.progress.at(own.time);
  if (own.hooks.clock_report) {
    own.process.heartbeat->enter(Phase::computing);
  }
}

void Process::Loop::finish() {
  State& own = *state_;
  own.process.heartbeat->enter(Phase::finalizing);
  const auto clock = own.clock_report();  // now: files may take their time
  own.progress.tell(own.time);
  if (own.hooks.after_loop) {
    own.hooks.after_loop();
  }
  if (own.process.recording) {
    own.process.recording->close();  // now, because finalize() waits for the slowest sender
  }
  own.report(clock);
  if (own.runtime != nullptr) {
    own.runtime->finalize();
    delete own.runtime;
  }
}

int Process::run(Graph& graph, const LoopHooks& hooks) {
  if (impl_->checking) {
    check();
    return 0;
  }
  Loop loop(*this, {&graph}, hooks);
  while (loop.begin()) {
    graph.step();
    loop.exchange();
  }
  loop.finish();
  return 0;
}

}  // namespace spikeloop::music
