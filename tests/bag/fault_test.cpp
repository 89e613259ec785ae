// Files that cannot be written, damaged ones, and such as are no recordings.
#include <gmock/gmock.h>
#include <rosbag/bag.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <set>

#include "spikeloop/bag/reader.hpp"
#include "spikeloop/bag/recorder.hpp"
#include "spikeloop/core/error.hpp"
#include "tests/bag/ros1_text.hpp"
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
  std::string reading_bag() const { return reading("x.bag"); }

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
  void write_good_bag(std::uint32_t messages = 2000) const {
    rosbag::Bag bag(path("x.bag"), rosbag::bagmode::Write);
    bag.setChunkThreshold(1 << 16);
    const test::Ros1Text text{std::string(1000, 'x')};
    for (std::uint32_t i = 0; i < messages; ++i) {
      bag.write("/x", ros::Time(1, i), text);
    }
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
    const int count = std::stoi(reading());
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
       {std::pair{std::size_t{7}, "is damaged: a chunk says that it has "},
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

TEST_F(BagFaults, BagThatWasNotEnded) {
  // Its header still says that there is no index, as rosbag writes it at the beginning.
  write_good_bag();
  const std::string whole = directory_.read("x.bag");
  const auto index = whole.find("index_pos=") + 10;
  directory_.write("x.bag",
                   whole.substr(0, index) + std::string(8, '\0') + whole.substr(index + 8));
  EXPECT_EQ(reading_bag(), "'" + path("x.bag") +
                               "' has no index, because its recording was not ended; write  rosbag "
                               "reindex " +
                               path("x.bag") + " [SL0109]");
}

TEST_F(BagFaults, BagThatIsCutOff) {
  write_good_bag();
  EXPECT_EQ(reading_bag(), "2000");
  const std::string whole = directory_.read("x.bag");
  for (std::size_t part = 1; part < 20; ++part) {
    directory_.write("x.bag", whole.substr(0, 13 + (whole.size() - 13) * part / 20));
    EXPECT_THAT(reading_bag(),
                AllOf(StartsWith("'" + path("x.bag") + "' is damaged: "),
                      EndsWith("'rosbag check' and 'rosbag reindex' may help [SL0109]")))
        << part;
  }
}

TEST_F(BagFaults, BagWhoseIndexLeadsElsewhere) {
  write_good_bag(3);
  std::string bag = directory_.read("x.bag");
  const auto count = bag.find(std::string("\x0a\0\0\0count=", 10));
  // Behind it the fields op and ver may follow; then come the entries: time and offset.
  const auto index = bag.find(std::string("\x24\0\0\0", 4), count) + 4;
  for (const auto& [offset, reason] :
       {std::pair{'\x7f', "its index leads outside of a chunk"},
        std::pair{'\0', "its index leads to something that is not a message"}}) {
    for (std::size_t i = 8; i < 12; ++i) {
      bag[index + i] = offset;
    }
    directory_.write("x.bag", bag);
    EXPECT_THAT(reading_bag(), HasSubstr(std::string("is damaged: ") + reason));
  }
}

/// rosbag's own reader would end the process.
TEST_F(BagFaults, WrongBytesAnywhereInABag) {
  write_good_bag(20);
  const std::string whole = directory_.read("x.bag");
  std::mt19937 random(1);
  int damaged = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::string bag = whole;
    const std::size_t at = 13 + random() % (whole.size() - 13);
    // Text of the messages fills most of the bag, and any byte is good there.
    bag[trial % 2 == 0 ? at : whole.size() - 1 - at % 1500] = static_cast<char>(random());
    directory_.write("x.bag", bag);
    const std::string result = reading_bag();
    damaged += result == "20" ? 0 : 1;
    EXPECT_THAT(result, AnyOf(MatchesRegex("[0-9]+"), HasSubstr("x.bag"))) << trial;
  }
  EXPECT_GT(damaged, 8);
}

}  // namespace
}  // namespace spikeloop
