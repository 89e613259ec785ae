// What a .music job of an experiment has in either layout.
#pragma once

#include <string>

#include "spikeloop/experiment/music_job.hpp"

namespace spikeloop::experiment {

class JobWriter {
 protected:
  JobWriter(const Experiment& experiment, const std::string& folder)
      : experiment_(experiment), folder_(folder) {}

  /// Keys of all sections.
  void write_globals();
  void begin_section(const std::string& label, const Location& where);
  void add(const char* name, const std::string& value, const Location& where = {});
  /// A key of the newest section that stands for a key of the experiment's.
  /// `key`: the experiment's, when it has another name there.
  void add(const Node& node, const std::string& name, const std::string& value,
           const std::string& key = "");
  /// Where its program runs: paths start where the experiment lies.
  void add_directory(const Location& where);
  /// Of a simulator; the section has been begun.
  void add_script(const Node& node);
  /// What its ports carry, as far as the nodes at their other ends say it.
  void add_kinds(const Node& node);

  static std::string seconds(TimeNs time);

  const Experiment& experiment_;
  std::string folder_;
  MusicJob job_{};
};

}  // namespace spikeloop::experiment
