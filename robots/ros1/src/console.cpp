#include "console.hpp"

#include <log4cxx/logger.h>
#include <ros/console.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <string_view>

#include "spikeloop/core/log.hpp"
#include "spikeloop/topics/message_kinds.hpp"

namespace spikeloop::ros1 {
namespace {

/// Errors that Spikeloop reports itself, with node and remedy.
constexpr std::array<std::string_view, 2> kReported{"to have datatype/md5sum",
                                                    "Couldn't find an AF_INET"};

class RoscppLog : public ros::console::LogAppender {
 public:
  void log(ros::console::Level level, const char* text, const char* /*file*/,
           const char* /*function*/, int /*line*/) override {
    const std::string_view message(text);
    const bool reported = std::ranges::any_of(
        kReported, [&](std::string_view part) { return message.find(part) != message.npos; });
    if (level < ros::console::levels::Warn || reported) {
      log::debug("roscpp: {}", message);
      return;
    }
    {
      const std::lock_guard lock(mutex_);
      if (!kinds_.is_new(message)) {
        return;
      }
    }
    log::warning("roscpp: {}", message);
  }

 private:
  std::mutex mutex_;
  topics::MessageKinds kinds_;
};

}  // namespace

void redirect_roscpp_log() {
  ros::console::initialize();
  log4cxx::Logger::getLogger(ROSCONSOLE_ROOT_LOGGER_NAME)->removeAllAppenders();
  ros::console::register_appender(new RoscppLog);  // roscpp's threads use it until the process ends
}

}  // namespace spikeloop::ros1
