// Robots that are not the vehicle, against MuJoCo's own loop and closed forms.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/files_read.hpp"
#include "spikeloop/vehicle/simulation.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::vehicle {
namespace {

using testing::ElementsAre;

constexpr TimeNs kMillisecond = 1'000'000;

constexpr const char* kArm = R"(<mujoco model="arm">
  <option timestep="0.002"/>
  <worldbody>
    <camera name="eye" pos="0 -2 1"/>
    <body name="base" pos="0 0 1">
      <joint name="shoulder" type="hinge" axis="0 1 0" damping="0.1"/>
      <geom type="capsule" fromto="0 0 0 0.5 0 0" size="0.02" mass="1"/>
      <body pos="0.5 0 0">
        <joint type="slide" axis="1 0 0" stiffness="50"/>
        <geom type="sphere" size="0.05" mass="0.5"/>
        <site name="tip"/>
      </body>
    </body>
    <body name="ball" pos="2 0 1"><freejoint/><geom type="sphere" size="0.1"/></body>
  </worldbody>
  <actuator>
    <motor name="torque" joint="shoulder" ctrlrange="-2 2" ctrllimited="true"/>
    <position joint="shoulder" kp="3"/>
    <velocity name="speed" joint="shoulder" kv="0.5"/>
  </actuator>
  <sensor>
    <framepos name="tip" objtype="site" objname="tip"/>
    <accelerometer site="tip"/>
  </sensor>
  <keyframe><key name="down" qpos="1.5 0 2 0 1 1 0 0 0" ctrl="0 1.5 0"/></keyframe>
</mujoco>)";

class Models : public testing::Test {
 protected:
  std::string written(const std::string& text, const char* name = "robot.xml") const {
    const std::string path = (folder_.path() / name).string();
    std::ofstream(path) << text;
    return path;
  }

  test::TemporaryDirectory folder_;
};

TEST_F(Models, HaveTheNamesOfTheFile) {
  const Simulation arm({written(kArm)});
  EXPECT_THAT(arm.joint_states().names, ElementsAre("shoulder", "joint_1")) << "no free joint";
  ASSERT_EQ(arm.actuators().size(), 3U);
  EXPECT_EQ(arm.actuators()[0].name, "torque");
  EXPECT_EQ(arm.actuators()[0].quantity, Quantity::effort);
  EXPECT_EQ(arm.actuators()[1].name, "shoulder") << "the name of its joint";
  EXPECT_EQ(arm.actuators()[1].quantity, Quantity::position);
  EXPECT_EQ(arm.actuators()[2].quantity, Quantity::velocity);
  ASSERT_EQ(arm.sensors().size(), 2U);
  EXPECT_EQ(arm.sensors()[0].name, "tip");
  EXPECT_EQ(arm.sensors()[1].name, "sensor_1");
  EXPECT_EQ(arm.sensors()[1].width, 3U);
  EXPECT_THAT(arm.names_of(Named::camera), ElementsAre("eye"));
  EXPECT_THAT(arm.names_of(Named::keyframe), ElementsAre("down"));
}

