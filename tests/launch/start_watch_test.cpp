// Who is missed before MPI knows the programs.
#include "start_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace spikeloop::launch {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

class Starting : public testing::Test {
 protected:
  void look(const std::vector<std::string>& living, milliseconds later = milliseconds(100)) {
    std::map<std::string, bool> found;
    for (const std::string& label : living) {
      found[label] = false;
    }
    now_ += later;
    watch_.take(found, now_);
  }

  StartWatch::Clock::time_point now_ = StartWatch::Clock::now();
  StartWatch watch_{{"a", "b", "c"}, now_};
};

TEST_F(Starting, NobodyIsMissedWhenAllLive) {
  EXPECT_THAT(watch_.missed(), IsEmpty()) << "nobody has been seen yet";
  EXPECT_THAT(watch_.living(), IsEmpty());
  look({"a"});
  EXPECT_THAT(watch_.missed(), ElementsAre("b", "c"));
  look({"a", "b", "c"});
  look({"a", "b", "c"}, seconds(60));
  EXPECT_THAT(watch_.missed(), IsEmpty());
  EXPECT_FALSE(watch_.one_has_gone(now_ + seconds(4)));
}

TEST_F(Starting, TheFirstToGoIsTheOne) {
  look({"a", "b", "c"});
  look({"a", "c"});
  look({});  // the others have been ended since
  EXPECT_THAT(watch_.missed(), ElementsAre("b"));
  EXPECT_THAT(watch_.living(), ElementsAre(Pair("a", false), Pair("c", false)));
  EXPECT_FALSE(watch_.one_has_gone(now_));
  EXPECT_TRUE(watch_.one_has_gone(now_ + seconds(5)));
}

TEST_F(Starting, WhoEndsAtOnceIsNeverSeen) {
  look({"a"});
  look({"a", "b"});
  look({"a"});
  EXPECT_THAT(watch_.missed(), ElementsAre("c"));
}

TEST_F(Starting, ATwinTakesThePlaceOfOneThatHasGone) {
  look({"a", "b"});
  look({"b"});
  look({"b", "c"});
  EXPECT_THAT(watch_.missed(), ElementsAre("a")) << "not who was late";
}

TEST_F(Starting, LooksOftenAtFirst) {
  EXPECT_TRUE(watch_.is_due(now_));
  look({"a"}, milliseconds(0));
  EXPECT_FALSE(watch_.is_due(now_ + milliseconds(99)));
  EXPECT_TRUE(watch_.is_due(now_ + milliseconds(100)));
  look({"a"}, seconds(6));
  EXPECT_FALSE(watch_.is_due(now_ + milliseconds(900)));
}

}  // namespace
}  // namespace spikeloop::launch
