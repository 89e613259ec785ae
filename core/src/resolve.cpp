// Written values as the declared parameters want them.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/core/reason.hpp"
#include "spikeloop/core/unit_demand.hpp"

namespace spikeloop {
namespace {

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
    throw ConfigurationError(
        with_code(Code::out_of_bounds, "{} is out of bounds; {}", value, bounds_text(parameter)));
  }
}

std::int64_t parse_integer(const ParameterDescription& parameter, std::string_view text) {
  std::int64_t value = 0;
  const std::string_view digits = text.substr(text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || error == std::errc::invalid_argument ||
      end != digits.data() + digits.size()) {
    throw ConfigurationError(with_code(Code::not_whole, "'{}' is not a whole number; {}", text,
                                       integer_bounds_text(parameter)));
  }
  const auto real = static_cast<double>(value);
  if (error != std::errc() || real < parameter.minimum || real > parameter.maximum) {
    throw ConfigurationError(with_code(Code::out_of_bounds, "{} is out of bounds; {}", text,
                                       integer_bounds_text(parameter)));
  }
  return value;
}

bool parse_boolean(std::string_view text) {
  if (text == "true" || text == "false") {
    return text == "true";
  }
  throw ConfigurationError(
      with_code(Code::unknown_choice, "'{}' is not a truth value; write true or false", text));
}

std::string parse_choice(const ParameterDescription& parameter, const std::string& text) {
  const auto& choices = parameter.choices;
  if (std::ranges::find(choices, text) == choices.end()) {
    throw ConfigurationError(
        with_code(Code::unknown_choice, "'{}' is not a choice{}; write one of: {}", text,
                  nearest(text, choices).empty() ? "" : did_you_mean(text, choices),
                  fmt::join(choices, ", ")));
  }
  return text;
}

/// What `work` returns; an error of its gets this prefix, and this place unless it has one.
template <typename Work>
auto within(const Location& where, const std::string& prefix, Work&& work) {
  try {
    return work();
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(error.located() ? error.where() : where,
                             fmt::format("{}: {}", prefix, reason_of(error)));
  }
}

Parameters::Value parse(const ParameterDescription& parameter, const WrittenValue& written,
                        const WeightLoader& load_weights);

bool is_numeric(const ParameterDescription& parameter) {
  return parameter.type == ParameterType::number || parameter.type == ParameterType::integer;
}

/// "limits: {linear.x: [-0.5, 0.5]}"
std::string example_of(const ParameterDescription& parameter) {
  return (parameter.name == kAnyKey ? "" : parameter.name + ": ") + parameter.example;
}

[[noreturn]] void refuse_shape(const ParameterDescription& parameter, const WrittenValue& written,
                               const std::string& shape) {
  const std::string remedy =
      parameter.choices.empty()
          ? example_of(parameter)
          : fmt::format("{}, or a map such as  {}", fmt::join(parameter.choices, ", "),
                        example_of(parameter));
  throw ConfigurationError(
      with_code(Code::wrong_shape, "'{}' is {}; write  {}", written.text, shape, remedy));
}

