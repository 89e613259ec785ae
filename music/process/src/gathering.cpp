#include "gathering.hpp"

#include <algorithm>
#include <numeric>
#include <vector>

namespace spikeloop::music {
namespace {

class SpikeGathering : public Node {
 public:
  explicit SpikeGathering(const Ranks& ranks)
      : ranks_(ranks), bytes_(static_cast<std::size_t>(ranks.count)), places_(bytes_.size()) {}

  void step(const Step& step) override {
    const auto own = step.spike_input().spikes;
    const int size = static_cast<int>(own.size_bytes());
    MPI_Gather(&size, 1, MPI_INT, bytes_.data(), 1, MPI_INT, 0, ranks_.communicator);
    std::exclusive_scan(bytes_.begin(), bytes_.end(), places_.begin(), 0);
    if (ranks_.rank == 0) {
      all_.resize(static_cast<std::size_t>(places_.back() + bytes_.back()) / sizeof(Spike));
    }
    MPI_Gatherv(own.data(), size, MPI_BYTE, all_.data(), bytes_.data(), places_.data(), MPI_BYTE, 0,
                ranks_.communicator);
    step.spike_output().emit(all_);
  }

 private:
  Ranks ranks_;
  std::vector<int> bytes_;   // of each process
  std::vector<int> places_;  // where they begin
  std::vector<Spike> all_;
};

class SignalGathering : public Node {
 public:
  SignalGathering(const Ranks& ranks, std::uint32_t width) : ranks_(ranks), all_(width) {
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(ranks.count); ++i) {
      const Share share{i, static_cast<std::uint32_t>(ranks.count)};
      counts_.push_back(static_cast<int>(share.count(width)));
      places_.push_back(static_cast<int>(share.begin(width)));
    }
  }

  void step(const Step& step) override {
    const SignalInput in = step.signal_input();
    const auto rank = static_cast<std::size_t>(ranks_.rank);
    MPI_Allgatherv(in.values.data() + places_[rank], counts_[rank], MPI_DOUBLE, all_.data(),
                   counts_.data(), places_.data(), MPI_DOUBLE, ranks_.communicator);
    const SignalOutput out = step.signal_output();
    if (in.valid() && (out.revision() == 0 || !std::ranges::equal(all_, out.values()))) {
      std::ranges::copy(all_, out.values().begin());
      out.commit();
    }
  }

 private:
  Ranks ranks_;
  std::vector<int> counts_;  // channels of each process
  std::vector<int> places_;
  std::vector<double> all_;
};

}  // namespace

NodeClass gathering_class(PortKind kind, const Ranks& ranks) {
  NodeDescription description;
  description.name = "gathering";
  description.text = "Puts together what the processes of a section compute";
  description.ports = {{"in", kind, Direction::input, {}, "This process's share"},
                       {"out", kind, Direction::output, WidthRule::same_as(0), "All channels"}};
  return {description, [kind, ranks](const NodeSetup& setup) -> std::unique_ptr<Node> {
            if (kind == PortKind::spikes) {
              return std::make_unique<SpikeGathering>(ranks);
            }
            return std::make_unique<SignalGathering>(ranks, setup.widths[0]);
          }};
}

}  // namespace spikeloop::music
