// Connections with several senders: how they are written, their widths, what is said of wrong ones.
#include <gmock/gmock.h>

#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/experiment/music_job.hpp"
#include "tests/experiment/experiment_text.hpp"
#include "tests/support/fault.hpp"

namespace spikeloop::test {
namespace senders {

using experiment::Connection;
using experiment::Experiment;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kTwo = R"(experiment: two
duration: 1 s
ros: 2
nodes:
  scan: {node: ros_sensor, topic: /scan, message: LaserScan}
  left: {node: rate_encoder}
  right: {node: rate_encoder}
  brain: {node: rate_window}
connections:
  - scan -> left [3]
  - scan -> right
)";

class Senders : public testing::Test {
 protected:
  Read read_with(const std::string& lines) {
    files_ = std::make_unique<Files>(
        kTwo + lines, std::map<std::string, std::string>{{"brain.py", "import spikeloop\n"}});
    return read(*files_, types_);
  }
  Experiment good(const std::string& lines) {
    Read result = read_with(lines);
    EXPECT_THAT(result.faults, IsEmpty()) << lines;
    return std::move(result.experiment);
  }
  std::vector<std::string> faults(const std::string& lines) { return read_with(lines).faults; }
  /// "left.out[0:2] + brain.in 5": the connections into `to`.
  static std::vector<std::string> into(const Experiment& experiment, const std::string& to) {
    std::vector<std::string> result;
    for (const Connection& connection : experiment.connections) {
      if (connection.to == to) {
        const char* sign = connection.combination == Combination::added      ? "+ "
                           : connection.combination == Combination::appended ? ", "
                                                                             : "";
        result.push_back(
            sign + connection.from + connection.channels.text() +
            (connection.delay_ticks ? " " + std::to_string(*connection.delay_ticks) : ""));
      }
    }
    return result;
  }
  std::string refusal(const std::function<void()>& action) {
    try {
      action();
    } catch (const ConfigurationError& error) {
      return files_->plain(error.what());
    }
    return "nothing";
  }

