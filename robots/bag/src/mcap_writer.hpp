// Writes an MCAP file, in chunks that are compressed and have indexes.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mcap_format.hpp"
#include "spikeloop/core/time.hpp"

namespace spikeloop::bag::mcap {

struct Channel {
  std::string topic;
  std::string encoding;             ///< of messages, as kRos1
  std::string type;                 ///< the name of their definition
  std::string definition_encoding;  ///< as kRos1Definition
  std::function<std::string(std::span<const std::byte>)> definition;  ///< for the first message
  std::map<std::string, std::string> metadata;
};

/// A process that is killed leaves a file that is readable up to the last chunk that was ended.
class Writer {
 public:
  /// Makes the file. @throws FileError; so do all others.
  Writer(const std::string& path, std::string_view profile);
  ~Writer();
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  /// Of take(): 0, 1, ...
  std::uint16_t add(Channel channel);
  void take(std::uint16_t channel, TimeNs time, std::span<const std::byte> message);
  /// A file within the file.
  void attach(std::string_view name, std::string_view media_type, std::string_view contents);
  /// Ends the chunk.
  void flush();
  /// Ends the chunk if it was begun so long ago, in wall time.
  void flush_when_older(std::chrono::milliseconds age);
  /// Writes indexes and summary.
  void close();

 private:
  struct Known {
    Channel channel;
    std::uint16_t schema = 0;  // 0: nothing has been written of it
    std::uint32_t messages = 0;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> in_chunk;  // time and offset
  };
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  void write(std::string_view bytes);
  /// Writes what waits of the chunk index to a file without a name: a run of days has too many
  /// chunks to keep their index in memory.
  void spill_index();
  std::string chunk_index();
  void begin(std::uint16_t channel, std::span<const std::byte> message);
  std::string channel_record(std::uint16_t channel) const;
  std::string statistics() const;
  /// Records of one kind, with their opcodes.
  std::string summary(Op op);
  std::string end();

  std::string path_;
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t offset_ = 0;
  std::vector<Known> channels_;
  std::vector<std::string> schemas_;  // without their numbers, which count from 1
  std::string chunk_;
  std::chrono::steady_clock::time_point chunk_begun_;
  std::uint64_t first_ = 0;
  std::uint64_t last_ = 0;
  std::uint32_t chunks_ = 0;
  std::uint64_t begin_ = 0;  // times of all messages
  std::uint64_t end_ = 0;
  std::string index_;  // chunk index records that are not in index_file_ yet
  std::unique_ptr<std::FILE, Close> index_file_;
  std::vector<std::string> attachment_indexes_;
};

}  // namespace spikeloop::bag::mcap
