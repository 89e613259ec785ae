#include "server.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <new>
#include <tuple>
#include <utility>
#include <vector>

#include "access.hpp"
#include "backend.hpp"
#include "connection.hpp"
#include "http.hpp"
#include "log.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/core/parse_message.hpp"
#include "spikeloop/live/stop_flag.hpp"
#include "websocket.hpp"

namespace spikeloop::view {
namespace {

using State = Connection::State;

constexpr int kPeriod_ms = 10;
constexpr TimeNs kPeriod = kPeriod_ms * 1'000'000;
constexpr int kFramesPerPeriod = 16;  // handled per viewer
constexpr int kAcceptsPerTurn = 8;
constexpr std::size_t kLargestHead = std::size_t{8} << 10;      // bytes
constexpr std::size_t kLargestMessage = std::size_t{16} << 10;  // bytes, from a viewer
constexpr std::size_t kMostOwnBytes = std::size_t{64} << 10;    // queued pongs per viewer
constexpr unsigned kMostWaitingRequests = 500;                  // per viewer

// Connections other than viewers are closed to make room.
constexpr std::size_t kMostRequests = 64;
constexpr std::size_t kMostRequestsPerAddress = 32;
constexpr std::size_t kMostViewers = 64;  // without the token
constexpr std::size_t kMostViewersPerAddress = 32;
constexpr std::size_t kMostControllers = 16;  // viewers with the token

constexpr TimeNs kRequestPatience = 2 * kNsPerSecond;  // for the first request
constexpr TimeNs kIdlePatience = 5 * kNsPerSecond;     // between requests
constexpr TimeNs kLagPatience = 5 * kNsPerSecond;
constexpr TimeNs kClosePatience = kNsPerSecond;
constexpr TimeNs kPingAfter = 10 * kNsPerSecond;
constexpr TimeNs kPongPatience = 10 * kNsPerSecond;
constexpr TimeNs kLogPeriod = kNsPerSecond;
/// Time for sending queued frames after the end of the run.
constexpr TimeNs kLastWords = kNsPerSecond / 2;

constexpr int kDeepest = 8;  // level of a message's values; deeper ones are left out

constexpr std::string_view kHeadEnd = "\r\n\r\n";
constexpr std::array<const char*, 2> kProtocols{"foxglove.sdk.v1", "foxglove.websocket.v1"};

std::string machine_name() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

/// Reason to refuse the handshake of RFC 6455 (4.2.1). Empty if it is valid.
std::string wrong_handshake(const HttpRequest& request) {
  if (request.method != "GET" || request.header("sec-websocket-key").empty()) {
    return "the request to upgrade is not one for a WebSocket";
  }
  if (request.header("sec-websocket-version") != "13") {
    return fmt::format("WebSocket version '{}' is not supported; use version 13",
                       request.header("sec-websocket-version"));
  }
  return {};
}

std::string protocol_of(const HttpRequest& request) {
  const auto* const found = std::ranges::find_if(kProtocols, [&](const char* protocol) {
    return request.lists("sec-websocket-protocol", protocol);
  });
  return found == kProtocols.end() ? "" : *found;
}

}  // namespace

struct Server::Impl {
  explicit Impl(const ServerOptions& server_options);

  void wake() const;
  void make_turn();
  void poll_connections();
  void serve(Connection& connection, short events);
  void handle_input(Connection& connection);
  void handle_head(Connection& connection, std::string_view head);
  void upgrade(Connection& connection, const HttpRequest& request, bool has_token);
  bool has_room_for(std::uint32_t address, bool has_token) const;
  void handle_frames(Connection& connection);
  void handle_frame(Connection& connection, const IncomingFrame& frame);
  void take(Connection& connection, std::string_view text);
  void refuse(Connection& connection, unsigned status, const std::string& reason);
  void disconnect(Connection& connection, CloseCode code, const std::string& reason);
  void accept_some();
  void make_room(std::uint32_t address);
  bool close_oldest(std::uint32_t address, bool any_address);
  void begin_period();
  bool has_expired(Connection& connection);
  void report(const Connection& connection, const std::string& event);

