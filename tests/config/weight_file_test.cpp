#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>

#include "spikeloop/config/weight_file.hpp"
#include "tests/config/helpers.hpp"
#include "tests/support/repetitions.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::weight_file_test {
namespace {

using test::Fault;
using test::message_of;
using testing::ElementsAre;
using Kind = WeightTable::Kind;

WeightOptions lax(std::uint32_t rows = 0, std::uint32_t columns = 0) {
  WeightOptions options;
  options.strict = false;
  options.rows = rows;
  options.columns = columns;
  return options;
}

std::string error(const std::string& text) {
  return message_of([&] { parse_weights(text, "w"); });
}

TEST(WeightFile, ReadsShortForms) {
  EXPECT_EQ(read_weights("uniform").kind, Kind::uniform);
  EXPECT_TRUE(read_weights("uniform").values.empty());
  EXPECT_THAT(read_weights("uniform:0.01").values, ElementsAre(0.01));
  EXPECT_EQ(read_weights("one_to_one").kind, Kind::one_to_one);
  EXPECT_EQ(read_weights("one_to_one").resized(3, 3).at(2, 2), 1.0);
  EXPECT_THAT(read_weights("one_to_one: -2e-1").values, ElementsAre(-0.2));
  EXPECT_TRUE(read_weights("even").is_even());
  EXPECT_FALSE(read_weights("uniform").is_even());
  for (const std::string text :
       {"uniform:", "uniform:x", "uniform:1x", "uniform:nan", "uniform:inf"}) {
    EXPECT_EQ(message_of([&] { read_weights(text); }),
              "the weight in '" + text + "' is not a finite number; write 'uniform:0.5' [SL0201]");
  }
}

TEST(WeightFile, ReadsDenseTables) {
  const WeightTable table = parse_weights(test::data_text("readout.json"), "w");
  EXPECT_EQ(table.kind, Kind::dense);
  EXPECT_EQ(table.rows, 2u);
  EXPECT_EQ(table.columns, 2u);
  EXPECT_THAT(table.values, ElementsAre(0.5, -0.25, 0.1, 2.0));
  EXPECT_EQ(parse_weights(" /* c */ [[1,2,3]] ", "w").columns, 3u);
  EXPECT_EQ(parse_weights("\xEF\xBB\xBF[[1]]", "w").columns, 1u);
}

TEST(WeightFile, ReadsWeightsWithTheTimeConstantOfTheirFit) {
  const WeightTable table = parse_weights(R"({"tau_s": 0.05, "weights": [[1, 2], [3, 4]]})", "w");
  EXPECT_EQ(table.kind, Kind::dense);
  EXPECT_THAT(table.values, ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(table.fitted_tau_s, 0.05);
  EXPECT_EQ(parse_weights("[[1, 2]]", "w").fitted_tau_s, 0);
}

TEST(WeightFile, MakesAGridOfAxes) {
  const WeightTable table = parse_weights(R"({"axes": [[-1, 1, 3, 0.2], [5, 6, 2, 0.4]]})", "w");
  EXPECT_EQ(table.kind, Kind::dense);
  EXPECT_EQ(table.rows, 6u);
  EXPECT_EQ(table.columns, 4u);
  EXPECT_THAT(table.values, ElementsAre(-1, 5, 0.2, 0.4, -1, 6, 0.2, 0.4,  //
                                        0, 5, 0.2, 0.4, 0, 6, 0.2, 0.4,    //
                                        1, 5, 0.2, 0.4, 1, 6, 0.2, 0.4));
  EXPECT_THAT(parse_weights(R"({"axes": [[3, 9, 1, 0.2]]})", "w").values, ElementsAre(3, 0.2));
}

TEST(WeightFile, ReadsSparseTables) {
  const WeightTable table = parse_weights(test::data_text("sparse.json"), "w");
  EXPECT_EQ(table.kind, Kind::sparse);
  EXPECT_EQ(table.rows, 2u);
  EXPECT_EQ(table.columns, 1000u);
  EXPECT_THAT(table.row_start, ElementsAre(0u, 2u, 3u));
  EXPECT_THAT(table.column, ElementsAre(3u, 17u, 999u));
  EXPECT_THAT(table.values, ElementsAre(2.0, 0.5, -1.5));
  EXPECT_EQ(table.at(0, 4), 0.0);
  EXPECT_EQ(parse_weights(R"({"entries": [], "columns": 2, "rows": 3})", "w").row_start.size(), 4u);
}

/// A sparse file and a dense file of the same random table give the same weights.
TEST(WeightFile, SparseAndDenseFilesAgree) {
  std::mt19937 random(3);
  for (int round = 0; round < 50; ++round) {
    const auto rows = 1 + random() % 6;
    const auto columns = 1 + random() % 9;
    std::vector<std::string> entries;
    std::string dense = "[";
    for (std::size_t i = 0; i < rows; ++i) {
      dense += i == 0 ? "[" : ",[";
      for (std::size_t j = 0; j < columns; ++j) {
        const int weight = random() % 3 == 0 ? static_cast<int>(random() % 100) - 50 : 0;
        dense += (j == 0 ? "" : ",") + std::to_string(weight);
        if (weight != 0) {
          entries.push_back("[" + std::to_string(i) + "," + std::to_string(j) + "," +
                            std::to_string(weight) + "]");
        }
      }
      dense += "]";
    }
    dense += "]";
    std::shuffle(entries.begin(), entries.end(), random);
    std::string sparse = "{\"entries\":[";
    for (std::size_t i = 0; i < entries.size(); ++i) {
      sparse += (i == 0 ? "" : ",") + entries[i];
    }
    sparse +=
        "],\"rows\":" + std::to_string(rows) + ",\"columns\":" + std::to_string(columns) + "}";
    const WeightTable a = parse_weights(dense, "w").compressed();
    const WeightTable b = parse_weights(sparse, "w");
    ASSERT_EQ(a.row_start, b.row_start) << dense << sparse;
    ASSERT_EQ(a.column, b.column);
    ASSERT_EQ(a.values, b.values);
  }
}

struct Case {
  std::string text;
  std::string message;
};

TEST(WeightFile, SaysWhatIsWrongInADenseTable) {
  const std::string rows =
      "write an array of weights: [[0.1, 0.2], [0.3, 0.4]], one row an output [SL0309]";
  const std::string nothing =
      "w: the table has no weights; write [[0.1, 0.2], [0.3, 0.4]], one row an output, or "
      "'uniform' in place of the file [SL0309]";
  const Case cases[] = {
      {"", "w: ... empty ... [[0.1, 0.2], [0.3, 0.4]] ... [SL0309]"},
      {" \n", "w: ... empty ... [[0.1, 0.2], [0.3, 0.4]] ... [SL0309]"},
      {std::string("\x89PNG\0", 5),
       "w: ... (byte 4 ... 0x00) ... [[0.1, 0.2], [0.3, 0.4]] ... [SL0309]"},
      {"[]", nothing},
      {"[[],[]]", nothing},
      {"0.5",
       "w: the table is 0.5; write an array of rows, [[0.1, 0.2], [0.3, 0.4]], one row an output "
       "[SL0309]"},
      {"true", "w: ... true ... [[0.1, 0.2], [0.3, 0.4]] ... [SL0309]"},
      {"[1, 2]", "w: row 0 is 1; " + rows},
      {"[[1], null]", "w: row 1 is null; " + rows},
      {"[[1], {}]", "w: row 1 is an object; " + rows},
      {"[[1, 2], [3, \"x\"]]", "w: row 1, column 1 is \"x\" ... [SL0309]"},
      {"[[1, false]]", "w: row 0, column 1 is false ... [SL0309]"},
      {"[[1, [2]]]", "w: row 0, column 1 is an array ... [SL0309]"},
      {"[[1, 2], [3]]", "w: row 1 has 1 weights, but row 0 has 2 ... [SL0309]"},
      {"[[1], [2], [3, 4]]", "w: row 2 has 2 weights, but row 0 has 1 ... [SL0309]"},
      {"[[1, NaN]]",
       "w:1:6: not JSON: invalid literal; last read: '1, N'; NaN is not a number of JSON: write a "
       "finite one [SL0101]"},
      {"[[1,\n-Infinity]]",
       "w:2:2: not JSON: invalid number; expected digit after '-'; last read: '-I'; Infinity ... "
       "JSON: ... [SL0101]"},
      {"[[1, nan]]",
       "w:1:7: not JSON: invalid literal; last read: '1, na'; nan ... JSON: ... [SL0101]"},
  };
  for (const auto& [text, message] : cases) {
    EXPECT_THAT(error(text), Fault(message)) << text;
  }
}

TEST(WeightFile, NamesLineAndColumnOfBrokenJson) {
  EXPECT_THAT(error("[[1, 2],\n [3, x]]"),
              testing::StartsWith("w:2:6: not JSON: invalid literal; last read: "));
  EXPECT_THAT(error("[[1, 2]\n"), testing::StartsWith("w:2:1: not JSON: unexpected end of input"));
  EXPECT_THAT(error("[[1, 2]] 3"),
              testing::StartsWith("w:1:10: not JSON: unexpected number literal"));
  EXPECT_THAT(error("[[1e999]]"),
              testing::EndsWith("not JSON: number overflow parsing '1e999' [SL0101]"));
}

TEST(WeightFile, SaysWhatIsWrongInASparseTable) {
  const auto sparse = [](const std::string& entries) {
    return "{\"rows\": 2, \"columns\": 3, \"entries\": " + entries + "}";
  };
  const std::string range = ", but the table has 2 rows and 3 columns; both count from 0 [SL0309]";
  const Case cases[] = {
      {"{}",
       "w: the key 'rows' is missing; write {\"rows\": 2, \"columns\": 3, \"entries\": [[0, 2, "
       "0.5]]} [SL0309]"},
      {"{\"rows\": 2, \"columns\": 3}",
       "w: the key 'entries' is missing; write {\"rows\": 2, \"columns\": 3, \"entries\": [[0, 2, "
       "0.5]]} [SL0309]"},
      {"{\"row\": 2}", "w: unknown key 'row'; did you mean 'rows'? [SL0309]"},
      {"{\"weights\": [[1]], \"tau_S\": 1}",
       "w: unknown key 'tau_S'; did you mean 'tau_s'? [SL0309]"},
      {"{\"tau_s\": 0.03}",
       "w: the key 'weights' is missing; write {\"tau_s\": 0.03, \"weights\": [[0.1, 0.2], [0.3, "
       "0.4]]} [SL0309]"},
      {"{\"tau_s\": \"30 ms\", \"weights\": [[1]]}", "w: 'tau_s' is \"30 ms\" ... [SL0309]"},
      {"{\"axes\": []}",
       "w: 'axes' is empty ... [first centre, last centre, number of centres, width] ... [SL0309]"},
      {"{\"axes\": [[0, 1, 2, 1], [0, 1, 2]]}",
       "w: axis 1 has 3 numbers; write [first centre, last centre, number of centres, width] "
       "[SL0309]"},
      {"{\"axes\": [[0, 1, 0, 1]]}",
       "w: the number of centres of axis 0 is 0 ... 1 to 16777216 ... [SL0309]"},
      {"{\"axes\": [[0, 1, 2, 1], [0, 1, 3, -0.5]]}",
       "w: the width of axis 1 is -0.5 ... 0 ... [SL0309]"},
      {"{\"axes\": [[0, 1, 5000, 1], [0, 1, 5000, 1]]}",
       "w: the axes have 25000000 combinations, more than 4194304; write fewer centres [SL0309]"},
      {"{\"rows\": 2, \"rows\": 2}", "w: the key 'rows' is given twice; remove one [SL0309]"},
      {"{\"rows\": 0, \"columns\": 3, \"entries\": []}",
       "w: 'rows' is 0 ... 1 to 16777216 ... [SL0309]"},
      {"{\"rows\": 2, \"columns\": 16777217, \"entries\": []}",
       "w: 'columns' is 16777217 ... 1 to 16777216 ... [SL0309]"},
      {"{\"rows\": 1.5, \"columns\": 3, \"entries\": []}",
       "w: 'rows' is 1.5 ... 1 to 16777216 ... [SL0309]"},
      {"{\"rows\": [2], \"columns\": 3, \"entries\": []}",
       "w: 'rows' is an array ... 1 to 16777216 ... [SL0309]"},
      {sparse("3"), "w: 'entries' is 3 ... [row, column, weight] ... [SL0309]"},
      {sparse("[3]"), "w: entry 0 is 3; write [row, column, weight] [SL0309]"},
      {sparse("[[0, 0, 1], [0, 0]]"),
       "w: entry 1 has 2 items; write [row, column, weight] [SL0309]"},
      {sparse("[[0, 0, 1, 1]]"), "w: entry 0 has 4 items; write [row, column, weight] [SL0309]"},
      {sparse("[[0, 0, \"x\"]]"), "w: entry 0 is \"x\" ... [SL0309]"},
      {sparse("[[0, 0, NaN]]"),
       "w:1:46: not JSON: invalid literal; last read: '0, N'; NaN ... JSON: ... [SL0101]"},
      {sparse("[[-1, 0, 1]]"), "w: entry 0 is at row -1, column 0" + range},
      {sparse("[[0, 0.5, 1]]"), "w: entry 0 is at row 0, column 0.5" + range},
      {sparse("[[2, 0, 1]]"), "w: entry 0 is at row 2, column 0" + range},
      {sparse("[[0, 0, 1], [1, 3, 1]]"), "w: entry 1 is at row 1, column 3" + range},
      {sparse("[[1, 2, 1], [0, 0, 1], [1, 2, 3]]"),
       "w: row 1, column 2 has two weights; write one entry [SL0309]"},
  };
  for (const auto& [text, message] : cases) {
    EXPECT_THAT(error(text), Fault(message)) << text;
  }
}

TEST(WeightFile, IsLookedForBesideItsConfigurationAndHere) {
  const test::TemporaryDirectory directory;
  directory.write("here.json", "[[7]]");
  WeightOptions options;
  options.base_directory = directory.path();
  EXPECT_THAT(read_weights("here.json", options).values, ElementsAre(7.0));
  EXPECT_THAT(read_weights((directory.path() / "here.json").string()).values, ElementsAre(7.0));
  const std::string name = "spikeloop-config-test-" + std::to_string(::getpid()) + ".json";
  std::ofstream(name) << "[[8]]";
  EXPECT_THAT(read_weights(name, options).values, ElementsAre(8.0));
  std::filesystem::remove(name);

  const std::string here = std::filesystem::current_path().string();
  EXPECT_EQ(message_of([&] { read_weights("none.json", options); }),
            "there is no weight file 'none.json' in '" + here + "' or '" +
                directory.path().string() +
                "'; write its path, 'uniform', 'one_to_one' or 'blocks' [SL0108]");
  EXPECT_EQ(message_of([&] { read_weights("unifrom"); }),
            "there is no weight file 'unifrom' in '" + here +
                "'; write its path, 'uniform', 'one_to_one' or 'blocks'; did you mean 'uniform'? "
                "[SL0108]");
  EXPECT_EQ(message_of([&] { read_weights("", options); }).substr(0, 26),
            "there is no weight file ''");
}

TEST(WeightFile, SaysWhenAFileCannotBeRead) {
  const test::TemporaryDirectory directory;
  const std::string file = directory.write("w.json", std::string(2'500'000, ' '));
  WeightOptions options;
  options.maximum_bytes = 2'000'000;
  EXPECT_EQ(message_of([&] { read_weights(file, options); }),
            file + ": the file has 2 MB, more than the 2 MB that a weight file may have [SL0203]");
  EXPECT_EQ(message_of([&] { read_weights(directory.path().string()); }),
            "cannot read '" + directory.path().string() + "': Is a directory [SL0109]");
}

TEST(WeightFile, LoaderLeavesTheKeyToResolve) {
  ParameterDescription parameter;
  parameter.name = "weights";
  parameter.type = ParameterType::weights;
  WrittenValues written{{"weights", {test::data_path_of("readout.json"), {"f", 3, 1}}}};
  const auto table = resolve({parameter}, written, weight_loader({})).weights("weights");
  EXPECT_EQ(table.rows, 2u);
  written["weights"].text = "uniform:";
  EXPECT_THAT(message_of([&] { resolve({parameter}, written, weight_loader({})); }),
              Fault("f:3:1: key 'weights': ... 'uniform:' ... 'uniform:0.5' ... [SL0201]"));
}

TEST(WeightFile, OlderProgramsTakeAMeanForAFileTheyCannotRead) {
  for (const std::string text : {"", "[[1,", "[[1, NaN]]"}) {
    test::LogCapture log;
    const WeightTable table = parse_weights(text, "w", lax());
    EXPECT_EQ(table.kind, Kind::uniform) << text;
    EXPECT_EQ(table.resized(1, 4).at(0, 3), 0.25);
    ASSERT_EQ(log.messages.size(), 1u);
    EXPECT_THAT(log.messages[0], testing::HasSubstr("; every weight is 1 / inputs [SL"));
  }
  test::LogCapture log;
  EXPECT_EQ(read_weights("none.json", lax()).kind, Kind::uniform);
  EXPECT_THAT(log.messages.at(0), testing::StartsWith("there is no weight file 'none.json' in "));
  EXPECT_EQ(read_weights("/", lax()).kind, Kind::uniform);
  EXPECT_EQ(log.messages.at(1),
            "cannot read '/': Is a directory; every weight is 1 / inputs [SL0109]");
  weight_loader(lax())({"/", {"job.music", 3, 1}});
  EXPECT_EQ(log.messages.at(2),
            "job.music:3:1: cannot read '/': Is a directory; every weight is 1 / inputs [SL0109]");
}

TEST(WeightFile, OlderProgramsFitATableToThePorts) {
  const std::string what = "; missing weights are 0, surplus ones are left out";
  {
    test::LogCapture log;
    const WeightTable table = parse_weights("[[1, 2, 3], [4]]", "w", lax());
    EXPECT_THAT(table.values, ElementsAre(1, 2, 3, 4, 0, 0));
    EXPECT_THAT(log.messages, ElementsAre("w: row 1 has 1 of 3 weights" + what));
  }
  {
    test::LogCapture log;
    const WeightTable table = parse_weights("[[1, 2, 3]]", "w", lax(2, 2));
    EXPECT_EQ(table.rows, 2u);
    EXPECT_THAT(table.values, ElementsAre(1, 2, 0, 0));
    EXPECT_THAT(log.messages, ElementsAre("w: row 0 has 3 of 2 weights" + what));
  }
  {
    test::LogCapture log;
    EXPECT_THAT(parse_weights("[[1], [2]]", "w", lax(1, 1)).values, ElementsAre(1));
    EXPECT_THAT(log.messages, ElementsAre("w: there are 2 of 1 rows" + what));
  }
  {
    test::LogCapture log;
    EXPECT_THAT(parse_weights("[[1]] x", "w", lax(1, 1)).values, ElementsAre(1));
    EXPECT_THAT(log.messages, ElementsAre("w:1:7: text after the end of the table is left out"));
  }
  test::LogCapture log;
  EXPECT_THAT(parse_weights("[[1, 2], [3, 4]]", "w", lax(2, 2)).values, ElementsAre(1, 2, 3, 4));
  EXPECT_TRUE(log.messages.empty());
}

TEST(WeightFile, MutatedFilesAreReadOrRefused) {
  const std::vector<std::string> texts = {test::data_text("halves.json"),
                                          test::data_text("readout.json"),
                                          test::data_text("sparse.json")};
  std::mt19937 random(11);
  for (int i = 0; i < test::repetitions(5000); ++i) {
    std::string text = texts[random() % texts.size()];
    for (unsigned k = 0; k < 1 + random() % 4; ++k) {
      const std::size_t at = random() % text.size();
      const std::string pieces[] = {"[", "]", "{", "}", ",", "\"", "NaN", "-", "1e400", "\n", "99"};
      if (random() % 2 == 0) {
        text.insert(at, pieces[random() % std::size(pieces)]);
      } else {
        text[at] = static_cast<char>(random() % 256);
      }
    }
    for (const bool strict : {true, false}) {
      WeightOptions options;
      options.strict = strict;
      try {
        const WeightTable table = parse_weights(text, "w", options);
        if (table.kind == Kind::dense) {
          ASSERT_EQ(table.values.size(), std::size_t{table.rows} * table.columns);
        }
      } catch (const ConfigurationError&) {
      }
    }
  }
}

TEST(WeightFile, DeepNestingIsRefused) {
  const std::size_t depth = 200'000;
  EXPECT_THAT(error(std::string(depth, '[') + std::string(depth, ']')),
              Fault("w: row 0, column 0 is an array ... [SL0309]"));
  EXPECT_EQ(error("{\"rows\": 1, \"columns\": 1, \"entries\": " + std::string(depth, '[') +
                  std::string(depth, ']') + "}"),
            "w: entry 0 has 1 items; write [row, column, weight] [SL0309]");
  EXPECT_EQ(
      parse_weights(std::string(depth, '[') + std::string(depth, ']') + " x", "w", lax()).kind,
      Kind::uniform);
}

}  // namespace
}  // namespace spikeloop::weight_file_test
