// `spikeloop doctor` on machines that lack this and that.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <set>

#include "app/spikeloop/doctor/probe.hpp"
#include "tests/doctor/examination.hpp"

namespace spikeloop::test {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::Not;
using testing::StartsWith;

const std::string kInstallMpi = " | apt-get install openmpi-bin, or add its directory to PATH";
const std::string kInstallMusic = " | apt-get install music-bin, or add its directory to PATH";
const std::string kInstallAgain = " | build and install Spikeloop again: all of it, scripts/build";

TEST(Doctor, FindsAllThatARunNeeds) {
  const Examination seen = examine({kRealPython});
  EXPECT_EQ(seen.outcome.exit_code, 0) << seen.outcome.text();
  EXPECT_EQ(seen.outcome.err, "");
  EXPECT_EQ(seen.outcome.left_behind, 0);
  EXPECT_TRUE(seen.report.value("ready", false));
  EXPECT_EQ(seen.report.value("spikeloop", ""), SPIKELOOP_VERSION);
  EXPECT_THAT(seen.line("Spikeloop"), StartsWith("ok | " SPIKELOOP_VERSION ", "));
  EXPECT_THAT(seen.line("its programs"), MatchesRegex("ok \\| [0-9]+ in /.* \\| "));
  EXPECT_THAT(seen.line("its libraries"), HasSubstr(" shared libraries of its programs"));
  EXPECT_THAT(seen.line("MUSIC library"),
              MatchesRegex("ok \\| [0-9.]+, /.*/libmusic\\.so\\..* \\| "));
  EXPECT_THAT(seen.line("MuJoCo"),
              MatchesRegex("ok \\| [0-9.]+, /.*/libmujoco\\.so\\.[0-9.]+ \\| "));
  EXPECT_THAT(seen.line("worlds"), StartsWith("ok | arena.xml, "));
  EXPECT_THAT(seen.line("HDF5"), MatchesRegex("ok \\| [0-9]+\\.[0-9]+\\.[0-9]+ \\| "));
  EXPECT_THAT(seen.line("Open MPI"), MatchesRegex("ok \\| [0-9.]+, /.*/mpirun \\| "));
  EXPECT_THAT(seen.line("mpirun"), HasSubstr("; --oversubscribe works"));
  EXPECT_THAT(seen.line("MUSIC launcher"), MatchesRegex("ok \\| [0-9.]+, /.*/music \\| "));
  EXPECT_EQ(seen.line("plug-ins"), "ok | SPIKELOOP_PLUGIN_PATH is not set | ");
  EXPECT_THAT(seen.line("ROS 1"), MatchesRegex("ok \\| /.*/rosmaster \\| "));
  EXPECT_EQ(seen.status("numpy"), "ok");
  EXPECT_EQ(seen.line("EGL"), "ok | libEGL.so.1, to draw cameras and films without a display | ");
  EXPECT_EQ(seen.line("GLFW"), "ok | libglfw.so.3, to open a window with --view | ");
  EXPECT_THAT(seen.line("ffmpeg"),
              MatchesRegex("ok \\| /.*/ffmpeg, to make films with --render \\| "));
}

TEST(Doctor, FindsTheSameWithFewOpenFiles) {
  Command few = doctor({"--json"}, {});
  few.arguments.insert(few.arguments.begin(), {"/bin/sh", "-c", "ulimit -n 40; exec \"$@\"", "sh"});
  const Examination seen = examination_by(few);
  EXPECT_THAT(seen.line("open files"), StartsWith("warning | the limit of open files is 40"));
  for (const auto& item : examine({}).report["items"]) {
    const std::string name = item["name"];
    if (name != "open files") {
      EXPECT_EQ(seen.status(name), item["status"]) << seen.line(name);
    }
  }
}

TEST(Doctor, SaysWhatDrawsAndWhichPackageHasIt) {
  TemporaryDirectory broken;  // libraries that are found first, and are none
  broken.write("libEGL.so.1", "no library");
  broken.write("libglfw.so.3", "no library");
  const Examination seen =
      examine({{"PATH", "/nowhere"}, {"LD_LIBRARY_PATH", broken.path().string()}});
  EXPECT_THAT(seen.line("EGL"), AllOf(StartsWith("missing | cannot draw cameras and films without "
                                                 "a display: "),
                                      EndsWith(" | apt-get install libegl1 libgl1 "
                                               "libgl1-mesa-dri")));
  EXPECT_THAT(seen.line("GLFW"), AllOf(StartsWith("missing | cannot open a window with --view: "),
                                       EndsWith(" | apt-get install libglfw3")));
  EXPECT_EQ(seen.line("ffmpeg"),
            "missing | no ffmpeg in PATH='/nowhere', to make films with --render | apt-get install "
            "ffmpeg");
}

TEST(Doctor, TableAndJsonHaveTheSameItems) {
  const Examination seen = examine({});
  const Outcome table = run(doctor({}, {}));
  EXPECT_EQ(table.exit_code, 0);
  EXPECT_THAT(table.out, Not(HasSubstr("\x1b[")));
  std::size_t lines = 0;
  std::size_t column = std::string::npos;
  for (const auto& item : seen.report["items"]) {
    const std::string name = item["name"];
    const auto place = table.out.find("  " + name + "  ");
    ASSERT_NE(place, std::string::npos) << name << "\n" << table.out;
    const auto begin = table.out.rfind('\n', place) + 1;
    const auto text = table.out.find_first_not_of(' ', place + 2 + name.size()) - begin;
    column = column == std::string::npos ? text : column;
    EXPECT_EQ(text, column) << name;
    lines += item["remedy"] == "" ? 1 : 2;
    EXPECT_EQ(item["status"] == "ok", item["remedy"] == "") << item;
  }
  // Two headings, two empty lines, a conclusion.
  EXPECT_EQ(static_cast<std::size_t>(std::ranges::count(table.out, '\n')), lines + 5) << table.out;
  EXPECT_THAT(last_line(table.out), StartsWith("spikeloop run has all that it needs"));
}

TEST(Doctor, ColoursOnATerminalOnly) {
  const std::string line = std::string(SPIKELOOP_PROGRAM) + " doctor";
  Command terminal = doctor({}, {{"TERM", "xterm"}, {"NO_COLOR", ""}});
  terminal.arguments = {"script", "-qec", line, "/dev/null"};
  EXPECT_THAT(run(terminal).out, HasSubstr("\x1b[32mok     \x1b[0m  "));
  terminal.environment["NO_COLOR"] = "1";
  EXPECT_THAT(run(terminal).out, Not(HasSubstr("\x1b[32m")));
}

TEST(Doctor, WorksWithAnEmptyPath) {
  const Environment none{{"PATH", ""}, {"HOME", ""}};
  const Examination unset = examine(none);
  EXPECT_EQ(unset.outcome.exit_code, 3) << unset.outcome.err;
  EXPECT_EQ(unset.line("Open MPI"), "missing | no mpirun in PATH=''" + kInstallMpi);
  EXPECT_EQ(unset.line("MUSIC launcher"), "missing | no music in PATH=''" + kInstallMusic);
  EXPECT_EQ(
      unset.line("ROS 1"),
      "missing | no rosmaster in PATH='' | apt-get install python3-rosmaster, or source ROS's "
      "setup.bash");
  EXPECT_EQ(unset.status("its libraries"), "ok");
  Command empty = doctor({}, none);
  empty.arguments = {"/usr/bin/env", "PATH=", SPIKELOOP_PROGRAM, "doctor"};
  const Outcome outcome = run(empty);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(last_line(outcome.out), StartsWith("spikeloop run lacks Open MPI, MUSIC launcher"));
  const Examination nowhere = examine({{"PATH", "/nowhere"}});
  EXPECT_EQ(nowhere.line("Open MPI"), "missing | no mpirun in PATH='/nowhere'" + kInstallMpi);
}

TEST(Doctor, DoesNotWaitForWhatHangs) {
  const Fakes fakes;
  fakes.add("mpirun", "trap '' TERM; sleep 1000");
  fakes.add("music", "exec yes");
  const std::string python = fakes.add("python3", "sleep 1000");
  const Examination seen = examine({{"PATH", fakes.before()}, {"PYTHON", python}});
  EXPECT_EQ(seen.outcome.exit_code, 3);
  EXPECT_LT(seen.outcome.seconds, 40);  // on a loaded machine; 10 s and some are usual
  EXPECT_EQ(seen.outcome.left_behind, 0);
  EXPECT_EQ(seen.line("Open MPI"),
            "missing | " + fakes.path() + "/mpirun: no answer within 10 s" + kInstallMpi);
  EXPECT_EQ(
      seen.line("mpirun"),
      "missing | cannot start programs: no answer within 10 s | see what it prints: mpirun -np 2 "
      "--oversubscribe hostname");
  EXPECT_EQ(seen.line("MUSIC launcher"),
            "missing | " + fakes.path() + "/music: no answer within 10 s" + kInstallMusic);
  EXPECT_EQ(seen.line("Python"), "missing | " + python +
                                     ": no answer within 10 s | apt-get install python3, or set "
                                     "PYTHON to another one");
  EXPECT_EQ(seen.line("numpy"), "missing | no answer within 10 s | apt-get install python3-numpy");
}

TEST(Doctor, KnowsOtherProgramsOfTheSameNames) {
  const Fakes fakes;
  fakes.add("mpirun", "echo HYDRA build details:");
  fakes.add("music", "echo A player of music 1.0");
  const Examination seen = examine({{"PATH", fakes.before()}});
  EXPECT_EQ(seen.line("Open MPI"), "missing | " + fakes.path() +
                                       "/mpirun is another program: 'HYDRA build details:'" +
                                       kInstallMpi);
  EXPECT_EQ(seen.line("MUSIC launcher"), "missing | " + fakes.path() +
                                             "/music is another program: 'A player of music 1.0'" +
                                             kInstallMusic);
}

TEST(Doctor, SaysWhyMpirunStartsNothing) {
  const Fakes fakes;
  fakes.add("mpirun",
            "[ \"$1\" = --version ] && echo 'mpirun (Open MPI) 4.1.4' && exit\n"
            "echo 'no space for a session' >&2; exit 213");
  fakes.add("music", "kill -ILL $$");
  const Examination seen = examine({{"PATH", fakes.before()}});
  EXPECT_EQ(seen.outcome.exit_code, 3);
  EXPECT_EQ(seen.line("Open MPI"), "ok | 4.1.4, " + fakes.path() + "/mpirun | ");
  EXPECT_THAT(seen.line("mpirun"),
              StartsWith("missing | cannot start programs: exit code 213: no space for a session | "
                         "see what it prints: "));
  EXPECT_THAT(seen.line("MUSIC launcher"),
              HasSubstr("/music: it crashed (Illegal instruction) | "));
}

/// A copy of the program in a directory of its own, beside what `link` names.
class Copy {
 public:
  explicit Copy(const std::vector<std::string>& links = {}) {
    std::filesystem::create_directory(directory_.path() / "bin");
    std::filesystem::copy_file(SPIKELOOP_PROGRAM, file("spikeloop"));
    for (const std::string& name : links) {
      std::filesystem::copy_file(std::filesystem::path(SPIKELOOP_PROGRAM).parent_path() / name,
                                 file(name));
    }
  }
  std::string file(const std::string& name) const {
    return (directory_.path() / "bin" / name).string();
  }
  std::string directory() const { return directory_.path().string(); }
  Examination examine() const {
    Command command = doctor({"--json"}, {});
    command.arguments[0] = file("spikeloop");
    return examination_by(command);
  }

