// The examples of music-adapters, with a gym-like environment at the other end of their sockets.
// Two of them lack keys that their own programs demand; what is missing is added here, and the
// error that names it is a test of its own.
#include <fmt/format.h>

#include <cmath>

#include "older_job.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/roscore.hpp"
#include "zmq_peer.hpp"

namespace spikeloop::test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

double unix_time() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration<double>(since).count();
}

json reading(double value, double low, double high) {
  return {{"value", value}, {"min", low}, {"max", high}, {"ts", unix_time()}};
}

/// Scaled to [-1, 1]: (0.5, -0.5, 0).
json three_readings() {
  return {reading(3, -6, 6), reading(0.25, 0, 1), reading(-4, -5, -3)};
}

class OlderZmqExample : public testing::Test {
 protected:
  /// A file of the older kind: programs by relative paths, sections indented by four.
  std::string section(const std::string& label, const std::string& program,
                      const std::string& keys) {
    job_.program(program, "../build/" + program);
    return fmt::format("[{}]\n    binary=../build/{}\n    np=1\n    args=\n{}", label, program,
                       keys);
  }
  std::string input(const std::string& keys = "    message_type=GymObservation\n") {
    return section("input", "zmq_cont_adapter",
                   fmt::format("    zmq_addr=tcp://localhost:{}\n{}", in_port_, keys));
  }
  std::string output(const std::string& keys = "    message_type=FloatArray\n") {
    return section("output", "cont_zmq_adapter",
                   fmt::format("    zmq_addr=tcp://*:{}\n{}", out_port_, keys));
  }
  void SetUp() override { std::filesystem::create_directories(job_.directory.path() / "build"); }

  OlderJob job_{"test"};
  ReservedPort in_;
  ReservedPort out_;
  int in_port_ = in_.number();
  int out_port_ = out_.number();
};

const char* const kPlaces =
    "[[-1, -1, -1, 0.6, 0.6, 0.6], [1, -1, -1, 0.6, 0.6, 0.6], [-1, 1, -1, 0.6, 0.6, 0.6],"
    " [1, 1, -1, 0.6, 0.6, 0.6], [-1, -1, 1, 0.6, 0.6, 0.6], [1, -1, 1, 0.6, 0.6, 0.6],"
    " [-1, 1, 1, 0.6, 0.6, 0.6], [1, 1, 1, 0.6, 0.6, 0.6]]";

TEST_F(OlderZmqExample, PlaceCellsOfAnObservation) {
  job_.write("connect.json", "[[1, 0, 0], [0, 1, 0], [0, 0, 1]]");
  job_.write("grid_pos.json", kPlaces);
  const std::string text =
      "stoptime=2.\nrtf=1.\n" + input() +
      section("connect", "cont_cont_adapter", "    weights_filename=connect.json\n") +
      section("discretize", "discretize_adapter", "    grid_positions_filename=grid_pos.json\n") +
      output() +
      "input.out->connect.in[3]\nconnect.out->discretize.in[3]\ndiscretize.out->output.in[8]\n";
  const ZmqPeer peer(in_port_, out_port_, three_readings);
  ASSERT_TRUE(peer.bound());
  const Outcome outcome = run(job_.command(text));
  expect_clean(outcome);
  EXPECT_THAT(warnings(outcome), ElementsAre()) << outcome.text();
  const auto heard = peer.heard();
  ASSERT_FALSE(heard.empty()) << outcome.text();
  const double x[3] = {0.5, -0.5, 0};
  for (const json& message : heard) {
    ASSERT_EQ(message.size(), 8U);
    for (unsigned cell = 0; cell < 8; ++cell) {
      double distance = 0;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const double centre = (cell >> axis & 1U) != 0 ? 1 : -1;
        distance += std::pow((x[axis] - centre) / 0.6, 2);
      }
      EXPECT_NEAR(message[cell].get<double>(), 2 * std::exp(-distance / 2) - 1, 1e-12);
    }
  }
}

// Three neurons, of which each encodes the whole observation, and their filtered spikes on eight
// channels: the older decoder left the last five at 0.
TEST_F(OlderZmqExample, SpikesOfAnObservation) {
  const std::string text =
      "stoptime=2.\nrtf=1.\ndialect=auto\n" + input() +
      section("encoder", "nef_encoder", "    rate_min=1\n    rate_max=10\n") +
      section("decoder", "linear_decoder", "    tau=30\n") + output() +
      "input.out->encoder.in[3]\nencoder.out->decoder.in[3]\ndecoder.out->output.in[8]\n";
  const ZmqPeer peer(in_port_, out_port_, three_readings);
  ASSERT_TRUE(peer.bound());
  const Outcome outcome = run(job_.command(text));
  expect_clean(outcome);
  EXPECT_THAT(warnings(outcome),
              ElementsAre("warning: port 'in' has 3 channels and port 'out' 8: outputs from "
                          "channel 3 on stay 0; make both connections equally wide"))
      << outcome.text();
  const auto heard = peer.heard();
  ASSERT_FALSE(heard.empty()) << outcome.text();
  // A current of at most 475 + 100 pA into 40 MOhm drives a neuron with these constants at most
  // this fast, and 2 s are short against tau.
  const double most = 1 / (0.002 + 0.01 * std::log(23.0 / (23.0 - 15.0)));
  const json& last = heard.back();
  ASSERT_EQ(last.size(), 8U);
  double total = 0;
  for (unsigned channel = 0; channel < 8; ++channel) {
    const double spikes = last[channel].get<double>() * 30;
    total += spikes;
    EXPECT_GE(spikes, 0);
    EXPECT_LE(spikes, channel < 3 ? 2 * most + 1 : 0) << channel;
  }
  // Encoders and thresholds are drawn: a neuron may be silent, but not all three.
  EXPECT_GE(total, 2 * most / 4) << "a quarter of what one neuron could fire";
}

