// spike_playback, signal_playback: a recording as a MUSIC program.
#include "spikeloop/process/music_main.hpp"
#include "spikeloop/record/playback.hpp"

namespace {

using namespace spikeloop;

music::ProgramText program_text(const std::string& name) {
  const bool spikes = name != "signal_playback";
  music::ProgramText text;
  text.name = spikes ? "spike_playback" : "signal_playback";
  text.summary = spikes ? "Plays back recorded spikes" : "Plays back a recorded continuous signal";
  text.ports = spikes ? "  out  output  spikes      Recorded data, at the recorded times\n"
                      : "  out  output  continuous  Recorded data, at the recorded times\n";
  text.parameters = record::playback_parameters();
  text.example = "  [input]\n  binary=" + text.name +
                 "\n  np=1\n  file=run1/encoder.h5\n  input.out -> RECEIVER.in [100]\n";
  text.defaults.clock_master = true;
  return text;
}

int body(music::Process& process) {
  process.set_defaults({.clock_master = true});
  process.declare_ports({"out"});
  const Parameters keys = process.read(record::playback_parameters());
  const bool spikes = process.program() != "signal_playback";
  const auto source = located_at(keys.where("file"), [&] {
    return spikes ? record::make_spike_playback(keys.text("file"), keys.text("stream"))
                  : record::make_signal_playback(keys.text("file"), keys.text("stream"));
  });
  const auto sink = spikes ? process.spike_output("out") : process.signal_output("out");
  GraphDescription description;
  description.tick = process.common().music_timestep;
  description.seed = process.common().seed;
  description.sources = {{"recording", source.get()}};
  description.sinks = {{"out", sink.get()}};
  description.connections = {{"recording.out", "out.out", 0, 0, process.where("out")}};
  process.attach_recorders(description);
  Graph graph(description);
  return process.run(graph);
}

}  // namespace

int main(int argc, char** argv) {
  return music::music_main(argc, argv, program_text(music::called_as(argc, argv)), body);
}
