// The file that a job really runs.
#include "spikeloop/launch/effective_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/launch/programs.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::launch::effective_file_test {
namespace {

using test::Fault;
using testing::ElementsAre;
using testing::IsEmpty;

/// The paper's chain, upstream-first, with a foreign network in its middle.
constexpr const char* kLoop = R"(
stoptime=10
[sensor]
np=1
binary=ros_sensor_adapter
[connect]
np=1
binary=connect_adapter
[encoder]
np=1
binary=./bin/rate_encoder
[brain]
np=2
binary=brain.py
[decoder]
np=1
binary=linear_readout_decoder
[command]
np=1
binary=ros_command_adapter
sensor.out -> connect.in [20]
connect.out -> encoder.in [2]
encoder.out -> brain.in [2]
brain.out -> decoder.in [2]
decoder.out -> command.in [2]
)";

MusicFile effective(const std::string& text, const RunOptions& options = {}) {
  return make_effective(parse_music(text, "loop.music"), options).file;
}

/// What the section's program reads; "-" when there is no such key.
std::string value(const MusicFile& file, const std::string& label, const std::string& key) {
  const MusicKey* found = file.find_key(file.section(label), key);
  return found == nullptr ? "-" : found->value;
}

std::vector<std::string> connections_into(const MusicFile& file, const std::string& label) {
  std::vector<std::string> found;
  for (const auto& connection : file.connections) {
    if (connection.to_app == label) {
      found.push_back(describe(connection));
    }
  }
  return found;
}

std::string with(const std::string& section, const std::string& key) {
  std::string text = kLoop;
  const std::string head = "[" + section + "]\n";
  return text.replace(text.find(head), head.size(), head + key + "\n");
}

TEST(EffectiveFile, PutsReceiversBeforeTheirSenders) {
  EXPECT_THAT(effective(kLoop).labels(),
              ElementsAre("command", "decoder", "brain", "encoder", "connect", "sensor"));
}

TEST(EffectiveFile, ConnectsSensorAndCommandByADataStampConnection) {
  const MusicFile file = effective(kLoop);
  EXPECT_THAT(connections_into(file, "command"),
              ElementsAre("decoder.out -> command.in", "sensor.data_stamp -> command.data_stamp"));
  EXPECT_EQ(file.connections.back().width, 1u);
}

TEST(EffectiveFile, AddsNoDataStampConnectionWhenThereIsOneOrNoneIsWanted) {
  const std::string own = std::string(kLoop) + "sensor.beat -> command.data_stamp [1]\n";
  EXPECT_THAT(connections_into(effective(own), "command"),
              ElementsAre("decoder.out -> command.in", "sensor.beat -> command.data_stamp"));
  RunOptions options;
  options.data_stamp = false;
  const MusicFile without = effective(kLoop, options);
  EXPECT_THAT(connections_into(without, "command"), ElementsAre("decoder.out -> command.in"));
  EXPECT_EQ(value(without, "command", "pipeline_ticks"), "-");
}

TEST(EffectiveFile, AddsNoDataStampConnectionWhereNoDataFlow) {
  const MusicFile file = effective(R"(
[sensor]
np=1
binary=ros_sensor_adapter
[sink]
np=1
binary=foreign
[source]
np=1
binary=foreign
[command]
np=1
binary=ros_command_adapter
sensor.out -> sink.in [2]
source.out -> command.in [2]
)");
  EXPECT_THAT(connections_into(file, "command"), ElementsAre("source.out -> command.in"));
  EXPECT_EQ(value(file, "command", "pipeline_ticks"), "-");
}

TEST(EffectiveFile, DataStampConnectionComesFromTheFirstSensorThatReachesTheCommand) {
  const std::string file = R"(
[a]
np=1
binary=ros_sensor_adapter
[b]
np=1
binary=ros_sensor_adapter
[sink]
np=1
binary=foreign
[command]
np=1
binary=ros_command_adapter
a.out -> sink.in [1]
b.out -> command.in [1]
)";
  EXPECT_THAT(connections_into(effective(file), "command"),
              ElementsAre("b.out -> command.in", "b.data_stamp -> command.data_stamp"));
}

