// spikeloop-network as users run it: under mpirun and MUSIC, between plain MUSIC programs.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <sstream>

#include "tests/support/fault.hpp"
#include "tests/support/music_job.hpp"

namespace spikeloop::test {
namespace {

using Pairs = std::vector<std::pair<std::int64_t, int>>;
using testing::HasSubstr;

constexpr std::int64_t kMs = 1'000'000;
constexpr int kWidth = 20;

constexpr const char* kRelay =
    "resolution: {}\n"
    "populations:\n"
    "  input: {{model: input, size: 20}}\n"
    "  relay: {{model: repeater, size: 20}}\n"
    "connections:\n"
    "  - {{from: input, to: relay, rule: one_to_one, delay: {}}}\n"
    "output: [relay]\n";

class NetworkProgram : public testing::Test {
 protected:
  // Sections downstream first, so that a spike does not wait for a tick of wall time.
  std::string job(const std::string& keys, double tick, double stoptime, int width = kWidth) const {
    return fmt::format(
        "music_timestep={}\nstoptime={}\nwidth={}\n"
        "[sink]\nbinary={}\nnp=1\nrole=sink\nfile=back.txt\n"
        "[network]\nbinary={}\nnp=1\n{}\n"
        "[source]\nbinary={}\nnp=1\nrole=source\nfile=spikes.txt\n"
        "source.out -> network.in [{}]\n"
        "network.out -> sink.in [{}]\n",
        tick, stoptime, width, MUSIC_PEER, NETWORK_PROGRAM, keys, MUSIC_PEER, width, width);
  }

  void write_spikes(const Pairs& spikes) const {
    std::string text;
    for (const auto& [time, channel] : spikes) {
      text += fmt::format("{} {}\n", time, channel);
    }
    directory_.write("spikes.txt", text);
  }

  Pairs received() const {
    Pairs spikes;
    std::istringstream in(directory_.read("back.txt"));
    std::int64_t time = 0;
    int channel = 0;
    while (in >> time >> channel) {
      spikes.emplace_back(time, channel);
    }
    std::sort(spikes.begin(), spikes.end());
    return spikes;
  }

  Outcome run_program(const std::vector<std::string>& arguments) const {
    Command command;
    command.arguments = {NETWORK_PROGRAM};
    command.arguments.insert(command.arguments.end(), arguments.begin(), arguments.end());
    command.directory = directory_.path().string();
    command.environment = mpi_environment(directory_);
    return run(command);
  }

  static Pairs random_spikes(std::int64_t duration) {
    std::mt19937_64 random(11);
    std::uniform_int_distribution<std::int64_t> time(1, duration);
    std::uniform_int_distribution<int> channel(0, kWidth - 1);
    Pairs spikes;
    for (int i = 0; i < 3000; ++i) {
      spikes.emplace_back(time(random), channel(random));
    }
    std::sort(spikes.begin(), spikes.end());
    return spikes;
  }

