#include "mcap_writer.hpp"

#include <zstd.h>

#include <algorithm>
#include <cerrno>

#include "mcap_format.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/write_failures.hpp"

namespace spikeloop::bag::mcap {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 20;
constexpr std::size_t kIndexBytes = std::size_t{1} << 16;
constexpr const char* kCompression = "zstd";
constexpr int kLevel = 1;  // the fastest: the loop may wait

std::string compressed(const std::string& bytes) {
  std::string result(ZSTD_compressBound(bytes.size()), '\0');
  result.resize(ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), kLevel));
  return result;
}

/// Pairs of numbers behind their bytes.
template <typename Pairs>
std::string pairs_of(const Pairs& pairs) {
  Content content;
  for (const auto& [key, value] : pairs) {
    content.number(key).number(value);
  }
  return content.bytes();
}

}  // namespace

Writer::Writer(const std::string& path, std::string_view profile)
    : path_(path), file_(::fdopen(create_file(path), "wb")) {
  if (file_ == nullptr) {
    throw FileError("create", path, errno);
  }
  std::string begin(kMagic);
  append(begin, Op::header, Content().text(profile).text("spikeloop").bytes());
  write(begin);
}

Writer::~Writer() = default;

void Writer::write(std::string_view bytes) {
  require_not_deleted(::fileno(file_.get()), path_);
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size() ||
      std::fflush(file_.get()) != 0) {
    throw FileError("write", path_, errno);
  }
  offset_ += bytes.size();
}

std::uint16_t Writer::add(Channel channel) {
  channels_.push_back({std::move(channel), 0, 0, {}});
  return static_cast<std::uint16_t>(channels_.size() - 1);
}

/// Writes the channel into the chunk, and its schema when no channel before had it.
void Writer::begin(std::uint16_t channel, std::span<const std::byte> message) {
  const Channel& written = channels_[channel].channel;
  const std::string schema = Content()
                                 .text(written.type)
                                 .text(written.definition_encoding)
                                 .text(written.definition(message))
                                 .bytes();
  const auto known = std::ranges::find(schemas_, schema);
  channels_[channel].schema = static_cast<std::uint16_t>(known - schemas_.begin() + 1);
  if (known == schemas_.end()) {
    schemas_.push_back(schema);
    append(chunk_, Op::schema, Content().number(channels_[channel].schema).raw(schema).bytes());
  }
  append(chunk_, Op::channel, channel_record(channel));
}

std::string Writer::channel_record(std::uint16_t channel) const {
  const Known& known = channels_[channel];
  Content metadata;
  for (const auto& [key, value] : known.channel.metadata) {
    metadata.text(key).text(value);
  }
  return Content()
      .number(channel)
      .number(known.schema)
      .text(known.channel.topic)
      .text(known.channel.encoding)
      .text(metadata.bytes())
      .bytes();
}

void Writer::take(std::uint16_t channel, TimeNs time, std::span<const std::byte> message) {
  if (chunk_.empty()) {
    chunk_begun_ = std::chrono::steady_clock::now();
  }
  Known& known = channels_[channel];
  const auto stamp = static_cast<std::uint64_t>(time);
  if (known.schema == 0) {
    begin(channel, message);
  }
  const bool is_first =
      std::ranges::all_of(channels_, [](const Known& one) { return one.in_chunk.empty(); });
  first_ = is_first ? stamp : std::min(first_, stamp);
  last_ = is_first ? stamp : std::max(last_, stamp);
  known.in_chunk.emplace_back(stamp, chunk_.size());
  append(chunk_, Op::message,
         Content()
             .number(channel)
             .number(known.messages++)
             .number(stamp)
             .number(stamp)
             .raw(as_text(message))
             .bytes());
  if (chunk_.size() >= kChunkBytes) {
    flush();
  }
}

void Writer::flush_when_older(std::chrono::milliseconds age) {
  if (std::chrono::steady_clock::now() - chunk_begun_ >= age) {
    flush();
  }
}

void Writer::flush() {
  if (chunk_.empty()) {
    return;
  }
  const std::string packed = compressed(chunk_);
  const std::uint64_t size = chunk_.size();
  std::string records;
  append(records, Op::chunk,
         Content()
             .number(first_)
             .number(last_)
             .number(size)
             .number(checksum(chunk_))
             .text(kCompression)
             .text<std::uint64_t>(packed)
             .bytes());
  const std::uint64_t length = records.size();
  std::map<std::uint16_t, std::uint64_t> indexes;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    auto& entries = channels_[i].in_chunk;
    if (!entries.empty()) {
      const auto id = static_cast<std::uint16_t>(i);
      indexes[id] = offset_ + records.size();
      append(records, Op::message_index, Content().number(id).text(pairs_of(entries)).bytes());
      entries.clear();
    }
  }
  append(index_, Op::chunk_index,
         Content()
             .number(first_)
             .number(last_)
             .number(offset_)
             .number(length)
             .text(pairs_of(indexes))
             .number(records.size() - length)
             .text(kCompression)
             .number(static_cast<std::uint64_t>(packed.size()))
             .number(size)
             .bytes());
  write(records);
  begin_ = chunks_ == 0 ? first_ : std::min(begin_, first_);
  end_ = std::max(end_, last_);
  ++chunks_;
  chunk_.clear();
  if (index_.size() >= kIndexBytes) {
    spill_index();
  }
}

