#include "spikeloop/launch/mpirun.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "spikeloop/launch/programs.hpp"
#include "spikeloop/processes/python.hpp"

namespace spikeloop::launch {
namespace {

namespace fs = std::filesystem;

bool is_program(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored) && access(path.c_str(), X_OK) == 0;
}

/// The number that follows `words`, if `line` has them.
std::optional<int> number_after(std::string_view line, std::string_view words) {
  const auto place = line.find(words);
  if (place == std::string_view::npos) {
    return std::nullopt;
  }
  const std::string rest(line.substr(place + words.size()));
  char* end = nullptr;
  const long number = std::strtol(rest.c_str(), &end, 10);
  return end == rest.c_str() ? std::nullopt : std::optional(static_cast<int>(number));
}

/// "[1,RANK]<stdout>:" or "[1,RANK]<stderr>:" at the begin of `text`.
struct Tag {
  int rank = -1;
  bool error = false;
  std::size_t size = 0;
};
std::optional<Tag> read_tag(std::string_view text) {
  std::size_t i = 1;
  const auto digits = [&] {
    const std::size_t begin = i;
    while (i < text.size() && i < begin + 9 && text[i] >= '0' && text[i] <= '9') {
      ++i;
    }
    return std::string(text.substr(begin, i - begin));
  };
  if (text.empty() || text[0] != '[' || digits().empty() || i >= text.size() || text[i++] != ',') {
    return std::nullopt;
  }
  const std::string rank = digits();
  const std::string_view rest = text.substr(i);
  const bool out = rest.starts_with("]<stdout>:");
  if (rank.empty() || !(out || rest.starts_with("]<stderr>:"))) {
    return std::nullopt;
  }
  return Tag{std::stoi(rank), !out, i + std::string_view("]<stdout>:").size()};
}

/// Place of the next tag in `text`, or its size.
std::size_t find_tag(std::string_view text) {
  std::size_t place = text.find('[');
  while (place != std::string_view::npos && !read_tag(text.substr(place))) {
    place = text.find('[', place + 1);
  }
  return std::min(place, text.size());
}

/// What Open MPI writes above and below its words, maybe in the middle of a program's line.
constexpr std::string_view kRule =
    "--------------------------------------------------------------------------";

/// "[HOST:PROCESS] ...": Open MPI speaks from inside a program, mostly of its crash.
bool is_mpi_speaking(std::string_view text) {
  const auto colon = text.find(':');
  const auto end = text.find("] ");
  if (!text.starts_with('[') || end == std::string_view::npos || colon == 1 || colon + 1 >= end) {
    return false;
  }
  const std::string_view process = text.substr(colon + 1, end - colon - 1);
  return text.substr(0, colon).find(' ') == std::string_view::npos &&
         process.find_first_not_of("0123456789") == std::string_view::npos;
}

constexpr const char* kMasterVariable = "ROS_MASTER_URI";
/// Where nodes of ROS 2 look for each other.
constexpr const char* kRos2Variables[] = {
    "ROS_DOMAIN_ID",    "ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_STATIC_PEERS", "CYCLONEDDS_URI",     "ROS_DISTRO"};

void add_if_set(const char* name, std::vector<std::string>& names) {
  if (std::getenv(name) != nullptr) {
    names.emplace_back(name);
  }
}

}  // namespace

std::vector<std::string> ros_variables() {
  std::vector<std::string> names;
  add_if_set(kMasterVariable, names);
  for (const char* name : kRos2Variables) {
    add_if_set(name, names);
  }
  return names;
}

std::vector<std::string> variables_of_job(const MusicFile& file) {
  std::vector<std::string> names{"PATH", "SPIKELOOP_FILE", "SPIKELOOP_FILE_NAME", "SPIKELOOP_OUT",
                                 "SPIKELOOP_STATUS"};
  if (needs_ros(file, 1)) {
    names.emplace_back(kMasterVariable);
  }
  if (needs_ros(file, 2)) {
    for (const char* name : kRos2Variables) {
      add_if_set(name, names);
    }
  }
  if (any_script(file)) {
    names.emplace_back("PYTHONPATH");
  }
  return names;
}

namespace {

/// LD_PRELOAD with one of our libraries, behind those of the user. Empty where the library is not
/// installed, or its path contains a separator.
std::string preloaded(const char* library) {
  const fs::path path = fs::path(own_directory()).parent_path() / "lib/spikeloop" / library;
  std::error_code error;
  if (!fs::exists(path, error) || path.string().find_first_of(" :") != std::string::npos) {
    return "";
  }
  const char* others = std::getenv("LD_PRELOAD");
  return others == nullptr ? path.string() : fmt::format("{}:{}", others, path.string());
}

/// LD_PRELOAD of a job's programs on this machine: music/waiting.cpp.
std::string preloaded_in_programs() {
  // Open MPI refuses -x in combination with a list of variables.
  return std::getenv("OMPI_MCA_mca_base_env_list") != nullptr
             ? ""
             : preloaded("libspikeloop_waiting.so");
}

}  // namespace

