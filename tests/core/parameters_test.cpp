#include "spikeloop/core/parameters.hpp"

#include "spikeloop/core/unit_demand.hpp"
#include "support.hpp"

namespace spikeloop {
namespace {

using test::Fault;
using test::message_of;

std::string quantity_error(const std::string& text, const std::string& unit) {
  return message_of<ConfigurationError>([&] { parse_quantity(text, unit); });
}

TEST(Quantity, ConvertsUnits) {
  EXPECT_EQ(parse_quantity("30 ms", "s"), 0.03);
  EXPECT_EQ(parse_quantity("30ms", "s"), 0.03);
  EXPECT_EQ(parse_quantity("0.03", "s"), 0.03);
  EXPECT_EQ(parse_quantity("+1e-3", "s"), 0.001);
  EXPECT_EQ(parse_quantity("2 min", "s"), 120.0);
  EXPECT_EQ(parse_quantity("1.5 kHz", "Hz"), 1500.0);
  EXPECT_EQ(parse_quantity("-55 mV", "mV"), -55.0);
  EXPECT_EQ(parse_quantity("1 V", "mV"), 1000.0);
  EXPECT_EQ(parse_quantity("250 pF", "pF"), 250.0);
  EXPECT_DOUBLE_EQ(parse_quantity("180 deg", "rad"), 3.14159265358979323846);
  EXPECT_EQ(parse_quantity(" 7 ", "1"), 7.0);
  EXPECT_EQ(parse_quantity("7", ""), 7.0);
}

TEST(Quantity, MicroHasThreeLetters) {
  for (const std::string micro : {"u", "\u00b5", "\u03bc"}) {
    EXPECT_EQ(parse_quantity("1 " + micro + "s", "s"), 1e-6);
    EXPECT_EQ(parse_quantity("20" + micro + "s", "ms"), 0.02);
    EXPECT_EQ(parse_quantity("3 " + micro + "s", "us"), 3);
    EXPECT_EQ(parse_quantity("3 us", micro + "s"), 3);
    EXPECT_EQ(parse_quantity("1500 " + micro + "V", "mV"), 1.5);
    EXPECT_EQ(parse_quantity("1 " + micro + "A", "pA"), 1e6);
    EXPECT_DOUBLE_EQ(parse_quantity("1 " + micro + "F", "nF"), 1000);
    EXPECT_THAT(quantity_error("1 " + micro, "s"), Fault("... ns, us, ms, s, min, h ... [SL0202]"));
    EXPECT_THAT(quantity_error("1 m" + micro + "s", "s"), Fault("... [SL0202]"));
  }
}

TEST(Quantity, SaysWhatIsWrong) {
  EXPECT_THAT(quantity_error("", "s"), Fault("'' ... 0.5 s ... [SL0201]"));
  EXPECT_THAT(quantity_error("fast", "Hz"), Fault("'fast' ... 0.5 Hz ... [SL0201]"));
  EXPECT_THAT(quantity_error("fast", "1"), Fault("'fast' ... 0.5 ... [SL0201]"));
  EXPECT_THAT(quantity_error("inf", "s"), Fault("'inf' ... 0.5 s ... [SL0201]"));
  EXPECT_THAT(quantity_error("nan", "s"), Fault("'nan' ... 0.5 s ... [SL0201]"));
  EXPECT_THAT(quantity_error("1e999", "s"), Fault("'1e999' ... 0.5 s ... [SL0201]"));
  EXPECT_THAT(quantity_error("3 Hz", "s"),
              Fault("'3 Hz': 'Hz' ... ns, us, ms, s, min, h ... [SL0202]"));
  EXPECT_THAT(quantity_error("3 parsec", "m"),
              Fault("'3 parsec': 'parsec' ... mm, cm, m, km ... [SL0202]"));
  EXPECT_EQ(quantity_error("3 s", "1"),
            "'3 s': this number has no unit, 's' cannot stand behind it; write 3 [SL0202]");
}

std::string unit_error(const std::string& unit, const std::optional<std::string>& usual,
                       const std::string& written) {
  return message_of<ConfigurationError>([&] {
    demand_unit("", {.name = "tau", .unit = unit, .default_value = usual}, {written, {}});
  });
}

TEST(UnitDemand, ShowsTheUnitThatIsNearerToTheDefault) {
  const std::string begin = "key 'tau': 30 has no unit; write for example  ";
  EXPECT_EQ(unit_error("s", "0.03", "30"), begin + "tau: 30 ms [SL0202]");
  EXPECT_EQ(unit_error("s", "500 ms", "30"), begin + "tau: 30 ms [SL0202]");
  EXPECT_EQ(unit_error("s", "10", "30"), begin + "tau: 30 s [SL0202]");
  EXPECT_EQ(unit_error("s", "0.03", "0.02"),
            "key 'tau': 0.02 has no unit; write for example  tau: 0.02 s [SL0202]");
  for (const auto& nothing : {std::optional<std::string>(), std::optional<std::string>(""),
                              std::optional<std::string>("0")}) {
    EXPECT_EQ(unit_error("s", nothing, "30"), begin + "tau: 30 ms  or  tau: 30 s [SL0202]");
  }
  EXPECT_EQ(unit_error("Hz", "0.03", "30"), begin + "tau: 30 Hz [SL0202]");
}

std::vector<ParameterDescription> declared() {
  return {{"rate_max", ParameterType::number, "Hz", "100", 0, 1e6, {}, "highest rate"},
          {"tau", ParameterType::number, "s", "0.03", 1e-9, 1e9, {}, "time constant"},
          {"count", ParameterType::integer, "", "3", 1, 5, {}, "how many"},
          {"strict", ParameterType::boolean, "", "false", 0, 0, {}, "errors instead of warnings"},
          {"policy", ParameterType::choice, "", "clip", 0, 0, {"clip", "pass", "error"}, "policy"},
          {"label", ParameterType::text, "", "x", 0, 0, {}, "a text"},
          {"weights", ParameterType::weights, "", "uniform", 0, 0, {}, "the weights"},
          {"topic", ParameterType::text, "", std::nullopt, 0, 0, {}, "ROS topic"}};
}

WeightTable one_weight(const WrittenValue& written) {
  return written.text == "uniform" ? WeightTable::uniform() : WeightTable::uniform(0.5);
}

TEST(Resolve, TakesWhatIsWrittenAndDefaultsForTheRest) {
  const WrittenValues written = {{"rate_max", {"0.2 kHz", {"f", 2, 1}}},
                                 {"count", {"5", {}}},
                                 {"strict", {"true", {}}},
                                 {"policy", {"pass", {}}},
                                 {"weights", {"file.json", {}}},
                                 {"topic", {"/scan", {}}},
                                 {"sensor_update_rate", {"30", {}}}};
  const Parameters parameters = resolve(declared(), written, one_weight, {"sensor_update_rate"});
  EXPECT_EQ(parameters.number("rate_max"), 200.0);
  EXPECT_EQ(parameters.number("tau"), 0.03);
  EXPECT_EQ(parameters.integer("count"), 5);
  EXPECT_EQ(parameters.number("count"), 5.0);
  EXPECT_TRUE(parameters.boolean("strict"));
  EXPECT_EQ(parameters.text("policy"), "pass");
  EXPECT_EQ(parameters.text("label"), "x");
  EXPECT_EQ(parameters.weights("weights").values, (std::vector<double>{0.5}));
  EXPECT_TRUE(parameters.given("rate_max"));
  EXPECT_FALSE(parameters.given("tau"));
  EXPECT_EQ(parameters.where("rate_max").line, 2);
  EXPECT_EQ(parameters.where("tau").line, 0);
}

std::string resolve_error(const std::string& key, const std::string& text) {
  WrittenValues written = {{"topic", {"/scan", {}}}};
  written[key] = {text, {"loop.music", 4, 2}};
  return message_of<ConfigurationError>([&] { resolve(declared(), written, one_weight); });
}

TEST(Resolve, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(resolve_error("rate_mx", "1"),
            "loop.music:4:2: unknown key 'rate_mx'; did you mean 'rate_max'? [SL0103]");
  EXPECT_EQ(
      resolve_error("zzz", "1"),
      "loop.music:4:2: unknown key 'zzz'; known: rate_max, tau, count, strict, policy, label, "
      "weights, topic [SL0103]");
  EXPECT_THAT(resolve_error("rate_max", "-1"),
              Fault("loop.music:4:2: key 'rate_max': -1 ... 0 to 1000000 Hz ... [SL0203]"));
  EXPECT_THAT(resolve_error("rate_max", "x"),
              Fault("loop.music:4:2: key 'rate_max': 'x' ... 0.5 Hz ... [SL0201]"));
  EXPECT_THAT(resolve_error("count", "9"),
              Fault("loop.music:4:2: key 'count': 9 ... 1 to 5 ... [SL0203]"));
  EXPECT_THAT(resolve_error("count", "1.5"),
              Fault("loop.music:4:2: key 'count': '1.5' ... 1 to 5 ... [SL0204]"));
  EXPECT_THAT(resolve_error("strict", "yes"),
              Fault("loop.music:4:2: key 'strict': 'yes' ... true or false ... [SL0205]"));
  EXPECT_THAT(
      resolve_error("policy", "clp"),
      Fault("loop.music:4:2: key 'policy': 'clp' ... 'clip' ... clip, pass, error ... [SL0205]"));
  EXPECT_THAT(
      resolve_error("policy", "something"),
      Fault("loop.music:4:2: key 'policy': 'something' ... clip, pass, error ... [SL0205]"));
}

TEST(Resolve, NamesAMissingKey) {
  EXPECT_EQ(message_of<ConfigurationError>([] { resolve(declared(), {}, one_weight); }),
            "key 'topic' is missing (ROS topic); write  topic=... [SL0104]");
}

TEST(Resolve, OneSidedBounds) {
  std::vector<ParameterDescription> low = {{"a", ParameterType::number, "s", "1"}};
  low[0].minimum = 0;
  EXPECT_THAT(message_of<ConfigurationError>([&] {
                resolve(low, {{"a", {"-1", {}}}}, {});
              }),
              Fault("key 'a': -1 ... 0 s ... [SL0203]"));
  std::vector<ParameterDescription> high = {{"a", ParameterType::number, "", "1"}};
  high[0].maximum = 2;
  EXPECT_THAT(message_of<ConfigurationError>([&] {
                resolve(high, {{"a", {"3", {}}}}, {});
              }),
              Fault("key 'a': 3 is out of bounds; write a value of at most 2 [SL0203]"));
}

TEST(Parameters, AskingForWhatWasNotDeclaredIsABug) {
  Parameters parameters;
  parameters.set("tau", 1.0);
  EXPECT_EQ(message_of<std::logic_error>([&] { parameters.number("tu"); }),
            "parameter 'tu' was not declared");
  EXPECT_EQ(message_of<std::logic_error>([&] { parameters.text("tau"); }),
            "parameter 'tau' was asked for with the wrong type");
}

}  // namespace
}  // namespace spikeloop
