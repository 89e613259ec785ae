// What a user did wrong: one line that says what, where and what to write; the error's exit code;
// and no process left hanging.
#include "job.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

// The job ended with this exit code and said what is like this line.
void expect_error(const Job& job, int exit_code, const std::string& line) {
  auto command = job.command();
  command.timeout = std::chrono::seconds(30);
  const auto outcome = test::run(command);
  EXPECT_FALSE(outcome.timed_out);
  EXPECT_EQ(outcome.exit_code, exit_code) << outcome.text();
  EXPECT_THAT(outcome.text(), Fault("... " + line + "\n ..."));
  EXPECT_EQ(outcome.left_behind, 0);
}

Job& encoder_job(Job& job, const std::string& keys,
                 const std::string& connection = "source.values -> encoder.in [3]") {
  job.global("stoptime=0.01");
  job.raw("sink").ours("encoder", "rate_encoder", keys).raw("source", "map_out=3");
  return job.connect(connection).connect("encoder.out -> sink.spikes_in [3]");
}

TEST(Errors, AConnectionWithoutWidthSaysWhereToWriteIt) {
  Job job;
  encoder_job(job, "", "source.values -> encoder.in");
  expect_error(job, 2,
               "encoder: " + job.place("source.values") +
                   ": the connection to 'encoder.in' has no width; write  "
                   "source.values -> encoder.in [100]  for 100 channels [SL0307]");
}

TEST(Errors, AnUnconnectedPortSaysHowToConnectIt) {
  Job job;
  job.global("stoptime=0.01");
  job.raw("sink").ours("encoder", "rate_encoder").connect("encoder.out -> sink.spikes_in [3]");
  expect_error(job, 2,
               "encoder: input 'encoder.in' is not connected; write for example  "
               "SENDER.out -> encoder.in [10] [SL0305]");
}

TEST(Errors, APortThatIsNotThereIsNamedBeforeMusicHangs) {
  Job job;
  job.global("stoptime=0.01");
  job.raw("sink").ours("encoder", "rate_encoder").raw("source");
  job.connect("source.values -> encoder.in [3]").connect("encoder.outt -> sink.spikes_in [3]");
  expect_error(job, 2,
               "encoder: " + job.place("encoder.outt") +
                   ": 'encoder' has no output port 'outt'; did you mean 'out'? [SL0302]");
}

TEST(Errors, AMisspeltInputIsNamedRatherThanTheMissingOne) {
  Job job;
  encoder_job(job, "", "source.values -> encoder.inn [3]");
  expect_error(
      job, 2,
      "encoder: " + job.place("encoder.inn") + ": 'encoder' ... 'inn' ... 'in' ... [SL0302]");
}

TEST(Errors, NoPortAtAll) {
  Job job;
  job.global("stoptime=0.01");
  job.raw("sink").raw("source").node("cell", "edge_spiker");
  job.connect("source.values -> sink.values_in [3]");
  expect_error(
      job, 2,
      "cell: no port of 'cell' is connected, and MUSIC would wait forever; connect one, or "
      "leave the section out [SL0305]");
}

TEST(Errors, APortInTheWrongDirection) {
  Job job;
  job.global("stoptime=0.01");
  job.raw("other").ours("encoder", "rate_encoder").raw("source");
  job.connect("source.values -> encoder.in [3]").connect("other.spikes -> encoder.out [3]");
  expect_error(job, 2,
               "encoder: " + job.place("other.spikes") +
                   ": 'encoder.out' is an output, but the file uses it as an input; "
                   "write  encoder.out -> RECEIVER.in [WIDTH] [SL0602]");
}

TEST(Errors, WidthsThatTheNodeCannotJoin) {
  Job job;
  job.global("stoptime=0.01");
  job.raw("sink").ours("encoder", "rate_encoder").raw("source");
  job.connect("source.values -> encoder.in [3]").connect("encoder.out -> sink.spikes_in [4]");
  expect_error(job, 2,
               "encoder: " + job.place("encoder.out ->") +
                   ": port 'encoder.out' has 4 ... 3 ... 'encoder.in' ... [SL0306]");
}

TEST(Errors, AValueThatIsNoNumber) {
  Job job;
  encoder_job(job, "rate_max=fast");
  auto command = job.command();
  const auto outcome = test::run(command);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(outcome.says("encoder: " + job.place("rate_max=fast") + ": key 'rate_max': "))
      << outcome.text();
}

