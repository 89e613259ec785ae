// MUSIC's own launcher reads the same files: without mpirun it takes its rank from the environment,
// and hands its configuration to the program in one environment string. A program that prints that
// string shows what MUSIC has read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>

#include "spikeloop/config/music_file.hpp"
#include "tests/config/helpers.hpp"
#include "tests/support/child.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop {
namespace {

class MusicOracle : public testing::Test {
 protected:
  MusicOracle() {
    program_ =
        directory_.write("print-configuration", "#!/bin/sh\nprintf '%s' \"$_MUSIC_CONFIG_\"\n");
    ::chmod(program_.c_str(), 0755);
  }

  test::Outcome music(const std::string& text, int rank) {
    test::Command command;
    command.arguments = {"music", directory_.write("job.music", text)};
    command.environment = {{"OMPI_COMM_WORLD_RANK", std::to_string(rank)}};
    command.directory = directory_.path().string();
    return test::run(command);
  }

  /// Every application's configuration, by MUSIC and by us.
  void compare(const std::string& text) {
    const MusicFile file = parse_music(text, "f");
    int rank = 0;
    for (const auto& section : file.sections) {
      const auto outcome = music(text, rank);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err << text;
      ASSERT_EQ(outcome.out, music_environment(file, section.label)) << text;
      rank += file.processes(section);
    }
  }

  /// A file that MUSIC can map: every section has the program, a number of processes, and known
  /// partners; ports have one direction.
  MusicFile make_runnable(MusicFile file, test::RandomMusicFile& random) {
    for (auto& section : file.sections) {
      set_key(section.keys, "binary", program_);
      set_key(section.keys, "np", std::to_string(1 + random.below(3)));
    }
    const auto odd = [](const std::string& app, const std::string& port) {
      return (app + port).find_first_of("#[") != std::string::npos;
    };
    // Those that to_text writes into a reopened section, which MUSIC numbers in another order.
    std::erase_if(file.connections, [&](const MusicConnection& c) {
      return c.from_app == c.to_app || file.find_section(c.to_app) == nullptr ||
             (c.from_app + c.to_app).find('.') != std::string::npos ||
             (odd(c.from_app, c.from_port) && odd(c.to_app, c.to_port));
    });
    for (auto& c : file.connections) {
      c.from_port = "out" + c.from_port;
      c.to_port = "in" + c.to_port;
    }
    return file;
  }

  test::TemporaryDirectory directory_;
  std::string program_;
};

TEST_F(MusicOracle, ReadsTheExamplesAsWeDo) {
  for (const auto& name : test::music_examples()) {
    MusicFile file = read_music_file(test::data_path_of(name));
    std::string text = test::data_text(name);
    for (auto& section : file.sections) {  // the same text, with our program in place of theirs
      const std::string& binary = file.find_key(section, "binary")->value;
      for (auto at = text.find(binary); at != std::string::npos; at = text.find(binary, at + 1)) {
        if (at > 0 && (text[at - 1] == '=' || text[at - 1] == ' ')) {
          text.replace(at, binary.size(), program_);
        }
      }
    }
    compare(text);
  }
}

TEST_F(MusicOracle, ReadsCornersOfTheGrammarAsWeDo) {
  const std::string binary = "\nbinary=" + program_ + "\nnp=1\n";
  compare(binary +
          "[]\ng=2\n[A]\nargs=\"-s \\\"x\\\" # no\n two\" # c\ncol:on=3\na\\->b=c\n[B.c]\nnp=2\n"
          "x = a\\\nb\\ \nin <- A.out[ 10 , point - to-point, TABLE ]  y=5\n[A]\nmore=a:b\\\\c\n");
  compare(binary +
          "[A]\nk=1\nout\t->\tB.in[7 # open\n.two -> B.in2 [,collective]z=1\n[B]#c\n "
          "A.three->in3\nk=2");
  compare(binary + "[A]\rk=1\rout->B.in[]\r[ B\\] ]\fk=2\f[B]\fk=\xC3\xA4\f");
  compare(binary + "[A]\nk=1\nk = 2#3\nk-=<\nl\\#=\"\"\nB\\#.in<-out\n[B#]\nk=1\nA.x->in2\n");
}

TEST_F(MusicOracle, ReadsRandomFilesAsWeDo) {
  int compared = 0;
  for (unsigned seed = 0; seed < 80; ++seed) {
    test::RandomMusicFile random(seed);
    const MusicFile file = make_runnable(random.make(), random);
    std::string text;
    try {
      text = to_text(file);
    } catch (const ConfigurationError&) {
      continue;
    }
    compare(text);
    ++compared;
    if (HasFatalFailure()) {
      return;
    }
  }
  EXPECT_GT(compared, 50);
}

TEST_F(MusicOracle, PassesOnAConfigurationUpToTheLimit) {
  const std::string start =
      "[A]\nnp=1\nbinary=" + program_ + "\n[B]\nnp=1\nbinary=" + program_ + "\nA.out->B.in[1]\nv=";
  const MusicFile empty = parse_music(start, "f");
  const std::size_t room = kEnvironmentLimit - 1 - std::string("_MUSIC_CONFIG_=").size() -
                           music_environment(empty, "B").size();
  EXPECT_NO_THROW(check_structure(parse_music(start + std::string(room, 'x'), "f")));
  EXPECT_THROW(check_structure(parse_music(start + std::string(room + 1, 'x'), "f")),
               ConfigurationError);
  // printf's argument in a shell is not limited: it is a built-in command.
  EXPECT_EQ(music(start + std::string(room, 'x'), 1).exit_code, 0);
  const auto refused = music(start + std::string(room + 1, 'x'), 1);
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, testing::HasSubstr("Argument list too long"));
}

