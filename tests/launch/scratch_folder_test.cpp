// A folder that goes with its owner, however that ends, and not before those who still need it.
#include "spikeloop/processes/scratch_folder.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/temporary_directory.hpp"

namespace spikeloop {
namespace {

namespace fs = std::filesystem;

TEST(ScratchFolder, IsRemovedWithWhatIsInIt) {
  std::string path;
  {
    const ScratchFolder folder;
    path = folder.path();
    std::ofstream(path + "/file") << "text";
    fs::create_directory(path + "/inner");
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(ScratchFolder, IsRemovedAfterTheLastOfThoseWhoNeedItWhenItsOwnerIsKilled) {
  const test::TemporaryDirectory parent;
  int needed[2];  // until its end is closed the folder is needed
  ASSERT_EQ(pipe(needed), 0);
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t owner = fork();
  if (owner == 0) {
    const ScratchFolder folder(parent.path().string());
    if (fork() == 0) {  // keeps what it has inherited
      close(needed[1]);
      char ignored = 0;
      [[maybe_unused]] const auto size = read(needed[0], &ignored, 1);
      _exit(0);
    }
    [[maybe_unused]] const auto size = write(ready[1], "x", 1);
    pause();
  }
  char ignored = 0;
  ASSERT_EQ(read(ready[0], &ignored, 1), 1);
  ASSERT_FALSE(fs::is_empty(parent.path()));
  kill(owner, SIGKILL);
  waitpid(owner, nullptr, 0);
  usleep(50'000);
  EXPECT_FALSE(fs::is_empty(parent.path())) << "somebody needs it";
  close(needed[1]);
  for (int i = 0; i < 1000 && !fs::is_empty(parent.path()); ++i) {
    usleep(10'000);
  }
  EXPECT_TRUE(fs::is_empty(parent.path()));
  close(needed[0]);
  close(ready[0]);
  close(ready[1]);
}

/// A folder like that of a killed run.
fs::path make_leftover(const fs::path& parent, const char* name) {
  fs::create_directory(parent / name);
  std::ofstream(parent / name / "vader_segment") << "text";
  return parent / name;
}

TEST(ScratchFolder, RemovesFoldersOfKilledRunsThatNoProcessHasLocked) {
  const test::TemporaryDirectory parent;
  const fs::path abandoned = make_leftover(parent.path(), "spikeloop-scratch-aaaaaa");
  const fs::path used = make_leftover(parent.path(), "spikeloop-scratch-bbbbbb");
  const fs::path longer = make_leftover(parent.path(), "spikeloop-scratch-results");
  const fs::path target = make_leftover(parent.path(), "target");
  const fs::path link = parent.path() / "spikeloop-scratch-cccccc";
  fs::create_directory_symlink(target, link);
  const fs::path foreign = make_leftover(parent.path(), "spikeloop-scratch-dddddd");
  const bool is_foreign = chown(foreign.c_str(), 12345, 12345) == 0;  // only root may
  const Descriptor lock{open(used.c_str(), O_RDONLY | O_CLOEXEC)};
  ASSERT_EQ(flock(lock.get(), LOCK_EX), 0);
  {
    const ScratchFolder folder(parent.path().string());
    EXPECT_FALSE(fs::exists(abandoned));
    EXPECT_TRUE(fs::exists(used / "vader_segment"));
    EXPECT_TRUE(fs::exists(longer / "vader_segment"));
    EXPECT_TRUE(fs::exists(target / "vader_segment"));
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_EQ(fs::exists(foreign), is_foreign);
    const ScratchFolder second(parent.path().string());
    EXPECT_TRUE(fs::exists(folder.path())) << "the first is in use";
  }
}

TEST(ScratchFolder, ItsRemoverIsNotStartedAgainIfTheFolderIsMissing) {
  const test::TemporaryDirectory parent;
  ScratchFolder folder(parent.path().string());
  pid_t remover = 0;
  std::ifstream("/proc/thread-self/children") >> remover;
  ASSERT_GT(remover, 0);
  siginfo_t ended{};
  kill(remover, SIGKILL);
  ASSERT_EQ(waitid(P_PID, static_cast<id_t>(remover), &ended, WEXITED | WNOWAIT), 0);
  fs::remove_all(folder.path());
  EXPECT_TRUE(folder.restart_remover());
  ASSERT_EQ(waitid(P_ALL, 0, &ended, WEXITED | WNOWAIT), 0) << "the next one ends by itself";
  EXPECT_FALSE(folder.restart_remover());
  EXPECT_FALSE(folder.restart_remover());
}

/// Each process makes folders while the others look for abandoned ones.
TEST(ScratchFolder, IsNotRemovedByARunThatStartsAtTheSameTime) {
  const test::TemporaryDirectory parent;
  std::vector<pid_t> runs;
  for (int run = 0; run < 8; ++run) {
    const pid_t pid = fork();
    if (pid == 0) {
      bool exists = true;
      for (int i = 0; i < 40 && exists; ++i) {
        const ScratchFolder folder(parent.path().string());
        const fs::path file = fs::path(folder.path()) / "file";
        std::ofstream(file) << "text";
        std::this_thread::yield();
        exists = fs::exists(file);
      }
      _exit(exists ? 0 : 1);
    }
    runs.push_back(pid);
  }
  for (const pid_t pid : runs) {
    int status = -1;
    waitpid(pid, &status, 0);
    EXPECT_EQ(status, 0);
  }
  EXPECT_TRUE(fs::is_empty(parent.path()));
}

}  // namespace
}  // namespace spikeloop
