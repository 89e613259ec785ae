#include "spikeloop/images/image_settings.hpp"

#include "tests/images/pictures.hpp"
#include "tests/support/fault.hpp"

namespace {

using spikeloop::test::Fault;
using namespace spikeloop;
using namespace spikeloop::images;

ImageSettings settings_of(const std::map<std::string, std::string>& keys) {
  WrittenValues written;
  for (const auto& [key, value] : keys) {
    written[key] = {value, {}};
  }
  return image_settings(resolve(image_parameters(), written, {}));
}

std::string error_of(const std::map<std::string, std::string>& keys) {
  return test::error_of([&] { settings_of(keys); });
}

TEST(ImageSettings, are_read) {
  const ImageSettings settings = settings_of({{"crop", "[0, 120, 640, 240]"},
                                              {"resize", "40,30"},
                                              {"channel", "rgb"},
                                              {"range", "[16, 235.5]"},
                                              {"intensity", "log"},
                                              {"filter", "on_off"},
                                              {"centre", "0.5"},
                                              {"surround", "2"},
                                              {"gain", "4"}});
  EXPECT_EQ(settings.crop->y, 120u);
  EXPECT_EQ(settings.crop->height, 240u);
  EXPECT_EQ(settings.resize->width, 40u);
  EXPECT_EQ(settings.channel, Channel::rgb);
  EXPECT_EQ(settings.range->second, 235.5);
  EXPECT_EQ(settings.intensity, Intensity::log);
  EXPECT_EQ(settings.filter, Filter::on_off);
  EXPECT_EQ(settings.centre, 0.5);
  EXPECT_EQ(settings.surround, 2);
  EXPECT_EQ(settings.gain, 4);
  EXPECT_EQ(settings.values(), 6u * 40 * 30);
}

TEST(ImageSettings, number_of_values) {
  EXPECT_EQ(settings_of({}).values(), std::nullopt);
  EXPECT_EQ(settings_of({{"crop", "[1, 2, 3, 4]"}}).values(), 12u);
  EXPECT_EQ(settings_of({{"resize", "[40, 30]"}, {"channel", "red"}}).values(), 1200u);
}

TEST(ImageSettings, what_is_wrong_is_said) {
  const std::string crop = "... 4 ... crop: [0, 120, 640, 240] ... [SL0105]";
  EXPECT_THAT(error_of({{"crop", "[1, 2, 3]"}}), Fault("C: key 'crop': '[1, 2, 3]'" + crop));
  EXPECT_THAT(error_of({{"crop", "middle"}}), Fault("C: key 'crop': 'middle'" + crop));
  EXPECT_EQ(error_of({{"crop", "[1, 2, 0, 4]"}}),
            "C: key 'crop': a part without pixels; write [x, y, width, height], as in [0, 120, "
            "640, 240] [SL0203]");
  EXPECT_THAT(error_of({{"crop", "[1, 2.5, 3, 4]"}}),
              Fault("C: key 'crop': entry 2: '2.5' ... 0 to 1000000 ... [SL0204]"));
  const std::string size = "... 1 to 4096 ... [SL0203]";
  EXPECT_THAT(error_of({{"resize", "40"}}),
              Fault("C: key 'resize': '40' ... 2 ... resize: [40, 30] ... [SL0105]"));
  EXPECT_THAT(error_of({{"resize", "[40, 0]"}}), Fault("C: key 'resize': entry 2: 0" + size));
  EXPECT_THAT(error_of({{"resize", "[5000, 30]"}}), Fault("C: key 'resize': entry 1: 5000" + size));
  EXPECT_THAT(
      error_of({{"range", "[255, 0]"}}),
      Fault("C: key 'range': minimum 255 is not below maximum 0; write  range: [0, 255] [SL0206]"));
  EXPECT_EQ(
      error_of({{"filter", "on_off"}, {"surround", "0.5"}}),
      "C: key 'surround': 0.5 is not above centre, 1; write for example 3 times as much [SL0206]");
  EXPECT_THAT(error_of({{"filter", "on_off"}, {"centre", "4"}}),
              Fault("C: key 'surround': 3 ... 4 ... 3 ... [SL0206]"));
  EXPECT_EQ(error_of({{"centre", "4"}}), "no error");
}

}  // namespace
