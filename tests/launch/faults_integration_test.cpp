// Every way in which a program of a chain can fail, at every place and at every time: the launcher
// ends soon, names the culprit, and leaves nothing behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "tests/launch/launcher.hpp"

namespace spikeloop::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

// Of start and of standing still, where they are what ends the job.
constexpr int kStart_s = 5;
constexpr int kStall_s = 3;

struct FaultCase {
  const char* behaviour;
  const char* when;
  int place;          ///< in the chain
  int exit_code;      ///< -1: any but 0
  const char* words;  ///< in the last line
  bool governed;      ///< by a deadline
};

void PrintTo(const FaultCase& fault, std::ostream* out) {
  *out << fault.behaviour << " at " << fault.when << ", place " << fault.place;
}

/// source -> relay -> sink, of which one misbehaves.
std::string chain(const FaultCase& fault) {
  const char* const ports[] = {"input=no", "", "output=no"};
  std::string text = "stoptime=0.5\n";
  for (int i = 0; i < 3; ++i) {
    text += "[p" + std::to_string(i) + "]\nnp=1\nbinary=./spikeloop-network\nname=p" +
            std::to_string(i) + "\n" + ports[i] + "\n";
    if (i == fault.place) {
      text += "behaviour=" + std::string(fault.behaviour) + "\nwhen=" + fault.when + "\n";
    }
  }
  return text + "p0.out -> p1.in [1]\np1.out -> p2.in [1]\n";
}

class Faults : public testing::TestWithParam<FaultCase> {};

TEST_P(Faults, AreNamedAndLeaveNothingBehind) {
  const FaultCase& fault = GetParam();
  const TemporaryDirectory directory;
  std::filesystem::create_symlink(SPIKELOOP_TEST_PROGRAM, directory.path() / "spikeloop-network");
  const std::string file = directory.write("chain.music", chain(fault));
  const bool at_start = fault.when == std::string_view("start");
  const std::string start = fault.governed && at_start ? std::to_string(kStart_s) : "30";
  const std::string stall = fault.governed && !at_start ? std::to_string(kStall_s) : "30";
  const auto begin = std::chrono::steady_clock::now();
  const Outcome outcome =
      run(launcher({"run", file, "--start-timeout", start, "--stall-timeout", stall}));
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  std::printf("%-12s %-6s place %d: exit %3d after %.1f s, %d left: %s\n", fault.behaviour,
              fault.when, fault.place, outcome.exit_code, taken.count(), outcome.left_behind,
              last_line(outcome.err).c_str());
  if (fault.exit_code >= 0) {
    EXPECT_EQ(outcome.exit_code, fault.exit_code) << outcome.text();
  } else {
    EXPECT_NE(outcome.exit_code, 0) << outcome.text();
  }
  EXPECT_THAT(last_line(outcome.err), HasSubstr(fault.words)) << outcome.text();
  if (outcome.exit_code != 0) {
    const std::string line = last_line(outcome.err);
    EXPECT_THAT(line.substr(0, line.find("waiting for the others")),
                HasSubstr("'p" + std::to_string(fault.place) + "'"));
  }
  EXPECT_EQ(outcome.left_behind, 0);
  EXPECT_LT(taken, 15s);
}

std::vector<FaultCase> everywhere() {
  const FaultCase kinds[] = {
      {"exit", "start", 0, 7, "exit code 7; its last line: ValueError: no such synapse", false},
      {"exit", "middle", 0, 7, "exit code 7", false},
      // Open MPI 4.1 may miss the end of a program for which the others wait in MPI_Finalize; the
      // launcher then sees that it has gone, but not how.
      {"exit", "end", 0, -1, "its last line: ValueError: no such synapse", false},
      {"leave", "start", 0, -1, "ended without MUSIC's finalize", false},
      {"leave", "middle", 0, -1, "ended without MUSIC's finalize", false},
      {"throw", "start", 0, 134, "signal 6 (Aborted)", false},
      {"throw", "middle", 0, 134, "signal 6 (Aborted)", false},
      {"crash", "middle", 0, 139, "signal 11 (Segmentation fault)", false},
      {"die", "start", 0, 137, "signal 9 (Killed)", false},
      {"die", "middle", 0, 137, "signal 9 (Killed)", false},
      {"die", "end", 0, -1, "", false},
      {"abort", "start", 0, 9, "exit code 9", false},
      {"abort", "middle", 0, 9, "exit code 9", false},
      {"hang", "start", 0, 3, "the job has not begun within 5 s; ", true},
      {"hang", "middle", 0, 3, "does not come to the end of its step", true},
      {"hang", "end", 0, 3, "has left its loop, but does not end", true},
      {"freeze", "start", 0, 3, "the job has not begun within 5 s; ", true},
      {"freeze", "middle", 0, 3, "neither ticks nor answers", true},
      {"finalize_mpi", "middle", 0, 3, "does not come to the end of its step", true},
      {"end_early", "middle", 0, 3, "before its stoptime of 0.5 s", false},
  };
  std::vector<FaultCase> all;
  for (FaultCase fault : kinds) {
    for (fault.place = 0; fault.place < 3; ++fault.place) {
      all.push_back(fault);
    }
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Everywhere, Faults, testing::ValuesIn(everywhere()),
                         [](const auto& instance) {
                           return std::string(instance.param.behaviour) + "_at_" +
                                  instance.param.when + "_" + std::to_string(instance.param.place);
                         });

TEST(SlowStart, IsForgivenWhileTheProgramSaysThatItPrepares) {
  const TwoPrograms job("", "behaviour=prepare_long");
  const Outcome outcome = run(job.command({"--start-timeout", "2"}));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
}

}  // namespace
}  // namespace spikeloop::test
