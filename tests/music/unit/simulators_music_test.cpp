// A Process beside a simulator that has MUSIC of its own; that MUSIC itself is left out here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>

#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/process/process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::music {
namespace {

using testing::HasSubstr;

constexpr const char* kJob =
    "stoptime=0.005\nmusic_timestep=0.001\nbarrier=false\n"
    "[sensor]\n  np=1\n  binary=s\n"
    "[brain]\n  np=1\n  binary=./brain.py\n  gain=3\n  record=true\n"
    "[motor]\n  np=1\n  binary=m\n"
    "sensor.out -> brain.in [3]\n"
    "brain.out -> motor.in [2]\n";

/// A spike of channel 1 at the end of every tick.
class Clock : public Source {
 public:
  std::vector<EndpointPort> ports() const override { return {{"out", PortKind::spikes, 2}}; }
  void receive(const Step& step) override {
    step.spike_output(0).emit(std::vector<Spike>{make_spike(step.interval().end, 1)});
  }
};

class SimulatorsMusicTest : public testing::Test {
 protected:
  SimulatorsMusic section(const std::string& text = kJob) const {
    return {directory_.write("job.music", text), "brain"};
  }
  test::TemporaryDirectory directory_;
};

TEST_F(SimulatorsMusicTest, KeysAndWidthsAreTheFiles) {
  Process process(section(), {});
  EXPECT_EQ(process.label(), "brain");
  EXPECT_EQ(process.program(), "brain.py");
  EXPECT_TRUE(process.launched());
  EXPECT_FALSE(process.checking());
  EXPECT_EQ(process.common().music_timestep, 1'000'000);
  EXPECT_EQ(process.written({"gain"}).at("gain").text, "3");
  EXPECT_TRUE(process.connected_input("in", PortKind::spikes));
  EXPECT_FALSE(process.connected_output("more", PortKind::spikes));
  EXPECT_EQ(process.width("in"), 3U);
  try {
    process.declare_ports({"in"});
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("job.music:16:1: 'brain' has no output port 'out'"));
  }
}

TEST_F(SimulatorsMusicTest, TurnsToTheEndWithoutARuntimeAndRecords) {
  setenv("SPIKELOOP_OUT", directory_.path().c_str(), 1);
  Process process(section(), {});
  process.written({"gain"});
  Clock clock;
  const auto source = process.spike_input("in");
  const auto sink = process.spike_output("out");
  GraphDescription description;
  description.tick = process.common().music_timestep;
  description.sources = {{"clock", &clock}};
  description.sinks = {{"out", sink.get()}};
  description.connections = {{"clock", "out", 0, 0, {}}};
  process.attach_recorders(description);
  Graph graph(description);
  int ticks = 0;
  Process::LoopHooks hooks;
  hooks.before_step = [&](TimeNs, TimeNs) { ++ticks; };
  EXPECT_EQ(process.run(graph, hooks), 0);
  unsetenv("SPIKELOOP_OUT");
  EXPECT_EQ(ticks, 5);
  EXPECT_EQ(graph.connections().front().spikes, 5U);
  EXPECT_TRUE(std::filesystem::exists(directory_.path() / "brain.h5"));
}

TEST_F(SimulatorsMusicTest, AFileThatIsNotThereAndSeveralProcessesAreErrors) {
  EXPECT_THROW(Process(SimulatorsMusic{"/nowhere/job.music", "brain"}, {}), FileError);
  std::string text = kJob;
  text.replace(text.find("np=1\n  binary=./brain.py"), 4, "np=2");
  try {
    const Process process(section(text), {});
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), HasSubstr("job.music:8:3: np=2 asks for 2 processes, but brain.py "
                                        "runs in one; write  np=1"));
  }
}

}  // namespace
}  // namespace spikeloop::music
