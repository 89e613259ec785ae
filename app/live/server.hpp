// Serves the page, files of the run folder and the data of a run on one port.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace spikeloop::view {

struct ServerOptions {
  std::string feeds;     ///< folder of the feeds
  std::string run;       ///< run folder; empty: none
  std::string page;      ///< folder of the page
  std::string name;      ///< of the experiment
  bool recording{};      ///< of a run that has ended
  std::string host;      ///< address to listen at, "127.0.0.1"
  std::uint16_t port{};  ///< 0: any
  std::string token;     ///< that control needs; empty: none
};

class Server {
 public:
  /// @throws TransportError: the port is in use, the address is not ours.
  explicit Server(const ServerOptions& options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;
  /// Serves until stop() is called, and a moment longer, for what waits.
  void run();
  /// Safe in a signal handler.
  void stop();

  struct Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::view
