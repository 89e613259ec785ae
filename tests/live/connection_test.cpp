#include "app/live/connection.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <array>
#include <memory>

namespace spikeloop::view {
namespace {

TEST(Connection, EndsIfItsOutboxIsClosedWhileNoFrameWaits) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()), 0);
  const Descriptor client{ends[1]};
  Connection connection({Descriptor{ends[0]}}, 0);
  const auto shared = std::make_shared<Client>(false);
  connection.begin_response(shared, 0);
  EXPECT_FALSE(connection.wants_to_write());
  shared->outbox.close();  // the file has shrunk
  EXPECT_TRUE(connection.wants_to_write());
  EXPECT_FALSE(connection.write(0));
}

}  // namespace
}  // namespace spikeloop::view
