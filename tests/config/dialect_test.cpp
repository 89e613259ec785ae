#include "spikeloop/config/dialect.hpp"

#include <gtest/gtest.h>

namespace spikeloop {
namespace {

TEST(DialectOfPrograms, IsThatOfTheFamilyThatAloneHasOneOfThem) {
  EXPECT_EQ(dialect_of_job({}), Dialect::rma);
  EXPECT_EQ(dialect_of_job({"rate_encoder", "brain.py"}), Dialect::rma);
  EXPECT_EQ(dialect_of_job({"ros_sensor_adapter", "poisson_encoder"}), Dialect::rma);
  EXPECT_EQ(dialect_of_job({"rate_encoder", "linear_decoder"}), Dialect::ma);
  for (const char* name :
       {"ros_cont_adapter", "cont_ros_adapter", "zmq_cont_adapter", "cont_zmq_adapter",
        "cont_cont_adapter", "threshold_adapter", "sigmoid_adapter", "argmax_adapter",
        "discretize_adapter", "linear_decoder"}) {
    EXPECT_EQ(dialect_of_job({name}), Dialect::ma) << name;
  }
}

TEST(DialectOfPrograms, CannotBeChosenWhenBothFamiliesTakePart) {
  try {
    dialect_of_job({"linear_decoder", "rate_encoder", "connect_adapter"});
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_STREQ(error.what(),
                 "dialect=auto cannot choose: connect_adapter is a program of dialect rma, and "
                 "linear_decoder one of dialect ma; write dialect=rma or dialect=ma [SL0205]");
  }
}

TEST(DialectOfPrograms, OnlyAutoLooksAtThem) {
  const std::vector<std::string> programs = {"zmq_cont_adapter"};
  EXPECT_EQ(dialect_named("", programs), Dialect::rma);
  EXPECT_EQ(dialect_named("rma", programs), Dialect::rma);
  EXPECT_EQ(dialect_named("ma", {"connect_adapter", "linear_decoder"}), Dialect::ma);
  EXPECT_EQ(dialect_named("auto", programs), Dialect::ma);
}

TEST(ProgramsOfAFile, AreTheLastPartsOfTheirPaths) {
  const MusicFile file = parse_music(
      "[a]\nnp=1\nbinary=../../build/nef_encoder\n[b]\nnp=1\nbinary=b.py\na.out->b.in[1]\n",
      "loop.music");
  EXPECT_EQ(programs_of(file), (std::vector<std::string>{"nef_encoder", "b.py"}));
}

}  // namespace
}  // namespace spikeloop