  experiment::NodeTypes types_;
  std::unique_ptr<Files> files_;
};

TEST_F(Senders, ACommaPutsTheirChannelsOneAfterAnother) {
  const Experiment experiment = good("  - left, right.out -> brain [6, delay 2 ticks]\n");
  EXPECT_THAT(into(experiment, "brain.in"), ElementsAre("left.out 2", ", right.out 2"));
  EXPECT_EQ(experiment.width("brain", "in"), 6U);
  EXPECT_EQ(experiment.width("brain", "out"), 6U);
}

TEST_F(Senders, APlusAddsThem) {
  const Experiment experiment = good("  - left + right -> brain\n");
  EXPECT_THAT(into(experiment, "brain.in"), ElementsAre("left.out", "+ right.out"));
  EXPECT_EQ(experiment.width("brain", "in"), 3U);
}

TEST_F(Senders, MapsHaveThemAsAListOrAsText) {
  EXPECT_THAT(into(good("  - {from: [left, right.out], to: brain, width: 6}\n"), "brain.in"),
              ElementsAre("left.out", ", right.out"));
  EXPECT_THAT(into(good("  - {from: left + right, to: brain}\n"), "brain.in"),
              ElementsAre("left.out", "+ right.out"));
  EXPECT_THAT(into(good("  - from: left, right\n    to: brain\n    delay: 1 tick\n"), "brain.in"),
              ElementsAre("left.out 1", ", right.out 1"));
}

TEST_F(Senders, TheLineGoesOnBehindThem) {
  std::string lines = "  - left, right, left -> brain [9] -> squash -> squash2 [9]\n";
  std::string text = kTwo;
  text.insert(text.find("connections:"),
              "  squash: {node: sigmoid}\n  squash2: {node: low_pass}\n");
  const Files files(text + lines);
  const Read result = read(files, types_);
  EXPECT_THAT(result.faults, IsEmpty());
  EXPECT_THAT(into(result.experiment, "brain.in"),
              ElementsAre("left.out", ", right.out", ", left.out"));
  EXPECT_EQ(result.experiment.width("squash", "in"), 9U);
}

TEST_F(Senders, SaysWhatIsWrong) {
  EXPECT_THAT(faults("  - left, right -> brain [5]\n"),
              ElementsAre("x.yaml:12:20: widths differ: 'left.out, right.out' has 6 channels, "
                          "'brain.in' has 5, the connection says [5] [SL0306]"));
  EXPECT_THAT(faults("  - left + right + left -> brain [5]\n"),
              ElementsAre("x.yaml:12:28: widths differ: 'left.out' has 3 channels, 'brain.in' has "
                          "5, the connection says [5] [SL0306]"));
  EXPECT_THAT(
      faults("  - right + left[0:2] -> brain\n"),
      ElementsAre("x.yaml:12:26: widths differ: 'right.out' has 3 channels, 'brain.in' has 2 "
                  "[SL0306]"));
  EXPECT_THAT(faults("  - left, rigth -> brain\n"),
              ElementsAre("x.yaml:12:11: unknown node 'rigth'; did you mean 'right'? [SL0301]"));
  EXPECT_THAT(faults("  - left, scan -> brain\n"),
              ElementsAre("x.yaml:12:19: continuous output 'scan.out' cannot drive spike input "
                          "'brain.in'; put an encoder between them [SL0303]"));
  EXPECT_THAT(faults("  - left,  -> brain\n"),
              ElementsAre("x.yaml:12:10: a sender is missing beside ','; write for example  left, "
                          "right.out  or  left + right.out [SL0101]"));
  EXPECT_THAT(
      faults("  - left, right + left -> brain\n"),
      ElementsAre(Fault(
          "x.yaml:12:17: 'left, right + left' has both ',' (channels one after another) and '+' "
          "(sum); write one of them, and put another node between for the other [SL0101]")));
  EXPECT_THAT(faults("  - left -> brain\n  - right -> brain\n"),
              ElementsAre("x.yaml:13:14: input 'brain.in' has two senders, 'left.out' and "
                          "'right.out'; remove one connection [SL0304]"));
  EXPECT_THAT(faults("  - {from: [left, right + left], to: brain}\n"),
              ElementsAre("x.yaml:12:19: key 'from': 'right + left' has several senders in one "
                          "entry of a list; write one in each entry, or  from: left + right  for "
                          "their sum [SL0105]"));
  EXPECT_THAT(faults("  - {from: [], to: brain}\n"),
              ElementsAre("x.yaml:12:12: key 'from' has an empty list; write  from: [left, right] "
                          "[SL0105]"));
  EXPECT_THAT(
      faults("  - left, right -> brain [delay 1.5 ms]\n"),
      ElementsAre(Fault("x.yaml:12:33: delay '1.5 ms' ... 0 to 1000000 ... 1 ms ... [SL0310]")));
}

TEST_F(Senders, GiveSomeOfTheirChannelsAsInPython) {
  const auto channels = [&](const std::string& sender) {
    return into(good("  - " + sender + " -> brain\n"), "brain.in").front();
  };
  EXPECT_EQ(channels("left[0:2]"), "left.out[0:2]");
  EXPECT_EQ(channels("left.out[:2]"), "left.out[0:2]");
  EXPECT_EQ(channels("left[1:]"), "left.out[1:]");
  EXPECT_EQ(channels("left[2]"), "left.out[2]");
  EXPECT_EQ(channels("left[0:3]"), "left.out[0:3]");
  const Experiment experiment = good("  - left[1:], right[0] -> brain [3, delay 1 tick]\n");
  EXPECT_THAT(into(experiment, "brain.in"), ElementsAre("left.out[1:] 1", ", right.out[0] 1"));
  EXPECT_EQ(experiment.width("brain", "in"), 3U);
  EXPECT_EQ(experiment.width("left", "out"), 3U);
  EXPECT_THAT(into(good("  - {from: [left, \"right[0:2]\"], to: brain, width: 5}\n"), "brain.in"),
              ElementsAre("left.out", ", right.out[0:2]"));
  EXPECT_THAT(into(good("  - {from: \"left[0] + right[2]\", to: brain}\n"), "brain.in"),
              ElementsAre("left.out[0]", "+ right.out[2]"));
}

TEST_F(Senders, SaysWhatIsWrongWithChannels) {
  EXPECT_THAT(faults("  - right, left[1:5] -> brain\n"),
              ElementsAre(Fault("x.yaml:12:12: 'left.out' has 3 channels, counted from 0, and "
                                "[1:5] ... [0:3] ... [SL0203]")));
  EXPECT_THAT(faults("  - left[3] -> brain\n"),
              ElementsAre(Fault("x.yaml:12:5: 'left.out' has 3 channels, counted from 0, and [3] "
                                "... [0:3] ... [SL0203]")));
  EXPECT_THAT(faults("  - left[0:2] -> brain [3]\n"),
              ElementsAre("x.yaml:12:18: widths differ: 'left.out[0:2]' has 2 channels, 'brain.in' "
                          "has 3, the connection says [3] [SL0306]"));
  for (const char* range : {"[2:1]", "[1:1]", "[-1]", "[0:2:1]", "[:]", "[]", "[a]", "[0 :2]",
                            "[0:2", "[99999999]", "[0:2]]", "[0:]0"}) {
    EXPECT_THAT(faults(std::string("  - left") + range + " -> brain\n"),
                ElementsAre(std::string("x.yaml:12:9: '") + range +
                            "' is not a range of channels; write the first channel, counted from "
                            "0, and the one behind the last, as  [0:50],  or one channel, as  [7] "
                            "[SL0101]"));
  }
  EXPECT_THAT(
      faults("  - left -> brain [0:2]\n"),
      ElementsAre(Fault("x.yaml:12:20: '0:2' is neither a width nor a delay; channels are selected "
                        "where a line begins, as  scan[0:50] -> encoder [50] [SL0307]")));
  std::string text = kTwo;
  text.replace(text.find("  - scan -> left [3]\n"), 21, "  - scan[0:3] -> left\n");
  text.replace(text.find("  - scan -> right\n"), 18, "");
  const Files files(text + "  - left, left -> brain\n");
  EXPECT_THAT(
      read(files, types_).faults,
      testing::Contains(
          Fault("x.yaml:10:5: ... 'scan.out' is unknown ... scan.out -> NODE [10] ... [SL0307]")));
  text.replace(text.find("message: LaserScan"), 18,
               "message: LaserScan, fields: [\"ranges[0:2]\", range_max]");
  EXPECT_THAT(read(Files(text + "  - left, left -> brain\n"), types_).faults,
              ElementsAre(Fault("... node 'right' is not connected; ... [SL0305]")));
}

TEST_F(Senders, AnExportedJobHasNone) {
  const Experiment experiment = good("  - left, right -> brain\n");
  EXPECT_EQ(refusal([&] { experiment::music_job(experiment, "out"); }),
            "x.yaml:12:20: input 'brain.in' has several senders, which an exported job does not "
            "support; connect one output to each input [SL0601]");
  const Experiment slice = good("  - left[1:] -> brain\n");
  EXPECT_EQ(refusal([&] { experiment::music_job(slice, "out"); }),
            "x.yaml:12:17: 'brain.in' takes [1:] of 'left.out', and an exported job has no slices; "
            "connect all channels [SL0601]");
}

/// brain is a script, in a process of its own.
class SendersOfASimulator : public Senders {
 protected:
  Experiment scripted(const std::string& lines, const char* layout = "fused") {
    std::string text = kTwo;
    const std::string window = "{node: rate_window}";
    text.replace(text.find(window), window.size(),
                 "{simulator: python, script: brain.py}\n"
                 "  other: {simulator: python, script: brain.py}");
    files_ = std::make_unique<Files>(
        text + lines, std::map<std::string, std::string>{{"brain.py", "import spikeloop\n"}});
    Read result = read(*files_, types_, {.settings = {{"layout", layout, "--layout"}}});
    EXPECT_THAT(result.faults, IsEmpty()) << lines;
    return experiment::with_layout_delays(result.experiment);
  }
  std::string job_refusal(const Experiment& experiment) {
    return refusal([&] { experiment::process_job(experiment, "", {}); });
  }
};

TEST_F(SendersOfASimulator, AreOneConnectionOfMusic) {
  const Experiment experiment =
      scripted("  - left, right -> brain [6]\n  - left[1:] + right[0:2] -> other\n");
  const MusicFile file = experiment::process_job(experiment, "", {}).file;
  EXPECT_NO_THROW(check_structure(file));
  EXPECT_THAT(to_text(file), HasSubstr("experiment.brain__in -> brain.in [6]\n"
                                       "experiment.other__in -> other.in [2]\n"));
}

TEST_F(SendersOfASimulator, AreInOneProcess) {
  EXPECT_THAT(job_refusal(scripted("  - left, right -> brain\n  - left -> other\n", "separate")),
              Fault("x.yaml:13:20: 'left.out' and 'right.out' are in the processes 'left' and "
                    "'right', and the senders of one input of a simulator must be in one process; "
                    "put them into one process, or put another node before 'brain.in' [SL0601]"));
  EXPECT_THAT(
      job_refusal(scripted("  - left -> brain\n  - brain.a + brain.b -> other [5]\n")),
      Fault("x.yaml:14:26: 'brain.a' and 'brain.b' are outputs of a simulator, and no graph "
            "combines them before 'other.in', which is an input of another one ... [SL0601]"));
  EXPECT_THAT(
      job_refusal(scripted("  - left -> brain\n  - brain.a -> other.b [2]\n"
                           "  - brain.a[0] -> other [1]\n")),
      Fault("x.yaml:15:19: no graph selects the channels of 'brain.a' before 'other.in', which is "
            "an input of another simulator; put another node between them [SL0601]"));
}

}  // namespace senders
}  // namespace spikeloop::test
