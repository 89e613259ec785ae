// Our definitions and codec against Debian's generated ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>

#include "reference_messages.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/catalog.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/messages/message_writer.hpp"

namespace {

using namespace spikeloop::messages;

std::span<const std::byte> bytes_of(const std::vector<std::uint8_t>& bytes) {
  return std::as_bytes(std::span(bytes));
}

class Reference : public testing::TestWithParam<std::string> {};

TEST_P(Reference, md5_sums_are_equal) {
  EXPECT_EQ(Catalog::builtin().md5(GetParam()), reference::random_message(GetParam(), 1).md5);
}

TEST_P(Reference, definition_with_comments_gives_the_same_sum) {
  const reference::Message message = reference::random_message(GetParam(), 1);
  Catalog catalog;
  catalog.add_with_dependencies(GetParam(), message.definition);
  EXPECT_EQ(catalog.md5(GetParam()), message.md5);
}

TEST_P(Reference, our_full_text_parses_to_the_same_sum) {
  Catalog catalog;
  catalog.add_with_dependencies(GetParam(), Catalog::builtin().full_text(GetParam()));
  EXPECT_EQ(catalog.md5(GetParam()), reference::random_message(GetParam(), 1).md5);
}

TEST_P(Reference, reads_what_roscpp_wrote) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const reference::Message message = reference::random_message(GetParam(), seed);
    for (const auto& [path, numbers] : message.numbers) {
      const FieldReader reader(Catalog::builtin(), GetParam(), path);
      std::vector<double> read;
      EXPECT_EQ(reader.read(bytes_of(message.bytes), read), numbers.size());
      EXPECT_EQ(read, numbers) << path << ", seed " << seed;
    }
  }
}

TEST_P(Reference, writes_what_roscpp_writes) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    const reference::Message message = reference::random_message(GetParam(), seed);
    std::vector<std::string> paths;
    std::vector<FieldValue> values;
    for (const auto& [path, numbers] : message.numbers) {
      paths.push_back(path);
      values.push_back({numbers, {}});
    }
    for (const auto& [path, text] : message.texts) {
      paths.push_back(path);
      values.push_back({{}, text});
    }
    const MessageWriter writer(Catalog::builtin(), GetParam(), paths);
    std::vector<std::byte> written;
    writer.write(values, written);
    ASSERT_EQ(written.size(), message.bytes.size());
    EXPECT_TRUE(std::ranges::equal(written, bytes_of(message.bytes))) << "seed " << seed;
  }
}

// Every truncation and many bit flips: an error or numbers, never a read outside (under ASan).
TEST_P(Reference, damaged_bytes_never_lead_outside) {
  std::mt19937 engine(7);
  for (unsigned seed = 0; seed < 4; ++seed) {
    const reference::Message message = reference::random_message(GetParam(), seed);
    std::vector<FieldReader> readers;
    for (const auto& [path, numbers] : message.numbers) {
      readers.emplace_back(Catalog::builtin(), GetParam(), path);
    }
    const auto read_all = [&](const std::vector<std::uint8_t>& bytes) {
      // A copy of exactly this size: its end is the end of the allocation.
      const std::vector<std::uint8_t> exact(bytes);
      for (const FieldReader& reader : readers) {
        std::vector<double> numbers;
        try {
          reader.read(bytes_of(exact), numbers);
        } catch (const spikeloop::TransportError&) {
        }
        EXPECT_LE(numbers.size(), std::max<std::size_t>(bytes.size(), 1));
      }
    };
    for (std::size_t size = 0; size < message.bytes.size(); ++size) {
      read_all({message.bytes.begin(), message.bytes.begin() + static_cast<std::ptrdiff_t>(size)});
    }
    for (int i = 0; i < 300 && !message.bytes.empty(); ++i) {
      std::vector<std::uint8_t> damaged = message.bytes;
      for (int flips = 0; flips < 3; ++flips) {
        damaged[engine() % damaged.size()] ^= static_cast<std::uint8_t>(1u << (engine() % 8));
      }
      read_all(damaged);
    }
  }
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Debian, Reference, testing::ValuesIn(reference::types()), test_name);

// Debian has no dvs_msgs: event_oracle_test.cpp.
TEST(Reference, covers_every_definition_we_bring) {
  std::vector<std::string> types = reference::types();
  types.insert(types.end(), {"dvs_msgs/Event", "dvs_msgs/EventArray"});
  std::ranges::sort(types);
  EXPECT_EQ(Catalog::builtin().names(), types);
}

}  // namespace
