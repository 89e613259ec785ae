#include "output.hpp"

namespace spikeloop::app {

void put(std::FILE* stream, std::string_view text) noexcept {
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
}

}  // namespace spikeloop::app
