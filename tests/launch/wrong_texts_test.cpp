// What is said of a .music file whose grammar or structure is wrong: by the functions that
// `spikeloop check` and `spikeloop run` call, in this process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/check.hpp"
#include "tests/launch/wrong_files.hpp"

namespace spikeloop::test {
namespace {

using testing::HasSubstr;

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
  EXPECT_THAT(found.text(), HasSubstr(wrong.words));
  EXPECT_EQ(found.text().find('\n'), std::string::npos) << found.text();
}

INSTANTIATE_TEST_SUITE_P(
    Grammar, WrongTexts,
    testing::Values(
        Wrong{"width is a word",
              {{"[3]", "[abc]"}},
              "loop.music:23:16: the width 'abc' is not a whole number"},
        Wrong{"width is negative", {{"[3]", "[-3]"}}, "the width '-3' is not a whole number"},
        Wrong{"width without bracket", {{"[3]", "[3"}}, "the width '[3' has no ']'; write '[3]'"},
        Wrong{"two numbers", {{"[3]", "[3 4]"}}, "two numbers in a width"},
        Wrong{"a fourth option", {{"[3]", "[3, point-to-point, tree, x]"}}, "a fourth option"},
        Wrong{"width too large", {{"[3]", "[99999999999]"}}, "the width 99999999999 is too large"},
        Wrong{"width of zero", {{"[3]", "[0]"}}, "has width 0; write at least 1"},
        Wrong{"unknown communication", {{"[3]", "[3, foo]"}}, "unknown communication 'foo'"},
        Wrong{"unknown processing", {{"[3]", "[3, collective, foo]"}}, "unknown processing 'foo'"},
        Wrong{"label without bracket", {{"[e]", "[e"}}, "the section '[e' has no ']'; write '[e]'"},
        Wrong{"text behind a label", {{"[e]", "[e] x"}}, "text after the section '[e]'"},
        Wrong{"quote never closed", {{"=FloatArray", "=\"Float"}}, "is never closed"},
        Wrong{"line without =", {{"rate_max=200", "rate_max 200"}}, "loop.music:10:1"},
        Wrong{"key without name", {{"rate_max=200", "=200"}}, "no key before '='"},
        Wrong{"double arrow", {{"s.out -> e.in", "s.out => e.in"}}, "write a connection with '->'"},
        Wrong{"two arrows", {{"s.out -> e.in", "s.out -> e.in -> n.in"}}, "a second arrow"},
        Wrong{"no receiver", {{"s.out -> e.in [3]", "s.out -> [3]"}}, "has no receiver port"},
        Wrong{"connection at the top",
              {{"stoptime", "out -> e.in\nstoptime"}},
              "application of port"},
        Wrong{"empty file", {{"", ""}}, "the file has no application"},
        Wrong{"only comments", {{"", "# nothing\n"}}, "the file has no application"},
        Wrong{"byte order mark", {{"stoptime", "\xEF\xBB\xBFstoptime"}}, "byte order mark"},
        Wrong{"UTF-16", {{"", std::string("\xFF\xFE[\0", 4)}}, "the file is UTF-16 text"},
        Wrong{"binary file",
              {{"", std::string("\x7f"
                                "ELF\0\0",
                                6)}},
              "this is not a text file"},
        Wrong{"huge file",
              {{"stoptime", "#" + std::string(5'000'000, 'x') + "\nstoptime"}},
              "more than the 4 MB that a .music file may have"},
        Wrong{"huge key",
              {{"rate_max=200", "note=" + std::string(140'000, 'x')}},
              "in one environment string"},
        Wrong{"key twice, strict",
              {{"stoptime=0.1", kStrict}, {"rate_max=200", "rate_max=2\nrate_max=3"}},
              "duplicate key 'rate_max'; the first is at"}),
    [](const auto& i) { return "row" + std::to_string(i.index); });

INSTANTIATE_TEST_SUITE_P(
    Structure, WrongTexts,
    testing::Values(
        Wrong{"unknown application", {{"-> e.in", "-> encoder.in"}}, "unknown node 'encoder'"},
        Wrong{"connected to itself", {{"-> e.in", "-> s.in"}}, "joins an application to itself"},
        Wrong{"port in and out",
              {{"e.out -> n.in", "e.in -> n.in"}},
              "is both an output and an input"},
        Wrong{"np missing", {{"[e]\nnp=1", "[e]"}}, "the section '[e]' has no np"},
        Wrong{"np is a word", {{"[e]\nnp=1", "[e]\nnp=one"}}, "np of '[e]' is 'one'"},
        Wrong{"np is 0", {{"[e]\nnp=1", "[e]\nnp=0"}}, "np of '[e]' is '0'"},
        Wrong{"binary missing", {{"binary=rate_encoder\n", ""}}, "the section '[e]' has no binary"},
        Wrong{"binary empty", {{"binary=rate_encoder", "binary="}}, "binary of '[e]' is empty"},
        Wrong{"connection repeated",
              {{"s.out -> e.in [3]", "s.out -> e.in [3]\ns.out -> e.in [3]"}},
              "the connection 's.out -> e.in' is written twice"},
        Wrong{"two senders",
              {{"d.out -> c.in", "s.out -> c.in [2]\nd.out -> c.in"}},
              "input 'c.in' has two senders"},
        Wrong{"no connection",
              {{"d.out -> c.in [2]\n", ""}},
              "has no connection, and MUSIC would hang"},
        Wrong{"spikes into a signal",
              {{"n.out -> d.in [3]\nd.out -> c.in [2]", "n.out -> c.in [3]\ne.out -> d.in [3]\n"}},
              "spike output 'n.out' cannot drive continuous input 'c.in'"},
        Wrong{"signal into spikes",
              {{"s.out -> e.in [3]\ne.out -> n.in [3]", "s.out -> n.in [3]\ns.out -> e.in [3]"}},
              "continuous output 's.out' cannot drive spike input 'n.in'"},
        Wrong{"two widths of an output",
              {{"n.out -> d.in [3]",
                "n.out -> d.in [3]\nn.out -> x.in [4]\n[x]\n"
                "np=1\nbinary=spikeloop-network\n"
                "network=net.yaml"}},
              "has another width in line"},
        Wrong{
            "unequal ticks", {{"rate_max=200", "music_timestep=0.01"}}, "but that of 's' is 1 ms"},
        Wrong{"two publishers at one address",
              {{"d.out -> c.in [2]",
                "d.out -> c.in [2]\nd.out -> x.in [2]\n[x]\nnp=1\nbinary=cont_zmq_adapter\n"
                "message_type=FloatArray\n"}},
              "'c' and 'x' both publish at tcp://127.0.0.1:5556"},
        Wrong{"shorter than a tick",
              {{"stoptime=0.1", "stoptime=0.0001"}},
              "less than its tick of 1 ms"},
        Wrong{"unequal lengths, strict",
              {{"stoptime=0.1", kStrict}, {"rate_max=200", "stoptime=5"}},
              "'e' runs for 5 s, but 's' for 100 ms"},
        Wrong{"barriers that differ", {{"rate_max=200", "barrier=false"}}, "the job would hang"},
        Wrong{"loop of signals",
              {{"d.out -> c.in [2]",
                "d.out -> c.in [2]\n[x]\nnp=1\n"
                "binary=threshold_adapter\n[y]\nnp=1\nbinary="
                "threshold_adapter\nx.out -> y.in [1]\n"
                "y.out -> x.in [1]"}},
              "the cycle x -> y -> x lacks 2 ms of acceptable latency"}),
    [](const auto& i) { return "row" + std::to_string(i.index); });

}  // namespace
}  // namespace spikeloop::test
