#include "model_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "spikeloop/core/code.hpp"

namespace spikeloop::vehicle {
namespace {

constexpr std::string_view kSpace = " \t\r\n";

struct Bound {
  std::string_view name;
  double most;
  std::string_view element{};  ///< empty: any
};

constexpr Bound kBounds[] = {{"pos", 1e6},
                             {"size", 1e5, "numeric"},
                             {"size", 1e6},
                             {"fromto", 1e6},
                             {"width", 16384},
                             {"height", 16384},
                             {"nrow", 10000},
                             {"ncol", 10000},
                             {"count", 1000},
                             {"dim", 1e5},
                             {"njmax", 1e6},
                             {"nconmax", 1e6},
                             {"nstack", 1e8},
                             {"nuserdata", 1e6},
                             {"nkey", 1e5},
                             {"nuser_body", 1e4},
                             {"nuser_jnt", 1e4},
                             {"nuser_geom", 1e4},
                             {"nuser_site", 1e4},
                             {"nuser_cam", 1e4},
                             {"nuser_tendon", 1e4},
                             {"nuser_actuator", 1e4},
                             {"nuser_sensor", 1e4},
                             {"iterations", 1e6},
                             {"mpr_iterations", 1e6},
                             {"noslip_iterations", 1e6},
                             {"offsamples", 64},
                             {"shadowsize", 16384},
                             {"numslices", 1000},
                             {"numstacks", 1000},
                             {"numquads", 1000}};

/// Reads a text from left to right, and counts its lines.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : text_(text) {}

  bool at_end() const { return at_ == text_.size(); }
  int line() const { return line_; }
  bool starts_with(std::string_view word) const { return text_.substr(at_).starts_with(word); }

  /// Moves to the first of `characters`, or to the end; returns the text up to there.
  std::string_view until_any(std::string_view characters) {
    return move_to(text_.find_first_of(characters, at_));
  }
  /// Moves behind `word`, or to the end; returns the text up to the word.
  std::string_view until(std::string_view word) {
    const std::string_view passed = move_to(text_.find(word, at_));
    move_to(at_ + word.size());
    return passed;
  }
  void skip_space() { move_to(text_.find_first_not_of(kSpace, at_)); }
  char next() {
    const char c = at_end() ? '\0' : text_[at_];
    move_to(at_ + 1);
    return c;
  }

 private:
  std::string_view move_to(std::size_t end) {
    const std::string_view passed = text_.substr(at_, std::min(end, text_.size()) - at_);
    at_ += passed.size();
    line_ += static_cast<int>(std::ranges::count(passed, '\n'));
    return passed;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

/// The attributes of the element whose '<' has been read. Returns false at a syntax error.
bool parse_element(Cursor& cursor, std::vector<Attribute>& attributes) {
  const std::string_view element = cursor.until_any(" \t\r\n/>");
  while (true) {
    cursor.skip_space();
    if (cursor.at_end() || cursor.starts_with(">") || cursor.starts_with("/")) {
      cursor.until(">");
      return !cursor.at_end();
    }
    const int line = cursor.line();
    const std::string_view name = cursor.until_any(" \t\r\n=>");
    cursor.skip_space();
    if (cursor.next() != '=') return false;
    cursor.skip_space();
    const char quote = cursor.next();
    if (quote != '"' && quote != '\'') return false;
    attributes.push_back({element, name, cursor.until({&quote, 1}), line});
  }
}

/// Calls `use` for each number of a list; words that are no numbers are left out.
template <typename Use>
void for_each_number(std::string_view list, Use&& use) {
  while (true) {
    list.remove_prefix(std::min(list.find_first_not_of(kSpace), list.size()));
    if (list.empty()) return;
    const std::string word(list.substr(0, list.find_first_of(kSpace)));
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (*end == '\0') use(word, value);
    list.remove_prefix(word.size());
  }
}

void check_attribute(const std::string& path, const Attribute& attribute) {
  const auto* const bound = std::ranges::find_if(kBounds, [&](const Bound& candidate) {
    return candidate.name == attribute.name &&
           (candidate.element.empty() || candidate.element == attribute.element);
  });
  if (bound == std::end(kBounds)) return;
  for_each_number(attribute.value, [&](const std::string& word, double value) {
    if (!(std::abs(value) <= bound->most)) {
      throw ConfigurationError(Location{path, attribute.line},
                               with_code(Code::out_of_bounds,
                                         "<{0}>: {1}=\"{2}\" is out of range; write a number from "
                                         "-{3:.10g} to {3:.10g}",
                                         attribute.element, attribute.name, word, bound->most));
    }
  });
}

}  // namespace

std::vector<Attribute> parse_attributes(std::string_view text) {
  std::vector<Attribute> attributes;
  Cursor cursor(text);
  while (cursor.until("<"), !cursor.at_end()) {
    if (cursor.starts_with("!--")) {
      cursor.until("-->");
    } else if (cursor.starts_with("![CDATA[")) {
      cursor.until("]]>");
    } else if (cursor.starts_with("!") || cursor.starts_with("?") || cursor.starts_with("/")) {
      cursor.until(">");
    } else if (!parse_element(cursor, attributes)) {
      break;
    }
  }
  return attributes;
}

void check_numbers(const std::vector<ModelText>& files) {
  for (const auto& [path, text] : files) {
    for (const Attribute& attribute : parse_attributes(text)) {
      check_attribute(path, attribute);
    }
  }
}

Location find_attribute(const std::vector<ModelText>& files, std::string_view element,
                        std::string_view attribute, std::string_view name) {
  for (const auto& [path, text] : files) {
    const char* current = nullptr;  // identifies the element: its attributes share one string_view
    bool is_wanted = false;
    int line = 0;
    for (const Attribute& found : parse_attributes(text)) {
      if (found.element != element) continue;
      if (found.element.data() != current) {
        current = found.element.data();
        is_wanted = name.empty();
        line = 0;
      }
      is_wanted = is_wanted || (found.name == "name" && found.value == name);
      if (found.name == attribute) line = found.line;
      if (is_wanted && line > 0) return {path, line};
    }
  }
  return {files.empty() ? std::string() : files.front().path};
}

}  // namespace spikeloop::vehicle
