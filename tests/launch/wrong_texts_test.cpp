// What is said of a .music file whose grammar or structure is wrong: by the functions that
// `spikeloop check` and `spikeloop run` call, in this process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/check.hpp"
#include "tests/launch/wrong_files.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace {

Diagnostic first_error_of(const std::string& path) {
  try {
    // The programs need not be there: they judge keys and files, on which no row depends.
    const Diagnostics diagnostics = launch::check_job(read_music_file(path), {}, false);
    return has_errors(diagnostics) ? first_error(diagnostics, path) : warning_at({}, "no error");
  } catch (const Error& error) {
    return diagnostic_of(error);
  }
}

class WrongTexts : public testing::TestWithParam<Wrong> {};

TEST_P(WrongTexts, AreExplainedInOneSentence) {
  const Wrong& wrong = GetParam();
  ASSERT_TRUE(wrong.options.empty());
  const TemporaryDirectory directory;
  write_files(wrong, directory);
  const Diagnostic found = first_error_of((directory.path() / "loop.music").string());
  EXPECT_EQ(found.exit_code, wrong.exit_code) << found.text();
  EXPECT_THAT(found.text(), Fault(std::string("... ") + wrong.words));
  EXPECT_EQ(found.text().find('\n'), std::string::npos) << found.text();
}

