// Reads MCAP files from the first record to the last, so that one without a summary is read as
// well.
#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <limits>
#include <map>

#include "cursor.hpp"
#include "mcap_format.hpp"
#include "source.hpp"
#include "spikeloop/bag/recorder.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/schema.hpp"

namespace spikeloop::bag::mcap {
namespace {

constexpr std::uint64_t kLargestChunk = 1'000'000'000;  // bytes; writers begin another after 1 MB

struct Record {
  Op op;
  std::string_view content;
};

/// None: the rest of the bytes is no whole record.
std::optional<Record> next_record(Cursor& cursor) {
  if (cursor.left() < kRecordHead) {
    return std::nullopt;
  }
  const auto op = static_cast<Op>(cursor.number<std::uint8_t>());
  const auto length = cursor.number<std::uint64_t>();
  if (length > cursor.left()) {
    return std::nullopt;
  }
  return Record{op, cursor.take(length)};
}

struct Chunk {
  std::string_view stored;
  std::string_view compression;
  std::uint64_t size;
};

std::string unpack_lz4(std::string_view stored, std::string bytes) {
  LZ4F_dctx* context = nullptr;
  LZ4F_createDecompressionContext(&context, LZ4F_VERSION);
  std::size_t size = bytes.size();
  std::size_t used = stored.size();
  const std::size_t left =
      LZ4F_decompress(context, bytes.data(), &size, stored.data(), &used, nullptr);
  LZ4F_freeDecompressionContext(context);
  if (left != 0 || size != bytes.size()) {
    throw std::runtime_error("a chunk cannot be unpacked");
  }
  return bytes;
}

/// @throws std::runtime_error
std::string unpack(const Chunk& chunk) {
  if (chunk.compression == "zstd" &&
      ZSTD_getFrameContentSize(chunk.stored.data(), chunk.stored.size()) == chunk.size) {
    std::string bytes(chunk.size, '\0');
    if (ZSTD_decompress(bytes.data(), bytes.size(), chunk.stored.data(), chunk.stored.size()) ==
        chunk.size) {
      return bytes;
    }
  } else if (chunk.compression == "lz4") {
    return unpack_lz4(chunk.stored, std::string(chunk.size, '\0'));
  } else if (chunk.compression != "zstd") {
    throw std::runtime_error(fmt::format("a chunk is compressed by '{}'", chunk.compression));
  }
  throw std::runtime_error("a chunk cannot be unpacked");
}

struct Schema {
  std::string name;
  std::string encoding;
  std::string text;
};

/// "sensor_msgs/msg/LaserScan" is sensor_msgs/LaserScan.
std::string type_of(std::string name) {
  if (const auto middle = name.find("/msg/"); middle != std::string::npos) {
    name.erase(middle, 4);
  }
  return name;
}

/// Empty: the definition cannot be read.
std::string version_of(messages::Dialect dialect, const std::string& type,
                       const std::string& text) {
  try {
    messages::Catalog catalog(dialect);
    catalog.add_with_dependencies(type, text);
    return dialect == messages::Dialect::ros1 ? catalog.md5(type) : catalog.type_hash(type);
  } catch (const ConfigurationError&) {
    return "";
  }
}

/// Where a message is.
struct Place {
  TimeNs time;
  std::uint32_t chunk;
  std::uint64_t offset;  ///< of its record, in the unpacked chunk
  auto operator<=>(const Place&) const = default;
};

struct File {
  explicit File(const std::string& its_path) : path(its_path), mapping(its_path) {}

  std::string path;
  Mapping mapping;
  std::vector<Chunk> chunks;
  TimeNs begin = 0;
};

[[noreturn]] void damaged(const std::string& path, const std::string& why) {
  throw FileError(with_code(Code::no_access, "'{}' is damaged: {}", path, why));
}

class McapStream : public Stream::Impl {
 public:
  McapStream(std::shared_ptr<const File> file, std::vector<Place> places)
      : file_(std::move(file)), places_(std::move(places)) {}

