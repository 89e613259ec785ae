// MUSIC ports as sources and sinks. Every connection gets maxBuffered 1 on our side: MUSIC's
// default would batch up to a whole run.
#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "process_impl.hpp"
#include "spikeloop/process/transfer.hpp"

namespace spikeloop::music {
namespace {

constexpr int kMaxBuffered = 1;

// A block of doubles that MUSIC reads or writes at its ticks; NaN until somebody writes.
class ContBuffer {
 public:
  /// Of the port's channels from `first` on.
  explicit ContBuffer(std::uint32_t width, std::uint32_t first = 0)
      : values(width, std::numeric_limits<double>::quiet_NaN()),
        data(values.data(), MPI_DOUBLE, static_cast<int>(first), static_cast<int>(width)) {}

  std::vector<double> values;
  MUSIC::ArrayData data;
};

class SignalSource : public Source {
 public:
  SignalSource(MUSIC::Setup& setup, const std::string& name, const EndpointPort& port, TimeNs delay)
      : port_(port), buffer_(port.width), block_(port.width) {
    constexpr bool kInterpolate = false;  // whole ticks: exact
    setup.publishContInput(name)->map(&buffer_.data, music_seconds(delay), kMaxBuffered,
                                      kInterpolate);
  }
  std::vector<EndpointPort> ports() const override { return {port_}; }

  void receive(const Step& step) override {
    if (!block_.update(buffer_.values)) {
      return;
    }
    auto& out = step.plain().signal_outputs[0];
    std::copy(block_.values().begin(), block_.values().end(), out.values);
    out.revision = block_.revision();
  }

 private:
  EndpointPort port_;
  ContBuffer buffer_;
  SignalBlock block_;
};

class SpikeSource : public Source, private MUSIC::EventHandlerGlobalIndex {
 public:
  SpikeSource(MUSIC::Setup& setup, const EndpointPort& port, TimeNs accept_latency, TimeNs delay)
      : port_(port), inbox_(port.width) {
    if (delay != 0) {
      delay_.emplace(delay);
    }
    // A foreign sender may map fewer or more channels than the file says. The wildcard takes
    // whatever comes, and the inbox counts what does not belong.
    MUSIC::LinearIndex any(0, MUSIC::Index::WILDCARD_MAX);
    setup.publishEventInput(port.name)->map(&any, this, music_seconds(accept_latency),
                                            kMaxBuffered);
  }
  std::vector<EndpointPort> ports() const override { return {port_}; }

  void receive(const Step& step) override {
    step.spike_output().emit(delay_ ? delay_->pass(inbox_.spikes(), step.interval())
                                    : inbox_.spikes());
    inbox_.clear();
  }
  std::vector<Counter> counters() const override {
    return {{"events_outside_port", inbox_.outside_port()},
            {"events_without_time", inbox_.without_time()}};
  }

 private:
  void operator()(double time, MUSIC::GlobalIndex id) override { inbox_.add(time, id); }

  EndpointPort port_;
  SpikeInbox inbox_;
  std::optional<SpikeDelay> delay_;
};

class SignalSink : public Sink {
 public:
  SignalSink(MUSIC::Setup& setup, const std::string& name, const EndpointPort& port,
             const Ranks& ranks)
      : port_(port),
        first_(ranks.share().begin(port.width)),
        buffer_(ranks.share().count(port.width), first_) {
    setup.publishContOutput(name)->map(&buffer_.data, kMaxBuffered);
  }
  std::vector<EndpointPort> ports() const override { return {port_}; }

  void send(const Step& step) override {
    const SignalInput input = step.signal_input();
    if (input.revision == revision_) {
      return;  // MUSIC takes the block as it is
    }
    revision_ = input.revision;
    if (input.valid()) {
      std::ranges::copy(input.values.subspan(first_, buffer_.values.size()),
                        buffer_.values.begin());
    } else {
      std::fill(buffer_.values.begin(), buffer_.values.end(),
                std::numeric_limits<double>::quiet_NaN());
    }
  }

 private:
  EndpointPort port_;
  std::uint32_t first_;
  ContBuffer buffer_;
  std::uint64_t revision_ = 0;  // nothing yet: the block is NaN
};

class SpikeSink : public Sink {
 public:
  SpikeSink(MUSIC::Setup& setup, const EndpointPort& port, bool stamp_guard, const Ranks& ranks)
      : port_(port), guarded_(stamp_guard), music_port_(setup.publishEventOutput(port.name)) {
    if (ranks.rank == 0) {
      MUSIC::LinearIndex all(0, static_cast<int>(port.width));
      music_port_->map(&all, MUSIC::Index::GLOBAL, kMaxBuffered);
    } else {
      MUSIC::GlobalIndex none = 0;
      MUSIC::PermutationIndex nothing(&none, 0);  // an empty LinearIndex ends the job
      music_port_->map(&nothing, MUSIC::Index::GLOBAL, kMaxBuffered);
    }
  }
  std::vector<EndpointPort> ports() const override { return {port_}; }

  void send(const Step& step) override {
    const Interval interval = step.interval();
    for (const Spike& spike : step.spike_input().spikes) {
      TimeNs stamp = spike.time_ns;
      if (guarded_) {
        stamp = guarded_stamp(stamp, interval);
        moved_ += stamp != spike.time_ns ? 1 : 0;
      }
      music_port_->insertEvent(music_seconds(stamp), MUSIC::GlobalIndex(spike.channel));
    }
  }
  std::vector<Counter> counters() const override { return {{"stamps_moved", moved_}}; }

 private:
  EndpointPort port_;
  bool guarded_;
  MUSIC::EventOutputPort* music_port_;  // MUSIC's; its destructor must not run
  std::uint64_t moved_ = 0;
};

}  // namespace

std::unique_ptr<Source> make_signal_source(MUSIC::Setup& setup, const std::string& name,
                                           const EndpointPort& port, TimeNs delay) {
  return std::make_unique<SignalSource>(setup, name, port, delay);
}
std::unique_ptr<Source> make_spike_source(MUSIC::Setup& setup, const EndpointPort& port,
                                          TimeNs accept_latency, TimeNs delay) {
  return std::make_unique<SpikeSource>(setup, port, accept_latency, delay);
}
std::unique_ptr<Sink> make_signal_sink(MUSIC::Setup& setup, const std::string& name,
                                       const EndpointPort& port, const Ranks& ranks) {
  return std::make_unique<SignalSink>(setup, name, port, ranks);
}
std::unique_ptr<Sink> make_spike_sink(MUSIC::Setup& setup, const EndpointPort& port,
                                      bool stamp_guard, const Ranks& ranks) {
  return std::make_unique<SpikeSink>(setup, port, stamp_guard, ranks);
}

}  // namespace spikeloop::music
