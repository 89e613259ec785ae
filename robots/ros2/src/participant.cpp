#include "participant.hpp"

#include <dds/ddsrt/log.h>
#include <fmt/format.h>

#include <functional>
#include <mutex>
#include <set>
#include <string>
#include <string_view>

#include "qos.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/topics/message_kinds.hpp"

namespace spikeloop::ros2 {
namespace {

/// What Cyclone DDS has to say goes to our log, or into the error that it is about; each kind once.
class CycloneLog {
 public:
  /// For ever: Cyclone's threads may have something to say when static objects have ended.
  static CycloneLog& instance() {
    static CycloneLog& log = *new CycloneLog;
    return log;
  }

  /// Keeps what is said from now on.
  void keep() {
    const std::lock_guard lock(mutex_);
    keeping_ = true;
    kept_.clear();
    kept_kinds_.clear();
  }
  /// Ends that. @return what was said
  std::string release() {
    const std::lock_guard lock(mutex_);
    keeping_ = false;
    return std::move(kept_);
  }

 private:
  CycloneLog() { dds_set_log_sink(&CycloneLog::take, this); }

  static void take(void* self, const dds_log_data_t* data) {
    std::string_view text(data->message, data->size);
    while (!text.empty() && (text.back() == '\n' || text.back() == '\0')) {
      text.remove_suffix(1);
    }
    static_cast<CycloneLog*>(self)->take(data->priority, text);
  }

  void take(std::uint32_t priority, std::string_view text) {
    {
      const std::lock_guard lock(mutex_);
      if (keeping_ && (priority & (DDS_LC_FATAL | DDS_LC_ERROR | DDS_LC_WARNING)) != 0) {
        if (kept_kinds_.is_new(text)) {
          kept_ += kept_.empty() ? "" : "; ";
          kept_ += text;
        }
        return;
      }
      if (!said_.is_new(text)) {
        return;
      }
    }
    if ((priority & DDS_LC_INFO) != 0) {
      log::debug("Cyclone DDS: {}", text);
    } else {
      log::warning("Cyclone DDS: {}", text);
    }
  }

  std::mutex mutex_;
  bool keeping_ = false;
  std::string kept_;
  topics::MessageKinds kept_kinds_;
  topics::MessageKinds said_;
};

/// Cyclone DDS has each domain once a process.
class DomainNumbers {
 public:
  static DomainNumbers& instance() {
    static DomainNumbers numbers;
    return numbers;
  }

  /// The domain's own number, for which a user may have settings, unless this process has it
  /// already.
  dds_domainid_t take(dds_domainid_t wanted) {
    const std::lock_guard lock(mutex_);
    dds_domainid_t number = wanted;
    while (taken_.contains(number)) {
      number = (number + 1) % kNumbers;
    }
    taken_.insert(number);
    return number;
  }
  void give_back(dds_domainid_t number) {
    const std::lock_guard lock(mutex_);
    taken_.erase(number);
  }

 private:
  static constexpr dds_domainid_t kNumbers = 1000000;
  std::mutex mutex_;
  std::set<dds_domainid_t> taken_;
};

/// One at a time, so that an error gets what Cyclone DDS says of it.
dds_entity_t created(const char* what, const discovery::Discovery& where,
                     const std::function<dds_entity_t()>& create) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  CycloneLog::instance().keep();
  const dds_entity_t entity = create();
  const std::string said = CycloneLog::instance().release();
  // The kernel's table of sockets may lack some while others are opened and closed.
  if (entity < 0 && (said.find("free participant index") != std::string::npos ||
                     discovery::free_participants(where) == 0)) {
    throw TransportError(with_code(Code::resource,
                                   "domain {} of ROS 2 has reached its limit of {} participants on "
                                   "this machine; end other programs of the domain, or set another "
                                   "ROS_DOMAIN_ID",
                                   where.domain, discovery::most_participants(where.domain)));
  }
  if (entity < 0) {
    throw TransportError(
        with_code(Code::ros_setting, "Cyclone DDS makes no {} in domain {} ({}); look at {}", what,
                  where.domain, said.empty() ? dds_strretcode(entity) : said,
                  where.cyclone.empty() ? "the network interfaces and ROS_STATIC_PEERS"
                                        : "CYCLONEDDS_URI and ROS_STATIC_PEERS"));
  }
  if (!said.empty()) {
    log::warning("Cyclone DDS: {}", said);
  }
  return entity;
}

}  // namespace

Domain::Domain(const discovery::Discovery& where)
    : number_(DomainNumbers::instance().take(where.domain)) {
  const std::string settings = discovery::cyclone_settings(where, discovery::interfaces(), number_);
  try {
    entity_ =
        created("domain", where, [&] { return dds_create_domain(number_, settings.c_str()); });
  } catch (...) {
    DomainNumbers::instance().give_back(number_);
    throw;
  }
}

Domain::~Domain() {
  dds_delete(entity_);
  DomainNumbers::instance().give_back(number_);
}

Participant::Participant(const Domain& domain, const discovery::Discovery& where) {
  // ROS 2 files a participant without an enclave as foreign to ROS.
  const Qos qos = user_data_qos("enclave=/;");
  entity_ = created("participant", where,
                    [&] { return dds_create_participant(domain.number(), qos.get(), nullptr); });
}

Participant::~Participant() {
  dds_delete(entity_);
}

}  // namespace spikeloop::ros2
