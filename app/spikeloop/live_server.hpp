// spikeloop-live beside a run.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>

#include "spikeloop/processes/process_tree.hpp"
#include "spikeloop/processes/scratch_folder.hpp"

namespace CLI {
class App;
}

namespace spikeloop::app {

struct LiveOptions {
  bool on = false;
  std::string host = "127.0.0.1";
  std::uint16_t port = 8765;  ///< first of ten ports that are tried; 0: any
};

/// --live-port and --live-host.
void add_address_options(CLI::App& command, LiveOptions& options);

class LiveServer {
 public:
  /// Starts it, tells its address on standard error, and gives the processes that are started from
  /// now on the folder for their data. @throws TransportError when it cannot start.
  /// @param recording the run has ended
  LiveServer(const LiveOptions& options, const std::string& run_folder, const std::string& name,
             bool recording = false);
  /// Ends it.
  ~LiveServer();
  /// @throws TransportError: it has ended.
  void require_alive();
  LiveServer(const LiveServer&) = delete;
  LiveServer& operator=(const LiveServer&) = delete;

 private:
  void watch(bool recording);
  bool warn_if_lost();

  ScratchFolder folder_;
  std::optional<ProcessTree> server_;
  std::atomic<bool> ended_{false};
  bool stopped_ = false;  ///< True while the server is stopped by SIGSTOP; used by watch()
  std::thread watch_;
};

}  // namespace spikeloop::app
