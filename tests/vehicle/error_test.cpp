// Every message a world can cause.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <stdexcept>

#include "spikeloop/core/error.hpp"
#include "tests/support/fault.hpp"
#include "worlds.hpp"

namespace spikeloop::vehicle {
namespace {

using test::Fault;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

template <typename Kind>
std::string message(const std::string& world) {
  try {
    const Vehicle vehicle({world, 1});
  } catch (const Kind& error) {
    return error.what();
  } catch (const std::exception& error) {
    return std::string("another kind of error: ") + error.what();
  }
  return "no error";
}

std::string complaint(const World& world) {
  const std::string text = message<ConfigurationError>(world.path());
  EXPECT_THAT(text, StartsWith(world.path())) << "the file must be named";
  const std::string rest = text.substr(std::min(text.size(), world.path().size()));
  const auto space = rest.find(' ');
  return space == std::string::npos ? rest : rest.substr(space + 1);
}

std::string complaint(const std::string& numerics, const std::string& bodies) {
  return complaint(World(numerics, bodies));
}

// The shipped vehicle with one piece of its text replaced, in a world of its own.
std::string complaint_of_vehicle(const std::string& from, const std::string& to) {
  const std::filesystem::path shipped = find_world("spikeloop_vehicle.xml");
  std::ifstream in(shipped);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  const test::TemporaryDirectory directory;
  directory.write("spikeloop_vehicle.xml", text);  // beside the world: has precedence
  const std::string world = directory.write("world.xml", mjcf(kArena + kStart, kFloor));
  const std::string what = message<Error>(world);
  return what.substr(std::min(what.size(), what.find(' ') + 1));
}

const std::string kIncludeRemedy =
    "include the shipped vehicle: <include file=\"spikeloop_vehicle.xml\"/>";

TEST(WorldErrors, MissingFile) {
  EXPECT_THAT(message<FileError>("/nowhere/arena.xml"),
              Fault("cannot open world '/nowhere/arena.xml': ... [SL0109]"));
  EXPECT_THAT(message<FileError>("arenna.xml"),
              Fault("cannot find world 'arenna.xml': no such file here, nor in /... "
                    "share/spikeloop/worlds ... ; write the path of an MJCF file, or arena, "
                    "phototaxis, t_maze or lane for a shipped world [SL0108]"));
}

TEST(WorldErrors, ADirectoryIsNoWorld) {
  EXPECT_EQ(message<FileError>("/tmp"), "cannot read '/tmp': Is a directory [SL0109]");
}

TEST(WorldErrors, BadXml) {
  EXPECT_THAT(complaint(World("<mujoco>\n  <worldbody>\n")),
              StartsWith("MuJoCo 2.2.2 cannot read it: "));
}

TEST(WorldErrors, BadMjcfNamesTheLine) {
  const World world("<mujoco>\n<worldbody>\n<geom tipe=\"box\"/>\n</worldbody></mujoco>");
  EXPECT_THAT(
      message<ConfigurationError>(world.path()),
      AllOf(StartsWith(world.path() + ":3: MuJoCo 2.2.2 cannot read it: "), HasSubstr("tipe")));
}

TEST(WorldErrors, WithoutARobot) {
  EXPECT_EQ(complaint(World("<mujoco><worldbody>" + kFloor + "</worldbody></mujoco>")),
            "has no body 'vehicle'; " + kIncludeRemedy + " [SL0801]");
  EXPECT_EQ(complaint(World("<mujoco><worldbody><body name=\"vehicle\"><geom size=\"1\"/></body>"
                            "</worldbody></mujoco>")),
            "body 'vehicle' has no free joint; write <freejoint/> in it, or " + kIncludeRemedy +
                " [SL0801]");
}

TEST(WorldErrors, WithPartsOfTheRobotMissing) {
  EXPECT_EQ(complaint_of_vehicle("site name=\"laser\"", "site name=\"lidar\""),
            "has no site 'laser'; " + kIncludeRemedy + " [SL0801]");
  EXPECT_EQ(complaint_of_vehicle("velocity name=\"wheel_rear_left\"", "velocity name=\"other\""),
            "has no actuator 'wheel_rear_left'; " + kIncludeRemedy + " [SL0801]");
  EXPECT_EQ(complaint_of_vehicle("<numeric name=\"laser\"", "<numeric name=\"lidar\""),
            "has no numeric 'laser'; write <custom><numeric name=\"laser\" data=\"...\"/></custom> "
            "with 6 numbers: beams (2 to 10000), first and last angle (rad, rising), smallest and "
            "largest range (m, rising), scans per second (0.001 to 1000) [SL0801]");
  EXPECT_THAT(
      complaint_of_vehicle("data=\"100 -1.5", "data=\"0.5 -1.5"),
      Fault("numeric 'laser' is \"0.5 -1.5707963267948966 1.5707963267948966 0.05 5 20\"; write 6 "
            "numbers: beams (2 to 10000) ... (rad, rising) ... (m, rising) ... [SL0801]"));
  EXPECT_EQ(
      complaint_of_vehicle("data=\"1.0 3.0", "data=\"1.0 -3.0"),
      "numeric 'command_limits' is \"1 -3 4 20\"; write 4 numbers: largest speed (m/s), yaw "
      "rate (rad/s), acceleration (m/s^2) and yaw acceleration (rad/s^2), all above 0 [SL0801]");
}

TEST(WorldErrors, AJointWithoutAWheel) {
  EXPECT_EQ(
      complaint_of_vehicle("<geom name=\"wheel_front_left\" class=\"wheel\"/>",
                           "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>"),
      "joint 'wheel_front_left' turns a body without a geom; " + kIncludeRemedy + " [SL0801]");
}

TEST(WorldErrors, ATimestepTooLong) {
  EXPECT_EQ(complaint_of_vehicle("timestep=\"0.002\"", "timestep=\"0.05\""),
            "has a timestep of 0.05 s; write a timestep from 1e-6 to 0.01 s, such as "
            "<option timestep=\"0.002\"/> [SL0801]");
}

TEST(WorldErrors, WithoutAFloor) {
  EXPECT_EQ(
      complaint(kArena, ""),
      "has no geom 'floor'; write <geom name=\"floor\" type=\"plane\" size=\"4 4 0.1\"/> [SL0801]");
}

TEST(WorldErrors, TheArenasOutline) {
  const std::string meaning = "smallest x and y, largest x and y of the walls' inner faces";
  EXPECT_EQ(complaint("", kFloor),
            "has no numeric 'arena'; write <custom><numeric name=\"arena\" data=\"...\"/></custom> "
            "with 4 numbers: " +
                meaning + " [SL0801]");
  EXPECT_EQ(complaint(R"(<numeric name="arena" data="3 3"/>)", kFloor),
            "numeric 'arena' is \"3 3\"; write 4 numbers: " + meaning + " [SL0801]");
  EXPECT_EQ(complaint(R"(<numeric name="arena" data="3 3 -3 -3"/>)", kFloor),
            "numeric 'arena' is \"3 3 -3 -3\", which is empty; write " + meaning + " [SL0801]");
}

TEST(WorldErrors, NumbersOutOfRangeNameTheLine) {
  const auto refuses = [](const std::string& numerics, const std::string& bodies,
                          const std::string& line, const std::string& text) {
    const World world("\n" + numerics, "\n" + kFloor + "\n" + bodies);
    EXPECT_THAT(message<ConfigurationError>(world.path()),
                Fault(world.path() + ":" + line + ": " + text));
  };
  const auto arena = [&](const std::string& most, const std::string& text) {
    refuses("<numeric name='arena'\n data='-3 -3 3 " + most + "'/>", "", "4", text);
  };
  arena("1e9", "numeric 'arena' ... 1000000003 m; write at most 1000 m ... [SL0801]");
  arena("9223372036854775808",
        "numeric 'arena' ... 9.223372036854776e+18; ... 1e+09: ... [SL0801]");
  arena("1e20", "numeric 'arena' ... 1e+20; ... 1e+09: ... [SL0801]");
  arena("nan", "numeric 'arena' ... nan; ... 1e+09: ... [SL0801]");
  refuses(kArena + "<numeric name=\"start\" data=\"0 0 1e10\"/>", "", "3",
          "numeric 'start' ... 10000000000; ... [SL0801]");
  const auto body = [&](const std::string& element, const std::string& text) {
    refuses(kArena + kStart, "<!-- size=\"1e300\" -->\n" + element, "7", text + " [SL0203]");
  };
  body("<geom size=\"1e300\"/>", "<geom>: size=\"1e300\" ... from -1000000 to 1000000");
  body("<body pos='0 0 -inf'/>", "<body>: pos=\"-inf\" ... from -1000000 to 1000000");
  body("<composite count='3 2000 1'/>", "<composite>: count=\"2000\" ... from -1000 to 1000");
}

TEST(WorldErrors, RejectsCountsThatNeedTooMuchMemoryOrTime) {
  const auto refuses = [](const std::string& part, const std::string& attribute) {
    const World world("<mujoco>\n" + part + "\n</mujoco>");
    EXPECT_THAT(
        message<ConfigurationError>(world.path()),
        Fault(world.path() + ":2: ... " + attribute + " ... write a number from ... [SL0203]"));
  };
  refuses("<asset><hfield name='h' nrow='1000000000' ncol='9'/></asset>", "nrow=\"1000000000\"");
  refuses("<asset><texture type='2d' width='2e9' height='2'/></asset>", "width=\"2e9\"");
  refuses("<size nconmax='100000000'/>", "nconmax=\"100000000\"");
  refuses("<visual><quality numslices='2000000000'/></visual>", "numslices=\"2000000000\"");
  refuses("<visual><quality shadowsize='1000000'/></visual>", "shadowsize=\"1000000\"");
  refuses("<sensor><user dim='100000000'/></sensor>", "dim=\"100000000\"");
  refuses("<custom><numeric name='n' size='100000000'/></custom>", "size=\"100000000\"");
}

TEST(WorldErrors, ANumberOfAnIncludedFile) {
  const test::TemporaryDirectory directory;
  const std::string part =
      directory.write("part.xml",
                      "<mujocoinclude>\n<custom>\n<numeric name=\"arena\" data=\"0 0 1e9 1\"/>\n"
                      "</custom></mujocoinclude>");
  const std::string world = directory.write(
      "world.xml", mjcf(kStart, kFloor + "</worldbody><include file=\"part.xml\"/><worldbody>"));
  EXPECT_THAT(message<ConfigurationError>(world), Fault(part + ":3: numeric 'arena' ... [SL0801]"));
}

TEST(WorldErrors, ManyObstaclesThatDoNotFitAreRefusedSoon) {
  std::string bodies = kFloor;
  for (int i = 0; i < 400; ++i) {
    bodies += "<body name=\"obstacle_" + std::to_string(i) +
              "\" mocap=\"true\"><geom type=\"cylinder\" size=\"0.1 0.2\"/></body>";
  }
  const std::string numerics =
      R"(<numeric name="arena" data="0 0 20 20"/><numeric name="passage" data="0.75"/>)";
  EXPECT_THAT(complaint(numerics, bodies), Fault("its 400 obstacles do not fit ... [SL0801]"));
}

TEST(WorldErrors, Obstacles) {
  const std::string shapes =
      "obstacle 'obstacle_a' has a geom that is not an upright box or cylinder; write type=\"box\" "
      "or "
      "type=\"cylinder\" and turn it about z only [SL0801]";
  const auto of = [](const std::string& body) { return complaint(kArena, kFloor + body); };
  EXPECT_EQ(of(R"(<body name="obstacle_a"><geom type="sphere" size="0.2"/></body>)"), shapes);
  EXPECT_EQ(of(R"(<body name="obstacle_a" euler="90 0 0"><geom type="box" size="1 1 1"/></body>)"),
            shapes);
  EXPECT_EQ(
      of(R"(<body name="obstacle_a"><joint/><geom type="box" size="1 1 1"/></body>)"),
      "obstacle 'obstacle_a' can move; make it a child of <worldbody> without joints [SL0801]");
}

TEST(WorldErrors, Lamps) {
  const std::string intensity = "the lamp's luminous intensity (cd), above 0";
  const std::string site = R"(<site name="lamp_1" pos="1 0 0.2"/>)";
  EXPECT_EQ(
      complaint(kArena + kStart, kFloor + site),
      "has no numeric 'lamp_1'; write <custom><numeric name=\"lamp_1\" data=\"...\"/></custom> "
      "with 1 numbers: " +
          intensity + " [SL0801]");
  EXPECT_EQ(complaint(kArena + kStart + R"(<numeric name="lamp_1" data="-2"/>)", kFloor + site),
            "numeric 'lamp_1' is \"-2\"; write 1 number: " + intensity + " [SL0801]");
}

TEST(WorldErrors, PhotodiodesAreNeededWhereThereAreLamps) {
  const std::filesystem::path shipped = find_world("spikeloop_vehicle.xml");
  std::ifstream in(shipped);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  text.replace(text.find("light_right\""), 12, "eye\"");
  const test::TemporaryDirectory directory;
  directory.write("spikeloop_vehicle.xml", text);
  const std::string numerics = kArena + kStart + R"(<numeric name="lamp_1" data="1"/>)";
  const std::string world =
      directory.write("world.xml", mjcf(numerics, kFloor + R"(<site name="lamp_1"/>)"));
  EXPECT_THAT(message<ConfigurationError>(world),
              Fault("... has no site 'light_right'; a world with lamps needs it: include the "
                    "shipped vehicle, or write <site name=\"light_left\"/> and \"light_right\" "
                    "into body 'vehicle', x along the diode's normal [SL0801]"));
}

TEST(WorldErrors, Cues) {
  const std::string remedy =
      "body 'cue' is put in one of several places by the seed; write mocap=\"true\" in it, and "
      "<custom><numeric name=\"cue_place_1\" data=\"X Y HEADING\"/></custom>, cue_place_2 and so "
      "on [SL0801]";
  const std::string place = R"(<numeric name="cue_place_1" data="1 0 0"/>)";
  EXPECT_EQ(complaint(kArena + kStart,
                      kFloor + R"(<body name="cue" mocap="true"><geom size="0.1"/></body>)"),
            remedy);
  EXPECT_EQ(complaint(kArena + kStart + place,
                      kFloor + R"(<body name="cue" pos="1 1 0"><geom size="0.1"/></body>)"),
            remedy);
}

TEST(WorldErrors, MarksThatAreNoBoxes) {
  for (const std::string prefix : {"lane_", "goal_"}) {
    EXPECT_THAT(
        complaint(kArena + kStart, kFloor + "<geom name=\"" + prefix +
                                       "1\" type=\"cylinder\" size=\"0.5 0.001\" contype=\"0\" "
                                       "conaffinity=\"0\"/>"),
        Fault("geom '" + prefix + "1' is not a box, as marks " + prefix +
              "* of the floor are; write type=\"box\", or give it another name [SL0801]"));
  }
}

TEST(WorldErrors, TooManyObstacles) {
  std::string bodies = kFloor;
  for (const char* name : {"a", "b", "c"}) {
    bodies += std::string("<body name=\"obstacle_") + name +
              "\" mocap=\"true\"><geom type=\"cylinder\" size=\"1.0 0.2\"/></body>";
  }
  EXPECT_EQ(complaint(kArena, bodies),
            "its 3 obstacles do not fit into the arena with 0.9 m between them (seed 1); write "
            "fewer or smaller obstacles, a larger arena or a smaller numeric 'passage' [SL0801]");
}

TEST(WorldErrors, NoRoomToStart) {
  EXPECT_EQ(complaint(kArena + R"(<numeric name="start_clearance" data="3.5"/>)", kFloor),
            "has no place that is 3.5 m away from every wall, obstacle and end of a lane (seed 1); "
            "write a smaller numeric 'start_clearance' or fewer obstacles [SL0801]");
  EXPECT_EQ(complaint(kArena + R"(<numeric name="start" data="2.9 0 0"/>)", kFloor),
            "numeric 'start' = (2.9, 0) is nearer than the vehicle's radius of 0.234 m to a wall "
            "or an obstacle; write a free place [SL0801]");
}

TEST(PhysicsErrors, AnUnstableWorldSaysSo) {
  const World world(kArena + kStart,
                    kFloor + R"(<body name="top" pos="2 2 1"><joint name="spin" stiffness="0"/>
                                <geom size="0.1"/></body></worldbody>
                                <actuator><general joint="spin" gainprm="0" biastype="affine"
                                biasprm="0 0 1e9"/><general joint="spin" biastype="affine"
                                biasprm="1e6 0 0"/></actuator><worldbody>)");
  Vehicle vehicle = world.vehicle();
  try {
    vehicle.step(kSecond);
    FAIL() << "it is stable";
  } catch (const NodeError& error) {
    EXPECT_THAT(
        error.what(),
        AllOf(StartsWith("node 'robot': the physics of " + world.path() + " became unstable at "),
              EndsWith("; write a smaller <option timestep=\"...\"/> (now 2 ms) or weaker "
                       "actuators [SL0704]")));
  }
}

TEST(PhysicsErrors, AnErrorInsideMujocoIsThrown) {
  const Vehicle vehicle({"arena.xml", 1});
  try {
    mju_error("out of memory");
    FAIL();
  } catch (const NodeError& error) {
    EXPECT_STREQ(error.what(), "node 'robot': MuJoCo stopped: out of memory [SL0704]");
  }
}

}  // namespace
}  // namespace spikeloop::vehicle
