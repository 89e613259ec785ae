#include "yaml_section.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <sstream>
#include "spikeloop/core/code.hpp"

namespace spikeloop::yaml_text {

namespace {

constexpr const char* kTooMany = "its aliases (*name) stand for more than 4000000 values";

/// Lines count from 0.
std::string_view line_of(std::string_view text, int line) {
  for (int i = 0; i < line; ++i) {
    const auto end = text.find('\n');
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return text.substr(0, text.find('\n'));
}

/// What yaml-cpp says, and what to look for.
std::string reason_of(const YAML::Exception& error, const std::string& text) {
  if (error.msg == kTooMany) {
    return fmt::format("{}; write the values themselves, or into a file", kTooMany);
  }
  if (error.msg == "bad file") {
    return "it is nested too deeply; close its brackets";
  }
  const std::string_view line = line_of(text, error.mark.line);
  const auto indent = line.substr(0, line.find_first_not_of(" \t"));
  if (indent.find('\t') != std::string_view::npos) {
    return fmt::format("{}; this line begins with a tab, write blanks", error.msg);
  }
  if (line.find("->") != std::string_view::npos && line.find('[') != std::string_view::npos) {
    return fmt::format("{}; put quotes round a connection that stands in brackets", error.msg);
  }
  return fmt::format("{}; look for a bracket, a quote or an indentation that does not match",
                     error.msg);
}

/// Where documents begin. Aliases may stand for aliases: what they all stand for is counted.
class Begins : public YAML::EventHandler {
 public:
  std::vector<YAML::Mark> marks;

  void OnDocumentStart(const YAML::Mark&) override { expected_ = true; }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { note(mark); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    note(mark, sizes_[anchor]);
  }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                const std::string&) override {
    note(mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    note(mark);
    open_.push_back({anchor, values_});
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    note(mark);
    open_.push_back({anchor, values_});
  }
  void OnMapEnd() override { close(); }

 private:
  struct Open {
    YAML::anchor_t anchor;
    std::uint64_t values_before;
  };

  void note(const YAML::Mark& mark, std::uint64_t more = 0) {
    constexpr std::uint64_t kMostAliased = 4'000'000;
    values_ += 1 + more;
    if (more > 0 && values_ > kMostAliased) {
      throw YAML::ParserException(mark, kTooMany);
    }
    if (expected_) {
      marks.push_back(mark);
      expected_ = false;
    }
  }
  void close() {
    sizes_[open_.back().anchor] = values_ - open_.back().values_before;
    open_.pop_back();
  }

  bool expected_ = false;
  std::uint64_t values_ = 0;
  std::vector<Open> open_;
  std::map<YAML::anchor_t, std::uint64_t> sizes_;
};

/// yaml-cpp takes seconds until it gives up. Brackets in texts and comments count, too: nobody
/// writes so many of them.
void refuse_depth(const std::string& text, const std::string& path) {
  constexpr int kMostOpen = 1000;
  int depth = 0;
  Location where{path, 1, 0};
  for (const char c : text) {
    where.line += c == '\n' ? 1 : 0;
    where.column = c == '\n' ? 0 : where.column + 1;
    depth += c == '[' || c == '{' ? 1 : (c == ']' || c == '}') && depth > 0 ? -1 : 0;
    if (depth > kMostOpen) {
      throw ConfigurationError(
          where,
          with_code(Code::syntax, "this is not YAML: it is nested too deeply; close its brackets"));
    }
  }
}

/// Of at most two documents: YAML::LoadAll finds documents for ever behind a ',' at the left
/// margin.
std::vector<YAML::Mark> first_documents(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  Begins begins;
  while (begins.marks.size() < 2 && parser.HandleNextDocument(begins)) {
  }
  return begins.marks;
}

}  // namespace

YAML::Node load(const std::string& text, const std::string& path, const std::string& what) {
  const auto where = [&](const YAML::Mark& mark) {
    return Location{path, mark.line + 1, mark.column + 1};
  };
  refuse_depth(text, path);
  try {
    const std::vector<YAML::Mark> begins = first_documents(text);
    if (begins.size() > 1 && begins[0].pos == begins[1].pos) {
      throw ConfigurationError(
          where(begins[0]),
          with_code(Code::syntax,
                    "this is not YAML: nothing can begin like this; write  key: value"));
    }
    if (begins.size() > 1) {
      throw ConfigurationError(
          where(begins[1]),
          with_code(Code::syntax,
                    "a second document begins; write one {} a file, without '---' inside it",
                    what));
    }
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    throw ConfigurationError(
        where(error.mark), with_code(Code::syntax, "this is not YAML: {}", reason_of(error, text)));
  }
}

Location place(const std::string& file, const YAML::Node& node) {
  const YAML::Mark mark = node.Mark();
  return mark.is_null() ? Location{file, 0, 0} : Location{file, mark.line + 1, mark.column + 1};
}

Location text_place(const std::string& file, const YAML::Node& node) {
  Location where = place(file, node);
  const bool quoted = node.Tag() == "!";
  where.column += quoted && where.line > 0 ? 1 : 0;
  return where;
}

std::string scalar(const std::string& file, const std::string& key, const YAML::Node& node) {
  if (!node.IsScalar() || node.Scalar().empty()) {
    throw ConfigurationError(
        place(file, node),
        with_code(Code::wrong_shape, "key '{}': expected one value, found {}", key,
                  node.IsMap()        ? "a map"
                  : node.IsSequence() ? "a list"
                                      : "nothing"));
  }
  return node.Scalar();
}

Section::Section(std::string file, std::string what, const YAML::Node& node,
                 const std::vector<std::string>& known)
    : Section(std::move(file), std::move(what), node, known,
              [](const ConfigurationError& error) { throw error; }) {}

Section::Section(std::string file, std::string what, const YAML::Node& node,
                 const std::vector<std::string>& known, const ErrorHandler& report)
    : file_(std::move(file)), what_(std::move(what)), where_(place(file_, node)) {
  if (!node.IsMap()) {
    throw ConfigurationError(
        where_, with_code(Code::wrong_shape,
                          "{} must be a map; write  key: value  lines, for example  {}: ...", what_,
                          known.empty() ? "name" : known.front()));
  }
  for (const auto& entry : node) {
    const Location here = place(file_, entry.first);
    if (!entry.first.IsScalar() || entry.first.Scalar().empty()) {
      report(ConfigurationError(
          here, with_code(Code::wrong_shape,
                          "{}: {} stands where a name has to; write  name: value", what_,
                          entry.first.IsMap()        ? "a map"
                          : entry.first.IsSequence() ? "a list"
                                                     : "nothing")));
      continue;
    }
    const std::string& key = entry.first.Scalar();
    if (key == "<<") {  // another YAML reader would merge a map here
      throw ConfigurationError(
          here, with_code(Code::wrong_shape,
                          "{}: '<<' is not read; write the other map's keys themselves", what_));
    }
    if (!known.empty() && std::find(known.begin(), known.end(), key) == known.end()) {
      report(ConfigurationError(here, with_code(Code::unknown_key, "{}: unknown key '{}'{}", what_,
                                                key, did_you_mean(key, known))));
      continue;
    }
    if (!entries_.emplace(key, entry.second).second) {
      report(ConfigurationError(here, with_code(Code::duplicate_key,
                                                "{}: duplicate key '{}'; "
                                                "the first is at {}",
                                                what_, key, key_places_[key].text())));
      continue;
    }
    keys_.push_back(key);
    key_places_[key] = here;
  }
}

const YAML::Node& Section::at(const std::string& key, const std::string& example) const {
  const auto found = entries_.find(key);
  if (found == entries_.end()) {
    throw ConfigurationError(
        where_, with_code(Code::missing_key, "{}: key '{}' is missing; write  {}: {}", what_, key,
                          key, example));
  }
  return found->second;
}

std::string Section::text(const std::string& key, const std::string& example) const {
  const YAML::Node& node = at(key, example);
  if (node.IsNull()) {
    throw ConfigurationError(
        where(key), with_code(Code::missing_key, "{}: key '{}' has no value; write  {}: {}", what_,
                              key, key, example));
  }
  return scalar(file_, key, node);
}

double Section::quantity(const std::string& key, const std::string& unit,
                         const std::string& example) const {
  const std::string written = text(key, example);
  try {
    return parse_quantity(written, unit);
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(where(key), fmt::format("{}: key '{}': {}", what_, key, error.what()));
  }
}

TimeNs Section::time(const std::string& key, const std::string& example) const {
  constexpr double kLongestMs = 1e9;  // 11 days
  const double nanoseconds = quantity(key, "ms", example) * 1e6;
  const bool whole = std::abs(nanoseconds - std::round(nanoseconds)) < 1e-3;
  if (!whole || nanoseconds < 1.0 || nanoseconds > kLongestMs * 1e6) {
    throw ConfigurationError(where(key),
                             with_code(Code::off_grid,
                                       "{}: {} '{}' is not a whole number of nanoseconds from "
                                       "1 ns to 1e9 ms; write for example {}",
                                       what_, key, entries_.at(key).Scalar(), example));
  }
  return std::llround(nanoseconds);
}

Location Section::where(const std::string& key) const {
  const auto found = entries_.find(key);
  if (found == entries_.end()) {
    return where_;
  }
  // What is not there has no place of its own.
  return found->second.IsNull() ? key_places_.at(key) : place(file_, found->second);
}

Parameters resolve_section(const Section& section,
                           const std::vector<ParameterDescription>& declared) {
  for (const ParameterDescription& parameter : declared) {
    if (!parameter.default_value) {  // resolve() would not know the place
      const bool text = parameter.type == ParameterType::text;
      section.at(parameter.name, text ? "NAME" : fmt::format("10 {}", parameter.unit));
    }
  }
  WrittenValues written;
  for (const std::string& key : section.keys()) {
    written[key] = {section.text(key, ""), section.where(key)};
  }
  return resolve(declared, written, {});
}

}  // namespace spikeloop::yaml_text