  TemporaryDirectory directory_;
};

TEST_F(NetworkProgram, EverySpikeComesBackOnceAtItsTimePlusTheDelay) {
  const Pairs spikes = random_spikes(900 * kMs);
  write_spikes(spikes);
  directory_.write("relay.yaml", fmt::format(kRelay, "0.1 ms", "3 ms"));
  Pairs wanted;
  for (const auto& [time, channel] : spikes) {
    wanted.emplace_back((time + 99'999) / 100'000 * 100'000 + 3 * kMs, channel);
  }
  std::sort(wanted.begin(), wanted.end());
  for (const double tick : {0.001, 0.01}) {
    const Outcome outcome = run(music_job(directory_, 3, job("network=relay.yaml", tick, 1.0)));
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text();
    EXPECT_EQ(outcome.left_behind, 0);
    EXPECT_EQ(received(), wanted) << "tick " << tick;
  }
}

TEST_F(NetworkProgram, WithoutAGridEverySpikeComesBackAtTheExactTime) {
  const Pairs spikes = random_spikes(900 * kMs);
  write_spikes(spikes);
  directory_.write("relay.yaml", fmt::format(kRelay, "off", "2.5 ms"));
  Pairs wanted;
  for (const auto& [time, channel] : spikes) {
    wanted.emplace_back(time + 2'500'000, channel);
  }
  std::sort(wanted.begin(), wanted.end());
  const std::string keys = "network=relay.yaml\nstamp_guard=false";
  const Outcome outcome = run(music_job(directory_, 3, job(keys, 0.001, 1.0)));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(received(), wanted);
}

TEST_F(NetworkProgram, ANeuronFiresAsItsClosedFormSays) {
  // No input population, port `in` unconnected: I_e alone. 500 pA, tau_m/C_m = 0.04 mV/pA: drive
  // 20 mV, threshold 15 mV after 10 ms * ln 4 = 13.863 ms, on the grid 13.9 ms; then 2 ms
  // refractory.
  directory_.write("cell.yaml",
                   "populations:\n"
                   "  cell: {model: iaf_psc_exp, size: 1, parameters: {I_e: 500 pA}}\n"
                   "output: [cell]\n");
  const std::string text = fmt::format(
      "music_timestep=0.001\nstoptime=0.5\nwidth=1\n"
      "[sink]\nbinary={}\nnp=1\nrole=sink\nfile=back.txt\n"
      "[network]\nbinary={}\nnp=1\nnetwork=cell.yaml\n"
      "network.out -> sink.in [1]\n",
      MUSIC_PEER, NETWORK_PROGRAM);
  const Outcome outcome = run(music_job(directory_, 2, text));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text();
  Pairs wanted;
  for (std::int64_t time = 13'900'000; time <= 500 * kMs; time += 15'900'000) {
    wanted.emplace_back(time, 0);
  }
  EXPECT_EQ(received(), wanted);
}

TEST_F(NetworkProgram, EndsTheJobWithPlaceAndRemedy) {
  write_spikes({});
  directory_.write("relay.yaml", fmt::format(kRelay, "0.3 ms", "3 ms"));
  Outcome outcome = run(music_job(directory_, 3, job("network=relay.yaml", 0.001, 0.1)));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text(), Fault("... network: relay.yaml:1:13: the tick 1 ms ... network's "
                                    "resolution 300 us ... 900 us ... [SL0207] ..."));

  directory_.write("relay.yaml", fmt::format(kRelay, "0.1 ms", "3 ms"));
  outcome = run(music_job(directory_, 3, job("network=relay.yaml", 0.001, 0.1, 19)));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text(),
              HasSubstr("the connection of 'network.in' has the width 19, but the network "
                        "relay.yaml has 20 channels there; write [20]"));

  directory_.write("relay.yaml",
                   "populations:\n  cell: {model: repeater, size: 20}\noutput: [cell]\n");
  outcome = run(music_job(directory_, 3, job("network=relay.yaml", 0.001, 0.1)));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text(),
              HasSubstr("'network.in' is connected, but the network relay.yaml has no input "
                        "population; write  in: {model: input, size: 20}"));
}

TEST_F(NetworkProgram, SaysWhatAPortWithoutChannelsWants) {
  directory_.write("one.yaml",
                   "populations:\n  cell: {model: iaf_psc_exp, size: 3}\nrecord: {cell: {spikes: "
                   "true}}\n");
  const auto told = [&](const char* connection) {
    directory_.write("job.music", fmt::format("music_timestep=0.001\nstoptime=1\n[network]\n"
                                              "binary=spikeloop-network\nnp=1\nnetwork=one.yaml\n"
                                              "[peer]\nbinary=peer\nnp=1\n{}\n",
                                              connection));
    const Outcome outcome = run_program({"--check-section", "job.music", "network"});
    EXPECT_EQ(outcome.exit_code, 2);
    return outcome.text();
  };
  const std::string begin = " is connected, but the network one.yaml has no ";
  EXPECT_THAT(told("peer.out -> network.signal [2]"),
              HasSubstr("'network.signal'" + begin +
                        "population of model signal_input; write  signal: {model: signal_input, "
                        "size: 2}"));
  EXPECT_THAT(told("network.out -> peer.in [3]"),
              HasSubstr("'network.out'" + begin + "key 'output'; write  output: [NAME]"));
  EXPECT_THAT(
      told("network.potential -> peer.in [3]"),
      HasSubstr("'network.potential'" + begin + "key 'potential'; write  potential: [NAME]"));
  EXPECT_THAT(told("network.rates -> peer.in [3]"),
              HasSubstr("'network.rates'" + begin + "key 'rates'; write  rates: [NAME]"));
  directory_.write("one.yaml", "populations:\n  a: {model: lin_rate_ipn, size: 2}\nrates: [a]\n");
  EXPECT_THAT(told("network.rates -> peer.in [3]"),
              HasSubstr("the connection of 'network.rates' has the width 3, but the network "
                        "one.yaml has 2 channels there; write [2]"));
}

TEST_F(NetworkProgram, NamesTheKeyAndTheFileThatAreMissing) {
  write_spikes({});
  Outcome outcome = run(music_job(directory_, 3, job("", 0.001, 0.1)));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.text(), HasSubstr("key 'network' is missing"));
  outcome = run(music_job(directory_, 3, job("network=nowhere.yaml", 0.001, 0.1)));
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.text(), HasSubstr("nowhere.yaml"));
}

