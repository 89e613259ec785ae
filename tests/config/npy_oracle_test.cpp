// What NumPy writes is read, and NumPy reads what is written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/config/npy_file.hpp"
#include "spikeloop/config/weight_file.hpp"
#include "tests/config/helpers.hpp"
#include "tests/support/child.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop {
namespace {

using test::Fault;
using test::message_of;
using testing::ElementsAre;
using testing::HasSubstr;

class NumPy : public testing::Test {
 protected:
  /// Runs Python in the directory, with numpy as np.
  test::Outcome python(const std::string& code) const {
    const test::Outcome outcome =
        test::run({.arguments = {"/usr/bin/python3", "-c", "import numpy as np\n" + code},
                   .directory = directory_.path().string()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
    return outcome;
  }
  std::string path(const std::string& name) const { return (directory_.path() / name).string(); }

  test::TemporaryDirectory directory_;
};

TEST_F(NumPy, AllTypesOrdersAndVersions) {
  const std::vector<std::string> types = {"f8", "f4", "i1", "i2", "i4",
                                          "i8", "u1", "u2", "u4", "u8"};
  python(
      "for kind in 'f8 f4 i1 i2 i4 i8 u1 u2 u4 u8'.split():\n"
      "  for order in '<>':\n"
      "    for layout in 'CF':\n"
      "      for version in 1, 2, 3:\n"
      "        a = np.array([[1, 2, 3], [4, 5, 127]], order + kind, order=layout)\n"
      "        name = f'{kind}{\"little\" if order == \"<\" else \"big\"}{layout}{version}.npy'\n"
      "        with open(name, 'wb') as file:\n"
      "          np.lib.format.write_array(file, a, (version, 0))\n");
  int read = 0;
  for (const std::string& type : types) {
    for (const std::string order : {"little", "big"}) {
      for (const std::string layout : {"C", "F"}) {
        for (const std::string version : {"1", "2", "3"}) {
          const std::string name = type + order + layout + version + ".npy";
          const WeightTable table = read_weights(path(name));
          EXPECT_EQ(table.rows, 2u) << name;
          EXPECT_THAT(table.values, ElementsAre(1, 2, 3, 4, 5, 127)) << name;
          ++read;
        }
      }
    }
  }
  EXPECT_EQ(read, 120);
}

TEST_F(NumPy, ExtremeNumbers) {
  python(
      "np.save('f8', [5e-324, -1.7976931348623157e308, -0.0])\n"
      "np.save('f4', np.array([[np.finfo('f4').max]], 'f4'))\n"
      "np.save('i8', np.array([-2**63, 2**53 - 1]))\n"
      "np.save('u8', np.array([2**64 - 1], 'u8'))\n"
      "np.save('i1', np.array([-128], 'i1'))\n");
  EXPECT_THAT(read_weights(path("f8.npy")).values,
              ElementsAre(5e-324, -1.7976931348623157e308, -0.0));
  EXPECT_THAT(read_weights(path("f4.npy")).values,
              ElementsAre(static_cast<double>(std::numeric_limits<float>::max())));
  EXPECT_THAT(read_weights(path("i8.npy")).values,
              ElementsAre(-9223372036854775808.0, 9007199254740991.0));
  EXPECT_THAT(read_weights(path("u8.npy")).values, ElementsAre(18446744073709551616.0));
  EXPECT_THAT(read_weights(path("i1.npy")).values, ElementsAre(-128));
}

TEST_F(NumPy, WhatItWritesAndIsNoTable) {
  python(
      "np.save('object', np.array([[1], [2, 3]], object), allow_pickle=True)\n"
      "np.save('fields', np.zeros(2, [('x', 'f8'), ('y', 'f4', (2,))]))\n"
      "np.save('complex', np.zeros((2, 2), complex))\n"
      "np.save('three', np.zeros((2, 2, 2)))\n"
      "np.save('nan', np.asfortranarray([[1, 2], [np.nan, 4]]))\n"
      "with open('two.npy', 'wb') as file:\n"
      "  np.save(file, [1.0]); np.save(file, [2.0])\n");
  const auto error = [&](const std::string& name) {
    return message_of([&] { read_weights(path(name)); });
  };
  EXPECT_THAT(error("object.npy"), HasSubstr("the array holds Python objects"));
  EXPECT_THAT(error("fields.npy"), HasSubstr("the array has named fields"));
  EXPECT_THAT(error("complex.npy"), HasSubstr("the array holds '<c16'"));
  EXPECT_THAT(error("three.npy"), HasSubstr("the array has 3 dimensions"));
  EXPECT_THAT(error("nan.npy"), Fault(path("nan.npy") + ": row 1, column 0 is nan ... [SL0309]"));
  EXPECT_THAT(error("two.npy"), HasSubstr(": 136 bytes follow the array; write one array a file"));
}

TEST_F(NumPy, ReadsWhatIsWritten) {
  write_npy(path("w.npy"), 2, 3, std::vector<double>{1, -2, 0.1, 5e-324, 1e308, 6});
  EXPECT_EQ(python("a = np.load('w.npy')\n"
                   "print(a.dtype.str, a.shape, a.flags.c_contiguous, a.tolist())\n"
                   "print(np.load('w.npy', mmap_mode='r').ctypes.data % 64)\n")
                .out,
            "<f8 (2, 3) True [[1.0, -2.0, 0.1], [5e-324, 1e+308, 6.0]]\n0\n");
}

}  // namespace
}  // namespace spikeloop
