// What the tests of this module share.
#pragma once

#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/log.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {

/// The message of the Spikeloop error that `action` throws, or "no error".
inline std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

inline std::string data_path_of(const std::string& name) {
  return std::string(TEST_DATA) + "/" + name;
}

inline std::string data_text(const std::string& name) {
  std::ifstream stream(data_path_of(name), std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The `.music` files among the test data.
inline std::vector<std::string> music_examples() {
  return {"vehicle.music", "camera.music", "feedback.music"};
}

/// Collects what is logged while it lives.
class LogCapture {
 public:
  LogCapture() {
    log::set_sink([this](log::Level, std::string_view message) { messages.emplace_back(message); });
  }
  ~LogCapture() { log::set_sink(nullptr); }
  LogCapture(const LogCapture&) = delete;
  LogCapture& operator=(const LogCapture&) = delete;

  std::vector<std::string> messages;
};

/// Random files that say what a `.music` file can say, with the characters that need escapes.
class RandomMusicFile {
 public:
  explicit RandomMusicFile(unsigned seed) : random_(seed) {}

  MusicFile make() {
    MusicFile file;
    add_keys(file.globals, below(4));
    for (std::size_t i = 0; i < 1 + below(6); ++i) {
      const std::string label = name(".#[]-<>= \t\"", true);
      if (file.find_section(label) == nullptr) {
        file.sections.push_back({label, {}, {}});
        add_keys(file.sections.back().keys, below(6));
      }
    }
    for (std::size_t i = 0; i < below(8); ++i) {
      add_connection(file);
    }
    return file;
  }

  std::size_t below(std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random_);
  }

 private:
  std::string letters(std::size_t least) {
    std::string text;
    for (std::size_t i = 0; i < least + below(5); ++i) {
      text += "abcXYZ019_"[below(10)];
    }
    return text;
  }
  /// Letters with at times one of the odd characters in between or, if wanted, at the beginning.
  std::string name(const std::string& odd, bool at_beginning) {
    std::string text = letters(1);
    while (below(3) == 0) {
      text += odd[below(odd.size())];
      text += letters(1);
    }
    return at_beginning && below(6) == 0 ? odd[below(odd.size())] + text : text;
  }
  std::string value() {
    std::string text = below(5) == 0 ? "" : letters(0);
    while (below(3) == 0) {
      text += std::string("#\\\"'\n\r\f\v\t :=[]<>-.,;%\xC3\xA4")[below(24)];
      text += letters(0);
    }
    return text;
  }
  void add_keys(std::vector<MusicKey>& keys, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      set_key(keys, name(".#[]-<> \t\":", true), value());
    }
  }
  void add_connection(MusicFile& file) {
    MusicConnection c;
    c.from_app = file.sections[below(file.sections.size())].label;
    c.to_app = below(8) == 0 ? letters(1) : file.sections[below(file.sections.size())].label;
    c.from_port = name(".#[-<", false);
    c.to_port = name(".#[-<", false);
    if (below(3) != 0) {
      c.width = static_cast<std::uint32_t>(below(1000));
    }
    c.communication = below(4) == 0 ? Communication::collective : Communication::point_to_point;
    c.processing = below(4) == 0 ? Processing::table : Processing::tree;
    file.connections.push_back(c);
  }

  std::mt19937 random_;
};

}  // namespace spikeloop::test
