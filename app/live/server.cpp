#include "server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <libwebsockets.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <ctime>
#include <map>
#include <optional>
#include <vector>

#include "access.hpp"
#include "files.hpp"
#include "hub.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/processes/descriptor.hpp"
#include "viewer.hpp"

namespace spikeloop::view {
namespace {

constexpr lws_usec_t kReadPeriod_us = 10'000;
constexpr TimeNs kLookPeriod = kNsPerSecond / 20;
constexpr TimeNs kOwnPeriod = kNsPerSecond;
/// For what still waits when the run is over.
constexpr TimeNs kLastWords = kNsPerSecond / 2;
constexpr std::size_t kMostConnections = 64;
constexpr std::size_t kLargestRequest = std::size_t{64} << 10;  // bytes of a viewer's message
constexpr std::size_t kMostOfFile = std::size_t{64} << 10;      // bytes of one write
constexpr int kMostFrames = 64;                                 // of one turn
constexpr unsigned kRequest_s = 5;                              // for a whole request to come
constexpr int kPorts = 10;                                      // that are tried

constexpr const char* kHttp = "http";
constexpr const char* kSdk = "foxglove.sdk.v1";
constexpr const char* kWebsocket = "foxglove.websocket.v1";

// A viewer that is gone without a word is found out.
const lws_retry_bo_t kPings{nullptr, 0, 0, 10, 20, 0};

struct Connection {
  std::optional<Viewer> viewer;
  std::string incoming;  // of a message that comes in pieces
  Answer answer;
};

std::string header(lws* wsi, lws_token_indexes token) {
  std::array<char, 512> text{};
  const int size = lws_hdr_copy(wsi, text.data(), static_cast<int>(text.size()), token);
  // One that is too long is not that of a page of ours.
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : size < 0 ? "?" : "";
}

std::string token_of(lws* wsi) {
  std::array<char, 128> text{};
  const char* const found =
      lws_get_urlarg_by_name(wsi, "token=", text.data(), static_cast<int>(text.size()));
  return found == nullptr ? "" : found;
}

std::string machine_name() {
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  return name.data();
}

}  // namespace

struct Server::Impl {
  explicit Impl(const ServerOptions& server_options);
  ~Impl() { lws_context_destroy(context); }

  void listen();
  int take(lws* wsi, lws_callback_reasons reason, const char* in, std::size_t size);
  bool refuses(lws* wsi) const;
  int give_file(lws* wsi, std::string_view path);
  int go_on_with_file(lws* wsi);
  int receive(lws* wsi, std::string_view piece);
  int write(lws* wsi);
  void greet(lws* wsi);
  void begin_anew();
  void introduce(Viewer& viewer) const;
  void look();
  void read();
  void tell_losses();
  void ask_to_write();
  static void tick(lws_sorted_usec_list_t* list);

  ServerOptions options;
  const std::string machine = machine_name();
  Hub hub;
  lws_context* context = nullptr;
  lws_vhost* vhost = nullptr;
  std::map<lws*, Connection> connections;
  std::vector<SharedFrame> newest;  // of the channels
  std::size_t advertised = 0;
  std::uint32_t beginnings = 0;
  nlohmann::json parameters;  // as the viewers know them
  const std::string session = fmt::format("{}", std::time(nullptr));
  TimeNs next_look = 0;
  TimeNs next_own = 0;
  std::atomic<bool> stop{false};
  struct Timer {
    lws_sorted_usec_list_t list;
    Impl* impl;
  } timer{};
};

namespace {

int callback(lws* wsi, lws_callback_reasons reason, void* /*user*/, void* in, std::size_t size) {
  lws_context* const context = lws_get_context(wsi);
  auto* const impl = static_cast<Server::Impl*>(lws_context_user(context));
  return impl == nullptr ? 0 : impl->take(wsi, reason, static_cast<const char*>(in), size);
}

const std::array<lws_protocols, 4> kProtocols{
    lws_protocols{kHttp, callback, 0, 0, 0, nullptr, 0},
    lws_protocols{kSdk, callback, 0, kLargestRequest, 0, nullptr, 0},
    lws_protocols{kWebsocket, callback, 0, kLargestRequest, 0, nullptr, 0}, lws_protocols{}};

/// The library would wait for an address that this machine does not have.
void require_own_address(const std::string& host) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  const Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (::inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1 ||
      ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    throw TransportError(fmt::format(
        "the live view cannot listen at '{}', which is no IPv4 address of this machine; give one "
        "with --live-host, or 0.0.0.0 for all",
        host));
  }
}

}  // namespace

