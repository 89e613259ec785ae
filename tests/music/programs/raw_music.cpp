// A MUSIC program written against MUSIC alone, to test ours against. It sends what files say and
// logs what comes, tick by tick. Ports, each used when the job connects it:
//   spikes     event output    key spikes=FILE: lines "TICK SECONDS ID", sent before that tick
//   values     cont output     key values=FILE: lines "TICK V0 V1 ...", held from then on
//   spikes_in  event input     logged as "event K SECONDS ID", where K counts the ticks done
//   values_in  cont input      logged as "value K V0 V1 ..." before tick K
// Other keys: stoptime, music_timestep, barrier, latency (acceptable), log=FILE, map_out, map_in
// (channels to map, the connection's width unless given), pause_ms (a sleep every tick), wall=true
// (adds monotonic nanoseconds to the log).
#include <mpi.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <music.hh>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace {

long long wall_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

struct Log {
  std::FILE* file = nullptr;
  bool wall = false;
  int ticks = 0;
  std::string lines;

  void begin(const char* what) { lines += std::string(what) + " " + std::to_string(ticks); }
  void number(double value) {
    char text[40];
    std::snprintf(text, sizeof text, " %.17g", value);
    lines += text;
  }
  void end() { lines += (wall ? " @" + std::to_string(wall_ns()) : "") + "\n"; }
  ~Log() {
    if (file != nullptr) {
      std::fputs(lines.c_str(), file);
      std::fclose(file);
    }
  }
};

class Handler : public MUSIC::EventHandlerGlobalIndex {
 public:
  explicit Handler(Log& log) : log_(log) {}
  void operator()(double t, MUSIC::GlobalIndex id) override {
    log_.begin("event");
    log_.number(t);
    log_.lines += " " + std::to_string(static_cast<int>(id));
    log_.end();
  }

 private:
  Log& log_;
};

struct Program {
  MUSIC::Setup* setup;
  Log log;
  Handler handler{log};
  MUSIC::EventOutputPort* spikes = nullptr;
  std::map<int, std::vector<std::pair<double, int>>> to_send;
  std::map<int, std::vector<double>> to_show;
  std::vector<double> out;
  std::vector<double> in;
  std::vector<MUSIC::ArrayData*> blocks;
  bool has_values_in = false;

  explicit Program(MUSIC::Setup* s) : setup(s) {}

  std::string text(const char* key, const char* otherwise = "") {
    std::string value = otherwise;
    setup->config(key, &value);
    return value;
  }
  double number(const char* key, double otherwise) {
    const auto value = text(key);
    return value.empty() ? otherwise : std::stod(value);
  }
  /// Channels of a port, 0 when it is not connected.
  int width(const char* port, const char* key) {
    auto* probe = setup->publishEventInput(port);
    if (!probe->isConnected()) {
      return 0;
    }
    const int given = static_cast<int>(number(key, 0));
    return given > 0 ? given : probe->width();
  }

  void read_files() {
    std::string line;
    for (std::ifstream file(text("spikes")); std::getline(file, line);) {
      std::istringstream words(line);
      int tick = 0;
      double time = 0;
      int id = 0;
      words >> tick >> time >> id;
      to_send[tick].push_back({time, id});
    }
    for (std::ifstream file(text("values")); std::getline(file, line);) {
      std::istringstream words(line);
      int tick = 0;
      words >> tick;
      for (std::string word; words >> word;) {
        to_show[tick].push_back(std::stod(word));
      }
    }
  }

  void open_ports() {
    if (const int n = width("spikes", "map_out"); n > 0) {
      spikes = setup->publishEventOutput("spikes");
      MUSIC::LinearIndex all(0, n);
      spikes->map(&all, MUSIC::Index::GLOBAL, 1);
    }
    if (const int n = width("spikes_in", "map_in"); n > 0) {
      MUSIC::LinearIndex all(0, n);
      setup->publishEventInput("spikes_in")->map(&all, &handler, number("latency", 0), 1);
    }
    const double nan = std::numeric_limits<double>::quiet_NaN();
    if (const int n = width("values", "map_out"); n > 0) {
      out.assign(static_cast<std::size_t>(n), nan);
      blocks.push_back(new MUSIC::ArrayData(out.data(), MPI_DOUBLE, 0, n));
      setup->publishContOutput("values")->map(blocks.back(), 1);
    }
    if (const int n = width("values_in", "map_in"); n > 0) {
      in.assign(static_cast<std::size_t>(n), nan);
      blocks.push_back(new MUSIC::ArrayData(in.data(), MPI_DOUBLE, 0, n));
      setup->publishContInput("values_in")->map(blocks.back(), 0.0, 1, false);
      has_values_in = true;
    }
  }

  void step() {
    static const std::vector<std::pair<double, int>> nothing;
    const int k = log.ticks;
    if (has_values_in) {
      log.begin("value");
      for (const double value : in) {
        log.number(value);
      }
      log.end();
    }
    if (!out.empty() && to_show.contains(k)) {
      std::copy(to_show[k].begin(), to_show[k].end(), out.begin());
    }
    for (const auto& [time, id] : spikes != nullptr ? to_send[k] : nothing) {
      if (log.wall) {
        log.begin("sent");
        log.end();
      }
      spikes->insertEvent(time, MUSIC::GlobalIndex(id));
    }
  }
};

}  // namespace

int main(int argc, char** argv) {
  auto* setup = new MUSIC::Setup(argc, argv);
  Program program(setup);
  const double stoptime = program.number("stoptime", 1);
  const double tick = program.number("music_timestep", 0.001);
  const auto pause = std::chrono::milliseconds(static_cast<int>(program.number("pause_ms", 0)));
  if (const auto log = program.text("log"); !log.empty()) {
    program.log.file = std::fopen(log.c_str(), "w");
  }
  program.log.wall = program.text("wall") == "true";
  program.read_files();
  program.open_ports();
  if (program.text("barrier", "true") == "true") {
    MPI_Barrier(MPI_COMM_WORLD);
  }
  auto* runtime = new MUSIC::Runtime(setup, tick);
  const int ticks = static_cast<int>(stoptime / tick + 0.5);
  while (program.log.ticks < ticks) {
    program.step();
    ++program.log.ticks;  // what comes during the tick serves the next step
    runtime->tick();
    std::this_thread::sleep_for(pause);
  }
  runtime->finalize();
  delete runtime;
  return 0;
}
