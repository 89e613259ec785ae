#include "spikeloop/core/parameters.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace spikeloop {

namespace {

template <typename T>
const T& typed(const Parameters::Value& value, std::string_view name) {
  if (const T* found = std::get_if<T>(&value)) {
    return *found;
  }
  throw std::logic_error(fmt::format("parameter '{}' was asked for with the wrong type", name));
}

}  // namespace

const Parameters::Value& Parameters::find(std::string_view name) const {
  const auto found = values_.find(name);
  if (found == values_.end()) {
    throw std::logic_error(fmt::format("parameter '{}' was not declared", name));
  }
  return found->second;
}

double Parameters::number(std::string_view name) const {
  const Value& value = find(name);
  if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    return static_cast<double>(*integer);
  }
  return typed<double>(value, name);
}

std::int64_t Parameters::integer(std::string_view name) const {
  return typed<std::int64_t>(find(name), name);
}

bool Parameters::boolean(std::string_view name) const {
  return typed<bool>(find(name), name);
}

const std::string& Parameters::text(std::string_view name) const {
  return typed<std::string>(find(name), name);
}

const WeightTable& Parameters::weights(std::string_view name) const {
  return typed<WeightTable>(find(name), name);
}

const std::vector<double>& Parameters::numbers(std::string_view name) const {
  return typed<std::vector<double>>(find(name), name);
}

const Parameters& Parameters::map(std::string_view name) const {
  const Entries& entries = typed<Entries>(find(name), name);
  if (entries.size() != 1) {
    throw std::logic_error(fmt::format("parameter '{}' was asked for without having a map", name));
  }
  return entries.front().values;
}

const Parameters::Entries& Parameters::entries(std::string_view name) const {
  static const Entries kNone;
  const Value& value = find(name);
  return std::holds_alternative<std::string>(value) ? kNone : typed<Entries>(value, name);
}

std::string Parameters::word(std::string_view name) const {
  const auto* word = std::get_if<std::string>(&find(name));
  return word == nullptr ? "" : *word;
}

bool Parameters::given(std::string_view name) const {
  return given_.find(name) != given_.end();
}

const Location& Parameters::where(std::string_view name) const {
  static const Location kNowhere;
  const auto found = given_.find(name);
  return found == given_.end() ? kNowhere : found->second;
}

void Parameters::set(const std::string& name, Value value, bool given, Location where) {
  values_[name] = std::move(value);
  given_.erase(name);
  if (given) {
    given_[name] = std::move(where);
  }
}

std::vector<std::string> names_of(const std::vector<ParameterDescription>& parameters) {
  std::vector<std::string> names;
  names.reserve(parameters.size());
  for (const auto& parameter : parameters) {
    names.push_back(parameter.name);
  }
  return names;
}

ParameterType parameter_type(std::string_view kind) {
  return kind == "integer"   ? ParameterType::integer
         : kind == "boolean" ? ParameterType::boolean
         : kind == "text"    ? ParameterType::text
         : kind == "choice"  ? ParameterType::choice
         : kind == "weights" ? ParameterType::weights
                             : ParameterType::number;
}

std::string missing_key(const ParameterDescription& parameter, std::string_view equals) {
  const std::string example =
      parameter.choices.empty() ? parameter.example : parameter.choices.front();
  return example.empty()
             ? with_code(Code::missing_key, "key '{0}' is missing ({1}); write  {0}{2}...",
                         parameter.name, parameter.text, equals)
             : with_code(Code::missing_key, "key '{0}' is missing; write for example  {0}{1}{2}",
                         parameter.name, equals, example);
}

}  // namespace spikeloop
