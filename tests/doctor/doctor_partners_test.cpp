// What `spikeloop doctor` finds of plug-ins, ROS and Python.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/doctor/examination.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/roscore.hpp"

namespace spikeloop::test {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kRemove =
    " | rebuild it with this Spikeloop (docs/plugins.md), or take it out of SPIKELOOP_PLUGIN_PATH";
const std::string kStartMaster =
    " | roscore, or spikeloop run FILE --roscore; or set ROS_MASTER_URI to where one is";

class Plugins {
 public:
  std::string add(const std::string& name, const char* library) const {
    const auto file = directory_.path() / name;
    std::filesystem::create_symlink(library, file);
    return file.string();
  }
  std::string write(const std::string& name, const std::string& text) const {
    return directory_.write(name, text);
  }
  std::string path() const { return directory_.path().string(); }
  Examination examine(const std::string& more = "", const char* how_broken = "") const {
    return test::examine(
        {{"SPIKELOOP_PLUGIN_PATH", path() + more}, {"SPIKELOOP_BROKEN_PLUGIN", how_broken}});
  }

 private:
  TemporaryDirectory directory_;
};

TEST(DoctorPlugins, NamesWhatEachGives) {
  const Plugins plugins;
  const std::string good = plugins.add("a.so", GOOD_PLUGIN);
  const Examination seen = plugins.examine();
  EXPECT_EQ(seen.outcome.exit_code, 0) << seen.outcome.out;
  EXPECT_EQ(seen.line(plugins.path()), "ok | 1 plug-in | ");
  EXPECT_EQ(seen.line(good), "ok | node=gain | ");
  EXPECT_TRUE(seen.item(good)["needed"]);
}

TEST(DoctorPlugins, LooksAtThoseInPython) {
  const Plugins plugins;
  const std::string good =
      plugins.write("good.py",
                    "import spikeloop\n@spikeloop.node(inputs={'in': 'signal'}, outputs={'out': "
                    "spikeloop.Signal(same_as='in')})\ndef gain(step):\n    pass\n");
  const std::string broken =
      plugins.write("broken.py", "import spikeloop\n@spikeloop.node\nclass Mine(:\n");
  plugins.write("helper.py", "x = 1\n");
  const Examination seen = plugins.examine();
  EXPECT_EQ(seen.line(plugins.path()), "ok | 2 plug-ins | ");
  EXPECT_EQ(seen.line(good), "ok | node=gain | ");
  EXPECT_THAT(seen.line(broken),
              AllOf(StartsWith("missing | "), HasSubstr("broken.py:3"),
                    EndsWith(" | correct it (docs/python-nodes.md), or take it out of "
                             "SPIKELOOP_PLUGIN_PATH")));
}

TEST(DoctorPlugins, SaysWhyOneIsRefused) {
  const Plugins plugins;
  const std::string first = plugins.add("a.so", GOOD_PLUGIN);
  const std::string second = plugins.add("b.so", GOOD_PLUGIN);
  const std::string old = plugins.add("c.so", OLD_PLUGIN);
  const std::string text = plugins.write("d.so", "no library");
  const Examination seen = plugins.examine(":/nowhere");
  EXPECT_EQ(seen.outcome.exit_code, 3);  // as every node program would end
  EXPECT_EQ(seen.status(first), "ok");
  EXPECT_EQ(seen.line(second),
            "missing | there is already a node class 'gain', of " + first +
                " | give it another name, or take one of the two out of SPIKELOOP_PLUGIN_PATH");
  EXPECT_EQ(
      seen.line(old),
      "missing | was built for plug-in ABI 0, this Spikeloop has 2; rebuild it [SL0402]" + kRemove);
  EXPECT_THAT(seen.line(text), AllOf(StartsWith("missing | cannot be loaded: "),
                                     HasSubstr("file too short"), EndsWith(kRemove)));
  EXPECT_EQ(seen.line("/nowhere"),
            "missing | cannot read '/nowhere': No such file or directory [SL0109] | correct that, "
            "or take "
            "it out of SPIKELOOP_PLUGIN_PATH");
}

TEST(DoctorPlugins, SurvivesOneThatCrashesExitsOrHangs) {
  const Plugins plugins;
  const std::string broken = plugins.add("a.so", BROKEN_PLUGIN);
  const Examination crashed = plugins.examine();
  EXPECT_EQ(crashed.outcome.exit_code, 3);
  EXPECT_EQ(crashed.line(broken),
            "missing | cannot be loaded: it crashed (Segmentation fault)" + kRemove);
  EXPECT_EQ(plugins.examine("", "exits").line(broken),
            "missing | ends the program that loads it" + kRemove);
  const Examination hung = plugins.examine("", "hangs");
  EXPECT_EQ(hung.line(broken), "missing | cannot be loaded: no answer within 10 s" + kRemove);
  EXPECT_EQ(hung.outcome.left_behind, 0);
}

TEST(DoctorRos, FindsAMaster) {
  const RosCore master;
  const Examination seen = examine({{"ROS_MASTER_URI", master.uri()}});
  EXPECT_EQ(seen.line("ROS master"), "ok | answers at " + master.uri() + " | ");
}

TEST(DoctorRos, SaysWhyThereIsNoMaster) {
  EXPECT_EQ(examine({}).line("ROS master"),
            "warning | no master answers at http://127.0.0.1:1" + kStartMaster);
  const SilentHost silent;
  const Examination hung = examine({{"ROS_MASTER_URI", silent.uri()}});
  EXPECT_EQ(hung.outcome.exit_code, 0) << hung.outcome.out;
  EXPECT_EQ(hung.line("ROS master"),
            "warning | no master answers at " + silent.uri() + kStartMaster);
  EXPECT_THAT(examine({{"ROS_MASTER_URI", "moon"}}).line("ROS master"),
              Fault("warning | ROS_MASTER_URI is 'moon' ... http://localhost:11311 [SL0701]" +
                    kStartMaster));
}

TEST(DoctorRos, SaysWhichHostHasNoAddress) {
  // Without an answer of a name server the reason is another one.
  const Examination seen =
      examine({{"ROS_MASTER_URI", "http://robot.invalid:11311"}, {"ROS_HOSTNAME", "base.invalid"}});
  const auto unresolved = [](const std::string& host, const std::string& remedy) {
    return AllOf(AnyOf(StartsWith("warning | the host name '" + host + "' cannot be resolved ("),
                       StartsWith("warning | no answer within 10 s | ")),
                 EndsWith(remedy));
  };
  EXPECT_THAT(seen.line("ROS master"), unresolved("robot.invalid", kStartMaster));
  EXPECT_THAT(
      seen.line("host name"),
      unresolved("base.invalid", " | see /etc/hosts; or set ROS_IP to this machine's address"));
  EXPECT_EQ(examine({{"ROS_IP", "127.0.0.1"}, {"ROS_HOSTNAME", ""}}).line("host name"),
            "ok | '127.0.0.1' has an address | ");
}

TEST(DoctorRos, KnowsWhatRos2Needs) {
  const Environment plain{{"ROS_DOMAIN_ID", ""},
                          {"ROS_LOCALHOST_ONLY", ""},
                          {"ROS_STATIC_PEERS", ""},
                          {"ROS_AUTOMATIC_DISCOVERY_RANGE", ""},
                          {"CYCLONEDDS_URI", ""}};
  const Examination seen = examine(plain);
  EXPECT_THAT(seen.line("Cyclone DDS"),
              testing::MatchesRegex("ok \\| [0-9.]+, /.*/libddsc\\.so\\..* \\| "));
  EXPECT_THAT(seen.line("ROS 2 discovery"), StartsWith("ok | domain 0, this machine"));
}

TEST(DoctorRos, SaysWhereRos2Looks) {
  const auto line = [](Environment environment) {
    environment.try_emplace("ROS_LOCALHOST_ONLY", "");
    return examine(environment).line("ROS 2 discovery");
  };
  EXPECT_EQ(line({{"ROS_DOMAIN_ID", "7"},
                  {"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"},
                  {"ROS_STATIC_PEERS", "192.0.2.7;192.0.2.8"},
                  {"CYCLONEDDS_URI", "file:///etc/cyclone.xml"}}),
            "ok | domain 7, this machine, 192.0.2.7, 192.0.2.8, with CYCLONEDDS_URI | ");
  EXPECT_EQ(line({{"ROS_DOMAIN_ID", "7"}, {"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}}),
            "ok | domain 7, nobody | ");
  EXPECT_EQ(line({{"ROS_DOMAIN_ID", "7"}, {"ROS_AUTOMATIC_DISCOVERY_RANGE", "SYSTEM_DEFAULT"}}),
            "ok | domain 7, as in CYCLONEDDS_URI | ");
  EXPECT_THAT(line({{"ROS_DOMAIN_ID", "abc"}}),
              Fault("warning | ROS_DOMAIN_ID is 'abc' ... 0 to 232 [SL0510] | docs/ros2.md has "
                    "these variables"));
}

/// Answers to `import`; $4 is the module.
std::string python_that(const Fakes& fakes, const std::string& script) {
  return fakes.add("python3", "[ \"$1\" = --version ] && echo Python 3.99 && exit\n" + script);
}

TEST(DoctorPython, AsksTheOneThatIsNamed) {
  const Fakes fakes;
  const std::string python = python_that(
      fakes,
      "case $3 in\n"
      "nest) echo a banner; echo '{\"version\": \"3.8\", \"music\": true, \"mpi\": true, "
      "\"place\": \"/opt/nest\"}' ;;\n"
      "neuron) echo '{\"version\": \"8.2\"}' ;;\n"
      "brian2) echo ImportError: no Cython >&2; exit 1 ;;\n"
      "numpy) echo nonsense ;;\n"
      "*) exit 7 ;;\n"
      "esac");
  const Examination seen = examine({{"PYTHON", python}});
  EXPECT_EQ(seen.outcome.exit_code, 0);
  EXPECT_EQ(seen.line("Python"), "ok | 3.99, " + python + " | ");
  EXPECT_EQ(seen.line("NEST"), "ok | 3.8, /opt/nest, with MUSIC | ");
  EXPECT_EQ(seen.line("NEURON"), "ok | 8.2 | ");
  EXPECT_EQ(seen.line("Brian2"),
            "missing | ImportError: no Cython | Debian: apt install python3-brian; see "
            "docs/simulators.md");
  EXPECT_EQ(seen.line("numpy"),
            "missing | its answer cannot be read: 'nonsense' | apt-get install python3-numpy");
  EXPECT_EQ(seen.line("h5py"), "missing | exit code 7 | apt-get install python3-h5py");
  EXPECT_EQ(seen.line("matplotlib"), "missing | exit code 7 | apt-get install python3-matplotlib");
}

TEST(DoctorPython, WarnsOfANestWithMpiAlone) {
  const Fakes fakes;
  const std::string python = python_that(
      fakes, "echo '{\"version\": \"3.8\", \"music\": false, \"mpi\": true, \"place\": \"/n\"}'");
  EXPECT_EQ(examine({{"PYTHON", python}}).line("NEST"),
            "warning | 3.8, /n, with MPI but without MUSIC | jobs need one with MUSIC (cmake "
            "-Dwith-music=ON -Dwith-mpi=ON), or one without MPI (conda-forge: "
            "nest-simulator=*=nompi*)");
}

TEST(DoctorPython, SaysHowToGetSimulators) {
  const Fakes fakes;
  const std::string python = fakes.add("python3", "exec /usr/bin/python3 -S \"$@\"");  // none
  const Examination seen = examine({{"PYTHON", python}, {"PYTHONPATH", ""}});
  EXPECT_EQ(seen.line("NEST"),
            "missing | ModuleNotFoundError: No module named 'nest' | NEST is not in Debian: build "
            "it (nest-simulator.readthedocs.io), and let PYTHONPATH name the place of its Python "
            "module; see docs/simulators.md");
  EXPECT_EQ(seen.line("NEURON"),
            "missing | ModuleNotFoundError: No module named 'neuron' | Debian: apt install "
            "python3-neuron; see docs/simulators.md");
}

TEST(DoctorPython, ImportsWhatIsThere) {
  // Packages that the real Python finds first.
  const TemporaryDirectory packages;
  packages.write("neuron.py", "__version__ = '8.0'\nprint('NEURON -- a banner')\n");
  packages.write("brian2.py", "__version__ = '2.5.1'\n");
  packages.write("nest.py",
                 "__version__ = '3.3'\nclass ll_api:\n  @staticmethod\n  def sli_func(text):\n    "
                 "return text == 'statusdict/have_music ::'\n");
  const Examination seen = examine({kRealPython, {"PYTHONPATH", packages.path().string()}});
  const std::string place = packages.path().string();
  EXPECT_EQ(seen.line("NEURON"), "ok | 8.0, " + place + " | ");
  EXPECT_EQ(seen.line("Brian2"), "ok | 2.5.1, " + place + " | ");
  EXPECT_EQ(seen.line("NEST"), "ok | 3.3, " + place + ", with MUSIC | ");
  packages.write("nest.py",
                 "class ll_api:\n  @staticmethod\n  def sli_func(text):\n    return False\n");
  EXPECT_EQ(examine({kRealPython, {"PYTHONPATH", place}}).line("NEST"),
            "ok | ?, " + place + ", without MUSIC | ");
}

TEST(DoctorPython, SaysThatThereIsNone) {
  const Examination seen = examine({{"PYTHON", "/nowhere/python3"}});
  EXPECT_EQ(seen.outcome.exit_code, 0);
  EXPECT_EQ(
      seen.line("Python"),
      "missing | no program '/nowhere/python3' | apt-get install python3, or set PYTHON to another "
      "one");
  EXPECT_EQ(
      seen.line("NEURON"),
      "missing | there is no Python | Debian: apt install python3-neuron; see docs/simulators.md");
}

}  // namespace
}  // namespace spikeloop::test
