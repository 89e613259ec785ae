// What is sent comes back: exactly, through our reader and through h5py.
#include "spikeloop/record/recorder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include "record/src/hdf5.hpp"
#include "spikeloop/core/graph.hpp"
#include "spikeloop/record/reader.hpp"
#include "steps.hpp"
#include "tests/support/child.hpp"
#include "tests/support/temporary_directory.hpp"

namespace spikeloop {
namespace {

using record::Recorder;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<std::pair<TimeNs, std::int32_t>> pairs(const std::vector<Spike>& spikes) {
  std::vector<std::pair<TimeNs, std::int32_t>> result;
  for (const auto& spike : spikes) {
    result.emplace_back(spike.time_ns, spike.channel);
  }
  return result;
}

class RecorderTest : public testing::Test {
 protected:
  std::string file(const std::string& name = "encoder.h5") const {
    return (directory_.path() / name).string();
  }
  /// Standard output of a Python script that is given the file's path.
  std::string python(const std::string& script) const {
    const auto outcome = test::run(
        {.arguments = {"/usr/bin/python3", "-c",
                       "import sys, h5py\nf = h5py.File(sys.argv[1], 'r')\n" + script, file()}});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text();
    return outcome.out;
  }
  test::TemporaryDirectory directory_;
};

TEST_F(RecorderTest, SpikesComeBackInOrderToTheNanosecond) {
  Recorder recorder(file(), "encoder", {7, 1'000'000});
  const auto sink = recorder.spike_sink("out", 3);
  test::send_spikes(*sink, test::tick(0), {make_spike(1, 0), make_spike(1'000'000, 2)});
  test::send_spikes(*sink, test::tick(1), {});
  test::send_spikes(*sink, test::tick(2), {make_spike(2'500'001, 1)});
  test::send_spikes(*sink, test::tick(3), {make_spike(9'007'199'254'740'993, 0)});  // 2^53 + 1
  const auto report = recorder.close();
  EXPECT_EQ(report.spikes_written, 4u);
  EXPECT_EQ(report.spikes_dropped, 0u);
  EXPECT_EQ(report.error, "");

  const auto read = record::read_spikes(file(), "out");
  EXPECT_THAT(pairs(read.spikes),
              ElementsAre(std::pair(1, 0), std::pair(1'000'000, 2), std::pair(2'500'001, 1),
                          std::pair(9'007'199'254'740'993, 0)));
  EXPECT_EQ(read.width, 3u);
  EXPECT_EQ(read.until, 4'000'000);
  EXPECT_EQ(read.dropped, 0u);
}

TEST_F(RecorderTest, LateSpikesStandWhereTheLoopSawThem) {
  Recorder recorder(file(), "encoder", {});
  const auto late = recorder.spike_sink("late", 1);
  const auto sorted = recorder.spike_sink("sorted", 1);
  for (Sink* sink : {late.get(), sorted.get()}) {
    test::send_spikes(*sink, test::tick(0), {make_spike(800'000, 0)});
  }
  test::send_spikes(*late, test::tick(1), {make_spike(700'000, 0), make_spike(1'500'000, 0)});
  test::send_spikes(*sorted, test::tick(1), {make_spike(800'000, 0), make_spike(1'500'000, 0)});
  recorder.close();
  EXPECT_THAT(pairs(record::read_spikes(file(), "late").spikes),
              ElementsAre(std::pair(800'000, 0), std::pair(700'000, 0), std::pair(1'500'000, 0)));
  EXPECT_EQ(python("names = {v: k for k, v in h5py.check_enum_dtype(\n"
                   "    f['spikes/late'].attrs.get_id('sorting').dtype).items()}\n"
                   "for s in ('late', 'sorted'):\n"
                   "    print(names[int(f['spikes'][s].attrs['sorting'])])\n"),
            "none\nby_time\n");
}

TEST_F(RecorderTest, H5pySeesSonataSpikes) {
  Recorder recorder(file(), "encoder", {42, 500'000});
  const auto sink = recorder.spike_sink("out", 5);
  test::send_spikes(*sink, {0, 500'000}, {make_spike(125'000, 4), make_spike(250'000, 1)});
  recorder.close();
  EXPECT_EQ(python("g = f['spikes/out']\n"
                   "for name in ('timestamps', 'node_ids', 'timestamps_ns'):\n"
                   "    print(name, g[name].dtype, g[name][:].tolist())\n"
                   "print(g['timestamps'].attrs['units'], g.attrs['width'], g.attrs['until_ns'])\n"
                   "print(hex(f.attrs['magic']), f.attrs['version'].tolist())\n"),
            "timestamps float64 [0.125, 0.25]\n"
            "node_ids uint64 [4, 1]\n"
            "timestamps_ns int64 [125000, 250000]\n"
            "ms 5 500000\n"
            "0xa7a [0, 1]\n");
  EXPECT_EQ(python("a = f.attrs\n"
                   "print(a['process'], a['spikeloop_format'], a['seed'], a['tick_ns'],\n"
                   "      a['complete'], a['spikeloop_version'].count('.'))\n"),
            "encoder 1 42 500000 1 2\n");
}

TEST_F(RecorderTest, FileSaysWhereItComesFrom) {
  {
    Recorder recorder(file(), "decoder", {std::numeric_limits<std::uint64_t>::max(), 1'000'000});
    recorder.signal_sink("b", 1, "");
    recorder.signal_sink("a", 1, "");
    recorder.spike_sink("in", 1);
    EXPECT_FALSE(record::read_info(file()).complete);
  }
  const auto info = record::read_info(file());
  EXPECT_EQ(info.process, "decoder");
  EXPECT_EQ(info.format, record::kFormat);
  EXPECT_EQ(info.seed, std::numeric_limits<std::uint64_t>::max());
  EXPECT_EQ(info.tick, 1'000'000);
  EXPECT_TRUE(info.complete);
  EXPECT_THAT(info.spikes, ElementsAre("in"));
  EXPECT_THAT(info.signals, ElementsAre("a", "b"));
}

TEST_F(RecorderTest, SignalRowsStandWhereTheRevisionChanges) {
  Recorder recorder(file(), "command", {});
  const auto sink = recorder.signal_sink("in", 2, "m/s", {"linear.x", "angular.z"});
  test::send_signal(*sink, test::tick(0), {9, 9}, 0);  // no value yet
  test::send_signal(*sink, test::tick(1), {0.5, -1}, 1);
  test::send_signal(*sink, test::tick(2), {0.5, -1}, 1);
  test::send_signal(*sink, test::tick(3), {0.5, -1}, 2);
  test::send_signal(*sink, test::tick(4), {0.25, 1}, 3);
  test::send_signal(*sink, test::tick(5), {0.25, 1}, 3);
  EXPECT_EQ(recorder.close().signals_written, 3u);

  const auto read = record::read_signal(file(), "in");
  EXPECT_THAT(read.times, ElementsAre(2'000'000, 4'000'000, 5'000'000));
  EXPECT_THAT(read.values, ElementsAre(0.5, -1, 0.5, -1, 0.25, 1));
  EXPECT_THAT(read.row(2), ElementsAre(0.25, 1));
  EXPECT_EQ(read.width, 2u);
  EXPECT_EQ(read.unit, "m/s");
  EXPECT_THAT(read.channels, ElementsAre("linear.x", "angular.z"));
  EXPECT_EQ(read.until, 6'000'000);
  EXPECT_EQ(python("g = f['signals/in']\n"
                   "print(g['times_ns'][:].tolist(), g['values'][:].tolist())\n"
                   "print(g['values'].attrs['unit'], *g.attrs['channels'])\n"),
            "[2000000, 4000000, 5000000] [[0.5, -1.0], [0.5, -1.0], [0.25, 1.0]]\n"
            "m/s linear.x angular.z\n");
}

TEST_F(RecorderTest, NanAndInfinityKeepTheirBits) {
  const std::vector<double> values{kNan, std::numeric_limits<double>::infinity(), -0.0,
                                   std::numeric_limits<double>::denorm_min(),
                                   std::bit_cast<double>(std::uint64_t{0x7ff8'0000'dead'beef})};
  Recorder recorder(file(), "encoder", {});
  const auto sink = recorder.signal_sink("out", 5, "");
  test::send_signal(*sink, test::tick(0), values, 1);
  recorder.close();
  const auto read = record::read_signal(file(), "out");
  ASSERT_EQ(read.values.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(read.values[i]), std::bit_cast<std::uint64_t>(values[i]))
        << i;
  }
}

TEST_F(RecorderTest, SignalThatTurnsInvalidIsNanFromThen) {
  Recorder recorder(file(), "encoder", {});
  const auto sink = recorder.signal_sink("out", 2, "");
  test::send_signal(*sink, test::tick(0), {1, 2}, 1);
  test::send_signal(*sink, test::tick(1), {1, 2}, 0);
  test::send_signal(*sink, test::tick(2), {1, 2}, 0);
  test::send_signal(*sink, test::tick(3), {3, 4}, 1);
  recorder.close();
  const auto read = record::read_signal(file(), "out");
  EXPECT_THAT(read.times, ElementsAre(1'000'000, 2'000'000, 4'000'000));
  EXPECT_THAT(read.values, testing::Pointwise(testing::NanSensitiveDoubleEq(),
                                              {1.0, 2.0, kNan, kNan, 3.0, 4.0}));
}

TEST_F(RecorderTest, ValuesWithoutAPortComeBack) {
  Recorder recorder(file(), "wheels", {1, 1'000'000});
  const auto write = recorder.value_writer("latency", "ms");
  write(1'000'000, 0.5);
  write(51'000'000, 0.5);  // a row a call, also when nothing has changed
  write(101'000'000, -0.0);
  EXPECT_EQ(recorder.close().signals_written, 3u);
  write(151'000'000, 1.0);
  EXPECT_EQ(recorder.close().signals_dropped, 1u);
  const auto read = record::read_signal(file(), "latency");
  EXPECT_THAT(read.times, ElementsAre(1'000'000, 51'000'000, 101'000'000));
  EXPECT_THAT(read.values, ElementsAre(0.5, 0.5, -0.0));
  EXPECT_EQ(read.unit, "ms");
  EXPECT_EQ(read.width, 1u);
  EXPECT_EQ(read.until, 101'000'000);
}

TEST_F(RecorderTest, TwoWritersOfOneNameAreRefused) {
  Recorder recorder(file(), "wheels", {1, 1'000'000});
  recorder.value_writer("latency", "ms");
  EXPECT_THROW(recorder.value_writer("latency", "ms"), ConfigurationError);
}

TEST_F(RecorderTest, EmptyStreamsCanBeRead) {
  Recorder recorder(file(), "encoder", {});
  const auto spikes = recorder.spike_sink("spikes", 4);
  const auto signal = recorder.signal_sink("signal", 3, "rad");
  test::send_spikes(*spikes, test::tick(0), {});
  const auto report = recorder.close();
  EXPECT_EQ(report.spikes_written + report.signals_written, 0u);
  EXPECT_THAT(record::read_spikes(file(), "spikes").spikes, IsEmpty());
  EXPECT_EQ(record::read_spikes(file(), "spikes").until, 1'000'000);
  EXPECT_THAT(record::read_signal(file(), "signal").values, IsEmpty());
  EXPECT_EQ(record::read_signal(file(), "signal").width, 3u);
}

TEST_F(RecorderTest, MillionSpikesComeBack) {
  constexpr TimeNs kTicks = 10'000;
  constexpr int kSpikesATick = 100;
  record::RecorderOptions options;
  options.spike_capacity = std::size_t{1} << 20;
  options.flush_every = kNsPerSecond / 50;  // many batches
  Recorder recorder(file(), "network", {}, options);
  const auto sink = recorder.spike_sink("out", kSpikesATick);
  std::vector<Spike> spikes;
  for (TimeNs k = 0; k < kTicks; ++k) {
    spikes.clear();
    for (int i = 0; i < kSpikesATick; ++i) {
      spikes.push_back(make_spike(test::tick(k).begin + 1 + i * 997 + k % 13, i));
    }
    test::send_spikes(*sink, test::tick(k), spikes);
  }
  EXPECT_EQ(recorder.close().spikes_written, 1'000'000u);
  const auto read = record::read_spikes(file(), "out");
  ASSERT_EQ(read.spikes.size(), 1'000'000u);
  std::size_t wrong = 0;
  for (std::size_t n = 0; n < read.spikes.size(); ++n) {
    const auto k = static_cast<TimeNs>(n / kSpikesATick);
    const int i = static_cast<int>(n % kSpikesATick);
    wrong += read.spikes[n].time_ns != test::tick(k).begin + 1 + i * 997 + k % 13 ||
             read.spikes[n].channel != i;
  }
  EXPECT_EQ(wrong, 0u);
}

/// The most gaps that HDF5 remembers of an open file.
ssize_t gaps_of_open_files() {
  const record::hdf5::Lock lock;
  std::array<hid_t, 8> files{};
  const ssize_t count =
      H5Fget_obj_ids(static_cast<hid_t>(H5F_OBJ_ALL), H5F_OBJ_FILE, files.size(), files.data());
  ssize_t most = 0;
  for (ssize_t i = 0; i < count; ++i) {
    most = std::max(most, H5Fget_free_sections(files[static_cast<std::size_t>(i)], H5FD_MEM_DEFAULT,
                                               0, nullptr));
  }
  return most;
}

/// A compressed chunk that grows with each flush moves and leaves a gap, which HDF5 remembers for
/// as long as the file is open.
TEST_F(RecorderTest, GapsAreForgottenInALongRun) {
  constexpr TimeNs kSpikes = 400'000;
  constexpr TimeNs kLook = 1000;
  record::RecorderOptions options;
  options.patient = true;
  options.spike_capacity = 1024;
  options.flush_every = 1;
  Recorder recorder(file(), "network", {}, options);
  const auto sink = recorder.spike_sink("out", 1000);
  const auto spike = [dice = std::mt19937_64(54)]() mutable {
    return make_spike(static_cast<TimeNs>(dice() >> 20), static_cast<std::int32_t>(dice() % 1000));
  };
  auto sent = spike;
  ssize_t gaps = 0;
  for (TimeNs k = 0; k < kSpikes; ++k) {
    test::send_spikes(*sink, test::tick(k), {sent()});
    if (k % kLook == 0) {
      gaps = std::max(gaps, gaps_of_open_files());
    }
  }
  // Up to 10 when a flush begins, and one more per dataset.
  EXPECT_THAT(gaps, testing::AllOf(testing::Gt(5), testing::Le(13)));
  EXPECT_EQ(recorder.close().spikes_written, static_cast<std::uint64_t>(kSpikes));
  auto expected = spike;
  std::size_t wrong = 0;
  for (const Spike& read : record::read_spikes(file(), "out").spikes) {
    const Spike right = expected();
    wrong += read.time_ns != right.time_ns || read.channel != right.channel;
  }
  EXPECT_EQ(wrong, 0u);
}

TEST_F(RecorderTest, WideSignalsComeBackInManyBatches) {
  constexpr std::uint32_t kWidth = 1000;
  record::RecorderOptions options;
  options.flush_every = kNsPerSecond / 100;
  Recorder recorder(file(), "encoder", {}, options);
  const auto sink = recorder.signal_sink("out", kWidth, "");
  std::vector<double> values(kWidth);
  for (TimeNs k = 0; k < 2000; ++k) {
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      values[i] = static_cast<double>(k) + i / 1024.0;
    }
    test::send_signal(*sink, test::tick(k), values, static_cast<std::uint64_t>(k + 1));
  }
  EXPECT_EQ(recorder.close().signals_dropped, 0u);
  const auto read = record::read_signal(file(), "out");
  ASSERT_EQ(read.times.size(), 2000u);
  for (const std::size_t k : {0u, 1u, 777u, 1999u}) {
    EXPECT_EQ(read.times[k], test::tick(static_cast<TimeNs>(k)).end);
    EXPECT_EQ(read.row(k)[0], static_cast<double>(k));
    EXPECT_EQ(read.row(k)[kWidth - 1], static_cast<double>(k) + (kWidth - 1) / 1024.0);
  }
}

TEST_F(RecorderTest, TwoRecordersWorkSideBySide) {
  Recorder first(file("a.h5"), "a", {});
  Recorder second(file("b.h5"), "b", {});
  const auto to_first = first.spike_sink("out", 1);
  const auto to_second = second.spike_sink("out", 1);
  std::thread other([&] {
    for (TimeNs k = 0; k < 1000; ++k) {
      test::send_spikes(*to_second, test::tick(k), {make_spike(test::tick(k).end, 0)});
    }
    second.close();
  });
  for (TimeNs k = 0; k < 500; ++k) {
    test::send_spikes(*to_first, test::tick(k), {make_spike(test::tick(k).end, 0)});
  }
  first.close();
  other.join();
  EXPECT_EQ(record::read_spikes(file("a.h5"), "out").spikes.size(), 500u);
  EXPECT_EQ(record::read_spikes(file("b.h5"), "out").spikes.size(), 1000u);
}

TEST_F(RecorderTest, OutputsHaveThePopulationsAndTheUnitOfTheirPorts) {
  NodeClass network;
  network.description.ports = {
      {"out", PortKind::spikes, Direction::output, {}, "", "1", {{"left", 2}, {"right", 3}}},
      {"potential", PortKind::signal, Direction::output, {}, "", "mV"}};
  GraphDescription graph;
  graph.nodes.push_back({"brain", &network, {}});
  Recorder recorder(file(), "brain", {});
  const auto spikes = recorder.output_sink(graph, "brain.out", {"out", PortKind::spikes, 5});
  const auto known =
      recorder.output_sink(graph, "brain.potential", {"potential", PortKind::signal, 1});
  const auto unknown = recorder.output_sink(graph, "scan.out", {"scan", PortKind::signal, 1});
  recorder.close();
  EXPECT_EQ(
      python("a = f['spikes/out'].attrs\n"
             "print(list(a['populations']), a['population_sizes'].tolist())\n"
             "print(*(f['signals'][s]['values'].attrs['unit'] for s in ('potential', 'scan')))\n"),
      "['left', 'right'] [2, 3]\nmV 1\n");
}

/// One spike a tick, and a value that changes every second tick.
class Generator : public Source {
 public:
  std::vector<EndpointPort> ports() const override {
    return {{"spikes", PortKind::spikes, 2}, {"value", PortKind::signal, 1}};
  }
  void receive(const Step& step) override {
    step.spike_output().emit(step.interval().end, 1);
    if (step.interval().begin % 2'000'000 == 0) {
      step.signal_output().values()[0] = to_seconds(step.interval().begin);
      step.signal_output().commit();
    }
  }
};

TEST_F(RecorderTest, SinksOfAGraphRecordEveryConnection) {
  Recorder recorder(file(), "generator", {});
  Generator generator;
  const auto spikes = recorder.spike_sink("spikes", 2);
  const auto value = recorder.signal_sink("value", 1, "s");
  GraphDescription description;
  description.tick = 1'000'000;
  description.sources.push_back({"generator", &generator});
  description.sinks.push_back({"record_spikes", spikes.get()});
  description.sinks.push_back({"record_value", value.get()});
  description.connections.push_back({.from = "generator.spikes", .to = "record_spikes"});
  description.connections.push_back({.from = "generator.value", .to = "record_value.in"});
  Graph graph(description);
  for (int k = 0; k < 4; ++k) {
    graph.step();
  }
  recorder.close();
  EXPECT_EQ(record::read_spikes(file(), "spikes").spikes.size(), 4u);
  const auto read = record::read_signal(file(), "value");
  EXPECT_THAT(read.times, ElementsAre(1'000'000, 3'000'000));
  EXPECT_THAT(read.values, ElementsAre(0, 0.002));
}

}  // namespace
}  // namespace spikeloop
