#include "spikeloop/core/code.hpp"

#include <regex>

namespace spikeloop {

std::string code_text(Code code) {
  return fmt::format("SL{:04}", static_cast<int>(code));
}

std::string with_code(Code code, std::string_view message) {
  static const std::regex inner(R"( \[SL\d{4}\])");
  return fmt::format("{} [{}]", std::regex_replace(std::string(message), inner, ""),
                     code_text(code));
}

std::string lengthened(std::string_view message, std::string_view more) {
  static const std::regex last(R"(( \[SL\d{4}\])?$)");
  std::string text(message);
  std::smatch code;
  std::regex_search(text, code, last);
  return text.insert(static_cast<std::size_t>(code.position()), more);
}

}  // namespace spikeloop
