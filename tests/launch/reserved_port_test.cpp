// A port that no other program gets, under the real kernel.
#include "spikeloop/processes/reserved_port.hpp"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>
#include <optional>

#include "tests/support/error_of.hpp"
#include "tests/support/no_descriptors.hpp"

namespace spikeloop {
namespace {

class Listener {
 public:
  explicit Listener(bool shares) {
    const int value = shares;
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_REUSEADDR, &value, sizeof value);
  }
  /// The error number of bind() and listen(), 0 without an error.
  int listen(int port) const {
    const sockaddr_in address = place(port);
    const bool good =
        ::bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
        ::listen(socket_.get(), 1) == 0;
    return good ? 0 : errno;
  }
  static sockaddr_in place(int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return address;
  }

 private:
  Descriptor socket_{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
};

int error_of_connecting(int port) {
  const Descriptor client{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  const sockaddr_in address = Listener::place(port);
  const auto* const generic = reinterpret_cast<const sockaddr*>(&address);
  return ::connect(client.get(), generic, sizeof address) == 0 ? 0 : errno;
}

TEST(ReservedPort, IsForWhoSharesIt) {
  const ReservedPort port;
  EXPECT_EQ(error_of_connecting(port.number()), ECONNREFUSED);
  EXPECT_EQ(Listener(false).listen(port.number()), EADDRINUSE);
  for (int start = 0; start < 2; ++start) {  // also a program that is started again
    const Listener master(true);
    EXPECT_EQ(master.listen(port.number()), 0);
    EXPECT_EQ(error_of_connecting(port.number()), 0);
  }
}

TEST(ReservedPort, IsFreeAgainAfterwards) {
  std::optional<ReservedPort> port(std::in_place);
  const int number = port->number();
  port.reset();
  EXPECT_EQ(Listener(false).listen(number), 0);
}

TEST(ReservedPort, SaysWhyThereIsNone) {
  const std::string message = test::error_of<TransportError>([] {
    const test::NoDescriptors none;
    const ReservedPort port;
  });
  EXPECT_EQ(message, "no TCP port of this machine is free: Too many open files [SL0701]");
}

}  // namespace
}  // namespace spikeloop