// Keys that never did anything, or do nothing any more, are no fault in a strict file either.
TEST_F(OlderZmqExample, NeuronsReachAScriptUnderAPortOfItsOwn) {
  job_.stand_in("neurons.py");
  const std::string text = fmt::format(
      "stoptime=2.\nrtf=1.0\nmusic_timestep=0.001\ndialect=ma\n"
      "[sensor]\n  binary=zmq_cont_adapter\n  args=\n  np=1\n  message_type=GymObservation\n"
      "  zmq_topic=\n  zmq_addr=tcp://localhost:{}\n"
      "[encoder]\n  binary=nef_encoder\n  args=\n  np=1\n  one_hot=false\n  verbose=false\n"
      "  neuron_resolution=0.001\n"
      "[nest]\n  binary=./neurons.py\n  args=\n  np=1\n"
      "sensor.out->encoder.in[3]\nencoder.out->nest.sensory[100]\n",
      in_port_);
  const ZmqPeer peer(in_port_, out_port_, three_readings);
  ASSERT_TRUE(peer.bound());
  for (const std::string first : {"", "strict=true\n"}) {
    const Outcome outcome = run(job_.command(first + text));
    expect_clean(outcome);
    EXPECT_THAT(warnings(outcome), ElementsAre()) << outcome.text();
    EXPECT_THAT(outcome.text(), testing::ContainsRegex("stand-in: [1-9][0-9]* spikes, highest "
                                                       "channel [1-9][0-9]"));
  }
}

// The observation has one entry and the port three channels: the older program left the others 0.
TEST_F(OlderZmqExample, CommandsFromAShortObservation) {
  const std::string text =
      "stoptime=2.\nrtf=1.\n" + input() +
      output("    message_type=GymCommand\n    zmq_topic=commands\n    min=-1\n    max=1\n") +
      "input.out->output.in[3]\n";
  const ZmqPeer peer(in_port_, out_port_, [] { return json{reading(0.8, -1, 1)}; });
  ASSERT_TRUE(peer.bound());
  const Outcome outcome = run(job_.command(text));
  expect_clean(outcome);
  EXPECT_THAT(warnings(outcome),
              ElementsAre(Fault(fmt::format(
                  "warning: tcp://localhost:{}: ... 1 ... 3 ... 0 ... [1] ...", in_port_))));
  const auto heard = peer.heard();
  ASSERT_FALSE(heard.empty()) << outcome.text();
  for (const json& message : heard) {
    ASSERT_EQ(message.size(), 3U);
    EXPECT_NEAR(message[0]["value"].get<double>(), 0.8, 1e-12);
    EXPECT_EQ(message[1]["value"], 0.0);
    EXPECT_EQ(message[2]["value"], 0.0);
    EXPECT_EQ(message[0]["min"], -1.0);
    EXPECT_EQ(message[0]["max"], 1.0);
    EXPECT_NEAR(message[0]["ts"].get<double>(), unix_time(), 60);
  }
}

TEST_F(OlderZmqExample, SaysWhichKeysTheOlderProgramsDemandedToo) {
  const std::string connection = "input.out->output.in[3]\n";
  EXPECT_THAT(run(job_.command("stoptime=1.\n" + input("") + output() + connection)).text(),
              HasSubstr("section 'input' has no message_type; write message_type=GymObservation "
                        "or FloatArray"));
}

// The older decoder wrote past its memory here.
TEST_F(OlderZmqExample, SurplusNeuronsHaveNoOutput) {
  const std::string text =
      "stoptime=0.5\n" + input() + section("encoder", "nef_encoder", "") +
      section("decoder", "linear_decoder", "") + output() +
      "input.out->encoder.in[3]\nencoder.out->decoder.in[5]\ndecoder.out->output.in[2]\n";
  const ZmqPeer peer(in_port_, out_port_, three_readings);
  ASSERT_TRUE(peer.bound());
  const Outcome outcome = run(job_.command(text));
  expect_clean(outcome);
  EXPECT_THAT(warnings(outcome),
              ElementsAre(Fault("warning: port 'in' has 5 ... 'out' 2 ... 2 ...")));
}

TEST_F(OlderZmqExample, StrictDoesNotDecodeOntoAWiderPort) {
  const std::string text = "stoptime=1.\nstrict=true\n" + input() +
                           section("encoder", "nef_encoder", "") +
                           section("decoder", "linear_decoder", "    tau=30\n") + output() +
                           "input.out->encoder.in[3]\nencoder.out->decoder.in[3]\n"
                           "decoder.out->output.in[8]\n";
  const Outcome outcome = run(job_.command(text));
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_THAT(outcome.text(), Fault("... port 'in' has 3 ... 'out' 8 ... [SL0306] ..."));
}

}  // namespace
}  // namespace spikeloop::test