INSTANTIATE_TEST_SUITE_P(
    Grammar, WrongTexts,
    testing::Values(
        Wrong{"width is a word", {{"[3]", "[abc]"}}, "23:16: ... 'abc' ... [SL0307]"},
        Wrong{"width is negative", {{"[3]", "[-3]"}}, "23:16: ... '-3' ... [SL0307]"},
        Wrong{"width without bracket", {{"[3]", "[3"}}, "23:16: ... '[3]' ... [SL0101]"},
        Wrong{"two numbers", {{"[3]", "[3 4]"}}, "23:16: ... '3' ... '4' ... [SL0101]"},
        Wrong{"a fourth option", {{"[3]", "[3, point-to-point, tree, x]"}}, "23:34: ... [SL0101]"},
        Wrong{"width too large", {{"[3]", "[99999999999]"}}, "23:1: ... 99999999999 ... [SL0307]"},
        Wrong{"width of zero", {{"[3]", "[0]"}}, "23:1: ... 0 ... 1 ... [SL0307]"},
        Wrong{"unknown communication", {{"[3]", "[3, foo]"}}, "23:1: ... 'foo' ... [SL0205]"},
        Wrong{"unknown processing",
              {{"[3]", "[3, collective, foo]"}},
              "23:1: ... 'foo' ... [SL0205]"},
        Wrong{"label without bracket", {{"[e]", "[e"}}, "7:1: ... '[e]' ... [SL0101]"},
        Wrong{"text behind a label", {{"[e]", "[e] x"}}, "7:5: ... '[e]' ... [SL0101]"},
        Wrong{"quote never closed",
              {{"=FloatArray", "=\"Float"}},
              "6:14: ... 'message_type' ... [SL0101]"},
        Wrong{"line without =",
              {{"rate_max=200", "rate_max 200"}},
              "10:1: ... 'rate_max=200' ... [SL0101]"},
        Wrong{"key without name", {{"rate_max=200", "=200"}}, "10:1: ... '=' ... [SL0101]"},
        Wrong{"double arrow", {{"s.out -> e.in", "s.out => e.in"}}, "23:1: ... '->' ... [SL0101]"},
        Wrong{"two arrows",
              {{"s.out -> e.in", "s.out -> e.in -> n.in"}},
              "23:1: ... 'in -> n.in' ... [SL0101]"},
        Wrong{"no receiver",
              {{"s.out -> e.in [3]", "s.out -> [3]"}},
              "23:1: ... receiver ... 'A.out -> B.in [width]' ... [SL0101]"},
        Wrong{"connection at the top",
              {{"stoptime", "out -> e.in\nstoptime"}},
              "1:1: ... 'out' ... [SL0101]"},
        Wrong{"empty file", {{"", ""}}, "application ... '[label]' ... [SL0104]"},
        Wrong{"only comments", {{"", "# nothing\n"}}, "application ... '[label]' ... [SL0104]"},
        Wrong{"byte order mark",
              {{"stoptime", "\xEF\xBB\xBFstoptime"}},
              "1:1: ... UTF-8 byte order mark ... MUSIC ... [SL0101]"},
        Wrong{"UTF-16",
              {{"", std::string("\xFF\xFE[\0", 4)}},
              "1:1: ... UTF-16 ... UTF-8 ... [SL0101]"},
        Wrong{"binary file",
              {{"", std::string("\x7f"
                                "ELF\0\0",
                                6)}},
              "1:5: ... zero byte ... [SL0101]"},
        Wrong{"huge file",
              {{"stoptime", "#" + std::string(5'000'000, 'x') + "\nstoptime"}},
              "5 MB ... 4 MB ... [SL0203]"},
        Wrong{"huge key",
              {{"rate_max=200", "note=" + std::string(140'000, 'x')}},
              "7:1: ... 'e' ... 131072 ... [SL0203]"},
        Wrong{"key twice, strict",
              {{"stoptime=0.1", kStrict}, {"rate_max=200", "rate_max=2\nrate_max=3"}},
              "12:1: ... 'rate_max' ... [SL0102]"}),
    [](const auto& i) { return "row" + std::to_string(i.index); });

INSTANTIATE_TEST_SUITE_P(
    Structure, WrongTexts,
    testing::Values(
        Wrong{"unknown application",
              {{"-> e.in", "-> encoder.in"}},
              "23:1: ... 'encoder' ... [SL0301]"},
        Wrong{"connected to itself",
              {{"-> e.in", "-> s.in"}},
              "23:1: ... 's.out -> s.in' ... [SL0602]"},
        Wrong{"port in and out",
              {{"e.out -> n.in", "e.in -> n.in"}},
              "24:1: ... 'e.in' ... [SL0602]"},
        Wrong{"np missing", {{"[e]\nnp=1", "[e]"}}, "7:1: ... '[e]' ... np=1 ... [SL0104]"},
        Wrong{"np is a word",
              {{"[e]\nnp=1", "[e]\nnp=one"}},
              "8:1: ... '[e]' ... 'one' ... [SL0204]"},
        Wrong{"np is 0", {{"[e]\nnp=1", "[e]\nnp=0"}}, "8:1: ... '[e]' ... '0' ... [SL0204]"},
        Wrong{"binary missing",
              {{"binary=rate_encoder\n", ""}},
              "7:1: ... '[e]' ... binary=program ... [SL0104]"},
        Wrong{"binary empty", {{"binary=rate_encoder", "binary="}}, "9:1: ... '[e]' ... [SL0104]"},
        Wrong{"connection repeated",
              {{"s.out -> e.in [3]", "s.out -> e.in [3]\ns.out -> e.in [3]"}},
              "24:1: ... 's.out -> e.in' ... [SL0304]"},
        Wrong{"two senders",
              {{"d.out -> c.in", "s.out -> c.in [2]\nd.out -> c.in"}},
              "27:1: ... 'c.in' ... [SL0304]"},
        Wrong{"no connection", {{"d.out -> c.in [2]\n", ""}}, "19:1: ... 'c' ... [SL0305]"},
        Wrong{"spikes into a signal",
              {{"n.out -> d.in [3]\nd.out -> c.in [2]", "n.out -> c.in [3]\ne.out -> d.in [3]\n"}},
              "25:1: ... 'n.out' ... 'c.in' ... [SL0303]"},
        Wrong{"signal into spikes",
              {{"s.out -> e.in [3]\ne.out -> n.in [3]", "s.out -> n.in [3]\ns.out -> e.in [3]"}},
              "23:1: ... 's.out' ... 'n.in' ... [SL0303]"},
        Wrong{"two widths of an output",
              {{"n.out -> d.in [3]",
                "n.out -> d.in [3]\nn.out -> x.in [4]\n[x]\n"
                "np=1\nbinary=spikeloop-network\n"
                "network=net.yaml"}},
              "26:1: ... 'n.out' ... [SL0306]"},
        Wrong{"unequal ticks",
              {{"rate_max=200", "music_timestep=0.01"}},
              "10:1: ... 's' ... 1 ms ... [SL0602]"},
        Wrong{"two publishers at one address",
              {{"d.out -> c.in [2]",
                "d.out -> c.in [2]\nd.out -> x.in [2]\n[x]\nnp=1\nbinary=cont_zmq_adapter\n"
                "message_type=FloatArray\n"}},
              "28:1: ... 'c' ... 'x' ... tcp://127.0.0.1:5556 ... [SL0506]"},
        Wrong{"shorter than a tick",
              {{"stoptime=0.1", "stoptime=0.0001"}},
              "1:1: ... 1 ms ... [SL0203]"},
        Wrong{"unequal lengths, strict",
              {{"stoptime=0.1", kStrict}, {"rate_max=200", "stoptime=5"}},
              "11:1: ... 'e' ... 5 s ... 's' ... 100 ms ... [SL0602]"},
        Wrong{"barriers that differ",
              {{"rate_max=200", "barrier=false"}},
              "10:1: ... 's' ... 'e' ... [SL0602]"},
        Wrong{"loop of signals",
              {{"d.out -> c.in [2]",
                "d.out -> c.in [2]\n[x]\nnp=1\n"
                "binary=threshold_adapter\n[y]\nnp=1\nbinary="
                "threshold_adapter\nx.out -> y.in [1]\n"
                "y.out -> x.in [1]"}},
              "the cycle x -> y -> x ... 2 ms ..."}),
    [](const auto& i) { return "row" + std::to_string(i.index); });

}  // namespace
}  // namespace spikeloop::test
