#include "app/live/outbox.hpp"

#include <gtest/gtest.h>

namespace spikeloop::view {
namespace {

Outgoing frame(Frame::Kind kind) {
  return {std::make_shared<Frame>(kind, std::string(1 << 20, 'x'))};
}

TEST(Outbox, DropsDataAndKeepsAnswersWhenMoreThan16MBWait) {
  Outbox outbox;
  outbox.push(frame(Frame::Kind::text));
  for (int i = 0; i < 15; ++i) {
    outbox.push(frame(Frame::Kind::data));
  }
  EXPECT_EQ(outbox.dropped(), 0);
  outbox.push(frame(Frame::Kind::data));
  EXPECT_EQ(outbox.dropped(), 16);
  EXPECT_EQ(outbox.bytes(), 1 << 20);
  EXPECT_FALSE(outbox.is_closed());
  EXPECT_EQ(outbox.pop()->frame->kind, Frame::Kind::text);
  EXPECT_TRUE(outbox.is_empty());
  EXPECT_FALSE(outbox.pop());
}

TEST(Outbox, ClosesAClientWhoseAnswersWait) {
  Outbox outbox;
  for (int i = 0; i < 17; ++i) {
    EXPECT_FALSE(outbox.is_closed());
    outbox.push(frame(Frame::Kind::text));
  }
  EXPECT_TRUE(outbox.is_closed());
}

}  // namespace
}  // namespace spikeloop::view
