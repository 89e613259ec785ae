// Messages of music-adapters and gymz, as their texts.
#include "spikeloop/zmq/wire.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "spikeloop/core/error.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::zmq {
namespace {

using test::Fault;

std::vector<double> channels(const ObservationReader& reader) {
  return {reader.channels().begin(), reader.channels().end()};
}

TEST(ObservationReader, ScalesGymObservationsToMinusOneToOne) {
  ObservationReader reader("GymObservation", 3, true);
  EXPECT_TRUE(reader.read(R"([{"max": 2, "min": -2, "value": 1, "ts": 5},
                              {"max": 2, "min": 0, "value": 0, "ts": 5},
                              {"max": -2, "min": -8, "value": -2.5, "ts": 5}])",
                          5.001));
  const auto values = channels(reader);
  EXPECT_DOUBLE_EQ(values[0], 0.5);
  EXPECT_DOUBLE_EQ(values[1], -1);
  EXPECT_DOUBLE_EQ(values[2], 2 * 5.5 / 6 - 1);
  EXPECT_EQ(reader.counts().late, 0u);
  EXPECT_EQ(reader.take_warning(), "");
}

// music-adapters halved them.
TEST(ObservationReader, TakesAFloatArrayAsItIs) {
  ObservationReader reader("FloatArray", 2, true);
  EXPECT_TRUE(reader.read("[0.25, -7]", 0));
  EXPECT_EQ(channels(reader), (std::vector<double>{0.25, -7}));
}

TEST(ObservationReader, LimitsToTheRange) {
  ObservationReader reader("GymObservation", 2, true);
  EXPECT_TRUE(
      reader.read(R"([{"value": 9, "min": 0, "max": 1}, {"value": -9, "min": 0, "max": 1}])", 0));
  EXPECT_EQ(channels(reader), (std::vector<double>{1, -1}));
}

// music-adapters divided by max - min.
TEST(ObservationReader, AnEntryThatIsNoReadingKeepsItsChannel) {
  ObservationReader reader("GymObservation", 1, true);
  EXPECT_TRUE(reader.read(R"([{"value": 1, "min": 0, "max": 2}])", 0));
  for (const char* entry :
       {R"([{"value": 1, "min": 1, "max": 1}])", R"([{"value": 1}])", "[3]", "[null]",
        R"([{"value": "1", "min": 0, "max": 2}])", R"([{"value": 1, "min": 2, "max": 0}])"}) {
    EXPECT_TRUE(reader.read(entry, 0));
    EXPECT_EQ(channels(reader), std::vector<double>{0}) << entry;
  }
  EXPECT_EQ(reader.counts().invalid_readings, 6u);
  EXPECT_EQ(
      reader.take_warning(),
      R"(entry 0 is not a reading: {"max":1,"min":1,"value":1}; an observation has 'value', and )"
      "'min' below 'max'");
}

TEST(ObservationReader, AMessageThatIsNoArrayChangesNothing) {
  ObservationReader reader("FloatArray", 1, true);
  EXPECT_TRUE(reader.read("[1]", 0));
  for (const char* text : {"", "{}", "[1", "3", "\xff\xfe", "[1] [2]"}) {
    EXPECT_FALSE(reader.read(text, 0)) << text;
  }
  EXPECT_EQ(channels(reader), std::vector<double>{1});
  EXPECT_EQ(reader.counts().malformed, 6u);
  EXPECT_EQ(reader.take_warning(), "a message that is not a JSON array was left out: ''");
}

TEST(ObservationReader, DeeplyNestedMessagesAreMalformed) {
  ObservationReader reader("FloatArray", 1, true);
  EXPECT_FALSE(reader.read(std::string(1'000'000, '[') + std::string(1'000'000, ']'), 0));
  EXPECT_EQ(reader.counts().malformed, 1u);
}

TEST(ObservationReader, MessagesThatDoNotFitAreCroppedWithOneWarningOrRefused) {
  ObservationReader lax("FloatArray", 2, false);
  EXPECT_TRUE(lax.read("[1, 2, 3]", 0));
  EXPECT_EQ(lax.take_warning(),
            "a message brought 3 values, but the port has 2 channels: the last ones are left out; "
            "write [3] in its connection");
  EXPECT_TRUE(lax.read("[4, 5, 6]", 0));
  EXPECT_EQ(lax.take_warning(), "");
  EXPECT_TRUE(lax.read("[7]", 0));
  EXPECT_EQ(lax.take_warning(),
            "a message brought 1 values, but the port has 2 channels: the others keep their value, "
            "0 at first; write [1] in its connection");
  EXPECT_EQ(channels(lax), (std::vector<double>{7, 5}));
  EXPECT_EQ(lax.counts().cropped, 2u);
  EXPECT_EQ(lax.counts().short_messages, 1u);
  ObservationReader fresh("FloatArray", 3, false);
  EXPECT_TRUE(fresh.read("[7]", 0));
  EXPECT_EQ(channels(fresh), (std::vector<double>{7, 0, 0}));
  ObservationReader strict("FloatArray", 2, true);
  try {
    strict.read("[1]", 0);
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(), Fault("... 1 values ... 2 channels ... [1] ... [SL0505]"));
  }
}

TEST(ObservationReader, CountsMessagesOlderThanGymzTolerates) {
  ObservationReader reader("GymObservation", 1, true);
  reader.read(R"([{"value": 1, "min": 0, "max": 2, "ts": 100}])", 100.009);
  EXPECT_EQ(reader.counts().late, 0u);
  reader.read(R"([{"value": 1, "min": 0, "max": 2, "ts": 100}])", 100.011);
  EXPECT_EQ(reader.counts().late, 1u);
}

TEST(ObservationReader, NamesItsTypes) {
  try {
    ObservationReader("LaserScan", 1, true);
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_STREQ(error.what(),
                 "message_type 'LaserScan' is not known; write message_type=GymObservation or "
                 "FloatArray [SL0502]");
  }
}

TEST(Commands, AreWhatGymzReads) {
  const double values[] = {0.1, -3};
  EXPECT_EQ(float_array(values), "[0.1,-3.0]");
  EXPECT_EQ(nlohmann::json::parse(gym_command(values, -1, 2, 17.5)),
            nlohmann::json::parse(R"([{"value": 0.1, "ts": 17.5, "max": 2.0, "min": -1.0},
                                      {"value": -3.0, "ts": 17.5, "max": 2.0, "min": -1.0}])"));
}

}  // namespace
}  // namespace spikeloop::zmq
