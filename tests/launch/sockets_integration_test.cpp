// Sockets on which a job on one machine listens.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "spikeloop/processes/descriptor.hpp"
#include "tests/launch/launcher.hpp"

namespace spikeloop::test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Address and port of a TCP socket in the hexadecimal form of /proc/net/tcp.
struct Listener {
  std::string address;
  std::uint16_t port = 0;

  bool is_ipv6() const { return address.size() > 8; }
  bool is_loopback() const {
    return address == "0100007F" || address == "00000000000000000000000001000000";
  }
};

/// All listening TCP sockets of this network namespace by their inode.
std::map<std::string, Listener> all_listeners() {
  std::map<std::string, Listener> found;
  for (const char* const path : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      std::string number, local, remote, state, ignored, inode;
      words >> number >> local >> remote >> state >> ignored >> ignored >> ignored >> ignored >>
          ignored >> inode;
      const auto colon = local.find(':');
      if (state == "0A" && colon != std::string::npos) {
        const auto port = std::stoul(local.substr(colon + 1), nullptr, 16);
        found["socket:[" + inode + "]"] = {local.substr(0, colon),
                                           static_cast<std::uint16_t>(port)};
      }
    }
  }
  return found;
}

std::vector<Listener> listeners_of(const Child& child) {
  namespace fs = std::filesystem;
  std::set<std::string> sockets;
  for (const pid_t process : child.family()) {
    std::error_code error;
    for (const auto& entry :
         fs::directory_iterator("/proc/" + std::to_string(process) + "/fd", error)) {
      sockets.insert(fs::read_symlink(entry.path(), error).string());
    }
  }
  std::vector<Listener> found;
  for (const auto& [inode, listener] : all_listeners()) {
    if (sockets.contains(inode)) {
      found.push_back(listener);
    }
  }
  return found;
}

Descriptor connect_to(const Listener& listener) {
  sockaddr_in6 six{};
  six.sin6_family = AF_INET6;
  six.sin6_port = htons(listener.port);
  six.sin6_addr = in6addr_loopback;
  sockaddr_in four{};
  four.sin_family = AF_INET;
  four.sin_port = htons(listener.port);
  four.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  Descriptor connection{
      ::socket(listener.is_ipv6() ? AF_INET6 : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  const int result =
      listener.is_ipv6()
          ? ::connect(connection.get(), reinterpret_cast<sockaddr*>(&six), sizeof six)
          : ::connect(connection.get(), reinterpret_cast<sockaddr*>(&four), sizeof four);
  EXPECT_EQ(result, 0) << std::strerror(errno);
  return connection;
}

TEST(Run, ListensOnLoopbackOnlyAndEndsDespiteSilentConnections) {
  const TwoPrograms job("stoptime=4", "stoptime=4");
  Child child(job.command());
  ASSERT_TRUE(child.wait_for("b: first tick", 30s)) << child.output();
  const std::vector<Listener> listeners = listeners_of(child);
  EXPECT_THAT(listeners, Not(IsEmpty())) << "mpirun listens for the programs of its job";
  std::vector<Descriptor> silent;
  for (const Listener& listener : listeners) {
    EXPECT_TRUE(listener.is_loopback()) << listener.address << ", port " << listener.port;
    for (int i = 0; i < 4; ++i) {
      silent.push_back(connect_to(listener));
    }
  }
  const Outcome outcome = child.wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
  EXPECT_THAT(outcome.text(), Not(HasSubstr("mpirun has not ended")));
}

}  // namespace
}  // namespace spikeloop::test
