// Files of NumPy's, made by hand: what is wrong with them is said.
#include "spikeloop/config/npy_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <limits>
#include <random>
#include <stdexcept>

#include "spikeloop/config/weight_file.hpp"
#include "tests/config/helpers.hpp"
#include "tests/support/repetitions.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop::npy_file_test {
namespace {

using test::Fault;
using test::message_of;
using testing::ElementsAre;
using testing::HasSubstr;
using Kind = WeightTable::Kind;

std::string bytes_of(const std::vector<double>& values) {
  std::string bytes;
  for (const double value : values) {
    char number[sizeof value];
    std::memcpy(number, &value, sizeof value);
    bytes.append(number, sizeof value);
  }
  return bytes;
}

/// A file of version 1.0 with this header.
std::string file_with(const std::string& header, const std::string& data) {
  return std::string("\x93NUMPY\x01\0", 8) + static_cast<char>(header.size()) + '\0' + header +
         data;
}

std::string header_of(const std::string& type, const std::string& shape) {
  return "{'descr': " + type + ", 'fortran_order': False, 'shape': " + shape + ", }\n";
}

std::string array(const std::string& shape, const std::vector<double>& values) {
  return file_with(header_of("'<f8'", shape), bytes_of(values));
}

WeightTable parsed(const std::string& bytes, const WeightOptions& options = {}) {
  return parse_weights(bytes, "w.npy", options);
}

std::string error(const std::string& bytes) {
  return message_of([&] { parsed(bytes); });
}

WeightOptions lax(std::uint32_t rows = 0, std::uint32_t columns = 0) {
  WeightOptions options;
  options.strict = false;
  options.rows = rows;
  options.columns = columns;
  return options;
}

TEST(NpyFile, ReadsTablesAndSingleRows) {
  const WeightTable table = parsed(array("(2, 3)", {1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(table.kind, Kind::dense);
  EXPECT_EQ(table.rows, 2u);
  EXPECT_EQ(table.columns, 3u);
  EXPECT_THAT(table.values, ElementsAre(1, 2, 3, 4, 5, 6));
  const WeightTable row = parsed(array("(3,)", {1, 2, 3}));
  EXPECT_EQ(row.rows, 1u);
  EXPECT_EQ(row.columns, 3u);
}

TEST(NpyFile, HeadersNeedNotLookLikeNumpysOwn) {
  const std::string data = bytes_of({1, 2, 3, 4, 5, 6});
  for (const std::string header :
       {"{'shape':(3L,2L),'fortran_order':True,'descr':'<f8'}",
        "  { \"shape\" : ( 3 , 2 ) , \"descr\" : \"<f8\" , \"fortran_order\" : True }   \n"}) {
    EXPECT_THAT(parsed(file_with(header, data)).values, ElementsAre(1, 4, 2, 5, 3, 6)) << header;
  }
}

TEST(NpyFile, IsKnownByItsFirstBytes) {
  EXPECT_THAT(parse_weights(array("(1, 1)", {7}), "readout_weights.dat").values, ElementsAre(7));
  EXPECT_FALSE(is_npy("[[1, 2]]"));
  const std::string none =
      "w.npy: this is no .npy file, it does not begin with \\x93NUMPY; write it with numpy.save, "
      "or give a JSON file another name [SL0309]";
  EXPECT_EQ(error("[[1, 2]]"), none);
  EXPECT_EQ(error(""), none);
  EXPECT_EQ(error("\x93NUMP"), none);
}

TEST(NpyFile, SaysThatItWasCutOff) {
  const std::string whole = array("(2, 3)", {1, 2, 3, 4, 5, 6});
  const std::size_t header = whole.size() - 48;
  for (std::size_t size = 6; size < header; ++size) {
    EXPECT_EQ(error(whole.substr(0, size)), "w.npy: the file ends within its header, after " +
                                                std::to_string(size) +
                                                " bytes; it was cut off, write it again [SL0309]");
  }
  for (std::size_t size = header; size < whole.size(); ++size) {
    EXPECT_THAT(error(whole.substr(0, size)),
                Fault("w.npy: the file has " + std::to_string(size - header) +
                      " bytes of data, too few for shape (2, 3) of '<f8' ... [SL0309]"));
  }
  EXPECT_THAT(error(array("(18446744073709551615, 18446744073709551615)", {1})),
              Fault("w.npy: ... 8 ... too few for shape (18446744073709551615, "
                    "18446744073709551615) of '<f8' ... [SL0309]"));
  EXPECT_THAT(error(array("(3,)", {1})),
              Fault("w.npy: ... 8 ... too few for shape (3,) of '<f8' ... [SL0309]"));
  EXPECT_EQ(error(whole + "xy"),
            "w.npy: 2 bytes follow the array; write one array a file [SL0309]");
}

TEST(NpyFile, SaysWhatItDoesNotRead) {
  const std::string unread =
      "; float64, float32 and whole numbers are read: write weights.astype(float) [SL0309]";
  const std::array<std::string, 2> cases[] = {
      {"'|O'",
       "the array holds Python objects, as one of rows of different lengths does; write numbers: "
       "numpy.array(weights, dtype=float) [SL0309]"},
      {"[('x', '<f8'), ('y', '<f8', (2,))]",
       "the array has named fields; write an array of plain numbers [SL0309]"},
      {"'<c16'", "the array holds '<c16'" + unread},
      {"'<f2'", "the array holds '<f2'" + unread},
      {"'|b1'", "the array holds '|b1'" + unread},
      {"'|f8'", "the array holds '|f8'" + unread},
      {"'<U3'", "the array holds '<U3'" + unread}};
  for (const auto& [type, message] : cases) {
    EXPECT_EQ(error(file_with(header_of(type, "(1, 1)"), bytes_of({1}))), "w.npy: " + message);
  }
  EXPECT_EQ(error(array("(1, 1, 2)", {1, 2})),
            "w.npy: the array has 3 dimensions; write 2, [output, input], or 1 for a single row "
            "[SL0309]");
  EXPECT_THAT(error(array("()", {1})),
              Fault("w.npy: ... 0 dimensions ... 2, [output, input], or 1 ... [SL0309]"));
  std::string version = array("(1, 1)", {1});
  version[6] = 4;
  EXPECT_EQ(
      error(version),
      "w.npy: format version 4.0 is not known; write 1.0, 2.0 or 3.0, as numpy.save does [SL0309]");
}

TEST(NpyFile, SaysThatItsHeaderIsBroken) {
  const std::string good = header_of("'<f8'", "(1, 1)");
  for (const std::string& header :
       {std::string("{}"), std::string(""), good + "x", good.substr(1), good.substr(0, 30),
        header_of("'<f8", "(1, 1)"), header_of("''", "(1, 1)"), header_of("[", "(1, 1)"),
        header_of("'<f8'", "(1, -1)"), header_of("'<f8'", "(1, 1"), header_of("'<f8'", "(1 1)"),
        header_of("'<f8'", "[1, 1]"), header_of("'<f8'", "(99999999999999999999, 1)"),
        std::string("{'descr': '<f8', 'fortran_order': False}"),
        std::string("{'descr': '<f8', 'fortran_order': 0, 'shape': (1, 1)}"),
        std::string("{'descr': '<f8', 'fortran_order': False, 'form': (1, 1)}"),
        std::string("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 1), 'shape': (1, 1)}"),
        std::string("{'descr': '<f8' 'fortran_order': False, 'shape': (1, 1)}")}) {
    EXPECT_EQ(
        error(file_with(header, bytes_of({1}))),
        "w.npy: the header is not a dictionary of 'descr', 'fortran_order' and 'shape'; write "
        "the file with numpy.save [SL0309]")
        << header;
  }
}

TEST(NpyFile, NamesThePlaceOfANumberThatIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_THAT(error(array("(2, 3)", {1, 2, 3, 4, nan, 6})),
              Fault("w.npy: row 1, column 1 is nan ... [SL0309]"));
  EXPECT_THAT(error(array("(3,)", {1, 2, -infinite})),
              Fault("w.npy: row 0, column 2 is -inf ... [SL0309]"));
  EXPECT_THAT(error(file_with("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3)}",
                              bytes_of({1, 2, 3, infinite, 5, 6}))),
              Fault("w.npy: row 1, column 1 is inf ... [SL0309]"));
}

TEST(NpyFile, HasAsManyChannelsAsAPortCanHave) {
  const std::string most = "; at most 16777216 of each are possible [SL0309]";
  const std::string bytes(16'777'217, '\1');
  EXPECT_EQ(error(file_with(header_of("'|u1'", "(16777217,)"), bytes)),
            "w.npy: the table has 1 rows of up to 16777217 weights" + most);
  EXPECT_EQ(error(file_with(header_of("'|u1'", "(16777217, 1)"), bytes)),
            "w.npy: the table has 16777217 rows of up to 1 weights" + most);
  for (const std::string shape : {"(0, 3)", "(3, 0)", "(0,)", "(18446744073709551615, 0)"}) {
    EXPECT_THAT(error(array(shape, {})), HasSubstr("w.npy: the table has no weights; write "));
  }
}

TEST(NpyFile, OlderProgramsTakeAMeanForAFileTheyCannotRead) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const std::string& bytes :
       {std::string(), array("(1, 2)", {1}), array("(1, 1)", {nan}), array("(1, 1, 1)", {1})}) {
    test::LogCapture log;
    EXPECT_EQ(parsed(bytes, lax()).kind, Kind::uniform);
    ASSERT_EQ(log.messages.size(), 1u);
    EXPECT_THAT(log.messages[0], testing::StartsWith("w.npy: "));
    EXPECT_THAT(log.messages[0], testing::EndsWith("; every weight is 1 / inputs [SL0309]"));
  }
  test::LogCapture log;
  EXPECT_EQ(read_weights("none.npy", lax()).kind, Kind::uniform);
  EXPECT_THAT(log.messages.at(0), testing::StartsWith("there is no weight file 'none.npy' in "));
}

TEST(NpyFile, OlderProgramsFitATableToThePorts) {
  const std::string what = "; missing weights are 0, surplus ones are left out";
  test::LogCapture log;
  EXPECT_THAT(parsed(array("(1, 3)", {1, 2, 3}), lax(2, 2)).values, ElementsAre(1, 2, 0, 0));
  EXPECT_THAT(parsed(array("(2, 2)", {1, 2, 3, 4}), lax(2, 3)).values,
              ElementsAre(1, 2, 0, 3, 4, 0));
  EXPECT_THAT(parsed(array("(2, 2)", {1, 2, 3, 4}) + "x", lax(2, 2)).values,
              ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(log.messages, ElementsAre("w.npy: row 0 has 3 of 2 weights" + what,
                                        "w.npy: row 0 has 2 of 3 weights" + what,
                                        "w.npy: 1 bytes follow the array and are left out"));
}

TEST(NpyFile, WhatIsWrittenIsRead) {
  const test::TemporaryDirectory directory;
  const auto path = directory.path() / "w.npy";
  for (const auto& [rows, columns] : {std::pair{1, 1}, {3, 100}, {100, 3}, {1000, 1000}}) {
    std::vector<double> values(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = 1.0 / (1.0 + static_cast<double>(i));
    }
    write_npy(path, static_cast<std::uint64_t>(rows), static_cast<std::uint64_t>(columns), values);
    const WeightTable table = read_weights(path.string());
    EXPECT_EQ(table.rows, static_cast<std::uint32_t>(rows));
    EXPECT_EQ(table.columns, static_cast<std::uint32_t>(columns));
    EXPECT_EQ(table.values, values);
  }
}

TEST(NpyFile, SaysWhyItCannotBeWritten) {
  const std::vector<double> values(4);
  EXPECT_THAT(message_of([&] { write_npy("/nowhere/w.npy", 2, 2, values); }),
              Fault("cannot create '/nowhere/w.npy': ... [SL0109]"));
  EXPECT_EQ(message_of([&] { write_npy("/dev/full", 2, 2, values); }),
            "cannot write '/dev/full': No space left on device [SL0109]");
  EXPECT_THROW(write_npy("w.npy", 2, 3, values), std::logic_error);
}

TEST(NpyFile, MutatedFilesAreReadOrRefused) {
  const std::string good = array("(2, 3)", {1, 2, 3, 4, 5, 6});
  std::mt19937 random(5);
  for (int i = 0; i < test::repetitions(5000); ++i) {
    std::string bytes = good;
    for (unsigned k = 0; k < 1 + random() % 3; ++k) {
      bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
    }
    bytes.resize(random() % 4 == 0 ? random() % bytes.size() : bytes.size());
    bytes.shrink_to_fit();
    for (const bool strict : {true, false}) {
      WeightOptions options;
      options.strict = strict;
      try {
        const WeightTable table = parsed(bytes, options);
        if (table.kind == Kind::dense) {
          ASSERT_EQ(table.values.size(), std::size_t{table.rows} * table.columns);
        }
      } catch (const ConfigurationError&) {
      }
    }
  }
}

}  // namespace
}  // namespace spikeloop::npy_file_test