// MUSIC.md 2.1: a continuous hop shows the sender's value of the same time, a relay can only send
// it on one tick later. Continuous: sensor-connect, connect-encoder, decoder-command: 3 - 1.
TEST(EffectiveFile, CountsTheTicksThatDataNeedBesideTheDataStampConnection) {
  EXPECT_EQ(value(effective(kLoop), "command", "pipeline_ticks"), "2");
  // An acceptable latency of two ticks is used: spikes arrive two ticks later.
  EXPECT_EQ(value(effective(with("decoder", "accept_latency=0.002")), "command", "pipeline_ticks"),
            "4");
  EXPECT_EQ(value(effective("music_timestep=2 ms\n" + with("decoder", "accept_latency=0.002")),
                  "command", "pipeline_ticks"),
            "3");
  EXPECT_EQ(value(effective(with("command", "signal_delay=2")), "command", "pipeline_ticks"), "4");
  EXPECT_EQ(value(effective(with("command", "pipeline_ticks=9")), "command", "pipeline_ticks"),
            "9");
}

// Beside five connections MUSIC serves data_stamp in batches of six ticks; two more are grace. The
// command adapter's own choice, 0.1 s or three ticks, is enough for short ticks.
TEST(EffectiveFile, AWatchdogWaitsForTheNextBatch) {
  const auto watchdog = [](const std::string& globals) {
    return value(effective(globals + kLoop), "command", "watchdog");
  };
  EXPECT_EQ(watchdog("music_timestep=0.05\n"), "0.4");
  EXPECT_EQ(watchdog("music_timestep=0.05\nrtf=0.5\n"), "0.8");
  EXPECT_EQ(watchdog("music_timestep=0.001\n"), "-");
  EXPECT_EQ(watchdog("music_timestep=0.001\nrtf=slow\n"), "-");
  EXPECT_EQ(watchdog("music_timestep=0.05\nwatchdog=0.2\n"), "0.2");
  RunOptions without;
  without.data_stamp = false;
  EXPECT_EQ(value(effective("music_timestep=0.05\n" + std::string(kLoop), without), "command",
                  "watchdog"),
            "-");
}

TEST(EffectiveFile, ProgramsOfDialectMaEndAfterASecond) {
  const std::string loop = std::string(kLoop).substr(std::string("\nstoptime=10").size());
  EXPECT_EQ(value(effective(loop), "sensor", "stoptime"), "-");
  const MusicFile file = effective("dialect=ma" + loop);
  EXPECT_EQ(value(file, "sensor", "stoptime"), "1");
  EXPECT_EQ(value(file, "brain", "stoptime"), "-") << "it is somebody else's";
  EXPECT_EQ(total_time(file), 1.0);
  EXPECT_EQ(value(effective("dialect=ma" + std::string(kLoop)), "sensor", "stoptime"), "10");
  EXPECT_EQ(value(effective("dialect=auto" + loop), "sensor", "stoptime"), "-");
  std::string other = loop;
  other.replace(other.find("ros_sensor_adapter"), 18, "zmq_cont_adapter");
  try {
    effective("dialect=auto" + other);
    FAIL();
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(error.what(),
                Fault("loop.music:1:1: dialect=auto cannot choose: connect_adapter ... and "
                      "zmq_cont_adapter ... dialect=rma or dialect=ma ... [SL0205]"));
  }
}

TEST(EffectiveFile, ASensorThatIsConnectedToTheCommandAloneNeedsNoExtraTick) {
  const MusicFile file = effective(R"(
[sensor]
np=1
binary=ros_sensor_adapter
[command]
np=1
binary=ros_command_adapter
sensor.out -> command.in [2]
)");
  EXPECT_EQ(value(file, "command", "pipeline_ticks"), "0");
}

TEST(EffectiveFile, OneProcessWaitsForTheClock) {
  EXPECT_EQ(value(effective(kLoop), "sensor", "clock_master"), "true");
  EXPECT_EQ(value(effective(kLoop), "encoder", "clock_master"), "-");
  const std::string two =
      std::string(kLoop) + "[camera]\nnp=1\nbinary=ros_sensor_adapter\ncamera.out -> brain.light\n";
  EXPECT_EQ(value(effective(two), "sensor", "clock_master"), "true");
  EXPECT_EQ(value(effective(two), "camera", "clock_master"), "false");
}

