#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "node_import.hpp"

namespace spikeloop::app {
namespace {

/// The whole text is a number.
bool is_number(const std::string& text) {
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0' && std::isspace(static_cast<unsigned char>(text[0])) == 0;
}

bool is_plain(const std::string& text) {
  constexpr std::array kWords{"true", "false", "yes", "no", "on", "off", "null", "~"};
  static constexpr std::string_view kOther = "_/.,+-*^()";
  const auto allowed = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == ' ' ||
           kOther.find(c) != std::string_view::npos;
  };
  // "30 ms", but neither a date nor 0x10.
  const bool begins_well =
      !text.empty() && (std::isalpha(static_cast<unsigned char>(text[0])) || text[0] == '/' ||
                        text[0] == '.' || text.find(' ') != std::string::npos);
  return begins_well && text.back() != ' ' && std::ranges::all_of(text, allowed) &&
         std::ranges::find(kWords, text) == kWords.end();
}

/// "uniform", or "uniform:0.01".
std::string short_form(const char* name, const WeightTable& table) {
  return table.values.empty() ? name : fmt::format("\"{}:{}\"", name, table.values.front());
}

std::string dense_text(const WeightTable& table) {
  std::string text;
  for (std::uint32_t row = 0; row < table.rows; ++row) {
    const auto begin = table.values.begin() + std::ptrdiff_t{row} * table.columns;
    text += fmt::format("\n      - [{}]", fmt::join(begin, begin + table.columns, ", "));
  }
  return text;
}

std::string sparse_text(const WeightTable& table) {
  std::vector<std::string> entries;
  for (std::uint32_t row = 0; row < table.rows; ++row) {
    for (auto i = table.row_start[row]; i < table.row_start[row + 1]; ++i) {
      entries.push_back(fmt::format("[{}, {}, {}]", row, table.column[i], table.values[i]));
    }
  }
  return fmt::format("{{rows: {}, columns: {}, entries: [{}]}}", table.rows, table.columns,
                     fmt::join(entries, ", "));
}

}  // namespace

std::string yaml_quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string yaml_text(const std::string& text) {
  return is_number(text) || is_plain(text) ? text : yaml_quoted(text);
}

std::string with_unit(const std::string& value, const std::string& unit) {
  if (unit.empty() || unit == "1" || !is_number(value)) {
    return yaml_text(value);
  }
  const double number = std::strtod(value.c_str(), nullptr);
  if (number == 0) {
    return "0";
  }
  if (unit == "s" && std::abs(number) < 1) {
    std::string shorter = fmt::format("{:.15g} ms", number * 1e3);
    if (parse_quantity(shorter, unit) == number) {
      return shorter;
    }
  }
  return fmt::format("{} {}", value, unit);
}

std::string yaml_value(const ParameterDescription& parameter, const std::string& text,
                       const Location& where) {
  if (parameter.type == ParameterType::number) {
    return with_unit(text, parameter.unit);
  }
  if (parameter.type == ParameterType::boolean) {
    return text;
  }
  if (parameter.type != ParameterType::list) {
    return yaml_text(text);
  }
  const Parameters read = resolve({parameter}, {{parameter.name, {text, where}}}, {});
  const ParameterDescription& each = parameter.inner.front();
  std::vector<std::string> entries;
  if (each.type != ParameterType::map) {
    for (const double number : read.numbers(parameter.name)) {
      entries.push_back(with_unit(fmt::format("{}", number), each.unit));
    }
    return fmt::format("[{}]", fmt::join(entries, ", "));
  }
  for (const Parameters::Entry& entry : read.entries(parameter.name)) {
    entries.push_back(yaml_quoted(entry.values.text(each.plain_key)));
  }
  return fmt::format("[{}]", fmt::join(entries, ", "));
}

std::string yaml_table(const WeightTable& table) {
  switch (table.kind) {
    case WeightTable::Kind::uniform:
      return short_form("uniform", table);
    case WeightTable::Kind::one_to_one:
      return short_form("one_to_one", table);
    case WeightTable::Kind::blocks:
      return short_form("blocks", table);
    case WeightTable::Kind::sparse:
      return sparse_text(table);
    default:
      return dense_text(table);
  }
}

}  // namespace spikeloop::app
