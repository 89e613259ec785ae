#include "spikeloop/sensing/event_keys.hpp"

#include <gtest/gtest.h>

#include "spikeloop/core/error.hpp"

namespace {

using namespace spikeloop;

messages::EventSettings settings_of(const WrittenValues& written) {
  return sensing::event_settings(resolve(sensing::event_parameters(), written, {}),
                                 "dvs_msgs/EventArray");
}

TEST(EventKeys, defaults_are_the_whole_camera) {
  const messages::EventSettings settings = settings_of({});
  EXPECT_EQ(settings.message_type, "dvs_msgs/EventArray");
  EXPECT_EQ(settings.polarity, messages::Polarity::both);
  EXPECT_EQ(settings.downsample, 1u);
  EXPECT_FALSE(settings.region);
  EXPECT_EQ(settings.refractory, 0);
}

TEST(EventKeys, a_region_is_a_list_or_a_text) {
  for (const char* text : {"[100, 60, 128, 64]", "100,60,128,64"}) {
    const messages::EventSettings settings = settings_of(
        {{"roi", {text, {}}}, {"polarity", {"split", {}}}, {"refractory", {"2 ms", {}}}});
    ASSERT_TRUE(settings.region) << text;
    EXPECT_EQ(settings.region->x, 100u);
    EXPECT_EQ(settings.region->height, 64u);
    EXPECT_EQ(settings.polarity, messages::Polarity::split);
    EXPECT_EQ(settings.refractory, 2'000'000);
  }
}

TEST(EventKeys, what_is_no_region_is_told_with_its_place) {
  for (const char* text : {"[]", "[1, 2, 3]", "[1, 2, 0, 4]", "1,2,3,-4", "all"}) {
    try {
      settings_of({{"roi", {text, {"x.music", 3, 5}}}});
      FAIL() << text;
    } catch (const ConfigurationError& error) {
      EXPECT_NE(std::string(error.what()).find("x.music:3:5: key 'roi': "), std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
