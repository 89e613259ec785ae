// Reads MCAP files from the first record to the last, so that one without a summary is read as
// well.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>

#include "chunks.hpp"
#include "cursor.hpp"
#include "mcap_format.hpp"
#include "source.hpp"
#include "spikeloop/bag/recorder.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/schema.hpp"

namespace spikeloop::bag::mcap {
namespace {

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

struct Schema {
  std::string name;
  std::string encoding;
  std::string text;
};

constexpr std::size_t kMessageHead = 22;  // bytes: channel, number, two times

std::string_view message_at(std::string_view bytes) {
  Cursor cursor(bytes);
  Cursor message(next_record(cursor)->content);
  message.take(kMessageHead);
  return message.rest();
}

class McapFile : public Source {
 public:
  McapFile(const std::string& path, const std::string& name)
      : Source(name), file_(std::make_shared<ChunkedFile>(path, name)) {
    const std::string_view bytes = file_->mapping.bytes();
    const bool is_closed = bytes.ends_with(kMagic) && bytes.size() > kMagic.size();
    bool is_whole = false;
    try {
      is_whole = read(bytes);
    } catch (const FileError&) {
      throw;
    } catch (const std::runtime_error& error) {
      if (is_closed) {
        fail_damaged(name, error.what());
      }
    }
    keep_used_connections();
    if (!is_whole) {
      if (is_closed && places_.empty()) {
        fail_damaged(name, "a record is cut off");
      }
      warn_of_end();
    }
  }

  std::unique_ptr<Bytes> bytes() const override {
    return std::make_unique<ChunkBytes>(file_, message_at);
  }

 private:
  /// True if the file has its end.
  bool read(std::string_view bytes) {
    Cursor cursor(bytes);
    cursor.take(kMagic.size());
    while (const auto record = next_record(cursor)) {
      switch (record->op) {
        case Op::data_end:
        case Op::footer:
          return true;
        case Op::chunk:
          read_chunk(record->content);
          break;
        case Op::message:
          file_->chunks.push_back({record_around(record->content), "", 0});
          read_message(record->content, 0);
          break;
        default:
          read_definition(*record);
      }
    }
    return false;
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
    require_known(chunk.compression);
    add_chunk(*file_, chunk, [&](std::string_view bytes) {
      if (sum != 0 && sum != checksum(bytes)) {
        throw std::runtime_error("the checksum of a chunk is wrong");
      }
      read_records(bytes);
    });
  }

  void read_records(std::string_view bytes) {
    Cursor records(bytes);
    while (!records.at_end()) {
      const std::size_t position = bytes.size() - records.left();
      const auto record = next_record(records);
      if (!record) {
        throw std::runtime_error("a record is cut off");
      }
      if (record->op == Op::message) {
        read_message(record->content, position);
      } else {
        read_definition(*record);
      }
    }
  }

  void require_known(std::string_view compression) const {
    for (const char* const known : {"", "none", "lz4", "zstd"}) {
      if (compression == known) {
        return;
      }
    }
    throw FileError(
        with_code(Code::no_access,
                  "'{0}' has chunks that are compressed by '{1}', and only lz4 and zstd "
                  "are supported; write  mcap compress {0} -o NEW.mcap",
                  path_, compression));
  }

  void read_message(std::string_view content, std::size_t position) {
    Cursor cursor(content);
    const auto channel = channels_.find(cursor.number<std::uint16_t>());
    cursor.number();  // which of the channel's it is
    const auto time = cursor.number<std::uint64_t>();
    cursor.number<std::uint64_t>();  // when it was sent
    if (channel == channels_.end()) {
      throw std::runtime_error("a message belongs to no channel");
    }
    if (time > std::uint64_t{std::numeric_limits<TimeNs>::max()}) {
      throw std::runtime_error("the time of a message is out of range");
    }
    places_.push_back({static_cast<TimeNs>(time), channel->second,
                       static_cast<std::uint32_t>(file_->chunks.size() - 1), position});
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
        connections_.push_back(connection(cursor));
        channels_[id] = static_cast<std::uint32_t>(connections_.size() - 1);
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
      } else if (key == "topic_type_hash" ||
                 key == "md5sum") {  // rosbag2 since Iron; `mcap convert`
        result.version = value;
      }
    }
    const auto& [name, encoding, text] = schema == schemas_.end() ? Schema{} : schema->second;
    result.type = messages::without_msg(name);
    result.schema = {result.encoding, name, encoding, text};
    set_dialect(result);
    return result;
  }

  void warn_of_end() {
    if (places_.empty()) {
      warnings_.push_back(fmt::format(
          "'{}' was not ended, and contains no complete chunk of messages; record it again, "
          "and end the recorder with Ctrl-C",
          path_));
      return;
    }
    const auto by_time = [](const Place& a, const Place& b) { return a.time < b.time; };
    const auto [first, last] = std::ranges::minmax_element(places_, by_time);
    warnings_.push_back(fmt::format("'{}' was not ended: only its first {} can be read", path_,
                                    format_time(last->time - (has_run_times() ? 0 : first->time))));
  }

  bool has_run_times() const {
    return std::ranges::all_of(connections_, [](const auto& one) { return !one.node.empty(); });
  }

  std::shared_ptr<ChunkedFile> file_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, std::uint32_t> channels_;  ///< their connections
};

}  // namespace
}  // namespace spikeloop::bag::mcap

std::unique_ptr<spikeloop::bag::Source> spikeloop::bag::open_mcap(const std::string& path,
                                                                  const std::string& name) {
  return std::make_unique<mcap::McapFile>(path, name);
}
