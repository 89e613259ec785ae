// Bags of ROS 1, by its own library.
#include <fmt/format.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <set>

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
  TimeNs begin = 0;

  TimeNs time(const ros::Time& stamp) const { return static_cast<TimeNs>(stamp.toNSec()) - begin; }
};

struct Ros1Stream : Stream::Impl {
  explicit Ros1Stream(std::shared_ptr<const Opened> whose) : opened(std::move(whose)) {}

  std::optional<Message> next() override {
    return reading(opened->path, [&]() -> std::optional<Message> {
      if (!begun) {
        at = view.begin();
        begun = true;
      } else if (at != view.end()) {
        ++at;
      }
      if (at == view.end()) {
        return std::nullopt;
      }
      const rosbag::MessageInstance& message = *at;
      bytes.clear();
      ByteSink sink{&bytes};
      message.write(sink);
      return Message{opened->time(message.getTime()), bytes};
    });
  }

  std::shared_ptr<const Opened> opened;
  rosbag::View view;
  rosbag::View::iterator at;
  bool begun = false;
  std::vector<std::byte> bytes;
};

class Ros1Bag : public Source {
 public:
  explicit Ros1Bag(const std::string& path) {
    opened_->path = path;
    reading(path, [&] { open(path); });
  }

  std::optional<TimeNs> end_of(const std::string& topic) override {
    return reading(opened_->path, [&]() -> std::optional<TimeNs> {
      rosbag::View view(opened_->bag, rosbag::TopicQuery(topic));
      if (view.size() == 0) {
        return std::nullopt;
      }
      return opened_->time(view.getEndTime());
    });
  }

  std::unique_ptr<Stream::Impl> stream(std::vector<std::size_t> connections) override {
    std::set<std::uint32_t> ids;
    for (const std::size_t connection : connections) {
      ids.insert(ids_.at(connection));
    }
    auto stream = std::make_unique<Ros1Stream>(opened_);
    reading(opened_->path, [&] {
      stream->view.addQuery(opened_->bag, [ids](const rosbag::ConnectionInfo* info) {
        return ids.contains(info->id);
      });
    });
    return stream;
  }

 private:
  void open(const std::string& path) {
    if (!check_structure(path)) {
      throw rosbag::BagUnindexedException();
    }
    try_in_a_copy(path, "rosbag", [&] {
      rosbag::Bag bag(path, rosbag::bagmode::Read);
      const rosbag::View view(bag);
    });
    opened_->bag.open(path, rosbag::bagmode::Read);
    rosbag::View view(opened_->bag);
    for (const rosbag::ConnectionInfo* info : view.getConnections()) {
      connections_.push_back({.topic = info->topic,
                              .type = info->datatype,
                              .encoding = "ros1",
                              .dialect = messages::Dialect::ros1,
                              .version = info->md5sum,
                              .schema = {std::string(messages::kRos1), info->datatype,
                                         std::string(messages::kRos1Definition), info->msg_def}});
      ids_.push_back(info->id);
    }
    if (view.size() > 0) {
      opened_->begin = static_cast<TimeNs>(view.getBeginTime().toNSec());
      end_ = opened_->time(view.getEndTime());
    }
  }

  std::shared_ptr<Opened> opened_ = std::make_shared<Opened>();
  std::vector<std::uint32_t> ids_;  ///< of the connections, as rosbag numbers them
};

}  // namespace

std::shared_ptr<Source> open_ros1_bag(const std::string& path) {
  return std::make_shared<Ros1Bag>(path);
}

}  // namespace spikeloop::bag
