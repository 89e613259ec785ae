// Begin and end of jobs: barrier, early ends, stop requests, deaths.
#include "job.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/record/reader.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

using namespace std::chrono_literals;

std::string spikes(const Job& job, int ticks) {
  std::string text;
  for (int k = 0; k < ticks; ++k) {
    text += std::to_string(k) + " " + std::to_string(0.001 * k + 0.0005) + " 0\n";
  }
  return "spikes=" + job.directory.write("spikes.txt", text);
}

void three(Job& job, const std::string& sink, const std::string& relay, const std::string& source) {
  job.raw("sink", sink)
      .node("relay", "spike_relay", relay)
      .raw("source", spikes(job, 50) + "\n" + source);
  job.connect("source.spikes -> relay.in [1]").connect("relay.out -> sink.spikes_in [1]");
}

TEST(Control, RunsBesideProgramsWithoutABarrier) {
  Job job;
  job.global("stoptime=0.05").global("barrier=false");
  three(job, "", "", "");
  expect_clean(job.run());
  EXPECT_EQ(job.events("sink").size(), 50u);
}

TEST(Control, TheBarrierIsOurDefaultAndTheOthersMustHaveIt) {
  Job job;
  job.global("stoptime=0.05");
  three(job, "", "", "barrier=false");
  auto command = job.command();
  command.timeout = 5s;
  EXPECT_TRUE(test::run(command).timed_out);
}

TEST(Control, WorksWithMusicsOwnPrograms) {
  // constsource ships with MUSIC: the value of channel i is i, no barrier.
  const std::string tools = "/usr/lib/x86_64-linux-gnu/music-1.1.16";
  if (access((tools + "/constsource").c_str(), X_OK) != 0) {
    GTEST_SKIP() << "MUSIC's programs are not installed in " << tools;
  }
  const TemporaryDirectory directory;
  const std::string text =
      "stoptime=0.05\nbarrier=false\n[sink]\nnp=1\nlog=sink.log\nbinary=" + std::string(RAW_MUSIC) +
      "\n[relay]\nnp=1\nnode=signal_relay\nplugin=" + TEST_NODES + "\nbinary=" + PROGRAMS +
      "/spikeloop-node\n[source]\nnp=1\nbinary=" + tools + "/constsource\nargs=-t 0.001\n" +
      "source.contdata -> relay.in [4]\nrelay.out -> sink.values_in [4]\n";
  const auto outcome = test::run(music_job(directory, 3, text));
  expect_clean(outcome);
  EXPECT_NE(directory.read("sink.log").find("value 40 0 1 2 3"), std::string::npos)
      << outcome.text() << directory.read("sink.log");
}

class EarlyEnd : public testing::TestWithParam<int> {};

TEST_P(EarlyEnd, OfAnyMemberIsClean) {
  Job job;
  const auto stop = [](int member) {
    return member == GetParam() ? "stoptime=0.02" : "stoptime=0.05";
  };
  three(job, stop(0), stop(1), stop(2));
  expect_clean(job.run());
  // A sink that ends early still hears in finalize() what comes.
  EXPECT_EQ(job.events("sink").size(), GetParam() == 0 ? 50u : 20u);
}
INSTANTIATE_TEST_SUITE_P(Members, EarlyEnd, testing::Values(0, 1, 2));

TEST(Control, TwoJobsAtOnceDoNotDisturbEachOther) {
  Job jobs[2];
  for (auto& job : jobs) {
    job.global("stoptime=0.05");
    three(job, "", "", "");
  }
  Child first(jobs[0].command());
  Child second(jobs[1].command());
  expect_clean(first.wait());
  expect_clean(second.wait());
  EXPECT_EQ(jobs[0].events("sink").size(), 50u);
  EXPECT_EQ(jobs[1].events("sink").size(), 50u);
}

// Two nodes that run until stopped, paced in real time.
void endless(Job& job) {
  job.global("dialect=rma");
  job.node("relay", "spike_relay", "record=true").node("cell", "edge_spiker", "clock_master=true");
  job.connect("cell.out -> relay.in [2]").connect("relay.out -> end.in [2]");
  job.node("end", "spike_relay");
}

constexpr std::size_t kRecorded = 100;

std::size_t recorded(const Job& job) {
  return record::read_spikes((job.directory.path() / "relay.h5").string(), "out").spikes.size();
}

