#include <fmt/format.h>

#include "spikeloop/config/parameter_text.hpp"
#include "spikeloop/process/music_main.hpp"

namespace spikeloop::music {
namespace {

std::string option_table(const ProgramText& text) {
  std::string table;
  const auto line = [&](const std::string& name, const std::string& words) {
    table += fmt::format("  {:<27} {}\n", name, words);
  };
  line("--help", "Print this help");
  line("--version", "Print the version");
  line("--check-section FILE LABEL", "Report errors in this section; start nothing");
  if (text.may_run_alone) {
    line("--alone FILE LABEL", "Run this section without MUSIC");
  }
  for (const auto& [name, option] : text.options) {
    line(name, option.text);
  }
  return table;
}

constexpr const char* kBarrierNote =
    "If a job hangs before its first tick, check the key barrier. With barrier=true, the default,\n"
    "every program of the job must call MPI_Barrier(MPI_COMM_WORLD) exactly once between MUSIC's\n"
    "Setup and Runtime, as the older programs do. Ordinary PyNEST scripts and MUSIC's own tools\n"
    "do not: with them, write barrier=false in all sections of Spikeloop programs.\n";

}  // namespace

std::string help_text(const ProgramText& text) {
  std::string help = fmt::format(
      "{0}: {1}\n\n"
      "A MUSIC program: write a section with binary={0} into FILE.music and run\n"
      "  spikeloop run FILE.music        or        mpirun -np N music FILE.music\n\n"
      "Options without MUSIC:\n{2}",
      text.name, text.summary, option_table(text));
  if (!text.ports.empty()) {
    help += fmt::format("\nPorts:\n{}", text.ports);
  }
  if (!text.parameters.empty()) {
    help +=
        fmt::format("\nKeys of the section, with defaults:\n{}", parameter_text(text.parameters));
  }
  help +=
      fmt::format("\nKeys common to all programs, in the section or at the top of the file:\n{}",
                  parameter_text(common_parameters(text.defaults)));
  if (!text.example.empty()) {
    help += fmt::format("\nExample:\n{}", text.example);
  }
  if (!text.notes.empty()) {
    help += "\n" + text.notes;
  }
  return help + "\n" + kBarrierNote;
}

}  // namespace spikeloop::music
