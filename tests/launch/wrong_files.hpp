// A file that is right, and what is wrong in others.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/temporary_directory.hpp"

namespace spikeloop::test {

inline constexpr const char* kGood = R"(stoptime=0.1
music_timestep=0.001
[s]
np=1
binary=zmq_cont_adapter
message_type=FloatArray
[e]
np=1
binary=rate_encoder
rate_max=200
[n]
np=1
binary=spikeloop-network
network=net.yaml
[d]
np=1
binary=linear_readout_decoder
weights_filename=w.json
[c]
np=1
binary=cont_zmq_adapter
message_type=FloatArray
s.out -> e.in [3]
e.out -> n.in [3]
n.out -> d.in [3]
d.out -> c.in [2]
)";
inline constexpr const char* kNetwork =
    "populations:\n  input: {model: input, size: 3}\n  r: {model: repeater, size: 3}\n"
    "connections:\n  - {from: input, to: r, rule: one_to_one, delay: 1 ms}\noutput: [r]\n";
inline constexpr const char* kWeights = "[[1, 0, 0], [0, 1, 0]]";

inline const std::string kRosCommand =
    "[c]\nnp=1\nbinary=ros_command_adapter\nros_topic=/"
    "cmd_vel\nmessage_mapping_filename=map.json\n";

struct Wrong {
  const char* what;
  /// What to write instead of a part of the good file; an empty part: the whole file.
  std::vector<std::pair<std::string, std::string>> instead;
  const char* words;  ///< of the last line: a pattern of Fault()
  int exit_code = 2;
  std::map<std::string, std::string> files{};  ///< more of them, or others
  std::vector<std::string> options{};
};

inline void PrintTo(const Wrong& wrong, std::ostream* out) {
  *out << wrong.what;
}

inline std::string text_of(const Wrong& wrong) {
  std::string text = kGood;
  for (const auto& [part, other] : wrong.instead) {
    const auto place = part.empty() ? 0 : text.find(part);
    EXPECT_NE(place, std::string::npos) << part;
    text.replace(place, part.empty() ? text.size() : part.size(), other);
  }
  return text;
}

inline const std::string kStrict = "strict=true\nstoptime=0.1";

/// loop.music, and the files that it names.
inline void write_files(const Wrong& wrong, const TemporaryDirectory& directory) {
  auto files = wrong.files;
  files.insert({{"net.yaml", kNetwork}, {"w.json", kWeights}, {"loop.music", text_of(wrong)}});
  for (const auto& [name, text] : files) {
    directory.write(name, text);
  }
}

}  // namespace spikeloop::test
