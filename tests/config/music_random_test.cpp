// Random files: what is written can be read back, and nothing makes the parser crash or hang.
#include <gtest/gtest.h>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/config/order.hpp"
#include "tests/config/helpers.hpp"
#include "tests/support/repetitions.hpp"

namespace spikeloop {
namespace {

using test::Fault;
using test::message_of;

TEST(MusicText, RandomFilesComeBackEqual) {
  int written = 0;
  for (unsigned seed = 0; seed < 2000; ++seed) {
    const MusicFile file = test::RandomMusicFile(seed).make();
    std::string text;
    try {
      text = to_text(file);
    } catch (const ConfigurationError&) {
      continue;  // labels and ports that no file can join; the last test here looks at the message
    }
    ++written;
    ASSERT_EQ(parse_music(text, "f"), file) << seed << "\n" << text;
  }
  EXPECT_GT(written, 1400);
}

TEST(MusicText, ExamplesComeBackEqual) {
  for (const auto& name : test::music_examples()) {
    const MusicFile file = read_music_file(test::data_path_of(name));
    EXPECT_EQ(parse_music(to_text(file), "f"), file);
  }
}

TEST(MusicText, IsPlainWherePossible) {
  const MusicFile file =
      parse_music("g=1\n[A]\nargs=\"a b\"\nx=\"a#b\"\n[B]\nA.o->B.i[3,,table]\nA.p->B.j\n", "f");
  EXPECT_EQ(to_text(file),
            "g=1\n\n[A]\nargs=a b\nx=\"a#b\"\n\n[B]\n\nA.o -> B.i [3, point-to-point, table]\n"
            "A.p -> B.j\n");
}

TEST(MusicText, LabelsWithDotsAreLeftOutInTheirSection) {
  const std::string text = "[a.b]\n\n[c]\n\n[a.b]\n.out -> c.in [1]\n";
  EXPECT_EQ(to_text(parse_music("[a.b]\nout->c.in[1]\n[c]", "f")), text);
  EXPECT_EQ(to_text(parse_music(text, "f")), text);
}

TEST(MusicText, RefusesWhatNoFileCanSay) {
  MusicFile file;
  file.sections = {{"a.b", {}, {}}, {"c.d", {}, {}}};
  file.connections.resize(1);
  file.connections[0].from_app = "a.b";
  file.connections[0].from_port = "out";
  file.connections[0].to_app = "c.d";
  file.connections[0].to_port = "in";
  EXPECT_EQ(message_of([&] { to_text(file); }),
            "the connection 'a.b.out -> c.d.in' cannot be written in a .music file; use labels and "
            "ports of letters, digits and '_' [SL0106]");
  file.connections.clear();
  file.sections[0].label = "a\n";
  EXPECT_THAT(message_of([&] { to_text(file); }),
              Fault("the label 'a ' ... .music file; use a name without line ends and without "
                    "blanks at its end ... [SL0106]"));
  file.sections[0].label = "a:b";
  EXPECT_THAT(message_of([&] { to_text(file); }),
              Fault("the label 'a:b' contains ':', which MUSIC loses on the way to the program; "
                    "write letters, digits and '_' [SL0106]"));
  file.sections.clear();
  file.globals = {{"k", std::string("a\0", 2), {}}};
  EXPECT_EQ(
      message_of([&] { to_text(file); }),
      "the value of 'k' contains a zero byte, which no .music file can hold; remove it [SL0101]");
}

/// Changes a text as a fuzzer does: bytes flipped, pieces copied, cut, and swapped for tokens.
std::string mutate(std::string text, test::RandomMusicFile& random) {
  const std::vector<std::string> tokens = {
      "[",   "]",  "->", "<-", "=",  "\\",   "\"",           "#",
      "\n",  "\r", "\f", ".",  ",",  " ",    "[]",           "1",
      "999", "\t", "np", "\v", "A.", "\xFF", "\xEF\xBB\xBF", std::string(1, '\0')};
  for (std::size_t i = 0; i < 1 + random.below(6); ++i) {
    const std::size_t at = random.below(text.size() + 1);
    const std::size_t length = random.below(std::min<std::size_t>(30, text.size() - at) + 1);
    switch (random.below(4)) {
      case 0:
        text.insert(at, tokens[random.below(tokens.size())]);
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(random.below(text.size() + 1), text.substr(at, length));
        break;
      default:
        if (at < text.size()) {
          text[at] = static_cast<char>(random.below(256));
        }
    }
  }
  return text;
}

TEST(MusicParser, MutatedFilesAreReadOrRefused) {
  std::vector<std::string> texts;
  for (const auto& name : test::music_examples()) {
    texts.push_back(test::data_text(name));
  }
  test::RandomMusicFile random(20161);
  int read = 0;
  for (int i = 0; i < test::repetitions(5000); ++i) {
    const std::string text = mutate(texts[static_cast<std::size_t>(i) % texts.size()], random);
    MusicFile file;
    try {
      file = parse_music(text, "f");
    } catch (const ConfigurationError& error) {
      ASSERT_EQ(std::string(error.what()).substr(0, 2), "f:") << text;
      continue;
    }
    ++read;
    ASSERT_EQ(parse_music(to_text(file), "f"), file) << text << "\n---\n" << to_text(file);
    structure_diagnostics(file);
    ASSERT_EQ(downstream_first(file).size(), file.sections.size());
  }
  EXPECT_GT(read, test::repetitions(5000) / 10);
}

}  // namespace
}  // namespace spikeloop
