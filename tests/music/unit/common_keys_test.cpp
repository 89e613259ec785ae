#include "spikeloop/process/common_keys.hpp"
#include "tests/support/fault.hpp"

#include <gtest/gtest.h>

namespace spikeloop::music {
namespace {

using test::Fault;

CommonKeys parse(const std::map<std::string, std::string>& texts,
                 const CommonDefaults& defaults = {},
                 const std::vector<std::string>& programs = {}) {
  WrittenValues written;
  for (const auto& [name, text] : texts) {
    written[name] = {text, {"loop.music", 7, 3}};
  }
  return parse_common_keys(written, defaults, programs);
}

std::string error_of(const std::map<std::string, std::string>& texts) {
  try {
    parse(texts);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "no error";
}

TEST(CommonKeys, HaveTheDefaultsOfTheOlderPrograms) {
  const auto keys = parse({});
  EXPECT_FALSE(keys.stoptime.has_value());
  EXPECT_EQ(keys.music_timestep, 1'000'000);
  EXPECT_TRUE(keys.barrier);
  EXPECT_EQ(keys.seed, 1u);
  EXPECT_EQ(keys.dialect, Dialect::rma);
  EXPECT_FALSE(keys.strict);
  EXPECT_FALSE(keys.clock_master);
  EXPECT_EQ(keys.rtf, 1.0);
  EXPECT_FALSE(keys.unpaced);
  EXPECT_TRUE(keys.stamp_guard);
  EXPECT_EQ(keys.accept_latency, 0);
  EXPECT_EQ(keys.signal_delay, 0);
  EXPECT_FALSE(keys.record);
}

TEST(CommonKeys, AreReadAsWritten) {
  const auto keys = parse({{"stoptime", "2.5"},
                           {"music_timestep", "0.0005"},
                           {"barrier", "false"},
                           {"seed", "42"},
                           {"dialect", "ma"},
                           {"strict", "true"},
                           {"clock_master", "true"},
                           {"rtf", "0.5"},
                           {"sync", "unpaced"},
                           {"stamp_guard", "false"},
                           {"accept_latency", "0.0009"},
                           {"signal_delay", "3"},
                           {"record", "true"}});
  EXPECT_EQ(keys.stoptime, 2'500'000'000);
  EXPECT_EQ(keys.music_timestep, 500'000);
  EXPECT_FALSE(keys.barrier);
  EXPECT_EQ(keys.seed, 42u);
  EXPECT_EQ(keys.dialect, Dialect::ma);
  EXPECT_TRUE(keys.strict);
  EXPECT_TRUE(keys.clock_master);
  EXPECT_EQ(keys.rtf, 0.5);
  EXPECT_TRUE(keys.unpaced);
  EXPECT_FALSE(keys.stamp_guard);
  EXPECT_EQ(keys.accept_latency, 900'000);
  EXPECT_EQ(keys.signal_delay, 3);
  EXPECT_TRUE(keys.record);
}

TEST(CommonKeys, TakeUnits) {
  EXPECT_EQ(parse({{"stoptime", "3 min"}}).stoptime, 180 * kNsPerSecond);
  EXPECT_EQ(parse({{"music_timestep", "2 ms"}}).music_timestep, 2'000'000);
}

TEST(CommonKeys, MakeTheSourceOfAJobItsClockMasterByDefault) {
  EXPECT_TRUE(parse({}, {.clock_master = true}).clock_master);
  EXPECT_FALSE(parse({{"clock_master", "false"}}, {.clock_master = true}).clock_master);
}

TEST(CommonKeys, AcceptOneTickOnlyInTheDialectWhoseProgramDid) {
  const CommonDefaults decoder{.accept_one_tick = true};
  EXPECT_EQ(parse({{"music_timestep", "0.002"}}, decoder).accept_latency, 2'000'000);
  EXPECT_EQ(parse({{"music_timestep", "0.002"}}, decoder).spike_delay, 2'000'000);
  EXPECT_EQ(parse({{"dialect", "ma"}}, decoder).accept_latency, 0);
  EXPECT_EQ(parse({{"dialect", "ma"}}, decoder).spike_delay, 0);
  EXPECT_EQ(parse({{"accept_latency", "0.001"}}, decoder).spike_delay, 0);
  EXPECT_EQ(parse({{"dialect", "auto"}}, decoder, {"linear_decoder"}).accept_latency, 0);
  EXPECT_EQ(parse({{"dialect", "auto"}}, decoder).accept_latency, 1'000'000);
  EXPECT_EQ(parse({{"accept_latency", "0"}}, decoder).accept_latency, 0);
}

TEST(CommonKeys, EndAfterOneSecondInTheDialectWhoseProgramsDid) {
  EXPECT_FALSE(parse({{"dialect", "rma"}}).stoptime.has_value());
  EXPECT_EQ(parse({{"dialect", "ma"}}).stoptime, kNsPerSecond);
  EXPECT_EQ(parse({{"dialect", "ma"}, {"stoptime", "5"}}).stoptime, 5 * kNsPerSecond);
}

TEST(CommonKeys, AutoIsTheDialectOfTheJobsPrograms) {
  const auto dialect_of = [](const std::vector<std::string>& programs) {
    return parse({{"dialect", "auto"}}, {}, programs).dialect;
  };
  EXPECT_EQ(dialect_of({"rate_encoder"}), Dialect::rma);
  EXPECT_EQ(dialect_of({"rate_encoder", "cont_zmq_adapter"}), Dialect::ma);
  try {
    dialect_of({"connect_adapter", "cont_zmq_adapter"});
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_EQ(std::string(error.what()).find("loop.music:7:3: dialect=auto cannot choose: "), 0U);
  }
}

TEST(CommonKeys, SayWhatIsWrongAndWhatToWrite) {
  EXPECT_THAT(error_of({{"barrier", "yes"}}),
              Fault("loop.music:7:3: key 'barrier': 'yes' ... true or false ... [SL0205]"));
  EXPECT_THAT(error_of({{"sync", "lockstep"}}),
              Fault("loop.music:7:3: key 'sync': 'lockstep' is not in this version ... [SL0205]"));
  EXPECT_THAT(error_of({{"sync", "sim_time"}}),
              Fault("loop.music:7:3: key 'sync': 'sim_time' ... [SL0205]"));
  EXPECT_THAT(error_of({{"seed", "-1"}}),
              Fault("loop.music:7:3: key 'seed': -1 ... 0 to 9223372036854775807 ... [SL0203]"));
  EXPECT_THAT(error_of({{"stoptime", "-1"}}),
              Fault("loop.music:7:3: key 'stoptime': -1 ... 0 s ... [SL0203]"));
  EXPECT_NE(
      error_of({{"music_timestep", "0.0000000015"}}).find("loop.music:7:3: key 'music_timestep': "),
      std::string::npos);
}

TEST(CommonKeys, SpikesAreDelayedByWholeTicks) {
  const auto keys =
      parse_common_keys({{"spike_delay", {"3", {}}}, {"music_timestep", {"2 ms", {}}}});
  EXPECT_EQ(keys.spike_delay, 6'000'000);
  EXPECT_EQ(keys.accept_latency, 0);
}

TEST(CommonKeys, AreDeclaredForHelp) {
  const auto declared = common_parameters({.clock_master = true});
  for (const auto& parameter : declared) {
    EXPECT_FALSE(parameter.text.empty()) << parameter.name;
    EXPECT_TRUE(parameter.default_value.has_value()) << parameter.name;
  }
}

}  // namespace
}  // namespace spikeloop::music
