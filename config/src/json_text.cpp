#include "json_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <vector>

#include "music_text.hpp"
#include "spikeloop/core/code.hpp"
#include "text_file.hpp"

namespace spikeloop::json_text {

std::string reason(const std::string& message) {
  std::string_view rest = message;
  if (const auto column = rest.find(", column "); column != std::string_view::npos) {
    rest.remove_prefix(std::min(rest.size(), rest.find(": ", column) + 2));
  } else if (const auto bracket = rest.find("] "); bracket != std::string_view::npos) {
    rest.remove_prefix(bracket + 2);
  }
  if (const auto dash = rest.find(" - ");
      rest.starts_with("syntax error while parsing ") && dash != std::string_view::npos) {
    rest.remove_prefix(dash + 3);
  }
  return fmt::format("not JSON: {}", rest);
}

std::string not_text(std::string_view text) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    return "the file is empty";
  }
  constexpr std::size_t kLooked = 4096;
  for (std::size_t i = 0; i < std::min(text.size(), kLooked); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if (c < 0x20 && c != '\t' && c != '\n' && c != '\r') {
      return fmt::format("this is not a text file (byte {} is 0x{:02x})", i, c);
    }
  }
  return {};
}

namespace {

/// Tells the parser's place while it reads.
class Reading {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  Reading(const char* at, const char** seen) : at_(at), seen_(seen) {}
  reference operator*() const { return *at_; }
  Reading& operator++() {
    *seen_ = ++at_;
    return *this;
  }
  bool operator==(const Reading& other) const { return at_ == other.at_; }
  bool operator!=(const Reading& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  const char** seen_;
};

/// Python writes NaN and Infinity, which are not JSON. `byte` counts from 1, as nlohmann-json does.
std::string number_hint(std::string_view text, std::size_t byte) {
  const std::string_view near = text.substr(std::max<std::size_t>(byte, 2) - 2, 9);
  for (const std::string_view word : {"NaN", "nan", "Infinity", "inf"}) {
    if (near.find(word) != std::string_view::npos) {
      return fmt::format("; {} is not a number of JSON: write a finite one", word);
    }
  }
  return {};
}

}  // namespace

nlohmann::ordered_json parse(std::string_view text, const std::string& file) {
  using json = nlohmann::ordered_json;
  if (const auto problem = not_text(text); !problem.empty()) {
    throw ConfigurationError(Location{file},
                             with_code(Code::syntax, "{}; write a JSON object", problem));
  }
  std::vector<std::set<std::string>> keys;
  std::string twice;
  std::size_t place = 0;
  const char* seen = text.data();
  const auto watch = [&](int, json::parse_event_t event, json& parsed) {
    if (event == json::parse_event_t::object_start) {
      keys.emplace_back();
    } else if (event == json::parse_event_t::object_end) {
      keys.pop_back();
    } else if (event == json::parse_event_t::key) {
      const auto key = parsed.get<std::string>();
      if (!keys.back().insert(key).second && twice.empty()) {
        twice = key;
        place = text.rfind('"' + key + '"', static_cast<std::size_t>(seen - text.data()));
      }
    }
    return true;
  };
  json value;
  try {
    const char* const end = text.data() + text.size();
    value = json::parse(Reading(text.data(), &seen), Reading(end, &seen), watch, true, true);
  } catch (const json::parse_error& error) {
    throw ConfigurationError(
        locate(text, error.byte == 0 ? 0 : error.byte - 1, file),
        with_code(Code::syntax, "{}{}", reason(error.what()), number_hint(text, error.byte)));
  } catch (const json::exception& error) {
    throw ConfigurationError(Location{file}, with_code(Code::syntax, reason(error.what())));
  }
  if (!twice.empty()) {
    throw ConfigurationError(
        place == std::string_view::npos ? Location{file} : locate(text, place, file),
        with_code(Code::duplicate_key, "the key '{}' is given twice; remove one",
                  music_text::shown(twice)));
  }
  return value;
}

Location locate_key(std::string_view text, const std::vector<std::string>& keys,
                    const std::string& file) {
  std::optional<std::size_t> found;
  for (const std::string& key : keys) {
    const auto place = text.find('"' + key + '"', found.value_or(0));
    if (place == std::string_view::npos) {
      break;  // escaped in another way: its parent is near enough
    }
    found = place;
  }
  return found ? locate(text, *found, file) : Location{file};
}

WrittenValue written_value(const nlohmann::ordered_json& value, const Location& where) {
  if (!value.is_structured()) {
    return {value.is_string() ? value.get<std::string>() : value.dump(), where};
  }
  return {value.dump(), where, [value, where] {
            std::vector<WrittenEntry> entries;
            for (const auto& item : value.items()) {
              entries.push_back(
                  {value.is_object() ? item.key() : "", written_value(item.value(), where)});
            }
            return entries;
          }};
}

std::string shown_json(const nlohmann::ordered_json& value) {
  if (value.is_structured()) {  // may be nested deeper than the stack allows to print
    return value.is_array() ? "an array" : "an object";
  }
  return music_text::shown(
      value.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace spikeloop::json_text