// MUSIC lets neither part wait for the other one.
TEST(EffectiveFile, OneProcessOfEachUnconnectedPartWaitsForTheClock) {
  const auto joined = [](const std::string& keys) {
    return std::string(kLoop) + "[camera]\nnp=1\nbinary=ros_sensor_adapter\n" + keys +
           "[microphone]\nnp=1\nbinary=ros_sensor_adapter\n"
           "[viewer]\nnp=1\nbinary=contsink\n"
           "[first]\nnp=1\nbinary=rate_encoder\n[second]\nnp=1\nbinary=linear_readout_decoder\n"
           "camera.out -> viewer.light\nmicrophone.out -> viewer.sound\n"
           "first.out -> second.in\n";
  };
  const auto masters = [&joined](const std::string& keys) {
    const MusicFile file = effective(joined(keys));
    std::vector<std::string> found;
    for (const char* label : {"sensor", "camera", "microphone", "first", "second"}) {
      found.push_back(value(file, label, "clock_master"));
    }
    return found;
  };
  EXPECT_THAT(masters(""), ElementsAre("true", "true", "false", "true", "-"));
  EXPECT_THAT(masters("clock_master=false\n"), ElementsAre("true", "false", "true", "true", "-"));
  EXPECT_THAT(masters("clock_master=true\n"), ElementsAre("true", "true", "false", "true", "-"));
}

TEST(EffectiveFile, WhoIsWrittenToWaitWaits) {
  const std::string encoder = with("encoder", "clock_master=true");
  EXPECT_EQ(value(effective(encoder), "sensor", "clock_master"), "false");
  EXPECT_EQ(value(effective(encoder), "encoder", "clock_master"), "true");
  const std::string two = with("sensor", "clock_master=false") +
                          "[camera]\nnp=1\nbinary=ros_sensor_adapter\ncamera.out -> brain.light\n";
  EXPECT_EQ(value(effective(two), "sensor", "clock_master"), "false");
  EXPECT_EQ(value(effective(two), "camera", "clock_master"), "true");
  EXPECT_EQ(value(effective(std::string("clock_master=false") + kLoop), "sensor", "clock_master"),
            "false");
}

TEST(EffectiveFile, WithoutASourceTheProgramFurthestUpstreamWaits) {
  const std::string text = R"(
[decoder]
np=1
binary=linear_readout_decoder
[encoder]
np=1
binary=rate_encoder
[player]
np=1
binary=contsource
[plot]
np=1
binary=contsink
player.out -> encoder.in [2]
encoder.out -> decoder.in [2]
decoder.out -> plot.in [2]
)";
  EXPECT_EQ(value(effective(text), "encoder", "clock_master"), "true");
  EXPECT_EQ(value(effective(text), "decoder", "clock_master"), "-");
  EXPECT_EQ(value(effective("clock_master=false\n" + text), "encoder", "clock_master"), "false");
}

// MUSIC.md 6: NEST blocks a channel for ever when a spike lies within 1 us of the tick's begin.
TEST(EffectiveFile, OnlySpikesForForeignProgramsKeepAwayFromTheTick) {
  EXPECT_EQ(value(effective(kLoop), "encoder", "stamp_guard"), "-");
  EXPECT_EQ(value(effective(kLoop), "decoder", "stamp_guard"), "-");
  std::string ours = kLoop;
  ours.replace(ours.find("binary=brain.py"), 15, "binary=spikeloop-network");
  EXPECT_EQ(value(effective(ours), "encoder", "stamp_guard"), "false");
  EXPECT_EQ(value(effective(ours), "brain", "stamp_guard"), "false");
  EXPECT_EQ(value(effective("stamp_guard=true\n" + ours), "encoder", "stamp_guard"), "true");
}

TEST(EffectiveFile, AnOpenChainAcceptsNoLatency) {
  EXPECT_EQ(value(effective(kLoop), "decoder", "accept_latency"), "0");
  EXPECT_EQ(value(effective(with("decoder", "accept_latency=0.005")), "decoder", "accept_latency"),
            "0.005");
  EXPECT_EQ(value(effective(kLoop), "encoder", "accept_latency"), "-");
}

constexpr const char* kTwo = R"(
[network]
np=1
binary=spikeloop-network
[brain]
np=1
binary=brain.py
network.out -> brain.in [2]
brain.out -> network.in [2]
)";

// MUSIC.md 2.3: the acceptable latencies around a cycle must add up to at least its ticks.
TEST(EffectiveFile, ACycleAcceptsWhatItNeeds) {
  const auto two = make_effective(parse_music(kTwo, "f"), {});
  EXPECT_EQ(value(two.file, "network", "accept_latency"), "0.002");
  EXPECT_THAT(two.warnings, IsEmpty());
  std::string ours = kTwo;
  ours.replace(ours.find("brain.py"), 8, "spikeloop-network");
  const MusicFile both = effective("music_timestep=0.01\n" + ours);
  EXPECT_EQ(value(both, "network", "accept_latency"), "0.01");
  EXPECT_EQ(value(both, "brain", "accept_latency"), "0.01");
}

