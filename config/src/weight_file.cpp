#include "spikeloop/config/weight_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "music_text.hpp"
#include "spikeloop/config/data_file.hpp"
#include "spikeloop/config/npy_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/log.hpp"
#include "weight_json.hpp"

namespace spikeloop {

namespace {

using music_text::shown;

/// Not strict: what the older programs take when they cannot read the file.
WeightTable uniform_instead(const std::string& reason, const WeightOptions& options) {
  log::warning("{}", lengthened(ConfigurationError(options.named_in, reason).what(),
                                "; every weight is 1 / inputs"));
  return WeightTable::uniform();
}

std::uint32_t longest_row(const std::vector<std::uint64_t>& row_begin) {
  std::uint64_t longest = 0;
  for (std::size_t i = 1; i < row_begin.size(); ++i) {
    longest = std::max(longest, row_begin[i] - row_begin[i - 1]);
  }
  return static_cast<std::uint32_t>(std::min<std::uint64_t>(longest, kMaximumChannels + 1));
}

void check_even(const std::vector<std::uint64_t>& row_begin, const std::string& file) {
  for (std::size_t i = 2; i < row_begin.size(); ++i) {
    const auto length = row_begin[i] - row_begin[i - 1];
    if (length != row_begin[1]) {
      throw ConfigurationError(
          Location{file}, with_code(Code::weight_file,
                                    "row {} has {} weights, but row 0 has {}; write one weight an "
                                    "input in every row",
                                    i - 1, length, row_begin[1]));
    }
  }
}

/// Rows of the wanted length: missing weights are 0, surplus ones are left out.
WeightTable fitted(const std::vector<double>& values, const std::vector<std::uint64_t>& row_begin,
                   std::uint32_t rows, std::uint32_t columns, const std::string& file) {
  std::vector<double> result(std::size_t{rows} * columns, 0.0);
  std::string first_odd;
  for (std::uint32_t i = 0; i < rows; ++i) {
    const std::uint64_t begin = i + 1 < row_begin.size() ? row_begin[i] : 0;
    const std::uint64_t length = i + 1 < row_begin.size() ? row_begin[i + 1] - begin : 0;
    const std::uint64_t used = std::min<std::uint64_t>(length, columns);
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(begin), used,
                result.begin() + static_cast<std::ptrdiff_t>(std::size_t{i} * columns));
    if (length != columns && first_odd.empty()) {
      first_odd = fmt::format("row {} has {} of {} weights", i, length, columns);
    }
  }
  if (first_odd.empty() && row_begin.size() - 1 > rows) {
    first_odd = fmt::format("there are {} of {} rows", row_begin.size() - 1, rows);
  }
  if (!first_odd.empty()) {
    log::warning("{}: {}; missing weights are 0, surplus ones are left out", file, first_odd);
  }
  return WeightTable::dense(rows, columns, std::move(result));
}

void check_size(std::uint64_t rows, std::uint64_t columns, const std::string& file) {
  if (rows == 0 || columns == 0) {
    throw ConfigurationError(
        Location{file},
        with_code(Code::weight_file,
                  "the table has no weights; write [[0.1, 0.2], [0.3, 0.4]], one row an "
                  "output, or 'uniform' in place of the file"));
  }
  if (rows > kMaximumChannels || columns > kMaximumChannels) {
    throw ConfigurationError(Location{file},
                             with_code(Code::weight_file,
                                       "the table has {} rows of up to {} weights; at most {} "
                                       "of each are possible",
                                       rows, columns, kMaximumChannels));
  }
}

/// `row_begin`: where each row begins among the values, and where the last one ends.
WeightTable dense_table(std::vector<double> values, const std::vector<std::uint64_t>& row_begin,
                        const std::string& file, const WeightOptions& options) {
  const auto columns = longest_row(row_begin);
  check_size(row_begin.size() - 1, columns, file);
  const auto rows = static_cast<std::uint32_t>(row_begin.size() - 1);
  if (options.strict) {
    check_even(row_begin, file);
    return WeightTable::dense(rows, columns, std::move(values));
  }
  return fitted(values, row_begin, options.rows == 0 ? rows : options.rows,
                options.columns == 0 ? columns : options.columns, file);
}

/// The array's numbers, or what is wrong with it.
std::optional<std::vector<double>> read_values(const NpyArray& array, const std::string& file,
                                               const WeightOptions& options,
                                               ConfigurationError& problem) {
  if (array.surplus() != 0) {
    const std::string text = fmt::format("{} bytes follow the array", array.surplus());
    if (options.strict) {
      problem = ConfigurationError(
          Location{file}, with_code(Code::weight_file, "{}; write one array a file", text));
      return std::nullopt;
    }
    log::warning("{}: {} and are left out", file, text);
  }
  try {
    return array.values();
  } catch (const ConfigurationError& error) {
    problem = error;
    return std::nullopt;
  }
}

/// The table, or what is wrong with the .npy file.
std::optional<WeightTable> read_array(std::string_view bytes, const std::string& file,
                                      const WeightOptions& options, ConfigurationError& problem) {
  std::optional<NpyArray> array;
  try {
    array.emplace(bytes, file);
  } catch (const ConfigurationError& error) {
    problem = error;
    return std::nullopt;
  }
  check_size(array->rows(), array->columns(), file);
  auto values = read_values(*array, file, options, problem);
  if (!values) {
    return std::nullopt;
  }
  std::vector<std::uint64_t> row_begin(array->rows() + 1);
  for (std::size_t i = 0; i < row_begin.size(); ++i) {
    row_begin[i] = i * array->columns();
  }
  return dense_table(std::move(*values), row_begin, file, options);
}

/// The table, or what is wrong with the JSON.
std::optional<WeightTable> read_json(std::string_view text, const std::string& file,
                                     const WeightOptions& options, ConfigurationError& problem) {
  std::variant<WeightRows, WeightTable> read;
  try {
    read = read_weight_json(text, file, options.strict);
  } catch (const ConfigurationError& error) {
    problem = error;
    return std::nullopt;
  }
  if (auto* sparse = std::get_if<WeightTable>(&read)) {
    return std::move(*sparse);
  }
  auto& rows = std::get<WeightRows>(read);
  WeightTable table = dense_table(std::move(rows.values), rows.begin, file, options);
  table.fitted_tau_s = rows.fitted_tau_s;
  return table;
}

std::optional<double> short_form_weight(std::string_view text) {
  while (!text.empty() && music_text::is_space(text.front())) {
    text.remove_prefix(1);
  }
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

/// A short form that may have a weight behind its name.
struct ShortForm {
  std::string_view name;
  WeightTable (*plain)();
  WeightTable (*weighted)(double weight);
};
constexpr ShortForm kShortForms[] = {
    {"uniform", [] { return WeightTable::uniform(); },
     [](double weight) { return WeightTable::uniform(weight); }},
    {"one_to_one", [] { return WeightTable::one_to_one(); }, &WeightTable::one_to_one},
    {"blocks", [] { return WeightTable::blocks(); }, &WeightTable::blocks}};

/// "uniform", "uniform:0.01", "one_to_one:2", "blocks", "even"; nothing for a path.
std::optional<WeightTable> short_form(const std::string& written) {
  if (written == "even") {
    return WeightTable::even();
  }
  const auto colon = written.find(':');
  const std::string name = written.substr(0, colon);
  const auto* const form = std::ranges::find(kShortForms, name, &ShortForm::name);
  if (form == std::end(kShortForms)) {
    return std::nullopt;
  }
  if (colon == std::string::npos) {
    return form->plain();
  }
  const auto weight = short_form_weight(std::string_view(written).substr(colon + 1));
  if (!weight) {
    throw ConfigurationError(with_code(Code::not_a_number,
                                       "the weight in '{}' is not a finite number; write '{}:0.5'",
                                       shown(written), name));
  }
  return form->weighted(*weight);
}

std::string missing_text(const std::string& written, const WeightOptions& options) {
  const std::string slip =
      options.short_forms ? nearest(written, {"uniform", "one_to_one", "blocks"}) : std::string();
  return with_code(Code::missing_file, "there is no {} '{}' in {}; write its path{}{}",
                   options.what, shown(written), data_file_places(options.base_directory),
                   options.short_forms ? ", 'uniform', 'one_to_one' or 'blocks'" : "",
                   slip.empty() ? "" : fmt::format("; did you mean '{}'?", slip));
}

}  // namespace

WeightTable parse_weights(std::string_view text, const std::string& file,
                          const WeightOptions& options) {
  ConfigurationError problem("");
  // By its name as well, so that a broken array is not called broken JSON.
  const bool array = is_npy(text) || file.ends_with(".npy");
  if (auto table = array ? read_array(text, file, options, problem)
                         : read_json(text, file, options, problem)) {
    return std::move(*table);
  }
  if (options.strict) {
    throw ConfigurationError(problem);
  }
  return uniform_instead(problem.what(), options);
}

WeightTable read_weights(const std::string& written, const WeightOptions& options) {
  if (options.short_forms) {
    if (auto table = short_form(written)) {
      return std::move(*table);
    }
  }
  const auto path = find_data_file(written, options.base_directory);
  if (!path) {
    const std::string message = missing_text(written, options);
    if (options.strict) {
      throw ConfigurationError(message);
    }
    return uniform_instead(message, options);
  }
  std::string text;
  try {
    text = read_file(*path, options.what, options.maximum_bytes);
  } catch (const FileError& error) {
    if (options.strict) {
      throw;
    }
    return uniform_instead(error.what(), options);
  }
  return parse_weights(text, path->string(), options);
}

WeightLoader weight_loader(WeightOptions options) {
  return [options = std::move(options)](const WrittenValue& written) mutable {
    options.named_in = written.where;
    return read_weights(written.text, options);
  };
}

void write_weights(const std::filesystem::path& path, const WeightTable& table) {
  const WeightTable rows = table.compressed();
  if (path.extension() != ".json") {
    std::vector<double> values(std::size_t{rows.rows} * rows.columns, 0.0);
    for (std::uint32_t row = 0; row < rows.rows; ++row) {
      for (std::uint64_t k = rows.row_start[row]; k < rows.row_start[row + 1]; ++k) {
        values[std::size_t{row} * rows.columns + rows.column[k]] = rows.values[k];
      }
    }
    write_npy(path, rows.rows, rows.columns, values);
    return;
  }
  std::string text =
      fmt::format("{{\"rows\": {}, \"columns\": {}, \"entries\": [", rows.rows, rows.columns);
  for (std::uint32_t row = 0; row < rows.rows; ++row) {
    for (std::uint64_t k = rows.row_start[row]; k < rows.row_start[row + 1]; ++k) {
      text +=
          fmt::format("{}[{}, {}, {}]", k == 0 ? "" : ",\n ", row, rows.column[k], rows.values[k]);
    }
  }
  write_file(path.string(), text + "]}\n");
}

}  // namespace spikeloop