TEST(Errors, AMisspeltKeyIsAWarningAndInAStrictJobAnError) {
  Job lax;
  encoder_job(lax, "rate_mx=5");
  const std::string place = ": unknown key 'rate_mx'; did you mean 'rate_max'?";
  const auto outcome = lax.run();
  expect_clean(outcome);
  EXPECT_TRUE(outcome.says("encoder: warning: " + lax.place("rate_mx") + place +
                           "; it is ignored [SL0103]\n"))
      << outcome.text();
  Job strict;
  encoder_job(strict, "rate_mx=5\nstrict=true");
  expect_error(strict, 2, "encoder: " + strict.place("rate_mx") + place + " [SL0103]");
}

TEST(Errors, BothSpellingsOfTheWeights) {
  Job job;
  job.global("stoptime=0.01");
  job.raw("sink")
      .ours("mean", "connect_adapter", "weights=uniform\nweights_filename=w")
      .raw("source");
  job.connect("source.values -> mean.in [3]").connect("mean.out -> sink.values_in [1]");
  expect_error(
      job, 2,
      "mean: " + job.place("weights_filename") +
          ": 'weights' and 'weights_filename' ... leave out 'weights_filename' ... [SL0102]");
}

TEST(Errors, MoreThanOneProcess) {
  Job job;
  const auto text = std::string("stoptime=0.01\n[encoder]\nbinary=") + PROGRAMS +
                    "/spikeloop-network\nnp=2\n[source]\nbinary=" + RAW_MUSIC +
                    "\nnp=1\nsource.values -> encoder.in [3]\n";
  const auto outcome = test::run(music_job(job.directory, 3, text));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(
      outcome.says("/job.music:4:1: np=2 asks for 2 processes, but spikeloop-network runs in one; "
                   "write  np=1 [SL0602]\n"))
      << outcome.text();
}

TEST(Errors, AnUnknownNodeClass) {
  Job job;
  job.global("stoptime=0.01");
  job.raw("sink").ours("cell", "spikeloop-node", "node=rate_encodr");
  job.connect("cell.out -> sink.spikes_in [3]");
  expect_error(job, 2,
               "cell: " + job.place("node=rate") +
                   ": unknown node class 'rate_encodr'; did you mean "
                   "'rate_encoder'? [SL0401]");
}

TEST(Errors, ANodeThatFailsInTheMiddleEndsTheJobAtOnce) {
  Job job;
  job.global("stoptime=1000000");
  job.raw("sink")
      .node("cell", "edge_spiker", "fail_at=0.05")
      .connect("cell.out -> sink.spikes_in [2]");
  expect_error(job, 5, "cell: node 'cell': the cell has burst (plug-in '" TEST_NODES "') [SL0704]");
}

TEST(Errors, AnArgumentIsIgnoredWithAWarning) {
  const std::string words =
      "args=--rate 5 is for rate_encoder, whose parameters are keys of the section; leave it out";
  Job job;
  encoder_job(job, "args=--rate 5");
  const auto outcome = job.run();
  expect_clean(outcome);
  EXPECT_TRUE(outcome.says(words + "; it is ignored [SL0602]\n")) << outcome.text();
  Job strict;
  encoder_job(strict, "args=--rate 5\nstrict=true");
  EXPECT_TRUE(strict.run().says(words + " [SL0602]\n"));
}

TEST(Errors, WithoutALineNumberWhenTheFileIsOutOfReach) {
  // Behind `wd`, and without PWD, the program cannot find the file again.
  Job job;
  const auto text = std::string("stoptime=0.01\n[encoder]\nwd=/\nbinary=") + PROGRAMS +
                    "/rate_encoder\nnp=1\nrate_max=fast\n[source]\nbinary=" + RAW_MUSIC +
                    "\nnp=1\nsource.values -> encoder.in [3]\n";
  auto command = music_job(job.directory, 2, text);
  command.arguments.back() = "job.music";
  // mpirun sets PWD; a shell in between takes it away.
  command.arguments[command.arguments.size() - 2] = "env";
  command.arguments.insert(command.arguments.end() - 1, {"-u", "PWD", "music"});
  const auto outcome = test::run(command);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(outcome.says("encoder: key 'rate_max': ")) << outcome.text();
}

}  // namespace
}  // namespace spikeloop::test