TEST_F(Models, ActuatorsOfOneJointHaveDifferentNames) {
  const Simulation robot({written(R"(<mujoco><worldbody><body><joint name="j"/><geom size="0.1"/>
      </body></worldbody><actuator><motor joint="j"/><motor joint="j"/><position joint="j"/>
      <general joint="j" dyntype="integrator" biastype="affine" biasprm="0 -1 0"/></actuator>
      </mujoco>)")});
  std::vector<std::string> names;
  for (const Actuator& actuator : robot.actuators()) names.push_back(actuator.name);
  EXPECT_THAT(names, ElementsAre("j", "actuator_1", "j", "actuator_3"));
  EXPECT_EQ(robot.actuators()[2].quantity, Quantity::position);
  EXPECT_EQ(robot.actuators()[3].quantity, Quantity::effort) << "its control is a speed";
}

// The loop that MuJoCo's documentation shows (Programming, Simulation loop), with the same
// controls.
TEST_F(Models, MoveAsInMujocosOwnLoopToTheBit) {
  const std::string path = written(kArm);
  Simulation arm({path, "down"});
  const std::unique_ptr<mjModel, void (*)(mjModel*)> model(
      mj_loadXML(path.c_str(), nullptr, nullptr, 0), mj_deleteModel);
  const std::unique_ptr<mjData, void (*)(mjData*)> data(mj_makeData(model.get()), mj_deleteData);
  mj_resetDataKeyframe(model.get(), data.get(), 0);
  const double keep = std::numeric_limits<double>::quiet_NaN();
  for (int step = 0; step < 500; ++step) {
    const double torque = std::sin(0.05 * step);
    arm.command(std::vector{torque, keep, 0.1});
    data->ctrl[0] = torque;
    data->ctrl[2] = 0.1;
    arm.step(kMillisecond);
    if (step % 3 == 0) arm.read_sensor(1);  // who reads changes nothing
    arm.step(kMillisecond);
    mj_step(model.get(), data.get());
  }
  EXPECT_EQ(arm.joint_states().positions[0], data->qpos[0]);
  EXPECT_EQ(arm.joint_states().velocities[1], data->qvel[1]);
  EXPECT_EQ(arm.data().ctrl[1], 1.5) << "of the keyframe";
}

// The tip of a rigid pendulum hangs where its angle says, at the time of the reading.
/// A mass that slides without friction: 2 kg, steps of 5 ms.
constexpr const char* kMass = R"(<mujoco><option timestep="0.005" gravity="0 0 0"/>
  <worldbody><body><joint name="x" type="slide" axis="1 0 0"/><geom size="0.1" mass="2"/></body>
  </worldbody><actuator><motor joint="x"/></actuator></mujoco>)";

TEST_F(Models, ACommandActsFromTheNextPhysicsStepOn) {
  Simulation robot({written(kMass)});
  const auto speed_at = [&](TimeNs time) {
    while (robot.time() < time) {
      robot.step(kMillisecond);
    }
    return robot.joint_states().velocities[0];
  };
  EXPECT_EQ(speed_at(2 * kMillisecond), 0);
  robot.command(std::vector<double>{1.0});  // N
  EXPECT_EQ(speed_at(5 * kMillisecond), 0) << "this step began before the command";
  EXPECT_DOUBLE_EQ(robot.joint_states().efforts[0], 1);
  EXPECT_DOUBLE_EQ(speed_at(10 * kMillisecond), 0.005 / 2);
  robot.command(std::vector<double>{0.0});
  EXPECT_DOUBLE_EQ(speed_at(20 * kMillisecond), 0.005 / 2);
}

TEST_F(Models, ACommandThatMujocoWouldTakeForAFaultChangesNothing) {
  Simulation robot({written(kMass)});
  for (const double number : {1.0, 2e10, -1e300, std::numeric_limits<double>::infinity()}) {
    robot.command(std::vector<double>{number});
    robot.step(10 * kMillisecond);
    EXPECT_DOUBLE_EQ(robot.joint_states().efforts[0], 1) << number;
  }
}

TEST_F(Models, NamesOfTheFileComeFirst) {
  const Simulation robot({written(R"(<mujoco><worldbody>
      <body><joint type="slide"/><geom size="0.1"/><body><joint name="joint_0"/><geom size="0.1"/>
      </body></body></worldbody>
      <actuator><motor joint="joint_0"/><motor name="joint_0" joint="joint_0"/></actuator>
      </mujoco>)")});
  EXPECT_THAT(robot.joint_states().names, ElementsAre("joint_0_", "joint_0"));
  EXPECT_EQ(robot.actuators()[0].name, "actuator_0");
  EXPECT_EQ(robot.actuators()[1].name, "joint_0");
}

TEST_F(Models, SensorsMeasureTheStateOfNow) {
  Simulation arm({written(kArm)});
  for (int i = 0; i < 50; ++i) {
    arm.step(2 * kMillisecond);
    const JointStates joints = arm.joint_states();
    const double length = 0.5 + joints.positions[1];
    const std::vector<double> tip = arm.read_sensor(0);
    EXPECT_NEAR(tip[0], length * std::cos(joints.positions[0]), 1e-12);
    EXPECT_NEAR(tip[2], 1 - length * std::sin(joints.positions[0]), 1e-12);
  }
}

// A box that lies turned by 90 degrees about x on a turntable: it feels the floor along its own y
// axis, and the turning there, too.
TEST_F(Models, AnInertialUnitMeasuresInTheFrameOfItsSite) {
  Simulation table({written(R"(<mujoco><worldbody><body>
      <joint name="turn" type="hinge" axis="0 0 1"/>
      <geom type="box" size="0.1 0.1 0.1" mass="1"/>
      <site name="unit" euler="90 0 0"/></body></worldbody>
      <actuator><velocity name="motor" joint="turn" kv="1"/></actuator>
      <sensor><gyro site="unit"/><accelerometer site="unit"/></sensor></mujoco>)")});
  ASSERT_EQ(table.inertial_units().size(), 1U);
  EXPECT_EQ(table.inertial_units()[0].site, "unit");
  table.command(std::vector{0.5});
  table.step(4000 * kMillisecond);
  const Imu imu = table.read_inertial_unit(0);
  EXPECT_NEAR(imu.linear_acceleration_m_s2[1], 9.81, 1e-6);
  EXPECT_NEAR(imu.linear_acceleration_m_s2[2], 0, 1e-6);
  EXPECT_NEAR(imu.angular_velocity_rad_s[1], 0.5, 1e-3);
  const double turned = table.joint_states().positions[0];
  // Quaternions: half the turn about z, after the quarter turn about x.
  EXPECT_NEAR(imu.orientation[0], std::cos(turned / 2) * std::numbers::sqrt2 / 2, 1e-9);
  EXPECT_NEAR(imu.orientation[3], std::sin(turned / 2) * std::numbers::sqrt2 / 2, 1e-9);
}

// A motor with 2 N m against a damper of 0.1 N m s/rad, without gravity: 20 rad/s, reached with
// the time constant of inertia over damping, 1/3 m l^2 / d.
TEST_F(Models, ACommandHoldsWithinTheControlRange) {
  std::string text = R"(<mujoco><option timestep="0.001" gravity="0 0 0"/><worldbody><body>
      <joint name="hinge" type="hinge" axis="0 0 1" damping="0.1"/>
      <inertial pos="0 0 0" mass="1" diaginertia="0.05 0.05 0.05"/></body></worldbody>
      <actuator><motor name="m" joint="hinge" ctrlrange="-2 2" ctrllimited="true"/></actuator>
      </mujoco>)";
  Simulation wheel({written(text)});
  wheel.command(std::vector{7.0});
  wheel.step(500 * kMillisecond);
  EXPECT_NEAR(wheel.joint_states().velocities[0], 20 * (1 - std::exp(-0.5 / 0.5)), 0.02);
  EXPECT_NEAR(wheel.joint_states().efforts[0], 2, 1e-12);
  wheel.command(std::vector{std::numeric_limits<double>::infinity()});
  wheel.step(5000 * kMillisecond);
  EXPECT_NEAR(wheel.joint_states().velocities[0], 20, 0.01) << "infinity changes nothing";
}

TEST_F(Models, AKeyframeThatIsNotThereIsAnError) {
  const std::string path = written(kArm);
  try {
    const Simulation arm({path, "dwn"});
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_EQ(error.what(), path + ": has no keyframe 'dwn'; did you mean 'down'? [SL0801]");
  }
}

TEST_F(Models, AllFilesOfAModelAreNoted) {
  written("<mujocoinclude><asset><mesh name='m' file='part.obj'/></asset></mujocoinclude>",
          "more.xml");
  std::filesystem::create_directory(folder_.path() / "shapes");
  const std::string mesh =
      written("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n",
              "shapes/part.obj");
  const std::string path = written(
      "<mujoco><compiler meshdir='shapes'/><include file='more.xml'/><worldbody><body><freejoint/>"
      "<geom type='mesh' mesh='m'/></body></worldbody></mujoco>");
  const FilesRead read;
  const Simulation robot({path});
  EXPECT_THAT(read.paths(), ElementsAre((folder_.path() / "more.xml").string(), path, mesh));
}

}  // namespace
}  // namespace spikeloop::vehicle
