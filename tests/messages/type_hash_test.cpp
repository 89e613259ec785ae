// The sum by which ROS 2 tells versions of types apart.
#include <gtest/gtest.h>

#include <set>
#include <stdexcept>
#include <string>

#include "spikeloop/messages/catalog.hpp"

namespace {

using namespace spikeloop::messages;

// As ROS 2 Jazzy's packages have them (rosidl's *.json files).
TEST(TypeHash, ros_2_has_the_same) {
  const std::pair<const char*, const char*> published[] = {
      {"sensor_msgs/LaserScan", "64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828"},
      {"nav_msgs/Odometry", "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
      {"geometry_msgs/Twist", "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"},
      {"geometry_msgs/TwistStamped",
       "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"},
      {"std_msgs/Float64MultiArray",
       "1025ddc6b9552d191f89ef1a8d2f60f3d373e28b283d8891ddcc974e8c55397f"},
      {"sensor_msgs/Image", "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"},
      {"sensor_msgs/JointState",
       "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"},
      {"sensor_msgs/Imu", "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"},
      {"rosgraph_msgs/Clock", "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"},
      {"std_msgs/String", "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"},
      {"std_msgs/Empty", "20b625256f32d5dbc0d04fee44f43c41e51c70d3502f84b4a08e7a9c26a96312"},
      {"std_msgs/Float64", "705ba9c3d1a09df43737eb67095534de36fd426c0587779bda2bc51fe790182a"},
      {"rcl_interfaces/Log", "e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac"},
      {"rmw_dds_common/ParticipantEntitiesInfo",
       "91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e"},
  };
  for (const auto& [type, hash] : published) {
    EXPECT_EQ(Catalog::builtin(Dialect::ros2).type_hash(type), std::string("RIHS01_") + hash)
        << type;
  }
}

TEST(TypeHash, every_definition_has_one_of_its_own) {
  const Catalog& catalog = Catalog::builtin(Dialect::ros2);
  std::set<std::string> hashes;
  for (const std::string& name : catalog.names()) {
    hashes.insert(catalog.type_hash(name));
  }
  EXPECT_EQ(hashes.size(), catalog.names().size());
}

// REP 2016: neither defaults nor constants are part of it; bounds are.
TEST(TypeHash, of_what_the_wire_shows) {
  const auto hash = [](std::string_view text) {
    Catalog catalog(Dialect::ros2);
    catalog.add("my_msgs/Thing", text);
    return catalog.type_hash("my_msgs/Thing");
  };
  EXPECT_EQ(hash("int32 a 5\nint32 N=3 # three"), hash("int32 a"));
  EXPECT_NE(hash("int32 a"), hash("int32 b"));
  EXPECT_NE(hash("int32[] a"), hash("int32[<=3] a"));
  EXPECT_NE(hash("int32[3] a"), hash("int32[<=3] a"));
  EXPECT_NE(hash("string a"), hash("string<=3 a"));
  EXPECT_NE(hash("byte a"), hash("uint8 a"));
  EXPECT_EQ(hash("char a"), hash("uint8 a"));
}

TEST(TypeHash, ros_1_has_none) {
  EXPECT_THROW(Catalog::builtin(Dialect::ros1).type_hash("std_msgs/String"), std::logic_error);
}

}  // namespace
