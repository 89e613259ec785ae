#include "tests/support/fault.hpp"

#include <gtest/gtest.h>

namespace spikeloop::test {
namespace {

using testing::Not;

TEST(Fault, IsAboutPlaceValuesAndCode) {
  const std::string text = "f:2:6: 'tau': -10 ms is below 0.5 ms; write 0.5 ms [SL0203]";
  EXPECT_THAT(text, Fault(text));
  EXPECT_THAT(text, Fault("f:2:6: 'tau': ... -10 ... 0.5 ms ... 0.5 ms ... [SL0203]"));
  EXPECT_THAT("first 'tau'\n" + text + "\nlast line", Fault("... 'tau' ... [SL0203] ..."));
  EXPECT_THAT("first 'tau'\n" + text + "\nlast line", Not(Fault("... first ... [SL0203] ...")));
  EXPECT_THAT("5 is more than 15", Not(Fault("... 5")));
  for (const std::string wrong :
       {"2:6: ...", "... [SL0203", "f:2:6: 'tau'", "... 10 ms ...", "... 0 ... [SL0203]",
        "... 5 ms ...", "... -1 ...", "... 0.5 ms ... -10 ...", "... -10 ... -10 ...",
        "f:2:6: ... f:2:6: ...", "... 'tau' ... 7 ... [SL0203]", "f:2:6: 'tau': -1 ...",
        "... 'tau' ... f:2:6"}) {
    EXPECT_THAT(text, Not(Fault(wrong)));
  }
  testing::StringMatchResultListener listener;
  testing::ExplainMatchResult(Fault("... 7 ... [SL0203]"), text, &listener);
  EXPECT_EQ(listener.str(), "without: 7");
}

}  // namespace
}  // namespace spikeloop::test
