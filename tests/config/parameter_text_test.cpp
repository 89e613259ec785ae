#include "spikeloop/config/parameter_text.hpp"

#include <gtest/gtest.h>

namespace spikeloop {
namespace {

TEST(ParameterText, AlignsTheColumns) {
  std::vector<ParameterDescription> parameters(6);
  parameters[0] = {"rate_max", ParameterType::number, "Hz", "100"};
  parameters[0].minimum = 0;
  parameters[0].text = "rate at input 1";
  parameters[1] = {"weights", ParameterType::weights};
  parameters[1].text = "one row an output";
  parameters[2] = {"dialect", ParameterType::choice, "", "rma"};
  parameters[2].choices = {"rma", "ma"};
  parameters[3] = {"gain", ParameterType::number, "1", "-0.5"};
  parameters[3].minimum = -1;
  parameters[3].maximum = 1;
  parameters[4] = {"n", ParameterType::integer, "", "1"};
  parameters[4].maximum = 7;
  parameters[5] = {"verbose", ParameterType::boolean, "", ""};
  EXPECT_EQ(parameter_text(parameters),
            "  rate_max  Hz          100       >= 0     rate at input 1\n"
            "  weights   weights     required           one row an output\n"
            "  dialect   choice      rma       rma|ma\n"
            "  gain      number      -0.5      -1 .. 1\n"
            "  n         integer     1         <= 7\n"
            "  verbose   true|false  none\n");
}

TEST(ParameterText, LeavesOutEmptyColumns) {
  std::vector<ParameterDescription> parameters(1);
  parameters[0].name = "topic";
  parameters[0].type = ParameterType::text;
  EXPECT_EQ(parameter_text(parameters), "  topic  text  required\n");
  EXPECT_EQ(parameter_text({}), "");
}

}  // namespace
}  // namespace spikeloop
