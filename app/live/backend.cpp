#include "backend.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <iterator>

#include "http.hpp"
#include "log.hpp"
#include "spikeloop/core/background.hpp"
#include "spikeloop/core/pacer.hpp"

namespace spikeloop::view {
namespace {

constexpr std::chrono::milliseconds kReadPeriod{10};
constexpr TimeNs kRequestTime = 10'000'000;  // ns per round
constexpr TimeNs kLookPeriod = kNsPerSecond / 20;
constexpr TimeNs kLossPeriod = kNsPerSecond;
constexpr std::chrono::seconds kAfterError{1};
constexpr std::size_t kPieceBytes = std::size_t{64} << 10;
constexpr std::size_t kTransferBytes = std::size_t{1} << 20;  // queued for one client
/// Low priority, so that the server does not slow down the run.
constexpr int kNice = 10;

SharedFrame raw_frame(std::string bytes) {
  return std::make_shared<Frame>(Frame::Kind::raw, std::move(bytes));
}

}  // namespace

Backend::Backend(const ServerOptions& options, std::function<void()> wake)
    : options_(options),
      wake_(std::move(wake)),
      hub_(options.feeds, options.recording),
      session_(fmt::format("{}", std::time(nullptr))),
      thread_(background_thread([this] { run(); })) {}

Backend::~Backend() {
  stop_ = true;
  wakened_.notify_one();
  thread_.join();
}

void Backend::post(std::vector<ClientRequest>& requests) {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (lock && !requests.empty()) {
    std::ranges::move(requests, std::back_inserter(posted_));
    requests.clear();
    wakened_.notify_one();
  }
}

void Backend::run() {
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNice);
  while (!stop_) {
    {
      std::unique_lock lock(mutex_);
      wakened_.wait_for(lock, requests_.empty() ? kReadPeriod : std::chrono::milliseconds(0),
                        [this] { return stop_ || !posted_.empty(); });
      std::ranges::move(posted_, std::back_inserter(requests_));
      posted_.clear();
    }
    try {
      make_round();
    } catch (const std::exception& error) {
      // The other thread still handles STOP.
      log_line(fmt::format("the live view pauses for 1 s after an error: {}; STOP still works",
                           error.what()));
      std::this_thread::sleep_for(kAfterError);
    }
    wake_();
  }
}

void Backend::make_round() {
  const TimeNs now = wall_now();
  remove_gone();
  if (now >= next_losses_) {
    next_losses_ = now + kLossPeriod;
    report_losses();
  }
  if (now >= next_look_) {
    next_look_ = now + kLookPeriod;
    look();
  }
  while (!requests_.empty() && wall_now() - now < kRequestTime) {
    ClientRequest request = std::move(requests_.front());
    requests_.pop_front();
    --request.client->waiting_requests;
    if (!request.client->gone) {
      handle(request);
    }
  }
  reset_viewers();
  read();
  continue_transfers();
}

void Backend::handle(ClientRequest& request) {
  if (const auto* file = std::get_if<FileRequest>(&request.what)) {
    begin_transfer(request.client, *file);
  } else if (const auto* message = std::get_if<nlohmann::json>(&request.what)) {
    for (Viewer& viewer : viewers_) {
      if (&viewer.client() == request.client.get()) {
        viewer.take(*message, newest_);
      }
    }
  } else {
    Viewer& viewer = viewers_.emplace_back(hub_, request.client);
    introduce(viewer);
    viewer.advertise(0, advertised_);
  }
}

void Backend::begin_transfer(const SharedClient& client, const FileRequest& request) {
  Answer found = answer(request.path, request.range, options_.page, options_.run);
  const std::string range =
      found.range.empty() ? "" : fmt::format("content-range: {}\r\n", found.range);
  client->outbox.push({raw_frame(response_head(found.status, found.type, found.size, range))});
  if (request.without_body) {
    found.size = 0;
  }
  transfers_.push_back({client, std::move(found)});
}

void Backend::continue_transfers() {
  for (Transfer& transfer : transfers_) {
    Outbox& outbox = transfer.client->outbox;
    while (transfer.answer.size > 0 && outbox.bytes() < kTransferBytes) {
      std::string piece = next_piece(transfer.answer, kPieceBytes);
      if (piece.empty()) {
        outbox.close();  // the file has become shorter than its announced length
        break;
      }
      outbox.push({raw_frame(std::move(piece))});
    }
    if (transfer.answer.size == 0) {
      outbox.push({});
    }
  }
  std::erase_if(transfers_, [](const Transfer& transfer) {
    return transfer.answer.size == 0 || transfer.client->outbox.is_closed();
  });
}

void Backend::remove_gone() {
  std::erase_if(viewers_, [](const Viewer& viewer) { return viewer.client().gone.load(); });
  std::erase_if(transfers_, [](const Transfer& each) { return each.client->gone.load(); });
}

/// Processes, channels and parameters appear while a run begins; viewers may set parameters.
void Backend::look() {
  const std::size_t channels = hub_.look();
  newest_.resize(channels);
  const nlohmann::json now = hub_.parameters();
  for (Viewer& viewer : viewers_) {
    if (channels > advertised_) {
      viewer.advertise(advertised_, channels);
    }
    if (now != parameters_ && viewer.wants_parameters()) {
      viewer.send_parameters();
    }
    viewer.send(time_frame(hub_.time()));
  }
  parameters_ = now;
  advertised_ = channels;
}

/// After a jump in a recording: viewers discard old data.
void Backend::reset_viewers() {
  const std::uint32_t now = hub_.beginnings();
  if (now == beginnings_) {
    return;
  }
  beginnings_ = now;
  std::ranges::fill(newest_, nullptr);
  for (Viewer& viewer : viewers_) {
    introduce(viewer);
  }
}

void Backend::introduce(Viewer& viewer) const {
  viewer.greet(fmt::format("spikeloop: {}", options_.name),
               {{"experiment", options_.name}, {"recording", options_.recording ? "yes" : "no"}},
               fmt::format("{}-{}", session_, beginnings_));
}

void Backend::read() {
  hub_.read([this](std::uint32_t channel, TimeNs time, std::span<const std::byte> message) {
    const SharedFrame frame = data_frame(time, message);
    for (Viewer& viewer : viewers_) {
      viewer.send(channel, frame);
    }
    newest_[channel] = frame;
  });
}

void Backend::report_losses() {
  for (Viewer& viewer : viewers_) {
    const std::string text =
        nlohmann::json{{"lost", hub_.lost()}, {"dropped", viewer.client().outbox.dropped()}}.dump();
    viewer.send(Hub::kLosses, data_frame(hub_.time(), std::as_bytes(std::span(text))));
  }
}

}  // namespace spikeloop::view
