// What is found before a job starts.
#include "spikeloop/launch/check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/fault.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::launch {
namespace {

using test::Fault;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> texts_of(const Diagnostics& diagnostics, bool errors) {
  std::vector<std::string> result;
  for (const Diagnostic& found : diagnostics) {
    if (found.is_error() == errors) {
      result.push_back(found.text());
    }
  }
  return result;
}
std::vector<std::string> texts(const Diagnostics& diagnostics) {
  return texts_of(diagnostics, true);
}
std::vector<std::string> warnings(const Diagnostics& diagnostics) {
  return texts_of(diagnostics, false);
}

std::vector<std::string> program_problems(const std::string& text, const std::string& directory) {
  return texts(check_programs(parse_music(text, "loop.music"), directory));
}

TEST(CheckPrograms, NamesTheProgramThatIsMissing) {
  EXPECT_THAT(program_problems("[a]\nbinary=sh\n", "/"), IsEmpty());
  EXPECT_THAT(program_problems("[a]\nbinary=mybrainx\n", "/"),
              ElementsAre("loop.music:2:1: section 'a': there is no program 'mybrainx' in PATH; "
                          "install it, or write its path (./mybrainx) [SL0603]"));
  EXPECT_THAT(program_problems("[a]\nbinary=launch_testz\n", "/"),
              ElementsAre(Fault("loop.music:2:1: section 'a': ... 'launch_testz' in PATH ... "
                                "'launch_tests' ... [SL0603]")));
  const test::TemporaryDirectory directory;
  const std::string here = directory.path().string();
  EXPECT_THAT(
      program_problems("[a]\nbinary=./brain.py\n", here),
      ElementsAre("loop.music:2:1: section 'a': there is no program './brain.py', seen from '" +
                  here + "'; write a path from there, or a name that is in PATH [SL0603]"));
  EXPECT_THAT(program_problems("[a]\nwd=sub\nbinary=sh\n", here),
              ElementsAre("loop.music:2:1: section 'a': there is no directory '" + here +
                          "/sub' to run in; make it, or leave out wd [SL0603]"));
}

TEST(CheckPrograms, SaysHowToInstallMpirun) {
  const std::string before = getenv("PATH");
  setenv("PATH", "/nowhere", 1);
  const Diagnostics diagnostics = check_programs(parse_music("[a]\nbinary=/bin/sh\n", "f"), "/");
  setenv("PATH", before.c_str(), 1);
  EXPECT_THAT(
      texts(diagnostics),
      ElementsAre("cannot find 'mpirun' in PATH; install it (Debian: apt install openmpi-bin)",
                  "cannot find 'music' in PATH; install it (Debian: apt install music-bin)"));
  EXPECT_EQ(diagnostics.front().exit_code, 3);
}

// binary=./x with this text in it.
std::string script_problem(const std::string& text, mode_t mode = 0755) {
  const test::TemporaryDirectory directory;
  chmod(directory.write("x", text).c_str(), mode);
  const auto problems = program_problems("[a]\nbinary=./x\n", directory.path().string());
  return problems.empty() ? "" : problems.front();
}

TEST(CheckPrograms, LooksIntoScripts) {
  EXPECT_EQ(script_problem("#!/bin/sh\n"), "");
  EXPECT_EQ(script_problem("#! /usr/bin/env python3\n"), "");
  EXPECT_EQ(script_problem("#!/bin/sh\n", 0644),
            "loop.music:2:1: section 'a': './x' is there, but is not executable; write  chmod +x "
            "./x [SL0603]");
  EXPECT_EQ(
      script_problem("import nest\n"),
      "loop.music:2:1: section 'a': './x' is neither a program nor a script that says what runs "
      "it; write a first line like '#!/usr/bin/python3' [SL0603]");
  EXPECT_EQ(script_problem("#!/bin/sh\r\n"),
            "loop.music:2:1: section 'a': the first line of './x' ends as on Windows, and its "
            "interpreter will not be found; write  sed -i 's/\\r$//' ./x [SL0603]");
  EXPECT_THAT(script_problem("#!/usr/bin/python7\n"),
              Fault("loop.music:2:1: section 'a': ... './x' names '/usr/bin/python7', which is not "
                    "there; install it ... '#!/usr/bin/python3' ... [SL0603]"));
  EXPECT_THAT(script_problem("#!\n"), HasSubstr("names '', which is not there"));
}

TEST(CheckPrograms, AnInterpreterWouldRunTheMusicFile) {
  EXPECT_THAT(
      program_problems("[a]\nbinary=sh\nargs=brain.py 3\n", "/"),
      ElementsAre("loop.music:2:1: section 'a': binary=sh would run the .music file instead of "
                  "'brain.py 3', because MUSIC hands a program its args only later; write  "
                  "binary=./brain.py  and make that file begin with '#!/usr/bin/env sh' and "
                  "executable (chmod +x) [SL0603]"));
}

Diagnostics together(const std::string& text, const RunOptions& options = {}) {
  return check_together(make_effective(parse_music(text, "f"), options));
}

constexpr const char* kTwo =
    "[a]\nnp=1\nbinary=ros_sensor_adapter\n[b]\nnp=1\nbinary=rate_encoder\na.out -> b.in [3]\n";

TEST(CheckTogether, FindsNothingInAGoodFile) {
  EXPECT_THAT(texts(together(kTwo)), IsEmpty());
  EXPECT_THAT(warnings(together(kTwo)), IsEmpty());
}

TEST(CheckTogether, OneTick) {
  const std::string text = std::string(kTwo) + "music_timestep=0.01\n";
  EXPECT_THAT(
      texts(together(text)),
      ElementsAre("f:8:1: the tick of 'b' is 10 ms, but that of 'a' is 1 ms; MUSIC exchanges "
                  "less and less often between unequal ticks: write one music_timestep at the "
                  "top of the file [SL0602]"));
}

TEST(CheckTogether, OneLength) {
  const std::string text = std::string(kTwo) + "stoptime=2\n";
  EXPECT_THAT(warnings(together(text)),
              ElementsAre(Fault("f:8:1: 'b' runs for 2 s, but 'a' without end; write one stoptime "
                                "at the top of the file [SL0602]")));
  EXPECT_THAT(texts(together(text)), IsEmpty());
  RunOptions options;
  options.strict = true;
  EXPECT_EQ(texts(together(text, options)).size(), 1U);
  options.duration_s = 1;
  EXPECT_THAT(texts(together(text, options)), IsEmpty());
}

TEST(CheckTogether, ARunHasAtLeastATick) {
  EXPECT_THAT(
      texts(together("stoptime=0.001\nmusic_timestep=0.01\n" + std::string(kTwo))),
      ElementsAre("f:1:1: 'a' runs for 1 ms, less than its tick of 10 ms; write a longer "
                  "stoptime, or a shorter music_timestep [SL0203]",
                  Fault("f:1:1: 'b' runs for 1 ms ... 10 ms ... music_timestep ... [SL0203]")));
}

TEST(CheckTogether, NoTimeIsTooShort) {
  EXPECT_THAT(texts(together("stoptime=0\n" + std::string(kTwo))),
              Contains(Fault("f:1:1: 'a' runs for 0 s ... 1 ms ... music_timestep ... [SL0203]")));
}

TEST(CheckTogether, OneBarrier) {
  EXPECT_THAT(texts(together(std::string(kTwo) + "barrier=false\n")),
              ElementsAre(Fault("f:8:1: 'a' waits at the barrier before the first tick, 'b' does "
                                "not, and the job would hang; write one  barrier= ... [SL0602]")));
}

TEST(CheckTogether, AnOptionIsNoLineOfTheFile) {
  RunOptions options;
  options.duration_s = 0.0001;
  EXPECT_THAT(texts(together("stoptime=5\n" + std::string(kTwo), options)),
              ElementsAre("--duration 0.0001 is less than the tick of 1 ms; write a longer one, or "
                          "a shorter music_timestep [SL0203]"));
}

TEST(CheckTogether, AJobThatHearsItself) {
  const std::string loop =
      "[a]\nnp=1\nbinary=ros_sensor_adapter\nros_topic=cmd_vel\n"
      "[b]\nnp=1\nbinary=cont_ros_adapter\na.out -> b.in [3]\n";
  EXPECT_THAT(warnings(together(loop)),
              ElementsAre("f:4:1: 'a' subscribes to /cmd_vel, which 'b' publishes: the job hears "
                          "itself; write another ros_topic in one of them [SL0506]"));
  EXPECT_THAT(warnings(together(loop + "ros_topic=/other\n")), IsEmpty());
}

TEST(CheckTogether, TwoThatPublishAtOnePlace) {
  const auto two = [](const std::string& keys) {
    return "[a]\nnp=1\nbinary=connect_adapter\n[b]\nnp=1\n" + keys + "[c]\nnp=1\n" + keys +
           "a.out -> b.in [3]\na.out -> c.in [3]\n";
  };
  EXPECT_THAT(warnings(together(two("binary=ros_command_adapter\nros_topic=/go\n"))),
              ElementsAre(Fault("f:11:1: 'b' and 'c' both publish /go, and the robot obeys both in "
                                "turn; write another ros_topic ... [SL0506]")));
  EXPECT_THAT(
      texts(together(two("binary=cont_zmq_adapter\n"))),
      ElementsAre(Fault("f:7:1: 'b' and 'c' both publish at tcp://127.0.0.1:5556, which only one "
                        "program can; write another zmq_addr in one of them [SL0506]")));
}

TEST(CheckTogether, OtherSpellingsOfOnePlace) {
  const auto two = [](const std::string& first, const std::string& second) {
    const std::string start =
        "[a]\nnp=1\nbinary=connect_adapter\na.out -> b.in [3]\na.out -> c.in [3]\n";
    return start + "[b]\nnp=1\nbinary=cont_zmq_adapter\nzmq_addr=" + first +
           "\n[c]\nnp=1\nbinary=cont_zmq_adapter\nzmq_addr=" + second + "\n";
  };
  for (const auto& [first, second] :
       std::vector<std::pair<std::string, std::string>>{{"tcp://*:5", "tcp://127.0.0.1:05"},
                                                        {"tcp://lo:5", "tcp://127.0.0.1:5"},
                                                        {"ipc:///tmp//x", "ipc:///tmp/./x"},
                                                        {"tcp://0.0.0.0:5", "tcp://10.0.0.1:5"}}) {
    EXPECT_EQ(texts(together(two(first, second))).size(), 1u) << first;
  }
  for (const auto& [first, second] :
       std::vector<std::pair<std::string, std::string>>{{"tcp://127.0.0.1:0", "tcp://127.0.0.1:0"},
                                                        {"ipc://*", "ipc://*"},
                                                        {"tcp://10.0.0.1:5", "tcp://127.0.0.1:5"},
                                                        {"tcp://*:5", "tcp://*:6"}}) {
    EXPECT_THAT(texts(together(two(first, second))), IsEmpty()) << first;
  }
}

TEST(CheckTogether, OneNameANode) {
  const std::string text =
      "[a]\nnp=1\nbinary=ros_sensor_adapter\nros_topic=/s\nros_node_name=n\n"
      "[b]\nnp=1\nbinary=cont_ros_adapter\nros_node_name=n\na.out -> b.in [3]\n";
  EXPECT_THAT(
      texts(together(text)),
      ElementsAre(Fault("f:9:1: 'a' and 'b' have the ros_node_name n, and ROS would end the one "
                        "that comes first; write another ros_node_name in one of them [SL0506]")));
}

TEST(CheckTogether, AMisspeltKeyAtTheTop) {
  EXPECT_THAT(warnings(together("stoptim=4\nmine=3\n" + std::string(kTwo))),
              ElementsAre(Fault("f:1:1: unknown key 'stoptim' ... 'stoptime' ... [SL0103]")));
  EXPECT_THAT(warnings(together(
                  "stoptim=4\n[a]\nnp=1\nbinary=./x\n[b]\nnp=1\nbinary=./y\na.o -> b.i [3]\n")),
              IsEmpty())
      << "others may have such a key";
}

TEST(CheckTogether, KindsOfPorts) {
  EXPECT_THAT(texts(together("[a]\nnp=1\nbinary=rate_encoder\n[b]\nnp=1\nbinary=connect_adapter\n"
                             "a.out -> b.in [3]\n")),
              ElementsAre("f:7:1: spike output 'a.out' cannot drive continuous input 'b.in'; put a "
                          "decoder between them [SL0303]"));
  EXPECT_THAT(
      texts(together("[a]\nnp=1\nbinary=connect_adapter\n[b]\nnp=1\nbinary="
                     "spikeloop-network\na.out -> b.in [3]\n")),
      ElementsAre("f:7:1: continuous output 'a.out' cannot drive spike input 'b.in'; put an "
                  "encoder between them [SL0303]"));
}

TEST(CheckTogether, OneWidthAnOutput) {
  EXPECT_THAT(
      texts(
          together("[a]\nnp=1\nbinary=rate_encoder\n[b]\nnp=1\nbinary=./x\n[c]\nnp=1\nbinary=./y\n"
                   "a.out -> b.in [3]\na.out -> c.in [4]\n")),
      ElementsAre(
          "f:11:1: the output 'a.out' has another width in line 10; write the same [width] in "
          "both [SL0306]"));
}

TEST(CheckTogether, SeveralSendingProcesses) {
  EXPECT_THAT(warnings(together(
                  "[a]\nnp=2\nbinary=./brain\n[b]\nnp=3\nbinary=./sink\na.out -> b.in [3]\n")),
              ElementsAre("f:2:1: 'a' sends from 2 processes: MUSIC mixes up the ticks of several "
                          "senders; write np=1, unless the program sends from its "
                          "first process only [SL0602]"));
}

TEST(CheckTogether, OdditiesOfTheText) {
  const std::string text = std::string(kTwo) + "np=1\n[a]\n";
  EXPECT_THAT(warnings(together(text)),
              ElementsAre(Fault("f:8:1: duplicate key 'np' ... :5:1 ... [SL0102]"),
                          Fault("f:9:1: the section '[a]' ... 1 already, and MUSIC ... [SL0107]")));
  EXPECT_EQ(texts(together("strict=true\n" + text)).size(), 2U);
}

TEST(CheckTogether, ALoopThatNothingCanClose) {
  const std::string text =
      "[a]\nnp=1\nbinary=connect_adapter\n[b]\nnp=1\nbinary=connect_adapter\n"
      "a.out -> b.in [3]\nb.out -> a.in [3]\n";
  EXPECT_THAT(texts(together(text)),
              ElementsAre(HasSubstr("the cycle a -> b -> a lacks 2 ms of acceptable latency")));
}

TEST(FirstError, SaysHowManyMoreThereAre) {
  Diagnostics diagnostics{warning_at({"f", 1, 1}, "odd"), error_at({"f", 2, 1}, "bad")};
  EXPECT_EQ(first_error(diagnostics, "f").text(), "f:2:1: bad");
  diagnostics.push_back(error_at({}, "worse"));
  EXPECT_EQ(first_error(diagnostics, "f").text(), "f:2:1: bad (and 1 more: spikeloop check f)");
}

}  // namespace
}  // namespace spikeloop::launch
