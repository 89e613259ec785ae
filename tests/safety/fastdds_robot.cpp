// A robot, and the person beside it, on another vendor's DDS. A test leads it by lines on its
// standard input:
//
//     scans 1 | 0       ten readings of 3 m on /scan, 50 times a second, or none any more
//     odometry 1 | 0    the same of /odom
//     stop 1 | 0        one message on /emergency_stop
//     manual X          one message on /cmd_vel_manual, whose linear.x is X
//     touch N           one message on /bumper_states, with contacts with things 1 to N
//
// It says "ready", "done T 0" for every line, "button T N" and "driver T N" when /emergency_stop
// has a subscriber and /cmd_vel a publisher more, "scan T 0" for every scan that it has sent,
// "twist T X" for every message on /cmd_vel, and "diagnosis T LEVEL NAME: MESSAGE (KEY VALUE, ...)"
// for every one on /diagnostics: times are CLOCK_MONOTONIC in seconds, X linear.x. It ends with its
// input.
//
//     fastdds_robot DOMAIN
#include <atomic>
#include <chrono>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <iostream>
#include <thread>

#include "spikeloop/core/priority.hpp"
#include "tests/ros2/fastdds_node.hpp"

namespace fastdds_peer {
namespace {

constexpr std::chrono::milliseconds kPeriod{20};

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// What is said once is a line, whichever thread says it.
void say(const char* what, double at, double value) {
  std::printf("%s %.6f %.17g\n", what, at, value);
  std::fflush(stdout);
}

/// Tells when somebody begins to hear it; that somebody was killed is noticed only after twenty
/// seconds.
class Button : public DataWriterListener {
 public:
  void on_publication_matched(DataWriter*, const PublicationMatchedStatus& status) override {
    if (status.current_count_change > 0) {
      say("button", now_s(), status.current_count);
    }
  }
};

/// Hears commands, and tells when somebody begins to send some: a run's process, or its guard.
class Wheels : public Listener<Twist> {
 public:
  Wheels()
      : Listener<Twist>([](const Twist& twist, const SampleInfo&) {
          say("twist", now_s(), twist.values[0]);
        }) {}
  void on_subscription_matched(DataReader*, const SubscriptionMatchedStatus& status) override {
    if (status.current_count_change > 0) {
      say("driver", now_s(), status.current_count);
    }
  }
};

void say_diagnosis(const DiagnosticArray& array, const SampleInfo&) {
  std::string values;
  for (const auto& [key, value] : array.values) {
    values += key + " " + value + ", ";
  }
  std::printf("diagnosis %.6f %d %s: %s (%s)\n", now_s(), array.level, array.name.c_str(),
              array.message.c_str(), values.c_str());
  std::fflush(stdout);
}

/// Sends its sensors' messages in a thread of its own.
class Sensors {
 public:
  explicit Sensors(Peer& peer)
      : scans_(peer.publisher()->create_datawriter(peer.topic<LaserScan>("rt/scan"),
                                                   endpoint_qos(DATAWRITER_QOS_DEFAULT))),
        odometry_(peer.publisher()->create_datawriter(peer.topic<Odometry>("rt/odom"),
                                                      endpoint_qos(DATAWRITER_QOS_DEFAULT))),
        thread_([this] { run(); }) {}
  ~Sensors() {
    over = true;
    thread_.join();
  }

  std::atomic<bool> scanning{false}, moving{false}, over{false};

 private:
  void run() {
    LaserScan scan;
    scan.frame_id = "laser";
    scan.range_min = 0.1F;
    scan.range_max = 4.1F;
    scan.ranges.assign(10, 3.0F);
    Odometry pose;
    for (auto due = std::chrono::steady_clock::now(); !over; due += kPeriod) {
      std::this_thread::sleep_until(due);
      if (scanning) {
        scans_->write(&scan);
        say("scan", now_s(), 0);
      }
      if (moving) {
        odometry_->write(&pose);
      }
    }
  }

  DataWriter* scans_;
  DataWriter* odometry_;
  std::thread thread_;
};

int run(int argc, char** argv) {
  if (argc != 2) {
    throw std::runtime_error("write fastdds_robot DOMAIN");
  }
  spikeloop::run_before_others();  // what it hears late on a busy machine would look like a late
                                   // stop
  Wheels wheels;
  Button button;
  Listener<DiagnosticArray> monitor(say_diagnosis);
  // Without shared memory, which a killed process would leave behind.
  Peer peer(static_cast<std::uint32_t>(std::stoi(argv[1])), "udp");
  peer.subscriber()->create_datareader(peer.topic<Twist>("rt/cmd_vel"), every_message_qos(),
                                       &wheels);
  peer.subscriber()->create_datareader(peer.topic<DiagnosticArray>("rt/diagnostics"),
                                       every_message_qos(), &monitor);
  DataWriter* const stop = peer.publisher()->create_datawriter(
      peer.topic<Bool>("rt/emergency_stop"), endpoint_qos(DATAWRITER_QOS_DEFAULT), &button);
  DataWriter* const manual = peer.publisher()->create_datawriter(
      peer.topic<Twist>("rt/cmd_vel_manual"), endpoint_qos(DATAWRITER_QOS_DEFAULT));
  DataWriter* const bumper = peer.publisher()->create_datawriter(
      peer.topic<ContactsState>("rt/bumper_states"), endpoint_qos(DATAWRITER_QOS_DEFAULT));
  Sensors sensors(peer);
  std::cout << "ready" << std::endl;
  for (std::string word, number; std::cin >> word >> number;) {
    const double value = std::stod(number);  // nan, too
    if (word == "scans") {
      sensors.scanning = value != 0;
    } else if (word == "odometry") {
      sensors.moving = value != 0;
    } else if (word == "stop") {
      Bool message{static_cast<std::uint8_t>(value != 0)};
      stop->write(&message);
    } else if (word == "manual") {
      Twist message;
      message.values[0] = value;
      manual->write(&message);
    } else if (word == "touch") {
      ContactsState message;
      for (int thing = 1; thing <= value; ++thing) {
        message.contacts.emplace_back("chassis", std::to_string(thing));
      }
      bumper->write(&message);
    } else {
      refuse_word(word);
    }
    say("done", now_s(), 0);
  }
  return 0;
}

}  // namespace
}  // namespace fastdds_peer

int main(int argc, char** argv) {
  return fastdds_peer::run_program("fastdds_robot", fastdds_peer::run, argc, argv);
}
