// Parameters declared as data: checks, `describe` output and reference pages come from one list.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "spikeloop/core/error.hpp"
#include "spikeloop/core/weights.hpp"

namespace spikeloop {

enum class ParameterType { number, integer, boolean, text, choice, weights, list, map };

/// Of "integer", "boolean", "text", "choice" and "weights", as Python declares them; else number.
ParameterType parameter_type(std::string_view kind);

/// One parameter of a node class or endpoint. Inside of a list or a map numbers carry their units.
struct ParameterDescription {
  std::string name{};
  ParameterType type = ParameterType::number;
  std::string unit{};                          ///< "s", "Hz", "1" ...; values are kept in it
  std::optional<std::string> default_value{};  ///< as one would write it; none: must be given
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  std::vector<std::string> choices{};
  std::string text{};  ///< one line, no full stop
  /// list: what an entry is. map: its keys; a single one that is kAnyKey is of every key.
  std::vector<ParameterDescription> inner{};
  std::size_t count = 0;    ///< list: its entries; 0: any number
  std::string plain_key{};  ///< map: the key that is meant by a plain value in its place
  std::string example{};    ///< list, map: as one would write it
  bool changeable = false;  ///< number: may change during a run (Node::change)
};

/// The name of a map's only key when users choose its keys.
inline constexpr const char* kAnyKey = "*";

std::vector<std::string> names_of(const std::vector<ParameterDescription>& parameters);

/// "key 'topic' is missing; write for example  topic: /scan"; `equals` stands between name and
/// value. Without an example the parameter's text says what is missing.
std::string missing_key(const ParameterDescription& parameter, std::string_view equals);

struct WrittenEntry;

/// A value as the user wrote it, and where.
struct WrittenValue {
  std::string text;  ///< of a list or a map its JSON
  Location where;
  /// What a list or a map holds, in the user's order; a plain value has no such function.
  std::function<std::vector<WrittenEntry>()> entries{};

  bool is_list() const { return entries && text.starts_with('['); }
  bool is_map() const { return entries && text.starts_with('{'); }
};

struct WrittenEntry {
  std::string key;  ///< of a map
  WrittenValue value;
};
using WrittenValues = std::map<std::string, WrittenValue, std::less<>>;

/// Turns the text of a `weights` parameter into a table; config/ reads files, tests give tables.
using WeightLoader = std::function<WeightTable(const WrittenValue&)>;

/// Checked values by name. Asking for a name or type that was not declared is a bug and throws
/// std::logic_error.
class Parameters {
 public:
  struct Entry;
  /// Of a map with the user's own keys, or of a list of maps; one of a map with declared keys.
  using Entries = std::vector<Entry>;
  using Value = std::variant<double, std::int64_t, bool, std::string, WeightTable,
                             std::vector<double>, Entries>;

  double number(std::string_view name) const;  ///< integers too
  std::int64_t integer(std::string_view name) const;
  bool boolean(std::string_view name) const;
  const std::string& text(std::string_view name) const;  ///< text and choice
  const WeightTable& weights(std::string_view name) const;
  const std::vector<double>& numbers(
      std::string_view name) const;  ///< list of numbers; may be empty
  /// Of a map: its keys' values. An entry that is neither a map nor a list of maps has its value by
  /// the name of its description.
  const Parameters& map(std::string_view name) const;
  const Entries& entries(std::string_view name) const;  ///< may be empty
  /// The choice that stands in the place of a map; empty when there is none.
  std::string word(std::string_view name) const;
  /// True when the user wrote it, false when the default holds.
  bool given(std::string_view name) const;
  /// Where the user wrote it; empty for a default.
  const Location& where(std::string_view name) const;

  void set(const std::string& name, Value value, bool given = true, Location where = {});
  const std::map<std::string, Value, std::less<>>& all() const { return values_; }

 private:
  const Value& find(std::string_view name) const;
  std::map<std::string, Value, std::less<>> values_;
  std::map<std::string, Location, std::less<>> given_;
};

struct Parameters::Entry {
  std::string key;  ///< of a map with the user's own keys
  Location where;
  Parameters values;
};

/// Checks every written value against its declaration and fills in defaults.
/// Numbers may carry a unit ("30 ms" for a parameter in "s"); without one they are in the declared
/// unit. Names in `ignored` are accepted and left out.
/// @throws ConfigurationError with location, key, value and remedy: unknown key ("did you mean"),
/// not a number, not finite, outside its bounds, wrong unit, no such choice, missing.
Parameters resolve(const std::vector<ParameterDescription>& declared, const WrittenValues& written,
                   const WeightLoader& load_weights, const std::vector<std::string>& ignored = {});

/// Parses "30 ms" into `unit`; the whole text must be used.
/// Time: ns us ms s min h; frequency: Hz kHz MHz; voltage: uV mV V; current: pA nA uA mA A;
/// capacitance: pF nF uF; resistance: Ohm kOhm MOhm GOhm; length: mm cm m km; angle: rad deg;
/// speed: m/s; angular speed: rad/s deg/s; dimensionless: "1" or "".
/// @throws ConfigurationError (without location) that says what is wrong and what to write.
double parse_quantity(std::string_view text, std::string_view unit);

}  // namespace spikeloop
