// What concerns more than one program of a job.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "cycles.hpp"
#include "external_topics.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/connection_faults.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/time.hpp"
#include "spikeloop/launch/check.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::launch {
namespace {

bool says(const MusicFile& file, const MusicSection& section, const char* name, const char* value) {
  const MusicKey* key = file.find_key(section, name);
  return key != nullptr && key->value == value;
}

bool any_strict(const MusicFile& file) {
  for (const MusicSection& section : file.sections) {
    if (says(file, section, "strict", "true")) {
      return true;
    }
  }
  return false;
}

class TogetherCheck {
 public:
  explicit TogetherCheck(const EffectiveFile& effective)
      : effective_(effective), file_(effective.file), strict_(any_strict(file_)) {}

  Diagnostics run() {
    for (const Diagnostic& warning : file_.warnings) {
      diagnostics_.push_back(warning_at(warning.where, warning.message, strict_));
    }
    check_globals();
    check_ours();
    for (const MusicSection* section : in_written_order(file_)) {
      check_ranks(*section);
    }
    check_connections();
    append(diagnostics_, check_external_topics(file_, strict_));
    for (const std::string& warning : effective_.warnings) {
      diagnostics_.push_back(warning_at({}, warning, strict_ || all_ours(file_)));
    }
    return std::move(diagnostics_);
  }

 private:
  Location where(const MusicSection& section, const char* key) const {
    const MusicKey* found = file_.find_key(section, key);
    return found == nullptr || found->where.line == 0 ? section.where : found->where;
  }

  /// Programs judge the keys of their sections; those at the top are everybody's.
  void check_globals() {
    const std::vector<std::string> known{"stoptime", "music_timestep", "rtf",     "seed",
                                         "dialect",  "strict",         "barrier", "record"};
    for (const MusicKey& key : file_.globals) {
      const bool is_known = std::ranges::find(known, key.name) != known.end();
      const std::string meant = is_known ? "" : nearest(key.name, known);
      if (all_ours(file_) && !meant.empty()) {
        diagnostics_.push_back(
            warning_at(key.where,
                       with_code(Code::unknown_key,
                                 "unknown key '{}' at the top of the file; did you mean "
                                 "'{}'?; it is ignored",
                                 key.name, meant),
                       strict_));
      }
    }
  }

  /// Each of our programs against the first of them, and against itself.
  void check_ours() {
    std::vector<const MusicSection*> ours = in_written_order(file_);
    std::erase_if(ours,
                  [&](const auto* section) { return find_program(file_, *section) == nullptr; });
    if (ours.empty()) {
      return;
    }
    check_duration(*ours.front());
    for (const MusicSection* section : ours) {
      check_length(*section);
      check_ticks(*ours.front(), *section);
      check_lengths(*ours.front(), *section);
      check_barriers(*ours.front(), *section);
    }
  }

  bool is_too_short(const MusicSection& section) const {
    const auto length = stop_time(file_, section);
    return length && *length < tick_of(file_, section);
  }

  /// The option holds for all sections: once is enough.
  void check_duration(const MusicSection& section) {
    const MusicKey* key = file_.find_key(section, "stoptime");
    if (is_too_short(section) && key->where.line == 0) {
      diagnostics_.push_back(
          error_at({}, with_code(Code::out_of_bounds,
                                 "--duration {} is less than the tick of {}; write a "
                                 "longer one, or a shorter music_timestep",
                                 key->value, format_time(tick_of(file_, section)))));
    }
  }

  void check_length(const MusicSection& section) {
    const MusicKey* key = file_.find_key(section, "stoptime");
    if (is_too_short(section) && key->where.line != 0) {
      diagnostics_.push_back(error_at(
          key->where, with_code(Code::out_of_bounds,
                                "'{}' runs for {}, less than its tick of {}; write a longer "
                                "stoptime, or a shorter music_timestep",
                                section.label, format_time(stop_time(file_, section).value_or(0)),
                                format_time(tick_of(file_, section)))));
    }
  }

  void check_ticks(const MusicSection& a, const MusicSection& b) {
    const TimeNs tick_a = tick_of(file_, a);
    const TimeNs tick_b = tick_of(file_, b);
    if (tick_a != tick_b) {
      diagnostics_.push_back(error_at(
          where(b, "music_timestep"),
          with_code(Code::music_job,
                    "the tick of '{}' is {}, but that of '{}' is {}; MUSIC exchanges less and less "
                    "often between unequal ticks: write one music_timestep at the top of the file",
                    b.label, format_time(tick_b), a.label, format_time(tick_a))));
    }
  }

