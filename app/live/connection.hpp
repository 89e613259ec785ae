// One connection: bytes in and out, in bounded pieces. Never waits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "listener.hpp"
#include "outbox.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop::view {

class Connection {
 public:
  enum class State {
    request,   ///< waits for a request
    response,  ///< sends a file
    viewer,    ///< WebSocket
    closing    ///< sends queued bytes, discards input
  };

  Connection(Accepted accepted, TimeNs now);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  int fd() const { return socket_.get(); }
  std::uint32_t address() const { return address_; }
  State state() const { return state_; }
  bool is_viewer() const { return state_ == State::viewer; }
  /// Time of the newest change of the state.
  TimeNs since() const { return since_; }
  /// Time of the newest bytes of the client.
  TimeNs received() const { return received_; }
  /// True if the connection has served a request.
  bool has_served() const { return has_served_; }
  Client& client() { return *client_; }
  const SharedClient& shared_client() const { return client_; }

  /// Reads at most 4 KB. False if the client has closed the connection.
  bool receive(TimeNs now);
  /// Sends at most 64 KB: own bytes first, then frames of the client. False if the connection has
  /// failed, or Backend has closed the outbox.
  bool write(TimeNs now);
  /// True if bytes are queued and the client has received none for `patience`.
  bool lags(TimeNs now, TimeNs patience);
  bool wants_to_receive() const;
  bool wants_to_write() const;

  /// Sends bytes before the next frame.
  void send(std::string_view bytes) { own_ += bytes; }
  std::size_t own_bytes() const { return own_.size(); }
  void begin_response(SharedClient client, TimeNs now);
  void begin_viewer(SharedClient client, TimeNs now);
  void begin_closing(TimeNs now);
  /// The connection is closed at the end of the turn.
  void drop() { is_dropped_ = true; }
  bool is_dropped() const { return is_dropped_; }

  std::string input;           ///< received, and not yet handled
  std::string message;         ///< payloads of the viewer's unfinished message
  bool message_begun = false;  ///< True between the first frame of a message and its last one
  bool message_is_text = false;
  int budget = 0;  ///< frames that are handled before the next period
  TimeNs pinged = 0;

 private:
  void change(State state, TimeNs now);
  void fill(TimeNs now);
  bool begin_frame(TimeNs now);

  Descriptor socket_;
  std::uint32_t address_;
  State state_ = State::request;
  TimeNs since_;
  TimeNs received_;
  TimeNs progress_;
  bool has_served_ = false;
  bool locked_ = false;  ///< the other thread held the outbox: its frames are sent later
  bool shut_ = false;
  bool is_dropped_ = false;
  SharedClient client_{};
  std::string own_{};
  std::string output_{};
  std::size_t output_at_ = 0;
  SharedFrame frame_{};
  std::size_t frame_at_ = 0;
};

}  // namespace spikeloop::view
