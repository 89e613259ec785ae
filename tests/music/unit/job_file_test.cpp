#include "job_file.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include "spikeloop/process/music_main.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::music {
namespace {

constexpr const char* kText =
    "stoptime=1\n"
    "[sensor]\n  np=1\n  binary=s\n"
    "[encoder]\n  np=1\n  binary=e\n  rate_max=200\n"
    "  sensor.out -> encoder.in [100]\n";

class Environment {
 public:
  Environment(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
  ~Environment() { unsetenv(name_); }

 private:
  const char* name_;
};

// argv of a program.
struct Arguments {
  explicit Arguments(std::vector<std::string> words) : texts(std::move(words)) {
    for (auto& text : texts) {
      pointers.push_back(text.data());
    }
  }
  int count() const { return static_cast<int>(pointers.size()); }
  std::vector<std::string> texts;
  std::vector<char*> pointers;
};

TEST(JobFile, AProgramsPlaceHasOneDigitForMusic1116) {
  EXPECT_EQ(with_one_digit_color("encoder:9:12:sensor:1"), "encoder:9:12:sensor:1");
  EXPECT_EQ(with_one_digit_color("encoder:10:12:sensor:1"), "encoder:0:12:sensor:1");
  EXPECT_EQ(with_one_digit_color("encoder"), "encoder");
  EXPECT_EQ(with_one_digit_color(""), "");
}

TEST(SectionLabel, IsTheFirstFieldOfTheEnvironmentVariable) {
  EXPECT_EQ(label_in_environment("encoder:1:2:sensor:1:encoder:1:0"), "encoder");
  EXPECT_EQ(label_in_environment(""), "");

  const Environment config("_MUSIC_CONFIG_", "encoder:1:0:0");
  Arguments arguments({"music", "loop.music"});
  EXPECT_EQ(section_label(arguments.count(), arguments.pointers.data()), "encoder");
  EXPECT_TRUE(started_by_music(arguments.count(), arguments.pointers.data()));
}

TEST(SectionLabel, IsTheArgumentWithoutMusicsLauncher) {
  Arguments arguments({"./rate_encoder", "--music-config", "x.music", "--app-label", "left"});
  EXPECT_EQ(section_label(arguments.count(), arguments.pointers.data()), "left");
  EXPECT_TRUE(started_by_music(arguments.count(), arguments.pointers.data()));
}

TEST(SectionLabel, IsTheProgramsNameOtherwise) {
  Arguments arguments({"/usr/bin/rate_encoder"});
  EXPECT_EQ(section_label(arguments.count(), arguments.pointers.data()), "rate_encoder");
  EXPECT_EQ(called_as(arguments.count(), arguments.pointers.data()), "rate_encoder");
  EXPECT_FALSE(started_by_music(arguments.count(), arguments.pointers.data()));
}

TEST(JobFile, IsFoundByTheLaunchersArgumentAlsoAfterItsChangeOfDirectory) {
  const test::TemporaryDirectory directory;
  directory.write("loop.music", kText);
  const Environment config("_MUSIC_CONFIG_", "encoder:1:0:0");
  const Environment pwd("PWD", directory.path().c_str());
  Arguments arguments({"music", "loop.music"});
  const auto file = JobFile::find(arguments.count(), arguments.pointers.data());
  EXPECT_EQ(file.directory(), directory.path().string());
  EXPECT_EQ(file.where("encoder", "rate_max").line, 8);
  EXPECT_EQ(file.where("encoder", "stoptime").line, 1);
  EXPECT_EQ(file.where("encoder", "tau").line, 0);
}

TEST(JobFile, KnowsBothEndsOfConnections) {
  const JobFile file(parse_music(kText, "loop.music"));
  const auto in = file.ports("encoder");
  ASSERT_EQ(in.size(), 1u);
  EXPECT_EQ(in[0].port, "in");
  EXPECT_EQ(in[0].direction, Direction::input);
  const auto out = file.ports("sensor");
  ASSERT_EQ(out.size(), 1u);
  EXPECT_EQ(out[0].port, "out");
  EXPECT_EQ(out[0].direction, Direction::output);
  EXPECT_EQ(file.own_keys("encoder"), (std::vector<std::string>{"np", "binary", "rate_max"}));
}

TEST(JobFile, IsEmptyWithoutAFile) {
  const JobFile file;
  EXPECT_EQ(file.directory(), "");
  EXPECT_TRUE(file.ports("encoder").empty());
  EXPECT_TRUE(file.own_keys("encoder").empty());
  EXPECT_EQ(file.where("encoder", "tau").text(), "");
  Arguments arguments({"music", "/no/such/file.music"});
  const Environment config("_MUSIC_CONFIG_", "encoder:1:0:0");
  EXPECT_EQ(JobFile::find(arguments.count(), arguments.pointers.data()).directory(), "");
}

TEST(Help, ShowsPortsKeysAnExampleAndTheBarrier) {
  ProgramText text;
  text.name = "squarer";
  text.summary = "Squares";
  text.ports = "  in   input\n";
  text.parameters = {{.name = "power", .default_value = "2", .text = "What power"}};
  text.example = "  [squarer]\n";
  text.notes = "A note.\n";
  text.options["--list"] = {"a list", [] { return std::string("x"); }};
  const std::string help = help_text(text);
  for (const char* words : {"squarer: Squares", "  in   input", "power", "What power", "stoptime",
                            "  [squarer]", "A note.", "--list", "a list", "barrier=false"}) {
    EXPECT_NE(help.find(words), std::string::npos) << words;
  }
}

}  // namespace
}  // namespace spikeloop::music
