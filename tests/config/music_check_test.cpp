#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/config/music_file.hpp"
#include "tests/config/helpers.hpp"

namespace spikeloop {
namespace {

using test::Fault;
using test::message_of;

const std::string kPair = "binary=b\n[A]\nnp=1\n[B]\nnp=1\n";  // five lines

std::string check(const std::string& text) {
  return message_of([&] { check_structure(parse_music(text, "f")); });
}

TEST(MusicCheck, AcceptsTheExamples) {
  for (const auto& name : test::music_examples()) {
    EXPECT_NO_THROW(check_structure(read_music_file(test::data_path_of(name)))) << name;
  }
}

TEST(MusicCheck, AFileNeedsAnApplication) {
  const std::string message =
      "f: the file has no application; write '[label]', np=1, binary=program and its connections "
      "[SL0104]";
  EXPECT_EQ(check(""), message);
  EXPECT_EQ(check("# nothing\nnp=1\n"), message);
}

TEST(MusicCheck, EverySectionNeedsProcessesAndBinary) {
  const std::string wire = "\nA.out -> B.in [1]\n";
  EXPECT_EQ(check("[A]\nbinary=b\n[B]\nbinary=b\nnp=1" + wire),
            "f:1:1: the section '[A]' has no np, its number of processes; write np=1 [SL0104]");
  for (const std::string np : {"one", "0", "-1", "1.5", "2x", "", "99999999999"}) {
    EXPECT_EQ(
        check("[A]\nbinary=b\n np=" + np + "\n[B]\nbinary=b\nnp=1" + wire),
        "f:3:2: np of '[A]' is '" + np + "', no whole number of at least 1; write np=1 [SL0204]");
  }
  EXPECT_EQ(check("[A]\nnp=1\n[B]\nnp=1\nbinary=b" + wire),
            "f:1:1: the section '[A]' has no binary; write binary=program [SL0104]");
  EXPECT_EQ(check("np=1\n[A]\nbinary=\n[B]\nbinary=b" + wire),
            "f:3:1: binary of '[A]' is empty; write binary=program [SL0104]");
  EXPECT_EQ(check("np=1\nbinary=b\n[A]\nk=1\n[B]" + wire),
            "f:5:1: the section '[B]' has no key of its own, and MUSIC would abort; write np=1 and "
            "binary=program [SL0104]");
  EXPECT_EQ(check(kPair + wire), "no error") << "global keys hold in every section";
}

TEST(MusicCheck, KnowsWidthsThatBecameSections) {
  EXPECT_EQ(check("np=1\n[A]\nbinary=b\n[B]\nbinary=b\nA.out->B.in\n[10]\n"),
            "f:7:1: '[10]' on a line of its own is a section for MUSIC; write a width on the "
            "connection's line: 'A.out -> B.in [10]' [SL0101]");
}

TEST(MusicCheck, ConnectionsNeedKnownApplications) {
  EXPECT_EQ(check("binary=b\n[reader]\nnp=1\n[writer]\nnp=1\nwriter.a -> raeder.b [1]\n"
                  "writer.a -> reader.b [1]"),
            "f:6:1: unknown node 'raeder'; did you mean 'reader'? [SL0301]");
  EXPECT_EQ(check(kPair + "A.a -> B.b\nqqqq.a -> B.c"),
            "f:7:1: unknown node 'qqqq'; known: A, B [SL0301]");
}

TEST(MusicCheck, RefusesConnectionsThatMusicHangsAt) {
  const std::string wire = kPair + "A.out -> B.in [1]\n";
  EXPECT_EQ(
      check(wire + "A.x -> A.y"),
      "f:7:1: the connection 'A.x -> A.y' joins an application to itself, which MUSIC refuses; "
      "write two applications [SL0602]");
  EXPECT_EQ(
      check(wire + "B.x -> A.out"),
      "f:7:1: the port 'A.out' is both an output and an input (line 6); write two ports [SL0602]");
  EXPECT_THAT(check(wire + "B.in -> A.x"),
              Fault("f:7:1: the port 'B.in' ... (line 6) ... [SL0602]"));
  EXPECT_EQ(
      check(wire + "A.other -> B.in"),
      "f:7:1: input 'B.in' has two senders, 'A.out' and 'A.other'; remove one connection [SL0304]");
  EXPECT_EQ(check(wire + "A.out -> B.in [2]"),
            "f:7:1: the connection 'A.out -> B.in' is written twice; remove one [SL0304]");
  EXPECT_EQ(check(wire + "A.x -> B.y [0]"), "no error") << "message ports have no width";
  EXPECT_EQ(check(wire + "A.out -> B.in2"), "no error") << "an output may have many receivers";
}

TEST(MusicCheck, EveryApplicationNeedsAConnection) {
  EXPECT_EQ(check(kPair + "[C]\nnp=1\nA.out -> B.in"),
            "f:6:1: the application 'C' has no connection, and MUSIC would hang; write 'C.out -> "
            "B.in [width]' or remove the section [SL0305]");
  EXPECT_THAT(check("[A]\nnp=1\nbinary=b"), testing::HasSubstr("'A' has no connection"));
}

TEST(MusicCheck, ReportsAllProblemsInTheOrderOfTheFile) {
  const MusicFile file =
      parse_music("binary=b\n[A]\nA.x->A.y\n[B]\nnp=0\nB.x -> C.y\n[D]\nnp=1", "f");
  std::vector<int> lines;
  for (const auto& problem : structure_diagnostics(file)) {
    lines.push_back(problem.where.line);
  }
  EXPECT_EQ(lines, (std::vector<int>{2, 3, 5, 6, 7}));
}

TEST(MusicCheck, TheConfigurationMustFitIntoAnEnvironmentString) {
  MusicFile file = parse_music(kPair + "A.out -> B.in [1]", "f");
  const std::size_t without = music_environment(file, "B").size();
  const std::size_t overhead =
      std::string("_MUSIC_CONFIG_=").size() + 1 + std::string(":v=").size();
  set_key(file.section("B").keys, "v", std::string(kEnvironmentLimit - without - overhead, 'x'));
  EXPECT_NO_THROW(check_structure(file));
  set_key(file.section("B").keys, "v",
          std::string(kEnvironmentLimit - without - overhead + 1, 'x'));
  EXPECT_EQ(message_of([&] { check_structure(file); }),
            "f:4:1: the configuration of 'B' has 131073 bytes, but MUSIC passes it on in one "
            "environment string of at most 131072; write long values to files and name the files "
            "[SL0203]");
}

}  // namespace
}  // namespace spikeloop
