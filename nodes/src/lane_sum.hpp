// The order in which nodes add up products. Every result must be the same on every machine and for
// every form in which a weight table is written, so no library's matrix product is used.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace spikeloop {

/// Term j goes to lane j % 8 in ascending order of j, and the lanes are added in a fixed tree.
/// Terms that are 0 may be left out without changing a bit of the total: a lane begins with +0,
/// which adding +0 or -0 leaves as it is. So sparse and dense tables give the same results.
class LaneSum {
 public:
  static constexpr std::size_t kLanes = 8;

  void add(std::size_t index, double term) { lanes_[index % kLanes] += term; }

  /// Adds a[j] * b[j] for all j; both have one length.
  void add_products(std::span<const double> a, std::span<const double> b) {
    const std::size_t whole = a.size() - a.size() % kLanes;
    std::array<double, kLanes> lanes = lanes_;  // a copy that can live in registers
    for (std::size_t j = 0; j < whole; j += kLanes) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        lanes[lane] += a[j + lane] * b[j + lane];
      }
    }
    lanes_ = lanes;
    for (std::size_t j = whole; j < a.size(); ++j) {
      add(j, a[j] * b[j]);
    }
  }

  double total() const {
    return ((lanes_[0] + lanes_[4]) + (lanes_[2] + lanes_[6])) +
           ((lanes_[1] + lanes_[5]) + (lanes_[3] + lanes_[7]));
  }

 private:
  std::array<double, kLanes> lanes_{};
};

}  // namespace spikeloop
