// Objects to `.music` text that MUSIC's parser reads back.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "music_text.hpp"
#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/code.hpp"

namespace spikeloop {

namespace {

using music_text::is_line_end;
using music_text::is_space;
using music_text::shown;

bool has_line_end_or_zero(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) { return is_line_end(c) || c == '\0'; });
}

/// A name that stands on the left of '=' or an arrow, or inside '[...]'.
void check_name(std::string_view kind, std::string_view name, const Location& where) {
  if (name.empty() || has_line_end_or_zero(name) || is_space(name.back())) {
    throw ConfigurationError(
        where, with_code(Code::invalid_name,
                         "the {} '{}' cannot be written in a .music file; use a name without line "
                         "ends and without blanks at its end",
                         kind, shown(name)));
  }
  if (const auto reason = music_text::unportable_name(kind, name); !reason.empty()) {
    throw ConfigurationError(where, reason);
  }
}

/// Backslashes before what would end a key.
std::string escaped_left(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const char next = i + 1 < text.size() ? text[i + 1] : '\0';
    const bool arrow = (c == '-' && next == '>') || (c == '<' && next == '-');
    const bool opening = i == 0 && (c == '[' || is_space(c));
    if (arrow || opening || c == '#' || c == '=' || c == '\\') {
      result += '\\';
    }
    result += c;
  }
  return result;
}

std::string escaped_label(std::string_view label) {
  std::string result;
  for (std::size_t i = 0; i < label.size(); ++i) {
    if (label[i] == ']' || (i == 0 && is_space(label[i]))) {
      result += '\\';
    }
    result += label[i];
  }
  return result;
}

std::string value_text(std::string_view value) {
  const bool bare = value.empty() ||
                    (!is_space(value.front()) && !is_space(value.back()) && value[0] != '"' &&
                     value[0] != '>' && value.find_first_of("#\\\n\r\f") == std::string_view::npos);
  if (bare) {
    return std::string(value);
  }
  std::string result = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') {
      result += '\\';
    }
    result += c;
  }
  return result + '"';
}

void append_key(const MusicKey& key, std::string& text) {
  check_name("key", key.name, key.where);
  if (key.value.find('\0') != std::string::npos) {
    throw ConfigurationError(key.where, with_code(Code::syntax,
                                                  "the value of '{}' contains a zero byte, which "
                                                  "no .music file can hold; remove it",
                                                  shown(key.name)));
  }
  text += fmt::format("{}={}\n", escaped_left(key.name), value_text(key.value));
}

std::string options_text(const MusicConnection& connection) {
  const bool table = connection.processing == Processing::table;
  const bool collective = connection.communication == Communication::collective;
  if (!connection.width && !table && !collective) {
    return {};
  }
  std::string text = connection.width ? fmt::format(" [{}", *connection.width) : " [";
  if (table || collective) {
    text += collective ? ", collective" : ", point-to-point";
  }
  return text + (table ? ", table]" : "]");
}

/// One way to write a connection. The left side knows escapes, the right side none, and a label
/// with a '.' can only be left out, inside its own section.
struct Form {
  bool to_right;
  const std::string* section;  ///< reopened, its side is written as ".port"; null: both in full
};

bool can_stand_left(const std::string& app) {
  return app.find('.') == std::string::npos;
}

bool can_stand_right(const std::string& text) {
  return text.find_first_of("#[") == std::string::npos && !is_space(text.front());
}

bool fits(const MusicConnection& c, const Form& form) {
  const bool from_implied = form.section == &c.from_app;
  const bool to_implied = form.section == &c.to_app;
  const bool left_implied = form.to_right ? from_implied : to_implied;
  const bool right_implied = form.to_right ? to_implied : from_implied;
  const std::string& left_app = form.to_right ? c.from_app : c.to_app;
  const std::string& right_app = form.to_right ? c.to_app : c.from_app;
  const std::string& right_port = form.to_right ? c.to_port : c.from_port;
  return (left_implied || can_stand_left(left_app)) && can_stand_right(right_port) &&
         (right_implied || (can_stand_left(right_app) && can_stand_right(right_app)));
}

Form choose_form(const MusicConnection& c) {
  const std::array<Form, 6> forms = {Form{true, nullptr},     Form{false, nullptr},
                                     Form{true, &c.from_app}, Form{false, &c.from_app},
                                     Form{true, &c.to_app},   Form{false, &c.to_app}};
  const auto found =
      std::find_if(forms.begin(), forms.end(), [&](const Form& form) { return fits(c, form); });
  if (found == forms.end()) {
    throw ConfigurationError(
        c.where, with_code(Code::invalid_name,
                           "the connection '{}' cannot be written in a .music file; use labels "
                           "and ports of letters, digits and '_'",
                           shown(describe(c))));
  }
  return *found;
}

void append_connection(const MusicConnection& c, std::string& section, std::string& text) {
  check_name("label", c.from_app, c.where);
  check_name("port", c.from_port, c.where);
  check_name("label", c.to_app, c.where);
  check_name("port", c.to_port, c.where);
  const Form form = choose_form(c);
  if (form.section != nullptr && *form.section != section) {
    section = *form.section;
    text += fmt::format("[{}]\n", escaped_label(section));
  }
  const std::string from = (form.section == &c.from_app ? "" : c.from_app) + "." + c.from_port;
  const std::string to = (form.section == &c.to_app ? "" : c.to_app) + "." + c.to_port;
  text += fmt::format("{} {} {}{}\n", escaped_left(form.to_right ? from : to),
                      form.to_right ? "->" : "<-", form.to_right ? to : from, options_text(c));
}

}  // namespace

std::string to_text(const MusicFile& file) {
  std::string text;
  for (const auto& key : file.globals) {
    append_key(key, text);
  }
  std::string current;
  for (const auto& section : file.sections) {
    check_name("label", section.label, section.where);
    current = section.label;
    text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", escaped_label(current));
    for (const auto& key : section.keys) {
      append_key(key, text);
    }
  }
  if (!file.connections.empty()) {
    text += '\n';
  }
  for (const auto& connection : file.connections) {
    append_connection(connection, current, text);
  }
  return text;
}

}  // namespace spikeloop
