#include "weight_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <tuple>

#include "json_text.hpp"
#include "music_text.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/log.hpp"
#include "text_file.hpp"

namespace spikeloop {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostBytes = 200'000'000;  // ten times as much in memory while it is read
constexpr std::string_view kDense = "[[0.1, 0.2], [0.3, 0.4]], one row an output";
constexpr std::string_view kSparse = R"({"rows": 2, "columns": 3, "entries": [[0, 2, 0.5]]})";
constexpr std::string_view kAxes = R"({"axes": [[-1, 1, 5, 0.2], [0, 3, 4, 0.5]]})";
constexpr std::string_view kAxis = "[first centre, last centre, number of centres, width]";
constexpr std::string_view kFitted = R"({"tau_s": 0.03, "weights": [[0.1, 0.2], [0.3, 0.4]]})";

struct Entry {
  std::uint32_t row = 0;
  std::uint32_t column = 0;
  double weight = 0;
};

class WeightJson {
 public:
  WeightJson(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  WeightRows rows(const Json& table) const {
    if (!table.is_array()) {
      wrong("the table", table, fmt::format("write an array of rows, {}", kDense));
    }
    WeightRows result;
    for (const Json& row : table) {
      const std::size_t i = result.begin.size() - 1;
      if (!row.is_array()) {
        wrong(fmt::format("row {}", i), row, fmt::format("write an array of weights: {}", kDense));
      }
      for (const Json& weight : row) {
        result.values.push_back(number(weight, [&] {
          return fmt::format("row {}, column {}", i, result.values.size() - result.begin.back());
        }));
      }
      result.begin.push_back(result.values.size());
    }
    return result;
  }

  /// As `spikeloop fit` writes them.
  WeightRows fitted(const Json& object) const {
    check_keys(object, {"tau_s", "weights"}, kFitted);
    WeightRows result = rows(object["weights"]);
    result.fitted_tau_s = number(object["tau_s"], [] { return "'tau_s'"; });
    return result;
  }

  /// All combinations of the axes' centres; the last axis changes first.
  WeightRows grid(const Json& object) const {
    check_keys(object, {"axes"}, kAxes);
    std::vector<Axis> axes;
    const Json& list = object["axes"];
    if (!list.is_array()) {
      wrong("'axes'", list, fmt::format("write an array of {}", kAxis));
    }
    if (list.empty()) {
      fail(fmt::format("'axes' is empty; write an array of {}", kAxis));
    }
    const double most = kMaximumChannels / (2.0 * static_cast<double>(list.size()));
    double cells = 1;
    for (const Json& item : list) {
      axes.push_back(axis(item, axes.size()));
      cells *= axes.back().count;
    }
    if (cells > most) {
      fail(fmt::format("the axes have {:.0f} combinations, more than {:.0f}; write fewer centres",
                       cells, most));
    }
    WeightRows result;
    std::vector<std::uint32_t> at(axes.size(), 0);
    for (bool more = true; more;) {
      for (std::size_t i = 0; i < axes.size(); ++i) result.values.push_back(axes[i].centre(at[i]));
      for (const Axis& axis : axes) result.values.push_back(axis.width);
      result.begin.push_back(result.values.size());
      more = false;
      for (std::size_t i = axes.size(); i-- > 0 && !more;) {
        more = ++at[i] < axes[i].count;
        if (!more) at[i] = 0;
      }
    }
    return result;
  }

  WeightTable sparse(const Json& object) const {
    check_keys(object, {"rows", "columns", "entries"}, kSparse);
    const std::uint32_t rows = count(object["rows"], "'rows'");
    const std::uint32_t columns = count(object["columns"], "'columns'");
    return table_of(entries(object["entries"], rows, columns), rows, columns);
  }

 private:
  struct Axis {
    double first;
    double last;
    std::uint32_t count;
    double width;
    double centre(std::uint32_t i) const {
      const double part = count == 1 ? 0 : static_cast<double>(i) / (count - 1);
      return first * (1 - part) + last * part;
    }
  };

  Axis axis(const Json& item, std::size_t i) const {
    if (!item.is_array()) {
      wrong(fmt::format("axis {}", i), item, fmt::format("write {}", kAxis));
    }
    if (item.size() != 4) {
      fail(fmt::format("axis {} has {} numbers; write {}", i, item.size(), kAxis));
    }
    const auto part = [&](const char* what) {
      return [i, what] { return fmt::format("the {} of axis {}", what, i); };
    };
    const Axis axis{number(item[0], part("first centre")), number(item[1], part("last centre")),
                    count(item[2], part("number of centres")()), number(item[3], part("width"))};
    if (axis.width <= 0) {
      fail(fmt::format("the width of axis {} is {}; write a number above 0", i, axis.width));
    }
    return axis;
  }

  void check_keys(const Json& object, const std::vector<std::string>& keys,
                  std::string_view example) const {
    for (const auto& item : object.items()) {
      if (std::ranges::find(keys, item.key()) == keys.end()) {
        fail(fmt::format("unknown key '{}'{}", music_text::shown(item.key()),
                         did_you_mean(item.key(), keys)));
      }
    }
    for (const std::string& key : keys) {
      const std::string quoted = '"' + key + '"';
      if (text_.find(quoted) != text_.rfind(quoted)) {
        fail(fmt::format("the key '{}' is given twice; remove one", key));
      }
      if (!object.contains(key)) {
        fail(fmt::format("the key '{}' is missing; write {}", key, example));
      }
    }
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw ConfigurationError(Location{file_}, with_code(Code::weight_file, message));
  }
  [[noreturn]] void wrong(std::string_view what, const Json& value, std::string_view remedy) const {
    fail(fmt::format("{} is {}; {}", what, json_text::shown_json(value), remedy));
  }

  /// `what` is made for an error alone: tables are large.
  template <typename What>
  double number(const Json& value, What&& what) const {
    if (!value.is_number()) {
      wrong(what(), value, "write a finite number");
    }
    return value.get<double>();
  }

  std::uint32_t count(const Json& value, const std::string& what) const {
    if (!value.is_number_integer() || value < 1 || value > kMaximumChannels) {
      wrong(what, value, fmt::format("write a whole number from 1 to {}", kMaximumChannels));
    }
    return value.get<std::uint32_t>();
  }

  std::vector<Entry> entries(const Json& list, std::uint32_t rows, std::uint32_t columns) const {
    if (!list.is_array()) {
      wrong("'entries'", list, "write an array of [row, column, weight]");
    }
    std::vector<Entry> result;
    for (const Json& item : list) {
      const auto name = [&] { return fmt::format("entry {}", result.size()); };
      if (!item.is_array()) {
        wrong(name(), item, "write [row, column, weight]");
      }
      if (item.size() != 3) {
        fail(fmt::format("{} has {} items; write [row, column, weight]", name(), item.size()));
      }
      const auto index = [&](std::size_t i, std::uint32_t end) {
        if (!item[i].is_number_integer() || item[i] < 0 || item[i] >= end) {
          fail(fmt::format(
              "{} is at row {}, column {}, but the table has {} rows and {} columns; both count "
              "from 0",
              name(), json_text::shown_json(item[0]), json_text::shown_json(item[1]), rows,
              columns));
        }
        return item[i].get<std::uint32_t>();
      };
      result.push_back({index(0, rows), index(1, columns), number(item[2], name)});
    }
    return result;
  }

  WeightTable table_of(std::vector<Entry> entries, std::uint32_t rows,
                       std::uint32_t columns) const {
    const auto place = [](const Entry& entry) { return std::tie(entry.row, entry.column); };
    std::ranges::sort(entries, {}, place);
    const auto twice = std::ranges::adjacent_find(entries, {}, place);
    if (twice != entries.end()) {
      fail(fmt::format("row {}, column {} has two weights; write one entry", twice->row,
                       twice->column));
    }
    WeightTable table;
    table.kind = WeightTable::Kind::sparse;
    table.rows = rows;
    table.columns = columns;
    table.row_start.assign(std::size_t{rows} + 1, 0);
    for (const Entry& entry : entries) {
      ++table.row_start[std::size_t{entry.row} + 1];
      table.column.push_back(entry.column);
      table.values.push_back(entry.weight);
    }
    for (std::size_t i = 1; i < table.row_start.size(); ++i) {
      table.row_start[i] += table.row_start[i - 1];
    }
    return table;
  }

  std::string_view text_;
  const std::string& file_;
};

/// The first value of a text that goes on behind it; nothing when that is not JSON either.
std::optional<Json> first_value(std::string_view text, const std::string& file) {
  std::istringstream stream{std::string(text)};
  Json value;
  try {
    stream >> value;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
  stream >> std::ws;
  log::warning("{}: text after the end of the table is left out",
               locate(text, static_cast<std::size_t>(stream.tellg()), file).text());
  return value;
}

}  // namespace

std::variant<WeightRows, WeightTable> read_weight_json(std::string_view text,
                                                       const std::string& file, bool whole) {
  if (const std::string problem = json_text::not_text(text); !problem.empty()) {
    throw ConfigurationError(Location{file},
                             with_code(Code::weight_file, "{}; write {}", problem, kDense));
  }
  if (text.size() > kMostBytes) {
    throw ConfigurationError(Location{file},
                             with_code(Code::weight_file,
                                       "the table has {} MB of JSON, more than {} MB; write it as "
                                       "a .npy file",
                                       text.size() / 1'000'000, kMostBytes / 1'000'000));
  }
  Json json;
  try {
    json = Json::parse(text, nullptr, true, true);  // json_text::parse() takes twice as long
  } catch (const Json::exception&) {
    auto first = whole ? std::nullopt : first_value(text, file);
    // Moved: the copy of what is nested deeply overflows the stack. parse() throws with the place.
    json = first ? std::move(*first) : json_text::parse(text, file);
  }
  const WeightJson reader(text, file);
  if (json.is_object()) {
    if (json.contains("weights") || json.contains("tau_s")) {
      return reader.fitted(json);
    }
    return json.contains("axes") ? std::variant<WeightRows, WeightTable>(reader.grid(json))
                                 : reader.sparse(json);
  }
  return reader.rows(json);
}

}  // namespace spikeloop
