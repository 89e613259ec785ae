#include <fmt/format.h>

#include <algorithm>

#include "faults.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/unit_demand.hpp"

namespace spikeloop::experiment {
namespace {

class KeyReader {
 public:
  KeyReader(const Keyed& keyed, const WeightLoader& load_weights, Faults& faults)
      : keyed_(keyed), load_weights_(load_weights), faults_(faults) {}

  Parameters read(const std::vector<ParameterDescription>& declared) {
    check_names(declared);
    for (const ParameterDescription& parameter : declared) {
      if (!faults_.attempt(keyed_.where, [&] { take(parameter); })) {
        stand_in(parameter);
      }
    }
    return std::move(result_);
  }

 private:
  void check_names(const std::vector<ParameterDescription>& declared) {
    const std::vector<std::string> names = names_of(declared);
    for (const auto& [name, value] : keyed_.written) {
      if (std::ranges::find(names, name) == names.end()) {
        const auto place = keyed_.places.find(name);
        faults_.add(place == keyed_.places.end() ? value.where : place->second,
                    with_code(Code::unknown_key, "{}: unknown key '{}'{}", keyed_.what, name,
                              remedy(name, declared)));
        meant_.push_back(nearest(name, names));
      }
    }
  }

  /// Points to a list of maps if the entries of the list have the key.
  static std::string remedy(const std::string& name,
                            const std::vector<ParameterDescription>& declared) {
    for (const ParameterDescription& list : declared) {
      if (list.type != ParameterType::list || list.inner.front().plain_key.empty()) {
        continue;
      }
      const ParameterDescription& entry = list.inner.front();
      if (std::ranges::find(entry.inner, name, &ParameterDescription::name) != entry.inner.end()) {
        return fmt::format(
            "; it is a key of an entry of '{0}': write  {0}: [{{{1}: ..., {2}: VALUE}}]", list.name,
            entry.plain_key, name);
      }
    }
    return did_you_mean(name, names_of(declared));
  }

  void take(const ParameterDescription& parameter) {
    const auto value = keyed_.written.find(parameter.name);
    if (value == keyed_.written.end()) {
      take_default(parameter);
      return;
    }
    demand_unit(keyed_.what, parameter, value->second);
    try {
      keep(parameter, spikeloop::resolve({parameter}, {*value}, load_weights_));
    } catch (const FileError& error) {
      throw FileError(value->second.where,
                      with_code(Code::missing_file, "key '{}': {}; write the path of a file",
                                parameter.name, error.what()));
    }
  }

  void take_default(const ParameterDescription& parameter) {
    if (parameter.default_value) {
      keep(parameter, spikeloop::resolve({parameter}, {}, load_weights_));
      return;
    }
    const auto told = [&](const std::vector<std::string>& names) {
      return std::ranges::find(names, parameter.name) != names.end();
    };
    if (told(meant_) || told(keyed_.unread)) {
      stand_in(parameter);
      return;
    }
    throw ConfigurationError(keyed_.where,
                             fmt::format("{}: {}", keyed_.what, missing_key(parameter, ": ")));
  }

  void keep(const ParameterDescription& parameter, const Parameters& read) {
    if (const auto value = read.all().find(parameter.name); value != read.all().end()) {
      result_.set(parameter.name, value->second, read.given(parameter.name),
                  read.where(parameter.name));
    }
  }

  /// Something to go on with after a fault.
  void stand_in(const ParameterDescription& parameter) {
    if (parameter.default_value && !parameter.default_value->empty()) {
      keep(parameter, spikeloop::resolve({parameter}, {}, load_weights_));
    } else {
      result_.set(parameter.name, empty_value(parameter), false);
    }
  }
  static Parameters::Value empty_holder(ParameterDescription parameter) {
    parameter.default_value = "";
    return spikeloop::resolve({parameter}, {}, {}).all().at(parameter.name);
  }
  static Parameters::Value empty_value(const ParameterDescription& parameter) {
    switch (parameter.type) {
      case ParameterType::number:
        return 0.0;
      case ParameterType::integer:
        return std::int64_t{0};
      case ParameterType::boolean:
        return false;
      case ParameterType::weights:
        return WeightTable{};
      case ParameterType::list:
      case ParameterType::map:
        return empty_holder(parameter);
      case ParameterType::text:
      case ParameterType::choice:
        break;
    }
    return std::string();
  }

  const Keyed& keyed_;
  const WeightLoader& load_weights_;
  Faults& faults_;
  std::vector<std::string> meant_;
  Parameters result_;
};

}  // namespace

Parameters resolve_keys(const std::vector<ParameterDescription>& declared, const Keyed& keyed,
                        const WeightLoader& load_weights, Faults& faults) {
  return KeyReader(keyed, load_weights, faults).read(declared);
}

}  // namespace spikeloop::experiment