TEST_F(MusicOracle, CrashesAtUnknownApplicationsWhichWeRefuse) {
  const std::string text =
      "np=1\nbinary=" + program_ + "\n[A]\nk=1\n[B]\nk=1\nA.out->C.in\nA.out->B.in";
  EXPECT_EQ(music(text, 0).exit_code, 128 + SIGSEGV);
  EXPECT_THROW(check_structure(parse_music(text, "f")), ConfigurationError);
}

TEST_F(MusicOracle, AbortsForSectionsWithoutKeys) {
  const std::string text = "np=1\nbinary=" + program_ + "\n[A]\n[B]\nk=1\nA.out->B.in";
  EXPECT_EQ(music(text, 0).exit_code, 128 + SIGABRT);
  EXPECT_THROW(check_structure(parse_music(text, "f")), ConfigurationError);
}

TEST_F(MusicOracle, LosesNamesThatWeRefuse) {
  const std::string start = "np=1\nbinary=" + program_ + "\n";
  EXPECT_THAT(music(start + "a\\=b=1\n[A]\nk=1\n[B]\nk=1\nA.out->B.in", 0).out,
              testing::HasSubstr(":a=b=1"));  // read back as the key 'a' with the value 'b=1'
  EXPECT_THAT(music(start + "[a:b]\nk=1\n[B]\nk=1\na:b.out->B.in", 0).out,
              testing::StartsWith("a:b:0:2:"));
  EXPECT_THAT(music(start + "[A]\nk=1\n[B]\nk=1\nA.o:p->B.in", 0).out,
              testing::HasSubstr(":o:p:0:-1:1"));
}

TEST_F(MusicOracle, AbortsForWhatWeRefuse) {
  const std::string start = "np=1\nbinary=" + program_ + "\n[A]\nk=1\n[B]\nk=1\n";
  for (const std::string line :
       {"A.a->B.b[abc]", "A.a->B.b[-3]", "A.a->B.b[10", "A.a->B.b[10 20]", "A.a->B.b[1,,tree,x]",
        "A.a->B.b[99999999999]", "A.a->B.b[2147483648]", "A.a->B.b[1,foo]", "A.a->B.b[1,,foo]",
        "[A", "[A] x", "k=\"a", "k=\"a\" b", "k=a\\", "k\\\n=a", "A.x->A.y",
        "A.a->B.b\nB.x->A.a"}) {
    const std::string text = start + line;
    EXPECT_NE(music(text, 0).exit_code, 0) << text;
    EXPECT_THROW(check_structure(parse_music(text, "f")), ConfigurationError) << text;
  }
}

}  // namespace
}  // namespace spikeloop
