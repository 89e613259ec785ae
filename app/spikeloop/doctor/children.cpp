#include "children.hpp"

#include <fmt/format.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <span>
#include <thread>

#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/mpirun.hpp"
#include "spikeloop/processes/process_tree.hpp"
#include "spikeloop/processes/scratch_folder.hpp"

namespace spikeloop::app::doctor {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostOutput = 1'000'000;
constexpr std::chrono::milliseconds kLookEvery{5};

struct Child {
  std::unique_ptr<ProcessTree> tree{};  ///< none: it has ended, or was not started
  std::string err{};
  Answer answer{};
  bool is_running() const { return tree != nullptr; }
};

/// One read takes all that a pipe can hold; a program that prints for ever does not hold us up.
void read_some(int fd, std::string& text) {
  std::array<char, 65536> buffer;
  const auto size = read(fd, buffer.data(), buffer.size());
  if (size > 0 && text.size() < kMostOutput) {
    text.append(buffer.data(), static_cast<std::size_t>(size));
  }
}

/// mpirun's own exit codes are above 128: they are no signals.
std::string failure_of(int status, std::string_view said) {
  if (WIFSIGNALED(status)) {
    return fmt::format("it crashed ({})", strsignal(WTERMSIG(status)));
  }
  const int code = WEXITSTATUS(status);
  if (code == 0 || (code == 1 && !said.empty())) {  // that of any failure tells nothing
    return std::string(code == 0 ? "" : said);
  }
  return fmt::format("exit code {}{}{}", code, said.empty() ? "" : ": ", said);
}

/// Both pipes are read at every look: a full one would hold the program up.
void look(Child& child, double seconds) {
  const bool ended = child.tree->gone() || child.tree->status();
  read_some(child.tree->out(), child.answer.out);
  read_some(child.tree->err(), child.err);
  child.answer.seconds = seconds;
  if (ended) {
    const std::string_view said = last_line(child.err);
    child.answer.failure = failure_of(child.tree->status().value_or(0),
                                      said.empty() ? last_line(child.answer.out) : said);
    child.tree.reset();
  }
}

Child start(const Command& command, const ScratchFolder* scratch) {
  Child child;
  ProgramStart program{command, launch::program_environment(), "",
                       scratch == nullptr ? -1 : scratch->descriptor()};
  program.environment.erase("PYTHONPATH");  // a directory of ours is no simulator of its name
  program.environment["MPLBACKEND"] = "Agg";
  program.environment["PYTHONSAFEPATH"] = "1";  // no module of the working directory's
  program.environment.merge(launch::mpirun_environment());
  if (scratch != nullptr) {
    program.environment["OMPI_MCA_orte_tmpdir_base"] = scratch->path();
  }
  try {
    child.tree = std::make_unique<ProcessTree>(program);
  } catch (const Error& error) {
    child.answer.failure = error.what();
  }
  return child;
}

}  // namespace

std::string_view last_line(std::string_view text) {
  text = text.substr(0, text.find_last_not_of(" \r\n") + 1);
  return text.substr(text.rfind('\n') + 1);
}

namespace {

/// Runs all commands at the same time.
std::vector<Answer> ask_at_once(std::span<const Command> commands, const ScratchFolder* scratch) {
  const auto begin = Clock::now();
  std::vector<Child> children;
  for (const Command& command : commands) {
    children.push_back(command.empty() ? Child{} : start(command, scratch));
  }
  while (std::ranges::any_of(children, &Child::is_running) && Clock::now() < begin + kPatience) {
    std::this_thread::sleep_for(kLookEvery);
    for (Child& child : children) {
      if (child.is_running()) {
        look(child, std::chrono::duration<double>(Clock::now() - begin).count());
      }
    }
  }
  std::vector<Answer> answers;
  for (Child& child : children) {
    if (child.is_running()) {  // all at once: the end of a tree waits for its processes
      child.tree->kill();
      child.answer.in_time = false;
      child.answer.failure = fmt::format("no answer within {} s", kPatience.count());
    }
    answers.push_back(std::move(child.answer));
  }
  return answers;
}

/// Number of children that the limit of open files allows. Each child has two pipes and a
/// descriptor of its end.
std::size_t most_children() {
  constexpr rlim_t kOwnFiles = 16;
  constexpr rlim_t kFilesPerChild = 5;
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  return std::max<rlim_t>(1, (std::max(limit.rlim_cur, kOwnFiles) - kOwnFiles) / kFilesPerChild);
}

}  // namespace

std::vector<Answer> ask(const std::vector<Command>& commands, const ScratchFolder* scratch) {
  const std::size_t most = most_children();
  std::span<const Command> waiting(commands);
  std::vector<Answer> answers;
  while (!waiting.empty()) {
    const std::size_t count = std::min(most, waiting.size());
    std::ranges::move(ask_at_once(waiting.first(count), scratch), std::back_inserter(answers));
    waiting = waiting.subspan(count);
  }
  return answers;
}

}  // namespace spikeloop::app::doctor