Server::Impl::Impl(const ServerOptions& server_options)
    : options(server_options), hub(options.feeds, options.recording) {
  require_own_address(options.host);
  lws_set_log_level(0, nullptr);
  lws_context_creation_info info{};
  info.port = CONTEXT_PORT_NO_LISTEN;
  info.options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_DISABLE_IPV6;
  info.user = this;
  info.timeout_secs = kRequest_s;
  info.timeout_secs_ah_idle = kRequest_s;
  context = lws_create_context(&info);
  if (context == nullptr) {
    throw TransportError("cannot start the server of the live view");
  }
  listen();
  timer.impl = this;
  lws_sul_schedule(context, 0, &timer.list, &Impl::tick, kReadPeriod_us);
}

/// At the port, or one of the next ones when it is in use.
void Server::Impl::listen() {
  lws_context_creation_info info{};
  info.protocols = kProtocols.data();
  info.vhost_name = "view";
  info.iface = options.host.c_str();
  info.retry_and_idle_policy = &kPings;
  info.keepalive_timeout = kRequest_s;
  info.options = LWS_SERVER_OPTION_DISABLE_IPV6;
  for (int i = 0; vhost == nullptr && i < (options.port == 0 ? 1 : kPorts); ++i) {
    info.port = options.port + i;
    vhost = lws_create_vhost(context, &info);
  }
  if (vhost == nullptr) {
    lws_context_destroy(context);
    throw TransportError(fmt::format(
        "the live view cannot listen at {}:{} (nor at the {} ports behind it); give another port "
        "with --live-port, or 0 for any",
        options.host, options.port, kPorts - 1));
  }
}

/// Of another site, or by a name of another site.
bool Server::Impl::refuses(lws* wsi) const {
  const std::string host = header(wsi, WSI_TOKEN_HOST);
  return !is_our_host(host, machine) || !is_own_origin(header(wsi, WSI_TOKEN_ORIGIN), host);
}

int Server::Impl::take(lws* wsi, lws_callback_reasons reason, const char* in, std::size_t size) {
  switch (reason) {
    case LWS_CALLBACK_FILTER_NETWORK_CONNECTION:
      return connections.size() < kMostConnections ? 0 : -1;
    case LWS_CALLBACK_WSI_CREATE:
      connections.try_emplace(wsi);
      return 0;
    case LWS_CALLBACK_WSI_DESTROY:
      connections.erase(wsi);
      return 0;
    case LWS_CALLBACK_HTTP:
      return give_file(wsi, {in, size});
    case LWS_CALLBACK_HTTP_WRITEABLE:
      return go_on_with_file(wsi);
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION: {
      const bool knows_us = lws_get_protocol(wsi)->name != kHttp;
      return knows_us && !refuses(wsi) ? 0 : -1;
    }
    case LWS_CALLBACK_ESTABLISHED:
      greet(wsi);
      return 0;
    case LWS_CALLBACK_RECEIVE:
      return receive(wsi, {in, size});
    case LWS_CALLBACK_SERVER_WRITEABLE:
      return write(wsi);
    default:
      return 0;
  }
}

