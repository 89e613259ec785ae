// Commands as subscribers get them, over every kind of session.
#include "spikeloop/topics/publisher.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "meeting.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/topics/memory_session.hpp"
#include "tests/ros2/domain.hpp"
#include "tests/support/fault.hpp"

namespace {

using spikeloop::test::Fault;
using namespace spikeloop;
using namespace spikeloop::topics;
using test::eventually;
using testing::ElementsAre;

class PublisherTest : public testing::TestWithParam<test::Kind> {
 protected:
  std::unique_ptr<test::Meeting> meeting_ = test::meet(GetParam());
  topics::Session& session_ = meeting_->session();
  test::Meeting& robot_ = *meeting_;
};

TEST_P(PublisherTest, twist) {
  Publisher publisher(session_, "/cmd_vel", "geometry_msgs/Twist", {"angular.z", "linear.x"});
  robot_.listen_twist("/cmd_vel");
  const double values[] = {0.25, -0.5};
  ASSERT_TRUE(eventually(20, [&] {
    publisher.publish(values);
    return !robot_.twists().empty();
  }));
  EXPECT_THAT(robot_.twists().front(), ElementsAre(-0.5, 0.25));
}

TEST_P(PublisherTest, array_of_all_values) {
  Publisher publisher(session_, "/motors", "std_msgs/Float64MultiArray", {"data"});
  robot_.listen_array("/motors");
  const double values[] = {1, 2, 3};
  ASSERT_TRUE(eventually(20, [&] {
    publisher.publish(values);
    return !robot_.arrays().empty();
  }));
  EXPECT_THAT(robot_.arrays().front(), ElementsAre(1, 2, 3));
}

/// The stamp of a message of TwistStamped, and that of the message which stops a robot.
std::pair<double, double> stamps(const std::vector<std::string>& fields, bool stamped) {
  constexpr const char* kType = "geometry_msgs/TwistStamped";
  MemorySession session(messages::Dialect::ros2);
  Publisher publisher(session, "/cmd_vel", kType, fields, stamped);
  const std::vector<double> values(fields.size(), 0.5);
  const messages::FieldReader reader(messages::Catalog::builtin(session.dialect()), kType,
                                     "header.stamp");
  std::vector<double> read;
  reader.read(publisher.publish(values), read);
  reader.read(publisher.message(values), read);
  return {read.at(0), read.at(1)};
}

TEST(Publisher, stamps_by_the_wall) {
  const auto now = [] {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch())
        .count();
  };
  const double before = now() - 1e-6;  // a number of seconds since 1970 is as exact as that
  const auto [sent, stop] = stamps({"twist.linear.x"}, true);
  EXPECT_GE(sent, before);
  EXPECT_LE(sent, now() + 1e-6);
  EXPECT_EQ(stop, 0) << "it is sent later";
  EXPECT_EQ(stamps({"twist.linear.x"}, false).first, 0);
  EXPECT_EQ(stamps({"header.stamp"}, true).first, 0.5) << "a field of the user's";
}

TEST_P(PublisherTest, errors) {
  const auto error_of = [&](const std::string& topic, const std::string& type,
                            const std::string& field) {
    try {
      Publisher(session_, topic, type, {field});
    } catch (const ConfigurationError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(error_of("a b", "geometry_msgs/Twist", "linear.x"),
              Fault("'a b' ... [SL0501] ..."));
  EXPECT_EQ(error_of("/a", "geometry_msgs/Twist", "linear.w"),
            "field path 'linear.w' of geometry_msgs/Twist: geometry_msgs/Vector3 has no field 'w'; "
            "did you mean 'x'? [SL0504]");
}

INSTANTIATE_TEST_SUITE_P(AllSessions, PublisherTest, test::kinds());

}  // namespace
