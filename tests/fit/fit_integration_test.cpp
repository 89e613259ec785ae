// `spikeloop fit` as a user calls it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "spikeloop/core/graph.hpp"
#include "spikeloop/core/registry.hpp"
#include "spikeloop/nodes/register.hpp"
#include "spikeloop/record/recorder.hpp"
#include "tests/support/child.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

class Fit : public testing::Test {
 protected:
  Outcome fit(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {SPIKELOOP, "fit"});
    Command command;
    command.arguments = std::move(arguments);
    command.directory = directory_.path().string();
    return run(command);
  }

  TemporaryDirectory directory_;
};

TEST_F(Fit, RatesDecodeAHeldOutValueToOnePercent) {
  for (const std::vector<std::string>& size :
       {std::vector<std::string>{"--neurons", "100"},
        std::vector<std::string>{"--neurons", "200", "--dimensions", "2"}}) {
    std::vector<std::string> arguments{"nef_encoder", "spike_times=interpolated", "--rates"};
    arguments.insert(arguments.end(), size.begin(), size.end());
    const Outcome outcome = fit(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.text();
    // "held-out error   0.001646   0.08 % of the target's range"
    const auto place = outcome.out.find("held-out error");
    ASSERT_NE(place, std::string::npos);
    EXPECT_LE(std::stod(outcome.out.substr(place + 28)), 1.0) << outcome.out;
  }
}

TEST_F(Fit, WritesWeightsThatAReadoutTakesAndAPicture) {
  const Outcome outcome = fit({"nef_encoder", "--neurons", "50", "--duration", "5", "--function",
                               "x^2; -x", "--out", "w.json", "--picture", "it's fit.png"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_THAT(outcome.out, HasSubstr("nef_encoder: 50 neurons, 2 outputs, 728 samples (spikes, "
                                     "tau 0.03 s)\n"));
  EXPECT_THAT(outcome.out, HasSubstr("section          [encoder] binary=spikeloop-node "
                                     "node=nef_encoder seed=1\n"
                                     "weights          w.json\npicture          it's fit.png\n"));
  EXPECT_THAT(directory_.read("it's fit.png").substr(1, 3), "PNG");
  directory_.write("job.music",
                   "stoptime=1\n[cells]\nnp=1\nbinary=nef_encoder\n[readout]\nnp=1\n"
                   "binary=linear_readout_decoder\nweights=w.json\n[more]\nnp=1\nbinary=sh\n"
                   "cells.out -> readout.in [50]\nreadout.out -> more.in [2]\n"
                   "more.out -> cells.in [1]\n");
  Command check;
  check.arguments = {std::string(PROGRAMS) + "/linear_readout_decoder", "--check-section",
                     "job.music", "readout"};
  check.directory = directory_.path().string();
  const Outcome taken = run(check);
  EXPECT_EQ(taken.exit_code, 0) << taken.text();
}

TEST_F(Fit, WeightsAreForOneTimeConstant) {
  const auto checked = [&](const std::string& keys) {
    directory_.write("e.yaml",
                     "ros: 2\nnodes:\n  scan: {node: ros_sensor, topic: /x, message: "
                     "std_msgs/Float64MultiArray}\n  encoder: {node: nef_encoder}\n"
                     "  readout: {node: linear_readout, weights: " +
                         keys +
                         "}\nconnections:\n  - scan -> encoder [1]\n  - encoder -> readout [20]\n");
    Command command;
    command.arguments = {SPIKELOOP, "check", "e.yaml"};
    command.directory = directory_.path().string();
    return run(command);
  };
  ASSERT_EQ(
      fit({"nef_encoder", "--neurons", "20", "--duration", "2", "--tau", "0.05", "--out", "w.json"})
          .exit_code,
      0);
  EXPECT_EQ(checked("w.json, tau: 50 ms").exit_code, 0);
  EXPECT_THAT(checked("w.json, tau: 5 ms").text(),
              HasSubstr("e.yaml:5:57: key 'tau': 5 ms, but the weights were fitted "
                        "with 50 ms; write  tau: 50 ms, fit them again with --tau 0.005, or write "
                        "the list of weights alone into their file [SL0309]"));
  EXPECT_EQ(checked("w.json").exit_code, 2);  // the default is 30 ms
  ASSERT_EQ(fit({"nef_encoder", "--neurons", "20", "--rates", "--out", "w.json"}).exit_code, 0);
  EXPECT_EQ(checked("w.json, tau: 5 ms").exit_code, 0);  // rates have no kernel
}

/// Two slow sinusoids.
class Wave : public Source {
 public:
  std::vector<EndpointPort> ports() const override { return {{"out", PortKind::signal, 2}}; }
  void receive(const Step& step) override {
    const double t = to_seconds(step.interval().begin);
    step.signal_output().values()[0] = 0.7 * std::sin(5 * t);
    step.signal_output().values()[1] = 0.6 * std::cos(3.1 * t);
    step.signal_output().commit();
  }
};

TEST_F(Fit, RecordingsGiveWhatNumPyFinds) {
  Registry registry;
  register_nodes(registry);
  Wave wave;
  const NodeClass& cells = registry.find("nef_encoder");
  {
    record::Recorder recorder((directory_.path() / "run.h5").string(), "cells", {1, 1'000'000});
    const auto spikes = recorder.spike_sink("out", 40);
    const auto signal = recorder.signal_sink("in", 2, "1");
    GraphDescription description;
    description.tick = 1'000'000;
    description.sources = {{"wave", &wave}};
    description.nodes = {{"cells", &cells, resolve(cells.description.parameters, {}, {})}};
    description.sinks = {{"spikes", spikes.get()}, {"signal", signal.get()}};
    description.connections = {
        {"wave.out", "cells.in"}, {"cells.out", "spikes.in", 40}, {"wave.out", "signal.in"}};
    Graph graph(description);
    while (graph.time() < 8'000'000'000) {
      graph.step();
    }
  }
  const Outcome outcome =
      fit({"--spikes", "run.h5", "--target", "run.h5:in", "--function", "x0*x1; x0", "--tau",
           "0.05", "--regularisation", "0.02", "--out", "w.npy"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.text();
  Command numpy;
  numpy.arguments = {"/usr/bin/python3", CHECK_FIT, "run.h5", "w.npy"};
  numpy.directory = directory_.path().string();
  const Outcome checked = run(numpy);
  EXPECT_EQ(checked.exit_code, 0) << checked.text();
  // It prints its own held-out error as we do.
  const auto place = outcome.out.find("held-out error");
  EXPECT_EQ(outcome.out.substr(place, 25), checked.out.substr(0, 25)) << outcome.out << checked.out;
}

TEST_F(Fit, SaysWhatIsWrong) {
  const auto error = [&](const std::vector<std::string>& arguments) {
    const Outcome outcome = fit(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.text();
    return outcome.err;
  };
  EXPECT_EQ(error({}),
            "spikeloop: fit takes an encoder or a recording: write  spikeloop fit nef_encoder  or  "
            "spikeloop fit --spikes FILE.h5 --target FILE.h5\n");
  EXPECT_EQ(error({"--spikes", "a.h5"}),
            "spikeloop: --spikes and --target belong together; write both\n");
  EXPECT_EQ(error({"nef_encoder", "--out", "w.txt"}),
            "spikeloop: --out w.txt: the name does not say the format; write a name with .json or "
            ".npy\n");
  EXPECT_THAT(error({"nef_encodr"}), HasSubstr("did you mean 'nef_encoder'?"));
  EXPECT_EQ(
      error({"linear_readout"}),
      "spikeloop: 'linear_readout' is not an encoder: it does not turn one continuous input into "
      "spikes; spikeloop describe lists the encoders\n");
  EXPECT_EQ(error({"nef_encoder", "gain"}),
            "spikeloop: 'gain' is not a key of the encoder; write KEY=VALUE, as in "
            "max_rate_high=300\n");
  EXPECT_THAT(error({"nef_encoder", "max_rate=3"}), HasSubstr("unknown key 'max_rate'"));
  EXPECT_THAT(error({"nef_encoder", "--function", "ln(x0)"}),
              ContainsRegex("--function 'ln\\(x0\\)' has no value at x0 = -"));
  EXPECT_THAT(error({"nef_encoder", "--duration", "0.1"}),
              HasSubstr("there is no sample to fit to; fit to a longer time"));
  EXPECT_THAT(error({"nef_encoder", "--neurons", "0"}), HasSubstr("see spikeloop fit --help"));
  EXPECT_EQ(error({"rate_encoder", "--neurons", "10"}),
            "spikeloop: rate_encoder has one neuron a dimension, not 10 for 1; write --neurons 10 "
            "--dimensions 10\n");
  EXPECT_THAT(error({"nef_encoder", "--tau", "nan"}),
              HasSubstr("--tau: 'nan' is not a number from 0.0001 to 100; write one"));
  EXPECT_THAT(error({"nef_encoder", "--picture", "a.pdf"}),
              HasSubstr("--picture a.pdf: write the name of a .png file"));
  EXPECT_THAT(error({"nef_encoder", "--rates", "--duration", "3"}), HasSubstr("excludes"));
  EXPECT_THAT(error({"--spikes", "a.h5", "--target", "a.h5", "--rates"}), HasSubstr("excludes"));
  EXPECT_THAT(error({"nef_encoder", "--seed", "-1"}), HasSubstr("--seed"));
}

TEST_F(Fit, SaysWhichFileCannotBeReadOrWritten) {
  Outcome outcome = fit({"--spikes", "no.h5", "--target", "no.h5"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("no.h5"));
  outcome = fit({"nef_encoder", "--neurons", "5", "--duration", "2", "--out", "none/w.json"});
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("none/w.json"));
}

}  // namespace
}  // namespace spikeloop::test