  ServerOptions options;
  const std::string machine = machine_name();
  Listener listener;
  live::StopFlag stop_flag;
  Descriptor wakened;
  std::vector<std::unique_ptr<Connection>> connections;
  std::vector<ClientRequest> requests;  // for the backend
  std::vector<pollfd> polled;
  TimeNs now = wall_now();
  TimeNs next_period = 0;
  TimeNs next_accept = 0;
  TimeNs next_log = 0;
  std::size_t unreported = 0;
  std::atomic<bool> stop{false};
  Backend backend;  // its thread ends first
};

Server::Impl::Impl(const ServerOptions& server_options)
    : options(server_options),
      listener(options.host, options.port),
      stop_flag(options.feeds),
      wakened(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      backend(options, [this] { wake(); }) {}

void Server::Impl::wake() const {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t ignored = ::write(wakened.get(), &one, sizeof(one));
}

void Server::Impl::make_turn() {
  poll_connections();
  now = wall_now();
  try {
    for (std::size_t i = 0; i < connections.size(); ++i) {
      serve(*connections[i], polled[i + 2].revents);
    }
    if ((polled[1].revents & POLLIN) != 0) {
      accept_some();
    }
    if (now >= next_period) {
      next_period = now + kPeriod;
      begin_period();
    }
    backend.post(requests);
  } catch (const std::bad_alloc&) {
    close_oldest(0, true);
  }
  std::erase_if(connections, [](const auto& connection) { return connection->is_dropped(); });
}

void Server::Impl::poll_connections() {
  polled.assign({{wakened.get(), POLLIN, 0}, {now >= next_accept ? listener.fd() : -1, POLLIN, 0}});
  for (const auto& connection : connections) {
    const int events = (connection->wants_to_receive() ? POLLIN : 0) |
                       (connection->wants_to_write() ? POLLOUT : 0);
    polled.push_back({connection->fd(), static_cast<short>(events), 0});
  }
  ::poll(polled.data(), polled.size(), kPeriod_ms);
  std::uint64_t count = 0;
  [[maybe_unused]] const ssize_t ignored = ::read(wakened.get(), &count, sizeof(count));
}

void Server::Impl::serve(Connection& connection, short events) {
  if ((events & (POLLIN | POLLHUP | POLLERR)) != 0) {
    if (!connection.receive(now)) {
      connection.drop();
      connection.budget = kFramesPerPeriod;  // STOP may be the last message of a viewer
      handle_input(connection);
      return;
    }
    handle_input(connection);
  }
  if (connection.wants_to_write() && !connection.write(now)) {
    connection.drop();
  }
}

void Server::Impl::handle_input(Connection& connection) {
  if (connection.is_viewer()) {
    handle_frames(connection);
  } else if (connection.state() == State::request) {
    const std::size_t end = connection.input.find(kHeadEnd);
    if (end == std::string::npos && connection.input.size() > kLargestHead) {
      refuse(connection, 400, fmt::format("the request has more than {} bytes", kLargestHead));
    } else if (end != std::string::npos) {
      const std::string head = connection.input.substr(0, end);
      connection.input.erase(0, end + kHeadEnd.size());
      handle_head(connection, head);
    }
  }
}

void Server::Impl::handle_head(Connection& connection, std::string_view head) {
  const auto request = parse_head(head);
  if (!request) {
    refuse(connection, 400,
           "not a valid HTTP/1.1 request, or it has a body; send GET without a body");
    return;
  }
  const bool has_token = is_same_token(request->argument("token"), options.token);
  const std::string host(request->header("host"));
  const std::string origin(request->header("origin"));
  if (!is_our_host(host, machine)) {
    refuse(connection, 403,
           fmt::format("host '{}' is not a name of this machine; open the printed address", host));
  } else if (!is_allowed_origin(origin, host, has_token)) {
    refuse(connection, 403,
           fmt::format("origin '{}' is not allowed; open the printed address, which has the token",
                       origin));
  } else if (request->lists("upgrade", "websocket")) {
    upgrade(connection, *request, has_token);
  } else if (request->method != "GET" && request->method != "HEAD") {
    refuse(connection, 405, fmt::format("method '{}' is not allowed; use GET", request->method));
  } else {
    connection.begin_response(std::make_shared<Client>(has_token), now);
    ++connection.client().waiting_requests;
    requests.push_back({connection.shared_client(),
                        FileRequest{request->path, std::string(request->header("range")),
                                    request->method == "HEAD"}});
  }
}

void Server::Impl::upgrade(Connection& connection, const HttpRequest& request, bool has_token) {
  const std::string protocol = protocol_of(request);
  if (const std::string wrong = wrong_handshake(request); !wrong.empty()) {
    refuse(connection, 400, wrong);
  } else if (protocol.empty()) {
    refuse(connection, 400,
           fmt::format("WebSocket protocol '{}' is not supported; use {}",
                       request.header("sec-websocket-protocol"), kProtocols.back()));
  } else if (!has_room_for(connection.address(), has_token)) {
    refuse(connection, 503, "too many viewers are connected; close one");
  } else {
    connection.send(response_head(
        101, fmt::format("upgrade: websocket\r\nconnection: upgrade\r\nsec-websocket-accept: {}\r\n"
                         "sec-websocket-protocol: {}\r\n",
                         accept_key(request.header("sec-websocket-key")), protocol)));
    connection.begin_viewer(std::make_shared<Client>(has_token), now);
    connection.budget = kFramesPerPeriod;
    ++connection.client().waiting_requests;
    requests.push_back({connection.shared_client(), Arrival{}});
    handle_frames(connection);
  }
}

bool Server::Impl::has_room_for(std::uint32_t address, bool has_token) const {
  std::size_t viewers = 0;
  std::size_t of_address = 0;
  for (const auto& each : connections) {
    if (each->is_viewer() && each->client().may_control == has_token) {
      ++viewers;
      of_address += each->address() == address ? 1 : 0;
    }
  }
  return has_token ? viewers < kMostControllers
                   : viewers < kMostViewers && of_address < kMostViewersPerAddress;
}

void Server::Impl::handle_frames(Connection& connection) {
  std::size_t handled = 0;
  for (; connection.is_viewer() && connection.budget > 0; --connection.budget) {
    const ParsedFrame parsed =
        parse_frame(std::span(connection.input).subspan(handled), kLargestMessage);
    if (parsed.error) {
      disconnect(connection, *parsed.error,
                 *parsed.error == CloseCode::too_big
                     ? fmt::format("a message has more than {} bytes", kLargestMessage)
                     : "invalid WebSocket frame");
    }
    if (!parsed.frame) {
      break;
    }
    handled += parsed.frame->size;
    handle_frame(connection, *parsed.frame);
  }
  connection.input.erase(0, handled);
}

void Server::Impl::handle_frame(Connection& connection, const IncomingFrame& frame) {
  const bool continues = frame.opcode == Opcode::continuation;
  if (frame.opcode == Opcode::close) {
    connection.send(close_frame(CloseCode::normal));
    connection.begin_closing(now);
  } else if (frame.opcode == Opcode::ping) {
    connection.send(frame_header(Opcode::pong, frame.payload.size()));
    connection.send(frame.payload);
    if (connection.own_bytes() > kMostOwnBytes) {
      disconnect(connection, CloseCode::violated_policy,
                 "the viewer sends pings but reads no pongs");
    }
  } else if (frame.opcode == Opcode::pong) {
    return;
  } else if (continues != connection.message_begun) {
    disconnect(connection, CloseCode::protocol_error,
               "a continuation frame without a message, or a new message inside an unfinished one");
  } else if (connection.message.size() + frame.payload.size() > kLargestMessage) {
    disconnect(connection, CloseCode::too_big,
               fmt::format("a message has more than {} bytes", kLargestMessage));
  } else {
    connection.message_is_text =
        continues ? connection.message_is_text : frame.opcode == Opcode::text;
    connection.message += frame.payload;
    connection.message_begun = !frame.last;
    if (frame.last) {
      const std::string message = std::exchange(connection.message, {});
      if (connection.message_is_text) {
        take(connection, message);
      }
    }
  }
}

void Server::Impl::take(Connection& connection, std::string_view text) {
  auto message = parse_message<nlohmann::json>(text, kDeepest);
  Client& client = connection.client();
  if (const auto pressed = stop_request(message, client.may_control)) {
    stop_flag.press(*pressed);
  }
  if (++client.waiting_requests > kMostWaitingRequests) {
    disconnect(
        connection, CloseCode::violated_policy,
        fmt::format("more than {} requests of the viewer are unanswered", kMostWaitingRequests));
  } else {
    requests.push_back({connection.shared_client(), std::move(message)});
  }
}

void Server::Impl::refuse(Connection& connection, unsigned status, const std::string& reason) {
  const std::string body = reason + "\n";
  report(connection, fmt::format("refused with {}: {}", status, reason));
  connection.send(response_head(status, "text/plain", body.size(), "connection: close\r\n") + body);
  connection.begin_closing(now);
}

void Server::Impl::disconnect(Connection& connection, CloseCode code, const std::string& reason) {
  report(connection, fmt::format("disconnected: {}", reason));
  connection.send(close_frame(code));
  connection.begin_closing(now);
}

/// At most one line per second: an attacker does not fill the terminal.
void Server::Impl::report(const Connection& connection, const std::string& event) {
  if (now < next_log) {
    ++unreported;
    return;
  }
  next_log = now + kLogPeriod;
  log_line(fmt::format("{} {}{}", address_text(connection.address()), event,
                       unreported == 0 ? "" : fmt::format(" (and {} more)", unreported)));
  unreported = 0;
}

void Server::Impl::accept_some() {
  try {
    for (int i = 0; i < kAcceptsPerTurn; ++i) {
      auto accepted = listener.accept();
      if (!accepted) {
        return;
      }
      make_room(accepted->address);
      connections.push_back(std::make_unique<Connection>(std::move(*accepted), now));
    }
  } catch (const TransportError&) {
    if (!close_oldest(0, true)) {
      next_accept = now + kNsPerSecond;
    }
  }
}

void Server::Impl::make_room(std::uint32_t address) {
  std::size_t all = 0;
  std::size_t of_address = 0;
  for (const auto& each : connections) {
    if (!each->is_viewer()) {
      ++all;
      of_address += each->address() == address ? 1 : 0;
    }
  }
  if (of_address >= kMostRequestsPerAddress || all >= kMostRequests) {
    close_oldest(address, of_address < kMostRequestsPerAddress);
  }
}

/// Closes a connection that is no viewer: first those that have never sent a request.
bool Server::Impl::close_oldest(std::uint32_t address, bool any_address) {
  const auto rank = [&](const auto& each) {
    const bool is_candidate = !each->is_viewer() && (any_address || each->address() == address);
    return std::tuple(!is_candidate, each->has_served(), each->since());
  };
  const auto oldest = std::ranges::min_element(connections, {}, rank);
  if (oldest == connections.end() || std::get<0>(rank(*oldest))) {
    return false;
  }
  connections.erase(oldest);
  return true;
}

void Server::Impl::begin_period() {
  for (const auto& connection : connections) {
    connection->budget = kFramesPerPeriod;
    if (has_expired(*connection)) {
      connection->drop();
    } else if (!connection->input.empty()) {
      handle_input(*connection);
    }
  }
}

bool Server::Impl::has_expired(Connection& connection) {
  const TimeNs age = now - connection.since();
  const bool lags = connection.lags(now, kLagPatience);
  switch (connection.state()) {
    case State::request:
      return age > (connection.has_served() ? kIdlePatience : kRequestPatience);
    case State::response:
      return lags;
    case State::closing:
      return age > kClosePatience;
    case State::viewer:
      break;
  }
  // A pause of this process (SIGSTOP, a virtual machine) is no silence of the viewer: a viewer is
  // dropped only if it does not answer a ping.
  const bool awaits_pong = connection.pinged > connection.received();
  if (!awaits_pong && now - connection.received() > kPingAfter) {
    connection.pinged = now;
    connection.send(frame_header(Opcode::ping, 0));
  }
  if (lags) {
    report(connection, fmt::format("disconnected: the viewer has read nothing for {} s",
                                   kLagPatience / kNsPerSecond));
  }
  return lags || (awaits_pong && now - connection.pinged > kPongPatience);
}

Server::Server(const ServerOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Server::~Server() = default;

std::uint16_t Server::port() const {
  return impl_->listener.port();
}

void Server::run() {
  while (!impl_->stop) {
    impl_->make_turn();
  }
  for (const TimeNs end = wall_now() + kLastWords; wall_now() < end;) {
    impl_->make_turn();
  }
}

void Server::stop() {
  impl_->stop = true;
  impl_->wake();
}

}  // namespace spikeloop::view
