// A message wakes the program that waits for it. Open MPI's messages between the processes of a
// machine lie in shared memory, where a receiver finds them by looking. Every process of a job has
// a bell, which those that send to it ring.
#pragma once

#include <cstdint>

namespace spikeloop::bell {

/// Instead of a rank of MPI_COMM_WORLD.
inline constexpr int kNobody = -1;

/// Whether the processes of this job have bells.
bool exists();

/// How often our own bell has been rung; 0 without bells.
std::uint32_t rings();

/// Sleeps until our own bell has been rung more often than `seen`, `length` nanoseconds at most.
/// Only where bells exist.
void sleep(std::uint32_t seen, std::int64_t length);

/// This thread begins, or ends, to exchange a message with a rank, its partner. With kNobody
/// nothing begins.
void begin(int rank);
void end();

/// Whether this thread exchanges a message with a partner that has a bell, and so rings ours.
bool will_be_rung();

/// Whether a message has been begun since this was last asked.
bool has_begun();

/// Rings the bell of the rank of the last begin().
void ring_partner();

}  // namespace spikeloop::bell
