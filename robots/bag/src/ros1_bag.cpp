// Bags of ROS 1 (http://wiki.ros.org/Bags/Format/2.0), read from the first record to the last. A
// record is a header of fields, which contain their lengths, and data.
#include <fmt/format.h>

#include <map>

#include "chunks.hpp"
#include "source.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/schema.hpp"

namespace spikeloop::bag::ros1 {
namespace {

constexpr std::string_view kVersion = "#ROSBAG V2.0\n";

enum class Op : std::uint8_t { message = 2, file_header, index, chunk, chunk_info, connection };

/// Value of a header's field "name=value"; nullopt if there is no such field.
std::optional<std::string_view> find_field(std::string_view header, std::string_view name) {
  Cursor fields(header);
  while (!fields.at_end()) {
    const std::string_view field = fields.text();
    if (field.starts_with(name) && field.substr(name.size()).starts_with('=')) {
      return field.substr(name.size() + 1);
    }
  }
  return std::nullopt;
}

struct Record {
  std::string_view header;
  std::string_view data;

  template <typename Number = std::uint32_t>
  Number number(std::string_view name) const {
    return Cursor(find_field(header, name).value_or("")).number<Number>();
  }
  std::string text(std::string_view name) const {
    return std::string(find_field(header, name).value_or(""));
  }
  Op op() const { return static_cast<Op>(number<std::uint8_t>("op")); }
};

Record next_record(Cursor& cursor) {
  const std::string_view header = cursor.text();
  return {header, cursor.text()};
}

std::string_view message_at(std::string_view bytes) {
  Cursor cursor(bytes);
  return next_record(cursor).data;
}

[[noreturn]] void fail_index(const std::string& name) {
  throw FileError(with_code(
      Code::no_access,
      "'{0}' has no index, because its recording was not ended; write  rosbag reindex {0}", name));
}

class Ros1Bag : public Source {
 public:
  Ros1Bag(const std::string& path, const std::string& name)
      : Source(name), file_(std::make_shared<ChunkedFile>(path, name)) {
    if (!file_->mapping.bytes().starts_with(kVersion)) {
      throw FileError(with_code(Code::no_access,
                                "'{0}' is a bag of a format before 2.0; write  rosbag filter {0} "
                                "NEW.bag True  and the path of the result",
                                name));
    }
    try {
      read();
    } catch (const FileError&) {
      throw;
    } catch (const std::runtime_error& error) {
      fail_damaged(name, error.what(),
                   "; 'rosbag check' and 'rosbag reindex' may help; if the "
                   "error remains, no message can be recovered");
    }
    keep_used_connections();
  }

  std::unique_ptr<Bytes> bytes() const override {
    return std::make_unique<ChunkBytes>(file_, message_at);
  }

 private:
  void read() {
    const std::string_view bytes = file_->mapping.bytes();
    Cursor cursor(bytes);
    cursor.take(kVersion.size());
    const auto index = next_record(cursor).number<std::uint64_t>("index_pos");
    if (index == 0) {
      fail_index(path_);
    }
    bool has_index = index == bytes.size();
    while (!cursor.at_end()) {
      has_index |= bytes.size() - cursor.left() == index;
      const Record record = next_record(cursor);
      if (record.op() == Op::chunk) {
        const Chunk chunk{record.data, find_field(record.header, "compression").value_or(""),
                          record.number("size")};
        add_chunk(*file_, chunk, [&](std::string_view unpacked) { read_chunk(unpacked); });
      } else if (record.op() == Op::connection) {
        add_connection(record);
      }
    }
    if (!has_index) {
      throw std::runtime_error("its index is not at the position in the header");
    }
  }

  void read_chunk(std::string_view bytes) {
    Cursor cursor(bytes);
    while (!cursor.at_end()) {
      const std::size_t position = bytes.size() - cursor.left();
      const Record record = next_record(cursor);
      if (record.op() == Op::connection) {
        add_connection(record);
      } else if (record.op() == Op::message) {
        const auto connection = indexes_.find(record.number("conn"));
        if (connection == indexes_.end()) {
          throw std::runtime_error("a message belongs to no connection");
        }
        const auto time = record.number<std::uint64_t>("time");  // seconds, nanoseconds
        places_.push_back({kNsPerSecond * static_cast<TimeNs>(time & 0xffff'ffff) +
                               static_cast<TimeNs>(time >> 32),
                           connection->second, static_cast<std::uint32_t>(file_->chunks.size() - 1),
                           position});
      }
    }
  }

  void add_connection(const Record& record) {
    const auto index = static_cast<std::uint32_t>(connections_.size());
    if (!indexes_.try_emplace(record.number("conn"), index).second) {
      return;  // the index repeats the connection
    }
    const Record described{record.data, {}};
    const std::string type = described.text("type");
    connections_.push_back(
        {.topic = record.text("topic"),
         .type = type,
         .encoding = std::string(messages::kRos1),
         .dialect = messages::Dialect::ros1,
         .version = described.text("md5sum"),
         .schema = {std::string(messages::kRos1), type, std::string(messages::kRos1Definition),
                    described.text("message_definition")}});
  }

  std::shared_ptr<ChunkedFile> file_;
  std::map<std::uint32_t, std::uint32_t> indexes_;  ///< connection index by its number
};

}  // namespace
}  // namespace spikeloop::bag::ros1

std::unique_ptr<spikeloop::bag::Source> spikeloop::bag::open_ros1_bag(const std::string& path,
                                                                      const std::string& name) {
  return std::make_unique<ros1::Ros1Bag>(path, name);
}
