// The window, on a display in memory: Xvfb shows its screen in a file.
#include "spikeloop/pictures/window.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <chrono>
#include <fstream>
#include <functional>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <thread>

#include "spikeloop/core/error.hpp"
#include "tests/support/child.hpp"
#include "worlds.hpp"

namespace spikeloop::pictures {
namespace {

using namespace std::chrono_literals;

bool within(std::chrono::seconds limit, const std::function<bool()>& done) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(10ms);
  }
  return true;
}

/// While it lives, DISPLAY is this one.
class ScreenInMemory {
 public:
  ScreenInMemory()
      : server_({.arguments = {"Xvfb", "-displayfd", "1", "-screen", "0", "1024x768x24", "-fbdir",
                               directory_.path().string(), "-nolisten", "tcp", "-noreset"},
                 .timeout = 120s}) {
    EXPECT_TRUE(within(30s, [this] { return !number().empty(); })) << server_.output();
    ::setenv("DISPLAY", (":" + number()).c_str(), 1);
  }
  ~ScreenInMemory() { ::unsetenv("DISPLAY"); }

  /// Of the display: a line of its own, beside words about numbers that others have.
  std::string number() {
    const std::string printed = server_.output();
    std::smatch line;
    return std::regex_search(printed, line, std::regex("(?:^|\n)([0-9]+)\n")) ? line[1].str() : "";
  }

  /// The bytes of the screen that differ from each other: few while it is black.
  std::size_t colours() const {
    const std::string file = directory_.read("Xvfb_screen0");
    std::set<std::string> seen;
    for (std::size_t i = 4096; i + 4 <= file.size(); i += 64) seen.insert(file.substr(i, 3));
    return seen.size();
  }

 private:
  test::TemporaryDirectory directory_;
  test::Child server_;
};

TEST(Window, ShowsTheWorldWhileTheVehicleDrives) {
  const ScreenInMemory screen;
  EXPECT_LT(screen.colours(), 5U);
  vehicle::Vehicle vehicle({"arena", 3});
  vehicle::Vehicle unseen({"arena", 3});
  Window window(vehicle, "a test");
  EXPECT_TRUE(window.open());
  vehicle.command(0.5, 0.2);
  unseen.command(0.5, 0.2);
  EXPECT_TRUE(within(60s, [&] {
    vehicle.step(10 * kMs);
    unseen.step(10 * kMs);
    window.show(vehicle);
    return window.pictures() >= 5;
  }));
  EXPECT_TRUE(within(30s, [&] { return screen.colours() > 20; }));
  EXPECT_EQ(vehicle.pose().x_m, unseen.pose().x_m);
  EXPECT_EQ(vehicle.pose().theta_rad, unseen.pose().theta_rad);
}

TEST(Window, NeedsADisplay) {
  const vehicle::Vehicle vehicle({"arena", 3});
  const auto refusal = [&] {
    try {
      Window window(vehicle, "a test");
    } catch (const TransportError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  ::unsetenv("DISPLAY");
  ::unsetenv("WAYLAND_DISPLAY");
  EXPECT_EQ(refusal(),
            "cannot open a window: there is no display (DISPLAY is not set); leave --view out, or "
            "write  --render FILE.mp4  for a film");
  ::setenv("DISPLAY", ":987", 1);
  EXPECT_THAT(refusal(),
              testing::MatchesRegex("cannot open a window on display ':987': .*:987; leave --view "
                                    "out, or write  --render FILE.mp4  for a film"));
  ::unsetenv("DISPLAY");
}

}  // namespace
}  // namespace spikeloop::pictures
