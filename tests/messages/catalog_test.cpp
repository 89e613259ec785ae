#include "spikeloop/messages/catalog.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/core/error.hpp"
#include "tests/support/error_of.hpp"

namespace catalog_test {
namespace {

using namespace spikeloop::messages;
using spikeloop::test::error_of;
using spikeloop::test::Fault;

// std_msgs/Duration and actionlib_msgs/GoalStatus as their pages on docs.ros.org list them.
TEST(Catalog, md5_with_constants_is_the_published_one) {
  Catalog catalog(Dialect::ros1);
  catalog.add("actionlib_msgs/GoalID", "time stamp\nstring id\n");
  catalog.add("actionlib_msgs/GoalStatus",
              "GoalID goal_id\nuint8 status\nuint8 PENDING         = 0   # pending\n"
              "uint8 ACTIVE          = 1\nuint8 PREEMPTED       = 2\nuint8 SUCCEEDED       = 3\n"
              "uint8 ABORTED         = 4\nuint8 REJECTED        = 5\nuint8 PREEMPTING      = 6\n"
              "uint8 RECALLING       = 7\nuint8 RECALLED        = 8\nuint8 LOST            = 9\n"
              "string text\n");
  EXPECT_EQ(catalog.md5("actionlib_msgs/GoalID"), "302881f31927c1df708a2dbab0e80ee8");
  EXPECT_EQ(catalog.md5("actionlib_msgs/GoalStatus"), "d388f9b87b3c471f784434d671988d4a");
}

// gazebo_msgs is not in Debian; these are the sums of its version 2.9 for Noetic.
TEST(Catalog, contacts_have_the_sums_of_gazebo_ros) {
  const Catalog& catalog = Catalog::builtin(Dialect::ros1);
  EXPECT_EQ(catalog.md5("gazebo_msgs/ContactsState"), "acbcb1601a8e525bf72509f18e6f668d");
  EXPECT_EQ(catalog.md5("gazebo_msgs/ContactState"), "48c0ffb054b8c444f870cecea1ee50d9");
}

TEST(Catalog, full_text_lists_every_part_once) {
  EXPECT_EQ(Catalog::builtin(Dialect::ros1).full_text("geometry_msgs/Twist"),
            "Vector3 linear\nVector3 angular\n\n" + std::string(80, '=') +
                "\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n");
}

TEST(Catalog, short_names) {
  EXPECT_EQ(Catalog::builtin(Dialect::ros1).full_name("LaserScan"), "sensor_msgs/LaserScan");
  EXPECT_EQ(Catalog::builtin(Dialect::ros1).full_name("sensor_msgs/LaserScan"),
            "sensor_msgs/LaserScan");
  EXPECT_EQ(error_of([] { Catalog::builtin(Dialect::ros1).full_name("LaserScam"); }),
            "unknown message type 'LaserScam'; did you mean 'LaserScan'? [SL0502]");
  EXPECT_EQ(error_of([] { Catalog::builtin(Dialect::ros1).find("sensor_msgs/LaserScam"); }),
            "unknown message type 'sensor_msgs/LaserScam'; did you mean 'sensor_msgs/LaserScan'? "
            "[SL0502]");
  Catalog catalog = Catalog::builtin(Dialect::ros1);
  catalog.add("my_msgs/Twist", "float64 x");
  EXPECT_EQ(error_of([&] { catalog.full_name("Twist"); }),
            "message type 'Twist' is in several packages; write one of geometry_msgs/Twist, "
            "my_msgs/Twist [SL0502]");
}

TEST(Catalog, missing_and_endless_parts) {
  Catalog catalog(Dialect::ros1);
  catalog.add("my_msgs/A", "B b");
  EXPECT_EQ(error_of([&] { catalog.md5("my_msgs/A"); }),
            "message type 'my_msgs/A' needs 'my_msgs/B' for its field 'b', which is not known; add "
            "its definition too [SL0502]");
  catalog.add("my_msgs/B", "A[] a");
  const std::string endless =
      "message type 'my_msgs/A' contains itself: my_msgs/A -> my_msgs/B -> my_msgs/A ... [SL0503]";
  EXPECT_THAT(error_of([&] { catalog.layout("my_msgs/A"); }), Fault(endless));
  EXPECT_THAT(error_of([&] { catalog.md5("my_msgs/A"); }), Fault(endless));
  EXPECT_THAT(error_of([&] { catalog.full_text("my_msgs/A"); }), Fault(endless));
  catalog.add("my_msgs/Long", "uint8[4000000000] a");
  EXPECT_EQ(error_of([&] { catalog.layout("my_msgs/Long"); }),
            "message type 'my_msgs/Long' is longer than 1 GB with its field 'a'; write a shorter "
            "array [SL0503]");
}

TEST(Catalog, layout_knows_constant_sizes) {
  const auto twist = Catalog::builtin(Dialect::ros1).layout("geometry_msgs/Twist");
  EXPECT_EQ(twist->bytes, std::optional<std::size_t>(48));
  const auto scan = Catalog::builtin(Dialect::ros1).layout("sensor_msgs/LaserScan");
  EXPECT_FALSE(scan->bytes.has_value());
  EXPECT_EQ(scan->least, 16u + 7 * 4 + 2 * 4);
}

}  // namespace
}  // namespace catalog_test