void Writer::spill_index() {
  errno = 0;
  if (!index_file_) {
    const std::string path = path_ + ".index";
    std::remove(path.c_str());
    index_file_.reset(std::fopen(path.c_str(), "w+bx"));
    if (!index_file_) {
      throw FileError("create", path, errno);
    }
    std::remove(path.c_str());
  }
  if (std::fwrite(index_.data(), 1, index_.size(), index_file_.get()) != index_.size() ||
      std::fflush(index_file_.get()) != 0) {
    throw FileError("write", path_ + ".index", errno);
  }
  index_.clear();
}

std::string Writer::chunk_index() {
  if (!index_file_) {
    return index_;
  }
  spill_index();
  const long size = std::ftell(index_file_.get());
  std::rewind(index_file_.get());
  std::string records(static_cast<std::size_t>(std::max(size, 0L)), '\0');
  errno = 0;
  if (std::fread(records.data(), 1, records.size(), index_file_.get()) != records.size()) {
    throw FileError("read", path_ + ".index", errno);
  }
  return records;
}

void Writer::attach(std::string_view name, std::string_view media_type, std::string_view contents) {
  flush();
  constexpr std::uint64_t kTime = 0;
  Content content;
  content.number(kTime).number(kTime).text(name).text(media_type).text<std::uint64_t>(contents);
  content.number(checksum(content.bytes()));
  std::string record;
  append(record, Op::attachment, content.bytes());
  attachment_indexes_.push_back(Content()
                                    .number(offset_)
                                    .number(static_cast<std::uint64_t>(record.size()))
                                    .number(kTime)
                                    .number(kTime)
                                    .number(static_cast<std::uint64_t>(contents.size()))
                                    .text(name)
                                    .text(media_type)
                                    .bytes());
  write(record);
}

std::string Writer::statistics() const {
  std::uint64_t messages = 0;
  std::map<std::uint16_t, std::uint64_t> counts;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (channels_[i].messages != 0) {
      counts[static_cast<std::uint16_t>(i)] = channels_[i].messages;
      messages += channels_[i].messages;
    }
  }
  return Content()
      .number(messages)
      .number(static_cast<std::uint16_t>(schemas_.size()))
      .number(static_cast<std::uint32_t>(counts.size()))
      .number(static_cast<std::uint32_t>(attachment_indexes_.size()))
      .number(std::uint32_t{0})  // metadata records
      .number(chunks_)
      .number(begin_)
      .number(end_)
      .text(pairs_of(counts))
      .bytes();
}

std::string Writer::summary(Op op) {
  std::string records;
  if (op == Op::schema) {
    for (std::uint16_t id = 1; const std::string& schema : schemas_) {
      append(records, op, Content().number(id++).raw(schema).bytes());
    }
  } else if (op == Op::channel) {
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      if (channels_[i].schema != 0) {
        append(records, op, channel_record(static_cast<std::uint16_t>(i)));
      }
    }
  } else if (op == Op::statistics) {
    append(records, op, statistics());
  } else if (op == Op::chunk_index) {
    records = chunk_index();
  } else if (op == Op::attachment_index) {
    for (const std::string& record : attachment_indexes_) {
      append(records, op, record);
    }
  }
  return records;
}

/// The summary in groups of one opcode, where these begin, and the footer.
std::string Writer::end() {
  std::string records;
  std::string groups;
  for (const Op op :
       {Op::schema, Op::channel, Op::statistics, Op::chunk_index, Op::attachment_index}) {
    const std::uint64_t begin = records.size();
    records += summary(op);
    if (records.size() != begin) {
      append(groups, Op::summary_offset,
             Content().number(op).number(offset_ + begin).number(records.size() - begin).bytes());
    }
  }
  const std::uint64_t groups_begin = offset_ + records.size();
  records += groups;
  // The footer ends with the checksum of everything from the summary on.
  constexpr std::uint64_t kFooterLength = 20;
  records += Content()
                 .number(Op::footer)
                 .number(kFooterLength)
                 .number(offset_)
                 .number(groups_begin)
                 .bytes();
  return Content().raw(records).number(checksum(records)).raw(kMagic).bytes();
}

void Writer::close() {
  flush();
  std::string data_end;
  append(data_end, Op::data_end, Content().number(std::uint32_t{0}).bytes());  // 0: no checksum
  write(data_end);
  write(end());
  if (std::fclose(file_.release()) != 0) {
    throw FileError("write", path_, errno);
  }
}

}  // namespace spikeloop::bag::mcap
