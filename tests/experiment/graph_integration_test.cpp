// `spikeloop graph`: a picture that is XML, with all that the file names.
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <utility>

#include "tests/experiment/program.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// What Python says of it.
Outcome parse_xml(const std::string& file, const TemporaryDirectory& directory) {
  return run({.arguments = {"/usr/bin/python3", "-c",
                            "import sys, xml.etree.ElementTree as e; e.parse(sys.argv[1])", file},
              .directory = directory.path().string()});
}

std::string draw(const std::string& name, const std::string& text,
                 const TemporaryDirectory& directory) {
  directory.write(name, text);
  const Outcome outcome = spikeloop({"graph", name, "--out", "x.svg"}, directory);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.text(), "");
  const Outcome parsed = parse_xml("x.svg", directory);
  EXPECT_EQ(parsed.exit_code, 0) << parsed.err;
  return directory.read("x.svg");
}

void expect_boxes(const std::string& svg, std::ptrdiff_t count) {
  static const std::regex kBox("class=\"node\"");
  EXPECT_EQ(std::distance(std::sregex_iterator(svg.begin(), svg.end(), kBox), {}), count);
}

TEST(GraphPicture, OfTheExampleHasAllNames) {
  const TemporaryDirectory directory;
  const std::string svg = draw("x.yaml", spikeloop({"new", "maze"}, directory).out, directory);
  for (const char* name : {"maze",
                           "scan",
                           "ros_sensor",
                           "sectors",
                           "connect",
                           "encoder",
                           "rate_encoder",
                           "brain",
                           "network",
                           "decoder",
                           "linear_readout",
                           "wheels",
                           "ros_command",
                           "/scan",
                           "/cmd_vel",
                           "robot in MuJoCo",
                           "[100]",
                           "[10]",
                           "[2]",
                           "one process, tick 1 ms, realtime"}) {
    EXPECT_THAT(svg, HasSubstr(std::string(name) + "</text>"));
  }
  EXPECT_THAT(svg, HasSubstr("stroke=\"#2f6db3\"")) << "continuous";
  EXPECT_THAT(svg, HasSubstr("stroke=\"#c0392b\"")) << "spikes";
  EXPECT_THAT(svg, Not(HasSubstr("with delay")));
  expect_boxes(svg, 7);
}

TEST(GraphPicture, OfACycle) {
  const TemporaryDirectory directory;
  const std::string svg =
      draw("x.yaml",
           "nodes:\n  a: {node: sigmoid}\n  b: {node: sigmoid}\n  c: {node: sigmoid}\n"
           "connections:\n  - a -> b [2] -> a [2, delay 5 ms]\n  - c -> c [3, delay 2 ticks]\n",
           directory);
  EXPECT_THAT(svg, HasSubstr(">[2, delay 5 ms]</text>"));
  EXPECT_THAT(svg, HasSubstr(">[3, delay 2 ms]</text>"));
  EXPECT_THAT(svg, HasSubstr("stroke-dasharray"));
  EXPECT_THAT(svg, HasSubstr("dashed: with delay</text>"));
  expect_boxes(svg, 3);
}

TEST(GraphPicture, OfThirtyNodes) {
  const TemporaryDirectory directory;
  std::string nodes = "nodes:\n";
  std::string connections = "connections:\n";
  for (int i = 0; i < 30; ++i) {
    const std::string name = "n" + std::to_string(i);
    nodes += "  " + name + ": {node: low_pass, tau: 30 ms}\n";
    const int from = i == 0 ? 29 : i * 7 / 9;
    connections += "  - n" + std::to_string(i > 0 && from == i ? i - 1 : from) + " -> " + name +
                   (i == 0 ? " [2, delay 1 tick]\n" : " [2]\n");
  }
  const std::string svg = draw("x.yaml", nodes + connections, directory);
  for (int i = 0; i < 30; ++i) {
    EXPECT_THAT(svg, HasSubstr(">n" + std::to_string(i) + "</text>"));
  }
  expect_boxes(svg, 30);
}

TEST(GraphPicture, OfAMusicFile) {
  const TemporaryDirectory directory;
  const std::string svg = draw("x.music",
                               "stoptime=1\n[laser]\nnp=1\nbinary=ros_sensor_adapter\n"
                               "ros_topic=/front\n[a&b]\nnp=1\nbinary=./my<own>\n"
                               "laser.out -> a&b.in [3]\n",
                               directory);
  for (const char* name : {"x.music", "laser", "ros_sensor_adapter", "a&amp;b", "my&lt;own&gt;",
                           "/front", "ROS 1: any robot", "one MUSIC job: a process a box"}) {
    EXPECT_THAT(svg, HasSubstr(std::string(name) + "</text>"));
  }
}

