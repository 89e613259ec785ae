#include "python_node.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "python_class.hpp"

namespace spikeloop::python {

namespace py = pybind11;

namespace {

/// An array over memory that is somebody else's. With a base that is not a buffer NumPy can neither
/// free the memory nor make a read-only array writable again.
py::array view_of(const py::dtype& type, const void* data, std::uint64_t count, bool writable) {
  py::array view(type, {static_cast<py::ssize_t>(count)},
                 {static_cast<py::ssize_t>(type.itemsize())}, data, py::none());
  if (!writable) {
    py::detail::array_proxy(view.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  }
  return view;
}

/// Arrays over the values of the ports of one direction; made anew only when the memory is another.
class SignalViews {
 public:
  SignalViews(std::uint64_t count, bool writable)
      : list_(count), pointers_(count, nullptr), writable_(writable) {}

  void show(std::size_t port, const double* values, std::uint32_t width) {
    if (values != pointers_[port] || list_[port].is_none()) {
      list_[port] = view_of(py::dtype::of<double>(), values, width, writable_);
      pointers_[port] = values;
    }
  }
  const py::list& list() const { return list_; }

 private:
  py::list list_;
  std::vector<const double*> pointers_;
  bool writable_;
};

/// The weights of a parameter as an array, outputs x inputs.
py::object table_of(const spikeloop_weights& weights) {
  py::array_t<double> table({weights.rows, weights.columns});
  auto values = table.mutable_unchecked<2>();
  std::fill_n(table.mutable_data(), table.size(), 0.0);
  for (std::uint32_t row = 0; row < weights.rows; ++row) {
    for (std::uint64_t i = weights.row_start[row]; i < weights.row_start[row + 1]; ++i) {
      values(row, weights.column[i]) = weights.value[i];
    }
  }
  return table;
}

py::object value_of(const spikeloop_value& value) {
  switch (value.type) {
    case SPIKELOOP_INTEGER:
      return py::int_(value.integer);
    case SPIKELOOP_BOOLEAN:
      return py::bool_(value.integer != 0);
    case SPIKELOOP_TEXT:
    case SPIKELOOP_CHOICE:
      return py::str(value.text);
    case SPIKELOOP_WEIGHTS:
      return table_of(*value.weights);
    default:
      return py::float_(value.number);
  }
}

std::size_t count_ports(const NodeDescription& description, PortKind kind, Direction direction) {
  return static_cast<std::size_t>(
      std::ranges::count_if(description.ports, [&](const PortDescription& port) {
        return port.kind == kind && port.direction == direction;
      }));
}

}  // namespace

/// Everything here needs the interpreter's lock.
class PythonNode {
 public:
  PythonNode(const PythonClass& node_class, const spikeloop_setup& setup)
      : host_(node_class.host()),
        values_(count_ports(node_class.description(), PortKind::signal, Direction::input), false),
        outputs_(count_ports(node_class.description(), PortKind::signal, Direction::output), true),
        revisions_(py::len(values_.list())),
        arrived_(count_ports(node_class.description(), PortKind::spikes, Direction::input)),
        spike_type_(node_host().attr("SPIKE")) {
    py::list widths;
    for (std::uint32_t i = 0; i < setup.width_count; ++i) {
      widths.append(setup.widths[i]);
    }
    py::dict parameters;
    for (std::uint32_t i = 0; i < setup.value_count; ++i) {
      parameters[setup.values[i].name] = value_of(setup.values[i]);
    }
    session_ = node_host().attr("create")(node_class.definition(), setup.name, setup.seed, widths,
                                          parameters);
    advance_ = session_.attr("advance");
  }

