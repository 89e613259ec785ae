// What a run removes from its folder, and who may use it.
#include "run_folder.hpp"

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

MusicFile file_with(const std::string& label) {
  return parse_music("[" + label + "]\nnp=1\nbinary=rate_encoder\n", "job.music");
}

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
};

TEST_F(Folder, LosesWhatAnEarlierRunWrote) {
  directory_.write("effective.music", "[old]\nnp=1\nbinary=rate_encoder\n");
  for (const char* name : {"old.h5", "new.h5", "mine.h5"}) {
    directory_.write(name, kRecording);
  }
  directory_.write("summary.json", "{}");
  directory_.write("notes.txt", "");
  const RunFolder folder(path_, file_with("new"));
  EXPECT_EQ(folder.path(), path_);
  EXPECT_EQ(files().size(), 6U) << "the run may not begin after all";
  directory_.write("effective.music", "");
  folder.clear();
  EXPECT_THAT(files(), UnorderedElementsAre("mine.h5", "notes.txt", "effective.music"));
}

TEST_F(Folder, KeepsFilesOfOthersWithTheNameOfASection) {
  directory_.write("new.h5", "\x89HDF\r\n of somebody else");
  directory_.write("effective.music", "no such thing [");
  RunFolder(path_, file_with("new")).clear();
  EXPECT_THAT(files(), UnorderedElementsAre("new.h5", "effective.music"));
}

TEST_F(Folder, IsHeldByOneRun) {
  std::optional<RunFolder> first;
  first.emplace(path_, file_with("a"));
  directory_.write("summary.json", "{}");
  try {
    const RunFolder second(path_, file_with("a"));
    FAIL() << "two runs in one folder";
  } catch (const FileError& error) {
    EXPECT_EQ(error.exit_code(), 4);
    EXPECT_EQ(std::string(error.what()),
              "another run that has not ended writes to the folder '" + path_ +
                  "'; wait for its end, or give another folder with --out [SL0109]");
  }
  EXPECT_THAT(files(), UnorderedElementsAre("summary.json")) << "it is the first one's";
  first.reset();
  EXPECT_NO_THROW(RunFolder(path_, file_with("a")));
}

TEST_F(Folder, MayBeNone) {
  const RunFolder none("", file_with("a"));
  EXPECT_EQ(none.path(), "");
  EXPECT_NO_THROW(none.clear());
}

TEST_F(Folder, ThatCannotBeClearedIsAnError) {
  std::filesystem::create_directories(directory_.path() / "summary.json" / "x");
  try {
    RunFolder(path_, file_with("a")).clear();
    FAIL() << "it was removed";
  } catch (const FileError& error) {
    EXPECT_EQ(std::string(error.what()),
              "cannot remove '" + path_ + "/summary.json': Directory not empty [SL0109]");
  }
}

TEST_F(Folder, IsNotThatOfTheFileThatItWouldOverwrite) {
  directory_.write("effective.music", "[a]\nnp=1\nbinary=rate_encoder\n");
  try {
    const RunFolder folder(path_, read_music_file(path_ + "/effective.music"));
    FAIL() << "it would be overwritten";
  } catch (const ConfigurationError& error) {
    EXPECT_EQ(std::string(error.what()),
              "the file '" + path_ +
                  "/effective.music' would be overwritten with what is made from it; give another "
                  "folder with --out [SL0109]");
  }
}

}  // namespace
}  // namespace spikeloop::launch
