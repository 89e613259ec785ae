// Bags that cannot be written, and files that are none.
#include <gmock/gmock.h>

#include <filesystem>
#include <random>

#include "spikeloop/bag/reader.hpp"
#include "spikeloop/bag/recorder.hpp"
#include "spikeloop/core/error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;
using testing::StrEq;

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
  std::string path(const char* name = "x.bag") const { return (directory_.path() / name).string(); }
  std::string reading() const {
    return file_error([&] {
      bag::Stream stream = bag::Reader(path()).stream("/x", "a");
      while (stream.next()) {
      }
    });
  }
  /// 2000 of them are several chunks.
  void write_good(TimeNs messages = 2000) const {
    bag::Recorder recorder(path(), {.patient = true});
    const auto connection = recorder.add({"/x", "std_msgs/String", "a"});
    std::vector<std::byte> text(1004);
    text[0] = std::byte{0xE8};
    text[1] = std::byte{0x03};  // 1000 bytes follow
    for (TimeNs i = 0; i < messages; ++i) {
      recorder.take(connection, i, text);
    }
    EXPECT_EQ(recorder.close().error, "");
  }

  test::TemporaryDirectory directory_;
};

TEST_F(BagFaults, FolderThatIsNotThere) {
  const std::string file = path("nowhere/x.bag");
  EXPECT_EQ(file_error([&] { bag::Recorder recorder(file); }),
            "cannot create '" + file + "': No such file or directory [SL0109]");
}

TEST_F(BagFaults, DiskThatIsFull) {
  const std::string error = file_error([] {
    bag::Recorder recorder("/dev/full");
    recorder.take(recorder.add({"/x", "std_msgs/Float64", "a"}), 1, std::vector<std::byte>(8));
    throw FileError(recorder.close().error);
  });
  EXPECT_THAT(error, StartsWith("cannot write '/dev/full': "));
}

TEST_F(BagFaults, FileThatIsNotThere) {
  EXPECT_EQ(reading(), "cannot open '" + path() + "': No such file or directory [SL0109]");
}

TEST_F(BagFaults, Directory) {
  std::filesystem::create_directory(path());
  EXPECT_EQ(reading(), "cannot read '" + path() + "': Is a directory [SL0109]");
}

TEST_F(BagFaults, OtherFiles) {
  for (const char* text : {"", "#ROSBA", "SQLite format 3"}) {
    directory_.write("x.bag", text);
    EXPECT_EQ(reading(), "'" + path() +
                             "' is not a bag of ROS 1: it does not begin with #ROSBAG V; write the "
                             "path of a .bag that 'rosbag info' reads (bags of ROS 2 are not in "
                             "this version) [SL0109]");
  }
}

TEST_F(BagFaults, RecordingThatWasNotEnded) {
  // A bag whose header still says that there is no index, as rosbag writes it at the beginning.
  write_good();
  const std::string whole = directory_.read("x.bag");
  const auto index = whole.find("index_pos=") + 10;
  directory_.write("x.bag",
                   whole.substr(0, index) + std::string(8, '\0') + whole.substr(index + 8));
  EXPECT_EQ(reading(), "'" + path() +
                           "' has no index, because its recording was not ended; write  rosbag "
                           "reindex " +
                           path() + " [SL0109]");
}

TEST_F(BagFaults, CutOffAnywhere) {
  write_good();
  const std::string whole = directory_.read("x.bag");
  for (std::size_t part = 1; part < 40; ++part) {
    directory_.write("x.bag", whole.substr(0, 13 + (whole.size() - 13) * part / 40));
    EXPECT_THAT(reading(), AllOf(StartsWith("'" + path() + "' is damaged: "),
                                 EndsWith("'rosbag check' and 'rosbag reindex' may help [SL0109]")))
        << part;
  }
}

TEST_F(BagFaults, IndexThatLeadsElsewhere) {
  write_good(3);
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
    EXPECT_THAT(reading(), HasSubstr(std::string("is damaged: ") + reason));
  }
}

/// rosbag's own reader would end the process.
TEST_F(BagFaults, WrongBytesAnywhere) {
  write_good(20);
  const std::string whole = directory_.read("x.bag");
  std::mt19937 random(1);
  int damaged = 0;
  for (int trial = 0; trial < 500; ++trial) {
    std::string bag = whole;
    const std::size_t at = 13 + random() % (whole.size() - 13);
    // Text of the messages fills most of the bag, and any byte is good there.
    bag[trial % 2 == 0 ? at : whole.size() - 1 - at % 1500] = static_cast<char>(random());
    directory_.write("x.bag", bag);
    const std::string error = reading();
    damaged += error == "no error" ? 0 : 1;
    EXPECT_THAT(error, AnyOf(StrEq("no error"), HasSubstr("x.bag"))) << trial;
  }
  EXPECT_GT(damaged, 20);
}

}  // namespace
}  // namespace spikeloop
