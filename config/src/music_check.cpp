// Finds in a parsed file what MUSIC would crash on, hang at or abort for.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "music_text.hpp"
#include "spikeloop/config/music_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/connection_faults.hpp"

namespace spikeloop {

namespace {

using music_text::shown;
using PortName = std::pair<std::string, std::string>;  // application, port

class Checker {
 public:
  explicit Checker(const MusicFile& file) : file_(file), labels_(file.labels()) {
    known_.insert(labels_.begin(), labels_.end());
    for (const auto& connection : file.connections) {
      connected_.insert(connection.from_app);
      connected_.insert(connection.to_app);
    }
  }

  Diagnostics run() {
    if (file_.sections.empty()) {
      add({file_.path}, with_code(Code::missing_key,
                                  "the file has no application; write '[label]', np=1, "
                                  "binary=program and its connections"));
      return std::move(diagnostics_);
    }
    constexpr std::size_t kMost = 10'000;  // MUSIC can pass on fewer
    if (std::max(file_.sections.size(), file_.connections.size()) > kMost) {
      add({file_.path}, with_code(Code::out_of_bounds,
                                  "the file has {} sections and {} connections; write at most {} "
                                  "of each",
                                  file_.sections.size(), file_.connections.size(), kMost));
      return std::move(diagnostics_);
    }
    for (const auto& section : file_.sections) {
      check_section(section);
    }
    for (const auto& connection : file_.connections) {
      check_connection(connection);
    }
    if (diagnostics_.empty()) {
      check_size();
    }
    std::stable_sort(diagnostics_.begin(), diagnostics_.end(), [](const auto& a, const auto& b) {
      return std::tie(a.where.line, a.where.column) < std::tie(b.where.line, b.where.column);
    });
    return std::move(diagnostics_);
  }

 private:
  void add(const Location& where, std::string message) {
    diagnostics_.push_back({where, std::move(message)});
  }

  void check_section(const MusicSection& section) {
    const std::string label = shown(section.label);
    if (section.label.find_first_not_of("0123456789") == std::string::npos &&
        file_.find_key(section, "binary") == nullptr) {
      add(section.where, with_code(Code::syntax,
                                   "'[{0}]' on a line of its own is a section for MUSIC; write a "
                                   "width on the connection's line: 'A.out -> B.in [{0}]'",
                                   label));
      return;
    }
    if (section.keys.empty()) {  // global keys do not count for MUSIC's assertion
      add(section.where,
          with_code(Code::missing_key,
                    "the section '[{}]' has no key of its own, and MUSIC would abort; "
                    "write np=1 and binary=program",
                    label));
      return;
    }
    const auto processes = music_text::read_processes(file_, section);
    if (const auto* problem = std::get_if<Diagnostic>(&processes)) {
      diagnostics_.push_back(*problem);
    }
    const MusicKey* binary = file_.find_key(section, "binary");
    if (binary == nullptr) {
      add(section.where,
          with_code(Code::missing_key, "the section '[{}]' has no binary; write binary=program",
                    label));
    } else if (binary->value.empty()) {
      add(binary->where,
          with_code(Code::missing_key, "binary of '[{}]' is empty; write binary=program", label));
    }
    if (!connected_.contains(section.label)) {
      add(section.where, with_code(Code::not_connected,
                                   "the application '{0}' has no connection, and MUSIC would hang; "
                                   "write '{0}.out -> B.in [width]' or remove the section",
                                   label));
    }
  }

  void check_connection(const MusicConnection& c) {
    const bool from_known = check_application(c.from_app, c);
    const bool to_known = check_application(c.to_app, c);  // both are reported
    if (!from_known || !to_known) {
      return;
    }
    if (c.from_app == c.to_app) {
      add(c.where, with_code(Code::music_job,
                             "the connection '{}' joins an application to itself, which MUSIC "
                             "refuses; write two applications",
                             shown(describe(c))));
      return;
    }
    check_directions(c);
    check_receiver(c);
  }

  bool check_application(const std::string& app, const MusicConnection& c) {
    if (known_.contains(app)) {
      return true;
    }
    add(c.where, unknown_node(shown(app), labels_));
    return false;
  }

  void check_directions(const MusicConnection& c) {
    const PortName from{c.from_app, c.from_port};
    const PortName to{c.to_app, c.to_port};
    outputs_.emplace(from, c.where.line);
    inputs_.emplace(to, c.where.line);
    for (const auto& [port, others] : {std::pair{from, &inputs_}, std::pair{to, &outputs_}}) {
      if (const auto other = others->find(port); other != others->end()) {
        add(c.where, with_code(Code::music_job,
                               "the port '{}.{}' is both an output and an input (line {}); write "
                               "two ports",
                               shown(port.first), shown(port.second), other->second));
      }
    }
  }

  void check_receiver(const MusicConnection& c) {
    const auto [first, is_new] = receivers_.emplace(PortName{c.to_app, c.to_port}, &c);
    if (is_new) {
      return;
    }
    const auto end = [](const std::string& app, const std::string& port) {
      return shown(fmt::format("{}.{}", app, port));
    };
    const MusicConnection& other = *first->second;
    add(c.where, two_connections(end(c.to_app, c.to_port), end(other.from_app, other.from_port),
                                 end(c.from_app, c.from_port)));
  }

  /// No application's configuration is longer: everything counted, every character escaped.
  std::size_t size_bound() const {
    std::size_t size = 64;
    const auto add_keys = [&](const std::vector<MusicKey>& keys) {
      for (const auto& key : keys) {
        size += key.name.size() + 2 * key.value.size() + 2;
      }
    };
    add_keys(file_.globals);
    for (const auto& section : file_.sections) {
      add_keys(section.keys);
      size += 3 * section.label.size() + 16;
    }
    for (const auto& c : file_.connections) {
      size +=
          2 * (c.from_app.size() + c.from_port.size() + c.to_app.size() + c.to_port.size()) + 128;
    }
    return size;
  }

  void check_size() {
    if (size_bound() < kEnvironmentLimit) {
      return;
    }
    for (const auto& section : file_.sections) {
      const std::size_t size = std::string_view("_MUSIC_CONFIG_=").size() +
                               music_environment(file_, section.label).size() + 1;
      if (size > kEnvironmentLimit) {
        add(section.where,
            with_code(Code::out_of_bounds,
                      "the configuration of '{}' has {} bytes, but MUSIC passes it on in one "
                      "environment string of at most {}; write long values to files and name "
                      "the files",
                      shown(section.label), size, kEnvironmentLimit));
        return;
      }
    }
  }

  const MusicFile& file_;
  std::vector<std::string> labels_;
  std::set<std::string_view> known_;
  std::set<std::string_view> connected_;
  std::map<PortName, int> outputs_;  // with the line of the first use
  std::map<PortName, int> inputs_;
  std::map<PortName, const MusicConnection*> receivers_;
  Diagnostics diagnostics_;
};

}  // namespace

Diagnostics structure_diagnostics(const MusicFile& file) {
  return Checker(file).run();
}

void check_structure(const MusicFile& file) {
  const auto diagnostics = structure_diagnostics(file);
  if (!diagnostics.empty()) {
    throw ConfigurationError(diagnostics.front().where, diagnostics.front().message);
  }
}

}  // namespace spikeloop
