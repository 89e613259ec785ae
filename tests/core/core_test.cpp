// Time, errors, weights, logging and pacing.
#include <cerrno>
#include <cmath>
#include <limits>

#include "spikeloop/core/log.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/core/units.hpp"
#include "spikeloop/core/weights.hpp"
#include "support.hpp"

namespace spikeloop {
namespace {

using test::Fault;
using test::message_of;

TEST(Time, RoundsToTheNearestNanosecond) {
  EXPECT_EQ(from_seconds(0.001), 1'000'000);
  EXPECT_EQ(from_seconds(-1.4e-9), -1);
  EXPECT_EQ(from_seconds(0.1 + 0.2), 300'000'000);
  for (const TimeNs time : {TimeNs{1}, TimeNs{123'456'789'012'345}, TimeNs{3'600'000'000'001}}) {
    EXPECT_EQ(from_seconds(to_seconds(time)), time);
  }
}

TEST(Time, RefusesWhatCannotBeRepresented) {
  EXPECT_THAT(message_of<ConfigurationError>([] { from_seconds(std::nan("")); }),
              Fault("a time of nan s cannot be represented; write a finite number of seconds below "
                    "9e+09 [SL0203]"));
  EXPECT_THAT(message_of<ConfigurationError>([] { tick_from_seconds(0.0); }),
              Fault("a tick of 0 s is not a whole number of nanoseconds above 0; write for example "
                    "0.001 s [SL0207]"));
  EXPECT_THAT(message_of<ConfigurationError>([] { tick_from_seconds(1.0 / 3.0); }),
              Fault("... 0.3333333333333333 s ... 0 ... 0.333333333 s ... [SL0207]"));
  EXPECT_EQ(tick_from_seconds(0.05), 50'000'000);
}

TEST(Time, PrintsTheLargestUnitThatIsNotLonger) {
  EXPECT_EQ(format_time(0), "0 s");
  EXPECT_EQ(format_time(1'500'000), "1.5 ms");
  EXPECT_EQ(format_time(20'000'000'000), "20 s");
  EXPECT_EQ(format_time(3), "3 ns");
  EXPECT_EQ(format_time(1'000'001), "1.000001 ms");
  EXPECT_EQ(format_time(102'998'999'999), "102.998999999 s");
  EXPECT_EQ(format_time(-2'000'500), "-2.0005 ms");
}

TEST(Numbers, AreRoundedWithoutAnExponent) {
  EXPECT_EQ(format_rounded(217.4, 2), "220");
  EXPECT_EQ(format_rounded(1e6, 3), "1000000");
  EXPECT_EQ(format_rounded(999'999, 3), "1000000");
  EXPECT_EQ(format_rounded(0.004567, 2), "0.0046");
  EXPECT_EQ(format_rounded(2, 2), "2");
  EXPECT_EQ(format_rounded(0, 2), "0");
}

TEST(Interval, IsOpenOnTheLeftAndClosedOnTheRight) {
  const Interval interval{10, 20};
  EXPECT_FALSE(interval.contains(10));
  EXPECT_TRUE(interval.contains(11));
  EXPECT_TRUE(interval.contains(20));
  EXPECT_FALSE(interval.contains(21));
}

TEST(Errors, CarryTheirPlaceAndExitCode) {
  EXPECT_STREQ(ConfigurationError({"a.music", 3, 4}, "bad").what(), "a.music:3:4: bad");
  EXPECT_STREQ(ConfigurationError({"a.music", 3, 0}, "bad").what(), "a.music:3: bad");
  EXPECT_STREQ(ConfigurationError({"a.music", 0, 0}, "bad").what(), "a.music: bad");
  EXPECT_STREQ(ConfigurationError({"", 3, 4}, "bad").what(), "line 3:4: bad");
  EXPECT_STREQ(FileError("open", "x", ENOENT).what(),
               "cannot open 'x': No such file or directory [SL0109]");
  EXPECT_EQ(ConfigurationError("").exit_code(), 2);
  EXPECT_EQ(TransportError("").exit_code(), 3);
  EXPECT_EQ(FileError("").exit_code(), 4);
  EXPECT_EQ(NodeError("a", "b").exit_code(), 5);
}

TEST(Errors, AreOneLine) {
  EXPECT_STREQ(ConfigurationError("key 'a\nb\x1b[2J\x7F\xc3\xa4'").what(),
               "key 'a b?[2J?\xc3\xa4'");
  std::string seen;
  log::set_sink([&](log::Level, std::string_view message) { seen = message; });
  log::warning("'{}'", "x\r\ny");
  log::set_sink({});
  EXPECT_EQ(seen, "'x  y'");
}

TEST(Log, AListenerGetsWhatTheSinkGets) {
  std::vector<std::string> heard;
  log::warning("nobody");
  {
    const log::Listener listener(
        [&](log::Level, std::string_view message) { heard.emplace_back(message); });
    log::warning("without a sink");
    log::set_sink([](log::Level, std::string_view) {});
    log::info("with one");
    log::debug("below the level");
  }
  log::warning("too late");
  log::set_sink({});
  EXPECT_EQ(heard, (std::vector<std::string>{"without a sink", "with one"}));
}

TEST(DidYouMean, FindsSlipsAndListsOtherwise) {
  const std::vector<std::string> names = {"rate_encoder", "poisson_encoder", "connect"};
  EXPECT_EQ(did_you_mean("rate_encodre", names), "; did you mean 'rate_encoder'?");
  EXPECT_EQ(did_you_mean("Connect", names), "; did you mean 'connect'?");
  EXPECT_EQ(did_you_mean("zebra", names), "; known: rate_encoder, poisson_encoder, connect");
  EXPECT_EQ(did_you_mean("zebra", {}), "");
  EXPECT_EQ(nearest("x", {"y", "abc"}), "y");
}

TEST(Errors, NameTheHostWithoutAnAddress) {
  EXPECT_EQ(unresolved_host("localhost", "Name or service not known"),
            "the host name 'localhost' cannot be resolved (Name or service not known); add the "
            "line '127.0.0.1 localhost' to /etc/hosts");
  EXPECT_EQ(unresolved_host("robot", "no answer"),
            "the host name 'robot' cannot be resolved (no answer); add the line 'IP-ADDRESS robot' "
            "to /etc/hosts");
}

TEST(WeightTable, TakesItsSizeFromThePortsAndAgreesInAllShapes) {
  const WeightTable dense = WeightTable::dense(2, 3, {1, 0, 2, 0, 0, 3}).resized(2, 3);
  const WeightTable sparse = dense.compressed();
  for (std::uint32_t i = 0; i < 2; ++i) {
    for (std::uint32_t j = 0; j < 3; ++j) {
      EXPECT_EQ(dense.at(i, j), sparse.at(i, j));
    }
  }
  EXPECT_EQ(sparse.values, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(WeightTable::uniform().resized(2, 4).at(1, 3), 0.25);
  EXPECT_EQ(WeightTable::uniform(7).resized(2, 4).compressed().values.size(), 8U);
  const WeightTable diagonal = WeightTable::one_to_one(3).resized(3, 3);
  EXPECT_EQ(diagonal.at(1, 1), 3.0);
  EXPECT_EQ(diagonal.at(1, 2), 0.0);
  EXPECT_EQ(diagonal.compressed().values, (std::vector<double>{3, 3, 3}));
}

TEST(WeightTable, SaysWhichSizesDisagree) {
  EXPECT_THAT(message_of<ConfigurationError>(
                  [] { WeightTable::dense(2, 3, std::vector<double>(6)).resized(2, 4); }),
              Fault("... 2 rows and 3 columns ... 2 outputs and 4 inputs ... [SL0308]"));
  EXPECT_THAT(message_of<ConfigurationError>([] { WeightTable::one_to_one().resized(2, 4); }),
              Fault("one-to-one ... but there are 2 outputs and 4 inputs; write a weight file "
                    "instead ... [SL0308]"));
}

TEST(Log, ReachesTheSinkAboveItsLevelOnly) {
  std::vector<std::string> seen;
  log::warning("lost {}", 1);
  log::set_sink([&](log::Level, std::string_view text) { seen.emplace_back(text); });
  log::debug("hidden {}", 2);
  log::info("shown {}", 3);
  log::set_level(log::Level::warning);
  log::info("hidden {}", 4);
  log::warning("shown {}", 5);
  log::set_level(log::Level::info);
  log::set_sink({});
  EXPECT_EQ(seen, (std::vector<std::string>{"shown 3", "shown 5"}));
}

TEST(Pacer, RealtimeNeverBeginsATickBeforeItsTime) {
  const auto pacer = make_realtime_pacer(2.0, 1'000'000);
  const TimeNs before = wall_now();
  pacer->start();
  pacer->wait_until(40'000'000);
  EXPECT_GE(wall_now() - before, 20'000'000);
  EXPECT_EQ(pacer->report().ticks, 1U);
}

TEST(Pacer, CountsOverrunsAndGivesUpWhatIsLostBeyondItsCatchUp) {
  const auto pacer = make_realtime_pacer(1.0, 1'000'000);
  pacer->start();
  const TimeNs stalled = wall_now() + 300'000'000;
  while (wall_now() < stalled) {
  }
  pacer->wait_until(1'000'000);  // about 299 ms late: 199 ms are given up, 100 ms are caught up
  EXPECT_EQ(pacer->report().overruns, 1U);
  EXPECT_GE(pacer->report().worst_lateness, 298'000'000);
  const TimeNs before = wall_now();
  pacer->wait_until(300'000'000);  // would be due now, is due 199 ms later
  EXPECT_GE(wall_now() - before, 150'000'000);
}

TEST(Pacer, UnpacedDoesNotWait) {
  const auto pacer = make_unpaced_pacer();
  pacer->start();
  for (int i = 0; i < 1000; ++i) {
    pacer->wait_until(TimeNs{i} * kNsPerSecond);
  }
  EXPECT_EQ(pacer->report().ticks, 1000U);
  EXPECT_EQ(pacer->report().overruns, 0U);
}

TEST(Pacer, RefusesAFactorThatCannotBeKept) {
  EXPECT_THAT(message_of<ConfigurationError>([] { make_realtime_pacer(0.0, 1); }),
              Fault("a real-time factor of 0 cannot be kept; write a number above 0, 1 is real "
                    "time [SL0203]"));
}

}  // namespace
}  // namespace spikeloop
