#include "parameter_values.hpp"

#include <string>

namespace spikeloop::python {

ParameterDescription parameter_of(const pybind11::tuple& plain) {
  ParameterDescription description;
  description.name = plain[0].cast<std::string>();
  description.type = parameter_type(plain[1].cast<std::string>());
  description.unit = plain[2].cast<std::string>();
  if (!plain[3].is_none()) {
    description.default_value = plain[3].cast<std::string>();
  }
  description.minimum = plain[4].cast<double>();
  description.maximum = plain[5].cast<double>();
  for (const pybind11::handle choice : plain[6]) {
    description.choices.push_back(choice.cast<std::string>());
  }
  description.text = plain[7].cast<std::string>();
  return description;
}

}  // namespace spikeloop::python
