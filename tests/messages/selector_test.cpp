// Elements that are chosen by a text, and payloads that are read where they stand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/core/error.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/messages/message_writer.hpp"
#include "spikeloop/messages/sensor_conversion.hpp"
#include "tests/support/error_of.hpp"

namespace selector_test {
namespace {

using spikeloop::test::Fault;
using namespace spikeloop::messages;
using spikeloop::test::error_of;
using testing::ElementsAre;

using Bytes = std::vector<std::byte>;

/// A message of one number or text a path.
struct Field {
  const char* path;
  std::vector<double> numbers{};
  const char* text = "";
};

Bytes message(const Catalog& catalog, std::string_view type, const std::vector<Field>& fields) {
  std::vector<std::string> paths;
  std::vector<FieldValue> values;
  for (const Field& field : fields) {
    paths.emplace_back(field.path);
    values.push_back({field.numbers, field.text});
  }
  Bytes bytes;
  MessageWriter(catalog, type, paths).write(values, bytes);
  return bytes;
}

std::vector<double> read(const Catalog& catalog, std::string_view type, std::string_view path,
                         const Bytes& bytes) {
  std::vector<double> numbers;
  FieldReader(catalog, type, path).read(bytes, numbers);
  return numbers;
}

std::vector<std::string_view> texts(const Catalog& catalog, std::string_view type,
                                    std::string_view path, const Bytes& bytes) {
  std::vector<std::string_view> found;
  TextField(catalog, type, path).read(bytes, found);
  return found;
}

class Selectors : public testing::TestWithParam<Dialect> {
 protected:
  const Catalog& catalog() const { return Catalog::builtin(GetParam()); }
};

TEST_P(Selectors, read_the_element_beside_the_text) {
  const Bytes state = message(catalog(), "sensor_msgs/JointState",
                              {{"name[0]", {}, "left"},
                               {"name[1]", {}, "right"},
                               {"name[2]", {}, "a.b/c"},
                               {"position", {1, 2, 3}},
                               {"velocity", {4}}});
  const auto at = [&](const char* path) {
    return read(catalog(), "sensor_msgs/JointState", path, state);
  };
  EXPECT_THAT(at("position[name=left]"), ElementsAre(1));
  EXPECT_THAT(at("position[name=right]"), ElementsAre(2));
  EXPECT_THAT(at("position[name=a.b/c]"), ElementsAre(3));
  EXPECT_THAT(at("position[name=middle]"), ElementsAre());
  EXPECT_THAT(at("velocity[name=left]"), ElementsAre(4));
  EXPECT_THAT(at("velocity[name=right]"), ElementsAre());
  EXPECT_EQ(compile_path(catalog(), "sensor_msgs/JointState", "position[name=left]").width(), 1u);
}

TEST_P(Selectors, read_the_element_with_the_text) {
  const Bytes tree = message(catalog(), "tf2_msgs/TFMessage",
                             {{"transforms[0].child_frame_id", {}, "base"},
                              {"transforms[1].child_frame_id", {}, "arm"},
                              {"transforms[0].header.frame_id", {}, "odom"},
                              {"transforms[1].header.frame_id", {}, "base"},
                              {"transforms[0].transform.translation.x", {7}},
                              {"transforms[1].transform.translation.x", {8}},
                              {"transforms[2].transform.translation.x", {9}}});
  const auto at = [&](const char* path) {
    return read(catalog(), "tf2_msgs/TFMessage", path, tree);
  };
  EXPECT_THAT(at("transforms[child_frame_id=base].transform.translation.x"), ElementsAre(7));
  EXPECT_THAT(at("transforms[child_frame_id=arm].transform.translation.x"), ElementsAre(8));
  EXPECT_THAT(at("transforms[child_frame_id=hand].transform.translation.x"), ElementsAre());
  EXPECT_THAT(texts(catalog(), "tf2_msgs/TFMessage",
                    "transforms[child_frame_id=arm].header.frame_id", tree),
              ElementsAre("base"));
}

TEST_P(Selectors, write_texts_and_elements) {
  const Bytes command = message(catalog(), "sensor_msgs/JointState",
                                {{"velocity[name=right]", {1.5}},
                                 {"velocity[name=left]", {2.5}},
                                 {"position[name=left]", {3.5}}});
  const auto at = [&](const char* path) {
    return read(catalog(), "sensor_msgs/JointState", path, command);
  };
  EXPECT_THAT(texts(catalog(), "sensor_msgs/JointState", "name", command),
              ElementsAre("right", "left"));
  EXPECT_THAT(at("velocity"), ElementsAre(1.5, 2.5));
  EXPECT_THAT(at("position"), ElementsAre(testing::IsNan(), 3.5));
  EXPECT_THAT(at("effort"), ElementsAre());
  const Bytes tree = message(catalog(), "tf2_msgs/TFMessage",
                             {{"transforms[child_frame_id=b].transform.translation.x", {1}},
                              {"transforms[child_frame_id=a].transform.translation.y", {2}},
                              {"transforms[child_frame_id=b].transform.translation.y", {3}}});
  EXPECT_THAT(texts(catalog(), "tf2_msgs/TFMessage", "transforms.child_frame_id", tree),
              ElementsAre("b", "a"));
  EXPECT_THAT(read(catalog(), "tf2_msgs/TFMessage", "transforms.transform.translation.y", tree),
              ElementsAre(3, 2));
}

TEST_P(Selectors, channels_keep_their_values_when_a_name_is_missing) {
  SensorConversion conversion(catalog(), "JointState",
                              plain_fields({"position[name=left]", "position[name=right]"}), 2,
                              true);
  EXPECT_TRUE(conversion.convert(message(
      catalog(), "JointState", {{"position[name=right]", {2}}, {"position[name=left]", {1}}})));
  EXPECT_THAT(conversion.channels(), ElementsAre(1, 2));
  EXPECT_TRUE(
      conversion.convert(message(catalog(), "JointState", {{"position[name=right]", {5}}})));
  EXPECT_THAT(conversion.channels(), ElementsAre(1, 5));
  EXPECT_FALSE(conversion.convert(message(catalog(), "JointState", {{"position[name=up]", {6}}})));
  EXPECT_THAT(conversion.channels(), ElementsAre(1, 5));
}

TEST_P(Selectors, errors_say_what_to_write) {
  const auto path_error = [&](const char* type, const char* path) {
    return error_of([&] { compile_path(catalog(), type, path); });
  };
  EXPECT_EQ(path_error("sensor_msgs/JointState", "position[nme=left]"),
            "field path 'position[nme=left]' of sensor_msgs/JointState: 'nme' is neither a text in "
            "each element of 'position' nor an array of texts beside it, so [nme=left] selects "
            "nothing [SL0504]");
  EXPECT_THAT(path_error("sensor_msgs/JointState", "position[velocity=left]"),
              Fault("field path 'position[velocity=left]' of sensor_msgs/JointState: 'velocity' "
                    "... 'position' ... so [velocity=left] selects nothing ... [SL0504]"));
  for (const char* path : {"position[=left]", "position[name=]", "position[name=left"}) {
    EXPECT_THAT(
        path_error("sensor_msgs/JointState", path),
        testing::HasSubstr("selects nothing; write [index], [first:end] or [name=text] [SL0504]"));
  }
  const auto write_error = [&](std::string_view type, const std::vector<std::string>& paths) {
    return error_of([&] { MessageWriter(catalog(), type, paths); });
  };
  EXPECT_THAT(write_error("sensor_msgs/JointState", {"position[name=left]", "position"}),
              Fault("field paths 'position[name=left]' and 'position' of sensor_msgs/JointState "
                    "... [SL0504]"));
  EXPECT_THAT(write_error("sensor_msgs/JointState", {"name[0]", "position[name=left]"}),
              Fault("field paths 'name[0]' and 'position[name=left]' of sensor_msgs/JointState ... "
                    "[SL0504]"));
  Catalog own = catalog();
  own.add("my_msgs/Pair", "string[2] name\nfloat64[2] value\n");
  EXPECT_EQ(
      error_of([&] {
        MessageWriter(own, "my_msgs/Pair", {"value[name=a]", "value[name=b]", "value[name=c]"});
      }),
      "field path 'value[name=c]' of my_msgs/Pair: 'value' has 2 elements, and so many have "
      "names already [SL0504]");
}

TEST_P(Selectors, damaged_texts_lead_nowhere) {
  const Bytes state = message(catalog(), "sensor_msgs/JointState",
                              {{"position[name=left]", {1}}, {"position[name=right]", {2}}});
  const FieldReader reader(catalog(), "sensor_msgs/JointState", "position[name=right]");
  for (std::size_t size = 0; size < state.size(); ++size) {
    const Bytes cut(state.begin(), state.begin() + static_cast<std::ptrdiff_t>(size));
    std::vector<double> numbers;
    try {
      reader.read(cut, numbers);
      EXPECT_THAT(numbers, ElementsAre(2)) << size;
    } catch (const spikeloop::TransportError&) {
      EXPECT_TRUE(numbers.empty());
    }
  }
}

TEST_P(Selectors, texts_are_not_numbers) {
  EXPECT_EQ(error_of([&] { TextField(catalog(), "sensor_msgs/Image", "height"); }),
            "field path 'height' of sensor_msgs/Image: a number is not text; name a field of type "
            "string [SL0504]");
}

INSTANTIATE_TEST_SUITE_P(Ros, Selectors, testing::Values(Dialect::ros1, Dialect::ros2),
                         [](const auto& each) {
                           return std::to_string(each.param == Dialect::ros1 ? 1 : 2);
                         });

}  // namespace
}  // namespace selector_test
