// What can go wrong: no room in the buffer, in time; and the words for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <thread>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/record/reader.hpp"
#include "spikeloop/record/recorder.hpp"
#include "steps.hpp"
#include "tests/support/child.hpp"
#include "tests/support/fault.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop {
namespace {

using record::Recorder;
using test::Fault;
using testing::HasSubstr;

/// What an expression that must throw `E` says.
template <typename E>
std::string message(const std::function<void()>& action) {
  try {
    action();
  } catch (const E& error) {
    return error.what();
  }
  return "(nothing thrown)";
}

class RecorderFaults : public testing::Test {
 protected:
  std::string file(const std::string& name = "x.h5") const {
    return (directory_.path() / name).string();
  }
  test::TemporaryDirectory directory_;
};

TEST_F(RecorderFaults, FullSpikeBufferIsCounted) {
  record::RecorderOptions options;
  options.spike_capacity = 4;
  Recorder recorder(file(), "x", {}, options);
  const auto sink = recorder.spike_sink("out", 10);
  std::vector<Spike> spikes;
  for (std::int32_t i = 0; i < 10; ++i) {
    spikes.push_back(make_spike(i + 1, i));
  }
  test::send_spikes(*sink, test::tick(0), spikes);
  const auto counters = sink->counters();
  ASSERT_EQ(counters.size(), 1u);
  EXPECT_EQ(counters[0].name, "spikes_dropped");
  EXPECT_EQ(counters[0].value, 6u);
  const auto report = recorder.close();
  EXPECT_EQ(report.spikes_written, 4u);
  EXPECT_EQ(report.spikes_dropped, 6u);
  EXPECT_EQ(report.error,
            "'" + file() +
                "' is incomplete: 6 spikes and 0 signal rows are lost, because the disk is slower "
                "than the data or the run went on after the file was closed; record fewer streams "
                "or write to a faster disk");
  const auto read = record::read_spikes(file(), "out");
  EXPECT_EQ(read.spikes.size(), 4u);
  EXPECT_EQ(read.dropped, 6u);
}

TEST_F(RecorderFaults, RowsThatDoNotFitAreDroppedWhole) {
  record::RecorderOptions options;
  options.value_capacity = 1;
  options.least_rows = 1;  // a ring of 4 values has room for one row of 1 + 2
  Recorder recorder(file(), "x", {}, options);
  const auto sink = recorder.signal_sink("out", 2, "");
  std::uint64_t sent = 0;
  while (sink->counters().at(0).value == 0 && sent < 1'000'000) {
    ++sent;
    test::send_signal(*sink, test::tick(0), {1, 2}, sent);
  }
  EXPECT_EQ(sink->counters().at(0).name, "signals_dropped");
  const auto report = recorder.close();
  EXPECT_EQ(report.signals_dropped, 1u);
  EXPECT_EQ(report.signals_written, sent - 1);
  EXPECT_THAT(report.error, HasSubstr("0 spikes and 1 signal rows are lost"));
  EXPECT_EQ(record::read_signal(file(), "out").values.size(), 2 * (sent - 1));
}

TEST_F(RecorderFaults, WhatIsSentAfterCloseIsCounted) {
  Recorder recorder(file(), "x", {});
  const auto spikes = recorder.spike_sink("out", 1);
  const auto signal = recorder.signal_sink("value", 1, "");
  test::send_spikes(*spikes, test::tick(0), {make_spike(1, 0)});
  EXPECT_EQ(recorder.close().error, "");
  test::send_spikes(*spikes, test::tick(1), {make_spike(1'000'001, 0)});
  test::send_signal(*signal, test::tick(1), {1}, 1);
  const auto report = recorder.close();
  EXPECT_EQ(report.spikes_written, 1u);
  EXPECT_EQ(report.spikes_dropped, 1u);
  EXPECT_EQ(report.signals_dropped, 1u);
  EXPECT_THAT(report.error, HasSubstr("the run went on after the file was closed"));
}

TEST_F(RecorderFaults, SinksOutliveTheirRecorder) {
  std::unique_ptr<Sink> sink;
  {
    Recorder recorder(file(), "x", {});
    sink = recorder.spike_sink("out", 1);
  }
  test::send_spikes(*sink, test::tick(0), {make_spike(1, 0)});
  EXPECT_EQ(sink->counters().at(0).value, 1u);
}

TEST_F(RecorderFaults, CloseFromAnotherThreadSaysWhenItIsDone) {
  Recorder recorder(file(), "x", {});
  const auto sink = recorder.spike_sink("out", 1);
  test::send_spikes(*sink, test::tick(0), {make_spike(1, 0)});
  EXPECT_TRUE(recorder.flush_and_close_from_signal(60 * kNsPerSecond));
  EXPECT_TRUE(recorder.flush_and_close_from_signal(0));
  EXPECT_EQ(recorder.close().spikes_written, 1u);
  EXPECT_EQ(record::read_spikes(file(), "out").spikes.size(), 1u);
}

TEST_F(RecorderFaults, DeletedFileIsReportedAtOnce) {
  WriteFailures failures;
  record::RecorderOptions options;
  options.flush_every = 1'000'000;
  options.failures = &failures;
  Recorder recorder(file(), "x", {}, options);
  const auto sink = recorder.spike_sink("out", 1);
  failures.check(OnWriteFailure::stop);
  std::filesystem::remove(file());
  for (TimeNs k = 0; !failures.any(); ++k) {  // ctest ends a test that waits
    test::send_spikes(*sink, test::tick(k), {test::nth_spike(k)});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(message<FileError>([&] { failures.check(OnWriteFailure::stop); }),
            "cannot write '" + file() +
                "': it has been deleted during the run; incomplete: x.h5 [SL0109]");
  EXPECT_THAT(recorder.close().error, Fault("cannot write '" + file() + "': ... [SL0109]"));
}

/// With a thread per file 2000 nodes could not start.
TEST_F(RecorderFaults, ManyFilesShareAThread) {
  const auto threads = [] {
    const std::filesystem::directory_iterator tasks("/proc/self/task");
    return std::distance(begin(tasks), end(tasks));
  };
  const auto before = threads();
  std::vector<std::unique_ptr<Recorder>> recorders;
  std::vector<std::unique_ptr<Sink>> sinks;
  for (int i = 0; i < 100; ++i) {
    recorders.push_back(
        std::make_unique<Recorder>(file(std::to_string(i)), "x", record::RunAttributes{}));
    sinks.push_back(recorders.back()->spike_sink("out", 1));
    test::send_spikes(*sinks.back(), test::tick(0), {make_spike(i + 1, 0)});
  }
  EXPECT_EQ(threads(), before + 1);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(recorders[i]->close().spikes_written, 1u);
    EXPECT_EQ(record::read_spikes(file(std::to_string(i)), "out").spikes.front().time_ns, i + 1);
  }
  recorders.clear();
  EXPECT_EQ(threads(), before);
}

TEST_F(RecorderFaults, SignalTooWideForItsRateIsRefused) {
  constexpr std::uint32_t kWidth = 1'000'000;
  constexpr TimeNs kTick = 1000;
  Recorder hurried(file(), "x", {1, kTick});
  EXPECT_THAT(message<ConfigurationError>([&] { hurried.signal_sink("out", kWidth, ""); }),
              Fault("recording 'out' of '" + file() +
                    "' ... 32.8 GB for 4096 rows of 1000000 channels, 1000000 rows per second ... "
                    "record: false ... [SL0203]"));
  record::RecorderOptions options;
  options.patient = true;  // a loop that waits for the writer needs few rows
  Recorder patient(file("y.h5"), "y", {1, kTick}, options);
  EXPECT_NE(patient.signal_sink("out", kWidth, ""), nullptr);
}

TEST_F(RecorderFaults, UnwritablePathIsNamed) {
  const std::string nowhere = file("missing/x.h5");
  EXPECT_THAT(message<FileError>([&] { Recorder(nowhere, "x", {}); }),
              Fault("cannot create '" + nowhere + "': ... [SL0109]"));
  EXPECT_EQ(message<FileError>([&] { Recorder(directory_.path(), "x", {}); }),
            "cannot create '" + directory_.path().string() + "': Is a directory [SL0109]");
}

TEST_F(RecorderFaults, StreamsThatCannotBeAreNamed) {
  Recorder recorder(file(), "x", {});
  recorder.spike_sink("out", 1);
  EXPECT_EQ(message<ConfigurationError>([&] { recorder.spike_sink("out", 2); }),
            "two recorded streams of '" + file() + "' are called 'out': rename one");
  EXPECT_EQ(message<ConfigurationError>([&] { recorder.signal_sink("out", 2, ""); }),
            "two recorded streams of '" + file() + "' are called 'out': rename one");
  EXPECT_EQ(message<ConfigurationError>([&] { recorder.spike_sink("a/b", 1); }),
            "a recorded stream cannot be called 'a/b': write a name without '/', such as 'out'");
  EXPECT_EQ(message<ConfigurationError>([&] { recorder.spike_sink("", 1); }),
            "a recorded stream cannot be called '': write a name without '/', such as 'out'");
  EXPECT_EQ(message<ConfigurationError>([&] { recorder.signal_sink("wide", 0, ""); }),
            "the recorded stream 'wide' has width 0: give it at least one channel");
  EXPECT_EQ(message<ConfigurationError>([&] { recorder.signal_sink("two", 2, "", {"a"}); }),
            "the recorded stream 'two' has 2 channels but 1 names: give one name each");
}

TEST_F(RecorderFaults, ClosedRecorderTakesNoStreams) {
  Recorder recorder(file(), "x", {});
  recorder.close();
  EXPECT_EQ(message<ConfigurationError>([&] { recorder.spike_sink("out", 1); }),
            "cannot record 'out': '" + file() + "' is closed already");
}

TEST_F(RecorderFaults, ReaderRefusesAChannelThatTheStreamHasNot) {
  const std::string path = file("wide.h5");
  {
    record::Recorder recorder(path, "encoder", {1, 1'000'000});
    const auto sink = recorder.spike_sink("out", 3);
    test::send_spikes(*sink, test::tick(0), {make_spike(5, 2)});
  }
  const std::string python =
      "import h5py\nh5py.File('" + path + "', 'r+')['spikes/out/node_ids'][0] = 5000000\n";
  ASSERT_EQ(test::run({.arguments = {"/usr/bin/python3", "-c", python}}).exit_code, 0);
  EXPECT_EQ(
      message<FileError>([&] { record::read_spikes(path, "out"); }),
      "cannot read '" + path + "': damaged: a spike of channel 5000000 in a stream of 3 [SL0109]");
}

TEST_F(RecorderFaults, ReaderNamesWhatItCannotRead) {
  const std::string missing = file("missing.h5");
  EXPECT_THAT(message<FileError>([&] { record::read_info(missing); }),
              Fault("cannot open '" + missing + "': ... [SL0109]"));
  const std::string text = directory_.write("text.h5", "just a text");
  EXPECT_EQ(message<FileError>([&] { record::read_info(text); }),
            "cannot read '" + text + "': not an HDF5 file, or damaged [SL0109]");
  const std::string python =
      "import h5py\n"
      "h5py.File('" +
      file("foreign.h5") +
      "', 'w').close()\n"
      "f = h5py.File('" +
      file("future.h5") +
      "', 'w')\n"
      "f.attrs['spikeloop_format'] = 2\n"
      "f.attrs['spikeloop_version'] = '9.0.0'\n";
  ASSERT_EQ(test::run({.arguments = {"/usr/bin/python3", "-c", python}}).exit_code, 0);
  EXPECT_EQ(message<FileError>([&] { record::read_info(file("foreign.h5")); }),
            "cannot read '" + file("foreign.h5") +
                "': an HDF5 file, but not a recording of Spikeloop's [SL0109]");
  EXPECT_THAT(message<FileError>([&] { record::read_info(file("future.h5")); }),
              testing::AllOf(HasSubstr("': it has format 2, this Spikeloop ("),
                             HasSubstr(") knows formats up to 1; read it with version 9.0.0 or "
                                       "newer")));
}

TEST_F(RecorderFaults, ReaderNamesUnknownStreams) {
  {
    Recorder recorder(file(), "x", {});
    recorder.spike_sink("spikes_out", 1);
  }
  EXPECT_EQ(
      message<ConfigurationError>([&] { record::read_spikes(file(), "spike_out"); }),
      "'" + file() + "' has no spikes called 'spike_out'; did you mean 'spikes_out'? [SL0205]");
  EXPECT_EQ(message<ConfigurationError>([&] { record::read_signal(file(), "value"); }),
            "'" + file() + "' has no signals called 'value'; it has none at all [SL0205]");
}

}  // namespace
}  // namespace spikeloop
