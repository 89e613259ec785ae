#include "spikeloop/bag/reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include "mcap_format.hpp"
#include "parts.hpp"
#include "recorded_clock.hpp"
#include "source.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "unpack.hpp"

namespace spikeloop::bag {
namespace {

/// Spikes and signals in the file of a run, always in CDR.
constexpr std::string_view kOwnTypes = "spikeloop/";

constexpr std::string_view kRos1Magic = "#ROSBAG V";
constexpr std::string_view kSqliteMagic{"SQLite format 3\0", 16};

/// Files that other programs compress.
constexpr std::pair<std::string_view, const char*> kPackers[] = {{"\037\213", "gunzip"},
                                                                 {"BZh", "bunzip2"},
                                                                 {"\3757zXZ", "unxz"},
                                                                 {"\004\042\115\030", "unlz4"},
                                                                 {"PK\003\004", "unzip"}};

std::string first_bytes(const std::string& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string first(kSqliteMagic.size(), '\0');
  file.read(first.data(), static_cast<std::streamsize>(first.size()));
  if (errno != 0) {
    throw FileError("read", path, errno);
  }
  return first;
}

[[noreturn]] void refuse_format(const std::string& path, std::string_view first) {
  for (const auto& [magic, program] : kPackers) {
    if (first.starts_with(magic)) {
      throw FileError(with_code(Code::no_access,
                                "'{0}' is compressed; write  {1} {0}  and the path of the result",
                                path, program));
    }
  }
  throw FileError(with_code(Code::no_access,
                            "'{}' is neither an MCAP file nor a recording of ROS 2 in SQLite nor a "
                            "bag of ROS 1; write the path of a .mcap, .db3 or .bag file",
                            path));
}

std::unique_ptr<Source> open_source(const std::string& path, const std::string& name) {
  const std::string first = first_bytes(path);
  if (first.starts_with(kRos1Magic)) {
    return open_ros1_bag(path, name);
  }
  if (first.starts_with(mcap::kMagic)) {
    return open_mcap(path, name);
  }
  if (first == kSqliteMagic) {
    return open_sqlite(path, name);
  }
  refuse_format(name, first);
}

std::unique_ptr<Source> open_part(const std::string& path) {
  require_regular_file(path, "recording");
  if (is_zstd(first_bytes(path))) {
    const UnpackedFile unpacked(path);
    return open_source(unpacked.path(), path);
  }
  return open_source(path, path);
}

}  // namespace

void Source::keep_used_connections() {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> index(connections_.size(), kUnused);
  std::vector<Connection> used;
  for (Place& place : places_) {
    std::uint32_t& now = index[place.connection];
    if (now == kUnused) {
      now = static_cast<std::uint32_t>(used.size());
      used.push_back(connections_[place.connection]);
    }
    place.connection = now;
  }
  connections_ = std::move(used);
}

void fail_damaged(const std::string& name, std::string_view why, std::string_view remedy) {
  throw FileError(with_code(Code::no_access, "'{}' is damaged: {}{}", name, why, remedy));
}

void set_dialect(Connection& connection) {
  if (connection.encoding == messages::kRos1) {
    connection.dialect = messages::Dialect::ros1;
  } else if (connection.encoding == messages::kRos2) {
    connection.dialect = messages::Dialect::ros2;
  }
}

/// All files of a recording as one.
class Recording {
 public:
  explicit Recording(const std::string& path) {
    Parts parts = find_parts(path);
    warnings_ = std::move(parts.warnings);
    for (const std::string& file : parts.files) {
      std::error_code none;
      if (parts.files.size() > 1 && std::filesystem::file_size(file, none) == 0) {
        warnings_.push_back(fmt::format("'{}' is empty and is left out", file));
        continue;  // the last part of a recorder that was killed
      }
      parts_.push_back(open_part(file));
      const auto& warnings = parts_.back()->warnings();
      warnings_.insert(warnings_.end(), warnings.begin(), warnings.end());
    }
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      add_connections(i);
    }
    of_a_run_ =
        std::ranges::all_of(connections_, [](const auto& one) { return !one.node.empty(); });
    read_places(path);
    if (connections_.empty() && !parts_.empty() && !parts_.back()->warnings().empty()) {
      throw FileError(with_code(Code::no_access, parts_.back()->warnings().back()));
    }
  }