TEST(GraphPicture, GoesToStandardOutput) {
  const TemporaryDirectory directory;
  directory.write("x.yaml", spikeloop({"new"}, directory).out);
  const Outcome outcome = spikeloop({"graph", "x.yaml"}, directory);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, testing::StartsWith("<?xml "));
  EXPECT_THAT(outcome.out, testing::EndsWith("</svg>\n"));
}

TEST(GraphPicture, OfWrongFiles) {
  const TemporaryDirectory directory;
  directory.write("x.yaml", "nodes: {a: {node: sigmod}}\nconnections: [a -> a]\n");
  const Outcome outcome = spikeloop({"graph", "x.yaml"}, directory);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.out, "");
  EXPECT_THAT(outcome.err, HasSubstr("unknown node class 'sigmod'; did you mean 'sigmoid'?"));
  directory.write("x.music", "[a]\nnp=1\nbinary=a\n[b]\nnp=1\nbinary=b\na.out -> c.in [1]\n");
  EXPECT_EQ(spikeloop({"graph", "x.music"}, directory).exit_code, 2);
  const Outcome gif = spikeloop({"graph", "x.yaml", "--out", "x.gif"}, directory);
  EXPECT_EQ(gif.exit_code, 2);
  EXPECT_EQ(
      gif.err,
      "spikeloop: --out: 'x.gif' does not end in .svg, .png, .pdf, .dot; write  --out x.svg\n");
  EXPECT_EQ(spikeloop({"graph", "x.yaml", "--out", "a.d/x"}, directory).err,
            "spikeloop: --out: 'a.d/x' does not end in .svg, .png, .pdf, .dot; write  --out "
            "a.d/x.svg\n");
  directory.write("y.yaml", spikeloop({"new"}, directory).out);
  const Outcome nowhere = spikeloop({"graph", "y.yaml", "--out", "no/x.svg"}, directory);
  EXPECT_EQ(nowhere.exit_code, 4);
  EXPECT_THAT(nowhere.err, Fault("spikeloop: cannot create 'no/x.svg': ... [SL0109]\n"));
}

/// Width and height of a PNG, from its header.
std::pair<std::uint32_t, std::uint32_t> png_size(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  unsigned char head[24] = {};
  file.read(reinterpret_cast<char*>(head), sizeof head);
  EXPECT_EQ(std::string(reinterpret_cast<char*>(head), 8), "\x89PNG\r\n\x1a\n");
  const auto number = [&head](int at) {
    return std::uint32_t{head[at]} << 24 | std::uint32_t{head[at + 1]} << 16 |
           std::uint32_t{head[at + 2]} << 8 | head[at + 3];
  };
  return {number(16), number(20)};
}

TEST(Graph, PngIsTwiceAsLargeAsTheSvg) {
  const TemporaryDirectory directory;
  directory.write("y.yaml", spikeloop({"new"}, directory).out);
  const std::string svg = spikeloop({"graph", "y.yaml"}, directory).out;
  std::smatch size;
  ASSERT_TRUE(std::regex_search(svg, size, std::regex("width=\"(\\d+)pt\" height=\"(\\d+)pt\"")));
  const Outcome png = spikeloop({"graph", "y.yaml", "--out", "it's y.png"}, directory);
  EXPECT_EQ(png.exit_code, 0) << png.err;
  const auto [width, height] = png_size(directory.path() / "it's y.png");
  EXPECT_NEAR(width, 2 * std::stod(size[1]), 3);
  EXPECT_NEAR(height, 2 * std::stod(size[2]), 3);
  EXPECT_THAT(spikeloop({"graph", "y.yaml", "--out", "no/x.png"}, directory).err,
              Fault("spikeloop: cannot create 'no/x.png': ... [SL0109]\n"));
}

TEST(Graph, WithoutGraphvizThereIsItsInput) {
  const TemporaryDirectory directory;
  directory.write("y.yaml", spikeloop({"new"}, directory).out);
  const auto draw_to = [&](const char* out) {
    return run({.arguments = {SPIKELOOP_PROGRAM, "graph", "y.yaml", "--out", out},
                .environment = {{"PATH", directory.path().string()}},
                .directory = directory.path().string()});
  };
  const Outcome png = draw_to("y.png");
  EXPECT_EQ(png.exit_code, 3);
  EXPECT_EQ(png.err,
            "spikeloop: Graphviz draws the picture, and its program 'dot' is not in PATH; install "
            "it (Debian: apt install graphviz), or write  --out FILE.dot\n");
  EXPECT_EQ(draw_to("y.dot").exit_code, 0);
  EXPECT_THAT(directory.read("y.dot"), testing::StartsWith("digraph {"));
}

}  // namespace
}  // namespace spikeloop::test
