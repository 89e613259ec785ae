#include "spikeloop/core/code.hpp"

#include <gtest/gtest.h>

namespace spikeloop {
namespace {

TEST(Code, StandsAtTheEnd) {
  EXPECT_EQ(code_text(Code::unknown_key), "SL0103");
  EXPECT_EQ(with_code(Code::unknown_key, "unknown key '{}'", "tua"), "unknown key 'tua' [SL0103]");
  EXPECT_EQ(with_code(Code::unknown_key, "{} is text"), "{} is text [SL0103]");
}

TEST(Code, OfTheOuterErrorHolds) {
  EXPECT_EQ(with_code(Code::missing_file, "{}; write a path", "no file [SL0109]"),
            "no file; write a path [SL0108]");
  EXPECT_EQ(with_code(Code::missing_file, "a [SL0109] b [SL0103]"), "a b [SL0108]");
  EXPECT_EQ(with_code(Code::missing_file, "a [SL010] [SL01x3] [SL"),
            "a [SL010] [SL01x3] [SL [SL0108]");
}

TEST(Code, MoreTextStandsBeforeIt) {
  EXPECT_EQ(lengthened("unknown key 'tua' [SL0103]", "; it is ignored"),
            "unknown key 'tua'; it is ignored [SL0103]");
  EXPECT_EQ(lengthened("it failed", "; see the log"), "it failed; see the log");
  EXPECT_EQ(lengthened("", "x"), "x");
}

}  // namespace
}  // namespace spikeloop