  const std::vector<Connection>& connections() const { return connections_; }
  bool is_of_a_run() const { return of_a_run_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  TimeNs end() const { return end_; }

  std::optional<TimeNs> end_of(const std::string& topic) const {
    std::optional<TimeNs> end;
    for (std::size_t i = 0; i < connections_.size(); ++i) {
      if (connections_[i].topic == topic && !places_[i].empty()) {
        end = std::max(end.value_or(0), places_[i].back().place.time);
      }
    }
    return end;
  }

  /// Time since the recording begins.
  struct PartPlace {
    Place place;
    std::uint32_t part;
  };
  static bool is_earlier(const PartPlace& a, const PartPlace& b) {
    return a.place.time < b.place.time;
  }

  const std::vector<PartPlace>& places(std::size_t connection) const { return places_[connection]; }
  std::unique_ptr<Bytes> bytes(std::uint32_t part) const { return parts_[part]->bytes(); }
  const std::string& file(std::uint32_t part) const { return parts_[part]->path(); }
  std::size_t part_count() const { return parts_.size(); }

 private:
  /// Connections of one topic in several parts are one connection.
  void add_connections(std::size_t part) {
    std::vector<std::uint32_t>& indexes = indexes_.emplace_back();
    for (const Connection& connection : parts_[part]->connections()) {
      const auto is_same = [&](const Connection& other) {
        const auto key = [](const Connection& one) {
          return std::tie(one.topic, one.type, one.encoding, one.version, one.node,
                          one.schema.definition);
        };
        return key(connection) == key(other);
      };
      // Within a part they stay apart: two nodes may have used one topic.
      const auto end = connections_.begin() + static_cast<std::ptrdiff_t>(before_part_);
      const auto known = std::find_if(connections_.begin(), end, is_same);
      indexes.push_back(static_cast<std::uint32_t>((known == end ? connections_.end() : known) -
                                                   connections_.begin()));
      if (known == end) {
        connections_.push_back(connection);
      }
    }
    before_part_ = connections_.size();
  }

  void read_places(const std::string& path) {
    std::vector<std::vector<Place>> all;
    for (const auto& part : parts_) {
      all.push_back(part->take_places());
    }
    if (!of_a_run_) {
      set_zero_times(path, all);
    }
    places_.resize(connections_.size());
    RecordedClock clock;
    TimeNs begin = of_a_run_ ? 0 : std::numeric_limits<TimeNs>::max();
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      for (Place place : all[part]) {
        const std::uint32_t connection = indexes_[part][place.connection];
        if (!of_a_run_) {
          place.time = clock.next(connection, place.time);
          begin = std::min(begin, place.time);
        }
        places_[connection].push_back({place, static_cast<std::uint32_t>(part)});
      }
      std::vector<Place>().swap(all[part]);
    }
    for (auto& places : places_) {
      std::ranges::stable_sort(places, is_earlier);
      for (PartPlace& one : places) {
        one.place.time -= begin;
      }
      end_ = std::max(end_, places.empty() ? 0 : places.back().place.time);
    }
    if (const std::string warning = clock.warning(path); !warning.empty()) {
      warnings_.push_back(warning);
    }
    warn_of_gap(path, clock.longest_gap().begin - begin, clock.longest_gap().end - begin);
  }

  /// `ros2 bag record --use-sim-time` gives time 0 to messages before the first /clock. They get
  /// the time at which the others begin.
  void set_zero_times(const std::string& path, std::vector<std::vector<Place>>& all) {
    constexpr TimeNs kClear = 60 * kNsPerSecond;
    TimeNs begin = std::numeric_limits<TimeNs>::max();
    std::size_t zeros = 0;
    for (const auto& places : all) {
      for (const Place& place : places) {
        zeros += place.time == 0 ? 1 : 0;
        begin = place.time == 0 ? begin : std::min(begin, place.time);
      }
    }
    if (begin == std::numeric_limits<TimeNs>::max() && zeros > connections_.size()) {
      warnings_.push_back(fmt::format(
          "'{}': all {} messages are at time 0, so that they arrive at once; record them again "
          "without --use-sim-time, or while a simulator publishes /clock",
          path, zeros));
    }
    if (zeros == 0 || begin < kClear || begin == std::numeric_limits<TimeNs>::max()) {
      return;
    }
    for (auto& places : all) {
      for (Place& place : places) {
        place.time = place.time == 0 ? begin : place.time;
      }
    }
    warnings_.push_back(fmt::format(
        "'{}': {} {} at time 0, before the first /clock, and the next time is {}; they are used at "
        "the beginning",
        path, zeros, zeros == 1 ? "message is" : "messages are", format_time(begin)));
  }

  void warn_of_gap(const std::string& path, TimeNs from, TimeNs to) {
    constexpr TimeNs kLong = 60 * kNsPerSecond;
    const auto is_empty = [&](const std::vector<PartPlace>& places) {
      const auto after = std::ranges::upper_bound(
          places, from, {}, [](const PartPlace& one) { return one.place.time; });
      return after == places.end() || after->place.time >= to;
    };
    if (to - from > kLong && std::ranges::all_of(places_, is_empty)) {
      warnings_.push_back(fmt::format("'{}': there is no message from {} to {}", path,
                                      format_time(from), format_time(to)));
    }
  }

