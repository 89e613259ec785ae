#include "thread_team.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <barrier>
#include <exception>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "spikeloop/core/code.hpp"

namespace spikeloop {

namespace {

/// One thread's node, and what it gives.
struct Member {
  std::unique_ptr<Node> node;
  std::vector<std::vector<Spike>> spikes;  // of each spike output
  std::vector<spikeloop_spike_output> spike_outputs;
  std::vector<spikeloop_signal_output> signal_outputs;
  std::exception_ptr failure;

  static void append(void* sink, const Spike* spikes, std::uint64_t count) {
    auto& list = *static_cast<std::vector<Spike>*>(sink);
    list.insert(list.end(), spikes, spikes + count);
  }

  void step(const spikeloop_step& whole) {
    spikes.resize(whole.spike_output_count);
    spike_outputs.clear();
    for (std::size_t i = 0; i < spikes.size(); ++i) {
      spikes[i].clear();
      spike_outputs.push_back({&spikes[i], &append, whole.spike_outputs[i].width, 0});
    }
    signal_outputs.assign(whole.signal_outputs, whole.signal_outputs + whole.signal_output_count);
    spikeloop_step own = whole;
    own.spike_outputs = spike_outputs.data();
    own.signal_outputs = signal_outputs.data();
    try {
      node->step(Step(own));
    } catch (...) {
      failure = std::current_exception();
    }
  }
};

/// Members write to disjoint channels of the same signal outputs; the first runs in the caller's
/// thread.
class ThreadTeam final : public Node {
 public:
  ThreadTeam(const NodeClass& node_class, const NodeSetup& setup, unsigned threads)
      : members_(threads), all_(threads) {
    for (unsigned i = 0; i < threads; ++i) {
      NodeSetup own = setup;
      own.share = {setup.share.index * threads + i, setup.share.parts * threads};
      members_[i].node = node_class.create(own);
    }
  }

  ~ThreadTeam() override {
    if (!threads_.empty()) {
      step_ = nullptr;
      all_.arrive_and_wait();
    }
    for (std::thread& thread : threads_) {
      thread.join();
    }
  }

  void step(const Step& step) override {
    if (threads_.empty()) {
      start();
    }
    step_ = &step.plain();
    all_.arrive_and_wait();
    members_.front().step(step.plain());
    all_.arrive_and_wait();
    for (Member& member : members_) {
      if (member.failure) {
        std::rethrow_exception(std::exchange(member.failure, nullptr));
      }
    }
    put_together(step.plain());
  }

  /// The threads wait meanwhile.
  void change(std::string_view parameter, double value) override {
    for (Member& member : members_) {
      member.node->change(parameter, value);
    }
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> sums = members_.front().node->counters();
    for (std::size_t i = 1; i < members_.size(); ++i) {
      const std::vector<Counter> more = members_[i].node->counters();
      for (std::size_t k = 0; k < sums.size(); ++k) {
        sums[k].value += more[k].value;
      }
    }
    return sums;
  }

 private:
  /// Now, because a node that is only checked needs none.
  void start() {
    try {
      for (std::size_t i = 1; i < members_.size(); ++i) {
        threads_.emplace_back([this, i] { work(members_[i]); });
      }
    } catch (const std::system_error&) {
      for (std::size_t i = threads_.size() + 1; i < members_.size(); ++i) {
        all_.arrive_and_drop();  // for one that does not exist
      }
      throw std::runtime_error(
          fmt::format("only {} of {} threads could be started; write a smaller number of threads",
                      threads_.size() + 1, members_.size()));
    }
  }

  void work(Member& member) {
    for (all_.arrive_and_wait(); step_ != nullptr; all_.arrive_and_wait()) {
      member.step(*step_);
      all_.arrive_and_wait();
    }
  }

  void put_together(const spikeloop_step& whole) {
    for (std::size_t i = 0; i < whole.spike_output_count; ++i) {
      const auto& output = whole.spike_outputs[i];
      for (const Member& member : members_) {
        output.append(output.sink, member.spikes[i].data(), member.spikes[i].size());
      }
    }
    for (std::size_t i = 0; i < whole.signal_output_count; ++i) {
      auto& output = whole.signal_outputs[i];
      const bool changed = std::ranges::any_of(members_, [&](const Member& member) {
        return member.signal_outputs[i].revision != output.revision;
      });
      const bool invalid = members_.front().signal_outputs[i].revision == 0;
      output.revision = invalid ? 0 : output.revision + (changed ? 1 : 0);
    }
  }

  std::vector<Member> members_;
  std::vector<std::thread> threads_;
  std::barrier<> all_;                    ///< before and behind each step
  const spikeloop_step* step_ = nullptr;  ///< null: the threads end
};

void check(const NodeClass& node_class, const NodeSetup& setup, unsigned threads) {
  const std::uint64_t parts = std::uint64_t{setup.share.parts} * threads;
  if (parts == 1) {
    return;
  }
  if (!node_class.description.shareable) {
    throw std::logic_error("a node of the class " + node_class.description.name +
                           " cannot be shared out");
  }
  for (std::size_t i = 0; i < setup.widths.size(); ++i) {
    const PortDescription& port = node_class.description.ports[i];
    if (port.direction == Direction::output && setup.widths[i] < parts) {
      throw ConfigurationError(
          with_code(Code::music_job,
                    "port '{}' has {} channels, too few for {} parts (np times threads); write "
                    "smaller ones",
                    port.name, setup.widths[i], parts));
    }
  }
}

}  // namespace

std::unique_ptr<Node> make_node(const NodeClass& node_class, const NodeSetup& setup,
                                unsigned threads) {
  check(node_class, setup, threads);
  if (threads == 1) {
    return node_class.create(setup);
  }
  return std::make_unique<ThreadTeam>(node_class, setup, threads);
}

}  // namespace spikeloop