int Server::Impl::give_file(lws* wsi, std::string_view path) {
  const bool without_body = lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) != 0;
  Answer& answer = connections[wsi].answer;
  if (refuses(wsi)) {
    answer = error_answer(403);
  } else if (!without_body && lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) == 0) {
    answer = error_answer(405);
  } else {
    answer = view::answer(path, header(wsi, WSI_TOKEN_HTTP_RANGE), options.page, options.run);
  }
  static constexpr std::pair<const char*, const char*> kHeaders[] = {
      {"content-security-policy:",
       "default-src 'self'; connect-src 'self' ws:; img-src 'self' blob: data:; "
       "frame-ancestors 'none'"},
      {"x-content-type-options:", "nosniff"},
      {"referrer-policy:", "no-referrer"},
      {"cache-control:", "no-store"}};
  std::array<unsigned char, LWS_PRE + 2048> head{};
  unsigned char* const begin = head.data() + LWS_PRE;
  unsigned char* at = begin;
  unsigned char* const end = head.data() + head.size() - 1;
  int error =
      lws_add_http_common_headers(wsi, answer.status, answer.type.c_str(), answer.size, &at, end);
  const auto add = [&](const char* name, const char* value) {
    error |= lws_add_http_header_by_name(wsi, reinterpret_cast<const unsigned char*>(name),
                                         reinterpret_cast<const unsigned char*>(value),
                                         static_cast<int>(std::strlen(value)), &at, end);
  };
  for (const auto& [name, value] : kHeaders) {
    add(name, value);
  }
  if (!answer.range.empty()) {
    add("content-range:", answer.range.c_str());
  }
  if (error != 0 || lws_finalize_write_http_header(wsi, begin, &at, end) != 0) {
    return -1;
  }
  if (without_body) {
    answer = {};
    return lws_http_transaction_completed(wsi) != 0 ? -1 : 0;
  }
  lws_callback_on_writable(wsi);
  return 0;
}

int Server::Impl::go_on_with_file(lws* wsi) {
  Answer& answer = connections[wsi].answer;
  if (!answer.body) {
    return -1;
  }
  const auto size = static_cast<std::size_t>(std::min<std::uintmax_t>(answer.size, kMostOfFile));
  const bool last = size == answer.size;
  std::vector<unsigned char> piece(LWS_PRE + size);
  // A file that has become shorter than announced ends the connection.
  if (!answer.body->read(reinterpret_cast<char*>(piece.data() + LWS_PRE),
                         static_cast<std::streamsize>(size)) ||
      lws_write(wsi, piece.data() + LWS_PRE, size, last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) <
          0) {
    return -1;
  }
  answer.size -= size;
  lws_set_timeout(wsi, PENDING_TIMEOUT_HTTP_CONTENT, kRequest_s);
  if (last) {
    answer = {};
    return lws_http_transaction_completed(wsi) != 0 ? -1 : 0;
  }
  lws_callback_on_writable(wsi);
  return 0;
}

void Server::Impl::greet(lws* wsi) {
  const std::string token = token_of(wsi);
  Viewer& viewer = connections[wsi].viewer.emplace(
      hub, options.token.empty() || same_token(token, options.token));
  introduce(viewer);
  viewer.advertise(0, advertised);
  lws_callback_on_writable(wsi);
}

int Server::Impl::receive(lws* wsi, std::string_view piece) {
  Connection& connection = connections[wsi];
  if (!connection.viewer || connection.incoming.size() + piece.size() > kLargestRequest) {
    return -1;
  }
  connection.incoming += piece;
  if (lws_is_final_fragment(wsi) != 0 && lws_remaining_packet_payload(wsi) == 0) {
    if (lws_frame_is_binary(wsi) == 0) {
      connection.viewer->take(connection.incoming, newest);
      if (connection.viewer->hangs()) {
        // Its socket may never be written again, and closing takes seconds.
        connection.viewer.reset();
        return -1;
      }
      lws_callback_on_writable(wsi);
    }
    connection.incoming.clear();
  }
  return 0;
}

