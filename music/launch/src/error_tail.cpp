#include "error_tail.hpp"

#include <algorithm>

namespace spikeloop::launch {
namespace {

/// Advice follows this line of roslaunch's, and where the traceback is.
constexpr std::string_view kReason = "RLException: ";

/// Where the terminal code ends that begins at `begin`: ESC [ ... LETTER is a colour,
/// ESC ] ... BEL the window's title.
std::size_t end_of_code(std::string_view text, std::size_t begin) {
  const bool title = text.substr(begin + 1).starts_with(']');
  const auto last = std::find_if(
      text.begin() + static_cast<std::ptrdiff_t>(std::min(begin + 2, text.size())), text.end(),
      [title](char c) { return title ? c == '\a' : c >= '@' && c <= '~'; });
  return std::min(static_cast<std::size_t>(last - text.begin()) + 1, text.size());
}

std::string without_codes(std::string_view text) {
  std::string plain;
  while (!text.empty()) {
    const std::size_t code = std::min(text.find('\x1b'), text.size());
    plain += text.substr(0, code);
    text.remove_prefix(code == text.size() ? code : end_of_code(text, code));
  }
  return plain;
}

}  // namespace

void ErrorTail::take(const OutputLine& line) {
  std::string plain = without_codes(line.text);
  plain.erase(plain.find_last_not_of(" \t\r") + 1);
  if (plain.empty()) {
    return;
  }
  (line.error ? last_error_ : last_out_) = plain;
  if (reason_.empty() && plain.starts_with(kReason)) {
    reason_ = plain.substr(kReason.size());
    reason_.erase(reason_.find_last_not_of('.') + 1);
  }
}

const std::string& ErrorTail::text() const {
  const std::string& last = last_error_.empty() ? last_out_ : last_error_;
  return reason_.empty() ? last : reason_;
}

}  // namespace spikeloop::launch
