// How the processes of a job tell the launcher what they do: JSON datagrams over a Unix socket.
// docs/architecture.md lists the messages.
#pragma once

#include <chrono>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "spikeloop/core/time.hpp"
#include "spikeloop/processes/descriptor.hpp"

namespace spikeloop::status {

/// The environment variable that holds the path of the launcher's socket.
inline constexpr const char* kSocketVariable = "SPIKELOOP_STATUS";

/// What a process does at the moment.
enum class Phase {
  preparing,   ///< reads its files, builds what it runs
  meeting,     ///< waits for the other programs to be ready
  waiting,     ///< waits for the clock
  computing,   ///< its own step
  exchanging,  ///< in MUSIC, which may wait for the others
  finalizing,  ///< has left its loop
};
const char* name_of(Phase phase);
/// Nothing for another name.
std::optional<Phase> phase_named(std::string_view name);

/// Key of a report's summary: why the robot stood before the end of the run stopped it, when it did
/// for want of data. Such a run has failed.
inline constexpr const char* kStoodAtEnd = "stood_at_end";

/// How far a process came.
struct Reached {
  TimeNs simulated = 0;
  TimeNs wall = 0;
  std::uint64_t overruns = 0;
};

/// Adds a summary to those of other processes or commands: counts add up, of latencies and of the
/// time that the robot stood the largest counts, and of all else the last one.
void add_summary(const nlohmann::json& summary, nlohmann::json& sum);

/// The reporting side, one a process. Without a launcher, or when it has gone, every call does
/// nothing. No call throws, and all may be used from any thread.
class Sender {
 public:
  /// `process` is the section's label. Reads SPIKELOOP_STATUS.
  explicit Sender(std::string process);

  /// Whether there is a launcher to tell anything.
  bool connected() const { return socket_.get() >= 0; }
  /// From now on nothing is told: another process of the section does.
  void silence() { socket_.reset(); }

  /// After MUSIC's Setup. Waits up to 1 s for room.
  void started() const;
  /// When the loop has begun. Waits up to 10 ms for room.
  void first_tick() const;
  /// Never waits: dropped when there is no room. The members of the object `extra` are added.
  void progress(const Reached& reached, const nlohmann::json& extra = {}) const;
  /// A heartbeat, in every phase. Never waits.
  void alive(Phase phase, TimeNs simulated) const;
  /// Once at the end. Waits up to 1 s for room. A report that does not fit a datagram (at least
  /// 200 kB do) is replaced by one whose member `too_large` holds its size. With `reached`, how far
  /// the process came: the last progress may have been dropped.
  void report(const nlohmann::json& counters, const nlohmann::json& summary,
              const std::optional<Reached>& reached = std::nullopt) const;
  /// SIGTERM ends the process. Never waits.
  void terminated() const;
  /// Before the process ends because of an error. Waits up to 1 s for room; a message longer than
  /// 64 kB is cut.
  void failure(int exit_code, std::string_view message) const;

 private:
  nlohmann::json message(const char* type) const;

  std::string process_;
  Descriptor socket_;
};

/// The launcher's side: makes the socket, and removes it at its end.
class Receiver {
 public:
  /// @throws FileError when the socket cannot be made at `path` (at most 107 bytes long).
  explicit Receiver(const std::string& path);
  ~Receiver();
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  /// The next message, which is an object with the strings `type` and `process`; nothing when none
  /// came in time. Whatever else arrives is passed over.
  std::optional<nlohmann::json> next(std::chrono::milliseconds timeout);
  /// Readable when a message waits.
  int fd() const { return socket_.get(); }

 private:
  std::string path_;
  Descriptor socket_;
};

}  // namespace spikeloop::status
