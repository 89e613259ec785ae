// What the two endpoints refuse.
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "spikeloop/core/error.hpp"
#include "spikeloop/zmq/publisher.hpp"
#include "spikeloop/zmq/subscriber.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::zmq {
namespace {

using test::Fault;

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(Publisher, NeedsAnAddress) {
  EXPECT_THAT(message_of([] {
                Publisher({"tcp://*:99999", "FloatArray", 0, 0, 1});
              }),
              Fault("zmq_addr 'tcp://*:99999' ... tcp://HOST:PORT, or tcp://*:PORT to publish on "
                    "every interface ... [SL0501]"));
  EXPECT_THAT(message_of([] {
                Publisher({"5555", "FloatArray", 0, 0, 1});
              }),
              Fault("zmq_addr '5555' ... tcp://HOST:PORT, or tcp://*:PORT ... [SL0501]"));
}

TEST(Publisher, NeedsAPlaceOfItsOwn) {
  const auto problem = [](const std::string& address) {
    return message_of([&] { Publisher({address, "FloatArray", 0, 0, 1}); });
  };
  const std::string remedy =
      "write an IP address of this machine, as in tcp://127.0.0.1:5556, or tcp://*:5556 ... "
      "[SL0501]";
  EXPECT_THAT(problem("tcp://localhost:5599"),
              Fault("zmq_addr 'tcp://localhost:5599' is not an address to publish at; " + remedy));
  EXPECT_THAT(problem("tcp://[::1]:5599"), Fault("zmq_addr 'tcp://[::1]:5599' ... " + remedy));
  EXPECT_NO_THROW(Publisher({"tcp://lo:*", "FloatArray", 0, 0, 1}));
  const std::string far = "ipc:///" + std::string(107, 'x');
  EXPECT_EQ(problem(far),
            "zmq_addr '" + far + "' has a path of 108 bytes; write one of at most 107 [SL0501]");
  const test::TemporaryDirectory directory;
  const std::string file = "ipc://" + directory.write("w.json", "[[1]]");
  EXPECT_EQ(problem(file),
            "zmq_addr '" + file +
                "' is the path of something else than a socket; write another one [SL0501]");
  EXPECT_TRUE(std::filesystem::is_regular_file(directory.path() / "w.json"));
}

TEST(Publisher, SaysWhenItsPortIsTaken) {
  int port = 40000 + ::getpid() % 20000;
  std::unique_ptr<Publisher> first;
  std::string address;
  while (!first) {
    address = "tcp://127.0.0.1:" + std::to_string(++port);
    try {
      first = std::make_unique<Publisher>(PublisherSettings{address, "FloatArray", 0, 0, 1});
    } catch (const TransportError&) {
      continue;  // somebody else's
    }
  }
  EXPECT_THAT(
      message_of([&] {
        Publisher({address, "FloatArray", 0, 0, 1});
      }),
      Fault("cannot bind " + address + ": ... write another port in zmq_addr ... [SL0501]"));
}

TEST(Publisher, AFileThatIsTakenIsNotTakenOver) {
  const test::TemporaryDirectory directory;
  const std::string address = "ipc://" + (directory.path() / "socket").string();
  const PublisherSettings settings{address, "FloatArray", 0, 0, 1};
  {
    const Publisher first(settings);
    EXPECT_THAT(
        message_of([&] { Publisher second(settings); }),
        Fault("cannot bind " + address + ": ... write another path in zmq_addr ... [SL0501]"));
  }
  EXPECT_NO_THROW(Publisher{settings}) << "what the first has left is no hindrance";
}

TEST(Publisher, AGymCommandNeedsARange) {
  EXPECT_EQ(message_of([] {
              Publisher({"tcp://127.0.0.1:1", "GymCommand", 1, 1, 1});
            }),
            "a GymCommand carries its range, but min is 1 and max 1; write min below max, as in "
            "min=-1 and max=1 [SL0206]");
  EXPECT_EQ(
      message_of([] {
        Publisher({"tcp://127.0.0.1:1", "Twist", 0, 0, 1});
      }),
      "message_type 'Twist' is not known; write message_type=GymCommand or FloatArray [SL0502]");
}

TEST(Subscriber, NeedsAnAddress) {
  EXPECT_THAT(message_of([] {
                Subscriber({"localhost:5555", "FloatArray", 1});
              }),
              Fault("zmq_addr 'localhost:5555' ... tcp://HOST:PORT, or tcp://*:PORT ... [SL0501]"));
  EXPECT_EQ(message_of([] {
              Subscriber({"tcp://*:5555", "FloatArray", 1});
            }),
            "zmq_addr 'tcp://*:5555' names no host to connect to; write it, as in "
            "tcp://localhost:5555 [SL0501]");
  EXPECT_EQ(
      message_of([] {
        Subscriber({"tcp://localhost:5555", "", 1});
      }),
      "message_type '' is not known; write message_type=GymObservation or FloatArray [SL0502]");
}

}  // namespace
}  // namespace spikeloop::zmq
