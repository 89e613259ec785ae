// One section of a .music file as a node of an experiment.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "music_import.hpp"
#include "spikeloop/config/dialect.hpp"
#include "spikeloop/config/older_programs.hpp"
#include "spikeloop/experiment/node_types.hpp"
#include "spikeloop/experiment/topic_section.hpp"
#include "spikeloop/launch/programs.hpp"

namespace spikeloop::app {

/// A node as YAML: keys with their values, below its name.
struct ImportedNode {
  std::string name;
  std::vector<std::pair<std::string, std::string>> keys;
  const NodeDescription* description = nullptr;  ///< of its class; null: not known
  bool left_out = false;                         ///< an experiment has no such node
  std::string plugin{};                          ///< that its class comes from
};

class NodeImporter {
 public:
  NodeImporter(const MusicFile& file, const ImportOptions& options, experiment::NodeTypes& types,
               Imported& result)
      : file_(file), options_(options), types_(types), result_(result) {}

  /// @throws Error for what cannot be said; it names its place.
  ImportedNode import(const MusicSection& section);

 private:
  void refuse_script(const MusicSection& section, const launch::Program* program) const;
  void import_topic(const MusicSection& section, const RosProgram& program);
  void import_class(const MusicSection& section, const NodeProgram* program);
  void import_network(const MusicSection& section);
  void import_playback(const MusicSection& section);
  void load_plugin(const MusicSection& section, const MusicKey& key);

  void add_parameter(const MusicSection& section, const NodeProgram* program,
                     const ParameterDescription& parameter);
  void add_topic_key(const MusicSection& section, const RosProgram& program,
                     const experiment::SectionKey& key, const ParameterDescription& declared);
  std::string message_type(const MusicSection& section, const std::string& text,
                           const Location& where) const;
  const MusicKey* command_rate(const MusicSection& section, const RosProgram& program);
  void add_maps(const MusicSection& section, std::span<const experiment::SectionKey> keys,
                const std::vector<ParameterDescription>& declared);
  void add_mapping_file(const MusicSection& section);
  void note_differences(const MusicSection& section);
  void add_fields(const MusicSection& section, const RosProgram& program);
  void add(const std::string& key, const std::string& yaml);
  const MusicKey* find(const MusicSection& section, std::string_view name);
  std::string required(const MusicSection& section, const char* key, const char* example);
  std::string table(const MusicSection& section, const std::string& written, const Location& where,
                    bool grid);
  std::string fitted_table(const MusicSection& section, const std::string& written,
                           const Location& where);
  /// Of a file, seen from the experiment; with what stands `behind` it.
  std::string path(const MusicSection& section, const std::string& written, const Location& where,
                   const char* what, const std::string& behind = "");
  std::uint32_t width(const MusicSection& section, std::string_view port) const;
  bool strict(const MusicSection& section) const;
  Dialect dialect(const MusicSection& section) const;
  /// Nothing of the experiment stands for it so far.
  bool is_unused(const MusicKey& key) const;
  void note_unused_keys(const MusicSection& section);
  void note(const Location& where, std::string text) {
    result_.notes.push_back(warning_at(where, text));
  }

  const MusicFile& file_;
  const ImportOptions& options_;
  experiment::NodeTypes& types_;
  Imported& result_;
  ImportedNode node_;
  std::vector<std::string> used_;
};

/// A text as a YAML scalar of block style: quoted where it would mean something else.
std::string yaml_text(const std::string& text);
std::string yaml_quoted(const std::string& text);
/// "0.03" of the unit s as "30 ms"; what has a unit, or needs none, as it is.
std::string with_unit(const std::string& value, const std::string& unit);
/// What a section has for a parameter, as an experiment writes it.
/// @throws ConfigurationError as resolve() for a list that is none.
std::string yaml_value(const ParameterDescription& parameter, const std::string& text,
                       const Location& where);
/// A table in place.
std::string yaml_table(const WeightTable& table);

}  // namespace spikeloop::app
