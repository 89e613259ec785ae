#include "renewable_node.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "thread_team.hpp"

namespace spikeloop {

namespace {

class RenewableNode final : public Node {
 public:
  RenewableNode(const NodeClass& node_class, const NodeSetup& setup, unsigned threads)
      : class_(node_class),
        setup_(setup),
        threads_(threads),
        node_(make_node(class_, setup_, threads_)) {}

  void step(const Step& step) override {
    if (setup_.episode == 1) {
      node_->step(step);
      revisions_.resize(step.plain().signal_output_count);
      for (std::size_t i = 0; i < revisions_.size(); ++i) {
        revisions_[i].latest = std::max(revisions_[i].latest, step.signal_output(i).revision());
      }
      return;
    }
    spikeloop_step own = step.plain();
    own.begin_ns -= begin_;
    own.end_ns -= begin_;
    take_spikes(own);
    prepare_outputs(own);
    node_->step(Step(own));
    pass_revisions(step.plain());
    renewed_ = false;
  }

  void change(std::string_view parameter, double value) override {
    node_->change(parameter, value);
    changes_[std::string(parameter)] = value;
  }

  void reset(TimeNs now) override {
    past_ = counters();
    begin_ = now;
    renewed_ = true;
    ++setup_.episode;
    node_ = make_node(class_, setup_, threads_);
    for (const auto& [parameter, value] : changes_) {
      node_->change(parameter, value);
    }
    for (Revisions& each : revisions_) {
      each.before = each.latest;
    }
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> sums = node_->counters();
    for (std::size_t i = 0; i < past_.size(); ++i) {
      sums[i].value += past_[i].value;
    }
    return sums;
  }

 private:
  // The revisions of an output; those who read it must never see one of them again.
  struct Revisions {
    std::uint64_t before = 0;  // that the nodes before this one have used
    std::uint64_t latest = 0;
  };

  // An output for spikes whose times count from the node's begin.
  struct SpikeOutlet {
    spikeloop_spike_output* port = nullptr;
    TimeNs begin = 0;
    std::vector<Spike> shifted{};

    static void append(void* sink, const Spike* spikes, std::uint64_t count) {
      auto& self = *static_cast<SpikeOutlet*>(sink);
      self.shifted.assign(spikes, spikes + count);
      for (Spike& spike : self.shifted) {
        spike.time_ns += self.begin;
      }
      self.port->append(self.port->sink, self.shifted.data(), count);
    }
  };

  void take_spikes(spikeloop_step& own) {
    arrived_.resize(own.spike_input_count);
    spike_inputs_.assign(own.spike_inputs, own.spike_inputs + own.spike_input_count);
    for (std::size_t i = 0; i < arrived_.size(); ++i) {
      spikeloop_spike_input& input = spike_inputs_[i];
      arrived_[i].assign(input.spikes, input.spikes + input.count);
      for (Spike& spike : arrived_[i]) {
        spike.time_ns -= begin_;
      }
      input.spikes = arrived_[i].data();
    }
    own.spike_inputs = spike_inputs_.data();
  }

  void prepare_outputs(spikeloop_step& own) {
    outlets_.resize(own.spike_output_count);
    spike_outputs_.clear();
    for (std::size_t i = 0; i < outlets_.size(); ++i) {
      outlets_[i].port = &own.spike_outputs[i];
      outlets_[i].begin = begin_;
      spike_outputs_.push_back({&outlets_[i], &SpikeOutlet::append, own.spike_outputs[i].width, 0});
    }
    own.spike_outputs = spike_outputs_.data();
    signal_outputs_.assign(own.signal_outputs, own.signal_outputs + own.signal_output_count);
    revisions_.resize(own.signal_output_count);
    for (std::size_t i = 0; i < signal_outputs_.size(); ++i) {
      spikeloop_signal_output& output = signal_outputs_[i];
      if (renewed_) {
        output.revision = 0;
        std::fill_n(output.values, output.width, 0.0);
      } else if (output.revision != 0) {
        output.revision -= revisions_[i].before;
      }
    }
    own.signal_outputs = signal_outputs_.data();
  }

  void pass_revisions(const spikeloop_step& whole) {
    for (std::size_t i = 0; i < signal_outputs_.size(); ++i) {
      const std::uint64_t own = signal_outputs_[i].revision;
      const std::uint64_t passed = own == 0 ? 0 : own + revisions_[i].before;
      whole.signal_outputs[i].revision = passed;
      revisions_[i].latest = std::max(revisions_[i].latest, passed);
    }
  }

  const NodeClass& class_;
  NodeSetup setup_;
  unsigned threads_;
  std::unique_ptr<Node> node_;
  TimeNs begin_ = 0;      // of the node's time
  bool renewed_ = false;  // since the last step
  std::vector<Counter> past_;
  std::map<std::string, double, std::less<>> changes_;
  std::vector<Revisions> revisions_;
  std::vector<std::vector<Spike>> arrived_;
  std::vector<spikeloop_spike_input> spike_inputs_;
  std::vector<SpikeOutlet> outlets_;
  std::vector<spikeloop_spike_output> spike_outputs_;
  std::vector<spikeloop_signal_output> signal_outputs_;
};

}  // namespace

std::unique_ptr<Node> make_renewable_node(const NodeClass& node_class, const NodeSetup& setup,
                                          unsigned threads) {
  if (node_class.description.reset != Reset::made_again) {
    return make_node(node_class, setup, threads);
  }
  return std::make_unique<RenewableNode>(node_class, setup, threads);
}

}  // namespace spikeloop
