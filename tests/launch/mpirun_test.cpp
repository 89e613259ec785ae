// mpirun's command line and its output.
#include "spikeloop/launch/mpirun.hpp"
#include "spikeloop/processes/python.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <optional>

#include "tests/support/temporary_directory.hpp"

namespace spikeloop::launch {
namespace {

using testing::ElementsAre;

constexpr const char* kJob =
    "[a]\nnp=1\nbinary=x\n[b]\nnp=3\nbinary=y\n[c]\nnp=1\nbinary=z\na.out -> b.in\nb.out -> c.in\n";

TEST(MpirunCommand, AsksForAsManyProcessesAsTheFile) {
  EXPECT_EQ(shell_text(mpirun_command(parse_music(kJob, "f"), "/run/x.music",
                                      {.scratch = "/s", .hostfile = {}})),
            "mpirun -np 5 --oversubscribe --bind-to none --mca mpi_yield_when_idle 1 --mca "
            "opal_abort_print_stack 1 --mca opal_signal '' --mca orte_tmpdir_base /s --mca "
            "btl_vader_backing_directory /s --mca mpi_event_tick_rate 1000000 --mca pml ob1 "
            "--mca btl vader,self --tag-output music /run/x.music");
}

TEST(MpirunCommand, OnSeveralHostsPassesOnTheEnvironment) {
  const std::string line = shell_text(
      mpirun_command(parse_music(kJob, "f"), "/run/x.music",
                     {.scratch = {}, .hostfile = "hosts", .variables = {"PATH", "ROS_IP"}}));
  EXPECT_THAT(line, testing::HasSubstr(" --hostfile hosts -x PATH -x ROS_IP --tag-output "));
  EXPECT_THAT(line, testing::Not(testing::HasSubstr("orte_tmpdir_base")));
}

/// Sets a variable for a test, or takes it away.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name); before != nullptr) {
      before_ = before;
    }
    value == nullptr ? ::unsetenv(name) : ::setenv(name, value, 1);
  }
  ~Variable() { before_ ? ::setenv(name_, before_->c_str(), 1) : ::unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

TEST(MpirunCommand, LeavesAChoiceOfNetworksToTheUser) {
  const Variable layers("OMPI_MCA_btl", "self,tcp");
  const auto command = mpirun_command(parse_music(kJob, "f"), "/run/x.music", {});
  EXPECT_THAT(command, testing::Not(testing::Contains("pml")));
}

TEST(MpirunCommand, OnSeveralHostsNodesLookForEachOtherAsHere) {
  const Variable domain("ROS_DOMAIN_ID", "7");
  const Variable range("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST");
  const Variable peers("ROS_STATIC_PEERS", "192.0.2.7");
  const Variable distribution("ROS_DISTRO", "jazzy");
  const Variable here("ROS_LOCALHOST_ONLY", nullptr);
  const Variable settings("CYCLONEDDS_URI", nullptr);
  const Variable master("ROS_MASTER_URI", "http://robot:11311");
  const auto variables = [](const std::string& keys) {
    const std::string text = "[a]\nnp=1\nbinary=ros_sensor_adapter\n" + keys;
    const auto names = variables_of_job(parse_music(text, "f"));
    return std::vector<std::string>(names.begin() + 5, names.end());  // those of every job
  };
  const std::vector<std::string> of_ros2{"ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE",
                                         "ROS_STATIC_PEERS", "ROS_DISTRO"};
  EXPECT_EQ(variables("ros=2\n"), of_ros2);
  EXPECT_THAT(variables(""), ElementsAre("ROS_MASTER_URI"));
}

TEST(SrunCommand, NamesEachSectionsRanksAndProgram) {
  const MusicFile file = parse_music(std::string(kJob) + "[a]\nwd=my dir\n", "f");
  EXPECT_EQ(multi_prog_text(file, "/job/x.music"),
            "# for: srun --multi-prog; ranks, program\n"
            "0  sh -c 'cd '\\''my dir'\\'' && exec x --music-config /job/x.music --app-label a'\n"
            "1-3  y --music-config /job/x.music --app-label b\n"
            "4  z --music-config /job/x.music --app-label c\n");
  EXPECT_EQ(shell_text(srun_command(file, "/job/programs.conf", "/home")),
            "srun -n 5 --mpi=pmix --overcommit --cpu-bind=none --kill-on-bad-exit=1 --chdir /home "
            "--export ALL,OMPI_MCA_mpi_yield_when_idle=1 --multi-prog /job/programs.conf");
}

TEST(MpirunCommand, FindsOurProgramsFirst) {
  const auto environment = program_environment();
  EXPECT_EQ(environment.at("PATH").find(own_directory() + ":"), 0u);
  EXPECT_EQ(environment.contains("OMPI_ALLOW_RUN_AS_ROOT"), geteuid() == 0);
}

TEST(LabelOfRank, CountsTheProcessesOfEachSection) {
  const MusicFile file = parse_music(kJob, "f");
  std::vector<std::string> labels;
  for (int rank = 0; rank < 6; ++rank) {
    labels.push_back(label_of_rank(file, rank));
  }
  EXPECT_THAT(labels, ElementsAre("a", "b", "b", "b", "c", ""));
}

TEST(ShellText, QuotesWhatAShellWouldTakeApart) {
  EXPECT_EQ(shell_text({"mpirun", "-np", "2", "a b", "it's", ""}),
            "mpirun -np 2 'a b' 'it'\\''s' ''");
}

TEST(FindExecutable, LooksWhereExecvpLooks) {
  const test::TemporaryDirectory directory;
  const std::string program = directory.write("tool", "#!/bin/sh\n");
  const std::string here = directory.path().string();
  EXPECT_EQ(find_executable("tool", "/", here), "") << "not executable";
  chmod(program.c_str(), 0755);
  EXPECT_EQ(find_executable("tool", "/", "/nowhere:" + here), program);
  EXPECT_EQ(find_executable("tool", here, "/nowhere:"), here + "/./tool");
  EXPECT_EQ(find_executable("./tool", here, ""), here + "/./tool");
  EXPECT_EQ(find_executable(program, "/", ""), program);
  EXPECT_EQ(find_executable("tool", here, "/nowhere"), "");
  EXPECT_EQ(find_executable("", here, here), "");
}

std::vector<std::string> lines_of(const std::vector<std::string>& pieces) {
  std::vector<std::string> lines;
  TaggedOutput output(true, [&lines](const OutputLine& line) {
    lines.push_back((line.rank ? std::to_string(*line.rank) : "mpirun") +
                    (line.error ? " err " : " out ") + line.text);
  });
  for (const std::string& piece : pieces) {
    output.feed(piece);
  }
  output.finish();
  return lines;
}

TEST(TaggedOutput, TellsProgramsFromMpirun) {
  EXPECT_THAT(lines_of({"[1,0]<stdout>:one\n[1,12]<std", "err>:two\n---\n", "[1,0]<stdout>:\nx"}),
              ElementsAre("0 out one", "12 err two", "mpirun err ---", "0 out ", "mpirun err x"));
}

TEST(TaggedOutput, JoinsWhatMpirunReadInPieces) {
  EXPECT_THAT(lines_of({"[1,0]<stdout>:a long[1,0]<stdout>: line\n"}),
              ElementsAre("0 out a long line"));
  EXPECT_THAT(lines_of({"[1,0]<stdout>:be[1,1]<stdout>:whole\n[1,0]<stdout>:gin\n"}),
              ElementsAre("1 out whole", "0 out begin"));
  EXPECT_THAT(lines_of({"[1,0]<stdout>:no end"}), ElementsAre("0 out no end"));
  EXPECT_THAT(lines_of({"ssh: no route\r\n"}), ElementsAre("mpirun err ssh: no route"));
}

TEST(TaggedOutput, ARuleOfMpirunMayComeInTheMiddleOfALine) {
  const std::string rule(74, '-');
  EXPECT_THAT(
      lines_of({"[1,0]<stderr>:Error in MUSIC library: " + rule + "\nMPI_ABORT was invoked\n" +
                rule + "\n[1,1]<stderr>:two\n[1,0]<stderr>:too short latency\n"}),
      ElementsAre("mpirun err " + rule, "mpirun err MPI_ABORT was invoked", "mpirun err " + rule,
                  "1 err two", "0 err Error in MUSIC library: too short latency"));
  EXPECT_THAT(lines_of({"[1,0]<stderr>:" + rule + "\n[1,0]<stderr>:=" + rule + "-\n"}),
              ElementsAre("0 err " + rule, "0 err =" + rule + "-"))
      << "the program's own";
}

TEST(TaggedOutput, LeavesBracketsOfProgramsAlone) {
  EXPECT_THAT(lines_of({"[1,0]<stdout>:[ INFO] [1,2] [1,x]<stdout>:\n[vm:1] lost\n"}),
              ElementsAre("0 out [ INFO] [1,2] [1,x]<stdout>:", "mpirun err [vm:1] lost"));
}

TEST(TaggedOutput, KnowsOpenMpiFromInsideAProgram) {
  EXPECT_THAT(lines_of({"[1,0]<stderr>:[my-pc:123] Signal: Segmentation fault (11)\n",
                        "[1,0]<stdout>:[ INFO] [16.5]: 3:4 a\n[1,0]<stdout>:[12:30] tea\n",
                        "[1,0]<stdout>:[:12] a\n[1,0]<stdout>:[a:] b\n"}),
              ElementsAre("mpirun err [my-pc:123] Signal: Segmentation fault (11)",
                          "0 out [ INFO] [16.5]: 3:4 a", "mpirun out [12:30] tea", "0 out [:12] a",
                          "0 out [a:] b"));
}

TEST(MpirunDiagnosis, ReadsWhoEndedFirst) {
  MpirunDiagnosis killed;
  killed.read("mpirun noticed that process rank 1 with PID 0 on node vm exited on signal 9 (Kil");
  killed.read("mpirun noticed that process rank 2 with PID 0 on node vm exited on signal 15 (T");
  EXPECT_EQ(killed.rank(), 1);
  EXPECT_EQ(killed.signal(), 9);
  MpirunDiagnosis left;
  left.read("  Process name: [[16537,1],2]");
  left.read("  Exit code:    7");
  EXPECT_EQ(left.rank(), 2);
  EXPECT_EQ(left.exit_code(), 7);
  MpirunDiagnosis aborted;
  aborted.read("MPI_ABORT was invoked on rank 3 in communicator MPI_COMM_WORLD");
  aborted.read("with errorcode 5.");
  EXPECT_EQ(aborted.rank(), 3);
  EXPECT_EQ(aborted.exit_code(), 5);
  MpirunDiagnosis improper;
  improper.read("mpirun has exited due to process rank 4 with PID 0 on");
  EXPECT_EQ(improper.rank(), 4);
  EXPECT_FALSE(improper.exit_code());
  EXPECT_FALSE(MpirunDiagnosis().rank());
}

}  // namespace
}  // namespace spikeloop::launch
