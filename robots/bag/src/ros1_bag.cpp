// Bags of ROS 1, by its own library.
#include <fmt/format.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <map>

#include "source.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/processes/trial.hpp"
#include "structure.hpp"

namespace spikeloop::bag {
namespace {

/// While it lives, rosbag prints nothing of what it throws as well.
class Quiet {
 public:
  Quiet() : before_(console_bridge::getLogLevel()) {
    console_bridge::setLogLevel(console_bridge::CONSOLE_BRIDGE_LOG_NONE);
  }
  ~Quiet() { console_bridge::setLogLevel(before_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  console_bridge::LogLevel before_;
};

/// What rosbag throws as an error of ours. A damaged file gives any exception.
template <typename Work>
auto reading(const std::string& path, Work&& work) {
  const Quiet quiet;
  try {
    return work();
  } catch (const Error&) {
    throw;
  } catch (const rosbag::BagUnindexedException&) {
    throw FileError(with_code(
        Code::no_access,
        "'{0}' has no index, because its recording was not ended; write  rosbag reindex {0}",
        path));
  } catch (const std::exception& error) {
    throw FileError(with_code(Code::no_access,
                              "'{}' is damaged: {}; 'rosbag check' and 'rosbag reindex' may help",
                              path, error.what()));
  }
}

/// MessageInstance writes itself into this.
struct ByteSink {
  std::vector<std::byte>* bytes;
  std::uint8_t* advance(std::size_t size) const {
    bytes->resize(size);
    return reinterpret_cast<std::uint8_t*>(bytes->data());
  }
};

struct Opened {
  std::string path;
  rosbag::Bag bag;
  std::vector<rosbag::MessageInstance> messages;  ///< a Place's position is an index
};

class Ros1Bytes : public Bytes {
 public:
  explicit Ros1Bytes(std::shared_ptr<const Opened> opened) : opened_(std::move(opened)) {}

  std::span<const std::byte> read(const Place& place) override {
    return reading(opened_->path, [&] {
      bytes_.clear();
      ByteSink sink{&bytes_};
      opened_->messages[place.position].write(sink);
      return std::span<const std::byte>(bytes_);
    });
  }

 private:
  std::shared_ptr<const Opened> opened_;
  std::vector<std::byte> bytes_;
};

class Ros1Bag : public Source {
 public:
  Ros1Bag(const std::string& path, const std::string& name) : Source(name) {
    opened_->path = name;
    reading(name, [&] { open(path); });
  }

  std::unique_ptr<Bytes> bytes() const override { return std::make_unique<Ros1Bytes>(opened_); }

 private:
  void open(const std::string& path) {
    BagStructure structure = check_structure(path);
    if (!structure.has_index) {
      throw rosbag::BagUnindexedException();
    }
    try_in_a_copy(path, "rosbag", [&] {
      rosbag::Bag bag(path, rosbag::bagmode::Read);
      const rosbag::View view(bag);
    });
    opened_->bag.open(path, rosbag::bagmode::Read);
    rosbag::View view(opened_->bag);
    // Connections are told apart by the address of their topic: a message has no other access.
    std::map<const std::string*, std::uint32_t> indexes;
    std::vector<std::vector<BagPosition>> positions;
    for (const rosbag::ConnectionInfo* info : view.getConnections()) {
      indexes[&info->topic] = static_cast<std::uint32_t>(connections_.size());
      positions.push_back(std::move(structure.positions[info->id]));
      connections_.push_back({.topic = info->topic,
                              .type = info->datatype,
                              .encoding = std::string(messages::kRos1),
                              .dialect = messages::Dialect::ros1,
                              .version = info->md5sum,
                              .schema = {std::string(messages::kRos1), info->datatype,
                                         std::string(messages::kRos1Definition), info->msg_def}});
    }
    for (const rosbag::MessageInstance& message : view) {
      places_.push_back({static_cast<TimeNs>(message.getTime().toNSec()),
                         indexes.at(&message.getTopic()), 0, opened_->messages.size()});
      opened_->messages.push_back(message);
    }
    sort_as_recorded(std::move(positions));
  }

  /// rosbag gives the messages by time. Messages of a connection at the same time stay in order, so
  /// that the n-th one is the n-th of the index by time.
  void sort_as_recorded(std::vector<std::vector<BagPosition>> positions) {
    using Key = std::pair<std::uint64_t, std::uint32_t>;
    std::vector<std::pair<Key, Place>> keyed;
    std::vector<std::size_t> used(positions.size());
    for (auto& of_connection : positions) {
      std::ranges::stable_sort(of_connection, {}, [](const BagPosition& one) {
        return std::pair(one.seconds, one.nanoseconds);
      });
    }
    for (const Place& place : places_) {
      const auto& of_connection = positions[place.connection];
      if (used[place.connection] == of_connection.size()) {
        return;  // an older format: by time
      }
      const BagPosition& at = of_connection[used[place.connection]++];
      keyed.emplace_back(Key{at.chunk, at.offset}, place);
    }
    std::ranges::stable_sort(keyed, {}, &std::pair<Key, Place>::first);
    std::ranges::transform(keyed, places_.begin(), &std::pair<Key, Place>::second);
  }

  std::shared_ptr<Opened> opened_ = std::make_shared<Opened>();
};

}  // namespace

std::unique_ptr<Source> open_ros1_bag(const std::string& path, const std::string& name) {
  return std::make_unique<Ros1Bag>(path, name);
}

}  // namespace spikeloop::bag
