// Experiment files that are wrong, and every word that is said about them. Connections, widths,
// delays.
#include "tests/experiment/wrong_file.hpp"

namespace spikeloop::test {
namespace {

class WrongConnections : public testing::TestWithParam<WrongFile> {};

TEST_P(WrongConnections, AreExplained) {
  expect_faults(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Table, WrongConnections,
    testing::Values(
        WrongFile{"wrong port in the middle of a line",
                  {{"-> brain [3]", "-> brain.spikes [3]"}},
                  {"x.yaml:12:28: 'brain' has no input port 'spikes'; known: in [SL0302]"}},
        WrongFile{"wrong port at the begin of a line",
                  {{"scan ->", "scan.ranges ->"}},
                  {"x.yaml:12:5: 'scan' has no output port 'ranges'; known: out [SL0302]"}},
        WrongFile{"unknown node",
                  {{"-> encoder", "-> encodr"}},
                  {"x.yaml:12:13: unknown node 'encodr'; did you mean 'encoder'? [SL0301]"}},
        WrongFile{"unknown port",
                  {{"-> encoder [3]", "-> encoder.inn [3]"}},
                  {"x.yaml:12:13: 'encoder' ... 'inn' ... 'in' ... [SL0302]"}},
        WrongFile{"wrong direction",
                  {{"-> encoder [3] ->", "-> encoder.out [3] ->"}},
                  {"x.yaml:12:13: 'encoder' ... 'out' ... in ... [SL0302]"}},
        WrongFile{
            "source as a target",
            {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
              "  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n  - decoder -> "
              "scan\n"}},
            {"x.yaml:13:16: 'scan' ... turn the connection round or leave it out ... [SL0302]"}},
        WrongFile{
            "sink as a source",
            {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
              "  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n  - wheels -> "
              "encoder\n"}},
            {"x.yaml:13:5: 'wheels' has no output port ... [SL0302]",
             "x.yaml:13:15: input 'encoder.in' has two senders, 'scan.out' and 'wheels'; remove "
             "one connection [SL0304]"}},
        WrongFile{
            "output that leads nowhere",
            {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
              "  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n  - scan -> "
              "extra\n"},
             {"  encoder: {node: rate_encoder, rate_max: 200 Hz}\n",
              "  encoder: {node: rate_encoder, rate_max: 200 Hz}\n  extra: {node: nef_encoder}\n"}},
            {"x.yaml:8:3: nothing is connected to the output 'extra.out', and nothing else says "
             "how wide it is; connect it, or leave the node out [SL0305]"}},
        WrongFile{"two connections into one input",
                  {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
                    "  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n  - scan "
                    "-> encoder\n"}},
                  {"x.yaml:13:13: the connection 'scan.out -> encoder.in' is written twice; remove "
                   "one [SL0304]"}},
        WrongFile{"unconnected node",
                  {{"  encoder: {node: rate_encoder, rate_max: 200 Hz}\n",
                    "  encoder: {node: rate_encoder, rate_max: 200 Hz}\n  extra: {node: "
                    "rate_encoder}\n"}},
                  {"x.yaml:8:3: node 'extra' is not connected; write it into 'connections' ... "
                   "[SL0305]"}},
        WrongFile{
            "unconnected input",
            {{"scan -> encoder [3]", "encoder"}},
            {"x.yaml:7:3: input 'encoder.in' is not connected; write for example  SENDER.out -> "
             "encoder.in [10] [SL0305]"}},
        WrongFile{"kinds that differ",
                  {{"decoder [3] -> wheels [2]", "decoder [3]\n  - brain -> wheels"}},
                  {"x.yaml:13:14: spike output 'brain.out' cannot drive continuous input "
                   "'wheels.in'; put a decoder between them [SL0303]"}},
        WrongFile{"continuous to spikes",
                  {{"scan -> encoder [3] ->", "scan ->"}},
                  {"x.yaml:7:3: node 'encoder' ... 'connections' ... [SL0305]",
                   "x.yaml:12:13: continuous output 'scan.out' cannot drive spike input "
                   "'brain.in'; put an encoder between them [SL0303]"}},
        WrongFile{"tables that disagree",
                  {{"encoder [3] -> brain [3] -> decoder [3] -> wheels [2]",
                    "a -> b -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]"},
                   {"nodes:\n",
                    "nodes:\n  a: {node: connect, weights: [[1, 1], [1, 1]]}\n"
                    "  b: {node: connect, weights: w.json}\n"}},
                  {"x.yaml:14:18: widths differ: 'a.out' has 2 channels, 'b.in' has 3 [SL0306]"}},
        WrongFile{"widths that differ",
                  {{"brain [3] -> decoder [3]", "brain [3] -> decoder [5]"}},
                  {"x.yaml:12:41: widths differ: 'brain.out' has 3 channels, 'decoder.in' has 5, "
                   "the connection says [5] [SL0306]"}},
        WrongFile{"two widths of one output",
                  {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
                    "  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n  - scan "
                    "-> other [4]\n"},
                   {"  encoder: {node: rate_encoder, rate_max: 200 Hz}\n",
                    "  encoder: {node: rate_encoder, rate_max: 200 Hz}\n  other: {node: "
                    "rate_encoder}\n"}},
                  {"x.yaml:14:13: widths differ: 'scan.out' has 3 channels, 'other.in' has 4, the "
                   "connection says [4] [SL0306]"}},
        WrongFile{
            "unknown width",
            {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
              "  - scan -> mix -> wheels [2]\n"},
             {"  encoder: {node: rate_encoder, rate_max: 200 Hz}\n  brain: {simulator: builtin, "
              "network: net.yaml}\n  decoder: {node: linear_readout, tau: 30 ms, weights: "
              "w.json}\n",
              "  mix: {node: connect, weights: uniform}\n"}},
            {"x.yaml:10:13: the width of 'scan.out' -> 'mix.in' is unknown; write the number of "
             "channels, for example [10] "
             "[SL0307]"}},
        WrongFile{"cycle without delay",
                  {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
                    "  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n  - a -> b "
                    "[2] -> c [2] -> a [2]\n"},
                   {"  encoder: {node: rate_encoder, rate_max: 200 Hz}\n",
                    "  encoder: {node: rate_encoder, rate_max: 200 Hz}\n  a: {node: sigmoid}\n  b: "
                    "{node: sigmoid}\n  c: {node: sigmoid}\n"}},
                  {"x.yaml:16:10: the cycle a -> b -> c -> a has no delay; give one of its "
                   "connections a delay of at least 1 tick [SL0310]"}},
        WrongFile{"to itself without delay",
                  {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
                    "  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n  - a -> a "
                    "[2]\n"},
                   {"  encoder: {node: rate_encoder, rate_max: 200 Hz}\n",
                    "  encoder: {node: rate_encoder, rate_max: 200 Hz}\n  a: {node: sigmoid}\n"}},
                  {"x.yaml:14:10: the cycle a -> a has no delay ... 1 tick ... [SL0310]"}},
        WrongFile{"delay no multiple of the tick",
                  {{"encoder [3]", "encoder [3, delay 1.5 ms]"}},
                  {"x.yaml:12:31: delay '1.5 ms' is not a whole number of ticks from 0 to 1000000 "
                   "... 1 ms ... [SL0310]"}},
        WrongFile{"delay without unit",
                  {{"encoder [3]", "encoder [3, delay 5]"}},
                  {"x.yaml:12:31: delay '5' has no unit; write 5 ms or 5 ticks [SL0310]"}},
        WrongFile{
            "delay without a time",
            {{"encoder [3]", "encoder [3, delay]"}},
            {"x.yaml:12:25: 'delay' is not a delay; write for example  delay 5 ms  or  delay 2 "
             "ticks [SL0310]"}},
        WrongFile{
            "another word than delay",
            {{"encoder [3]", "encoder [3, delays 2 ticks]"}},
            {"x.yaml:12:25: 'delays 2 ticks' ... delay 5 ms  or  delay 2 ticks ... [SL0310]"}},
        WrongFile{"delay of another unit",
                  {{"encoder [3]", "encoder [3, delay 5 Hz]"}},
                  {"x.yaml:12:31: delay '5 Hz' ... '5 Hz': 'Hz' is not a unit of time here; write "
                   "one of: ns, us, ms, s, min, h ... 5 ms or 2 ticks ... [SL0310]"}},
        WrongFile{"delay in part of a tick",
                  {{"encoder [3]", "encoder [3, delay 1.5 ticks]"}},
                  {"x.yaml:12:31: delay '1.5 ticks' ... 0 to 1000000 ... 1 ms ... [SL0310]"}},
        WrongFile{"negative delay",
                  {{"encoder [3]", "encoder [3, delay -1 ms]"}},
                  {"x.yaml:12:31: delay '-1 ms' ... 0 to 1000000 ... 1 ms ... [SL0310]"}},
        WrongFile{"huge delay",
                  {{"encoder [3]", "encoder [3, delay 1 h]"}},
                  {"x.yaml:12:31: delay '1 h' is not a whole number of ticks from 0 to 1000000; "
                   "write a multiple of the tick, 1 ms [SL0310]"}},
        WrongFile{"no arrow",
                  {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
                    "  - scan encoder\n"}},
                  {"x.yaml:12:5: 'scan encoder' is not a connection; write for example  scan -> "
                   "encoder [100] -> brain [100, delay 5 ms] [SL0101]"}},
        WrongFile{
            "another arrow",
            {{"scan -> encoder", "scan => encoder"}},
            {"x.yaml:12:10: '=>' is not an arrow; write for example  scan -> encoder [100] -> "
             "brain [100, delay 5 ms] [SL0101]"}},
        WrongFile{"arrow to nothing",
                  {{"-> wheels [2]", "->"}},
                  {"x.yaml:12:55: a node is missing beside '->'; write for example  scan -> "
                   "encoder [100] -> brain [100, delay 5 ms] [SL0101]"}},
        WrongFile{"arrow from nothing",
                  {{"- scan ->", "- ->"}},
                  {"x.yaml:12:5: ... '->' ... scan -> encoder [100] -> brain [100, delay 5 ms] ... "
                   "[SL0101]"}},
        WrongFile{"width before the first arrow",
                  {{"- scan ->", "- scan [3] ->"}},
                  {"x.yaml:12:10: a sender has no width; write the width behind the receiver, as  "
                   "scan -> encoder [100],  and a part of the sender's channels without a blank, "
                   "as  scan[0:50] -> encoder [SL0307]"}},
        WrongFile{"bracket not closed",
                  {{"wheels [2]", "wheels [2"}},
                  {"x.yaml:12:63: '[2' has no closing bracket at its end; write for example  scan "
                   "-> encoder [100] -> brain [100, delay 5 ms] [SL0101]"}},
        WrongFile{"text behind a bracket",
                  {{"wheels [2]", "wheels [2] fast"}},
                  {"x.yaml:12:63: '[2] fast' ... scan -> encoder [100] -> brain [100, delay 5 ms] "
                   "... [SL0101]"}},
        WrongFile{"width that is a word",
                  {{"wheels [2]", "wheels [two]"}},
                  {"x.yaml:12:64: 'two' is neither a width from 1 to 16777216 nor a delay; write "
                   "for example  scan -> encoder [100] -> brain [100, delay 5 ms] [SL0307]"}},
        WrongFile{"width of zero",
                  {{"wheels [2]", "wheels [0]"}},
                  {"x.yaml:12:64: '0' ... 1 to 16777216 ... scan -> encoder [100] -> brain [100, "
                   "delay 5 ms] ... [SL0307]"}},
        WrongFile{"huge width",
                  {{"wheels [2]", "wheels [2000000000]"}},
                  {"x.yaml:12:64: '2000000000' ... 1 to 16777216 ... scan -> encoder [100] -> "
                   "brain [100, delay 5 ms] ... [SL0307]"}},
        WrongFile{"two widths in a bracket",
                  {{"wheels [2]", "wheels [2, 3]"}},
                  {"x.yaml:12:67: '3' is the second of its kind here; write one width and one "
                   "delay [SL0102]"}},
        WrongFile{"two delays in a bracket",
                  {{"wheels [2]", "wheels [delay 1 ms, delay 2 ms]"}},
                  {"x.yaml:12:76: 'delay 2 ms' ... [SL0102]"}},
        WrongFile{"node that is not a name",
                  {{"-> encoder [3]", "-> my encoder [3]"}},
                  {"x.yaml:12:13: 'my encoder' is neither a node nor NODE.PORT; write for example  "
                   "scan -> encoder [100] -> brain [100, delay 5 ms] [SL0301]"}},
        WrongFile{"port that is not a name",
                  {{"-> encoder [3]", "-> encoder.in.x [3]"}},
                  {"x.yaml:12:13: 'encoder.in.x' ... NODE.PORT ... scan -> encoder [100] -> brain "
                   "[100, delay 5 ms] ... [SL0301]"}},
        WrongFile{"map with an unknown key",
                  {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
                    "  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n  - {from: "
                    "scan, too: encoder}\n"}},
                  {"x.yaml:13:18: connection: unknown key 'too'; did you mean 'to'? [SL0103]"}},
        WrongFile{"map without target",
                  {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
                    "  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n  - {from: "
                    "scan}\n"}},
                  {"x.yaml:13:5: connection: key 'to' is missing; write  to: encoder [SL0104]"}},
        WrongFile{"map with a wrong width",
                  {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
                    "  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n  - {from: "
                    "scan, to: encoder, width: -1}\n"}},
                  {"x.yaml:13:38: key 'width': '-1' is not a width from 1 to 16777216; write for "
                   "example 100 [SL0307]"}},
        WrongFile{"map with a wrong end",
                  {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
                    "  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n  - {from: "
                    "scan.out.x, to: encoder}\n"}},
                  {"x.yaml:13:12: 'scan.out.x' ... NODE.PORT ... left, right.out  or  left + "
                   "right.out ... [SL0301]"}},
        WrongFile{"connection that is a list",
                  {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
                    "  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n  - [scan, "
                    "encoder]\n"}},
                  {"x.yaml:13:5: a connection is a line or a map, this is a list; write  - scan -> "
                   "encoder [100] [SL0105]"}},
        WrongFile{"three connections that cannot be read",
                  {{"  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n",
                    "  - scan -> encoder [3] -> brain [3] -> decoder [3] -> wheels [2]\n  - scan\n "
                    " - scan -> encoder [x]\n  - scan => encoder\n"}},
                  {"x.yaml:13:5: 'scan' ... scan -> encoder [100] -> brain [100, delay 5 ms] ... "
                   "[SL0101]",
                   "x.yaml:14:22: 'x' ... 1 to 16777216 ... scan -> encoder [100] -> brain [100, "
                   "delay 5 ms] ... [SL0307]",
                   "x.yaml:15:10: '=>' ... scan -> encoder [100] -> brain [100, delay 5 ms] ... "
                   "[SL0101]"}},
        WrongFile{"faults of a node and of a connection",
                  {{"-> encoder", "-> encodr"},
                   {"200 Hz", "200"},
                   {"-> wheels [2]", "-> wheels [2, delay 5]"}},
                  {"x.yaml:7:43: node 'encoder': key 'rate_max': 200 has no unit; write for "
                   "example  rate_max: 200 Hz [SL0202]",
                   "x.yaml:12:13: unknown node 'encodr'; did you mean 'encoder'? [SL0301]",
                   "x.yaml:12:72: delay '5' has no unit; write 5 ms or 5 ticks [SL0310]"}},
        WrongFile{"more spikes than memory",
                  {{"duration: 1 s", "duration: 100 s"},
                   {"tick: 1 ms", "tick: 100 s"},
                   {"200 Hz", "1 MHz"}},
                  {"x.yaml:7:43: node 'encoder': key 'rate_max': 3 channels ... 300000000 spikes per "
                   "tick of 100 s ... 4.8 GB ... [SL0203]"}},
        WrongFile{"two faulty connections",
                  {{"-> encoder [3]", "-> encodr [3]"}, {"decoder [3]", "decodr [3]"}},
                  {"x.yaml:12:13: unknown node 'encodr'; did you mean 'encoder'? [SL0301]",
                   "x.yaml:12:40: unknown node 'decodr'; did you mean 'decoder'? [SL0301]"}}),
    [](const auto& row) { return "row" + std::to_string(row.index); });

}  // namespace
}  // namespace spikeloop::test
