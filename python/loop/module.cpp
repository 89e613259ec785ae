// The module spikeloop_python_loop: what python/spikeloop/experiment.py calls.
#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <mutex>
#include <optional>

#include "caller.hpp"
#include "failure.hpp"
#include "spike_arrays.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/log.hpp"
#include "spikeloop/experiment/layout.hpp"
#include "spikeloop/experiment/simulators.hpp"
#include "spikeloop/fused/robot_sensors.hpp"
#include "spikeloop/fused/run.hpp"

namespace py = pybind11;

namespace spikeloop::python {
namespace {

template <typename T>
using Array = py::array_t<T, py::array::c_style | py::array::forcecast>;

/// Warnings of the run, until somebody asks for them. A run may log from any thread.
class Warnings {
 public:
  Warnings() {
    log::set_sink([this](log::Level level, std::string_view message) {
      if (level >= log::Level::warning) {
        const std::scoped_lock lock(mutex_);
        texts_.emplace_back(message);
      }
    });
  }
  ~Warnings() { log::set_sink({}); }
  Warnings(const Warnings&) = delete;
  Warnings& operator=(const Warnings&) = delete;
  std::vector<std::string> take() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(texts_, {});
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> texts_;
};

/// All nodes but simulators are in this process, which has no ROS.
void refuse_others(const experiment::Experiment& experiment) {
  if (experiment.ros != experiment::Ros::none) {
    throw ConfigurationError(
        with_code(Code::conflicting_keys,
                  "an experiment that is stepped from Python has its robot in the same process; "
                  "leave out  ros: {}",
                  experiment::name_of(experiment.ros)));
  }
  if (experiment.layout.processes.size() > 1) {
    throw ConfigurationError(
        experiment.layout.where,
        with_code(Code::layout,
                  "an experiment that is stepped from Python has one process; write  "
                  "layout: fused"));
  }
}

class Loop {
 public:
  /// @param settings JSON. @param folder of the run, which is there; empty: none
  Loop(const std::string& file, const std::string& settings, const std::string& folder)
      : loaded_(experiment::load(file, {.settings = settings_from_text(settings)},
                                 fused::look_at_robot)) {
    if (!loaded_->diagnostics.empty()) {
      throw ConfigurationError(loaded_->diagnostics.front().text());
    }
    refuse_others(*loaded_->experiment);
    experiment_ = experiment::with_layout_delays(*loaded_->experiment);
    caller_.emplace(experiment_);
    options_.folder = folder;
    options_.record = !folder.empty();
    for (const experiment::Node& node : experiment_.nodes) {
      if (experiment::is_simulator(node)) {
        options_.about["caller"].push_back(node.name);
      }
    }
    options_.observe = [this](const std::string& end, PortKind kind, std::uint32_t width) {
      return caller_->observe(end, kind, width);
    };
    transport_ = fused::make_transport(experiment_, options_);
    run_.emplace(experiment_, *transport_, options_, events_, &*caller_);
  }

  /// Returns how many there were. Looks for signals of Python's.
  std::uint64_t step(std::uint64_t ticks) {
    const auto use = in_use();
    caller_->forget_spikes();
    std::uint64_t done = 0;
    TimeNs looked = wall_now();
    while (done < ticks && run_->tick()) {
      ++done;
      if (const TimeNs now = wall_now(); now > looked + kSignals) {
        looked = now;
        const py::gil_scoped_acquire python;
        if (PyErr_CheckSignals() != 0) {
          throw py::error_already_set();
        }
      }
    }
    return done;
  }

  fused::RunResult finish() {
    const auto use = in_use();
    return run_->finish();
  }

  /// One thread at a time. @throws ConfigurationError
  std::unique_lock<std::mutex> in_use() {
    std::unique_lock lock(use_, std::try_to_lock);
    if (!lock) {
      throw ConfigurationError(with_code(
          Code::conflicting_keys, "another thread uses this loop; let one thread alone step it"));
    }
    return lock;
  }
  TimeNs time() const { return run_->time(); }
  TimeNs tick() const { return experiment_.tick; }
  Caller& caller() { return *caller_; }
  const robot::Episodes* episodes() const { return transport_->episodes(); }
  std::vector<std::string> warnings() { return warnings_.take(); }

 private:
  static constexpr TimeNs kSignals = kNsPerSecond / 20;