  std::vector<std::unique_ptr<Source>> parts_;
  std::vector<Connection> connections_;
  std::vector<std::vector<std::uint32_t>> indexes_;  ///< of the connections of every part
  std::size_t before_part_ = 0;
  std::vector<std::vector<PartPlace>> places_;  ///< of every connection, by time
  std::vector<std::string> warnings_;
  bool of_a_run_ = false;
  TimeNs end_ = 0;
};

/// Reads messages in the order of their times.
struct Stream::Impl {
  Impl(std::shared_ptr<const Recording> opened, const std::vector<std::size_t>& connections)
      : recording(std::move(opened)), bytes(recording->part_count()) {
    for (const std::size_t connection : connections) {
      may_be_packed |= recording->connections()[connection].dialect == messages::Dialect::ros2;
      const auto& places = recording->places(connection);
      if (connections.size() == 1) {
        all = places;
      } else {
        merged.insert(merged.end(), places.begin(), places.end());
      }
    }
    if (connections.size() > 1) {
      std::ranges::stable_sort(merged, Recording::is_earlier);
      all = merged;
    }
  }

  std::optional<Message> next() {
    if (all.empty()) {
      return std::nullopt;
    }
    const auto [place, part] = all.front();
    all = all.subspan(1);
    if (!bytes[part]) {
      bytes[part] = recording->bytes(part);
    }
    std::span<const std::byte> message = bytes[part]->read(place);
    if (may_be_packed && is_zstd(mcap::as_text(message))) {  // no message in CDR begins like this
      message = unpack(message, part);
    }
    return Message{place.time, message};
  }

  std::span<const std::byte> unpack(std::span<const std::byte> message, std::uint32_t part) {
    try {
      unpacked = unpack_message(mcap::as_text(message));
    } catch (const std::runtime_error& error) {
      fail_damaged(recording->file(part), error.what());
    }
    return std::as_bytes(std::span(unpacked));
  }

  std::shared_ptr<const Recording> recording;
  std::vector<std::unique_ptr<Bytes>> bytes;  ///< of the parts that were used
  std::vector<Recording::PartPlace> merged;
  std::span<const Recording::PartPlace> all;  ///< messages that are left
  bool may_be_packed = false;
  std::string unpacked;
};

Stream::Stream(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Stream::~Stream() = default;
Stream::Stream(Stream&&) noexcept = default;
Stream& Stream::operator=(Stream&&) noexcept = default;

std::optional<Message> Stream::next() {
  return impl_->next();
}

Reader::Reader(const std::string& path) : recording_(std::make_shared<Recording>(path)) {}
Reader::~Reader() = default;

bool Reader::is_of_a_run() const {
  return recording_->is_of_a_run();
}

const std::vector<Connection>& Reader::connections() const {
  return recording_->connections();
}

messages::Dialect Reader::dialect() const {
  const auto is_ros2 = [](const Connection& one) {
    return one.dialect == messages::Dialect::ros2 && !one.type.starts_with(kOwnTypes);
  };
  return std::ranges::any_of(connections(), is_ros2) ? messages::Dialect::ros2
                                                     : messages::Dialect::ros1;
}

const std::vector<std::string>& Reader::warnings() const {
  return recording_->warnings();
}

TimeNs Reader::end() const {
  return recording_->end();
}

std::optional<TimeNs> Reader::end_of(const std::string& topic) const {
  return recording_->end_of(topic);
}

Stream Reader::stream(const std::string& topic, const std::string& node) const {
  std::vector<std::size_t> of_topic;
  std::vector<std::size_t> of_node;
  for (std::size_t i = 0; i < connections().size(); ++i) {
    if (connections()[i].topic == topic) {
      of_topic.push_back(i);
      if (connections()[i].node == node) {
        of_node.push_back(i);
      }
    }
  }
  if (is_of_a_run() && !of_topic.empty()) {
    of_topic = of_node.empty() ? std::vector{of_topic.front()} : of_node;
  }
  return Stream(std::make_unique<Stream::Impl>(recording_, of_topic));
}

std::string list_topics(const Reader& reader) {
  std::set<std::string> topics;
  for (const Connection& connection : reader.connections()) {
    topics.insert(fmt::format("{} ({})", connection.topic, connection.type));
  }
  return topics.empty() ? "none" : fmt::format("{}", fmt::join(topics, ", "));
}

messages::RecordedTopic recorded_topic(const Reader& reader, const Connection& connection,
                                       const std::string& node) {
  messages::RecordedTopic result{connection.topic, connection.type, connection.schema,
                                 connection.version};
  Stream stream = reader.stream(connection.topic, node);
  if (const auto first = stream.next()) {
    result.first.emplace(first->bytes.begin(), first->bytes.end());
  }
  return result;
}

}  // namespace spikeloop::bag