/// Until more than `kRecorded` spikes are in the file: how many.
std::size_t wait_until_running(Child& child, const Job& job) {
  for (int i = 0; i < 1200; ++i) {
    try {
      if (const std::size_t spikes = recorded(job); spikes > kRecorded) {
        return spikes;
      }
    } catch (const Error&) {  // not made yet, or caught in the middle of a flush
    }
    child.output();
    std::this_thread::sleep_for(50ms);
  }
  return 0;
}

TEST(Control, UserSignal1ToMpirunEndsCleanly) {
  Job job;
  endless(job);
  Child child(job.command());
  ASSERT_TRUE(wait_until_running(child, job)) << child.output();
  child.signal(SIGUSR1);
  const auto outcome = child.wait();
  expect_clean(outcome);
  EXPECT_EQ(outcome.text(), "mpirun: Forwarding signal 10 to job\n");
  const auto file = (job.directory.path() / "relay.h5").string();
  EXPECT_TRUE(record::read_info(file).complete);
}

TEST(Control, TerminationOfMpirunFlushesFilesAndLeavesNothing) {
  Job job;
  endless(job);
  Child child(job.command());
  const std::size_t before = wait_until_running(child, job);
  ASSERT_GT(before, 0u) << child.output();
  std::this_thread::sleep_for(300ms);  // the next flush by time comes after a second
  child.signal(SIGTERM);
  const auto outcome = child.wait();
  EXPECT_FALSE(outcome.timed_out);
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_EQ(outcome.left_behind, 0);
  // mpirun sends SIGKILL some 10 ms after SIGTERM. What was written before must be there, unless
  // the process was killed while it wrote the file's index (docs/run-folder.md).
  try {
    EXPECT_GT(recorded(job), before + 100) << outcome.text();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(),
                Fault("cannot read '" + (job.directory.path() / "relay.h5").string() + "': ..."));
  }
}

TEST(Control, ProgramsDieWithMpirunThatIsKilled) {
  Job job;
  endless(job);
  Child child(job.command());
  ASSERT_TRUE(wait_until_running(child, job)) << child.output();
  child.signal(SIGKILL);
  const auto outcome = child.wait();
  EXPECT_EQ(outcome.exit_code, 137);
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(Control, AProgramThatIsKilledEndsTheJob) {
  Job job;
  endless(job);
  Child child(job.command());
  ASSERT_TRUE(wait_until_running(child, job)) << child.output();
  for (const auto pid : child.family()) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/environ", std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (text.find("_MUSIC_CONFIG_=cell:") != std::string::npos) {
      ::kill(pid, SIGKILL);
    }
  }
  const auto outcome = child.wait();
  EXPECT_FALSE(outcome.timed_out);
  EXPECT_EQ(outcome.exit_code, 137) << outcome.text();
  EXPECT_EQ(outcome.left_behind, 0);
}

TEST(Control, RunsWithoutMusicsLauncherToo) {
  Job job;
  job.global("stoptime=0.05");
  three(job, "", "", "");
  auto command = job.command();
  const std::string file = command.arguments.back();
  command.arguments = {"mpirun", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1"};
  const char* separator = "";
  for (const auto& [program, label] : std::vector<std::pair<std::string, std::string>>{
           {RAW_MUSIC, "sink"}, {PROGRAMS "/spikeloop-node", "relay"}, {RAW_MUSIC, "source"}}) {
    if (*separator != 0) {
      command.arguments.push_back(separator);
    }
    for (const auto& word :
         {std::string("-np"), std::string("1"), program, std::string("--music-config"), file,
          std::string("--app-label"), label}) {
      command.arguments.push_back(word);
    }
    separator = ":";
  }
  expect_clean(test::run(command));
  EXPECT_EQ(job.events("sink").size(), 50u);
}

TEST(Control, RealtimeIsKeptByTheClockMaster) {
  Job job;
  job.global("stoptime=0.5");
  three(job, "", "", "");
  const auto unpaced = job.run();
  expect_clean(unpaced);
  for (const std::string key : {"clock_master", "pace"}) {  // the latter is its earlier name
    Job paced;
    paced.global("stoptime=0.5\nstrict=true");
    paced.raw("sink").node("cell", "edge_spiker", key + "=true\nrtf=0.5");
    paced.connect("cell.out -> sink.spikes_in [2]");
    const auto slow = paced.run();
    expect_clean(slow);
    EXPECT_GE(slow.seconds, 0.998);  // 499 waits of 2 ms: a lower bound that no load can break
    EXPECT_EQ(paced.events("sink").size(), 1000u);
  }
}

}  // namespace
}  // namespace spikeloop::test
