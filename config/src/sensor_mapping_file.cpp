#include "spikeloop/config/sensor_mapping_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "json_text.hpp"
#include "music_text.hpp"
#include "spikeloop/config/data_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"

namespace spikeloop {

WrittenValues read_sensor_mapping(const std::string& name, const std::filesystem::path& base) {
  constexpr std::uint64_t kLimit = 16'000'000;
  constexpr const char* kExample = R"({"fields": [{"path": "ranges", "scale": 2}]})";
  const auto path = find_data_file(name, base);
  if (!path) {
    throw ConfigurationError(with_code(Code::missing_file,
                                       "there is no mapping file '{}' in {}; write its path",
                                       music_text::shown(name), data_file_places(base)));
  }
  const std::string text = read_file(*path, "mapping file", kLimit);
  const auto json = json_text::parse(text, path->string());
  const auto place = [&](const std::vector<std::string>& keys) {
    return json_text::locate_key(text, keys, path->string());
  };
  if (!json.is_object() || json.empty()) {
    throw ConfigurationError(
        place({}), with_code(Code::wrong_shape, "the file holds {}, no object with keys; write {}",
                             json_text::shown_json(json), kExample));
  }
  const std::vector<std::string> known = {"fields", "image"};
  WrittenValues keys;
  for (const auto& item : json.items()) {
    const Location where = place({item.key()});
    if (std::ranges::find(known, item.key()) == known.end()) {
      throw ConfigurationError(
          where, with_code(Code::unknown_key, "unknown key '{}'{}", music_text::shown(item.key()),
                           did_you_mean(item.key(), known)));
    }
    keys[item.key()] = json_text::written_value(item.value(), where);
  }
  return keys;
}

}  // namespace spikeloop
