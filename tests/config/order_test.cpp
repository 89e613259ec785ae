#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <random>

#include "spikeloop/config/order.hpp"
#include "tests/config/helpers.hpp"

namespace spikeloop {
namespace {

using Labels = std::vector<std::string>;

/// Sections of one letter each, connections of two: "ab" is a -> b.
MusicFile graph(const std::string& sections, const Labels& edges) {
  MusicFile file;
  for (const char label : sections) {
    file.sections.push_back({std::string(1, label), {}, {}});
  }
  for (const auto& edge : edges) {
    MusicConnection c;
    c.from_app = edge.substr(0, 1);
    c.to_app = edge.substr(1, 1);
    c.from_port = "out" + edge;
    c.to_port = "in" + edge;
    file.connections.push_back(c);
  }
  return file;
}

std::string order(const std::string& sections, const Labels& edges) {
  std::string text;
  for (const auto& label : downstream_first(graph(sections, edges))) {
    text += label;
  }
  return text;
}

TEST(Order, PutsReceiversBeforeSenders) {
  EXPECT_EQ(order("abcde", {"ab", "bc", "cd", "de"}), "edcba");
  EXPECT_EQ(order("cab", {"ab", "bc"}), "cba");
  const MusicFile vehicle = read_music_file(test::data_path_of("vehicle.music"));
  EXPECT_EQ(downstream_first(vehicle),
            (Labels{"wheels", "readout", "brain", "spikes", "halves", "scan"}));
}

TEST(Order, KeepsTheFilesOrderWhereItIsFree) {
  EXPECT_EQ(order("abc", {}), "abc");
  EXPECT_EQ(order("edcba", {"ab", "bc", "cd", "de"}), "edcba");
  EXPECT_EQ(order("sxyz", {"sx", "sy", "sz"}), "xyzs");
  EXPECT_EQ(order("zyxs", {"sx", "sy", "sz"}), "zyxs");
}

TEST(Order, BreaksACycleAtItsFirstListed) {
  EXPECT_EQ(order("abc", {"ab", "bc", "ca"}), "cba");
  EXPECT_EQ(order("bca", {"ab", "bc", "ca"}), "acb");
}

TEST(Order, BreaksACycleWhereItIsFedFromOutside) {
  // s -> n, n <-> d, d -> c: the network n comes before its decoder d, however they are listed.
  EXPECT_EQ(order("sndc", {"sn", "nd", "dn", "dc"}), "cdns");
  EXPECT_EQ(order("dncs", {"sn", "nd", "dn", "dc"}), "cdns");
}

TEST(Order, BreaksNestedCyclesAndParallelConnections) {
  EXPECT_EQ(order("abcd", {"ab", "ab", "bc", "cb", "cd", "da"}), "dcba");
}

TEST(Order, IgnoresUnknownApplications) {
  EXPECT_EQ(order("ab", {"ab", "ax", "xb"}), "ba");
}

TEST(Order, TakesTheWholeFileAlong) {
  const MusicFile file = read_music_file(test::data_path_of("feedback.music"));
  const MusicFile ordered = order_downstream_first(file);
  EXPECT_EQ(ordered.labels(), (Labels{"mirror", "act", "decode", "net", "encode", "sense"}));
  EXPECT_EQ(ordered.connections, file.connections);
  EXPECT_EQ(ordered.section("net"), file.section("net"));
}

/// Checks the property itself: without cycles, every receiver stands before its sender, and no
/// later section could have stood earlier while one listed before it waits without need.
TEST(Order, RandomAcyclicGraphsAreOrderedAndStayOrdered) {
  std::mt19937 random(7);
  for (int round = 0; round < 300; ++round) {
    std::string letters = "abcdefgh";
    std::shuffle(letters.begin(), letters.end(), random);
    Labels edges;
    for (int i = 0; i < 10; ++i) {
      std::string edge{"abcdefgh"[random() % 8], "abcdefgh"[random() % 8]};
      if (edge[0] != edge[1]) {
        std::sort(edge.begin(), edge.end());  // from the earlier letter: no cycle
        edges.push_back(edge);
      }
    }
    const std::string result = order(letters, edges);
    for (const auto& edge : edges) {
      ASSERT_LT(result.find(edge[1]), result.find(edge[0]));
    }
    ASSERT_EQ(order(result, edges), result);
  }
}

const IsContinuous kLetter = [](const MusicConnection& c) { return c.from_app < "d"; };

TEST(DataPath, CountsContinuousHops) {
  // a, b and c send continuous signals, d and e spikes.
  const MusicFile file = graph("abcdef", {"ab", "bc", "cd", "de", "ef"});
  const auto path = data_path(file, "a", "f", kLetter);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->connections, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(path->continuous_hops, 3);
  EXPECT_EQ(data_path_ticks(file, "a", "f", kLetter), 2);
  EXPECT_EQ(data_path_ticks(file, "d", "f", kLetter), 0);
  EXPECT_EQ(data_path_ticks(file, "c", "f", kLetter), 0);
}

TEST(DataPath, PrefersFewContinuousHopsThenFewHops) {
  const MusicFile file = graph("abdef", {"ab", "bf", "ad", "de", "ef", "df"});
  const auto path = data_path(file, "a", "f", kLetter);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->connections, (std::vector<std::size_t>{2, 5}));
  EXPECT_EQ(path->continuous_hops, 1);
}

TEST(DataPath, KnowsWhenThereIsNone) {
  const MusicFile file = graph("abc", {"ab", "cb"});
  EXPECT_FALSE(data_path(file, "a", "c", kLetter));
  EXPECT_FALSE(data_path(file, "a", "z", kLetter));
  EXPECT_FALSE(data_path_ticks(file, "b", "a", kLetter));
  EXPECT_FALSE(data_path(file, "a", "a", kLetter));
}

TEST(DataPath, GoesAroundACycle) {
  const MusicFile file = graph("abc", {"ab", "bc", "ca"});
  EXPECT_EQ(data_path(file, "a", "a", kLetter)->connections, (std::vector<std::size_t>{0, 1, 2}));
}

}  // namespace
}  // namespace spikeloop
