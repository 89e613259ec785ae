#include "spikeloop/bag/reader.hpp"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "mcap_format.hpp"
#include "source.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"

namespace spikeloop::bag {
namespace {

/// Spikes and signals in the file of a run, always in CDR.
constexpr std::string_view kOwnTypes = "spikeloop/";

constexpr std::string_view kRos1Magic = "#ROSBAG V";

/// As rosbag2 writes them.
[[noreturn]] void refuse_folder(const std::string& folder) {
  namespace fs = std::filesystem;
  bool has_sqlite = false;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".mcap") {
      throw FileError(with_code(Code::no_access,
                                "'{}' is a folder; write the path of the recording in it: {}",
                                folder, entry.path().string()));
    }
    has_sqlite |= entry.path().extension() == ".db3";
  }
  throw FileError(with_code(
      Code::no_access, "'{}' is a folder{}; write the path of a .mcap or .bag file", folder,
      has_sqlite
          ? " with a recording in SQLite, which is not read; 'ros2 bag convert' writes MCAP, "
            "and so does 'ros2 bag record --storage mcap'"
          : ""));
}

std::shared_ptr<Source> open(const std::string& path) {
  if (std::filesystem::is_directory(path)) {
    refuse_folder(path);
  }
  require_regular_file(path, "recording");
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::string first(kRos1Magic.size(), '\0');
  file.read(first.data(), static_cast<std::streamsize>(first.size()));
  if (errno != 0) {
    throw FileError("read", path, errno);
  }
  if (first == kRos1Magic) {
    return open_ros1_bag(path);
  }
  if (first.starts_with(mcap::kMagic)) {
    return open_mcap(path);
  }
  throw FileError(with_code(
      Code::no_access,
      "'{}' is neither an MCAP file nor a bag of ROS 1; write the path of a .mcap or .bag file",
      path));
}

}  // namespace

Stream::Stream(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Stream::~Stream() = default;
Stream::Stream(Stream&&) noexcept = default;
Stream& Stream::operator=(Stream&&) noexcept = default;

std::optional<Message> Stream::next() {
  return impl_->next();
}

Reader::Reader(const std::string& path) : source_(open(path)) {}
Reader::~Reader() = default;

bool Reader::is_of_a_run() const {
  return source_->is_of_a_run();
}

const std::vector<Connection>& Reader::connections() const {
  return source_->connections();
}

messages::Dialect Reader::dialect() const {
  const auto is_ros2 = [](const Connection& one) {
    return one.dialect == messages::Dialect::ros2 && !one.type.starts_with(kOwnTypes);
  };
  return std::ranges::any_of(connections(), is_ros2) ? messages::Dialect::ros2
                                                     : messages::Dialect::ros1;
}

TimeNs Reader::end() const {
  return source_->end();
}

std::optional<TimeNs> Reader::end_of(const std::string& topic) const {
  return source_->end_of(topic);
}

Stream Reader::stream(const std::string& topic, const std::string& node) const {
  std::vector<std::size_t> of_topic;
  std::vector<std::size_t> of_node;
  for (std::size_t i = 0; i < connections().size(); ++i) {
    if (connections()[i].topic == topic) {
      of_topic.push_back(i);
      if (connections()[i].node == node) {
        of_node.push_back(i);
      }
    }
  }
  if (is_of_a_run() && !of_topic.empty()) {
    of_topic = of_node.empty() ? std::vector{of_topic.front()} : of_node;
  }
  return Stream(source_->stream(std::move(of_topic)));
}

}  // namespace spikeloop::bag
