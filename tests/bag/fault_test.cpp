// Files that cannot be written, damaged ones, and such as are no recordings.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <set>

#include "spikeloop/bag/reader.hpp"
#include "spikeloop/bag/recorder.hpp"
#include "spikeloop/core/error.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop {
namespace {

using test::Fault;
using testing::AllOf;
using testing::AnyOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::StartsWith;

template <typename Work>
std::string file_error(Work&& work) {
  try {
    work();
  } catch (const FileError& error) {
    return error.what();
  }
  return "no error";
}

class BagFaults : public testing::Test {
 protected:
  std::string path(const char* name = "x.mcap") const {
    return (directory_.path() / name).string();
  }
  /// How many messages a file has, or what is wrong with it.
  std::string reading(const char* name = "x.mcap") const {
    std::size_t count = 0;
    const std::string error = file_error([&] {
      bag::Stream stream = bag::Reader(path(name)).stream("/x", "a");
      while (stream.next()) {
        ++count;
      }
    });
    return error == "no error" ? std::to_string(count) : error;
  }

  /// 4000 of them are several chunks. Random letters, which nothing compresses.
  void write_good(TimeNs messages = 4000) const {
    std::mt19937 random(1);
    bag::Recorder recorder(path(), {.patient = true});
    const auto channel = recorder.add({"/x", "std_msgs/String", "a"});
    std::vector<std::byte> text(1004);
    text[0] = std::byte{0xE8};
    text[1] = std::byte{0x03};  // 1000 bytes follow
    for (TimeNs i = 0; i < messages; ++i) {
      std::ranges::generate(text.begin() + 4, text.end(), [&] { return std::byte(random()); });
      recorder.take(channel, i, text);
    }
    EXPECT_EQ(recorder.close().error, "");
  }

  test::TemporaryDirectory directory_;
};

TEST_F(BagFaults, FolderThatIsNotThere) {
  const std::string file = path("nowhere/x.bag");
  EXPECT_THAT(file_error([&] { bag::Recorder recorder(file); }),
              Fault("cannot create '" + file + "': ... [SL0109]"));
}

TEST_F(BagFaults, DiskThatIsFull) {
  const std::string error = file_error([] {
    bag::Recorder recorder("/dev/full");
    recorder.take(recorder.add({"/x", "std_msgs/Float64", "a"}), 1, std::vector<std::byte>(8));
    throw FileError(recorder.close().error);
  });
  EXPECT_THAT(error, StartsWith("cannot write '/dev/full': "));
}

TEST_F(BagFaults, DeletedFileIsReported) {
  WriteFailures failures;
  bag::Recorder recorder(path(), {.failures = &failures});
  const auto channel = recorder.add({"/x", "std_msgs/Float64", "a"});
  std::filesystem::remove(path());
  recorder.take(channel, 1, std::vector<std::byte>(8));
  EXPECT_THAT(recorder.close().error, Fault("cannot write '" + path() + "': ... [SL0109]"));
  EXPECT_EQ(failures.files(), std::vector{path()});
}

/// Their index is longer than what the writer keeps in memory.
TEST_F(BagFaults, ManyChunks) {
  constexpr TimeNs kMessages = 1500;
  {
    bag::Recorder recorder(path(), {.patient = true});
    const auto channel = recorder.add({"/x", "std_msgs/UInt8MultiArray", "a"});
    const std::vector<std::byte> zeros(std::size_t{1} << 20);  // one chunk per message
    for (TimeNs i = 0; i < kMessages; ++i) {
      recorder.take(channel, i, zeros);
    }
    EXPECT_EQ(recorder.close().error, "");
  }
  EXPECT_EQ(reading(), std::to_string(kMessages));
  EXPECT_FALSE(std::filesystem::exists(path("x.mcap.index")));
}

TEST_F(BagFaults, FileThatIsNotThere) {
  EXPECT_THAT(reading(), Fault("cannot open '" + path() + "': ... [SL0109]"));
}

TEST_F(BagFaults, OtherFiles) {
  for (const char* text : {"", "#ROSBA", "SQLite format 2", "\x89MCAP1\r\n"}) {
    directory_.write("x.mcap", text);
    EXPECT_THAT(reading(),
                Fault("'" + path() +
                      "' is neither an MCAP file nor a recording of ROS 2 in SQLite nor a bag of "
                      "ROS 1; ... .mcap, .db3 or .bag file [SL0109]"));
  }
}

/// As a process that was killed leaves it.
TEST_F(BagFaults, WhatIsCutOffIsReadUpToThere) {
  write_good();
  const std::string whole = directory_.read("x.mcap");
  int before = 0;
  std::set<int> counts;
  for (std::size_t part = 0; part <= 20; ++part) {
    directory_.write("x.mcap", whole.substr(0, 8 + (whole.size() - 8) * part / 20));
    const std::string text = reading();
    const bool has_none = text.find("was not ended, and contains no complete chunk") != text.npos;
    const int count = has_none ? 0 : std::stoi(text);
    EXPECT_GE(count, before) << part;
    counts.insert(before = count);
  }
  EXPECT_EQ(before, 4000);
  EXPECT_GT(counts.size(), 3u);
}

TEST_F(BagFaults, ChecksumOfAChunk) {
  write_good(3);
  std::string file = directory_.read("x.mcap");
  const auto chunk = file.find(std::string("zstd"));
  file[chunk - 8] ^= 1;  // before the length of "zstd"
  directory_.write("x.mcap", file);
  EXPECT_EQ(reading(), "'" + path() + "' is damaged: the checksum of a chunk is wrong [SL0109]");
}

TEST_F(BagFaults, ChunkThatClaimsToBeLarge) {
  write_good(3);
  std::string file = directory_.read("x.mcap");
  const auto size = file.find(std::string("zstd")) - 16;
  for (const auto& [byte, reason] :
       {std::pair{std::size_t{7}, "is damaged: invalid chunk size of "},
        std::pair{std::size_t{2}, "is damaged: a chunk cannot be unpacked"}}) {
    std::string wrong = file;
    wrong[size + byte] = '\x10';
    directory_.write("x.mcap", wrong);
    EXPECT_THAT(reading(), HasSubstr(reason));
  }
}

TEST_F(BagFaults, WrongBytesAnywhere) {
  write_good(20);
  const std::string whole = directory_.read("x.mcap");
  std::mt19937 random(1);
  int damaged = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::string file = whole;
    // Half of them not in the messages.
    const std::size_t at = 8 + random() % (whole.size() - 8);
    file[trial % 2 == 0      ? at
         : random() % 2 == 0 ? 8 + at % 100
                             : whole.size() - 1 - at % 700] = static_cast<char>(random());
    directory_.write("x.mcap", file);
    const std::string result = reading();
    damaged += result == "20" ? 0 : 1;
    EXPECT_THAT(result, AnyOf(MatchesRegex("[0-9]+"), HasSubstr("' is damaged: "),
                              HasSubstr("is neither an MCAP file"),
                              HasSubstr("' has chunks that are compressed by '")))
        << trial;
  }
  EXPECT_GT(damaged, 120);
}

}  // namespace
}  // namespace spikeloop
