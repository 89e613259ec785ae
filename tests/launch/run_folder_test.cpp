// What a run finds in its folder and removes from it, and who may use it.
#include "spikeloop/launch/run_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <set>

#include "spikeloop/core/error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::launch {
namespace {

using testing::UnorderedElementsAre;

const std::string kRecording = "\x89HDF\r\n ... spikeloop_format ...";

class Folder : public testing::Test {
 protected:
  test::TemporaryDirectory directory_;
  const std::string path_ = directory_.path().string();

  std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(path_)) {
      names.insert(entry.path().filename());
    }
    return names;
  }

  void refused(const std::string& why) const {
    try {
      const RunFolder folder(path_, "", false);
      FAIL() << "it was taken";
    } catch (const ConfigurationError& error) {
      EXPECT_EQ(std::string(error.what()), "the folder '" + path_ + "' " + why +
                                               ", or give another folder with --out [SL0109]");
    }
  }
  static constexpr const char* kResults = "has the results of a run; write --force to replace them";
};

TEST_F(Folder, KeepsTheResultsOfARunUnlessForced) {
  directory_.write("effective.music", "");
  directory_.write("encoder.h5", kRecording);
  directory_.write("notes.txt", "");
  refused(kResults);
  directory_.write("summary.json", R"({"simulated_s": 2.5})");
  directory_.write("trajectory.csv", "");
  const RunFolder folder(path_, "", true);
  EXPECT_EQ(folder.path(), path_);
  EXPECT_THAT(files(), UnorderedElementsAre("notes.txt", "effective.music"));
}

TEST_F(Folder, OfSomebodyElseKeepsItsFiles) {
  directory_.write("resolved.json", R"({"mine": 1})");
  directory_.write("log.txt", "mine");
  std::filesystem::create_directories(directory_.path() / "experiment-files" / "x");
  refused(
      "is not that of a run, and has a file 'resolved.json', which a run writes; write --force "
      "to replace it");
  const RunFolder folder(path_, "", true);
  EXPECT_THAT(files(), UnorderedElementsAre("resolved.json", "log.txt", "experiment-files"));
  EXPECT_TRUE(std::filesystem::exists(directory_.path() / "experiment-files" / "x"));
}

TEST_F(Folder, LinksCountAsFilesAndAreReplaced) {
  for (const char* name : {"log.txt", "eye.h5", "experiment-files"}) {
    const auto link = directory_.path() / name;
    std::filesystem::create_symlink("nowhere", link);
    refused(std::string("is not that of a run, and has a file '") + name +
            "', which a run writes; write --force to replace it");
    const RunFolder folder(path_, "", true);
    EXPECT_THAT(files(), testing::IsEmpty());
  }
}

TEST_F(Folder, NumberingSkipsDanglingLinks) {
  std::filesystem::create_symlink("nowhere", directory_.path() / "a-1");
  EXPECT_EQ(RunFolder("", path_ + "/a", false).path(), path_ + "/a-2");
}

TEST_F(Folder, OfARunThatNeverBeganIsUsedAgain) {
  for (const char* summary : {R"({"simulated_s": 0})", "{}", "[1]", "no JSON"}) {
    directory_.write("summary.json", summary);
    directory_.write("effective.music", "");
    const RunFolder folder(path_, "", false);
    EXPECT_THAT(files(), UnorderedElementsAre("effective.music")) << summary;
  }
  directory_.write("summary.json", R"({"simulated_s": 0.001})");
  refused(kResults);
}

TEST_F(Folder, KeepsFilesOfOthersWithTheNameOfARecording) {
  directory_.write("new.h5", "\x89HDF\r\n of somebody else");
  const RunFolder folder(path_, "", true);
  EXPECT_THAT(files(), UnorderedElementsAre("new.h5"));
}

TEST_F(Folder, WithoutANameIsTheFirstThatIsFree) {
  const RunFolder first("", path_ + "/runs/a", false);
  const RunFolder second("", path_ + "/runs/a", false);
  EXPECT_EQ(first.path(), path_ + "/runs/a-1");
  EXPECT_EQ(second.shown(), path_ + "/runs/a-2");
}

TEST_F(Folder, IsHeldByOneRun) {
  std::optional<RunFolder> first;
  first.emplace(path_, "", false);
  directory_.write("summary.json", R"({"simulated_s": 1})");
  try {
    const RunFolder second(path_, "", true);
    FAIL() << "two runs in one folder";
  } catch (const FileError& error) {
    EXPECT_EQ(error.exit_code(), 4);
    EXPECT_EQ(std::string(error.what()),
              "another run that has not ended writes to the folder '" + path_ +
                  "'; wait for its end, or give another folder with --out [SL0109]");
  }
  EXPECT_THAT(files(), UnorderedElementsAre("summary.json")) << "it is the first one's";
  first.reset();
  EXPECT_NO_THROW(RunFolder(path_, "", true));
}

TEST_F(Folder, ThatCannotBeClearedIsAnError) {
  directory_.write("effective.music", "");
  std::filesystem::create_directories(directory_.path() / "summary.json" / "x");
  try {
    const RunFolder folder(path_, "", true);
    FAIL() << "it was removed";
  } catch (const FileError& error) {
    EXPECT_EQ(std::string(error.what()),
              "cannot remove '" + path_ + "/summary.json': Directory not empty [SL0109]");
  }
}

}  // namespace
}  // namespace spikeloop::launch