TEST(EffectiveFile, WhatIsWrittenInACycleCounts) {
  std::string ours = kTwo;
  ours.replace(ours.find("brain.py"), 8, "spikeloop-network\naccept_latency=0.5 ms");
  const MusicFile file = effective(ours);
  EXPECT_EQ(value(file, "brain", "accept_latency"), "0.5 ms");
  EXPECT_EQ(value(file, "network", "accept_latency"), "0.0015");
}

TEST(EffectiveFile, ThreeInACycleShareWhatIsMissing) {
  const MusicFile file = effective(R"(
[a]
np=1
binary=spikeloop-network
[b]
np=1
binary=spikeloop-network
[c]
np=1
binary=foreign
a.out -> b.in
b.out -> c.in
c.out -> a.in
b.back -> a.back
)");
  // Around the three: 3 ms among two of ours; around a and b: 2 ms among two.
  EXPECT_EQ(value(file, "a", "accept_latency"), "0.0015");
  EXPECT_EQ(value(file, "b", "accept_latency"), "0.0015");
}

TEST(EffectiveFile, WarnsOfACycleThatItCannotServe) {
  const auto effective_file = make_effective(parse_music(R"(
[a]
np=1
binary=foreign
[b]
np=1
binary=other
a.out -> b.in
b.out -> a.in
)",
                                                         "f"),
                                             {});
  EXPECT_THAT(effective_file.warnings,
              ElementsAre("the cycle a -> b -> a lacks 2 ms of acceptable latency, and no spike "
                          "input of ours in it is free to accept it; MUSIC ends such a job with "
                          "'too short latency': let one of its programs accept more "
                          "(accept_latency, or nest.SetAcceptableLatency)"));
}

TEST(EffectiveFile, TheCommandLineHoldsOverTheFile) {
  RunOptions options;
  options.duration_s = 2.5;
  options.seed = 7;
  options.real_time_factor = 0.5;
  options.record = true;
  const MusicFile file =
      effective("seed=3\n" + with("encoder", "stoptime=99\nseed=4\nrtf=2\nrecord=false"), options);
  for (const std::string& label : file.labels()) {
    EXPECT_EQ(value(file, label, "stoptime"), "2.5");
    EXPECT_EQ(value(file, label, "seed"), "7");
    EXPECT_EQ(value(file, label, "rtf"), "0.5");
    EXPECT_EQ(value(file, label, "record"), label == "brain" ? "-" : "true");
  }
  EXPECT_EQ(total_time(file), 2.5);
}

TEST(EffectiveFile, NodesOfRos2WithOneNameGetTheirSectionsNames) {
  const auto file_of = [](const char* ros) {
    const std::string sensor =
        fmt::format("np=1\nbinary=ros_sensor_adapter\nros_topic=/s\nros={}\n", ros);
    return effective("stoptime=1\n[left]\n" + sensor + "[right]\n" + sensor + "[named]\n" + sensor +
                     "ros_node_name=front\n[wheels]\nnp=1\nbinary=ros_command_adapter\n" +
                     fmt::format("ros={}\n", ros) + "left.out -> wheels.in [2]\n");
  };
  const MusicFile ros2 = file_of("2");
  EXPECT_EQ(value(ros2, "left", "ros_node_name"), "ros_sensor_node_left");
  EXPECT_EQ(value(ros2, "right", "ros_node_name"), "ros_sensor_node_right");
  EXPECT_EQ(value(ros2, "named", "ros_node_name"), "front");
  EXPECT_EQ(value(ros2, "wheels", "ros_node_name"), "-") << "the only one";
  EXPECT_EQ(value(file_of("1"), "left", "ros_node_name"), "-") << "gets a suffix";
}

TEST(EffectiveFile, ChangesNothingElse) {
  MusicFile file = effective(kLoop);
  for (const auto& section : parse_music(kLoop, "loop.music").sections) {
    for (const auto& key : section.keys) {
      EXPECT_EQ(value(file, section.label, key.name), key.value);
    }
  }
  EXPECT_EQ(effective(to_text(file)), file) << "a second pass finds nothing to do";
}

