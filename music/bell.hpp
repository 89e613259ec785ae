// A message wakes the program that waits for it. Open MPI's messages between the processes of a
// machine lie in shared memory, where a receiver finds them by looking. Every process of a job has
// a bell, which those that send to it ring.
#pragma once

#include <cstdint>

namespace spikeloop::bell {

/// Not a rank.
inline constexpr int kNobody = -1;

/// Whether the processes of this job have bells; without them the others do nothing.
bool exists();

/// How often our own bell has been rung.
std::uint32_t rings();

/// Sleeps until our own bell has been rung more often than `seen`, `length` nanoseconds at most.
void sleep(std::uint32_t seen, std::int64_t length);

/// Rings that of a rank of MPI_COMM_WORLD.
void ring(int rank);

/// This thread exchanges messages with a rank: whoever has something for it rings, until end().
void begin(int rank);
void end();

/// Whether this thread is between begin() and end().
bool will_ring();

/// At the begin of every wait: for what this thread has just sent, or answered.
void ring_partner();

}  // namespace spikeloop::bell
