// Scripts in a job: which are ours, and what the launcher writes for them.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "spikeloop/launch/effective_file.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::launch::script_programs_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// What the section's program reads; "-" when there is no such key.
std::string value(const MusicFile& file, const std::string& label, const std::string& key) {
  const MusicKey* found = file.find_key(file.section(label), key);
  return found == nullptr ? "-" : found->value;
}

/// The effective file of a chain with a brain.py of this text.
MusicFile with_brain(const std::string& script) {
  const test::TemporaryDirectory directory;
  const std::string text = R"(
[encoder]
np=1
binary=rate_encoder
[brain]
np=1
binary=./brain.py
[decoder]
np=1
binary=linear_readout_decoder
encoder.out -> brain.in [2]
brain.out -> decoder.in [2]
)";
  const std::string path = directory.write("loop.music", text);
  std::filesystem::permissions(directory.write("brain.py", script),
                               std::filesystem::perms::owner_all);
  RunOptions options;
  options.record = true;
  return make_effective(parse_music(text, path), options).file;
}

TEST(Programs, AScriptThatImportsOurPackageIsOurs) {
  for (const char* import :
       {"import spikeloop", "import numpy, spikeloop", "import spikeloop.neuron",
        "    from spikeloop.brian import music", "from spikeloop import music",
        "import spikeloop\r", "import spikeloop.neuron\r"}) {
    const MusicFile file =
        with_brain(fmt::format("#!/usr/bin/python3\n\"\"\"Text\"\"\"\n{}\n", import));
    EXPECT_EQ(value(file, "brain", "record"), "true") << import;
    EXPECT_EQ(value(file, "encoder", "stamp_guard"), "false") << import;
    EXPECT_EQ(value(file, "brain", "clock_master"), "-") << import;
  }
}

/// The warnings of a cycle of two scripts with these keys.
std::vector<std::string> warnings_of_scripts(const std::string& keys) {
  const test::TemporaryDirectory directory;
  const std::string script = directory.write("a.py", "#!/usr/bin/python3\nimport spikeloop\n");
  std::filesystem::permissions(script, std::filesystem::perms::owner_all);
  const std::string section = "np=1\nbinary=./a.py\n" + keys;
  const std::string text =
      "[a]\n" + section + "[b]\n" + section + "a.out -> b.in [1]\nb.out -> a.in [1]\n";
  const std::string path = directory.write("loop.music", text);
  const EffectiveFile made = make_effective(parse_music(text, path), {});
  EXPECT_EQ(value(made.file, "a", "accept_latency"), keys.empty() ? "-" : "1 ms");
  return made.warnings;
}

TEST(Programs, WhatScriptsAcceptInACycleCounts) {
  EXPECT_THAT(warnings_of_scripts("accept_latency=1 ms\n"), IsEmpty());
  EXPECT_THAT(warnings_of_scripts(""), ElementsAre(HasSubstr("the cycle a -> b -> a lacks 2 ms")));
}

// NEST with MUSIC rounds times to 1 us: a spike just after a tick's begin would be before it.
TEST(Programs, SpikesForAScriptOfNestKeepAwayFromTheTick) {
  for (const char* import :
       {"import spikeloop.nest", "import spikeloop, spikeloop.nest", "from spikeloop import nest",
        "  from spikeloop.nest import music", "import spikeloop\nimport spikeloop.nest as n"}) {
    const MusicFile file = with_brain(fmt::format("#!/usr/bin/python3\n{}\n", import));
    EXPECT_EQ(value(file, "brain", "record"), "true") << import;
    EXPECT_EQ(value(file, "encoder", "stamp_guard"), "-") << import;
  }
}

TEST(Programs, AnotherScriptIsForeign) {
  for (const char* text :
       {"#!/usr/bin/python3\nimport nest\n", "#!/usr/bin/python3\nimport spikeloops\n",
        "#!/usr/bin/python3\nprint('import spikeloop')\n", "import spikeloop\n",
        "#!/usr/bin/python3\n# import spikeloop\n"}) {
    const MusicFile file = with_brain(text);
    EXPECT_EQ(value(file, "brain", "record"), "-") << text;
    EXPECT_EQ(value(file, "encoder", "stamp_guard"), "-") << text;
  }
}

}  // namespace
}  // namespace spikeloop::launch::script_programs_test