TEST_F(NetworkProgram, ChecksAFileStandingAlone) {
  directory_.write("w.json", "[[1, 0], [0.5, -2]]");
  directory_.write("net.yaml",
                   "resolution: 0.2 ms\n"
                   "populations:\n"
                   "  input: {model: input, size: 2}\n"
                   "  motor: {model: iaf_psc_exp, size: 2}\n"
                   "connections:\n"
                   "  - {from: input, to: motor, rule: w.json, weight: 10 pA, delay: 1.6 ms}\n"
                   "output: [motor]\n");
  const Outcome outcome = run_program({"--check", "net.yaml"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(outcome.out,
            "net.yaml: resolution 200 us, port in [2], port out [2]\n"
            "\n"
            "population       model                size  port\n"
            "input            input                   2  in\n"
            "motor            iaf_psc_exp             2  out\n"
            "\n"
            "from             to               rule             synapses      delay  weight\n"
            "input            motor            w.json                  3     1.6 ms  -20..10 pA\n");
}

TEST_F(NetworkProgram, ChecksSourcesLearningAndRecords) {
  directory_.write("net.yaml",
                   "populations:\n"
                   "  drive: {model: signal_input, size: 2}\n"
                   "  noise: {model: poisson, size: 5, parameters: {rate: 8 Hz}}\n"
                   "  motor: {model: iaf_psc_exp, size: 2}\n"
                   "connections:\n"
                   "  - {from: drive, to: motor, rule: one_to_one, weight: 200 pA}\n"
                   "  - {from: noise, to: motor, rule: all_to_all, weight: 30, delay: 1.5,\n"
                   "     plasticity: {rule: stdp}}\n"
                   "potential: [motor]\n"
                   "record: {motor: {spikes: true, V_m: [1]}, noise: {spikes: true}}\n");
  const Outcome outcome = run_program({"--check", "net.yaml"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_EQ(
      outcome.out,
      "net.yaml: resolution 100 us, port in [0], port out [0], port signal [2], port potential "
      "[2]\n"
      "\n"
      "population       model                size  port\n"
      "drive            signal_input            2  signal\n"
      "noise            poisson                 5  noise_spikes\n"
      "motor            iaf_psc_exp             2  potential, motor_spikes, motor_V_m\n"
      "\n"
      "from             to               rule             synapses      delay  weight\n"
      "drive            motor            one_to_one              2          -  200 pA\n"
      "noise            motor            all_to_all             10     1.5 ms  30 pA, stdp\n");
}

TEST_F(NetworkProgram, CheckRefusesWhatIsWrong) {
  directory_.write("net.yaml", "populations:\n  a: {model: parrot, size: 1}\noutput: [a]\n");
  Outcome outcome = run_program({"--check", "net.yaml"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err,
            "spikeloop-network: net.yaml:2:14: population 'a': unknown model 'parrot'; known: "
            "input, repeater, iaf_psc_delta, iaf_psc_exp, poisson, signal_input, step_current, "
            "sine_current, noise_current, lin_rate_ipn, threshold_lin_rate_ipn, sigmoid_rate_ipn "
            "[SL0205]\n");
  outcome = run_program({"--check"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err,
            "spikeloop-network: --check takes one file; write  spikeloop-network --check "
            "FILE.yaml\n");
}

TEST_F(NetworkProgram, TheExampleOfItsHelpIsANetworkFile) {
  const Outcome help = run_program({"--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.out, HasSubstr("binary=spikeloop-network"));
  const auto begin = help.out.find("  resolution:");
  const auto end = help.out.find("  output: [relay, motor]\n");
  ASSERT_NE(end, std::string::npos) << help.out;
  directory_.write("example.yaml",
                   help.out.substr(begin, end - begin) + "  output: [relay, motor]\n");
  const Outcome check = run_program({"--check", "example.yaml"});
  EXPECT_EQ(check.exit_code, 0) << check.text();
  EXPECT_THAT(check.out, HasSubstr("port in [100], port out [102]"));
}

}  // namespace
}  // namespace spikeloop::test