/// "[1, 2]" and "1, 2", where lists are plain texts.
std::vector<WrittenEntry> split(const WrittenValue& list) {
  std::string_view text = list.text;
  if (text.starts_with('[') && text.ends_with(']')) {
    text = text.substr(1, text.size() - 2);
  }
  std::vector<WrittenEntry> entries;
  while (!text.empty()) {
    const auto end = std::min(text.find(','), text.size());
    std::string_view entry = text.substr(0, end);
    entry.remove_prefix(std::min(entry.find_first_not_of(' '), entry.size()));
    entry = entry.substr(0, entry.find_last_not_of(' ') + 1);
    entries.push_back({"", {std::string(entry), list.where}});
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return entries;
}

void check_names(const std::vector<ParameterDescription>& declared, const WrittenValues& written,
                 const std::vector<std::string>& ignored) {
  const std::vector<std::string> names = names_of(declared);
  for (const auto& [name, value] : written) {
    const bool known = std::find(names.begin(), names.end(), name) != names.end() ||
                       std::find(ignored.begin(), ignored.end(), name) != ignored.end();
    if (!known) {
      throw ConfigurationError(value.where, with_code(Code::unknown_key, "unknown key '{}'{}", name,
                                                      did_you_mean(name, names)));
    }
  }
}

/// The keys of a map.
Parameters parse_keys(const ParameterDescription& map, const std::vector<WrittenEntry>& entries,
                      const WeightLoader& load_weights) {
  WrittenValues written;
  for (const auto& [key, value] : entries) {
    written[key] = value;
  }
  check_names(map.inner, written, {});
  for (const ParameterDescription& declared : map.inner) {
    const auto value = written.find(declared.name);
    if (value != written.end()) {
      demand_unit("", declared, value->second);
    } else if (!declared.default_value) {
      throw ConfigurationError(with_code(Code::missing_key, "key '{}' is missing ({}); write  {}",
                                         declared.name, declared.text, example_of(map)));
    }
  }
  return resolve(map.inner, written, load_weights);
}

/// What an entry of a list, or of a map with the user's own keys, holds.
Parameters::Entry parse_entry(const ParameterDescription& each, const WrittenEntry& entry,
                              const WeightLoader& load_weights) {
  Parameters::Entry result{entry.key, entry.value.where, {}};
  Parameters::Value value = parse(each, entry.value, load_weights);
  if (each.type == ParameterType::map) {
    result.values = std::get<Parameters::Entries>(value).at(0).values;
  } else {
    result.values.set(each.name, std::move(value), true, entry.value.where);
  }
  return result;
}

Parameters::Value empty_list(const ParameterDescription& list) {
  return is_numeric(list.inner.front()) ? Parameters::Value(std::vector<double>{})
                                        : Parameters::Value(Parameters::Entries{});
}

Parameters::Value parse_list(const ParameterDescription& list, const WrittenValue& written,
                             const WeightLoader& load_weights) {
  const ParameterDescription& each = list.inner.front();
  if (written.is_map()) {
    refuse_shape(list, written, "not a list");
  }
  const auto entries = written.is_list() ? written.entries() : split(written);
  if (entries.empty() || (list.count != 0 && entries.size() != list.count)) {
    refuse_shape(list, written,
                 list.count == 0 ? "an empty list" : fmt::format("not a list of {}", list.count));
  }
  Parameters::Value result = empty_list(list);
  auto* const numbers = std::get_if<std::vector<double>>(&result);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    within(entries[i].value.where, fmt::format("entry {}", i + 1), [&] {
      if (written.is_list() && lacks_unit(each, entries[i].value.text)) {
        throw ConfigurationError(with_code(Code::wrong_unit,
                                           "'{}' has no unit; write for example  {}",
                                           entries[i].value.text, example_of(list)));
      }
      Parameters::Entry entry = parse_entry(each, entries[i], load_weights);
      if (numbers != nullptr) {
        numbers->push_back(entry.values.number(each.name));
      } else {
        std::get<Parameters::Entries>(result).push_back(std::move(entry));
      }
      return 0;
    });
  }
  return result;
}

Parameters::Value parse_map(const ParameterDescription& map, const WrittenValue& written,
                            const WeightLoader& load_weights) {
  std::vector<WrittenEntry> entries;
  if (written.is_map()) {
    entries = written.entries();
  } else if (std::ranges::find(map.choices, written.text) != map.choices.end()) {
    return written.text;
  } else if (!written.is_list() && !map.plain_key.empty()) {
    entries = {{map.plain_key, {written.text, written.where}}};
  } else if (!written.text.empty()) {
    refuse_shape(map, written,
                 map.choices.empty()
                     ? "not a map"
                     : fmt::format("neither {} nor a map", fmt::join(map.choices, " nor ")));
  } else {
    return Parameters::Entries{};
  }
  if (map.inner.front().name != kAnyKey) {
    return Parameters::Entries{{"", written.where, parse_keys(map, entries, load_weights)}};
  }
  Parameters::Entries result;
  for (const WrittenEntry& entry : entries) {
    result.push_back(within(entry.value.where, fmt::format("'{}'", entry.key),
                            [&] { return parse_entry(map.inner.front(), entry, load_weights); }));
  }
  return result;
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
      return parse_choice(parameter, written.text);
    case ParameterType::list:
      return parse_list(parameter, written, load_weights);
    case ParameterType::map:
      return parse_map(parameter, written, load_weights);
    case ParameterType::weights:
      if (!load_weights) {
        throw std::logic_error("weights were declared, but no loader was given");
      }
      try {
        return load_weights(written);
      } catch (const ConfigurationError& error) {
        throw ConfigurationError(error.what());  // a place in the file is part of what is wrong
      }
  }
  throw std::logic_error("unknown type of parameter");
}

}  // namespace

Parameters resolve(const std::vector<ParameterDescription>& declared, const WrittenValues& written,
                   const WeightLoader& load_weights, const std::vector<std::string>& ignored) {
  check_names(declared, written, ignored);
  Parameters parameters;
  for (const auto& parameter : declared) {
    const auto found = written.find(parameter.name);
    const bool given = found != written.end();
    if (!given && !parameter.default_value) {
      throw ConfigurationError(missing_key(parameter, "="));
    }
    const bool empty = !given && parameter.default_value->empty();
    if (empty && is_numeric(parameter)) {
      continue;  // it has no value
    }
    if (empty && parameter.type == ParameterType::list) {
      parameters.set(parameter.name, empty_list(parameter), false);
      continue;
    }
    const WrittenValue value = given ? found->second : WrittenValue{*parameter.default_value, {}};
    parameters.set(parameter.name,
                   within(value.where, fmt::format("key '{}'", parameter.name),
                          [&] { return parse(parameter, value, load_weights); }),
                   given, value.where);
  }
  return parameters;
}

}  // namespace spikeloop
