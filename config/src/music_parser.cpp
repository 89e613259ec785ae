// A parser of MUSIC's grammar, one character ahead:
//
//   file       := { blanks | '[' label ']' | key '=' value | connection | '#' comment }
//   label      := text up to ']', '\c' stands for c
//   key        := text up to '=', '->' or '<-', '\c' stands for c
//   value      := '"' anything, '\c' stands for c '"' | text up to the line's end or '#', where
//   '\c'
//                 stands for c (a line end, too) and trailing blanks go
//   connection := [app.]port ('->' | '<-') [app.]port [ '[' [width] [, how [, how]] ']' ]
//
// Only text after a label's ']' and after a closing quote must be a comment; what follows the ']'
// of a width is read as if it stood on the next line.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <unordered_map>

#include "music_text.hpp"
#include "spikeloop/config/music_file.hpp"
#include "spikeloop/config/older_programs.hpp"
#include "spikeloop/core/code.hpp"
#include "text_file.hpp"

namespace spikeloop {
namespace {

using music_text::is_blank;
using music_text::is_line_end;
using music_text::is_space;
using music_text::shown;
using music_text::strip_trailing;

constexpr int kEnd = -1;

class Parser {
 public:
  Parser(std::string_view text, const std::string& path) : text_(text) { file_.path = path; }

  MusicFile parse();

 private:
  struct Endpoint {
    std::string app;
    std::string port;
  };
  struct Options {
    std::string width;
    std::string communication;
    std::string processing;
  };

  void check_bytes() const;
  void parse_section();
  void parse_entry();
  void parse_key_value(const std::string& key, const Location& where);
  std::string parse_quoted(const std::string& key, const Location& where);
  std::string parse_bare(const std::string& key, const Location& where);
  void parse_connection(const std::string& left, bool to_right, const Location& where);
  std::string read_right_side();
  Options read_options();
  std::string read_width(bool& more);
  std::string read_option(bool& more, bool last);
  void apply(const Options& options, MusicConnection& connection) const;

  Endpoint endpoint(const std::string& text, std::string_view role, const Location& where) const;
  void check_port(const std::string& port, const Location& where) const;
  void store(const std::string& key, std::string value, const Location& where);
  void note(const Location& where, std::string message) {
    file_.warnings.push_back(warning_at(where, message));
  }
  void skip_blanks();
  void skip_comment();

  int peek() const {
    return position_ < text_.size() ? static_cast<unsigned char>(text_[position_]) : kEnd;
  }
  char get();
  bool at_line_end() const { return peek() == kEnd || is_line_end(peek()); }
  Location here() const { return {file_.path, line_, column_}; }
  [[noreturn]] static void fail(const Location& where, const std::string& message) {
    throw ConfigurationError(where, with_code(Code::syntax, message));
  }
  static void check_name(std::string_view kind, std::string_view name, const Location& where) {
    if (const auto reason = music_text::unportable_name(kind, name); !reason.empty()) {
      throw ConfigurationError(where, reason);
    }
  }

