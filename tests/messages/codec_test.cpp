// Our definitions and codec against other people's: roscpp's generated serializers in ROS 1,
// Fast-CDR in ROS 2, for every definition that we bring.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <ostream>
#include <random>

#include "content.hpp"
#include "reference_cdr.hpp"
#include "reference_messages.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/messages/message_writer.hpp"

namespace {

using namespace spikeloop::messages;
using spikeloop::test::Content;
using spikeloop::test::random_content;

struct Case {
  Dialect dialect;
  std::string type;
};

void PrintTo(const Case& each, std::ostream* out) {
  *out << each.type << " of ROS " << (each.dialect == Dialect::ros1 ? 1 : 2);
}

std::span<const std::byte> bytes_of(const std::vector<std::uint8_t>& bytes) {
  return std::as_bytes(std::span(bytes));
}

class Codec : public testing::TestWithParam<Case> {
 protected:
  const Catalog& catalog() const { return Catalog::builtin(GetParam().dialect); }
  const std::string& type() const { return GetParam().type; }

  Content content(unsigned seed) const { return random_content(*catalog().layout(type()), seed); }

  std::vector<std::uint8_t> reference_bytes(const Content& content) const {
    return GetParam().dialect == Dialect::ros1
               ? reference::serialize(type(), content.atoms)
               : reference::serialize_cdr(catalog(), type(), content.atoms);
  }
};

TEST_P(Codec, reads_what_the_reference_wrote) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Content made = content(seed);
    const std::vector<std::uint8_t> bytes = reference_bytes(made);
    for (const auto& [path, numbers] : made.numbers) {
      std::vector<double> read;
      EXPECT_EQ(FieldReader(catalog(), type(), path).read(bytes_of(bytes), read), numbers.size());
      EXPECT_EQ(read, numbers) << path << ", seed " << seed;
    }
    for (const auto& [path, text] : made.texts) {
      std::vector<std::string_view> read;
      TextField(catalog(), type(), path).read(bytes_of(bytes), read);
      EXPECT_EQ(read, std::vector<std::string_view>{text}) << path << ", seed " << seed;
    }
  }
}

TEST_P(Codec, writes_what_the_reference_writes) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Content made = content(seed);
    std::vector<std::string> paths;
    std::vector<FieldValue> values;
    for (const auto& [path, numbers] : made.numbers) {
      paths.push_back(path);
      values.push_back({numbers, {}});
    }
    for (const auto& [path, text] : made.texts) {
      paths.push_back(path);
      values.push_back({{}, text});
    }
    std::vector<std::byte> written;
    MessageWriter(catalog(), type(), paths).write(values, written);
    const std::vector<std::uint8_t> bytes = reference_bytes(made);
    ASSERT_EQ(written.size(), bytes.size());
    EXPECT_TRUE(std::ranges::equal(written, bytes_of(bytes))) << "seed " << seed;
  }
}

// Every truncation and many bit flips: an error or values, never a read outside (under ASan).
TEST_P(Codec, damaged_bytes_never_lead_outside) {
  std::mt19937 engine(7);
  for (unsigned seed = 0; seed < 2; ++seed) {
    const Content made = content(seed);
    const std::vector<std::uint8_t> whole = reference_bytes(made);
    std::vector<FieldReader> numbers;
    for (const auto& [path, values] : made.numbers) {
      numbers.emplace_back(catalog(), type(), path);
    }
    std::vector<TextField> texts;
    for (const auto& [path, text] : made.texts) {
      texts.emplace_back(catalog(), type(), path);
    }
    const auto read_all = [&](const std::vector<std::uint8_t>& bytes) {
      // A copy of exactly this size: its end is the end of the allocation.
      const std::vector<std::uint8_t> exact(bytes);
      for (const FieldReader& reader : numbers) {
        std::vector<double> values;
        try {
          reader.read(bytes_of(exact), values);
        } catch (const spikeloop::TransportError&) {
        }
        EXPECT_LE(values.size(), std::max<std::size_t>(bytes.size(), 1));
      }
      for (const TextField& reader : texts) {
        std::vector<std::string_view> values;
        try {
          reader.read(bytes_of(exact), values);
        } catch (const spikeloop::TransportError&) {
        }
        for (const std::string_view value : values) {
          EXPECT_LE(value.size(), bytes.size());
        }
      }
    };
    for (std::size_t size = 0; size < whole.size(); ++size) {
      read_all({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
    }
    for (int i = 0; i < 100 && !whole.empty(); ++i) {
      std::vector<std::uint8_t> damaged = whole;
      for (int flips = 0; flips < 3; ++flips) {
        damaged[engine() % damaged.size()] ^= static_cast<std::uint8_t>(1u << (engine() % 8));
      }
      read_all(damaged);
    }
  }
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const std::string& type : reference::types()) {
    all.push_back({Dialect::ros1, type});
  }
  for (const std::string& type : Catalog::builtin(Dialect::ros2).names()) {
    all.push_back({Dialect::ros2, type});
  }
  return all;
}

std::string test_name(const testing::TestParamInfo<Case>& info) {
  std::string name = info.param.type + (info.param.dialect == Dialect::ros1 ? "_ros1" : "_ros2");
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(EveryType, Codec, testing::ValuesIn(cases()), test_name);

class DebianDefinition : public testing::TestWithParam<std::string> {};

TEST_P(DebianDefinition, has_the_same_md5_sum) {
  const Catalog& ours = Catalog::builtin(Dialect::ros1);
  EXPECT_EQ(ours.md5(GetParam()), reference::md5(GetParam()));
}

TEST_P(DebianDefinition, with_comments_gives_the_same_sum) {
  Catalog catalog(Dialect::ros1);
  catalog.add_with_dependencies(GetParam(), reference::definition(GetParam()));
  EXPECT_EQ(catalog.md5(GetParam()), reference::md5(GetParam()));
}

TEST_P(DebianDefinition, our_full_text_parses_to_the_same_sum) {
  Catalog catalog(Dialect::ros1);
  catalog.add_with_dependencies(GetParam(), Catalog::builtin(Dialect::ros1).full_text(GetParam()));
  EXPECT_EQ(catalog.md5(GetParam()), reference::md5(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(EveryType, DebianDefinition, testing::ValuesIn(reference::types()),
                         [](const testing::TestParamInfo<std::string>& each) {
                           std::string name = each.param;
                           std::replace(name.begin(), name.end(), '/', '_');
                           return name;
                         });

// Debian has no event cameras and no Gazebo: event_oracle_test.cpp, catalog_test.cpp.
TEST(DebianDefinitions, are_those_we_bring) {
  std::vector<std::string> types = reference::types();
  types.insert(types.end(),
               {"dvs_msgs/Event", "dvs_msgs/EventArray", "event_camera_msgs/EventPacket",
                "gazebo_msgs/ContactState", "gazebo_msgs/ContactsState"});
  std::ranges::sort(types);
  EXPECT_EQ(Catalog::builtin(Dialect::ros1).names(), types);
}

}  // namespace
