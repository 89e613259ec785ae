// Serves the page, files of the run folder and the data of a run on one port.
//
// STOP has a path of its own: the thread of run() receives a viewer's message and sets the flag in
// shared memory, which the processes of the run read. This thread only moves bytes between sockets
// and memory. It opens no file, waits for no lock, and its work per turn is bounded: 4 KB from each
// connection, 64 KB to each, eight new connections. Everything else is the task of Backend.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace spikeloop::view {

struct ServerOptions {
  std::string feeds;     ///< folder of the feeds
  std::string run;       ///< run folder. Empty if there is none
  std::string page;      ///< folder of the page
  std::string name;      ///< of the experiment
  bool recording{};      ///< of a run that has ended
  std::string host;      ///< address to listen at, "127.0.0.1"
  std::uint16_t port{};  ///< 0: any
  std::string token;     ///< required for everything but watching and pressing STOP
};

class Server {
 public:
  /// @throws TransportError: the port is in use, the address is not ours.
  explicit Server(const ServerOptions& options);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;
  /// Serves until stop() is called, and half a second longer, for frames that wait.
  void run();
  /// Safe in a signal handler.
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::view