  std::optional<Message> next() override {
    if (next_ == places_.size()) {
      return std::nullopt;
    }
    const Place& place = places_[next_++];
    const Chunk& chunk = file_->chunks[place.chunk];
    if (!chunk.compression.empty() && place.chunk != unpacked_) {
      try {
        bytes_ = unpack(chunk);
      } catch (const std::runtime_error& error) {
        damaged(file_->path, error.what());  // it was good when it was opened
      }
      unpacked_ = place.chunk;
    }
    Cursor cursor((chunk.compression.empty() ? chunk.stored : bytes_).substr(place.offset));
    Cursor message(next_record(cursor)->content);
    message.take(kMessageHead);
    return Message{place.time - file_->begin, std::as_bytes(std::span(message.rest()))};
  }

  static constexpr std::size_t kMessageHead = 22;  // bytes: channel, number, two times

 private:
  std::shared_ptr<const File> file_;
  std::vector<Place> places_;
  std::size_t next_ = 0;
  std::string bytes_;
  std::uint32_t unpacked_ = std::numeric_limits<std::uint32_t>::max();
};

class McapFile : public Source {
 public:
  explicit McapFile(const std::string& path) : file_(std::make_shared<File>(path)) {
    try {
      read(file_->mapping.bytes());
    } catch (const std::runtime_error& error) {
      damaged(path, error.what());
    }
    finish();
  }

  std::optional<TimeNs> end_of(const std::string& topic) override {
    std::optional<TimeNs> end;
    for (std::size_t i = 0; i < connections_.size(); ++i) {
      if (connections_[i].topic == topic) {
        end = std::max(end.value_or(0), places_[i].back().time - file_->begin);
      }
    }
    return end;
  }

  std::unique_ptr<Stream::Impl> stream(std::vector<std::size_t> connections) override {
    std::vector<Place> places;
    for (const std::size_t connection : connections) {
      const auto& more = places_.at(connection);
      places.insert(places.end(), more.begin(), more.end());
    }
    std::ranges::sort(places);
    return std::make_unique<McapStream>(file_, std::move(places));
  }

 private:
  void read(std::string_view bytes) {
    Cursor cursor(bytes);
    cursor.take(kMagic.size());
    while (const auto record = next_record(cursor)) {
      if (record->op == Op::data_end) {
        return;
      }
      if (record->op == Op::chunk) {
        read_chunk(record->content);
      } else if (record->op == Op::message) {
        // A chunk by itself.
        file_->chunks.push_back({record_around(record->content), "", 0});
        read_message(record->content, 0);
      } else {
        read_definition(*record);
      }
    }
    is_whole_ = false;
  }

  static std::string_view record_around(std::string_view content) {
    return {content.data() - kRecordHead, content.size() + kRecordHead};
  }

  void read_chunk(std::string_view content) {
    Cursor cursor(content);
    cursor.take(2 * sizeof(std::uint64_t));  // times, which the messages have as well
    Chunk chunk{};
    chunk.size = cursor.number<std::uint64_t>();
    const auto sum = cursor.number();
    chunk.compression = cursor.text();
    chunk.stored = cursor.text<std::uint64_t>();
    if (chunk.size > kLargestChunk ||
        (chunk.compression.empty() && chunk.size != chunk.stored.size())) {
      throw std::runtime_error(fmt::format("a chunk says that it has {} bytes", chunk.size));
    }
    const std::string bytes = chunk.compression.empty() ? std::string(chunk.stored) : unpack(chunk);
    if (sum != 0 && sum != checksum(bytes)) {
      throw std::runtime_error("the checksum of a chunk is wrong");
    }
    file_->chunks.push_back(chunk);
    Cursor records(bytes);
    while (!records.at_end()) {
      const std::size_t offset = bytes.size() - records.left();
      const auto record = next_record(records);
      if (!record) {
        throw std::runtime_error("a record leads beyond its end");
      }
      if (record->op == Op::message) {
        read_message(record->content, offset);
      } else {
        read_definition(*record);
      }
    }
  }

