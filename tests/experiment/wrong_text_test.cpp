// Experiment files that are wrong, and every word that is said about them. What is not an
// experiment at all.
#include "tests/experiment/wrong_file.hpp"

namespace spikeloop::test {
namespace {

class WrongText : public testing::TestWithParam<WrongFile> {};

TEST_P(WrongText, AreExplained) {
  expect_faults(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Table, WrongText,
    testing::Values(
        WrongFile{"no YAML",
                  {{"", "nodes: {a: [1, 2}\n"}},
                  {"x.yaml:1:17: this is not YAML: illegal flow end; look for a bracket, a quote "
                   "or an indentation that does not match [SL0101]"}},
        WrongFile{"tab for blanks",
                  {{"  scan:", "\tscan:"}},
                  {"x.yaml:6:6: this is not YAML: illegal map value; this line begins with a tab, "
                   "write blanks [SL0101]"}},
        WrongFile{"empty file",
                  {{"", ""}},
                  {"x.yaml: there is no experiment in this file; 'spikeloop new' prints one to "
                   "begin with [SL0105]"}},
        WrongFile{
            "only comments", {{"", "# nothing\n"}}, {"x.yaml: ... 'spikeloop new' ... [SL0105]"}},
        WrongFile{"a list",
                  {{"", "- a\n- b\n"}},
                  {"x.yaml:1:1: this is not an experiment: expected lines of  key: value; "
                   "'spikeloop new' ... [SL0105]"}},
        WrongFile{"a word",
                  {{"", "hello\n"}},
                  {"x.yaml:1:1: ... key: value; 'spikeloop new' ... [SL0105]"}},
        WrongFile{"second document",
                  {{"tick: 1 ms", "---\ntick: 1 ms"}},
                  {"x.yaml:4:1: a second document begins; write one experiment a file, without "
                   "'---' inside it [SL0101]"}},
        WrongFile{
            "binary bytes",
            {{"", std::string("\177ELF\002\001\000\000\000", 9)}},
            {"x.yaml:1:7: the byte 0x00 is not UTF-8 text; save the file as UTF-8 ('spikeloop "
             "new' prints an experiment to begin with) [SL0101]"}},
        WrongFile{"not UTF-8",
                  {{"", "\377\376\200\201: \220"}},
                  {"x.yaml:1:1: the byte 0xFF is not UTF-8 text ... UTF-8 ('spikeloop new' ... ) "
                   "... [SL0101]"}},
        WrongFile{"Latin-1",
                  {{"experiment: table", "experiment: caf\351"}},
                  {"x.yaml:1:16: the byte 0xE9 is not UTF-8 text ... UTF-8 ('spikeloop new' ... ) "
                   "... [SL0101]"}},
        WrongFile{"surrogate in a list",
                  {{"weights: w.json", "weights: [[\"\\uD800\"]]"}},
                  {"x.yaml:9:65: ... YAML: invalid unicode: 55296 ... [SL0101]"}},
        WrongFile{"comma first",
                  {{"", " , a: b\n"}},
                  {"x.yaml:1:2: this is not YAML: nothing can begin like this; write  key: value "
                   "[SL0101]"}},
        WrongFile{
            "text behind a map",
            {{"", "{nodes: {}, connections: []} x\n"}},
            {"x.yaml:1:30: ... write one experiment a file, without '---' inside it ... [SL0101]"}},
        WrongFile{"deep nesting",
                  {{"weights: w.json", "weights: " + nested(40)}},
                  {"x.yaml:9:89: there are more than 4000000 values or 32 levels here; write them "
                   "into a file [SL0203]"}},
        WrongFile{"deep nesting that is never closed",
                  {{"", "nodes: " + repeated("[", 3000)}},
                  {"x.yaml:1:1008: this is not YAML: it is nested too deeply; close its brackets "
                   "[SL0101]"}},
        WrongFile{"deep nesting of blocks",
                  {{"", "a: " + repeated("{a: ", 30000) + repeated("}", 30000)}},
                  {"x.yaml:1:4004: ... YAML: ... nested too deeply ... [SL0101]"}},
        WrongFile{
            "brackets in brackets",
            {{"connections:\n  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
              "connections: [scan -> encoder [3] -> brain [3]]\n"}},
            {"x.yaml:11:31: this is not YAML: end of sequence flow not found; put quotes round a "
             "connection that stands in brackets [SL0101]"}},
        WrongFile{
            "alias bomb",
            {{"tick: 1 ms\n", "plugins: " + bomb() + "\n"}},
            {"x.yaml:3:219: this is not YAML: its aliases (*name) stand for more than 4000000 "
             "values; write the values themselves, or into a file [SL0101]"}},
        WrongFile{"alias bomb in a node",
                  {{"weights: w.json", "weights: " + bomb()}},
                  {"x.yaml:9:265: ... YAML: its aliases (*name) ... 4000000 values ... [SL0101]"}},
        WrongFile{"maps that are merged",
                  {{"nodes:\n", "nodes:\n  a: &a {node: sigmoid}\n  b: {<<: *a, slope: 2}\n"}},
                  {"x.yaml:7:7: node 'b': '<<' is not read; write the other map's keys "
                   "themselves [SL0105]"}},
        WrongFile{"alias of itself",
                  {{"weights: w.json", "weights: &a [*a]"}},
                  {"x.yaml:9:56: ... 4000000 values or 32 levels here ... [SL0203]"}}),
    [](const auto& row) { return "row" + std::to_string(row.index); });

}  // namespace
}  // namespace spikeloop::test
