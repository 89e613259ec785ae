#include "weight_table_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "json_text.hpp"
#include "music_text.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop {

namespace {

const std::vector<std::string> kKeys = {"rows", "columns", "entries"};
constexpr std::string_view kDenseForm = "[[0.1, 0.2], [0.3, 0.4]], one row an output";

}  // namespace

void WeightTableReader::fail(const std::string& message) const {
  throw ConfigurationError(Location{file_}, with_code(Code::weight_file, message));
}

/// "row 1, column 2": where the next number would stand.
std::string WeightTableReader::at() const {
  switch (place_) {
    case Place::rows:
      return fmt::format("row {}", row_begin_.size() - 1);
    case Place::row:
      return fmt::format("row {}, column {}", row_begin_.size() - 1,
                         values_.size() - row_begin_.back());
    case Place::object:
      return fmt::format("'{}'", music_text::shown(key_));
    case Place::entries:
      return fmt::format("entry {}", entries_.size());
    case Place::entry:
      return fmt::format("entry {}, item {}", entries_.size(), items_.size());
    case Place::before:
    case Place::after:
      return "the table";
  }
  return {};
}

bool WeightTableReader::wrong(const std::string& what) {
  std::string remedy = "write a finite number";
  if (place_ == Place::before) {
    remedy = fmt::format("write an array of rows, {}", kDenseForm);
  } else if (place_ == Place::rows) {
    remedy = fmt::format("write an array of weights: {}", kDenseForm);
  } else if (place_ == Place::object) {
    remedy = key_ == "entries" ? "write an array of [row, column, weight]" : "write a whole number";
  } else if (place_ == Place::entries) {
    remedy = "write [row, column, weight]";
  }
  fail(fmt::format("{} is {}; {}", at(), what, remedy));
}

bool WeightTableReader::number_integer(std::int64_t value) {
  return number(static_cast<double>(value), true, fmt::format("{}", value));
}

bool WeightTableReader::number_unsigned(std::uint64_t value) {
  return number(static_cast<double>(value), true, fmt::format("{}", value));
}

bool WeightTableReader::number_float(double value, const std::string& written) {
  return number(value, false, music_text::shown(written));
}

bool WeightTableReader::string(const std::string& value) {
  return wrong(fmt::format("the text \"{}\"", music_text::shown(value)));
}

bool WeightTableReader::number(double value, bool whole, const std::string& written) {
  switch (place_) {
    case Place::row:
      if (!std::isfinite(value)) {
        return wrong(written);
      }
      values_.push_back(value);
      return true;
    case Place::object:
      return object_number(value, whole, written);
    case Place::entry:
      return entry_number(value, whole, written);
    default:
      return wrong(fmt::format("the number {}", written));
  }
}

bool WeightTableReader::object_number(double value, bool whole, const std::string& written) {
  if (key_ == "entries" || !whole) {
    return wrong(fmt::format("the number {}", written));
  }
  if (value < 1 || value > kMaximumChannels) {
    fail(fmt::format("'{}' is {}; write a number from 1 to {}", key_, written, kMaximumChannels));
  }
  (key_ == "rows" ? rows_ : columns_) = static_cast<std::uint32_t>(value);
  return true;
}

bool WeightTableReader::entry_number(double value, bool whole, const std::string& written) {
  if (items_.size() == 3) {
    fail(fmt::format("entry {} has more than three items; write [row, column, weight]",
                     entries_.size()));
  }
  if (items_.size() < 2) {
    const char* kind = items_.empty() ? "row" : "column";
    if (!whole || value < 0 || value >= kMaximumChannels) {
      fail(fmt::format("the {} of entry {} is {}; write a whole number from 0", kind,
                       entries_.size(), written));
    }
  } else if (!std::isfinite(value)) {
    return wrong(written);
  }
  items_.push_back(value);
  return true;
}

bool WeightTableReader::start_object(std::size_t) {
  if (place_ != Place::before) {
    return wrong("an object");
  }
  sparse_ = true;
  place_ = Place::object;
  return true;
}

