#include "spikeloop/core/file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "spikeloop/core/error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class WriteFile : public testing::Test {
 protected:
  [[nodiscard]] std::string path(const char* name) const {
    return (folder_.path() / name).string();
  }
  [[nodiscard]] std::string text(const char* name) const {
    return read_file(path(name), "text", 100);
  }
  [[nodiscard]] auto files() const {
    return std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator());
  }

 private:
  test::TemporaryDirectory folder_;
};

TEST_F(WriteFile, ReplacesTheWholeFileByAnother) {
  write_file(path("a.json"), "first, and longer");
  fs::create_hard_link(path("a.json"), path("reader"));
  write_file(path("a.json"), "second");
  EXPECT_EQ(text("a.json"), "second");
  EXPECT_EQ(text("reader"), "first, and longer") << "who has it open reads on in the whole old one";
  EXPECT_EQ(files(), 2);
}

TEST_F(WriteFile, WritesThroughALink) {
  write_file(path("target"), "first");
  fs::create_symlink(path("target"), path("link"));
  write_file(path("link"), "second");
  EXPECT_EQ(text("target"), "second");
  EXPECT_TRUE(fs::is_symlink(path("link")));
}

TEST_F(WriteFile, NamesTheFileThatCannotBeWritten) {
  const auto fails = [](const std::string& where, const char* why) {
    try {
      write_file(where, "text");
      ADD_FAILURE() << where << " was written";
    } catch (const FileError& error) {
      EXPECT_THAT(error.what(), HasSubstr("'" + where + "'"));
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
  };
  fails(path("nowhere/a.json"), "No such file or directory");
  fails(fs::path(path("")).parent_path().string(), "Is a directory");
  fails("/dev/full", "No space left on device");
}

}  // namespace
}  // namespace spikeloop
