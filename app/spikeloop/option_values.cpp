#include "option_values.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <limits>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/launch/mpirun.hpp"

namespace spikeloop::app {
namespace {

struct QuantityOption {
  const char* name;
  const char* unit;
  const char* what;
  double least;
  double most;
  const char* above;  ///< the range, for whoever wrote no number in it
  const char* below;  ///< the range, for whoever wrote a larger one
  const char* example;
};

[[noreturn]] void refuse(const char* name, const std::string& text, const std::string& remedy) {
  throw ConfigurationError(
      fmt::format("{} {}: write {}", name, launch::shell_text({text}), remedy));
}

double read_quantity(const QuantityOption& option, const std::string& text) {
  double value = -1;
  try {
    value = parse_quantity(text, option.unit);
  } catch (const ConfigurationError&) {
    // Ours names the option and fits one line; the value stays outside the range.
  }
  if (value < option.least || value > option.most) {
    refuse(option.name, text,
           fmt::format("{}, {}, as in {} {}", option.what,
                       value > option.most ? option.below : option.above, option.name,
                       option.example));
  }
  return value;
}

}  // namespace

double duration_s(const std::string& text) {
  return read_quantity(
      {"--duration", "s", "the simulated seconds", 1e-9, 1e9, "above 0", "at most 1e9", "60"},
      text);
}

double real_time_factor(const std::string& text) {
  return read_quantity({"--real-time-factor", "1", "simulated over wall time", 1e-3, 1e3,
                        "from 0.001 to 1000", "from 0.001 to 1000", "0.5"},
                       text);
}

double start_timeout_s(const std::string& text) {
  return read_quantity(
      {"--start-timeout", "s", "the seconds to wait", 1e-3, 1e6, "above 0", "at most 1e6", "120"},
      text);
}

double stall_timeout_s(const std::string& text) {
  return read_quantity({"--stall-timeout", "s", "the seconds to wait", 0, 1e6,
                        "0 or more (0: no limit)", "at most 1e6", "120"},
                       text);
}

void add_settings(CLI::App& command, std::vector<std::string>& texts) {
  command
      .add_option("--set", texts,
                  "Value of a key in place of the file's; repeatable: --set "
                  "encoder.rate_max=\"100 Hz\"")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

Settings parse_settings(const std::vector<std::string>& texts) {
  Settings settings;
  for (const std::string& text : texts) {
    settings.push_back(parse_setting(text));
  }
  return settings;
}

void add_no_code(CLI::App& command) {
  command.add_flag_callback(
      "--no-code", [] { ::setenv(kNoCode, "1", 1); }, "Run no code that FILE names");
}

CLI::Validator named(const std::string& what) {
  return {[what](const std::string& text) {
            return text.empty() ? "the name of the " + what + " is empty; write one"
                                : std::string();
          },
          ""};
}

std::uint64_t seed(const std::string& text) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int64_t>::max();
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || value > kMost) {
    refuse("--seed", text, fmt::format("a whole number from 0 to {}, as in --seed 7", kMost));
  }
  return value;
}

}  // namespace spikeloop::app
