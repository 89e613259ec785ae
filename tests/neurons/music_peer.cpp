// A plain MUSIC program, written against MUSIC alone: sends the spikes of a file, or writes down
// those it receives. Keys: role (source|sink), file, width, stoptime, music_timestep; a line a
// spike, "TIME_NS CHANNEL".
#include <mpi.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <music.hh>
#include <string>
#include <utility>
#include <vector>

namespace {

using Spikes = std::vector<std::pair<std::int64_t, int>>;

struct Job {
  double tick = 0.001;
  double stoptime = 1.0;
  int width = 1;
  std::string role;
  std::string file;
};

Job read_job(MUSIC::Setup& setup) {
  Job job;
  setup.config("music_timestep", &job.tick);
  setup.config("stoptime", &job.stoptime);
  setup.config("width", &job.width);
  setup.config("role", &job.role);
  setup.config("file", &job.file);
  return job;
}

void send(MUSIC::Setup* setup, const Job& job) {
  MUSIC::EventOutputPort* port = setup->publishEventOutput("out");
  MUSIC::LinearIndex index(MUSIC::GlobalIndex(0), job.width);
  port->map(&index, MUSIC::Index::GLOBAL, 1);
  Spikes spikes;
  std::ifstream in(job.file);
  std::int64_t time = 0;
  int channel = 0;
  while (in >> time >> channel) {
    spikes.emplace_back(time, channel);
  }
  MPI_Barrier(MPI_COMM_WORLD);
  MUSIC::Runtime runtime(setup, job.tick);
  std::size_t next = 0;
  const auto ticks = std::llround(job.stoptime / job.tick);
  const std::int64_t tick_ns = std::llround(job.tick * 1e9);
  for (std::int64_t k = 0; k < ticks; ++k) {
    for (; next < spikes.size() && spikes[next].first <= (k + 1) * tick_ns; ++next) {
      port->insertEvent(static_cast<double>(spikes[next].first) * 1e-9,
                        MUSIC::GlobalIndex(spikes[next].second));
    }
    runtime.tick();
  }
  runtime.finalize();
}

class Writer : public MUSIC::EventHandlerGlobalIndex {
 public:
  void operator()(double time, MUSIC::GlobalIndex id) override {
    spikes.emplace_back(std::llround(time * 1e9), static_cast<int>(id));
  }
  Spikes spikes;
};

void receive(MUSIC::Setup* setup, const Job& job) {
  MUSIC::EventInputPort* port = setup->publishEventInput("in");
  MUSIC::LinearIndex index(MUSIC::GlobalIndex(0), job.width);
  Writer writer;
  port->map(&index, &writer, 0.0, 1);
  MPI_Barrier(MPI_COMM_WORLD);
  MUSIC::Runtime runtime(setup, job.tick);
  const auto ticks = std::llround(job.stoptime / job.tick);
  for (std::int64_t k = 0; k < ticks; ++k) {
    runtime.tick();
  }
  runtime.finalize();
  std::ofstream out(job.file);
  for (const auto& [time, channel] : writer.spikes) {
    out << time << ' ' << channel << '\n';
  }
}

}  // namespace

int main(int argc, char** argv) {
  auto* setup = new MUSIC::Setup(argc, argv);  // Runtime deletes it
  const Job job = read_job(*setup);
  if (job.role == "source") {
    send(setup, job);
  } else {
    receive(setup, job);
  }
  return 0;
}