  void step(const spikeloop_step& data) {
    for (std::uint32_t i = 0; i < data.signal_input_count; ++i) {
      values_.show(i, data.signal_inputs[i].values, data.signal_inputs[i].width);
      revisions_[i] = data.signal_inputs[i].revision;
    }
    for (std::uint32_t i = 0; i < data.signal_output_count; ++i) {
      outputs_.show(i, data.signal_outputs[i].values, data.signal_outputs[i].width);
    }
    for (std::uint32_t i = 0; i < data.spike_input_count; ++i) {
      const auto& port = data.spike_inputs[i];
      arrived_[i] = view_of(spike_type_, port.spikes, port.count, false);
    }
    const py::tuple result =
        advance_(data.begin_ns, data.end_ns, values_.list(), revisions_, arrived_, outputs_.list());
    send(data, result[0], result[1]);
  }

  const std::vector<Counter>& counters() {
    counters_.clear();
    for (const py::handle counter : session_.attr("counters")()) {
      const auto pair = counter.cast<py::tuple>();
      counters_.push_back({pair[0].cast<std::string>(), pair[1].cast<std::uint64_t>()});
    }
    return counters_;
  }

  const spikeloop_host& host() const { return host_; }

 private:
  static void send(const spikeloop_step& data, const py::list& written, const py::list& emitted) {
    for (std::uint32_t i = 0; i < data.signal_output_count; ++i) {
      const auto revision = written[i].cast<std::int64_t>();
      if (revision != 0) {
        data.signal_outputs[i].revision =
            static_cast<std::uint64_t>(std::max<std::int64_t>(revision, 0));
      }
    }
    for (std::uint32_t i = 0; i < data.spike_output_count; ++i) {
      auto& port = data.spike_outputs[i];
      for (const py::handle part : emitted[i]) {
        const auto spikes = py::reinterpret_borrow<py::array>(part);
        port.append(port.sink, static_cast<const Spike*>(spikes.data()),
                    static_cast<std::uint64_t>(spikes.size()));
      }
    }
  }

  const spikeloop_host& host_;
  SignalViews values_;
  SignalViews outputs_;
  py::list revisions_;
  py::list arrived_;
  py::dtype spike_type_;
  py::object session_;
  py::object advance_;
  std::vector<Counter> counters_;  // keeps the names
};

namespace {

/// What `work` returns, or `failure`, with the text of what it threw in `error`. Takes the lock.
/// The traceback is a warning in a run; before it, `spikeloop check` counts warnings.
template <typename Work, typename Result>
Result guarded(const spikeloop_host& host, std::uint32_t level, char* error,
               std::uint64_t error_size, Result failure, Work&& work) {
  const Lock lock;
  try {
    return work();
  } catch (const py::error_already_set& raised) {
    write_error(described(raised, host, level), error, error_size);
  } catch (const std::exception& exception) {
    write_error(exception.what(), error, error_size);
  }
  return failure;
}

}  // namespace

void* create_node(const spikeloop_setup* setup, char* error, std::uint64_t error_size) {
  const auto& node_class = static_cast<const PythonClass&>(*setup->node_class);
  return guarded(node_class.host(), SPIKELOOP_LOG_INFO, error, error_size,
                 static_cast<void*>(nullptr),
                 [&]() -> void* { return new PythonNode(node_class, *setup); });
}

int step_node(void* node, const spikeloop_step* step, char* error, std::uint64_t error_size) {
  auto& self = *static_cast<PythonNode*>(node);
  return guarded(self.host(), SPIKELOOP_LOG_WARNING, error, error_size, 1, [&] {
    self.step(*step);
    return 0;
  });
}

std::uint32_t count_of_node(void* node, spikeloop_counter* counters, std::uint32_t capacity,
                            char* error, std::uint64_t error_size) {
  auto& self = *static_cast<PythonNode*>(node);
  return guarded(self.host(), SPIKELOOP_LOG_WARNING, error, error_size, SPIKELOOP_FAILED, [&] {
    const auto& all = self.counters();
    const auto count = static_cast<std::uint32_t>(std::min<std::size_t>(all.size(), capacity));
    for (std::uint32_t i = 0; i < count; ++i) {
      counters[i] = {all[i].name.c_str(), all[i].value};
    }
    return count;
  });
}

void destroy_node(void* node) {
  const Lock lock;
  delete static_cast<PythonNode*>(node);
}

}  // namespace spikeloop::python
