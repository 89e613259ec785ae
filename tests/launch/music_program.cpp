// A MUSIC program for tests: one event port in, one out, and a `behaviour` at a time, `when`. It
// tells the launcher what our programs tell, unless `silent` says that it is somebody else's.
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
#include <thread>

#include "spikeloop/status/status.hpp"

namespace {

using spikeloop::status::Phase;

std::atomic<bool> stop{false};

void on_stop(int) {
  stop = true;
}

/// As our programs have one.
class Heartbeat {
 public:
  explicit Heartbeat(const spikeloop::status::Sender& sender)
      : thread_([this, &sender] {
          while (!ended_) {
            sender.alive(phase_, static_cast<spikeloop::TimeNs>(time_s_ * 1e9));
            usleep(200'000);
          }
        }) {}
  ~Heartbeat() { end(); }
  void end() {
    ended_ = true;
    if (thread_.joinable()) {
      thread_.join();
    }
  }
  void enter(Phase phase, double time_s = 0) {
    phase_ = phase;
    time_s_ = time_s;
  }

 private:
  std::atomic<bool> ended_{false};
  std::atomic<Phase> phase_{Phase::preparing};
  std::atomic<double> time_s_{0};
  std::thread thread_;
};

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
  } else if (behaviour == "end_early") {
    stop = true;
  } else if (behaviour == "throw") {
    throw std::runtime_error("no such synapse");
  } else if (behaviour == "crash") {
    raise(SIGSEGV);
  } else if (behaviour == "abort") {
    MPI_Abort(MPI_COMM_WORLD, 9);
  } else if (behaviour == "finalize_mpi") {
    MPI_Finalize();  // behind MUSIC's back
    pause();
  } else if (behaviour == "freeze") {
    raise(SIGSTOP);
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
  const std::string when = text(*setup, "when", "middle");  // start, middle, late or end
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
  Heartbeat heartbeat(sender);
  if (behaviour == "prepare_long") {
    sleep(4);
  }
  signal(SIGUSR1, behaviour == "stubborn" ? SIG_IGN : on_stop);
  if (behaviour == "stubborn") {
    signal(SIGTERM, SIG_IGN);
  }
  if (when == "start") {
    heartbeat.end();
    misbehave(behaviour, sender);
  }
  Ignore handler;
  connect(*setup, handler);
  const double tick = 0.01;
  heartbeat.enter(Phase::meeting);
  MUSIC::Runtime runtime(setup, tick);
  sender.first_tick();
  std::printf("first tick\n");
  std::fflush(stdout);
  const auto reached = [&runtime] {
    const auto now = static_cast<spikeloop::TimeNs>(runtime.time() * 1e9);
    return spikeloop::status::Reached{now, 2 * now, 3};
  };
  long ticks = 0;
  for (; runtime.time() < stoptime && !stop; ++ticks) {
    heartbeat.enter(Phase::waiting, runtime.time());
    usleep(10'000);
    heartbeat.enter(Phase::exchanging, runtime.time());
    runtime.tick();
    if (ticks < 30) {  // as if later ones were dropped: the report says how far it came
      sender.progress(reached());
    }
    if ((ticks == 20 && when == "middle") || (ticks == 120 && when == "late")) {
      heartbeat.enter(Phase::computing, runtime.time());
      misbehave(behaviour, sender);
    }
  }
  heartbeat.enter(Phase::finalizing, runtime.time());
  if (when == "end") {
    misbehave(behaviour, sender);
  }
  if (behaviour == "slow_to_stop") {
    sleep(1);
  }
  sender.report({{"ticks", ticks}}, {{name + "_ticks", ticks}}, reached());
  runtime.finalize();
  return 0;
}
