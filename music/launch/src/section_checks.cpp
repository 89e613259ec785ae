#include "section_checks.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <string.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string_view>

#include "spikeloop/config/dialect.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/launch/folders.hpp"
#include "spikeloop/launch/programs.hpp"
#include "spikeloop/processes/python.hpp"
#include "spikeloop/processes/scratch_folder.hpp"

namespace spikeloop::launch {
namespace {

namespace fs = std::filesystem;

/// Large weight files take their time.
constexpr Milliseconds kCheckDeadline{60'000};
constexpr std::string_view kError = "error: ";
constexpr std::string_view kWarning = "warning: ";

/// Also where the section does not say which of our programs it is.
bool has_our_name(const MusicFile& file, const MusicSection& section) {
  const std::string name = program_of(section);
  return find_program(file, section) != nullptr || name == "spikeloop-node" ||
         name == "spikeloop-ros" || name == "spikeloop-zmq";
}

/// Another program may have the name of one of ours; that one we must not start. Empty: none.
std::string own_program(const MusicFile& file, const MusicSection& section,
                        const std::string& directory) {
  const MusicKey* binary = file.find_key(section, "binary");
  std::error_code ignored;
  if (binary == nullptr || !has_our_name(file, section) || !fs::is_directory(directory, ignored)) {
    return "";
  }
  const std::string path =
      find_executable(binary->value, directory, program_environment().at("PATH"));
  return !path.empty() && fs::equivalent(fs::path(path).parent_path(), own_directory(), ignored)
             ? path
             : "";
}

}  // namespace

std::map<std::string, std::string> origin_environment(const std::string& file) {
  auto environment = program_environment();
  std::error_code ignored;
  environment["SPIKELOOP_FILE"] = fs::absolute(file, ignored).string();
  environment["SPIKELOOP_FILE_NAME"] = file;
  return environment;
}

SectionChecks::SectionChecks(ProcessGroup& group, const MusicFile& file, const Places& places)
    : group_(group), file_(file) {
  for (const MusicSection* section : in_written_order(file)) {
    start(*section, places);
  }
}

void SectionChecks::start(const MusicSection& section, const Places& places) {
  const std::string directory = working_directory(file_, section, places.directory);
  const std::string program = own_program(file_, section, directory);
  if (program.empty() || (places.experiment && program_of(section) == "spikeloop-fused")) {
    return;
  }
  ProgramStart start;
  start.arguments = {program, "--check-section", places.effective_file, section.label};
  start.environment = origin_environment(file_.path);
  start.directory = directory;
  start.kept = places.kept;
  sections_.push_back({section.label});
  Section& added = sections_.back();
  added.process =
      &group_.start(start, [this, &added](const OutputLine& line) { take(added, line); });
}

/// What says its place in the file needs no label.
Diagnostic SectionChecks::diagnostic(const Section& section, std::string text,
                                     int exit_code) const {
  Location where{file_.path};
  std::string_view rest = text;
  const auto take_number = [&rest](int& number) {
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
    if (error == std::errc()) {
      const auto length = static_cast<std::size_t>(end - rest.data()) + 1;  // with the colon
      rest.remove_prefix(std::min(length, rest.size()));
    }
  };
  const std::string named = file_.path + ":";
  if (text.starts_with(named)) {
    rest.remove_prefix(named.size());
    take_number(where.line);
    take_number(where.column);
    return {where, std::string(rest.substr(std::min<std::size_t>(1, rest.size()))), exit_code};
  }
  return {{}, fmt::format("{}: {}", section.label, text), exit_code};
}

void SectionChecks::take(Section& section, const OutputLine& line) const {
  const auto found = [&](std::string_view kind, int exit_code) {
    return diagnostic(section, line.text.substr(kind.size()), exit_code);
  };
  if (line.text.starts_with(kWarning)) {
    section.diagnostics.push_back(found(kWarning, 0));
  } else if (line.text.starts_with(kError)) {
    section.diagnostics.push_back(found(kError, 2));
  } else if (line.error && !line.text.empty()) {
    section.last_error = found("", 2).text();
  }
}

void SectionChecks::finish(Section& section) {
  Diagnostics& diagnostics = section.diagnostics;
  if (!section.process->gone()) {
    section.process->tree().kill();
    diagnostics.push_back(error_at(
        {}, with_code(Code::program,
                      "{}: has not checked its section within {:g} s; see whether one of "
                      "its files is a pipe or a network drive that does not answer",
                      section.label, std::chrono::duration<double>(kCheckDeadline).count())));
    return;
  }
  const int code = exit_code(section.process->tree().status().value_or(0));
  if (code == 0) {
    return;
  }
  if (!has_errors(diagnostics)) {
    diagnostics.push_back(
        error_at({}, section.last_error.empty()
                         ? fmt::format("{}: its check ended with exit code {}", section.label, code)
                         : section.last_error));
  }
  std::ranges::find_if(diagnostics, &Diagnostic::is_error)->exit_code = code;
}

Diagnostics SectionChecks::run(const std::function<bool()>& stopped) {
  const auto all_gone = [this] {
    return std::all_of(sections_.begin(), sections_.end(),
                       [](const Section& section) { return section.process->gone(); });
  };
  group_.turn_until([&] { return all_gone() || stopped(); }, kCheckDeadline);
  Diagnostics diagnostics;
  for (Section& section : sections_) {
    if (stopped()) {
      section.process->tree().kill();
    } else {
      finish(section);
    }
    drop_repeated(section);
    append(diagnostics, section.diagnostics);
  }
  return diagnostics;
}

/// Every section reports a key at the top of the file: once is enough.
void SectionChecks::drop_repeated(Section& section) {
  std::erase_if(section.diagnostics, [&](const Diagnostic& found) {
    return !found.where.file.empty() && !said_.insert(found.text()).second;
  });
}

Diagnostics check_job(const MusicFile& file, const RunOptions& options, bool here) {
  Diagnostics diagnostics = structure_diagnostics(file);
  if (!diagnostics.empty()) {
    return diagnostics;
  }
  const EffectiveFile effective = make_effective(file, options);
  const std::string directory = directory_of(file.path);
  append(diagnostics, check_together(effective));
  if (here) {
    append(diagnostics, check_programs(effective.file, directory));
  }
  const ScratchFolder scratch;
  const std::string path = scratch.path() + "/effective.music";
  write_file(path, to_text(effective.file));
  status::Receiver receiver(scratch.path() + "/status");
  int signal = 0;
  ProcessGroup group(receiver,
                     {[](const nlohmann::json&) {}, [&signal](int number) { signal = number; }});
  SectionChecks sections(group, effective.file, {path, directory, scratch.descriptor(), false});
  append(diagnostics, sections.run([&signal] { return signal != 0; }));
  if (signal != 0) {
    return {{{}, stopped_by(signal), 128 + signal}};
  }
  return diagnostics;
}

}  // namespace spikeloop::launch
