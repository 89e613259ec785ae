// `--set KEY=VALUE`: as if the file had been written so.
#include <gmock/gmock.h>

#include "spikeloop/experiment/layout.hpp"
#include "tests/experiment/experiment_text.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

using experiment::Experiment;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::StartsWith;

class SettingsTest : public testing::Test {
 protected:
  /// The good file with these settings; "NAME" for its part of that name.
  Read read_with(const std::vector<std::string>& texts, const std::string& text = kGood) {
    experiment::Overrides overrides;
    for (const std::string& setting : texts) {
      overrides.settings.push_back(parse_setting(setting));
    }
    files_.push_back(std::make_unique<Files>(text));
    return read(*files_.back(), types_, overrides);
  }
  Experiment good(const std::vector<std::string>& texts, const std::string& text = kGood) {
    const Read result = read_with(texts, text);
    EXPECT_THAT(result.faults, IsEmpty());
    return result.experiment;
  }

  experiment::NodeTypes types_;
  std::vector<std::unique_ptr<Files>> files_;
};

TEST_F(SettingsTest, ReplaceKeysOfTheExperimentNodesAndRobot) {
  const Experiment experiment = good({"duration=2 min", "seed=3", "encoder.rate_max=100 Hz",
                                      "robot.seed=9", "nodes.decoder.tau=10 ms", "seed=4"});
  EXPECT_EQ(experiment.duration, 120'000'000'000);
  EXPECT_EQ(experiment.seed, 4U) << "the last one holds";
  EXPECT_EQ(experiment.robot->seed, 9U);
  EXPECT_EQ(experiment.node("encoder").parameters.number("rate_max"), 100);
  EXPECT_EQ(experiment.node("decoder").parameters.number("tau"), 0.01);
  EXPECT_EQ(experiment.settings.size(), 6U);
}

TEST_F(SettingsTest, MicroIsEitherLetter) {
  const std::string text = with({{"tau: 30 ms", "tau: 30 \u00b5s"}});
  ASSERT_NE(text, kGood);
  EXPECT_EQ(good({}, text).node("decoder").parameters.number("tau"), 30e-6);
  EXPECT_EQ(good({"decoder.tau=20 \u03bcs"}).node("decoder").parameters.number("tau"), 20e-6);
}

TEST_F(SettingsTest, AddKeysThatTheFileDoesNotHave) {
  const Experiment experiment =
      good({"sync=lockstep", "encoder.rate_min=5 Hz", "robot.camera.width=32"});
  EXPECT_EQ(experiment.sync, experiment::Sync::lockstep);
  EXPECT_EQ(experiment.node("encoder").parameters.number("rate_min"), 5);
  EXPECT_EQ(experiment.robot->camera->width, 32U);
}

TEST_F(SettingsTest, ReachIntoMapsAndListsAndMayReplaceThem) {
  const std::string text =
      with({{"weights: w.json", "weights: [[1, 0, 0], [0, 1, 0]]"},
            {"net.yaml", std::string("{") + "populations: {input: {model: input, size: 3}, "
                                            "r: {model: repeater, size: 3}}, connections: "
                                            "[{from: input, to: r, rule: one_to_one, delay: "
                                            "1 ms}], output: [r]}"}});
  const Experiment experiment =
      good({"decoder.weights.1.2=0.5", "wheels.fields.linear.x=1", "wheels.limits.linear.x=[0, 2]",
            "brain.network.connections.0.delay=4 ms"},
           text);
  EXPECT_EQ(experiment.node("decoder").parameters.weights("weights").values,
            (std::vector<double>{1, 0, 0, 0, 1, 0.5}));
  EXPECT_EQ(experiment.node("wheels").written.at("limits").text, R"({"linear.x":[0,2]})");
  EXPECT_EQ(experiment.node("wheels").written.at("fields").text, R"({"linear.x":1,"angular.z":1})");
  EXPECT_THAT(experiment.node("brain").written.at("network").text,
              testing::HasSubstr(R"("delay":"4 ms")"));
  EXPECT_EQ(good({"extra={node: sigmoid}",
                  "connections=['scan -> extra [3] -> encoder -> brain -> decoder "
                  "-> wheels']"})
                .nodes.size(),
            6U);
  EXPECT_EQ(good({"encoder={node: poisson_encoder, rate_max: 7 Hz}"}).node("encoder").kind,
            "poisson_encoder");
}

TEST_F(SettingsTest, ErrorsNameTheOptionInPlaceOfALine) {
  EXPECT_THAT(
      read_with({"encoder.rate_max=200 mV"}).faults,
      ElementsAre(Fault(
          "--set encoder.rate_max: key 'rate_max': '200 mV': 'mV' ... Hz, kHz, MHz ... [SL0202]")));
  EXPECT_THAT(read_with({"encoder.rate_mux=200 Hz"}).faults,
              ElementsAre("--set encoder.rate_mux: node 'encoder': unknown key 'rate_mux'; did you "
                          "mean 'rate_max'? [SL0103]"));
  EXPECT_THAT(
      read_with({"duration=0.5 ms"}).faults,
      ElementsAre(Fault("--set duration: key 'duration': 500 us ... 1 ms ... [SL0207] ...")));
  EXPECT_THAT(read_with({"encodr.rate_max=1 Hz"}).faults,
              ElementsAre(Fault("--set encodr.rate_max: ... 'encodr' ... 'encoder' ... [SL0301]")));
  EXPECT_THAT(read_with({"sead=1"}).faults,
              ElementsAre(Fault(
                  "--set sead: there is no node or key 'sead'; did you mean 'seed'? [SL0301]")));
  EXPECT_THAT(read_with({"encoder.rate_max.low=1 Hz"}).faults,
              ElementsAre("--set encoder.rate_max.low: there is no 'low' in the value '200 Hz'; "
                          "write the whole value, as a map or a list [SL0105]"));
  EXPECT_THAT(read_with({"decoder.weights=[[1, 0, 0], [0, 1, 0]]", "decoder.weights.2.0=1"}).faults,
              ElementsAre(Fault("--set decoder.weights.2.0: '2' is not an entry of a list of 2; "
                                "write a number from 0 to 1 [SL0203]")));
  EXPECT_THAT(read_with({"encoder=[1"}).faults,
              ElementsAre(StartsWith("--set encoder:1:1: this is not YAML: ")));
}

TEST(Setting, IsAKeyAndAValue) {
  for (const char* text : {"seed", "seed=", "=3", ""}) {
    EXPECT_THROW(parse_setting(text), ConfigurationError) << text;
  }
  const Setting setting = parse_setting("a.b=c=d");
  EXPECT_EQ(setting.key, "a.b");
  EXPECT_EQ(setting.value, "c=d");
  const Settings back = settings_from_text(to_text({setting, {"x", "\"#\n", "--x"}}));
  EXPECT_EQ(back.at(0).option, "--set a.b");
  EXPECT_EQ(back.at(1).value, "\"#\n");
}

}  // namespace
}  // namespace spikeloop::test
