#include "spikeloop/live/feed.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "shared_file.hpp"
#include "spikeloop/core/pacer.hpp"

namespace spikeloop::live {
namespace {

using nlohmann::json;

constexpr std::size_t kRecordWords = 2;  // size and channel; time
constexpr unsigned kChannelBits = 32;
constexpr TimeNs kPatience = 5 * kNsPerSecond;

std::uint64_t words_of(std::size_t bytes) {
  return (bytes + sizeof(std::uint64_t) - 1) / sizeof(std::uint64_t);
}

/// The file has its name when it can be read.
std::unique_ptr<SharedFile> make_file(const std::string& path, std::size_t ring_bytes,
                                      const About& about) {
  const std::string unfinished = path + ".new";
  auto file = std::make_unique<SharedFile>(unfinished, ring_bytes);
  file->header().speed = about.pausable ? kFirstSpeed : 0;
  file->header().seen_at = wall_now();
  file->add_text(
      json{{"process", about.process}, {"commands", about.commands}, {"pausable", about.pausable}}
          .dump() +
      "\n");
  std::filesystem::rename(unfinished, path);
  return file;
}

}  // namespace

std::string folder_from_environment() {
  const char* const folder = std::getenv(kFolderVariable);
  return folder == nullptr ? "" : folder;
}

Feed::Feed(const std::string& folder, const About& about, std::size_t ring_bytes)
    : stop_(folder), file_(make_file(folder + "/" + about.process + ".feed", ring_bytes, about)) {}

Feed::~Feed() = default;

std::uint32_t Feed::add(const Channel& channel) {
  file_->add_text(json{{"topic", channel.topic},
                       {"encoding", channel.encoding},
                       {"schemaName", channel.schema_name},
                       {"schemaEncoding", channel.schema_encoding},
                       {"schema", channel.schema}}
                      .dump() +
                  "\n");
  return channels_++;
}

bool Feed::add(const Parameter& parameter) {
  if (seen_.size() == kMostParameters) {
    return false;
  }
  file_->header().parameters[seen_.size()].value = parameter.value;
  seen_.push_back(0);
  file_->add_text(json{{"parameter", parameter.name},
                       {"value", parameter.value},
                       {"minimum", parameter.minimum},
                       {"maximum", parameter.maximum},
                       {"unit", parameter.unit}}
                      .dump() +
                  "\n");
  return true;
}

std::vector<std::pair<std::size_t, double>> Feed::changes() {
  std::vector<std::pair<std::size_t, double>> result;
  Header& header = file_->header();
  const std::uint32_t all = header.all_changes.load(std::memory_order_acquire);
  if (all == all_seen_) {
    return result;
  }
  all_seen_ = all;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    if (const std::uint32_t changes = header.parameters[i].changes.load(); changes != seen_[i]) {
      seen_[i] = changes;
      result.emplace_back(i, header.parameters[i].value.load());
    }
  }
  return result;
}

void Feed::publish(std::uint32_t channel, TimeNs simulated, std::span<const std::byte> message) {
  const std::uint64_t size = kRecordWords + words_of(message.size());
  Header& header = file_->header();
  if (size > file_->ring_words() / 2) {
    header.left_out += message.size();
    return;
  }
  const std::uint64_t begin = header.written.load(std::memory_order_relaxed);
  header.claimed.store(begin + size, std::memory_order_relaxed);
  // Whoever sees a word of this record also sees the claim.
  std::atomic_thread_fence(std::memory_order_release);
  file_->store(begin, (message.size() << kChannelBits) | channel);
  file_->store(begin + 1, static_cast<std::uint64_t>(simulated));
  file_->store(begin + kRecordWords, message);
  header.written.store(begin + size, std::memory_order_release);
}

void Feed::set(std::size_t parameter, double value) {
  file_->header().parameters[parameter].value = value;
}

void Feed::begin_anew() {
  Header& header = file_->header();
  header.begun_at = header.written.load();
  ++header.beginnings;
}

bool Feed::watched() const {
  return file_->header().watched.load() != 0;
}

/// Nobody could end a pause when the view has gone.
bool Feed::has_view() const {
  return wall_now() - file_->header().seen_at.load() < kPatience;
}

