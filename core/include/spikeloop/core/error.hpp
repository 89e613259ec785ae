// One kind of exception a kind of fault. Libraries throw; programs print `what()` once and exit
// with `exit_code()`. Every message says what happened, the value, and what to write instead.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace spikeloop {

/// Where in a text file something stands; line and column count from 1, 0 means unknown.
struct Location {
  std::string file;
  int line = 0;
  int column = 0;

  /// "loop.music:12:5", as far as known; empty when nothing is known.
  std::string text() const;
};

/// Text for one line of a terminal: line ends are blanks, other control characters '?', the middle
/// of more than 2000 bytes is left out. Values that a user wrote may hold anything.
std::string one_line(std::string_view text);

/// Base of every exception Spikeloop throws on purpose.
class Error : public std::runtime_error {
 public:
  /// The message becomes one line.
  explicit Error(std::string_view message) : std::runtime_error(one_line(message)) {}
  /// Puts the location before the message.
  Error(const Location& where, std::string_view message);
  virtual int exit_code() const = 0;
  /// Whether the message begins with where in a file the fault is.
  bool located() const { return where_ != nullptr; }
  /// That place; nothing is known when not located().
  Location where() const { return where_ ? *where_ : Location{}; }

 private:
  std::shared_ptr<const Location> where_;  // copying an exception must not throw
};

/// A file, key, value, width or connection that cannot be run as written.
class ConfigurationError : public Error {
 public:
  using Error::Error;
  int exit_code() const override { return 2; }
};

/// A partner outside (ROS master, MUSIC, another process) is missing, silent or broken.
class TransportError : public Error {
 public:
  static constexpr int kExitCode = 3;
  using Error::Error;
  int exit_code() const override { return kExitCode; }
};

/// A file could not be read or written.
class FileError : public Error {
 public:
  static constexpr int kExitCode = 4;
  /// "cannot open 'x.json': No such file or directory"; takes the reason from `error_number`.
  FileError(std::string_view action, std::string_view path, int error_number);
  using Error::Error;
  int exit_code() const override { return kExitCode; }
};

/// Messages arrived, and none of them was usable.
class UnusableMessages : public Error {
 public:
  static constexpr int kExitCode = 7;
  using Error::Error;
  int exit_code() const override { return kExitCode; }
};

/// Code that a file names is not run (`spikeloop check --no-code`): what depends on it is not
/// checked. No fault of the file's.
class NotRun : public Error {
 public:
  using Error::Error;
  int exit_code() const override { return 0; }
};

/// `spikeloop check --no-code` sets this variable, for the programs that it starts too.
inline constexpr const char* kNoCode = "SPIKELOOP_NO_CODE";
/// To be called before code is run that a file names. @throws NotRun when kNoCode is set.
void require_code_may_run(std::string_view what);

/// Inside of its handler: the same error with this place, when it says none.
template <typename Kind>
[[noreturn]] void throw_located(const Kind& error, const Location& where) {
  if (error.located()) {
    throw;
  }
  throw Kind(where, error.what());
}

/// What `work` returns; an error of its that says no place gets this one.
template <typename Work>
auto located_at(const Location& where, Work&& work) {
  try {
    return work();
  } catch (const ConfigurationError& error) {
    throw_located(error, where);
  } catch (const FileError& error) {
    throw_located(error, where);
  } catch (const TransportError& error) {
    throw_located(error, where);
  } catch (const NotRun& error) {
    throw_located(error, where);
  }
}

/// A node failed while it ran; carries the node's name.
class NodeError : public Error {
 public:
  NodeError(std::string_view node, std::string_view message);
  int exit_code() const override { return 5; }
};

/// The candidate nearest to `word` when it is near enough to be a slip, else empty.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// "; did you mean 'tau'?" or, when nothing is near, "; known: a, b, c". Ends an error message.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

/// "the host name 'robot' cannot be resolved (REASON); add the line 'IP-ADDRESS robot' to
/// /etc/hosts", with the address of localhost, which bare containers have no line for.
std::string unresolved_host(std::string_view host, std::string_view reason);

}  // namespace spikeloop