TEST(TotalTime, IsTheSmallestOfAnySection) {
  EXPECT_EQ(total_time(parse_music("stoptime=10\n[a]\nstoptime=2 s\n[b]\n", "f")), 2.0);
  EXPECT_EQ(total_time(parse_music("[a]\n", "f")), std::nullopt);
  EXPECT_EQ(total_time(parse_music("stoptime=soon\n[a]\n", "f")), std::nullopt);
}

TEST(Programs, AreKnownByTheLastPartOfTheBinary) {
  const MusicFile file = parse_music(
      "[a]\nbinary=/usr/bin/poisson_encoder\n[b]\nbinary=x\n[c]\nbinary=spikeloop-node\n"
      "node=rate_encoder\n[d]\n[e]\nbinary=spikeloop-node\nnode=connect\n",
      "f");
  EXPECT_EQ(find_program(file, "e")->output, PortKind::signal);
  EXPECT_EQ(find_program(file, "a")->name, "poisson_encoder");
  EXPECT_EQ(find_program(file, "b"), nullptr);
  EXPECT_EQ(find_program(file, "c")->name, "rate_encoder");
  EXPECT_EQ(find_program(file, "d"), nullptr);
  EXPECT_EQ(find_program(file, "nobody"), nullptr);
  EXPECT_FALSE(all_ours(file));
  EXPECT_FALSE(needs_ros(file, 1));
  EXPECT_TRUE(needs_ros(parse_music(kLoop, "f"), 1));
  EXPECT_FALSE(needs_ros(parse_music(kLoop, "f"), 2));
}

// As plug-ins' are: the launcher has their section recorded, and lets them keep their stamps.
TEST(Programs, ANodeOfAnUnknownClassIsOurs) {
  const std::string text =
      "stoptime=1\n[a]\nnp=1\nbinary=spikeloop-node\nnode=mine\n"
      "[b]\nnp=1\nbinary=spikeloop-network\na.out -> b.in [1]\n";
  const MusicFile file = parse_music(text, "f");
  ASSERT_NE(find_program(file, "a"), nullptr);
  EXPECT_EQ(find_program(file, "a")->name, "spikeloop-node");
  EXPECT_TRUE(all_ours(file));
  EXPECT_FALSE(is_continuous(file, file.connections.front()));
  RunOptions options;
  options.record = true;
  const MusicFile run = effective(text, options);
  EXPECT_EQ(value(run, "a", "record"), "true");
  EXPECT_EQ(value(run, "a", "stamp_guard"), "false");
  EXPECT_EQ(value(run, "a", "clock_master"), "true");
  const MusicFile foreign = effective(
      "[a]\nnp=1\nbinary=spikeloop-node\nnode=mine\n[b]\nnp=1\nbinary=x\na.out -> b.in [1]\n");
  EXPECT_EQ(value(foreign, "a", "stamp_guard"), "-");
}

TEST(Programs, TellWhetherAConnectionIsContinuous) {
  const MusicFile file = parse_music(std::string(kLoop) +
                                         "[x]\nbinary=foreign\nx.out -> connect.extra\n"
                                         "x.spikes -> brain.extra\n",
                                     "f");
  std::vector<bool> continuous;
  for (const auto& connection : file.connections) {
    continuous.push_back(is_continuous(file, connection));
  }
  EXPECT_THAT(continuous, ElementsAre(true, true, false, false, true, true, false));
}

TEST(EffectiveFile, AddsNoDataStampConnectionFromASourceWithoutThePort) {
  const auto made = make_effective(
      parse_music("[a]\nnp=1\nbinary=zmq_cont_adapter\n[b]\nnp=1\nbinary=ros_command_adapter\n"
                  "a.out -> b.in [2]\n",
                  "f"),
      {});
  EXPECT_EQ(made.file.connections.size(), 1U);
}

TEST(EffectiveFile, WarnsOfForeignProgramsThatMusic1116CannotRun) {
  std::string text = "stoptime=1\n";
  for (int i = 0; i < 12; ++i) {
    text += "[p" + std::to_string(i) + "]\nnp=1\nbinary=foreign.py\n";
    if (i > 0) {
      text += "p" + std::to_string(i - 1) + ".out -> p" + std::to_string(i) + ".in [1]\n";
    }
  }
  const auto warnings = make_effective(parse_music(text, "loop.music"), {}).warnings;
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_EQ(
      warnings[0],
      "'p1' is program 11 of the job, and MUSIC 1.1.16, which Debian has, crashes in programs "
      "after the tenth; run fewer, or use MUSIC 1.1.17");
}

}  // namespace
}  // namespace spikeloop::launch::effective_file_test
