// The parser of `.music` files under libFuzzer (scripts/fuzz): whatever the bytes are, it gives an
// object or a ConfigurationError; what has no problem can be written, and is read
// again as the same.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/config/order.hpp"

using namespace spikeloop;

namespace {

void need(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void check(const MusicFile& file) {
  if (!structure_diagnostics(file).empty()) {
    return;
  }
  const MusicFile again = parse_music(to_text(file), "again");
  need(again == file);
  for (const std::string& label : file.labels()) {
    need(!music_environment(file, label).empty());
  }
  MusicFile adopted = again;
  adopt_locations(adopted, file);
  need(adopted == file);
  need(downstream_first(file).size() == file.sections.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    check(parse_music(text, "fuzz"));
  } catch (const ConfigurationError& error) {
    need(error.what()[0] != '\0');
  }
  return 0;
}
