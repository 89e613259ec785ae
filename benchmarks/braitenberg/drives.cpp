// Drives as many vehicles as standard input has lines; fit_weights.py writes them.
//
//   seed delay_ms first_phase  (offset minimum maximum 100 weights) of the speed, then of the yaw
//   rate
//
// Prints a line each: collisions mean_speed_m_s coverage
#include <cstdio>
#include <iostream>
#include <sstream>

#include "benchmarks/braitenberg/drive.hpp"

int main() {
  using namespace spikeloop;
  for (std::string line; std::getline(std::cin, line);) {
    std::istringstream numbers(line);
    braitenberg::Drive drive;
    double delay_ms = 0;
    numbers >> drive.seed >> delay_ms >> drive.first_phase;
    drive.delay = from_seconds(delay_ms / 1000);
    braitenberg::Readout readout;
    for (auto& channel : readout.channels) {
      channel.weights.resize(braitenberg::kBeams);
      numbers >> channel.offset >> channel.minimum >> channel.maximum;
      for (double& weight : channel.weights) {
        numbers >> weight;
      }
    }
    if (!numbers) {
      std::fprintf(stderr, "braitenberg_drives: a line has too few numbers, or other text\n");
      return 2;
    }
    const auto result = braitenberg::drive(readout, drive);
    std::printf("%d %.4f %.4f\n", static_cast<int>(result.collisions), result.mean_speed_m_s,
                result.coverage);
    std::fflush(stdout);
  }
  return 0;
}