std::vector<std::string> mpirun_command(const MusicFile& file, const std::string& path,
                                        const Hosts& hosts) {
  std::vector<std::pair<std::string, std::string>> settings{
      {"mpi_yield_when_idle", "1"},
      // Who calls MPI_Abort says so itself: mpirun's own word of it is lost now and then ("Data
      // unpack would read past end of buffer").
      {"opal_abort_print_stack", "1"},
      // Open MPI's handler prints a trace, and hangs in it after a crash inside of malloc.
      {"opal_signal", ""}};
  if (!hosts.scratch.empty()) {
    settings.emplace_back("orte_tmpdir_base", hosts.scratch);
    settings.emplace_back("btl_vader_backing_directory", hosts.scratch);
  }
  if (hosts.hostfile.empty()) {
    // MPI looks at its sockets every 10 ms. It has none here, and music/waiting.cpp takes each look
    // for the end of a wait.
    settings.emplace_back("mpi_event_tick_rate", "1000000");  // microseconds
    // The search for networks of clusters takes 0.2 s, and programs would listen on all addresses
    // of the machine.
    if (std::getenv("OMPI_MCA_pml") == nullptr && std::getenv("OMPI_MCA_btl") == nullptr) {
      settings.emplace_back("pml", "ob1");
      settings.emplace_back("btl", "vader,self");
    }
  }
  // Waiting programs ask again and again: without yielding and free placement they starve each
  // other.
  std::vector<std::string> command{
      "mpirun",          "-np",       std::to_string(file.total_processes()),
      "--oversubscribe", "--bind-to", "none"};
  for (const auto& [name, value] : settings) {
    command.insert(command.end(), {"--mca", name, value});
  }
  if (!hosts.hostfile.empty()) {
    command.insert(command.end(), {"--hostfile", hosts.hostfile});
    for (const std::string& name : hosts.variables) {
      command.insert(command.end(), {"-x", name});
    }
  } else if (const std::string libraries = preloaded_in_programs(); !libraries.empty()) {
    command.insert(command.end(), {"-x", "LD_PRELOAD=" + libraries});
  }
  command.insert(command.end(), {"--tag-output", "music", path});
  return command;
}

std::map<std::string, std::string> mpirun_environment() {
  std::map<std::string, std::string> environment;
  if (const std::string libraries = preloaded("libspikeloop_mpirun.so"); !libraries.empty()) {
    environment["LD_PRELOAD"] = libraries;
  }
  if (std::getenv("PMIX_MCA_gds") == nullptr) {
    environment["PMIX_MCA_gds"] = "hash";  // other modules need 8 MB of shared memory
  }
  return environment;
}

std::string multi_prog_text(const MusicFile& file, const std::string& path) {
  std::string text = "# for: srun --multi-prog; ranks, program\n";
  int first = 0;
  for (const MusicSection& section : file.sections) {
    const MusicKey* binary = file.find_key(section, "binary");
    const MusicKey* wd = file.find_key(section, "wd");
    const int last = first + file.processes(section) - 1;
    // MUSIC crashes when --music-config is the last argument.
    std::string program = shell_text({binary == nullptr ? "" : binary->value, "--music-config",
                                      path, "--app-label", section.label});
    if (wd != nullptr) {
      program = shell_text(
          {"sh", "-c", fmt::format("cd {} && exec {}", shell_text({wd->value}), program)});
    }
    text += fmt::format(
        "{}  {}\n", first == last ? fmt::format("{}", first) : fmt::format("{}-{}", first, last),
        program);
    first = last + 1;
  }
  return text;
}

std::vector<std::string> srun_command(const MusicFile& file, const std::string& multi_prog,
                                      const std::string& directory) {
  return {"srun",
          "-n",
          std::to_string(file.total_processes()),
          "--mpi=pmix",
          "--overcommit",
          "--cpu-bind=none",
          "--kill-on-bad-exit=1",
          "--chdir",
          directory,
          "--export",
          "ALL,OMPI_MCA_mpi_yield_when_idle=1",
          "--multi-prog",
          multi_prog};
}

std::map<std::string, std::string> program_environment() {
  const char* path = std::getenv("PATH");
  std::map<std::string, std::string> environment;
  environment["PATH"] = own_directory() + (path == nullptr ? "" : fmt::format(":{}", path));
  environment["PYTHONPATH"] = python_path();
  if (std::getenv("PYTHONUNBUFFERED") == nullptr) {
    environment["PYTHONUNBUFFERED"] = "1";  // what scripts print is shown when they print it
  }
  if (std::getenv("HWLOC_COMPONENTS") == nullptr) {
    // hwloc looks for graphics cards on the X displays 0 to 9; one that goes meanwhile ends mpirun.
    environment["HWLOC_COMPONENTS"] = "-gl";
  }
  if (geteuid() == 0) {
    environment["OMPI_ALLOW_RUN_AS_ROOT"] = "1";
    environment["OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"] = "1";
  }
  return environment;
}

