#include "spikeloop/core/parameters.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace spikeloop {

namespace {

template <typename T>
const T& typed(const Parameters::Value& value, std::string_view name) {
  if (const T* found = std::get_if<T>(&value)) {
    return *found;
  }
  throw std::logic_error(fmt::format("parameter '{}' was asked for with the wrong type", name));
}

std::string bounds_text(const ParameterDescription& parameter) {
  const bool low = std::isfinite(parameter.minimum);
  const bool high = std::isfinite(parameter.maximum);
  const std::string unit =
      parameter.unit.empty() || parameter.unit == "1" ? "" : " " + parameter.unit;
  if (low && high) {
    return fmt::format("write a value from {} to {}{}", parameter.minimum, parameter.maximum, unit);
  }
  return low ? fmt::format("write a value of at least {}{}", parameter.minimum, unit)
             : fmt::format("write a value of at most {}{}", parameter.maximum, unit);
}

/// A bound that is not declared is that of the type.
std::string integer_bounds_text(const ParameterDescription& parameter) {
  using Limits = std::numeric_limits<std::int64_t>;
  const bool low = std::isfinite(parameter.minimum);
  const bool high = std::isfinite(parameter.maximum);
  return low || high ? fmt::format("write a whole number from {} to {}",
                                   low ? std::llround(parameter.minimum) : Limits::min(),
                                   high ? std::llround(parameter.maximum) : Limits::max())
                     : "write for example 10";
}

void check_bounds(const ParameterDescription& parameter, double value) {
  if (value < parameter.minimum || value > parameter.maximum) {
    throw ConfigurationError(fmt::format("{} is out of bounds; {}", value, bounds_text(parameter)));
  }
}

std::int64_t parse_integer(const ParameterDescription& parameter, std::string_view text) {
  std::int64_t value = 0;
  const std::string_view digits = text.substr(text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || error == std::errc::invalid_argument ||
      end != digits.data() + digits.size()) {
    throw ConfigurationError(
        fmt::format("'{}' is not a whole number; {}", text, integer_bounds_text(parameter)));
  }
  const auto real = static_cast<double>(value);
  if (error != std::errc() || real < parameter.minimum || real > parameter.maximum) {
    throw ConfigurationError(
        fmt::format("{} is out of bounds; {}", text, integer_bounds_text(parameter)));
  }
  return value;
}

bool parse_boolean(std::string_view text) {
  if (text == "true" || text == "false") {
    return text == "true";
  }
  throw ConfigurationError(fmt::format("'{}' is not a truth value; write true or false", text));
}

Parameters::Value parse(const ParameterDescription& parameter, const WrittenValue& written,
                        const WeightLoader& load_weights) {
  switch (parameter.type) {
    case ParameterType::number: {
      const double value = parse_quantity(written.text, parameter.unit);
      check_bounds(parameter, value);
      return value;
    }
    case ParameterType::integer:
      return parse_integer(parameter, written.text);
    case ParameterType::boolean:
      return parse_boolean(written.text);
    case ParameterType::text:
      return written.text;
    case ParameterType::choice:
      if (std::find(parameter.choices.begin(), parameter.choices.end(), written.text) ==
          parameter.choices.end()) {
        throw ConfigurationError(fmt::format("'{}' is not a choice{}; write one of: {}",
                                             written.text,
                                             nearest(written.text, parameter.choices).empty()
                                                 ? ""
                                                 : did_you_mean(written.text, parameter.choices),
                                             fmt::join(parameter.choices, ", ")));
      }
      return written.text;
    case ParameterType::weights:
      if (!load_weights) {
        throw std::logic_error("weights were declared, but no loader was given");
      }
      return load_weights(written);
  }
  throw std::logic_error("unknown type of parameter");
}

void check_names(const std::vector<ParameterDescription>& declared, const WrittenValues& written,
                 const std::vector<std::string>& ignored) {
  const std::vector<std::string> names = names_of(declared);
  for (const auto& [name, value] : written) {
    const bool known = std::find(names.begin(), names.end(), name) != names.end() ||
                       std::find(ignored.begin(), ignored.end(), name) != ignored.end();
    if (!known) {
      throw ConfigurationError(value.where,
                               fmt::format("unknown key '{}'{}", name, did_you_mean(name, names)));
    }
  }
}

}  // namespace

const Parameters::Value& Parameters::find(std::string_view name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) {
    throw std::logic_error(fmt::format("parameter '{}' was not declared", name));
  }
  return found->second;
}

double Parameters::number(std::string_view name) const {
  const Value& value = find(name);
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    return static_cast<double>(*integer);
  }
  return typed<double>(value, name);
}

std::int64_t Parameters::integer(std::string_view name) const {
  return typed<std::int64_t>(find(name), name);
}

bool Parameters::boolean(std::string_view name) const {
  return typed<bool>(find(name), name);
}

const std::string& Parameters::text(std::string_view name) const {
  return typed<std::string>(find(name), name);
}

const WeightTable& Parameters::weights(std::string_view name) const {
  return typed<WeightTable>(find(name), name);
}

bool Parameters::given(std::string_view name) const {
  return given_.find(name) != given_.end();
}

const Location& Parameters::where(std::string_view name) const {
  static const Location kNowhere;
  const auto found = given_.find(name);
  return found == given_.end() ? kNowhere : found->second;
}

void Parameters::set(const std::string& name, Value value, bool given, Location where) {
  values_[name] = std::move(value);
  given_.erase(name);
  if (given) {
    given_[name] = std::move(where);
  }
}

std::vector<std::string> names_of(const std::vector<ParameterDescription>& parameters) {
  std::vector<std::string> names;
  names.reserve(parameters.size());
  for (const auto& parameter : parameters) {
    names.push_back(parameter.name);
  }
  return names;
}

Parameters resolve(const std::vector<ParameterDescription>& declared, const WrittenValues& written,
                   const WeightLoader& load_weights, const std::vector<std::string>& ignored) {
  check_names(declared, written, ignored);
  Parameters parameters;
  for (const auto& parameter : declared) {
    const auto found = written.find(parameter.name);
    const bool given = found != written.end();
    if (!given && !parameter.default_value) {
      throw ConfigurationError(fmt::format("key '{}' is missing ({}); write  {} = ...",
                                           parameter.name, parameter.text, parameter.name));
    }
    const WrittenValue value = given ? found->second : WrittenValue{*parameter.default_value, {}};
    try {
      parameters.set(parameter.name, parse(parameter, value, load_weights), given, value.where);
    } catch (const ConfigurationError& error) {
      throw ConfigurationError(value.where,
                               fmt::format("key '{}': {}", parameter.name, error.what()));
    }
  }
  return parameters;
}

}  // namespace spikeloop
