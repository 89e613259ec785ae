// The example's controller on the real physics: beams -> rates -> spikes -> linear readout ->
// Twist, closed through the library (no ROS, no MUSIC), judged by what the vehicle does.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "benchmarks/braitenberg/drive.hpp"
#include "worlds.hpp"

namespace spikeloop::vehicle {
namespace {

using braitenberg::Controller;
using braitenberg::Drive;
using braitenberg::Readout;
using nlohmann::json;

json read_example(const std::string& name) {
  return json::parse(std::ifstream(std::string(SPIKELOOP_EXAMPLES) + "/01_braitenberg/" + name));
}

Readout example_readout() {
  const auto weights = read_example("readout_weights.json").get<std::vector<std::vector<double>>>();
  const json mapping = read_example("mapping.json")["mapping"];
  Readout readout;
  for (const char* field : {"linear.x", "angular.z"}) {
    const json& entry = mapping.at(field);
    const auto channel = entry.at("channel").get<std::size_t>();
    readout.channels.at(channel) = {weights.at(channel), entry.value("offset", 0.0),
                                    entry.at("min").get<double>(), entry.at("max").get<double>()};
  }
  return readout;
}

/// Driven once, whichever test asks first.
const Statistics& driven(const Drive& given) {
  static std::map<std::pair<std::uint64_t, TimeNs>, Statistics> known;
  const auto [place, is_new] = known.try_emplace({given.seed, given.delay});
  if (is_new) {
    place->second = drive(example_readout(), given);
  }
  return place->second;
}

class Braitenberg : public testing::TestWithParam<Drive> {};

TEST_P(Braitenberg, DrivesWithoutCollision) {
  const Statistics& result = driven(GetParam());
  std::printf("seed %2d  delay %2d ms  collisions %d  mean speed %.2f m/s  coverage %.0f %%\n",
              static_cast<int>(GetParam().seed), static_cast<int>(GetParam().delay / kMs),
              static_cast<int>(result.collisions), result.mean_speed_m_s, 100 * result.coverage);
  EXPECT_EQ(result.collisions, 0U);
  EXPECT_GE(result.mean_speed_m_s, 0.2);
  // The demonstration asks for 30 %, which most reach; in some arenas the path closes to a loop.
  EXPECT_GE(result.coverage, 0.25);
}

std::vector<Drive> drives() {
  std::vector<Drive> all;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    all.push_back({seed, 5 * kMs, 0.0});
    all.push_back({seed, 50 * kMs, 0.618});
  }
  return all;
}

INSTANTIATE_TEST_SUITE_P(Seeds, Braitenberg, testing::ValuesIn(drives()), [](const auto& instance) {
  return "Seed" + std::to_string(instance.param.seed) + "Delay" +
         std::to_string(instance.param.delay / kMs) + "ms";
});

TEST(BraitenbergDrives, FourOfFiveVisitThirtyPercentOfTheCells) {
  const std::vector<Drive> all = drives();
  const auto wide =
      std::ranges::count_if(all, [](const Drive& given) { return driven(given).coverage >= 0.3; });
  EXPECT_GE(5 * wide, 4 * std::ssize(all));
}

TEST(BraitenbergReadout, ASilentNetworkDoesNotDriveOn) {
  const Controller controller(example_readout(), 0);
  EXPECT_EQ(controller.command(0), 0);
}

}  // namespace
}  // namespace spikeloop::vehicle