  std::mutex use_;
  Warnings warnings_;
  std::unique_ptr<experiment::Loaded> loaded_;
  experiment::Experiment experiment_;
  std::optional<Caller> caller_;
  fused::RunOptions options_;
  fused::RunEvents events_;
  std::unique_ptr<fused::Transport> transport_;
  std::optional<fused::Run> run_;
};

const Seen& seen(Loop& loop, const std::string& end, PortKind kind) {
  const Seen& found = loop.caller().seen(end);
  if (found.kind != kind) {
    throw ConfigurationError(with_code(Code::kinds_differ, "'{}' carries {}; write {}", end,
                                       kind == PortKind::spikes ? "a continuous signal" : "spikes",
                                       kind == PortKind::spikes ? "loop.signal" : "loop.spikes"));
  }
  return found;
}

py::tuple spikes(Loop& loop, const std::string& end) {
  const auto use = loop.in_use();
  return spike_arrays(seen(loop, end, PortKind::spikes).spikes);
}

py::object signal(Loop& loop, const std::string& end) {
  const auto use = loop.in_use();
  const auto& values = seen(loop, end, PortKind::signal).values;
  if (values.empty()) {
    return py::none();
  }
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

Sent& of_kind(Loop& loop, const std::string& end, PortKind kind) {
  Sent& sent = loop.caller().sent(end);
  if (sent.kind != kind) {
    throw ConfigurationError(with_code(Code::kinds_differ, "'{}' carries {}; write {}", end,
                                       kind == PortKind::spikes ? "a continuous signal" : "spikes",
                                       kind == PortKind::spikes ? "loop.write" : "loop.send"));
  }
  return sent;
}

/// Of the interval that was stepped last.
void send(Loop& loop, const std::string& end, const Array<std::int64_t>& times,
          const Array<std::int64_t>& channels) {
  const auto use = loop.in_use();
  Sent& sent = of_kind(loop, end, PortKind::spikes);
  if (times.size() != channels.size()) {
    throw ConfigurationError(with_code(Code::widths_differ,
                                       "'{}': {} times and {} channels; give "
                                       "as many of one as of the other",
                                       end, times.size(), channels.size()));
  }
  std::vector<Spike> spikes;
  for (py::ssize_t i = 0; i < times.size(); ++i) {
    const TimeNs time = times.data()[i];
    const std::int64_t channel = channels.data()[i];
    if (time <= loop.time() - loop.tick() || time > loop.time()) {
      throw ConfigurationError(with_code(
          Code::out_of_bounds, "'{}': a spike at {} is not in the last tick, ({}, {}]", end,
          format_time(time), format_time(loop.time() - loop.tick()), format_time(loop.time())));
    }
    if (channel < 0 || channel >= sent.width) {
      throw ConfigurationError(with_code(Code::out_of_bounds,
                                         "'{}': there is no channel {}; write one from 0 to {}",
                                         end, channel, sent.width - 1));
    }
    spikes.push_back(make_spike(time, static_cast<std::int32_t>(channel)));
  }
  sent.spikes.insert(sent.spikes.end(), spikes.begin(), spikes.end());
}

void write(Loop& loop, const std::string& end, const Array<double>& values) {
  const auto use = loop.in_use();
  Sent& sent = of_kind(loop, end, PortKind::signal);
  if (values.size() != sent.width) {
    throw ConfigurationError(with_code(Code::widths_differ,
                                       "'{}' has {} channels; give as many "
                                       "values, not {}",
                                       end, sent.width, values.size()));
  }
  sent.values.assign(values.data(), values.data() + values.size());
  sent.is_new = true;
}

/// The robot's newest episode; None: it has no task.
py::object episode(Loop& loop) {
  const auto use = loop.in_use();
  const robot::Episodes* const episodes = loop.episodes();
  if (episodes == nullptr) {
    return py::none();
  }
  py::dict result;
  result["number"] = episodes->number();
  result["running"] = episodes->running();
  result["steps"] = episodes->steps();
  result["return"] = episodes->total();
  result["terminated"] = episodes->terminated();
  result["success"] = episodes->success();
  result["step_ns"] = episodes->step_time();
  return result;
}

template <typename Ends>
py::dict ends_of(const Ends& ends) {
  py::dict result;
  for (const auto& [end, value] : ends) {
    result[py::str(end)] =
        py::make_tuple(value.kind == PortKind::spikes ? "spikes" : "signal", value.width);
  }
  return result;
}

/// (exit code, reason, summary as JSON)
py::tuple finish(Loop& loop) {
  fused::RunResult result;
  {
    const py::gil_scoped_release free;
    result = loop.finish();
  }
  return py::make_tuple(result.exit_code, result.reason, result.summary.dump());
}

}  // namespace
}  // namespace spikeloop::python

PYBIND11_MODULE(spikeloop_python_loop, module) {
  namespace own = spikeloop::python;
  using own::Loop;
  own::register_failure(module);
  py::class_<Loop>(module, "Loop")
      .def(py::init<const std::string&, const std::string&, const std::string&>(),
           py::call_guard<py::gil_scoped_release>())
      .def("step", &Loop::step, py::call_guard<py::gil_scoped_release>())
      .def("time", &Loop::time)
      .def("tick", &Loop::tick)
      .def("warnings", &Loop::warnings)
      .def("spikes", &own::spikes)
      .def("signal", &own::signal)
      .def("send", &own::send)
      .def("write", &own::write)
      .def("outputs", [](Loop& loop) { return own::ends_of(loop.caller().all_seen()); })
      .def("inputs", [](Loop& loop) { return own::ends_of(loop.caller().all_sent()); })
      .def("episode", &own::episode)
      .def("finish", &own::finish);
}
