// The thread that reads the run's data and files, and answers viewers. It may be slow: STOP does
// not pass through it.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <list>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "files.hpp"
#include "hub.hpp"
#include "outbox.hpp"
#include "server.hpp"
#include "viewer.hpp"

namespace spikeloop::view {

struct Arrival {};
struct FileRequest {
  std::string path;
  std::string range;
  bool without_body = false;
};
struct ClientRequest {
  SharedClient client;
  std::variant<Arrival, nlohmann::json, FileRequest> what;
};

class Backend {
 public:
  /// @param wake called when frames wait for clients
  Backend(const ServerOptions& options, std::function<void()> wake);
  ~Backend();
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;

  /// Moves the requests to the thread. Does nothing while the thread holds the lock; then the
  /// caller tries again. Never waits.
  void post(std::vector<ClientRequest>& requests);

 private:
  struct Transfer {
    SharedClient client;
    Answer answer;
  };

  void run();
  void make_round();
  void handle(ClientRequest& request);
  void begin_transfer(const SharedClient& client, const FileRequest& request);
  void continue_transfers();
  void remove_gone();
  void look();
  void reset_viewers();
  void introduce(Viewer& viewer) const;
  void read();
  void report_losses();

  const ServerOptions options_;
  const std::function<void()> wake_;
  Hub hub_;
  std::list<Viewer> viewers_{};
  std::vector<Transfer> transfers_{};
  std::vector<SharedFrame> newest_{};  ///< index: channel
  std::size_t advertised_ = 0;
  std::uint32_t beginnings_ = 0;
  nlohmann::json parameters_{};  ///< last values sent to the viewers
  const std::string session_;
  TimeNs next_look_ = 0;
  TimeNs next_losses_ = 0;
  std::deque<ClientRequest> requests_{};
  std::mutex mutex_{};
  std::condition_variable wakened_{};
  std::vector<ClientRequest> posted_{};
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace spikeloop::view
