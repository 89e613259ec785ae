// A MUSIC program for tests: one event port in, one out, and a `behaviour`. It tells the launcher
// what our programs tell, unless `silent` says that it is somebody else's.
#include <mpi.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <music.hh>
#include <stdexcept>
#include <string>

#include "spikeloop/status/status.hpp"

namespace {

std::atomic<bool> stop{false};

void on_stop(int) {
  stop = true;
}

struct Ignore : MUSIC::EventHandlerGlobalIndex {
  void operator()(double, MUSIC::GlobalIndex) override {}
};

std::string text(MUSIC::Setup& setup, const char* key, const std::string& otherwise) {
  std::string value;
  return setup.config(key, &value) ? value : otherwise;
}

/// What happens in the middle of the run.
void misbehave(const std::string& behaviour, const spikeloop::status::Sender& sender) {
  if (behaviour == "fail") {
    std::fprintf(stderr, "the weights are odd\n");
    sender.failure(5, "weights.json: the weights are odd; write even ones");
    MPI_Abort(MPI_COMM_WORLD, 5);
  } else if (behaviour == "warn") {
    std::fprintf(stderr, "b: the weights are even\nb: warning: the weights are odd\n");
    std::printf("brain.py:3: UserWarning: no synapses\n");
    std::fflush(stdout);
  } else if (behaviour == "exit") {
    std::fprintf(stderr, "ValueError: no such synapse\n");
    std::_Exit(7);
  } else if (behaviour == "leave") {
    std::_Exit(0);
  } else if (behaviour == "die") {
    raise(SIGKILL);
  } else if (behaviour == "hang") {
    while (true) {
      pause();
    }
  }
}

void connect(MUSIC::Setup& setup, Ignore& handler) {
  if (text(setup, "input", "yes") == "yes") {
    auto* port = setup.publishEventInput("in");
    port->map(std::make_unique<MUSIC::LinearIndex>(0, 1).get(), &handler, 0.0, 1);
  }
  if (text(setup, "output", "yes") == "yes") {
    auto* port = setup.publishEventOutput("out");
    port->map(std::make_unique<MUSIC::LinearIndex>(0, 1).get(), MUSIC::Index::GLOBAL, 1);
  }
}

}  // namespace

int main(int argc, char** argv) {
  auto* setup = new MUSIC::Setup(argc, argv);
  const std::string behaviour = text(*setup, "behaviour", "good");
  const double stoptime = std::stod(text(*setup, "stoptime", "1"));
  if (text(*setup, "silent", "no") == "yes") {
    unsetenv(spikeloop::status::kSocketVariable);
  }
  const std::string name = text(*setup, "name", "?");
  const spikeloop::status::Sender sender(name);
  sender.started();
  if (behaviour == "never_tick") {
    misbehave("hang", sender);
  }
  signal(SIGUSR1, behaviour == "stubborn" ? SIG_IGN : on_stop);
  if (behaviour == "stubborn") {
    signal(SIGTERM, SIG_IGN);
  }
  Ignore handler;
  connect(*setup, handler);
  const double tick = 0.01;
  MUSIC::Runtime runtime(setup, tick);
  sender.first_tick();
  std::printf("first tick\n");
  std::fflush(stdout);
  long ticks = 0;
  for (; runtime.time() < stoptime && !stop; ++ticks) {
    usleep(10'000);
    runtime.tick();
    const auto now = static_cast<spikeloop::TimeNs>(runtime.time() * 1e9);
    sender.progress(now, 2 * now, 3);
    if (ticks == 20) {
      misbehave(behaviour, sender);
    }
  }
  if (behaviour == "slow_to_stop") {
    sleep(1);
  }
  runtime.finalize();
  sender.report({{"ticks", ticks}}, {{name + "_ticks", ticks}});
  return 0;
}
