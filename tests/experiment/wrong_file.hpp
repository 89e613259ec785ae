// A row of the tables of wrong experiment files.
#pragma once

#include <gmock/gmock.h>

#include "tests/experiment/experiment_text.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {

struct WrongFile {
  const char* what;
  /// What to write instead of a part of the good file; an empty part: the whole file.
  std::vector<std::pair<std::string, std::string>> instead;
  std::vector<std::string> faults;  ///< all that is said, without directories: patterns of Fault()
  std::map<std::string, std::string> files{};
};

inline void PrintTo(const WrongFile& wrong, std::ostream* out) {
  *out << wrong.what;
}

inline void expect_faults(const WrongFile& wrong) {
  const Files files(with(wrong.instead), wrong.files);
  const experiment::NodeTypes types;
  std::vector<testing::Matcher<std::string>> faults;
  for (const std::string& fault : wrong.faults) {
    faults.emplace_back(Fault(fault));
  }
  EXPECT_THAT(read(files, types).faults, testing::ElementsAreArray(faults)) << wrong.what;
}

inline std::string repeated(const std::string& text, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) {
    result += text;
  }
  return result;
}

inline std::string nested(int depth) {
  return repeated("[", depth) + repeated("]", depth);
}

/// Lists of nine aliases of the list before: 9^8 values.
inline std::string bomb() {
  std::string text = "[&a [" + repeated("1,", 8) + "1]";
  for (char name = 'b'; name <= 'h'; ++name) {
    const std::string before = std::string("*") + static_cast<char>(name - 1);
    text += std::string(", &") + name + " [" + repeated(before + ",", 8) + before + "]";
  }
  return text + "]";
}

}  // namespace spikeloop::test