  void read_message(std::string_view content, std::size_t offset) {
    Cursor cursor(content);
    const auto channel = channels_.find(cursor.number<std::uint16_t>());
    cursor.number();  // which of the channel's it is
    const auto time = cursor.number<std::uint64_t>();
    cursor.number<std::uint64_t>();  // when it was sent
    if (channel == channels_.end()) {
      throw std::runtime_error("a message belongs to no channel");
    }
    if (time > std::uint64_t{std::numeric_limits<TimeNs>::max()}) {
      throw std::runtime_error("a message is of no time that there is");
    }
    auto& [connection, places] = channel->second;
    places.push_back(
        {static_cast<TimeNs>(time), static_cast<std::uint32_t>(file_->chunks.size() - 1), offset});
  }

  void read_definition(const Record& record) {
    Cursor cursor(record.content);
    if (record.op == Op::schema) {
      const auto id = cursor.number<std::uint16_t>();
      const std::string name(cursor.text());
      const std::string encoding(cursor.text());
      schemas_.try_emplace(id, Schema{name, encoding, std::string(cursor.text())});
    } else if (record.op == Op::channel) {
      const auto id = cursor.number<std::uint16_t>();
      if (!channels_.contains(id)) {
        channels_[id].first = connection(cursor);
      }
    }
  }

  Connection connection(Cursor& cursor) {
    const auto schema = schemas_.find(cursor.number<std::uint16_t>());
    Connection result;
    result.topic = cursor.text();
    result.encoding = cursor.text();
    Cursor metadata(cursor.text());
    while (!metadata.at_end()) {
      const std::string_view key = metadata.text();
      const std::string_view value = metadata.text();
      if (key == kNodeField) {
        result.node = value;
      }
    }
    if (schema != schemas_.end()) {
      const auto& [name, encoding, text] = schema->second;
      result.type = type_of(name);
      result.schema = {result.encoding, name, encoding, text};
      if (result.encoding == messages::kRos1 && encoding == messages::kRos1Definition) {
        result.dialect = messages::Dialect::ros1;
      } else if (result.encoding == messages::kRos2 && encoding == messages::kRos2Definition) {
        result.dialect = messages::Dialect::ros2;
      }
      if (result.dialect) {
        result.version = version_of(*result.dialect, result.type, text);
      }
    }
    return result;
  }

  void finish() {
    TimeNs first = std::numeric_limits<TimeNs>::max();
    TimeNs last = 0;
    for (auto& [id, channel] : channels_) {
      auto& [connection, places] = channel;
      if (!places.empty()) {
        std::ranges::sort(places);
        first = std::min(first, places.front().time);
        last = std::max(last, places.back().time);
        connections_.push_back(std::move(connection));
        places_.push_back(std::move(places));
      }
    }
    of_a_run_ =
        std::ranges::all_of(connections_, [](const auto& one) { return !one.node.empty(); });
    file_->begin = of_a_run_ || connections_.empty() ? 0 : first;
    end_ = connections_.empty() ? 0 : last - file_->begin;
    if (!is_whole_) {
      log::warning("'{}' was not ended: what is readable are its first {}", file_->path,
                   format_time(end_));
    }
  }

  std::shared_ptr<File> file_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::pair<Connection, std::vector<Place>>> channels_;
  std::vector<std::vector<Place>> places_;  ///< of the connections
  bool is_whole_ = true;
};

}  // namespace
}  // namespace spikeloop::bag::mcap

std::shared_ptr<spikeloop::bag::Source> spikeloop::bag::open_mcap(const std::string& path) {
  return std::make_shared<mcap::McapFile>(path);
}