 private:
  TemporaryDirectory directory_;
};

TEST(Doctor, MissesItsOwnPrograms) {
  const Copy alone;
  const Examination seen = alone.examine();
  EXPECT_EQ(seen.outcome.exit_code, 3);
  EXPECT_THAT(seen.line("its programs"),
              AllOf(StartsWith("missing | not in " + alone.directory() + "/bin: argmax_"),
                    HasSubstr(", spikeloop-node, "), EndsWith(kInstallAgain)));
  EXPECT_THAT(seen.line("MUSIC library"), AllOf(HasSubstr("spikeloop-node: not found"),
                                                EndsWith(" | apt-get install libmusic1v5")));
  EXPECT_THAT(seen.line("MuJoCo"), EndsWith(" | apt-get install libmujoco2.2.2"));
  EXPECT_EQ(seen.line("worlds"), "missing | no arena.xml in " + alone.directory() +
                                     "/share/spikeloop/worlds" + kInstallAgain);
}

TEST(Doctor, MissesALibrary) {
  const Copy copy({"spikeloop-node"});
  std::string bytes;
  {
    std::ifstream in(copy.file("spikeloop-node"), std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  const std::string name("libmusic.so.1\0", 14);
  ASSERT_NE(bytes.find(name), std::string::npos);
  bytes.replace(bytes.find(name), name.size(), std::string("libmusic.so.7\0", 14));
  std::ofstream(copy.file("spikeloop-node"), std::ios::binary) << bytes;
  const Examination seen = copy.examine();
  EXPECT_EQ(seen.line("its libraries"),
            "missing | not found: libmusic.so.7 | scripts/install-dependencies, then build "
            "Spikeloop again");
  EXPECT_EQ(seen.line("MUSIC library"),
            "missing | no libmusic.so for spikeloop-node | apt-get install libmusic1v5");
}

TEST(Doctor, CountsCores) {
  Command one = doctor({"--json"}, {});
  one.arguments.insert(one.arguments.begin(), {"taskset", "1"});
  const Examination seen = examination_by(one);
  EXPECT_EQ(seen.line("cores"),
            "warning | 1: the programs of a job take turns | use a machine with a core a program, "
            "or --real-time-factor 0.5");
  EXPECT_EQ(seen.outcome.exit_code, 0) << seen.outcome.out;
}

TEST(Doctor, MeasuresSharedMemory) {
  using app::doctor::shared_memory;
  using app::doctor::Status;
  const auto none = shared_memory("/nowhere");
  EXPECT_EQ(none.status, Status::warning);
  EXPECT_EQ(none.text, "/nowhere: No such file or directory; jobs use /tmp, which may be a disk");
  EXPECT_EQ(none.remedy, "mount -t tmpfs tmpfs /nowhere");
}

// These tests run where scripts/install-dependencies has installed what the remedies name.
TEST(Doctor, RemediesNamePackagesOfDebian) {
  const Fakes fakes;
  const std::string python = fakes.add("python3", "exit 1");
  const Copy alone;
  Command lacking = doctor({"--json"}, {{"PATH", ""}, {"PYTHON", python}});
  lacking.arguments[0] = alone.file("spikeloop");
  const Examination seen = examination_by(lacking);
  // "apt install" or "apt-get install", and the package behind it.
  const std::regex install("apt(-get)? install ([^ ,;]+)");
  std::set<std::string> packages;
  for (const auto& item : seen.report["items"]) {
    const std::string remedy = item["remedy"];
    if (std::smatch found; std::regex_search(remedy, found, install)) {
      packages.insert(found[2]);
    }
  }
  EXPECT_GE(packages.size(), 12U);
  for (const std::string& name : packages) {
    EXPECT_EQ(run({.arguments = {"dpkg-query", "-W", "-f", "${db:Status-Status}", name}}).out,
              "installed")
        << name;
  }
}

TEST(Doctor, RefusesAProbeOfAStranger) {
  const Outcome outcome = run(doctor({"--probe", "moon"}, {}));
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.err,
            "spikeloop: --probe 'moon' is not a probe; leave it out: doctor uses it for its own "
            "children\n");
}

}  // namespace
}  // namespace spikeloop::test