bool WeightTableReader::key(const std::string& name) {
  if (std::find(kKeys.begin(), kKeys.end(), name) == kKeys.end()) {
    fail(fmt::format("unknown key '{}'{}", music_text::shown(name), did_you_mean(name, kKeys)));
  }
  if (!keys_.insert(name).second) {
    fail(fmt::format("the key '{}' is given twice; remove one", name));
  }
  key_ = name;
  return true;
}

bool WeightTableReader::end_object() {
  for (const auto& name : kKeys) {
    if (!keys_.contains(name)) {
      fail(
          fmt::format("the key '{}' is missing; write {{\"rows\": 2, \"columns\": 3, \"entries\": "
                      "[[0, 2, 0.5]]}}",
                      name));
    }
  }
  place_ = Place::after;
  return true;
}

bool WeightTableReader::start_array(std::size_t) {
  if (place_ == Place::before) {
    place_ = Place::rows;
  } else if (place_ == Place::rows) {
    place_ = Place::row;
  } else if (place_ == Place::object && key_ == "entries") {
    place_ = Place::entries;
  } else if (place_ == Place::entries) {
    place_ = Place::entry;
    items_.clear();
  } else {
    return wrong("an array");
  }
  return true;
}

bool WeightTableReader::end_array() {
  if (place_ == Place::row) {
    row_begin_.push_back(values_.size());
    place_ = Place::rows;
  } else if (place_ == Place::rows) {
    place_ = Place::after;
  } else if (place_ == Place::entry) {
    finish_entry();
    place_ = Place::entries;
  } else {
    place_ = Place::object;
  }
  return true;
}

void WeightTableReader::finish_entry() {
  if (items_.size() != 3) {
    fail(fmt::format("entry {} has {} of three items; write [row, column, weight]", entries_.size(),
                     items_.size()));
  }
  entries_.push_back(
      {static_cast<std::uint32_t>(items_[0]), static_cast<std::uint32_t>(items_[1]), items_[2]});
}

bool WeightTableReader::parse_error(std::size_t position, const std::string&,
                                    const Json::exception& error) {
  error_.offset = position == 0 ? 0 : position - 1;
  error_.reason = json_text::reason(error.what());
  // Python and JavaScript write these for numbers that are none.
  const std::string_view rest = text_.substr(std::min(error_.offset, text_.size()));
  for (const std::string_view word : {"NaN", "nan", "Infinity", "inf"}) {
    const auto first = rest.empty() ? std::string_view::npos : word.find(rest[0]);
    const bool begun = first < 2 && error_.offset >= first &&
                       text_.substr(error_.offset - first).starts_with(word);
    if (begun && (place_ == Place::row || place_ == Place::entry)) {
      error_.offset -= first;
      error_.reason = fmt::format("{} is {}; write a finite number", at(), word);
      return false;
    }
  }
  return false;
}

WeightTable WeightTableReader::sparse_table() {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    if (entry.row >= rows_ || entry.column >= columns_) {
      fail(
          fmt::format("entry {} is at row {}, column {}, but the table has {} rows and {} columns; "
                      "both count from 0",
                      i, entry.row, entry.column, rows_, columns_));
    }
  }
  const auto place = [](const Entry& entry) { return std::tie(entry.row, entry.column); };
  std::sort(entries_.begin(), entries_.end(),
            [&](const Entry& a, const Entry& b) { return place(a) < place(b); });
  const auto twice =
      std::adjacent_find(entries_.begin(), entries_.end(),
                         [&](const Entry& a, const Entry& b) { return place(a) == place(b); });
  if (twice != entries_.end()) {
    fail(fmt::format("row {}, column {} has two weights; write one entry", twice->row,
                     twice->column));
  }
  WeightTable table;
  table.kind = WeightTable::Kind::sparse;
  table.rows = rows_;
  table.columns = columns_;
  table.row_start.assign(std::size_t{rows_} + 1, 0);
  for (const Entry& entry : entries_) {
    ++table.row_start[std::size_t{entry.row} + 1];
    table.column.push_back(entry.column);
    table.values.push_back(entry.weight);
  }
  for (std::size_t i = 1; i < table.row_start.size(); ++i) {
    table.row_start[i] += table.row_start[i - 1];
  }
  return table;
}

}  // namespace spikeloop
