// The module spikeloop_python_music: what python/spikeloop/music_host.py calls.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "host.hpp"
#include "parameter_values.hpp"
#include "spike_arrays.hpp"
#include "spikeloop/process/music_main.hpp"
#include "spikeloop/status/signals.hpp"

namespace py = pybind11;

namespace spikeloop::python {
namespace {

template <typename T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  return pointers;
}

/// (name, "spikes" or "signal", whether an input, width or 0)
DeclaredPort port_of(const py::tuple& plain) {
  return {plain[0].cast<std::string>(),
          plain[1].cast<std::string>() == "spikes" ? PortKind::spikes : PortKind::signal,
          plain[2].cast<bool>() ? Direction::input : Direction::output,
          plain[3].cast<std::uint32_t>()};
}

/// Of a simulator that does MUSIC's Setup itself: before it, and between it and the host.
std::optional<music::SimulatorsMusic>& simulators_music() {
  static std::optional<music::SimulatorsMusic> section;
  return section;
}
std::unique_ptr<music::Process>& process_beside() {
  static auto* const process = new std::unique_ptr<music::Process>;
  return *process;
}

/// argv of the process, as MUSIC's Setup wants it.
std::unique_ptr<Host> make_host(std::vector<std::string> arguments, const py::list& ports,
                                const py::list& parameters, bool many_processes) {
  std::vector<DeclaredPort> declared;
  for (const py::handle port : ports) {
    declared.push_back(port_of(port.cast<py::tuple>()));
  }
  std::vector<ParameterDescription> described;
  for (const py::handle parameter : parameters) {
    described.push_back(parameter_of(parameter.cast<py::tuple>()));
  }
  if (process_beside() != nullptr) {
    return std::make_unique<Host>(std::move(process_beside()), std::move(declared),
                                  std::move(described));
  }
  const py::gil_scoped_release free;  // Setup meets the other programs
  return std::make_unique<Host>(std::move(arguments), std::move(declared), std::move(described),
                                many_processes);
}

/// argv of the process.
void before_simulators_setup(std::vector<std::string> arguments) {
  std::vector<char*> pointers = pointers_to(arguments);
  simulators_music() =
      music::before_simulators_setup(static_cast<int>(pointers.size()), pointers.data());
}

void after_simulators_setup() {
  process_beside() = std::make_unique<music::Process>(
      simulators_music().value(), music::CommonDefaults{.takes_arguments = true});
}

/// The label, once it is known who we are. From now on signals are ours, for the rest of the
/// process's life: what the script does after its loop must not make it deaf.
std::string take_signals(std::vector<std::string> arguments) {
  std::vector<char*> pointers = pointers_to(arguments);
  const auto count = static_cast<int>(pointers.size());
  const std::string label = music::section_label(count, pointers.data());
  static const auto* const signals = new status::SignalThread;
  (void)signals;
  music::log_to_standard_error(label);
  return label;
}

bool started_by_music(std::vector<std::string> arguments) {
  std::vector<char*> pointers = pointers_to(arguments);
  return music::started_by_music(static_cast<int>(pointers.size()), pointers.data());
}

py::dict values_of(const Parameters& parameters) {
  py::dict values;
  for (const auto& [name, value] : parameters.all()) {
    std::visit(
        [&](const auto& plain) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(plain)>, WeightTable>) {
            values[py::str(name)] = py::cast(plain);
          }
        },
        value);
  }
  return values;
}

py::object begin(Host& host) {
  std::optional<Interval> interval;
  {
    const py::gil_scoped_release free;
    interval = host.begin();
  }
  return interval ? py::object(py::make_tuple(interval->begin, interval->end)) : py::none();
}

py::tuple spikes(const Host& host, std::size_t i) {
  return spike_arrays(host.inbox().spikes(i));
}

