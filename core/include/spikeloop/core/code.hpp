// What kind of mistake or failure an error is: "[SL0103]" at the end of its message, which
// `spikeloop explain SL0103` describes. A number is never used for another kind.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

namespace spikeloop {

enum class Code : int {
  // The text of a file
  syntax = 101,
  duplicate_key = 102,
  unknown_key = 103,
  missing_key = 104,
  wrong_shape = 105,
  invalid_name = 106,
  duplicate_name = 107,
  missing_file = 108,
  no_access = 109,
  // Values
  not_a_number = 201,
  wrong_unit = 202,
  out_of_bounds = 203,
  not_whole = 204,
  unknown_choice = 205,
  wrong_order = 206,
  off_grid = 207,
  conflicting_keys = 208,
  expression = 209,
  // Connections
  unknown_node = 301,
  unknown_port = 302,
  kinds_differ = 303,
  two_senders = 304,
  not_connected = 305,
  widths_differ = 306,
  unknown_width = 307,
  weights_differ = 308,
  weight_file = 309,
  delay = 310,
  // Node classes, plug-ins and simulators
  unknown_class = 401,
  plug_in = 402,
  unknown_simulator = 403,
  script = 404,
  network = 405,
  // Topics and messages
  invalid_topic = 501,
  unknown_message = 502,
  message_definition = 503,
  field_path = 504,
  fields_differ = 505,
  topic_conflict = 506,
  no_such_topic = 507,
  wrong_message = 508,
  damaged_message = 509,
  ros_setting = 510,
  image_encoding = 511,
  // Processes
  layout = 601,
  music_job = 602,
  program = 603,
  resource = 604,
  // While a run goes on
  no_ros_master = 701,
  partner_missing = 702,
  partner_failed = 703,
  node_failed = 704,
  // The world of the simulated robot
  world = 801,
};

/// "SL0103"
std::string code_text(Code code);

/// "MESSAGE [SL0103]". A code that the message has already, from an error it wraps, is left out.
std::string with_code(Code code, std::string_view message);
/// The same of a formatted message.
template <typename... Values>
std::string with_code(Code code, fmt::format_string<Values...> format, Values&&... values) {
  return with_code(code, std::string_view(fmt::format(format, std::forward<Values>(values)...)));
}

/// `more` behind the message, before its code.
std::string lengthened(std::string_view message, std::string_view more);

}  // namespace spikeloop
