#include "spikeloop/core/file.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <string>

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

TEST_F(WriteFile, ReplacesALinkAndNotItsTarget) {
  const std::function<void(const std::string&)> writers[] = {
      [](const std::string& file) { write_file(file, "second"); },
      [](const std::string& file) { create_stream(file) << "second"; },
      [this](const std::string& file) { copy_to_new_file(path("source"), file); }};
  write_file(path("source"), "second");
  for (const auto& write : writers) {
    write_file(path("target"), "first");
    for (const char* target : {"target", "nowhere"}) {  // a link without a target counts as a file
      for (const char* link : {"link", "link.new"}) {
        fs::remove(path(link));
        fs::create_symlink(path(target), path(link));
      }
      write(path("link"));
      EXPECT_EQ(text("target"), "first");
      EXPECT_FALSE(fs::exists(path("nowhere")));
      EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(path("link"))));
      EXPECT_EQ(text("link"), "second");
    }
  }
}

/// User without write permission in `folder`, which contains only files of this user.
class ReadOnlyFolder {
 public:
  explicit ReadOnlyFolder(const fs::path& folder) : folder_(folder) {
    const uid_t user = ::geteuid() == 0 ? 65534 : ::geteuid();
    for (const auto& entry : fs::directory_iterator(folder)) {
      EXPECT_EQ(::lchown(entry.path().c_str(), user, static_cast<gid_t>(-1)), 0);
    }
    ::chmod(folder_.c_str(), 0555);
    EXPECT_EQ(::seteuid(user), 0);
  }
  ~ReadOnlyFolder() {
    EXPECT_EQ(::seteuid(::getuid()), 0);
    ::chmod(folder_.c_str(), 0755);
  }
  ReadOnlyFolder(const ReadOnlyFolder&) = delete;
  ReadOnlyFolder& operator=(const ReadOnlyFolder&) = delete;

 private:
  fs::path folder_;
};

TEST_F(WriteFile, WritesInPlaceIfTheFolderIsReadOnly) {
  for (const char* name : {"a", "b", "target", "named"}) {
    write_file(path(name), "first, and longer");
  }
  fs::create_symlink(path("target"), path("link"));
  fs::create_hard_link(path("named"), path("second_name"));
  const ReadOnlyFolder folder(fs::path(path("a")).parent_path());
  write_file(path("a"), "second");
  create_stream(path("b")) << "second";
  EXPECT_EQ(text("a"), "second");
  EXPECT_EQ(text("b"), "second");
  for (const char* refused : {"link", "named", "missing"}) {
    EXPECT_THROW(write_file(path(refused), "second"), FileError) << refused;
    EXPECT_THROW(create_file(path(refused)), FileError) << refused;
  }
  EXPECT_EQ(text("target"), "first, and longer");
  EXPECT_EQ(text("named"), "first, and longer");
}

TEST_F(WriteFile, CopiesAnEmptyFile) {
  write_file(path("source"), "");
  copy_to_new_file(path("source"), path("copy"));
  EXPECT_EQ(text("copy"), "");
}

TEST_F(WriteFile, WritesToAPipeInPlace) {
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  const int reader = ::open(path("pipe").c_str(), O_RDONLY | O_NONBLOCK);
  write_file(path("pipe"), "text");
  char buffer[9] = {};
  EXPECT_EQ(::read(reader, buffer, sizeof buffer), 4);
  ::close(reader);
  EXPECT_TRUE(fs::is_fifo(path("pipe")));
}

TEST_F(WriteFile, WritesToAnOpenDescriptorInPlace) {
  const int file = ::open(path("out").c_str(), O_WRONLY | O_CREAT, 0600);
  write_file("/dev/fd/" + std::to_string(file), "text");  // like /dev/stdout
  ::close(file);
  EXPECT_EQ(text("out"), "text");
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

class OpenRegularFile : public WriteFile {
 protected:
  [[nodiscard]] bool opens(const char* name, Links links) const {
    try {
      ::close(open_regular_file(path(name), "text", links));
      return true;
    } catch (const FileError&) {
      return false;
    }
  }
};

TEST_F(OpenRegularFile, FollowsLinksOnlyIfItMay) {
  write_file(path("target"), "text");
  fs::create_symlink(path("target"), path("link"));
  EXPECT_TRUE(opens("target", Links::refuse));
  EXPECT_TRUE(opens("link", Links::follow));
  EXPECT_FALSE(opens("link", Links::refuse));
}

TEST_F(OpenRegularFile, RefusesWhatIsNotAFileAtOnce) {
  fs::create_directory(path("folder"));
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  for (const char* name : {"folder", "pipe", "missing"}) {
    EXPECT_FALSE(opens(name, Links::follow)) << name;
  }
}

}  // namespace
}  // namespace spikeloop
