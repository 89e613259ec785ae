#include "spikeloop/bag/reader.hpp"

#include <fmt/format.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <string_view>

#include "spikeloop/bag/recorder.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/processes/trial.hpp"
#include "structure.hpp"

namespace spikeloop::bag {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V";

/// rosbag gives no reason of the system's, and takes any file for a damaged bag.
void check_magic(const std::string& path) {
  require_regular_file(path, "bag");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string first(kMagic.size(), '\0');
  file.read(first.data(), static_cast<std::streamsize>(first.size()));
  if (errno != 0) {
    throw FileError("read", path, errno);
  }
  if (first != kMagic) {
    throw FileError(with_code(
        Code::no_access,
        "'{}' is not a bag of ROS 1: it does not begin with {}; write the path of a .bag that "
        "'rosbag info' reads (bags of ROS 2 are not in this version)",
        path, kMagic));
  }
}

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

struct Opened {
  std::string path;
  rosbag::Bag bag;
  TimeNs offset = 0;
  bool of_a_run = false;
};

TimeNs time_in(const Opened& opened, const ros::Time& stamp) {
  const auto time = static_cast<TimeNs>(stamp.toNSec());
  return opened.of_a_run ? simulated_of(time) : time - opened.offset;
}

std::string node_of(const rosbag::ConnectionInfo& connection) {
  const auto found = connection.header->find(kNodeField);
  return found == connection.header->end() ? "" : found->second;
}

/// MessageInstance writes itself into this.
struct ByteSink {
  std::vector<std::byte>* bytes;
  std::uint8_t* advance(std::size_t size) const {
    bytes->resize(size);
    return reinterpret_cast<std::uint8_t*>(bytes->data());
  }
};

}  // namespace

struct Stream::Impl {
  std::shared_ptr<Opened> opened;
  rosbag::View view;
  rosbag::View::iterator at;
  bool begun = false;
  std::vector<std::byte> bytes;
};

Stream::Stream(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Stream::~Stream() = default;
Stream::Stream(Stream&&) noexcept = default;
Stream& Stream::operator=(Stream&&) noexcept = default;

std::optional<Message> Stream::next() {
  Impl& stream = *impl_;
  return reading(stream.opened->path, [&]() -> std::optional<Message> {
    if (stream.begun) {
      if (stream.at != stream.view.end()) {
        ++stream.at;
      }
    } else {
      stream.at = stream.view.begin();
      stream.begun = true;
    }
    if (stream.at == stream.view.end()) {
      return std::nullopt;
    }
    const rosbag::MessageInstance& message = *stream.at;
    stream.bytes.clear();
    ByteSink sink{&stream.bytes};
    message.write(sink);
    return Message{time_in(*stream.opened, message.getTime()), stream.bytes};
  });
}

struct Reader::Impl {
  std::shared_ptr<Opened> opened = std::make_shared<Opened>();
  std::vector<Connection> connections;
  std::vector<std::uint32_t> ids;  ///< of the connections, as rosbag numbers them
  TimeNs end = 0;
};

Reader::Reader(const std::string& path) : impl_(std::make_unique<Impl>()) {
  check_magic(path);
  Opened& opened = *impl_->opened;
  opened.path = path;
  reading(path, [&] {
    if (!check_structure(path)) {
      throw rosbag::BagUnindexedException();
    }
    try_in_a_copy(path, "rosbag", [&] {
      rosbag::Bag bag(path, rosbag::bagmode::Read);
      const rosbag::View view(bag);
    });
    opened.bag.open(path, rosbag::bagmode::Read);
    rosbag::View view(opened.bag);
    for (const rosbag::ConnectionInfo* info : view.getConnections()) {
      impl_->connections.push_back({info->topic, info->datatype, info->md5sum, node_of(*info)});
      impl_->ids.push_back(info->id);
    }
    opened.of_a_run =
        std::ranges::all_of(impl_->connections, [](const auto& one) { return !one.node.empty(); });
    if (view.size() > 0) {
      opened.offset = static_cast<TimeNs>(view.getBeginTime().toNSec());
      impl_->end = time_in(opened, view.getEndTime());
    }
  });
}

Reader::~Reader() = default;

bool Reader::is_of_a_run() const {
  return impl_->opened->of_a_run;
}

const std::vector<Connection>& Reader::connections() const {
  return impl_->connections;
}

TimeNs Reader::end() const {
  return impl_->end;
}

std::optional<TimeNs> Reader::end_of(const std::string& topic) const {
  return reading(impl_->opened->path, [&]() -> std::optional<TimeNs> {
    rosbag::View view(impl_->opened->bag, rosbag::TopicQuery(topic));
    if (view.size() == 0) {
      return std::nullopt;
    }
    return time_in(*impl_->opened, view.getEndTime());
  });
}

Stream Reader::stream(const std::string& topic, const std::string& node) const {
  std::vector<std::uint32_t> of_topic;
  std::vector<std::uint32_t> of_node;
  for (std::size_t i = 0; i < impl_->ids.size(); ++i) {
    const Connection& connection = impl_->connections[i];
    if (connection.topic == topic) {
      of_topic.push_back(impl_->ids[i]);
      if (connection.node == node) {
        of_node.push_back(impl_->ids[i]);
      }
    }
  }
  if (is_of_a_run() && !of_topic.empty()) {
    of_topic = of_node.empty() ? std::vector{std::ranges::min(of_topic)} : of_node;
  }
  auto stream = std::make_unique<Stream::Impl>();
  stream->opened = impl_->opened;
  reading(impl_->opened->path, [&] {
    stream->view.addQuery(impl_->opened->bag, [of_topic](const rosbag::ConnectionInfo* info) {
      return std::ranges::find(of_topic, info->id) != of_topic.end();
    });
  });
  return Stream(std::move(stream));
}

}  // namespace spikeloop::bag
