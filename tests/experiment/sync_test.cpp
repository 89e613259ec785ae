// What simulated time may wait for, with and without ROS, and in which layout.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "spikeloop/experiment/music_job.hpp"
#include "tests/experiment/experiment_text.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

using experiment::Overrides;
using experiment::Sync;
using testing::ElementsAre;
using testing::IsEmpty;

class SyncKey : public testing::Test {
 protected:
  /// With these lines in place of the tick's.
  Read read_with(const std::string& lines, bool robot = true, const Overrides& overrides = {}) {
    files_.emplace_back(std::make_unique<Files>(
        with({{"tick: 1 ms", lines}, {"robot: {simulator: mujoco}\n", robot ? kRobot : ""}})));
    return read(*files_.back(), types_, overrides);
  }

  static constexpr const char* kRobot = "robot: {simulator: mujoco}\n";
  experiment::NodeTypes types_;
  std::vector<std::unique_ptr<Files>> files_;
};

TEST_F(SyncKey, OverRosARobotIsSteppedOrFollowed) {
  for (const bool robot : {true, false}) {
    for (const auto& [ros, sync] :
         {std::pair{"1", Sync::lockstep}, std::pair{"1", Sync::sim_time},
          std::pair{"2", Sync::lockstep}, std::pair{"2", Sync::sim_time}}) {
      const Read result =
          read_with(fmt::format("ros: {}\nsync: {}", ros, experiment::name_of(sync)), robot);
      EXPECT_EQ(experiment::name_of(result.experiment.ros), ros);
      EXPECT_THAT(result.faults, IsEmpty());
      EXPECT_EQ(result.experiment.sync, sync);
      EXPECT_EQ(result.experiment.sync_where.line, 4);
    }
  }
}

TEST_F(SyncKey, OfTheCommandLineIsNamedByTheOption) {
  EXPECT_THAT(
      read_with("sync: realtime", true, {.settings = {{"sync", "sim_time", "--sync"}}}).faults,
      ElementsAre(Fault("--sync: key 'sync': sim_time ... /clock ... ROS ... ros: 2,  or  sync: "
                        "lockstep ... [SL0208]")));
}

TEST_F(SyncKey, AnExportedJobHasTwoOfThem) {
  for (const Sync sync : {Sync::lockstep, Sync::sim_time}) {
    const std::string name(experiment::name_of(sync));
    const Read result = read_with("ros: 1\nsync: " + name);
    try {
      experiment::music_job(result.experiment, "");
      FAIL() << name;
    } catch (const ConfigurationError& error) {
      EXPECT_EQ(files_.back()->plain(error.what()),
                "x.yaml:4:7: key 'sync': an exported job has no " + name +
                    "; write realtime or unpaced [SL0601]");
    }
  }
  for (const char* name : {"realtime", "unpaced"}) {
    const Read result = read_with("ros: 1\nsync: " + std::string(name));
    EXPECT_NO_THROW(experiment::music_job(result.experiment, ""));
  }
}

}  // namespace
}  // namespace spikeloop::test
