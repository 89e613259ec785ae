#include "python_class.hpp"

#include "parameter_values.hpp"
#include "python_node.hpp"

namespace spikeloop::python {

namespace py = pybind11;

namespace {

PortDescription port_of(const py::tuple& port) {
  PortDescription description;
  description.name = port[0].cast<std::string>();
  description.text = port[1].cast<std::string>();
  description.kind = port[2].cast<std::string>() == "spikes" ? PortKind::spikes : PortKind::signal;
  description.direction = port[3].cast<bool>() ? Direction::input : Direction::output;
  if (const auto width = port[4].cast<std::uint32_t>(); width != 0) {
    description.width = WidthRule::fixed(width);
  }
  if (const auto other = port[5].cast<int>(); other >= 0) {
    description.width = WidthRule::same_as(static_cast<std::uint32_t>(other));
  }
  return description;
}

NodeDescription description_of(const py::object& definition) {
  const py::tuple plain = node_host().attr("description")(definition);
  NodeDescription description;
  description.name = plain[0].cast<std::string>();
  description.text = plain[1].cast<std::string>();
  for (const py::handle port : plain[2]) {
    description.ports.push_back(port_of(port.cast<py::tuple>()));
  }
  for (const py::handle parameter : plain[3]) {
    description.parameters.push_back(parameter_of(parameter.cast<py::tuple>()));
  }
  return description;
}

}  // namespace

PythonClass::PythonClass(py::object definition, const spikeloop_host& host)
    : spikeloop_node_class{},
      definition_(std::move(definition)),
      plain_(description_of(definition_)),
      host_(host) {
  name = plain_.description().name.c_str();
  text = plain_.description().text.c_str();
  ports = plain_.ports().data();
  parameters = plain_.parameters().data();
  port_count = static_cast<std::uint32_t>(plain_.ports().size());
  parameter_count = static_cast<std::uint32_t>(plain_.parameters().size());
  create = &create_node;
  step = &step_node;
  counters = &count_of_node;
  destroy = &destroy_node;
}

PythonFile::PythonFile(const std::string& path, const spikeloop_host& host) {
  for (const py::handle definition : node_host().attr("load")(path)) {
    classes_.emplace_back(py::reinterpret_borrow<py::object>(definition), host);
    pointers_.push_back(&classes_.back());
  }
  plain_ = {sizeof(spikeloop_plugin), SPIKELOOP_ABI_VERSION, SPIKELOOP_BUILD, pointers_.data(),
            pointers_.size()};
}

}  // namespace spikeloop::python
