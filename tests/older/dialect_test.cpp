// Defaults that depend on the dialect, seen from outside: how many spikes reach the next program
// while no message comes, and when a job without `stoptime` ends.
#include <fmt/format.h>

#include <cmath>

#include "older_job.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/roscore.hpp"

namespace spikeloop::test {
namespace {

/// A sensor that hears nobody, an encoder, and a script that counts for `seconds`. The encoder gets
/// nothing: it encodes its start value.
std::string silent_job(const std::string& globals, const std::string& encoder,
                       const std::string& seconds = "2") {
  static const ReservedPort nobody;
  return fmt::format(
      "sync=unpaced\nmusic_timestep=0.01\n{}\n"
      "[input]\n  binary=zmq_cont_adapter\n  np=1\n  message_type=FloatArray\n"
      "  zmq_addr=tcp://localhost:{}\n"
      "[encoder]\n  binary={}\n  np=1\n"
      "[nest]\n  binary=./script.py\n  args=-s 0.01 -t {}\n  np=1\n"
      "input.out->encoder.in[1]\nencoder.out->nest.in[1]\n",
      globals, nobody.number(), encoder, seconds);
}

long spikes_in(const Outcome& outcome) {
  const std::string text = outcome.text();
  const auto place = text.find("stand-in: ");
  return place == std::string::npos ? -1 : std::stol(text.substr(place + 10));
}

class DialectOfAJob : public testing::Test {
 protected:
  void SetUp() override { job_.stand_in("script.py"); }
  OlderJob job_;
};

TEST_F(DialectOfAJob, HasSilentEncodersUnlessAnInitialValueIsWritten) {
  const std::string rates = "stoptime=2\nrate_min=10\nrate_max=100\n";
  const std::vector<std::pair<std::string, double>> expected = {
      {"", 0},
      {"initial=-1\n", 10},  // as rma began
      {"initial=0\n", 55},   // as ma began
  };
  for (const auto& [keys, rate] : expected) {
    // `initial` is a key of the sensor, too, which must have no value here.
    const Outcome outcome = run(job_.command(silent_job(rates, "rate_encoder\n  " + keys)));
    expect_clean(outcome);
    EXPECT_NEAR(static_cast<double>(spikes_in(outcome)), 2 * rate, 2) << keys << outcome.text();
  }
}

// The script goes on for 3 s; the encoder ends after the 1 s that dialect ma has for stoptime.
TEST_F(DialectOfAJob, OfMusicAdaptersEndsAfterASecond) {
  const std::string text =
      silent_job("dialect=auto\nrate_min=10\n", "rate_encoder\n  initial=0", "3");
  const Outcome launched = run(job_.command(text));
  expect_clean(launched);
  EXPECT_NEAR(static_cast<double>(spikes_in(launched)), 55, 2) << launched.text();
  // And without the launcher: the program itself knows its job.
  Command plain = music_job(job_.directory, 3, text);
  plain.environment["PATH"] = std::string(SPIKELOOP_BIN) + ":" + getenv("PATH");
  const Outcome outcome = run(plain);
  expect_clean(outcome);
  EXPECT_NEAR(static_cast<double>(spikes_in(outcome)), 55, 2) << outcome.text();
}

TEST_F(DialectOfAJob, CannotBeChosenForAJobOfBothFamilies) {
  const ReservedPort in;
  const ReservedPort out;
  const std::string text = fmt::format(
      "stoptime=1\ndialect=auto\n"
      "[input]\n  binary=zmq_cont_adapter\n  np=1\n  message_type=FloatArray\n"
      "  zmq_addr=tcp://localhost:{}\n"
      "[halves]\n  binary=connect_adapter\n  np=1\n  weights=uniform\n"
      "[output]\n  binary=cont_zmq_adapter\n  np=1\n  message_type=FloatArray\n"
      "  zmq_addr=tcp://*:{}\ninput.out->halves.in[1]\nhalves.out->output.in[1]\n",
      in.number(), out.number());
  const Outcome outcome = run(job_.command(text));
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_THAT(outcome.text(),
              Fault("... old.music:2:1: dialect=auto cannot choose: connect_adapter ... and "
                    "zmq_cont_adapter ... dialect=rma or dialect=ma ... [SL0205] ..."));
}

}  // namespace
}  // namespace spikeloop::test
