#include "outside.hpp"

#include <fmt/format.h>

#include <map>
#include <string>

#include "spikeloop/launch/programs.hpp"

namespace spikeloop::launch {
namespace {

/// Where a program of ours meets the world.
struct Place {
  std::string name;
  Location where;
};

class OutsideCheck {
 public:
  OutsideCheck(const MusicFile& file, bool strict) : file_(file), strict_(strict) {}

  Findings run() {
    for (const MusicSection* section : in_written_order(file_)) {
      const Program* program = find_program(file_, *section);
      if (program == nullptr || program->outside.key.empty()) {
        continue;
      }
      const Place place = place_of(*section, *program);
      if (place.name.empty()) {
        continue;  // the program itself reports it
      }
      if (!program->source) {
        add_writer(*section, *program, place);
      } else if (program->ros) {
        listeners_.emplace(place.name, section);
      }
    }
    for (const auto& [topic, listener] : listeners_) {
      check_echo(topic, *listener);
    }
    return std::move(findings_);
  }

 private:
  Place place_of(const MusicSection& section, const Program& program) const {
    const MusicKey* key = file_.find_key(section, program.outside.key);
    Place place{std::string(program.outside.otherwise), section.where};
    if (key != nullptr) {
      place = {key->value, key->where};
    }
    // scan and /scan are one topic, as long as no namespace is set.
    if (program.ros && !place.name.empty() && place.name.find_first_of("/~") != 0) {
      place.name = fmt::format("/{}", place.name);
    }
    return place;
  }

  void add_writer(const MusicSection& section, const Program& program, const Place& place) {
    const auto [first, is_new] = writers_.emplace(place.name, &section);
    if (is_new) {
      return;
    }
    const std::string both =
        fmt::format("'{}' and '{}' both publish {}", first->second->label, section.label,
                    program.ros ? place.name : "at " + place.name);
    if (program.ros) {
      findings_.add_warning(
          place.where,
          both + ", and the robot obeys both in turn; write another ros_topic in one of them",
          strict_);
    } else {
      findings_.add_error(
          place.where,
          both + ", which only one program can; write another zmq_addr in one of them");
    }
  }

  void check_echo(const std::string& topic, const MusicSection& listener) {
    const auto writer = writers_.find(topic);
    if (writer == writers_.end()) {
      return;
    }
    const MusicKey* key = file_.find_key(listener, "ros_topic");
    findings_.add_warning(
        key == nullptr ? listener.where : key->where,
        fmt::format("'{}' subscribes to {}, which '{}' publishes: the job hears itself; write "
                    "another ros_topic in one of them",
                    listener.label, topic, writer->second->label),
        strict_);
  }

  const MusicFile& file_;
  bool strict_;
  std::map<std::string, const MusicSection*> writers_;
  std::map<std::string, const MusicSection*> listeners_;
  Findings findings_;
};

}  // namespace

Findings check_outside(const MusicFile& file, bool strict) {
  return OutsideCheck(file, strict).run();
}

}  // namespace spikeloop::launch
