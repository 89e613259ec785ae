// What a launcher hears from a process.
#include <algorithm>
#include <nlohmann/json.hpp>

#include <thread>

#include "job.hpp"
#include "spikeloop/status/status.hpp"

namespace spikeloop::test {
namespace {

using nlohmann::json;

// Runs the job as a launcher would; all messages of `process`, heartbeats in place of the others
// when they are asked for.
std::vector<json> messages_of(const Job& job, const std::string& process, int exit_code,
                              bool heartbeats = false) {
  const std::string path = (job.directory.path() / "status").string();
  status::Receiver receiver(path);
  auto command = job.command();
  command.environment["SPIKELOOP_STATUS"] = path;
  std::vector<json> found;
  // Read while it runs: the socket holds but a few messages.
  std::jthread reader([&](const std::stop_token& end) {
    while (true) {
      const bool last = end.stop_requested();
      const auto message = receiver.next(std::chrono::milliseconds(100));
      if (message && message->at("process") == process &&
          (message->at("type") == "alive") == heartbeats) {
        found.push_back(*message);
      } else if (!message && last) {
        return;
      }
    }
  });
  const auto outcome = test::run(command);
  EXPECT_EQ(outcome.exit_code, exit_code) << outcome.text();
  reader.request_stop();
  reader.join();
  return found;
}

std::vector<std::string> types(const std::vector<json>& messages) {
  std::vector<std::string> result;
  for (const auto& message : messages) {
    if (message.at("type") != "progress") {
      result.push_back(message.at("type"));
    }
  }
  return result;
}

TEST(Status, TellsThatAProcessLivesAndWhatItDoes) {
  Job job;
  job.global("stoptime=1.2");
  job.raw("sink")
      .node("relay", "spike_relay", "clock_master=true")
      .raw("source", "map_out=9")
      .connect("source.spikes -> relay.in [2]")
      .connect("relay.out -> sink.spikes_in [2]");
  const auto beats = messages_of(job, "relay", 0, true);
  ASSERT_GE(beats.size(), 3U) << "every half second";
  // The first beat comes with the first tick, or a little later on a busy machine.
  EXPECT_LT(beats.front().at("simulated_s").get<double>(), 0.5);
  EXPECT_TRUE(std::ranges::is_sorted(
      beats, {}, [](const json& beat) { return beat.at("simulated_s").get<double>(); }));
  for (const json& beat : beats) {
    EXPECT_TRUE(status::phase_named(beat.at("phase").get<std::string>()).has_value()) << beat;
  }
  EXPECT_LE(beats.back().at("simulated_s").get<double>(), 1.2 + 1e-9);
  EXPECT_GT(beats.back().at("simulated_s").get<double>(), 0.2);
}

TEST(Status, TellsTheWholeLifeOfAProcess) {
  Job job;
  job.global("stoptime=0.05");
  job.raw("sink")
      .node("relay", "spike_relay")
      .raw("source", "map_out=9\nspikes=" +
                         job.directory.write("spikes.txt", "0 0.0005 0\n0 0.0006 7\n3 0.0035 1\n"))
      .connect("source.spikes -> relay.in [2]")
      .connect("relay.out -> sink.spikes_in [2]");
  const auto messages = messages_of(job, "relay", 0);
  EXPECT_EQ(types(messages), (std::vector<std::string>{"started", "first_tick", "report"}));
  ASSERT_FALSE(messages.empty());
  const auto& counters = messages.back().at("counters");
  EXPECT_EQ(counters.at("ticks"), 50);
  EXPECT_EQ(counters.at("in.events_outside_port"), 1);
  EXPECT_EQ(counters.at("in.events_without_time"), 0);
  EXPECT_EQ(counters.at("out.stamps_moved"), 0);
  EXPECT_EQ(counters.at("relay.out->out.out.spikes"), 2);
  EXPECT_EQ(counters.at("relay.out->out.out.late"), 0);
  EXPECT_TRUE(messages.back().at("summary").is_object());
}

TEST(Status, CountsLateSpikesAndMovedStamps) {
  Job job;
  job.global("stoptime=0.011");
  job.node("cell", "edge_spiker")
      .node("relay", "spike_relay", "accept_latency=0.001\ndelay=0.001")
      .raw("sink")
      .connect("cell.out -> relay.in [2]")
      .connect("relay.out -> sink.spikes_in [2]");
  const auto relay = messages_of(job, "relay", 0);
  ASSERT_FALSE(relay.empty());
  EXPECT_EQ(relay.back().at("counters").at("in.in->relay.in.late"), 20);
}

TEST(Status, TellsOfTheTimeOfTheClockMaster) {
  Job job;
  job.global("stoptime=0.6");
  job.node("end", "spike_relay").node("cell", "edge_spiker", "clock_master=true");
  job.connect("cell.out -> end.in [2]");
  const auto messages = messages_of(job, "cell", 0);
  int progress = 0;
  for (const auto& message : messages) {
    if (message.at("type") == "progress") {
      ++progress;
      EXPECT_GT(message.at("simulated_s"), 0.0);
      EXPECT_TRUE(message.contains("overruns"));
    }
  }
  EXPECT_GE(progress, 2);
  ASSERT_FALSE(messages.empty());
  EXPECT_TRUE(messages.back().at("counters").contains("overruns"));
}

TEST(Status, TellsOfAFailureWithItsSentence) {
  Job job;
  job.global("stoptime=1000");
  job.raw("sink")
      .node("cell", "edge_spiker", "fail_at=0.01")
      .connect("cell.out -> sink.spikes_in [2]");
  const auto messages = messages_of(job, "cell", 5);
  EXPECT_EQ(types(messages), (std::vector<std::string>{"started", "first_tick", "failure"}));
  ASSERT_FALSE(messages.empty());
  EXPECT_EQ(messages.back().at("exit_code"), 5);
  EXPECT_EQ(messages.back().at("message"),
            "node 'cell': the cell has burst (plug-in '" TEST_NODES "') [SL0704]");
}

// Whoever reports must have counted for all: only the first of several processes does report.
TEST(Status, CountsWhatAllProcessesOfASectionDid) {
  json counted[2];
  for (const int processes : {1, 3}) {
    Job job;
    job.global("stoptime=0.2\nsync=unpaced");
    job.raw("sink")
        .ours("cells", "poisson_encoder", "rate_max=1000", processes)
        .raw("source", "values=" + job.directory.write("values.txt", "0 1 2 0.5 -3 1 1 0 0 0.2\n"))
        .connect("source.values -> cells.in [9]")
        .connect("cells.out -> sink.spikes_in [9]");
    const auto messages = messages_of(job, "cells", 0);
    ASSERT_FALSE(messages.empty());
    EXPECT_EQ(messages.back().at("type"), "report");
    counted[processes == 1 ? 0 : 1] = messages.back().at("counters");
  }
  for (const char* const name : {"cells.spikes", "cells.inputs_clipped"}) {
    EXPECT_EQ(counted[0].at(name), counted[1].at(name)) << name;
    EXPECT_GT(counted[0].at(name), 0);
  }
}

}  // namespace
}  // namespace spikeloop::test
