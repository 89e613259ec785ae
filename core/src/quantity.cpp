// Numbers with units: "30 ms", "200 Hz".
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <string>
#include <vector>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/parameters.hpp"
#include "spikeloop/core/units.hpp"

namespace spikeloop {

namespace {

struct Unit {
  const char* name;
  const char* dimension;
  double factor;  // in the dimension's base unit
};

constexpr double kDegree = 3.14159265358979323846 / 180.0;
constexpr Unit kUnits[] = {
    {"ns", "time", 1e-9},        {"us", "time", 1e-6},        {"ms", "time", 1e-3},
    {"s", "time", 1.0},          {"min", "time", 60.0},       {"h", "time", 3600.0},
    {"Hz", "frequency", 1.0},    {"kHz", "frequency", 1e3},   {"MHz", "frequency", 1e6},
    {"uV", "voltage", 1e-6},     {"mV", "voltage", 1e-3},     {"V", "voltage", 1.0},
    {"pA", "current", 1e-12},    {"nA", "current", 1e-9},     {"uA", "current", 1e-6},
    {"mA", "current", 1e-3},     {"A", "current", 1.0},       {"pF", "capacitance", 1e-12},
    {"nF", "capacitance", 1e-9}, {"uF", "capacitance", 1e-6}, {"Ohm", "resistance", 1.0},
    {"kOhm", "resistance", 1e3}, {"MOhm", "resistance", 1e6}, {"GOhm", "resistance", 1e9},
    {"mm", "length", 1e-3},      {"cm", "length", 1e-2},      {"m", "length", 1.0},
    {"km", "length", 1e3},       {"rad", "angle", 1.0},       {"deg", "angle", kDegree},
    {"m/s", "speed", 1.0},       {"rad/s", "turning", 1.0},   {"deg/s", "turning", kDegree},
    {"1", "number", 1.0}};

/// "us" for both letters of micro: the micro sign U+00B5 and the Greek letter U+03BC.
std::string with_ascii_micro(std::string_view name) {
  for (const std::string_view micro : {"\u00b5", "\u03bc"}) {
    if (name.starts_with(micro)) {
      return "u" + std::string(name.substr(micro.size()));
    }
  }
  return std::string(name);
}

const Unit* find_unit(std::string_view name) {
  const std::string ascii = with_ascii_micro(name);
  for (const Unit& unit : kUnits) {
    if (ascii == unit.name) {
      return &unit;
    }
  }
  return nullptr;
}

std::vector<std::string> units_of(std::string_view dimension) {
  std::vector<std::string> names;
  for (const Unit& unit : kUnits) {
    if (dimension == unit.dimension) {
      names.emplace_back(unit.name);
    }
  }
  return names;
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

}  // namespace

std::vector<std::string> units_like(std::string_view unit) {
  if (unit.empty() || unit == "1") {
    return {};
  }
  const Unit* known = find_unit(unit);
  return known == nullptr ? std::vector<std::string>{std::string(unit)}
                          : units_of(known->dimension);
}

std::string format_rounded(double number, int digits) {
  return fmt::format("{}", std::stod(fmt::format("{:.{}e}", number, digits - 1)));
}

double parse_quantity(std::string_view text, std::string_view unit) {
  const std::string_view body = trimmed(text);
  const std::string_view wanted = unit.empty() ? std::string_view("1") : unit;
  const bool plain = wanted == "1";
  const std::string example = plain ? "0.5" : fmt::format("0.5 {}", wanted);
  double value = 0.0;
  const std::string_view digits = body.substr(body.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (body.empty() || error == std::errc::invalid_argument) {
    throw ConfigurationError(
        with_code(Code::not_a_number, "'{}' is not a number; write for example {}", text, example));
  }
  if (error != std::errc() || !std::isfinite(value)) {
    throw ConfigurationError(with_code(
        Code::not_a_number, "'{}' is not a finite number; write for example {}", text, example));
  }
  const std::string_view given =
      trimmed(digits.substr(static_cast<std::size_t>(end - digits.data())));
  if (given.empty() || given == wanted) {
    return value;
  }
  const Unit* to = find_unit(wanted);
  const Unit* from = find_unit(given);
  if (plain || to == nullptr || from == nullptr ||
      std::string_view(from->dimension) != to->dimension) {
    throw ConfigurationError(
        plain ? with_code(Code::wrong_unit,
                          "'{}': this number has no unit, '{}' cannot stand behind it; write {}",
                          text, given, value)
              : with_code(Code::wrong_unit, "'{}': '{}' is not a unit of {} here; write one of: {}",
                          text, given, to == nullptr ? wanted : to->dimension,
                          to == nullptr
                              ? std::string(wanted)
                              : fmt::format("{}", fmt::join(units_of(to->dimension), ", "))));
  }
  // Divide where the ratio is whole (30 ms = 30 / 1000 s), so that "30 ms" is the double 0.03.
  const double ratio = to->factor / from->factor;
  const double whole = std::round(ratio);
  const bool is_whole = whole >= 1 && std::abs(ratio - whole) < 1e-9 * whole;
  return is_whole ? value / whole : value * (from->factor / to->factor);
}

}  // namespace spikeloop
