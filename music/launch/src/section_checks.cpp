#include "section_checks.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <string.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "spikeloop/config/dialect.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/launch/folders.hpp"
#include "spikeloop/launch/programs.hpp"

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
  if (program.empty()) {
    return;
  }
  ProgramStart start;
  start.arguments = {program, "--check-section", places.effective_file, section.label};
  start.environment = origin_environment(file_.path);
  start.directory = directory;
  start.scratch = places.scratch;
  sections_.push_back({section.label});
  Section& added = sections_.back();
  added.process =
      &group_.start(start, [this, &added](const OutputLine& line) { take(added, line); });
}

/// What says its place in the file needs no label.
std::string SectionChecks::labelled(const Section& section, const std::string& text) const {
  return text.starts_with(file_.path + ":") ? text : fmt::format("{}: {}", section.label, text);
}

void SectionChecks::take(Section& section, const OutputLine& line) const {
  const auto said = [&](std::string_view kind) {
    return labelled(section, line.text.substr(kind.size()));
  };
  if (line.text.starts_with(kWarning)) {
    section.findings.warnings.push_back(said(kWarning));
  } else if (line.text.starts_with(kError)) {
    section.findings.errors.push_back({said(kError)});
  } else if (line.error && !line.text.empty()) {
    section.last_error = said("");
  }
}

void SectionChecks::finish(Section& section) {
  auto& errors = section.findings.errors;
  if (!section.process->gone()) {
    section.process->tree().kill();
    errors.push_back(
        {fmt::format("{}: has not checked its section within {:g} s; see whether one of "
                     "its files is a pipe or a network drive that does not answer",
                     section.label, std::chrono::duration<double>(kCheckDeadline).count())});
    return;
  }
  const int code = exit_code(section.process->tree().status().value_or(0));
  if (code == 0) {
    return;
  }
  if (errors.empty()) {
    errors.push_back(
        {section.last_error.empty()
             ? fmt::format("{}: its check ended with exit code {}", section.label, code)
             : section.last_error});
  }
  errors.front().exit_code = code;
}

Findings SectionChecks::run(const std::function<bool()>& stopped) {
  const auto all_gone = [this] {
    return std::all_of(sections_.begin(), sections_.end(),
                       [](const Section& section) { return section.process->gone(); });
  };
  group_.turn_until([&] { return all_gone() || stopped(); }, kCheckDeadline);
  Findings findings;
  for (Section& section : sections_) {
    if (stopped()) {
      section.process->tree().kill();
    } else {
      finish(section);
    }
    drop_repeated(section);
    findings.append(section.findings);
  }
  return findings;
}

/// All sections complain of a key at the top of the file: the first one's word is enough.
void SectionChecks::drop_repeated(Section& section) {
  const auto repeated = [&](const std::string& text) {
    return text.starts_with(file_.path + ":") && !said_.insert(text).second;
  };
  std::erase_if(section.findings.errors,
                [&](const Finding& error) { return repeated(error.text); });
  std::erase_if(section.findings.warnings, repeated);
}

Findings check_job(const MusicFile& file, const RunOptions& options, bool here) {
  Findings findings;
  for (const MusicProblem& problem : find_structure_problems(file)) {
    findings.add_error(problem.where, problem.message);
  }
  if (!findings.errors.empty()) {
    return findings;
  }
  const EffectiveFile effective = make_effective(file, options);
  const std::string directory = directory_of(file.path);
  findings.append(check_together(effective));
  if (here) {
    findings.append(check_programs(effective.file, directory));
  }
  const Scratch scratch;
  const std::string path = scratch.path() + "/effective.music";
  write_text(path, to_text(effective.file));
  status::Receiver receiver(scratch.path() + "/status");
  int signal = 0;
  ProcessGroup group(receiver,
                     {[](const nlohmann::json&) {}, [&signal](int number) { signal = number; }});
  SectionChecks sections(group, effective.file, {path, directory, scratch.path()});
  findings.append(sections.run([&signal] { return signal != 0; }));
  if (signal != 0) {
    findings.errors = {{stopped_by(signal), 128 + signal}};
  }
  return findings;
}

}  // namespace spikeloop::launch