  std::string_view text_;
  std::size_t position_ = 0;
  int line_ = 1;
  int column_ = 1;
  MusicFile file_;
  std::optional<std::size_t> section_;                        ///< none: the global part
  std::unordered_map<std::string, std::size_t> sections_;     ///< label to place
  std::unordered_map<std::string, std::size_t> global_keys_;  ///< name to place
  std::vector<std::unordered_map<std::string, std::size_t>> section_keys_;
};

char Parser::get() {
  const char c = text_[position_++];
  if (c == '\n' || (c == '\r' && peek() != '\n')) {
    ++line_;
    column_ = 1;
  } else if ((static_cast<unsigned char>(c) & 0xC0) != 0x80) {  // not inside a UTF-8 character
    ++column_;
  }
  return c;
}

void Parser::skip_blanks() {
  while (is_blank(peek())) {
    get();
  }
}

void Parser::skip_comment() {
  while (!at_line_end()) {
    get();
  }
}

void Parser::check_bytes() const {
  if (text_.starts_with("\xEF\xBB\xBF")) {
    fail({file_.path, 1, 1},
         "the file begins with a UTF-8 byte order mark, which MUSIC takes for a part of the first "
         "line; save it as UTF-8 without byte order mark");
  }
  if (text_.starts_with("\xFF\xFE") || text_.starts_with("\xFE\xFF")) {
    fail({file_.path, 1, 1}, "the file is UTF-16 text; save it as UTF-8 without byte order mark");
  }
  if (const auto zero = text_.find('\0'); zero != std::string_view::npos) {
    fail(locate(text_, zero, file_.path),
         "a zero byte: this is not a text file; give the path of a .music file");
  }
}

MusicFile Parser::parse() {
  check_bytes();
  while (peek() != kEnd) {
    if (is_space(peek())) {
      get();
    } else if (peek() == '[') {
      parse_section();
    } else if (peek() == '#') {
      skip_comment();
    } else {
      parse_entry();
    }
  }
  return std::move(file_);
}

void Parser::parse_section() {
  const Location where = here();
  get();
  skip_blanks();
  std::string label;
  while (peek() != ']') {
    if (peek() == '\\') {
      get();
    }
    if (at_line_end()) {
      fail(where, fmt::format("the section '[{}' has no ']'; write '[{}]'", shown(label),
                              label.empty() ? "label" : shown(label)));
    }
    label += get();
  }
  get();
  strip_trailing(label);
  skip_blanks();
  if (peek() == '#') {
    skip_comment();
  }
  if (!at_line_end()) {
    fail(here(), fmt::format("text after the section '[{}]'; write it on the next line, or '#' "
                             "before a comment",
                             shown(label)));
  }
  check_name("label", label, where);
  if (label.empty()) {  // "[]" goes back to the global part
    section_.reset();
    return;
  }
  const auto [found, is_new] = sections_.emplace(label, file_.sections.size());
  section_ = found->second;
  if (is_new) {
    file_.sections.push_back({label, {}, where});
    section_keys_.emplace_back();
  } else {
    note(where, with_code(Code::duplicate_name,
                          "the section '[{}]' was opened in line {} already, and MUSIC takes both "
                          "for one; write it once",
                          shown(label), file_.sections[*section_].where.line));
  }
}

void Parser::parse_entry() {
  const Location where = here();
  std::string key;
  for (;;) {
    if (at_line_end() || peek() == '#') {
      strip_trailing(key);
      fail(where, music_text::no_entry_message(key));
    }
    const char c = get();
    if (c == '=') {
      strip_trailing(key);
      return parse_key_value(key, where);
    }
    if ((c == '-' && peek() == '>') || (c == '<' && peek() == '-')) {
      get();
      return parse_connection(key, c == '-', where);
    }
    if (c == '\\') {
      if (at_line_end()) {
        fail(where, fmt::format("the key '{}' ends with a backslash; only a value may go on in the "
                                "next line, write the key on one line",
                                shown(key)));
      }
      key += get();
    } else {
      key += c;
    }
  }
}

void Parser::parse_key_value(const std::string& key, const Location& where) {
  if (key.empty()) {
    fail(where, "no key before '='; write 'key=value'");
  }
  check_name("key", key, where);
  skip_blanks();
  const bool quoted = peek() == '"';
  if (peek() == '>' && key.find('.') != std::string::npos) {
    fail(where,
         fmt::format("'{}=>' would be a key for MUSIC; write a connection with '->'", shown(key)));
  }
  store(key, quoted ? parse_quoted(key, where) : parse_bare(key, where), where);
}

std::string Parser::parse_quoted(const std::string& key, const Location& where) {
  const Location opening = here();
  get();
  std::string value;
  while (peek() != '"') {
    if (peek() == '\\') {
      get();
    }
    if (peek() == kEnd) {
      fail(opening,
           fmt::format("the quote that opens the value of '{}' is never closed; write '\"' "
                       "at its end, and '\\\"' for a quote inside",
                       shown(key)));
    }
    value += get();
  }
  get();
  skip_blanks();
  if (peek() == '#') {
    skip_comment();
  }
  if (!at_line_end()) {
    fail(here(), fmt::format("text after the closing quote of '{}' (line {}); write '\\\"' for a "
                             "quote inside the value, or '#' before a comment",
                             shown(key), where.line));
  }
  return value;
}

std::string Parser::parse_bare(const std::string& key, const Location& where) {
  std::string value;
  while (!at_line_end() && peek() != '#') {
    const char c = get();
    if (c != '\\') {
      value += c;
      continue;
    }
    if (peek() == kEnd) {
      fail(where, fmt::format("the value of '{}' ends with a backslash at the end of the file; "
                              "write '\\\\' for a backslash",
                              shown(key)));
    }
    const char escaped = get();
    value += escaped;
    if (is_line_end(escaped) && is_line_end(peek()) && peek() != escaped) {
      value += get();  // "\r\n" goes on as one line end
    }
  }
  strip_trailing(value);
  return value;
}

void Parser::store(const std::string& key, std::string value, const Location& where) {
  auto& keys = section_ ? file_.sections[*section_].keys : file_.globals;
  auto& places = section_ ? section_keys_[*section_] : global_keys_;
  const auto [found, is_new] = places.emplace(key, keys.size());
  if (is_new) {
    keys.push_back({key, std::move(value), where});
    return;
  }
  MusicKey& before = keys[found->second];
  note(where,
       with_code(Code::duplicate_key, "duplicate key '{}'; the first is at {}; the last one holds",
                 shown(key), before.where.text()));
  before.value = std::move(value);
  before.where = where;
}

void Parser::parse_connection(const std::string& left, bool to_right, const Location& where) {
  const std::string right = read_right_side();
  const Endpoint from = endpoint(to_right ? left : right, "sender", where);
  const Endpoint to = endpoint(to_right ? right : left, "receiver", where);
  MusicConnection connection;
  connection.from_app = from.app;
  connection.from_port = from.port;
  connection.to_app = to.app;
  connection.to_port = to.port;
  connection.where = where;
  if (peek() == '[') {
    get();
    apply(read_options(), connection);
  }
  file_.connections.push_back(std::move(connection));
}

// No escapes here.
std::string Parser::read_right_side() {
  skip_blanks();
  std::string text;
  while (!at_line_end() && peek() != '#' && peek() != '[') {
    text += get();
  }
  strip_trailing(text);
  return text;
}

Parser::Endpoint Parser::endpoint(const std::string& text, std::string_view role,
                                  const Location& where) const {
  const auto dot = text.find('.');
  Endpoint result;
  if (dot != std::string::npos) {
    result.app = text.substr(0, dot);
  }
  result.port = dot == std::string::npos ? text : text.substr(dot + 1);
  strip_trailing(result.app);
  strip_trailing(result.port);
  if (result.port.empty()) {
    fail(where, fmt::format("the connection has no {} port; write 'A.out -> B.in [width]'", role));
  }
  check_port(result.port, where);
  if (result.app.empty()) {
    if (!section_) {
      fail(where, fmt::format("the {} application of port '{}' is missing; before the first "
                              "section write 'application.{}'",
                              role, shown(result.port), shown(result.port)));
    }
    result.app = file_.sections[*section_].label;
  }
  check_name("label", result.app, where);
  return result;
}

// MUSIC would take "in 10" or "in -> C.in" for the name of a port, which no program has.
void Parser::check_port(const std::string& port, const Location& where) const {
  if (port.find("->") != std::string::npos || port.find("<-") != std::string::npos) {
    fail(where, fmt::format("a second arrow in '{}'; write each connection on a line of its own",
                            shown(port)));
  }
  const auto odd = std::find_if(port.begin(), port.end(),
                                [](char c) { return is_space(c) || c == '=' || c == ']'; });
  if (odd != port.end()) {
    throw ConfigurationError(
        where,
        with_code(Code::invalid_name,
                  "'{}' is not a valid port name; write 'A.out -> B.in [width]'", shown(port)));
  }
  check_name("port", port, where);
}

// What stands between '[' and ']'; a comment closes the bracket, too.
Parser::Options Parser::read_options() {
  Options options;
  bool more = false;
  options.width = read_width(more);
  if (more) {
    options.communication = read_option(more, false);
  }
  if (more) {
    options.processing = read_option(more, true);
  }
  return options;
}

std::string Parser::read_width(bool& more) {
  const Location where = here();
  std::string width;
  bool gap = false;
  for (;;) {
    if (at_line_end()) {
      fail(where, fmt::format("the width '[{}' has no ']'; write '[{}]'", shown(width),
                              width.empty() ? "10" : shown(width)));
    }
    if (peek() == '#') {
      skip_comment();
      return width;
    }
    const char c = get();
    if (c == ']' || c == ',') {
      more = c == ',';
      return width;
    }
    if (is_blank(c)) {
      gap = !width.empty();
    } else if (c < '0' || c > '9') {
      const auto rest =
          text_.substr(position_, text_.find_first_of(",]\r\n\f", position_) - position_);
      throw ConfigurationError(
          where,
          with_code(Code::unknown_width, "the width '{}' is not a whole number; write '[10]'",
                    shown(width + c + std::string(rest))));
    } else if (gap) {
      fail(where, fmt::format("two numbers in a width, '{}' and '{}'; write one, '[{}]'",
                              shown(width), c, shown(width)));
    } else {
      width += c;
    }
  }
}

std::string Parser::read_option(bool& more, bool last) {
  const Location where = here();
  std::string option;
  more = false;
  for (;;) {
    if (at_line_end()) {
      fail(where,
           fmt::format("no ']' after '{}'; write '[10, point-to-point, tree]'", shown(option)));
    }
    if (peek() == '#') {
      skip_comment();
      return option;
    }
    const char c = get();
    if (c == ',' && last) {
      fail(where,
           "a fourth option in the width's brackets; write at most '[10, point-to-point, "
           "tree]'");
    }
    if (c == ']' || c == ',') {
      more = c == ',';
      return option;
    }
    if (!is_blank(c)) {
      option += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
  }
}

void Parser::apply(const Options& options, MusicConnection& connection) const {
  if (!options.width.empty()) {
    std::uint64_t width = 0;
    for (const char digit : options.width) {
      width = std::min<std::uint64_t>(width * 10 + (digit - '0'), std::uint64_t{1} << 40);
    }
    if (width > std::numeric_limits<std::int32_t>::max()) {
      throw ConfigurationError(
          connection.where,
          with_code(Code::unknown_width, "the width {} is too large; write at most 2147483647",
                    shown(options.width)));
    }
    connection.width = static_cast<std::uint32_t>(width);
  }
  if (options.communication == "collective") {
    connection.communication = Communication::collective;
  } else if (!options.communication.empty() && options.communication != "point-to-point") {
    throw ConfigurationError(
        connection.where,
        with_code(Code::unknown_choice, "unknown communication '{}'{}",
                  shown(options.communication),
                  did_you_mean(options.communication, {"point-to-point", "collective"})));
  }
  if (options.processing == "table") {
    connection.processing = Processing::table;
  } else if (!options.processing.empty() && options.processing != "tree") {
    throw ConfigurationError(
        connection.where,
        with_code(Code::unknown_choice, "unknown processing '{}'{}", shown(options.processing),
                  did_you_mean(options.processing, {"tree", "table"})));
  }
}

}  // namespace

MusicFile parse_music(std::string_view text, const std::string& path) {
  return with_present_names(Parser(text, path).parse());
}

}  // namespace spikeloop
