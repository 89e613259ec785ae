// record=true: what a program puts out, in $SPIKELOOP_OUT/LABEL.h5.
#include "job.hpp"
#include "spikeloop/record/reader.hpp"

namespace spikeloop::test {
namespace {

TEST(Record, HoldsTheSpikesThatWentOut) {
  Job job;
  job.global("stoptime=0.1").global("seed=7").global("record=true");
  job.raw("sink")
      .ours("cells", "poisson_encoder", "rate_max=500\ninitial=1")
      .raw("source", "values=" + job.directory.write("values.txt", "0 1 1 1\n"))
      .connect("source.values -> cells.in [3]")
      .connect("cells.out -> sink.spikes_in [3]");
  auto command = job.command();
  command.environment["SPIKELOOP_OUT"] = job.directory.path().string();
  expect_clean(test::run(command));
  const auto file = (job.directory.path() / "cells.h5").string();
  const auto info = record::read_info(file);
  EXPECT_TRUE(info.complete);
  EXPECT_EQ(info.process, "cells");
  EXPECT_EQ(info.seed, 7u);
  EXPECT_EQ(info.tick, 1'000'000);
  const auto recorded = record::read_spikes(file, "out");
  EXPECT_EQ(recorded.width, 3u);
  const auto events = job.events("sink");
  ASSERT_GT(events.size(), 50u);
  ASSERT_EQ(recorded.spikes.size(), events.size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(recorded.spikes[i].channel, events[i].id);
    // The stamp guard moves what goes out, by at most 1 us.
    EXPECT_NEAR(static_cast<double>(recorded.spikes[i].time_ns) * 1e-9, events[i].seconds, 1.0e-6);
  }
}

TEST(Record, HoldsTheSignalsThatWentOut) {
  Job job;
  job.global("stoptime=0.02").global("record=true");
  job.raw("sink")
      .ours("twice", "connect_adapter", "weights=one_to_one:2")
      .raw("source", "values=" + job.directory.write("values.txt", "3 1 2\n8 3 4\n"))
      .connect("source.values -> twice.in [2]")
      .connect("twice.out -> sink.values_in [2]");
  expect_clean(job.run());
  const auto recorded = record::read_signal((job.directory.path() / "twice.h5").string(), "out");
  ASSERT_EQ(recorded.times.size(), 2u);
  // Value of sender time 4 ms, held over (4 ms, 5 ms]: the row stands where the recorder saw it.
  EXPECT_EQ(recorded.times[1] - recorded.times[0], 5'000'000);
  EXPECT_EQ(recorded.values, (std::vector<double>{2, 4, 6, 8}));
}

TEST(Record, AFolderThatIsNotThereIsAnError) {
  Job job;
  job.global("stoptime=0.02");
  job.raw("sink")
      .node("cell", "edge_spiker", "record=true")
      .connect("cell.out -> sink.spikes_in [2]");
  auto command = job.command();
  command.environment["SPIKELOOP_OUT"] = "/no/such/folder";
  const auto outcome = test::run(command);
  EXPECT_EQ(outcome.exit_code, 4);
  EXPECT_TRUE(outcome.says("cell: ")) << outcome.text();
  EXPECT_TRUE(outcome.says("/no/such/folder/cell.h5")) << outcome.text();
}

}  // namespace
}  // namespace spikeloop::test
