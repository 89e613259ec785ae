// The loop of a MUSIC process; process.hpp states its algebra.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "process_impl.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/process/transfer.hpp"
#include "spikeloop/status/signals.hpp"

namespace spikeloop::music {
namespace {

using nlohmann::json;
using status::Phase;

// Tells the launcher how far we are: often from the process that paces, else once a second.
class Progress {
 public:
  Progress(const status::Sender& sender, const Pacer& pacer, bool pacing)
      : sender_(sender), pacer_(pacer), period_(pacing ? kNsPerSecond / 4 : kNsPerSecond) {}

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
    const auto report = pacer_.report();
    sender_.progress(time, report.wall_time, report.overruns);
  }

 private:
  const status::Sender& sender_;
  const Pacer& pacer_;
  TimeNs period_;
  TimeNs next_ = 0;
  bool first_ = true;
};

/// Those of the node are summed over the processes that share it: a collective call. Sources see
/// the same in all of them.
std::vector<Counter> summed_counters(const Graph& graph, const std::string& node,
                                     const Ranks& ranks) {
  std::vector<Counter> counters = graph.counters();
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

json final_counters(const Graph& graph, const std::vector<Counter>& counted,
                    const Pacer::Report& pace, bool pacing) {
  json counters = json::object();
  counters["ticks"] = pace.ticks;
  if (pacing) {
    counters["overruns"] = pace.overruns;
    counters["worst_lateness_ns"] = pace.worst_lateness;
  }
  for (const auto& counter : counted) {
    counters[counter.name] = counter.value;
  }
  for (const auto& connection : graph.connections()) {
    if (connection.spikes > 0) {
      const std::string name = connection.from + "->" + connection.to;
      counters[name + ".spikes"] = connection.spikes;
      counters[name + ".late"] = connection.late;
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
  return keys.pace && !keys.unpaced ? make_realtime_pacer(keys.rtf, keys.music_timestep)
                                    : make_unpaced_pacer();
}

}  // namespace

int Process::run(Graph& graph, const LoopHooks& hooks) {
  const CommonKeys& keys = common();
  if (graph.tick() != keys.music_timestep) {
    throw std::logic_error("the graph's tick is not music_timestep");
  }
  check();
  if (impl_->checking) {
    return 0;
  }
  impl_->open_setup();
  const auto pacer = impl_->ranks.rank == 0 ? make_pacer(keys) : make_unpaced_pacer();
  status::Heartbeat& heartbeat = *impl_->heartbeat;
  heartbeat.enter(Phase::meeting);
  if (keys.barrier && impl_->launched) {
    MPI_Barrier(MPI_COMM_WORLD);
  }
  MUSIC::Setup* const setup = impl_->setup;
  impl_->setup = nullptr;
  // All programs meet here; handlers already run inside this constructor. The wall clock starts
  // afterwards.
  // When something throws, it is left alone: its destructor would talk to programs that MPI_Abort
  // is about to end.
  auto* const runtime = new MUSIC::Runtime(setup, music_seconds(keys.music_timestep));
  pacer->start();
  Progress progress(*impl_->status, *pacer, keys.pace);
  const auto goes_on = [&](TimeNs time) {
    return !status::stop_requested() && (!keys.stoptime || time < *keys.stoptime);
  };
  impl_->running = true;
  for (TimeNs time = 0; first_says(impl_->ranks, goes_on(time));) {
    heartbeat.enter(Phase::waiting);
    pacer->wait_until(time);
    heartbeat.enter(Phase::computing);
    const TimeNs end = time + keys.music_timestep;
    if (hooks.before_step) {
      hooks.before_step(time, end);
    }
    graph.step();
    heartbeat.enter(Phase::exchanging);
    runtime->tick();
    if (hooks.after_step) {
      hooks.after_step(time, end);
    }
    time = end;
    heartbeat.at(time);
    progress.at(time);
  }
  heartbeat.enter(Phase::finalizing);
  progress.tell(graph.time());
  const auto pace = pacer->report();
  if (hooks.after_loop) {
    hooks.after_loop();
  }
  if (impl_->recording) {
    impl_->recording->close();  // now, because finalize() waits for the slowest sender
  }
  const auto counted = summed_counters(graph, impl_->label, impl_->ranks);
  impl_->status->report(final_counters(graph, counted, pace, keys.pace),
                        hooks.summary ? hooks.summary() : json::object(), graph.time());
  runtime->finalize();
  delete runtime;
  return 0;
}

}  // namespace spikeloop::music
