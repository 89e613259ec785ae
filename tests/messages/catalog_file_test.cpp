// Definitions from a user's own files.
#include <gtest/gtest.h>

#include <filesystem>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/temporary_directory.hpp"

namespace catalog_file_test {
namespace {

using spikeloop::test::Fault;
using namespace spikeloop::messages;
namespace fs = std::filesystem;

class CatalogFile : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_.path() / name).parent_path());
    return folder_.write(name, text);
  }
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }

  template <typename Action>
  std::string error_of(Action action) const {
    try {
      action();
    } catch (const spikeloop::ConfigurationError& error) {
      std::string text = error.what();
      for (auto at = text.find(folder_.path().string()); at != std::string::npos;
           at = text.find(folder_.path().string())) {
        text.replace(at, folder_.path().string().size(), "DIR");
      }
      return text;
    }
    return "no error";
  }

 private:
  spikeloop::test::TemporaryDirectory folder_;
};

TEST_F(CatalogFile, brings_the_parts_that_lie_beside) {
  const std::string arm =
      write("my_robot/msg/Arm.msg", "std_msgs/Header header\nJoint[] joints\nother/Tool tool\n");
  write("my_robot/msg/Joint.msg", "string name\nfloat64 angle\n");
  write("other/msg/Tool.msg", "uint8 kind\nmy_robot/Joint joint\n");
  for (const Dialect dialect : {Dialect::ros1, Dialect::ros2}) {
    const Catalog& catalog = Catalog::for_type(dialect, arm);
    EXPECT_EQ(catalog.dialect(), dialect);
    EXPECT_EQ(catalog.full_name(arm), "my_robot/Arm");
    EXPECT_EQ(catalog.full_name("Arm"), "my_robot/Arm");
    EXPECT_EQ(catalog.layout("my_robot/Arm")->fields.size(), 3u);
    EXPECT_TRUE(catalog.contains("other/Tool"));
    EXPECT_TRUE(catalog.contains("sensor_msgs/LaserScan"));
    EXPECT_EQ(&Catalog::for_type(dialect, arm), &catalog);
    EXPECT_EQ(&Catalog::for_type(dialect, "other/Tool"), &catalog);
  }
  EXPECT_FALSE(Catalog::builtin(Dialect::ros1).contains("my_robot/Arm"));
  EXPECT_EQ(&Catalog::for_type(Dialect::ros2, "sensor_msgs/Image"),
            &Catalog::builtin(Dialect::ros2));
}

TEST_F(CatalogFile, own_package_goes_before_what_we_bring) {
  const std::string thing = write("std_msgs/msg/Thing.msg", "Float64 value\n");
  EXPECT_EQ(Catalog::for_type(Dialect::ros1, thing).layout("std_msgs/Thing")->bytes, 8u);
  const std::string other = write("std_msgs/msg/Other.msg", "Float64 value\n");
  write("std_msgs/msg/Float64.msg", "float32 data\n");
  EXPECT_EQ(Catalog::for_type(Dialect::ros1, other).layout("std_msgs/Other")->bytes, 4u);
}

TEST_F(CatalogFile, a_message_within_itself_ends) {
  const std::string loop = write("my_robot/msg/Loop.msg", "Loop[] inner\nKnot knot\n");
  write("my_robot/msg/Knot.msg", "Loop[] loops\n");
  EXPECT_EQ(
      error_of([&] { Catalog::for_type(Dialect::ros2, loop).layout("my_robot/Loop"); }),
      "message type 'my_robot/Loop' contains itself: my_robot/Loop -> my_robot/Loop; take the "
      "field out that leads back [SL0503]");
}

TEST_F(CatalogFile, errors_name_the_file) {
  const auto error = [&](const std::string& file) {
    return error_of([&] { Catalog::for_type(Dialect::ros2, file); });
  };
  EXPECT_THAT(
      error(path("my_robot/msg/Nothing.msg")),
      Fault("message definition 'DIR/my_robot/msg/Nothing.msg' ... .msg file ... [SL0502]"));
  EXPECT_EQ(error(write("loose/Thing.msg", "int8 a\n")),
            "message definition 'DIR/loose/Thing.msg' is in no package; put it where ROS has it, "
            "PACKAGE/msg/Thing.msg [SL0502]");
  EXPECT_EQ(error(write("my_robot/msg/Bad.msg", "int8 a\ntime t\n")),
            "DIR/my_robot/msg/Bad.msg:2: 'time' is not part of ROS 2; write "
            "builtin_interfaces/Time [SL0503]");
  EXPECT_EQ(error(write("my_robot/msg/Lonely.msg", "other/Part part\n")),
            "message type 'my_robot/Lonely' needs 'other/Part' for its field 'part', which is "
            "neither known nor a file DIR/other/msg/Part.msg; put its definition there [SL0502]");
  EXPECT_EQ(error(write("2bad/msg/Name.msg", "int8 a\n")),
            "message type '2bad/Name' has no package; write package/Type, as in "
            "sensor_msgs/LaserScan [SL0502]");
}

}  // namespace
}  // namespace catalog_file_test
