// spikeloop-live: shows a run in the browser while it goes on. `spikeloop run --live` starts it.
#include <fmt/format.h>
#include <signal.h>
#include <sys/random.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <string>

#include "server.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/processes/python.hpp"

namespace {

using namespace spikeloop;

view::Server* running = nullptr;

void take_signal(int /*number*/) {
  running->stop();
}

std::string url(const view::ServerOptions& options, std::uint16_t port) {
  return fmt::format("http://{}:{}/?token={}", options.host, port, options.token);
}

std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) {
    throw TransportError("there are no random numbers for the token of the live view");
  }
  std::string token;
  for (const unsigned char byte : bytes) {
    token += fmt::format("{:02x}", byte);
  }
  return token;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Shows a run in the browser while it goes on", "spikeloop-live");
  view::ServerOptions options;
  options.page = own_directory() + "/../share/spikeloop/live";
  app.add_option("--feeds", options.feeds,
                 "Folder in which the processes of the run put their data")
      ->required();
  app.add_option("--run", options.run, "Run folder");
  app.add_flag("--recording", options.recording, "The run has ended");
  app.add_option("--name", options.name, "Name of the experiment");
  app.add_option("--host", options.host, "Address to listen at")->default_val("127.0.0.1");
  app.add_option("--port", options.port, "Port; 0: any")->default_val(8765);
  app.set_version_flag("--version", SPIKELOOP_VERSION);
  app.footer("spikeloop run --live starts it.");
  CLI11_PARSE(app, argc, argv);
  try {
    options.token = make_token();
    view::Server server(options);
    running = &server;
    signal(SIGTERM, take_signal);
    signal(SIGINT, take_signal);
    signal(SIGPIPE, SIG_IGN);
    fmt::print("live: {}\n", url(options, server.port()));
    std::fflush(stdout);
    server.run();
    return 0;
  } catch (const Error& error) {
    fmt::print(stderr, "spikeloop-live: {}\n", error.what());
    return error.exit_code();
  }
}
