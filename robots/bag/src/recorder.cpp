#include "spikeloop/bag/recorder.hpp"

#include <fmt/format.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "mcap_writer.hpp"
#include "spikeloop/core/background.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop::bag {
namespace {

/// What a killed process loses at most, beside what waits.
constexpr std::chrono::milliseconds kLongestChunk{500};

struct Attachment {
  std::string name;
  std::string media_type;
  std::string contents;
};

struct Item {
  std::uint32_t connection = 0;
  TimeNs time = 0;
  std::vector<std::byte> bytes;
};

}  // namespace

struct Recorder::Impl {
  Impl(const std::string& path_, const RecorderOptions& options_)
      : path(path_), options(options_), file(path_, "") {}

  using Definition = std::function<std::string(std::span<const std::byte>)>;

  std::uint32_t add(const Channel& channel, Definition definition);
  void run();
  void write_fresh();
  void write(const std::vector<Item>& batch);
  template <typename Work>
  void attempt(Work&& work);
  std::string loss() const;

  const std::string path;
  const RecorderOptions options;
  mcap::Writer file;  // by the writer alone

  std::mutex mutex;  // held for a swap or an append
  std::condition_variable filled;
  std::condition_variable emptied;
  std::vector<mcap::Channel> fresh;     // that the writer does not know yet
  std::vector<Attachment> attachments;  // the same
  std::uint32_t channels = 0;
  std::vector<Item> waiting;
  std::size_t waiting_bytes = 0;
  std::uint64_t dropped = 0;
  std::uint64_t written = 0;
  std::string failure;
  bool stop = false;
  std::thread writer;
};

Recorder::Recorder(const std::string& path, const RecorderOptions& options)
    : impl_(std::make_unique<Impl>(path, options)) {
  impl_->writer = background_thread([impl = impl_.get()] { impl->run(); });
}

Recorder::~Recorder() {
  close();
}

std::uint32_t Recorder::add(const Topic& topic) {
  const messages::Schema schema = messages::schema_of(topic.dialect, topic.type);
  const auto& catalog = messages::Catalog::for_type(topic.dialect, topic.type);
  const auto type = catalog.layout(catalog.full_name(topic.type));
  return impl_->add({topic.name, schema, topic.node}, [schema, type](auto message) {
    return messages::definition_for(schema, *type, message);
  });
}

std::uint32_t Recorder::add_channel(const Channel& channel) {
  return impl_->add(channel, [text = channel.schema.definition](auto /*message*/) { return text; });
}

std::uint32_t Recorder::Impl::add(const Channel& channel, Definition definition) {
  const messages::Schema& schema = channel.schema;
  const std::lock_guard lock(mutex);
  fresh.push_back({channel.topic,
                   schema.encoding,
                   schema.type,
                   schema.definition_encoding,
                   std::move(definition),
                   {{kNodeField, channel.node}}});
  return channels++;
}

void Recorder::attach(const std::string& name, const std::string& media_type,
                      std::string contents) {
  const std::lock_guard lock(impl_->mutex);
  impl_->attachments.push_back({name, media_type, std::move(contents)});
}

void Recorder::take(std::uint32_t connection, TimeNs simulated,
                    std::span<const std::byte> message) {
  Item item{connection, simulated, {message.begin(), message.end()}};
  std::unique_lock lock(impl_->mutex);
  const auto has_room = [&] {
    return impl_->waiting.empty() ||
           impl_->waiting_bytes + message.size() <= impl_->options.capacity_bytes;
  };
  if (impl_->options.patient) {
    impl_->emptied.wait(lock, [&] { return has_room() || impl_->stop || !impl_->failure.empty(); });
  }
  if (impl_->stop || !impl_->failure.empty() || !has_room()) {
    ++impl_->dropped;
    return;
  }
  impl_->waiting_bytes += message.size();
  impl_->waiting.push_back(std::move(item));
  if (impl_->waiting.size() == 1) {
    impl_->filled.notify_one();
  }
}

void Recorder::Impl::run() {
  std::vector<Item> batch;
  std::unique_lock lock(mutex);
  const auto has_work = [&] { return stop || !waiting.empty(); };
  while (!stop || !waiting.empty()) {
    if (!filled.wait_for(lock, kLongestChunk, has_work)) {
      lock.unlock();
      attempt([&] { file.flush(); });
      lock.lock();
      continue;
    }
    batch.swap(waiting);
    waiting_bytes = 0;
    emptied.notify_all();
    lock.unlock();
    write(batch);
    batch.clear();
    lock.lock();
  }
  lock.unlock();
  attempt([&] {
    write_fresh();
    file.close();
  });
}

/// The first thing that goes wrong is kept in `failure`; the file is not touched any more.
template <typename Work>
void Recorder::Impl::attempt(Work&& work) {
  {
    const std::lock_guard lock(mutex);
    if (!failure.empty()) {
      return;
    }
  }
  try {
    work();
  } catch (const Error& error) {
    const std::lock_guard lock(mutex);
    failure = error.what();
    if (options.failures != nullptr) {
      options.failures->add(path, failure);
    }
    emptied.notify_all();
  }
}

void Recorder::Impl::write_fresh() {
  std::vector<mcap::Channel> its_channels;
  std::vector<Attachment> its_attachments;
  {
    const std::lock_guard lock(mutex);
    its_channels.swap(fresh);
    its_attachments.swap(attachments);
  }
  for (mcap::Channel& channel : its_channels) {
    file.add(std::move(channel));
  }
  for (const Attachment& attachment : its_attachments) {
    file.attach(attachment.name, attachment.media_type, attachment.contents);
  }
}

void Recorder::Impl::write(const std::vector<Item>& batch) {
  std::uint64_t good = 0;
  attempt([&] {
    write_fresh();
    for (const Item& item : batch) {
      file.take(static_cast<std::uint16_t>(item.connection), item.time, item.bytes);
      ++good;
    }
    file.flush_when_older(kLongestChunk);
  });
  const std::lock_guard lock(mutex);
  written += good;
  dropped += batch.size() - good;
}

std::string Recorder::Impl::loss() const {
  if (!failure.empty()) {
    return lengthened(failure, fmt::format("; {} messages are lost", dropped));
  }
  return dropped == 0 ? ""
                      : fmt::format(
                            "'{}' is incomplete: {} messages are lost, because the disk is "
                            "slower than the data; write to a faster disk",
                            path, dropped);
}

Report Recorder::close() {
  {
    const std::lock_guard lock(impl_->mutex);
    impl_->stop = true;
    impl_->filled.notify_one();
    impl_->emptied.notify_all();
  }
  if (impl_->writer.joinable()) {
    impl_->writer.join();
  }
  return {impl_->written, impl_->dropped, impl_->loss()};
}

}  // namespace spikeloop::bag
