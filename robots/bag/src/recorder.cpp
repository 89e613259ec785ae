#include "spikeloop/bag/recorder.hpp"

#include <fmt/format.h>
#include <rosbag/bag.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "raw_message.hpp"
#include "spikeloop/core/background.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"

namespace spikeloop::bag {
namespace {

/// What a killed process loses at most, beside what waits: `rosbag reindex` leaves a chunk out that
/// was not ended.
constexpr std::uint32_t kChunkBytes = 1 << 16;

struct Route {
  Topic topic;
  MessageType type;
  boost::shared_ptr<ros::M_string> header;
};

struct Item {
  std::uint32_t connection = 0;
  TimeNs time = 0;
  std::vector<std::byte> bytes;
};

Route route_of(const Topic& topic) {
  const auto& catalog = messages::Catalog::for_type(messages::Dialect::ros1, topic.type);
  const std::string name = catalog.full_name(topic.type);
  Route connection{topic, {name, catalog.md5(name), catalog.full_text(name)}, {}};
  const auto& type = connection.type;
  connection.header =
      boost::make_shared<ros::M_string>(ros::M_string{{"type", type.name},
                                                      {"md5sum", type.md5},
                                                      {"message_definition", type.definition},
                                                      {"callerid", "/spikeloop/" + topic.node},
                                                      {kNodeField, topic.node}});
  return connection;
}

}  // namespace

struct Recorder::Impl {
  Impl(const std::string& path_, const RecorderOptions& options_)
      : path(path_), options(options_) {}

  void run();
  void write(const std::vector<Item>& batch);
  void finish();
  void forsake_bag();
  template <typename Work>
  void attempt(Work&& work);
  void fail(const std::string& text);
  std::string loss() const;

  std::string path;
  RecorderOptions options;
  std::unique_ptr<rosbag::Bag> bag;

  std::mutex mutex;  // held for a swap or an append
  std::condition_variable filled;
  std::condition_variable emptied;
  std::vector<std::shared_ptr<const Route>> connections;
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
  make_empty_file(path);
  impl_->bag = std::make_unique<rosbag::Bag>();
  try {
    impl_->bag->open(path, rosbag::bagmode::Write);
    impl_->bag->setChunkThreshold(kChunkBytes);
  } catch (const rosbag::BagException& error) {
    impl_->forsake_bag();
    throw FileError(with_code(Code::no_access, "cannot write '{}': {}", path, error.what()));
  }
  impl_->writer = background_thread([impl = impl_.get()] { impl->run(); });
}

Recorder::~Recorder() {
  close();
}

std::uint32_t Recorder::add(const Topic& topic) {
  const auto connection = std::make_shared<const Route>(route_of(topic));
  const std::lock_guard lock(impl_->mutex);
  impl_->connections.push_back(connection);
  return static_cast<std::uint32_t>(impl_->connections.size() - 1);
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
  while (!stop || !waiting.empty()) {
    filled.wait(lock, [&] { return stop || !waiting.empty(); });
    batch.swap(waiting);
    waiting_bytes = 0;
    emptied.notify_all();
    lock.unlock();
    write(batch);
    batch.clear();
    lock.lock();
  }
  lock.unlock();
  finish();
}

/// The first thing that goes wrong is kept in `failure`; the bag is not touched any more.
template <typename Work>
void Recorder::Impl::attempt(Work&& work) {
  errno = 0;
  try {
    work();
  } catch (const rosbag::BagIOException& error) {
    fail(errno == 0 ? with_code(Code::no_access, "cannot write '{}': {}", path, error.what())
                    : std::string(FileError("write", path, errno).what()));
  } catch (const std::exception& error) {
    fail(with_code(Code::no_access, "cannot write '{}': {}", path, error.what()));
  }
}

void Recorder::Impl::fail(const std::string& text) {
  const std::lock_guard lock(mutex);
  failure = failure.empty() ? text : failure;
  emptied.notify_all();
}

void Recorder::Impl::write(const std::vector<Item>& batch) {
  std::uint64_t good = 0;
  std::vector<std::shared_ptr<const Route>> known;
  bool broken = false;
  {
    const std::lock_guard lock(mutex);
    known = connections;
    broken = !failure.empty();
  }
  if (!broken) {
    attempt([&] {
      for (const Item& item : batch) {
        const Route& connection = *known.at(item.connection);
        ros::Time stamp;
        stamp.fromNSec(static_cast<std::uint64_t>(stamp_of(item.time)));
        bag->write(connection.topic.name, stamp, RawMessage{connection.type, item.bytes},
                   connection.header);
        ++good;
      }
    });
  }
  const std::lock_guard lock(mutex);
  written += good;
  dropped += batch.size() - good;
}

void Recorder::Impl::finish() {
  attempt([&] { bag->close(); });
  if (!failure.empty()) {
    forsake_bag();
  }
}

/// A bag that could not be written tries it once more in its destructor, and ends the process by
/// what it throws there: it is never destroyed.
void Recorder::Impl::forsake_bag() {
  static std::mutex guard;
  static auto& forsaken = *new std::vector<std::unique_ptr<rosbag::Bag>>;
  const std::lock_guard lock(guard);
  forsaken.push_back(std::move(bag));
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