std::string find_executable(const std::string& program, const std::string& directory,
                            const std::string& path) {
  if (program.find('/') != std::string::npos) {
    const fs::path whole = fs::path(directory) / program;
    return is_program(whole) ? whole.string() : "";
  }
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find(':', begin), path.size());
    // An empty entry is the working directory.
    const std::string entry = end == begin ? "." : path.substr(begin, end - begin);
    const fs::path whole = fs::path(directory) / entry / program;
    if (!program.empty() && is_program(whole)) {
      return whole.string();
    }
    begin = end + 1;
  }
  return "";
}

std::string label_of_rank(const MusicFile& file, int rank) {
  for (const MusicSection& section : file.sections) {
    const int processes = file.processes(section);
    if (rank < processes) {
      return section.label;
    }
    rank -= processes;
  }
  return "";
}

std::string shell_text(const std::vector<std::string>& arguments) {
  std::vector<std::string> quoted;
  for (const std::string& argument : arguments) {
    const bool plain = !argument.empty() && argument.find_first_not_of(
                                                "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwx"
                                                "yz0123456789_-./=:,+@%") == std::string::npos;
    std::string text = argument;
    for (std::size_t i = text.find('\''); i != std::string::npos; i = text.find('\'', i + 4)) {
      text.replace(i, 1, "'\\''");
    }
    quoted.push_back(plain ? text : fmt::format("'{}'", text));
  }
  return fmt::format("{}", fmt::join(quoted, " "));
}

void TaggedOutput::feed(std::string_view bytes) {
  unfinished_ += bytes;
  std::size_t begin = 0;
  for (std::size_t end = unfinished_.find('\n'); end != std::string::npos;
       end = unfinished_.find('\n', begin)) {
    take_line(std::string_view(unfinished_).substr(begin, end - begin));
    begin = end + 1;
  }
  unfinished_.erase(0, begin);
}

void TaggedOutput::take_line(std::string_view line) {
  if (line.ends_with('\r')) {  // as ssh ends its lines
    line.remove_suffix(1);
  }
  Source source{-1, error_};
  while (true) {
    const std::size_t size = find_tag(line);
    pieces_[source] += line.substr(0, size);
    line.remove_prefix(size);
    const auto tag = read_tag(line);
    if (!tag) {
      break;
    }
    line.remove_prefix(tag->size);
    // Nothing stood before the line's first tag.
    if (source.rank == -1 && pieces_[source].empty()) {
      pieces_.erase(source);
    }
    source = {tag->rank, tag->error};
  }
  std::string& text = pieces_[source];
  const std::size_t own = text.size() - std::min(text.size(), kRule.size());
  if (source.rank >= 0 && own > 0 && text[own - 1] != '-' && text.ends_with(kRule)) {
    text.resize(own);
    handler_({std::nullopt, error_, std::string(kRule)});
  } else {
    flush(source);
  }
}

void TaggedOutput::flush(const Source& source) {
  std::string text = std::move(pieces_[source]);
  pieces_.erase(source);
  const bool own = source.rank < 0 || is_mpi_speaking(text);
  OutputLine line{own ? std::nullopt : std::optional(source.rank), source.error, std::move(text)};
  if (own && source.rank >= 0) {
    line.speaker = source.rank;
  }
  handler_(std::move(line));
}

void TaggedOutput::finish() {
  if (!unfinished_.empty()) {
    feed("\n");
  }
  while (!pieces_.empty()) {
    flush(pieces_.begin()->first);
  }
}

void MpirunDiagnosis::read(std::string_view line) {
  if (signal_ || exit_code_) {
    return;
  }
  if (const auto rank = number_after(line, "mpirun noticed that process rank ")) {
    rank_ = rank;
    signal_ = number_after(line, "exited on signal ");
  } else if (const auto improper = number_after(line, "mpirun has exited due to process rank ")) {
    rank_ = improper;
  } else if (const auto aborted = number_after(line, "MPI_ABORT was invoked on rank ")) {
    rank_ = aborted;
  } else if (line.find("Process name: [[") != std::string_view::npos) {
    rank_ = number_after(line.substr(line.find("],")), "],");
  } else if (rank_) {
    const auto code = number_after(line, "Exit code:");
    exit_code_ = code ? code : number_after(line, "with errorcode ");
  }
}

}  // namespace spikeloop::launch