bool Feed::paused() const {
  return file_->header().paused.load() != 0 && has_view();
}

std::uint64_t Feed::steps() const {
  return file_->header().steps.load();
}

double Feed::speed() const {
  return has_view() ? file_->header().speed.load() : 0;
}

FeedReader::FeedReader(const std::string& path) : file_(std::make_unique<SharedFile>(path)) {
  const auto line = json::parse(file_->text().substr(0, file_->text().find('\n')));
  about_ = {line.value("process", ""), line.value("commands", false),
            line.value("pausable", false)};
  lines_read_ = file_->text().find('\n') + 1;
}

FeedReader::~FeedReader() = default;
FeedReader::FeedReader(FeedReader&&) noexcept = default;
FeedReader& FeedReader::operator=(FeedReader&&) noexcept = default;

std::vector<Channel> FeedReader::new_channels() {
  file_->header().seen_at = wall_now();
  std::vector<Channel> channels;
  const std::string_view text = file_->text();
  while (lines_read_ < text.size()) {
    const std::size_t end = std::min(text.find('\n', lines_read_), text.size());
    const auto line = json::parse(text.substr(lines_read_, end - lines_read_));
    if (line.contains("parameter")) {
      parameters_.push_back({line.at("parameter"), line.at("value"), line.at("minimum"),
                             line.at("maximum"), line.at("unit")});
    } else {
      channels.push_back({line.at("topic"), line.at("encoding"), line.at("schemaName"),
                          line.at("schemaEncoding"), line.at("schema")});
    }
    lines_read_ = end + 1;
  }
  return channels;
}

std::optional<FeedReader::Record> FeedReader::next() {
  const Header& header = file_->header();
  const std::uint64_t ring = file_->ring_words();
  const std::uint64_t written = header.written.load(std::memory_order_acquire);
  // Viewers are told of a new begin before anything that comes behind it.
  if (position_ >= written || header.beginnings.load() != beginnings_) {
    return std::nullopt;
  }
  std::uint64_t head[kRecordWords];
  file_->load(position_, head);
  const std::size_t bytes = head[0] >> kChannelBits;
  const std::uint64_t size = kRecordWords + words_of(bytes);
  const bool is_head = size <= ring / 2;
  if (is_head) {
    copy_.resize(size - kRecordWords);
    file_->load(position_ + kRecordWords, copy_);
  }
  std::atomic_thread_fence(std::memory_order_acquire);
  if (!is_head || header.claimed.load(std::memory_order_relaxed) > position_ + ring) {
    lost_ += (written - position_) * sizeof(std::uint64_t);
    position_ = written;  // the newest counts
    return std::nullopt;
  }
  position_ += size;
  return Record{static_cast<std::uint32_t>(head[0]), static_cast<TimeNs>(head[1]),
                std::as_bytes(std::span(copy_)).first(bytes)};
}

std::uint64_t FeedReader::lost() const {
  return lost_ + file_->header().left_out.load();
}

std::uint32_t FeedReader::beginnings() {
  const std::uint32_t now = file_->header().beginnings.load();
  if (now != beginnings_) {
    beginnings_ = now;
    position_ = std::max(position_, file_->header().begun_at.load());
  }
  return now;
}

void FeedReader::change(std::size_t parameter, double value) {
  Header& header = file_->header();
  header.parameters[parameter].value = value;
  ++header.parameters[parameter].changes;
  header.all_changes.fetch_add(1, std::memory_order_release);
}

double FeedReader::value(std::size_t parameter) const {
  return file_->header().parameters[parameter].value.load();
}

void FeedReader::watch() {
  file_->header().watched = 1;
}

void FeedReader::pause(bool paused) {
  file_->header().paused = paused ? 1 : 0;
}

void FeedReader::step() {
  ++file_->header().steps;
}

void FeedReader::set_speed(double speed) {
  file_->header().speed = speed;
}

bool FeedReader::paused() const {
  return file_->header().paused.load() != 0;
}

std::uint64_t FeedReader::steps() const {
  return file_->header().steps.load();
}

double FeedReader::speed() const {
  return file_->header().speed.load();
}

}  // namespace spikeloop::live