int Server::Impl::write(lws* wsi) {
  if (!connections[wsi].viewer || connections[wsi].viewer->hangs()) {
    return -1;
  }
  Viewer& viewer = *connections[wsi].viewer;
  for (int i = 0; i < kMostFrames && viewer.waits() && lws_send_pipe_choked(wsi) == 0; ++i) {
    const SharedFrame frame = viewer.pop();
    if (lws_write(wsi, frame->payload(), frame->size(),
                  frame->binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT) < 0) {
      return -1;
    }
  }
  if (viewer.waits()) {
    lws_callback_on_writable(wsi);
  }
  return 0;
}

/// Processes, channels and parameters come while a run begins; viewers may set parameters.
void Server::Impl::look() {
  const std::size_t channels = hub.look();
  newest.resize(channels);
  const nlohmann::json now = hub.parameters();
  for (auto& [wsi, connection] : connections) {
    if (!connection.viewer) {
      continue;
    }
    if (channels > advertised) {
      connection.viewer->advertise(advertised, channels);
    }
    if (now != parameters && connection.viewer->wants_parameters()) {
      connection.viewer->send_parameters();
    }
    connection.viewer->send(time_frame(hub.time()));
  }
  parameters = now;
  advertised = channels;
}

/// Another time of a recording: what comes now has nothing to do with what came before.
void Server::Impl::begin_anew() {
  const std::uint32_t now = hub.beginnings();
  if (now == beginnings) {
    return;
  }
  beginnings = now;
  std::ranges::fill(newest, nullptr);
  for (auto& [wsi, connection] : connections) {
    if (connection.viewer) {
      introduce(*connection.viewer);
    }
  }
}

void Server::Impl::introduce(Viewer& viewer) const {
  viewer.greet(fmt::format("spikeloop: {}", options.name),
               {{"experiment", options.name}, {"recording", options.recording ? "yes" : "no"}},
               fmt::format("{}-{}", session, beginnings));
}

void Server::Impl::read() {
  hub.read([this](std::uint32_t channel, TimeNs time, std::span<const std::byte> message) {
    const SharedFrame frame = data_frame(time, message);
    for (auto& [wsi, connection] : connections) {
      if (connection.viewer) {
        connection.viewer->send(channel, frame);
      }
    }
    newest[channel] = frame;
  });
}

void Server::Impl::tell_losses() {
  for (auto& [wsi, connection] : connections) {
    if (connection.viewer) {
      const std::string text =
          nlohmann::json{{"lost", hub.lost()}, {"dropped", connection.viewer->dropped()}}.dump();
      connection.viewer->send(Hub::kLosses, data_frame(hub.time(), std::as_bytes(std::span(text))));
    }
  }
}

void Server::Impl::ask_to_write() {
  for (auto& [wsi, connection] : connections) {
    if (connection.viewer && connection.viewer->waits()) {
      lws_callback_on_writable(wsi);
    }
  }
}

void Server::Impl::tick(lws_sorted_usec_list_t* list) {
  Impl& impl = *lws_container_of(list, Timer, list)->impl;
  const TimeNs now = wall_now();
  if (now >= impl.next_own) {
    impl.next_own = now + kOwnPeriod;
    impl.tell_losses();
  }
  if (now >= impl.next_look) {
    impl.next_look = now + kLookPeriod;
    impl.look();
  }
  impl.begin_anew();
  impl.read();
  impl.ask_to_write();
  lws_sul_schedule(impl.context, 0, &impl.timer.list, &Impl::tick, kReadPeriod_us);
}

Server::Server(const ServerOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Server::~Server() = default;

std::uint16_t Server::port() const {
  return static_cast<std::uint16_t>(lws_get_vhost_listen_port(impl_->vhost));
}

void Server::run() {
  while (!impl_->stop) {
    lws_service(impl_->context, 0);
  }
  for (const TimeNs end = wall_now() + kLastWords; wall_now() < end;) {
    lws_service(impl_->context, 0);
  }
}

void Server::stop() {
  impl_->stop = true;
  lws_cancel_service(impl_->context);
}

}  // namespace spikeloop::view