  void check_lengths(const MusicSection& a, const MusicSection& b) {
    const auto text = [](std::optional<TimeNs> length) {
      return length ? "for " + format_time(*length) : "without end";
    };
    const auto length_a = stop_time(file_, a);
    const auto length_b = stop_time(file_, b);
    if (length_a != length_b) {
      diagnostics_.push_back(warning_at(
          where(b, "stoptime"),
          with_code(Code::music_job,
                    "'{}' runs {}, but '{}' {}; write one stoptime at the top of the file", b.label,
                    text(length_b), a.label, text(length_a)),
          strict_));
    }
  }

  void check_barriers(const MusicSection& a, const MusicSection& b) {
    const bool barrier_a = !says(file_, a, "barrier", "false");
    if (barrier_a == says(file_, b, "barrier", "false")) {
      diagnostics_.push_back(error_at(
          where(b, "barrier"),
          with_code(Code::music_job,
                    "'{}' waits at the barrier before the first tick, '{}' does not, and the job "
                    "would hang; write one  barrier=  at the top of the file",
                    barrier_a ? a.label : b.label, barrier_a ? b.label : a.label)));
    }
  }

  /// Our own say so themselves.
  void check_ranks(const MusicSection& section) {
    if (find_program(file_, section) != nullptr || file_.processes(section) == 1) {
      return;
    }
    const auto sends = [&](const MusicConnection& c) { return c.from_app == section.label; };
    if (std::any_of(file_.connections.begin(), file_.connections.end(), sends)) {
      diagnostics_.push_back(warning_at(
          where(section, "np"),
          with_code(Code::music_job,
                    "'{}' sends from {} processes: MUSIC mixes up the ticks of several senders; "
                    "write np=1, unless the program sends from its first "
                    "process only",
                    section.label, file_.processes(section)),
          strict_));
    }
  }

  void check_connections() {
    std::map<std::string, const MusicConnection*> senders;
    std::map<std::string, std::size_t> receivers;
    for (const MusicConnection& connection : file_.connections) {
      check_kinds(connection);
      check_width(connection);
      const auto [first, is_new] =
          senders.emplace(connection.from_app + "." + connection.from_port, &connection);
      const Program* sender = find_program(file_, connection.from_app);
      if (!is_new && sender != nullptr && first->second->width != connection.width) {
        diagnostics_.push_back(
            error_at(connection.where,
                     with_code(Code::widths_differ,
                               "the output '{}' has another width in line {}; write the same "
                               "[width] in both",
                               first->first, first->second->where.line)));
      }
      if (sender != nullptr && sender->output == PortKind::spikes) {
        ++receivers[first->first];
      }
    }
    for (const auto& [port, count] : receivers) {
      if (crashes_music(count)) {
        diagnostics_.push_back(
            warning_at(senders.at(port)->where,
                       with_code(Code::music_job, "the output '{}' has {} connections, and {}",
                                 port, count, kCrashesMusic),
                       strict_));
      }
    }
  }

  void check_kinds(const MusicConnection& connection) {
    const Program* from = find_program(file_, connection.from_app);
    const Program* to = find_program(file_, connection.to_app);
    if (from == nullptr || to == nullptr || connection.from_port != "out" ||
        connection.to_port != "in" || !from->output || !to->input || from->output == to->input) {
      return;
    }
    diagnostics_.push_back(error_at(
        connection.where,
        kinds_differ(connection.from_app + ".out", *from->output, connection.to_app + ".in")));
  }

  /// Width 0 is that of MUSIC's message ports, which none of our programs has.
  void check_width(const MusicConnection& connection) {
    const bool ours = find_program(file_, connection.from_app) != nullptr ||
                      find_program(file_, connection.to_app) != nullptr;
    if (ours && connection.width == 0U) {
      diagnostics_.push_back(error_at(
          connection.where, with_code(Code::unknown_width,
                                      "the connection '{}' has width 0; write at least 1 (0 is for "
                                      "message ports between other programs)",
                                      describe(connection))));
    }
  }

  const EffectiveFile& effective_;
  const MusicFile& file_;
  bool strict_;
  Diagnostics diagnostics_;
};

}  // namespace

Diagnostics check_together(const EffectiveFile& effective) {
  return TogetherCheck(effective).run();
}

}  // namespace spikeloop::launch
