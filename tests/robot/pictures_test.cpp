// spikeloop-robot's pictures: a film of a drive, and what it says where there can be none.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "robot_job.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::robot {
namespace {

using test::Fault;
using testing::MatchesRegex;

TEST(RobotPictures, ADriveLeavesItsFrames) {
  RobotJob job;
  job.start_core();
  const auto outcome =
      job.run(job.robot({"--duration", "1", "--world", "t_maze", "--render", "frames",
                         "--render-size", "64x48", "--render-rate", "5", "--camera", "16x12"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  for (int i = 1; i <= 6; ++i) {
    const std::string name = "frames/frame_00000" + std::to_string(i) + ".png";
    EXPECT_TRUE(job.directory().read(name).starts_with("\x89PNG")) << name;
  }
  EXPECT_FALSE(std::filesystem::exists(job.directory().path() / "frames/frame_000007.png"));
}

TEST(RobotPictures, WithoutOpenGlItSaysWhatToInstall) {
  RobotJob job;
  job.start_core();
  for (const std::vector<std::string>& options :
       {std::vector<std::string>{"--camera", "16x12"}, {"--render", "end.png"}}) {
    auto command = job.robot(options);
    command.environment["__EGL_VENDOR_LIBRARY_DIRS"] = "/nowhere";
    const auto outcome = job.run(command);
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_THAT(outcome.err,
                MatchesRegex("spikeloop-robot: cannot draw without a display: egl[A-Za-z]* failed "
                             "with EGL error 0x[0-9a-f]*; install Mesa's drivers:  apt-get install "
                             "libegl1 libgl1 libgl1-mesa-dri\n"));
  }
}

TEST(RobotPictures, WithoutADisplayThereIsNoWindow) {
  RobotJob job;
  job.start_core();
  auto command = job.robot({"--view"});
  command.environment["DISPLAY"] = command.environment["WAYLAND_DISPLAY"] = "";
  const auto outcome = job.run(command);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(
      outcome.err,
      Fault("spikeloop-robot: cannot open a window: ... DISPLAY ... --render FILE.mp4 ..."));
}

TEST(RobotPictures, WrongWordsAreRefusedBeforeAnythingElse) {
  RobotJob job;
  const auto refusal = [&](std::vector<std::string> options) {
    const auto outcome = job.run(job.robot(std::move(options)));
    EXPECT_EQ(outcome.exit_code, 2);
    return outcome.err;
  };
  EXPECT_EQ(
      refusal({"--camera", "64"}),
      "spikeloop-robot: '64' is not a size of a picture; write WIDTHxHEIGHT in pixels, at most "
      "4096 each, as 960x720\n");
  EXPECT_EQ(refusal({"--render", "a", "--render-view", "front"}),
            "spikeloop-robot: unknown view 'front'; write above, chase, camera, or several of them "
            "as above+chase\n");
  EXPECT_THAT(refusal({"--render", "a", "--render-rate", "nan"}),
              testing::HasSubstr("--render-rate: Value nan not in range"));
  EXPECT_THAT(refusal({"--render-rate", "5"}),
              testing::HasSubstr("--render-rate requires --render"));
  EXPECT_THAT(refusal({"--camera-fov", "50"}),
              testing::HasSubstr("--camera-fov requires --camera"));
}

}  // namespace
}  // namespace spikeloop::robot
