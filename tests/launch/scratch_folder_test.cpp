// A folder that goes with its owner, however that ends, and not before those who still need it.
#include "spikeloop/processes/scratch_folder.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

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

}  // namespace
}  // namespace spikeloop