/// (channels that have spikes, for each of them its times in ms, sorted) on a simulator's grid: to
/// the nearest tic, up to the grid's next point, and to the first one after `begin` what is late.
/// All in ns.
py::tuple spikes_on_grid(const Host& host, std::size_t i, TimeNs tic, TimeNs grid, TimeNs begin) {
  std::map<std::int32_t, std::vector<double>> times;
  std::vector<std::pair<std::int32_t, TimeNs>> steps;
  for (const Spike& spike : host.inbox().spikes(i)) {
    const TimeNs time = (spike.time_ns + tic / 2) / tic * tic;
    steps.emplace_back(spike.channel, std::max((time + grid - 1) / grid, begin / grid + 1));
  }
  std::ranges::sort(steps);
  for (const auto& [channel, step] : steps) {
    times[channel].push_back(static_cast<double>(step * grid) / 1e6);
  }
  py::list channels;
  py::list arrays;
  for (const auto& [channel, values] : times) {
    channels.append(channel);
    arrays.append(py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data()));
  }
  return py::make_tuple(channels, arrays);
}

/// (values, revision), a copy; revision 0: no value yet.
py::tuple signal(const Host& host, std::size_t i) {
  const auto& value = host.inbox().signal(i);
  return py::make_tuple(
      py::array_t<double>(static_cast<py::ssize_t>(value.values.size()), value.values.data()),
      value.revision);
}

void send(Host& host, std::size_t i, const Array<std::int64_t>& times,
          const Array<std::int32_t>& channels) {
  if (times.size() != channels.size()) {
    throw std::logic_error("as many times as channels");
  }
  auto& spikes = host.outbox().spikes(i);
  for (py::ssize_t k = 0; k < times.size(); ++k) {
    spikes.push_back(make_spike(times.data()[k], channels.data()[k]));
  }
}

void write(Host& host, std::size_t i, const Array<double>& values) {
  host.outbox().write(i, {values.data(), static_cast<std::size_t>(values.size())});
}

template <void (Host::*method)()>
void unlocked(Host& host) {
  const py::gil_scoped_release free;
  (host.*method)();
}

void let_the_first_speak(const Host& host) {
  const py::gil_scoped_release free;
  host.process().let_the_first_speak();
}

void bind_host(py::module_& module) {
  py::class_<Host>(module, "Host")
      .def(py::init(&make_host))
      .def("begin", &begin)
      .def("end", &unlocked<&Host::end>)
      .def("finish", &unlocked<&Host::finish>)
      .def("spikes", &spikes)
      .def("spikes_on_grid", &spikes_on_grid)
      .def("signal", &signal)
      .def("send", &send)
      .def("write", &write)
      .def("widths", &Host::widths)
      .def("connected", &Host::connected)
      .def("arguments", &Host::arguments)
      .def("parameters", [](const Host& host) { return values_of(host.parameters()); })
      .def("processes", [](const Host& host) { return host.process().share().parts; })
      .def("communicator", [](const Host& host) { return host.process().communicator(); })
      .def("let_the_first_speak", &let_the_first_speak)
      .def("label", [](const Host& host) { return host.process().label(); })
      .def("directory", &Host::directory)
      .def("tick", [](const Host& host) { return host.process().common().music_timestep; })
      .def("stoptime", [](const Host& host) { return host.process().common().stoptime; })
      .def("seed", [](const Host& host) { return host.process().common().seed; })
      .def("accept_latency",
           [](const Host& host) { return host.process().common().accept_latency; })
      .def("spike_delay", [](const Host& host) { return host.process().common().spike_delay; })
      .def("signal_delay", [](const Host& host) { return host.process().common().signal_delay; })
      .def("record", [](const Host& host) { return host.process().common().record; });
}

}  // namespace
}  // namespace spikeloop::python

PYBIND11_MODULE(spikeloop_python_music, module) {
  using namespace spikeloop;
  static auto* const error = new py::exception<Error>(module, "SectionError");
  py::register_exception_translator([](std::exception_ptr raised) {
    try {
      std::rethrow_exception(raised);
    } catch (const Error& fault) {
      const py::object made = error->attr("__call__")(fault.what());
      made.attr("exit_code") = fault.exit_code();
      PyErr_SetObject(error->ptr(), made.ptr());
    }
  });
  python::bind_host(module);
  module.def("take_signals", &python::take_signals);
  module.def("started_by_music", &python::started_by_music);
  module.def("before_simulators_setup", &python::before_simulators_setup);
  module.def("after_simulators_setup", &python::after_simulators_setup);
  module.def("stop_requested", &status::stop_requested);
  module.def("end_job", [](const std::string& label, int exit_code, const std::string& message) {
    const py::gil_scoped_release free;
    return music::end_job(label, exit_code, message);
  });
}
