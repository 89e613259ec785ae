#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <utility>

#include "spikeloop/config/music_file.hpp"
#include "tests/config/helpers.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::music_parser_test {
namespace {

using test::Fault;
using test::message_of;

MusicFile parse(std::string_view text) {
  return parse_music(text, "f");
}

/// The global value of `k` in "k=...".
std::string value_of(const std::string& text) {
  const MusicFile file = parse(text);
  const MusicKey* key = find_key(file.globals, "k");
  return key == nullptr ? "no key" : key->value;
}

std::string error(std::string_view text) {
  return message_of([&] { parse(text); });
}

TEST(MusicParser, ReadsTheVehicle) {
  const MusicFile file = read_music_file(test::data_path_of("vehicle.music"));
  EXPECT_EQ(file.labels(),
            (std::vector<std::string>{"scan", "halves", "spikes", "brain", "readout", "wheels"}));
  EXPECT_EQ(find_key(file.globals, "music_timestep")->value, "0.01");
  EXPECT_EQ(find_key(file.globals, "music_timestep")->where.line, 4);
  const MusicSection& brain = file.section("brain");
  EXPECT_EQ(brain.where.line, 24);
  EXPECT_EQ(find_key(brain.keys, "args")->value, "--resolution 0.1 --name \"brain one\"");
  EXPECT_EQ(find_key(brain.keys, "args")->where.column, 3);
  EXPECT_EQ(file.find_key(brain, "rtf")->value, "1");
  EXPECT_EQ(file.find_key(brain, "rmf"), nullptr);
  EXPECT_EQ(file.processes(brain), 2);
  EXPECT_EQ(file.total_processes(), 7);
  ASSERT_EQ(file.connections.size(), 5u);
  EXPECT_EQ(describe(file.connections[4]), "readout.out -> wheels.in");
  EXPECT_EQ(file.connections[0].width, 8u);
  EXPECT_EQ(file.connections[4].where.line, 44);
  EXPECT_NO_THROW(check_structure(file));
}

constexpr const char* kEarlierNames =
    "pace=false\n[sensor]\nbinary=bin/ros_sensor_adapter\npace=true\n"
    "[own]\nbinary=own.py\npace=0.5\n[command]\nbinary=cont_ros_adapter\n"
    "sensor.pace -> command.pace [1]\nsensor.pace -> own.pace [1]\nown.pace -> command.in [1]\n";

TEST(MusicParser, GivesKeysAndPortsTheirPresentNames) {
  const MusicFile file = parse(kEarlierNames);
  EXPECT_EQ(file,
            parse("clock_master=false\n[sensor]\nbinary=bin/ros_sensor_adapter\nclock_master=true\n"
                  "[own]\nbinary=own.py\npace=0.5\n[command]\nbinary=cont_ros_adapter\n"
                  "sensor.data_stamp -> command.data_stamp [1]\nsensor.data_stamp -> own.pace [1]\n"
                  "own.pace -> command.in [1]\n"));
  EXPECT_EQ(find_key(file.section("sensor").keys, "clock_master")->where.line, 4);
  EXPECT_EQ(error("[a]\nclock_master=true\npace=true\n"),
            "f:3:1: 'clock_master' and 'pace' are two spellings of one key; leave out 'pace' "
            "[SL0102]");
}

TEST(MusicParser, ReadsReopenedSectionsContinuedValuesAndTwoByteLineEnds) {
  const MusicFile file = read_music_file(test::data_path_of("camera.music"));
  EXPECT_EQ(file.labels(), (std::vector<std::string>{"camera one", "code"}));
  EXPECT_EQ(find_key(file.globals, "stoptime")->value, "12.5");
  const MusicSection& camera = file.section("camera one");
  EXPECT_EQ(find_key(camera.keys, "args")->value, "-a # \r\n  -b");
  EXPECT_EQ(find_key(camera.keys, "ros_topic")->value, "/camera\\raw:8");
  EXPECT_EQ(find_key(camera.keys, "ros_topic")->where.line, 13);
  EXPECT_EQ(file.processes(camera), 1);
  ASSERT_EQ(file.connections.size(), 2u);
  EXPECT_EQ(describe(file.connections[0]), "camera one.out -> code.in");
  EXPECT_EQ(file.connections[0].width, 1024u);
  EXPECT_EQ(file.connections[0].processing, Processing::table);
  EXPECT_EQ(file.connections[1].width, std::nullopt);
  EXPECT_NO_THROW(check_structure(file));
}

TEST(MusicParser, ValuesFollowTheGrammar) {
  EXPECT_EQ(value_of("k=a"), "a");
  EXPECT_EQ(value_of("k="), "");
  EXPECT_EQ(value_of("k =  a b\t \n"), "a b");
  EXPECT_EQ(value_of("k=a#b"), "a");
  EXPECT_EQ(value_of("k=#b"), "");
  EXPECT_EQ(value_of("k=a;b"), "a;b");
  EXPECT_EQ(value_of("k=a\\#b"), "a#b");
  EXPECT_EQ(value_of("k=a\\\nb"), "a\nb");
  EXPECT_EQ(value_of("k=a\\\r\nb"), "a\r\nb");
  EXPECT_EQ(value_of("k=a\\ "), "a");  // escaped or not, blanks at the end go
  EXPECT_EQ(value_of("k=\"a # b\nc\" # d"), "a # b\nc");
  EXPECT_EQ(value_of("k=\" \\\"\\x\\\\ \""), " \"x\\ ");
  EXPECT_EQ(value_of("k=a \"b\""), "a \"b\"");
  EXPECT_EQ(value_of("k=a=b"), "a=b");
  EXPECT_EQ(value_of("k=a\rz=b"), "a");
  EXPECT_EQ(value_of("k=a\nk=b"), "b");
  EXPECT_EQ(value_of("[s]\nk=a\n[]\nk=b"), "b");
  EXPECT_EQ(value_of("# k=b\n\n \tk=\xC3\xA4"), "\xC3\xA4");
}

TEST(MusicParser, KeysAndLabelsFollowTheGrammar) {
  const MusicFile file = parse("a\\#b-c < d = 1\n[ l\\]#\t] # c\nx\\->y=2");
  EXPECT_EQ(file.globals.at(0).name, "a#b-c < d");
  EXPECT_EQ(file.sections.at(0).label, "l]#");
  EXPECT_EQ(file.sections.at(0).keys.at(0).name, "x->y");
}

TEST(MusicParser, DuplicateKeysKeepTheFirstPlaceAndTheLastValue) {
  const MusicFile file = parse("a=1\nb=2\na=3");
  ASSERT_EQ(file.globals.size(), 2u);
  EXPECT_EQ(file.globals[0], (MusicKey{"a", "3", {}}));
  EXPECT_EQ(file.globals[0].where.line, 3);
}

TEST(MusicParser, ConnectionsTakeTheirSectionsApplication) {
  const auto one = [](const std::string& text) { return parse("[S]\n" + text).connections.at(0); };
  EXPECT_EQ(describe(one("out->B.in")), "S.out -> B.in");
  EXPECT_EQ(describe(one("in<-B.out")), "B.out -> S.in");
  EXPECT_EQ(describe(one("A.out -> in")), "A.out -> S.in");
}

TEST(MusicParser, ConnectionsSplitAtTheFirstDotAndKnowOptions) {
  const auto one = [](const std::string& text) { return parse("[S]\n" + text).connections.at(0); };
  EXPECT_EQ(describe(one("A .b.c\t-> .in")), "A.b.c -> S.in");
  EXPECT_EQ(one("a->B.in[]").width, std::nullopt);
  EXPECT_EQ(one("a->B.in[ 007 ]").width, 7u);
  EXPECT_EQ(one("a->B.in[10 # c").width, 10u);
  EXPECT_EQ(one("a->B.in[2147483647]").width, 2147483647u);
  EXPECT_EQ(one("a->B.in[10,]").communication, Communication::point_to_point);
  EXPECT_EQ(one("a->B.in[,COLLECTIVE # c").communication, Communication::collective);
  EXPECT_EQ(one("a->B.in[1, point - to-point,table]").processing, Processing::table);
  EXPECT_EQ(one("a->B.in[1,,tree]").processing, Processing::tree);
}

TEST(MusicParser, TextAfterAWidthIsReadAsANewLine) {
  const MusicFile file = parse("A.a->B.b[1] C.c->D.d[2] k=3\n");
  EXPECT_EQ(file.connections.size(), 2u);
  EXPECT_EQ(file.connections[1].where.column, 13);
  EXPECT_EQ(file.globals.at(0), (MusicKey{"k", "3", {}}));
  EXPECT_EQ(
      error("A.a->B.b[1] junk"),
      "f:1:13: 'junk' is neither a section nor a key nor a connection; write 'junk=value', or '#' "
      "before a comment [SL0101]");
}

TEST(MusicParser, ColumnsCountCharacters) {
  EXPECT_THAT(error("k=\"\xC3\xA4\xE2\x82\xAC\" x"), testing::StartsWith("f:1:8: "));
}

TEST(MusicParser, LinesCountAllLineEnds) {
  EXPECT_THAT(error("a=1\nb=2\r\nc=3\rjunk"), testing::StartsWith("f:4:1: "));
}

struct Case {
  std::string text;
  std::string message;
};

TEST(MusicParser, RefusesWhatMusicAbortsFor) {
  const Case cases[] = {
      {"A.a->B.b[abc]", "f:1:10: the width 'abc' ... '[10]' ... [SL0307]"},
      {"A.a->B.b[-3]", "f:1:10: the width '-3' ... '[10]' ... [SL0307]"},
      {"A.a->B.b[1.5]", "f:1:10: the width '1.5' ... '[10]' ... [SL0307]"},
      {"A.a->B.b[10", "f:1:10: the width '[10' has no ']'; write '[10]' [SL0101]"},
      {"A.a->B.b[\n", "f:1:10: the width '[' has no ']'; write '[10]' [SL0101]"},
      {"A.a->B.b[10 20]",
       "f:1:10: two numbers in a width, '10' and '2'; write one, '[10]' [SL0101]"},
      {"A.a->B.b[1,tree",
       "f:1:12: no ']' after 'tree'; write '[10, point-to-point, tree]' [SL0101]"},
      {"A.a->B.b[1,,tree,x]",
       "f:1:13: a fourth option in the width's brackets; write at most '[10, point-to-point, "
       "tree]' [SL0101]"},
      {"A.a->B.b[99999999999]",
       "f:1:1: the width 99999999999 is too large; write at most 2147483647 [SL0307]"},
      {"A.a->B.b[2147483648]",
       "f:1:1: the width 2147483648 is too large; write at most 2147483647 [SL0307]"},
      {"A.a->B.b[10, foo]",
       "f:1:1: unknown communication 'foo'; known: point-to-point, collective [SL0205]"},
      {"A.a->B.b[10, colective]",
       "f:1:1: unknown communication 'colective'; did you mean 'collective'? [SL0205]"},
      {"A.a->B.b[10, collective, foo]",
       "f:1:1: unknown processing 'foo'; known: tree, table [SL0205]"},
      {"A.a->B.b[10,, tabel]", "f:1:1: unknown processing 'tabel'; did you mean 'table'? [SL0205]"},
      {"[A\n", "f:1:1: the section '[A' has no ']'; write '[A]' [SL0101]"},
      {"[", "f:1:1: the section '[' has no ']'; write '[label]' [SL0101]"},
      {"[A\\\n]", "f:1:1: the section '[A' has no ']'; write '[A]' [SL0101]"},
      {"[A] x",
       "f:1:5: text after the section '[A]'; write it on the next line, or '#' before a comment "
       "[SL0101]"},
      {"\n k=\"a\nb",
       "f:2:4: the quote that opens the value of 'k' is never closed; write '\"' at its end, and "
       "'\\\"' for a quote inside [SL0101]"},
      {"k=\"a\\", "f:1:3: ... 'k' ... '\"' ... and '\\\"' ... [SL0101]"},
      {"k=\"a\nb\" c",
       "f:2:4: text after the closing quote of 'k' (line 1); write '\\\"' for a quote inside the "
       "value, or '#' before a comment [SL0101]"},
      {"k=a\\",
       "f:1:1: the value of 'k' ends with a backslash at the end of the file; write '\\\\' for a "
       "backslash [SL0101]"},
      {"k\\\n=a",
       "f:1:1: the key 'k' ends with a backslash; only a value may go on in the next line, write "
       "the key on one line [SL0101]"},
      {"out -> B.in",
       "f:1:1: the sender application of port 'out' is missing; before the first section write "
       "'application.out' [SL0101]"},
      {"A.out -> in",
       "f:1:1: the receiver application of port 'in' is missing ... 'application.in' ... [SL0101]"},
  };
  for (const auto& [text, message] : cases) {
    EXPECT_THAT(error(text), Fault(message)) << text;
  }
}

TEST(MusicParser, RefusesWhatMusicMisreadsWithoutAWord) {
  const std::string no = "' is neither a section nor a key nor a connection; ";
  const Case cases[] = {
      {"junk", "f:1:1: 'junk" + no + "write 'junk=value', or '#' before a comment [SL0101]"},
      {"junk # c", "f:1:1: 'junk" + no + "write 'junk=value', or '#' before a comment [SL0101]"},
      {"; c", "f:1:1: '; c" + no + "write '#' before a comment [SL0101]"},
      {"// c", "f:1:1: '// c" + no + "write '#' before a comment [SL0101]"},
      {"np: 1", "f:1:1: 'np: 1" + no + "write 'np=...' with '=' [SL0101]"},
      {"A.out > B.in",
       "f:1:1: 'A.out > B.in" + no + "write a connection as 'A.out -> B.in [width]' [SL0101]"},
      {"A]",
       "f:1:1: 'A]" + no +
           "write '[label]' for a section and 'A.out -> B.in [width]' for a connection [SL0101]"},
      {"=5", "f:1:1: no key before '='; write 'key=value' [SL0101]"},
      {"A.out => B.in",
       "f:1:1: 'A.out=>' would be a key for MUSIC; write a connection with '->' [SL0101]"},
      {"A.a -> B.b -> C.c [1]",
       "f:1:1: a second arrow in 'b -> C.c'; write each connection on a line of its own [SL0101]"},
      {"A.out -> B.in 10", "f:1:1: 'in 10' ... 'A.out -> B.in [width]' ... [SL0106]"},
      {"A.out -> B.in]",
       "f:1:1: 'in]' is not a valid port name; write 'A.out -> B.in [width]' [SL0106]"},
      {"A.out -> B.in=3", "f:1:1: 'in=3' ... 'A.out -> B.in [width]' ... [SL0106]"},
      {"-> B.in",
       "f:1:1: the connection has no sender port; write 'A.out -> B.in [width]' [SL0101]"},
      {"A. -> B.in", "f:1:1: ... sender ... 'A.out -> B.in [width]' ... [SL0101]"},
      {"A.out ->",
       "f:1:1: the connection has no receiver port; write 'A.out -> B.in [width]' [SL0101]"},
      {"A.out -> # B.in", "f:1:1: ... receiver ... 'A.out -> B.in [width]' ... [SL0101]"},
      {"A.out -> [1]", "f:1:1: ... receiver ... 'A.out -> B.in [width]' ... [SL0101]"},
      {"[a:b]",
       "f:1:1: the label 'a:b' contains ':', which MUSIC ... write letters, digits and '_' ... "
       "[SL0106]"},
      {"A.out -> B:c.in",
       "f:1:1: the label 'B:c' contains ':', which MUSIC ... write letters, digits and '_' ... "
       "[SL0106]"},
      {"A.o\\\\x -> B.in",
       "f:1:1: the port 'o\\x' contains '\\', which MUSIC ... write letters, digits and '_' ... "
       "[SL0106]"},
      {"a\\=b=1",
       "f:1:1: the key 'a=b' contains '=', which MUSIC ... write letters, digits and '_' ... "
       "[SL0106]"},
      {"\xEF\xBB\xBFnp=1",
       "f:1:1: the file begins with a UTF-8 byte order mark, which MUSIC takes for a part of the "
       "first line; save it as UTF-8 without byte order mark [SL0101]"},
      {std::string("\xFF\xFEn\0", 4),
       "f:1:1: the file is UTF-16 text; save it as UTF-8 without byte order mark [SL0101]"},
      {std::string("a=1\nb\0", 6),
       "f:2:2: a zero byte: this is not a text file; give the path of a .music file [SL0101]"},
  };
  for (const auto& [text, message] : cases) {
    EXPECT_THAT(error(text), Fault(message)) << text;
  }
}

TEST(MusicParser, LongAndUnprintableTextIsShortenedInMessages) {
  const std::string message = error(std::string(200, 'x') + "\x01");
  EXPECT_THAT(message, testing::HasSubstr("'" + std::string(60, 'x') + "...'"));
  EXPECT_THAT(error("a\x01"
                    "b"),
              testing::HasSubstr("'a?b'"));
}

TEST(MusicFile, SaysWhenItCannotBeRead) {
  const test::TemporaryDirectory directory;
  const auto read = [&](const std::string& name) {
    return message_of([&] { read_music_file(directory.path() / name); });
  };
  const std::string at = directory.path().string();
  EXPECT_THAT(read("none"), Fault("cannot open '" + at + "/none': ... [SL0109]"));
  EXPECT_EQ(read(""), "cannot read '" + at + "/': Is a directory [SL0109]");
  EXPECT_THAT(message_of([] { read_music_file("/dev/null"); }),
              Fault("cannot read '/dev/null': not a regular file ... .music file ... [SL0109]"));
  directory.write("huge", std::string(5'000'000, ' '));
  EXPECT_EQ(
      read("huge"),
      at + "/huge: the file has 5 MB, more than the 4 MB that a .music file may have [SL0203]");
}

TEST(MusicFile, FindsAndSets) {
  MusicFile file = parse("g=1\n[encoder]\nk=2\ng=3");
  EXPECT_EQ(message_of([&] { file.section("encodr"); }),
            "f: there is no section '[encodr]'; did you mean 'encoder'? [SL0301]");
  set_key(file.section("encoder").keys, "k", "5");
  set_key(file.section("encoder").keys, "new", "6");
  EXPECT_EQ(file.find_key(file.section("encoder"), "k")->value, "5");
  EXPECT_EQ(file.find_key(file.section("encoder"), "new")->value, "6");
  EXPECT_EQ(file.find_key(file.section("encoder"), "g")->value, "3");
  EXPECT_EQ(std::as_const(file).find_section("x"), nullptr);
}

TEST(AdoptLocations, WhereBothSayTheSame) {
  const MusicFile origin =
      parse_music("stoptime=1\n[a]\nnp=1\nk=1\n[b]\nnp=1\na.o -> b.i [2]\n", "mine");
  MusicFile made =
      parse_music("\n[b]\nnp=1\nx=1\n[a]\nk=2\nnp=1\na.o -> b.i [2]\na.o -> b.p\n", "made");
  adopt_locations(made, origin);
  EXPECT_EQ(made.section("b").where.text(), "mine:5:1");
  EXPECT_EQ(find_key(made.section("a").keys, "np")->where.text(), "mine:3:1");
  EXPECT_EQ(find_key(made.section("a").keys, "k")->where.text(), "") << "another value";
  EXPECT_EQ(find_key(made.section("b").keys, "x")->where.text(), "");
  EXPECT_EQ(made.connections[0].where.text(), "mine:7:1");
  EXPECT_EQ(made.connections[1].where.text(), "");
}

TEST(ParseMusic, NotesWhatIsHardlyMeant) {
  const MusicFile file = parse_music("x=1\nx=2\n[a]\nk=1\nk=2\n[b]\nk=1\n[a]\n", "f");
  ASSERT_EQ(file.warnings.size(), 3U);
  EXPECT_EQ(file.warnings[0].where.text(), "f:2:1");
  EXPECT_THAT(file.warnings[0].message,
              Fault("duplicate key 'x' ... :1:1; the last one holds ... [SL0102]"));
  EXPECT_EQ(file.warnings[1].where.text(), "f:5:1");
  EXPECT_EQ(
      file.warnings[2].message,
      "the section '[a]' was opened in line 3 already, and MUSIC takes both for one; write it "
      "once [SL0107]");
}

}  // namespace
}  // namespace spikeloop::music_parser_test
