// A camera and a witness on another vendor's DDS: publishes pictures on /eye/image_raw, and hears
// every message of /cmd_vel, /scan and /odom, whatever is lost elsewhere.
//
//     fastdds_witness DOMAIN WIDTH HEIGHT RATE
//
// Lines of its standard input lead it:
//
//     known      answers "known PUBLISHERS SUBSCRIBERS", of /cmd_vel and of the pictures
//     send N     sends so many pictures, RATE a second, and says "sent N"
//     heard      answers "heard TOPIC COUNT FIRST LAST" for every publisher it has heard: its
//                messages, and the numbers that the publisher has given the first and the last of
//                them, from 1
//
// It ends with its input.
#include <chrono>
#include <iostream>
#include <map>
#include <mutex>
#include <thread>

#include "tests/ros2/fastdds_node.hpp"

namespace fastdds_peer {
namespace {

using Clock = std::chrono::steady_clock;

/// Commands of some seconds, when the machine leaves no time to take them.
constexpr std::uint32_t kSocketBytes = 4'000'000;

/// Messages of a topic, publisher by publisher.
class Tally {
 public:
  void add(const SampleInfo& info) {
    const std::uint64_t number = info.sample_identity.sequence_number().to64long();
    const std::lock_guard<std::mutex> lock(mutex_);
    Heard& heard =
        by_writer_.try_emplace(info.sample_identity.writer_guid(), Heard{0, number, number})
            .first->second;
    ++heard.count;
    heard.last = std::max(heard.last, number);
  }
  void tell(const char* topic) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto& [writer, heard] : by_writer_) {
      std::cout << "heard " << topic << ' ' << heard.count << ' ' << heard.first << ' '
                << heard.last << '\n';
    }
  }

 private:
  struct Heard {
    std::uint64_t count, first, last;
  };
  mutable std::mutex mutex_;
  std::map<eprosima::fastrtps::rtps::GUID_t, Heard> by_writer_;
};

template <typename Message>
class Witness {
 public:
  Witness(Peer& peer, const char* topic)
      : peer_(peer),
        topic_(topic),
        listener_([this](const Message&, const SampleInfo& info) { tally_.add(info); }) {
    reader_ = peer.subscriber()->create_datareader(
        peer.topic<Message>((std::string("rt") + topic).c_str()), every_message_qos(), &listener_);
  }
  ~Witness() { peer_.subscriber()->delete_datareader(reader_); }

  void tell() const { tally_.tell(topic_); }
  int publishers() const {
    SubscriptionMatchedStatus status;
    reader_->get_subscription_matched_status(status);
    return status.current_count;
  }

 private:
  Peer& peer_;
  const char* topic_;
  Tally tally_;
  Listener<Message> listener_;
  DataReader* reader_ = nullptr;
};

class Camera {
 public:
  Camera(Peer& peer, std::uint32_t width, std::uint32_t height, double rate_hz)
      : period_(std::chrono::duration_cast<Clock::duration>(
            std::chrono::duration<double>(1 / rate_hz))) {
    DataWriterQos qos = endpoint_qos(DATAWRITER_QOS_DEFAULT);
    qos.publish_mode().kind = ASYNCHRONOUS_PUBLISH_MODE;  // a picture is many packets
    writer_ = peer.publisher()->create_datawriter(peer.topic<Image>("rt/eye/image_raw"), qos);
    picture_.frame_id = "eye";
    picture_.width = width;
    picture_.height = height;
    picture_.encoding = "rgb8";
    picture_.step = 3 * width;
    picture_.data.resize(std::size_t{3} * width * height);
  }

  int subscribers() const {
    PublicationMatchedStatus status;
    writer_->get_publication_matched_status(status);
    return status.current_count;
  }
  void send(int count) {
    auto due = Clock::now();
    for (int number = 0; number < count; ++number) {
      draw(number);
      writer_->write(&picture_);
      due += period_;
      std::this_thread::sleep_until(due);
    }
  }

 private:
  /// Stripes that go down the picture.
  void draw(int number) {
    picture_.sec = number;
    for (std::uint32_t row = 0; row < picture_.height; ++row) {
      const auto begin = picture_.data.begin() + static_cast<std::ptrdiff_t>(row) * picture_.step;
      std::fill(begin, begin + picture_.step, static_cast<std::uint8_t>(2 * row - 4 * number));
    }
  }

  Clock::duration period_;
  DataWriter* writer_ = nullptr;
  Image picture_;
};

int run(int argc, char** argv) {
  if (argc != 5) {
    throw std::runtime_error("write fastdds_witness DOMAIN WIDTH HEIGHT RATE");
  }
  // Without shared memory, which a killed process would leave behind.
  DomainParticipantQos qos = participant_qos("udp");
  qos.transport().listen_socket_buffer_size = kSocketBytes;
  Peer peer(static_cast<std::uint32_t>(std::stoi(argv[1])), qos);
  const Witness<Twist> commands(peer, "/cmd_vel");
  const Witness<LaserScan> scans(peer, "/scan");
  const Witness<Odometry> odometry(peer, "/odom");
  Camera camera(peer, static_cast<std::uint32_t>(std::stoi(argv[2])),
                static_cast<std::uint32_t>(std::stoi(argv[3])), std::stod(argv[4]));
  std::cout << "ready" << std::endl;
  for (std::string word; std::cin >> word;) {
    if (word == "known") {
      std::cout << "known " << commands.publishers() << ' ' << camera.subscribers() << std::endl;
    } else if (word == "heard") {
      commands.tell();
      scans.tell();
      odometry.tell();
      std::cout << "all" << std::endl;
    } else if (int count = 0; word == "send" && std::cin >> count) {
      camera.send(count);
      std::cout << "sent " << count << std::endl;
    } else {
      refuse_word(word);
    }
  }
  return 0;
}

}  // namespace
}  // namespace fastdds_peer

int main(int argc, char** argv) {
  return fastdds_peer::run_program("fastdds_witness", fastdds_peer::run, argc, argv);
}
