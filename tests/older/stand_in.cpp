// Stands in for the NEST and Python scripts of older examples, under their names: a MUSIC program
// that calls the barrier once between Setup and Runtime, as they do, and repeats every spike one
// tick later. It says at its end how many came.
#include <mpi.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <music.hh>
#include <string>
#include <vector>

namespace {

struct Event {
  double time;
  int channel;
};

struct Inbox : MUSIC::EventHandlerGlobalIndex {
  void operator()(double time, MUSIC::GlobalIndex channel) override {
    events.push_back({time, channel});
    ++count;
    highest = std::max(highest, static_cast<int>(channel));
  }
  std::vector<Event> events;
  long count = 0;
  int highest = -1;
};

/// What follows `name` in the section's args.
double option(int argc, char** argv, const char* name, double otherwise) {
  for (int i = 0; i + 1 < argc; ++i) {
    if (std::strcmp(argv[i], name) == 0) {
      return std::atof(argv[i + 1]);
    }
  }
  return otherwise;
}

double number(MUSIC::Setup& setup, const char* key, double otherwise) {
  double value = otherwise;
  return setup.config(key, &value) ? value : otherwise;
}

/// A port that may be unconnected is asked as an input: MUSIC crashes on an output.
MUSIC::Port* connected(MUSIC::Setup& setup, const char* name) {
  MUSIC::Port* port = setup.publishEventInput(name);
  return port->isConnected() ? port : nullptr;
}

}  // namespace

int main(int argc, char** argv) {
  auto* setup = new MUSIC::Setup(argc, argv);
  const double tick = option(argc, argv, "-s", number(*setup, "music_timestep", 0.001));
  const double stop = option(argc, argv, "-t", number(*setup, "stoptime", 1));
  Inbox inbox;
  for (const char* name : {"in", "sensory"}) {
    if (MUSIC::Port* probe = connected(*setup, name)) {
      MUSIC::LinearIndex channels(0, probe->width());
      setup->publishEventInput(name)->map(&channels, &inbox, tick, 1);
    }
  }
  MUSIC::EventOutputPort* out = nullptr;
  if (MUSIC::Port* probe = connected(*setup, "out")) {
    MUSIC::LinearIndex channels(0, probe->width());
    out = setup->publishEventOutput("out");
    out->map(&channels, MUSIC::Index::GLOBAL, 1);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  MUSIC::Runtime runtime(setup, tick);
  std::vector<Event> pending;
  while (runtime.time() < stop - tick / 2) {
    for (const Event& event : inbox.events) {
      pending.push_back({event.time + tick, event.channel});
    }
    inbox.events.clear();
    // Spikes of the tick to come go out; those after it wait.
    const double end = runtime.time() + tick;
    std::erase_if(pending, [&](const Event& event) {
      const bool due = event.time <= end + tick * 1e-6;
      if (due && out != nullptr) {
        out->insertEvent(event.time, MUSIC::GlobalIndex(event.channel));
      }
      return due;
    });
    runtime.tick();
  }
  runtime.finalize();
  std::printf("stand-in: %ld spikes, highest channel %d\n", inbox.count, inbox.highest);
  return 0;
}
