// Messages about a command for the user.
#include <fmt/format.h>

#include "spikeloop/command/command_sink.hpp"
#include "spikeloop/core/units.hpp"

namespace spikeloop::command {

std::string stop_cause(StopReason reason, const CommandSettings& settings,
                       std::size_t silent_sensor) {
  const EmergencyStop& emergency = settings.emergency_stop;
  switch (reason) {
    case StopReason::no_value:
      return settings.driver.empty()
                 ? "there is no value to send"
                 : fmt::format("there is no value from '{}' to send (NaN)", settings.driver);
    case StopReason::not_finite:
      return settings.driver.empty()
                 ? "a command has a value that is not a finite number"
                 : fmt::format("a value from '{}' is not a finite number", settings.driver);
    case StopReason::stale:
      return fmt::format("the data are older than max_age, {}", format_time(settings.max_age));
    case StopReason::sensor_silent:
      return fmt::format("no message with a reading on topic '{}' for {}",
                         settings.sensors[silent_sensor].topic,
                         format_time(settings.sensors[silent_sensor].timeout));
    case StopReason::spikes_silent:
      return fmt::format("no spike for spike_timeout, {}", format_time(settings.spike_timeout));
    case StopReason::silent:
      return fmt::format("no tick for {}", format_time(settings.watchdog));
    case StopReason::continued:
      return "a program of the job has died, or this one had been stopped (SIGCONT)";
    case StopReason::emergency:
      return fmt::format("emergency stop on topic '{}'{}", emergency.topic,
                         emergency.latched ? ", until the end of the run" : "");
    case StopReason::emergency_unknown:
      return emergency.timeout == 0
                 ? fmt::format("the emergency stop's topic '{}' has no publisher", emergency.topic)
                 : fmt::format(
                       "the emergency stop's topic '{}' has no publisher, or no message for {}",
                       emergency.topic, format_time(emergency.timeout));
    case StopReason::stop_button:
      return "STOP is pressed in the live view";
    case StopReason::suspended:
      return "the run is suspended (Ctrl-Z); fg continues it";
    case StopReason::unsupervised:
      return "the launcher or mpirun is stopped (SIGSTOP), or the machine is too busy";
    case StopReason::unguarded:
      return "no guard answers, and guard_required is true";
    case StopReason::terminated:
    case StopReason::ended:
      break;
  }
  return "the run is over";
}

std::string cut_warning(const Limiter::Cut& cut, const CommandSettings& settings) {
  const Bounds& bounds = settings.bounds[cut.component];
  const std::string& field = settings.fields[cut.component];
  return fmt::format(
      "the value {} of field '{}' is beyond its limits [{}, {}] and is cut, as others may be; to "
      "drive faster, write  limits: {{{}: [MIN, MAX]}}",
      format_rounded(cut.value, 4), field, bounds.minimum, bounds.maximum, field);
}

}  // namespace spikeloop::command
