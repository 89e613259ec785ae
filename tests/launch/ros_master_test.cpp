// What the launcher asks a ROS master, against an HTTP server of the test's own. The real roscore
// is in the integration tests.
#include "spikeloop/launch/ros_master.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>
#include <thread>

#include "spikeloop/core/error.hpp"
#include "tests/support/roscore.hpp"

namespace spikeloop::launch {
namespace {

TEST(ParseMasterUri, ReadsHostAndPort) {
  EXPECT_EQ(parse_master_uri("http://localhost:11311").host, "localhost");
  EXPECT_EQ(parse_master_uri("http://10.0.0.7:80/").port, 80);
}

TEST(ParseMasterUri, SaysWhatToWrite) {
  for (const char* uri : {"", "localhost:11311", "http://localhost", "http://:1",
                          "http://a:", "http://a:0", "http://a:99999", "http://a:1x"}) {
    try {
      parse_master_uri(uri);
      ADD_FAILURE() << uri;
    } catch (const ConfigurationError& error) {
      EXPECT_EQ(error.what(),
                std::string("ROS_MASTER_URI is '") + uri +
                    "', which is not a master's address; write http://HOST:PORT, such "
                    "as http://localhost:11311 [SL0701]");
    }
  }
}

/// Answers one request with the text, in two pieces, or closes the connection.
class OneAnswer {
 public:
  explicit OneAnswer(std::string text) : text_(std::move(text)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    bind(socket_, reinterpret_cast<sockaddr*>(&address), size);
    listen(socket_, 1);
    getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { serve(); });
  }
  ~OneAnswer() {
    thread_.join();
    close(socket_);
  }
  OneAnswer(const OneAnswer&) = delete;
  OneAnswer& operator=(const OneAnswer&) = delete;
  RosMaster master() const { return RosMaster("http://127.0.0.1:" + std::to_string(port_)); }

 private:
  void serve() const {
    const int client = accept(socket_, nullptr, nullptr);
    std::string request;
    char buffer[4096];
    while (request.find("</methodCall>") == std::string::npos) {
      const auto size = recv(client, buffer, sizeof buffer, 0);
      if (size <= 0) {
        break;
      }
      request.append(buffer, static_cast<std::size_t>(size));
    }
    const std::size_t half = text_.size() / 2;
    send(client, text_.data(), half, MSG_NOSIGNAL);
    send(client, text_.data() + half, text_.size() - half, MSG_NOSIGNAL);
    close(client);
  }

  std::string text_;
  int socket_ = -1;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

std::string response(const std::string& value) {
  return "HTTP/1.0 200 OK\r\nContent-Type: text/xml\r\n\r\n<?xml version='1.0'?>\n"
         "<methodResponse>\n<params>" +
         value + "</params>\n</methodResponse>\n";
}

TEST(RosMaster, AnswersWhenItAnswersXmlRpc) {
  EXPECT_TRUE(OneAnswer(response("<int>1</int>")).master().answers());
  EXPECT_FALSE(OneAnswer("HTTP/1.0 404 Not Found\r\n\r\n<html></html>").master().answers());
  EXPECT_FALSE(OneAnswer("SSH-2.0-OpenSSH_9.2\r\n").master().answers());
  EXPECT_FALSE(OneAnswer("").master().answers());
  EXPECT_FALSE(OneAnswer(response("<fault>x</fault>")).master().answers());
}

TEST(RosMaster, IsAskedAgainWhenAConnectionIsLost) {
  const test::SilentHost host;
  std::thread master([&host] {
    const int lost = host.accept();
    const int heard = host.accept();
    const std::string answer = response("<int>1</int>");
    EXPECT_EQ(send(heard, answer.data(), answer.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(answer.size()));
    close(heard);
    close(lost);
  });
  EXPECT_TRUE(RosMaster(host.uri()).answers());
  host.stop();
  master.join();
}

TEST(RosMaster, NobodyListens) {
  const ReservedPort port;
  const RosMaster nobody("http://127.0.0.1:" + port.text());
  EXPECT_FALSE(nobody.answers());
  EXPECT_FALSE(nobody.publishes("/scan"));
}

TEST(RosMaster, SaysThatItsHostHasNoAddress) {
  EXPECT_EQ(RosMaster("http://127.0.0.1:1").unresolved(), "");
  const RosMaster nowhere("http://no-such-host.invalid:11311");
  EXPECT_FALSE(nowhere.answers());
  EXPECT_THAT(nowhere.unresolved(),
              testing::MatchesRegex("the host name 'no-such-host.invalid' cannot be resolved "
                                    "\\([^)]+\\); add the line 'IP-ADDRESS no-such-host.invalid' "
                                    "to /etc/hosts"));
}

TEST(RosMaster, FindsATopicByItsWholeName) {
  const std::string topics = response(
      "<value><string>/scan_raw</string></value>\n<value>\n<string>/scan</string></value>");
  EXPECT_TRUE(OneAnswer(topics).master().publishes("/scan"));
  EXPECT_FALSE(OneAnswer(topics).master().publishes("/sca"));
  EXPECT_FALSE(OneAnswer(topics).master().publishes("scan"));
}

TEST(MasterUri, ComesFromTheEnvironment) {
  const char* before = getenv("ROS_MASTER_URI");
  const std::string saved = before == nullptr ? "" : before;
  setenv("ROS_MASTER_URI", "http://robot:1234", 1);
  EXPECT_EQ(master_uri(), "http://robot:1234");
  unsetenv("ROS_MASTER_URI");
  EXPECT_EQ(master_uri(), "http://localhost:11311");
  if (before != nullptr) {
    setenv("ROS_MASTER_URI", saved.c_str(), 1);
  }
}

}  // namespace
}  // namespace spikeloop::launch
