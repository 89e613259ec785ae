// Environments with Gymnasium's interface.
#include <pybind11/stl.h>

#include "interpreter.hpp"
#include "spikeloop/environments/script.hpp"

namespace spikeloop::python {

namespace py = pybind11;
using environments::Outcome;

namespace {

/// What went wrong in `work`, which has the lock. The traceback goes to the log.
template <typename Work>
std::string fault_of(const spikeloop_host& host, std::uint32_t level, Work&& work) {
  const Lock lock;
  try {
    work();
  } catch (const py::error_already_set& raised) {
    return described(raised, host, level);
  } catch (const std::exception& exception) {
    return exception.what();
  }
  return {};
}

class PythonEnvironment final : public environments::Script {
 public:
  /// Needs the lock.
  PythonEnvironment(const std::string& source, const spikeloop_host& host)
      : host_(host),
        hosted_(py::module_::import("spikeloop.environment_host").attr("make")(source)) {
    description_.name = source;
    description_.text = "An environment in Python";
    for (const py::handle row : hosted_.attr("quantities")()) {
      const auto [name, low, high] = row.cast<std::tuple<std::string, double, double>>();
      description_.observation.push_back({name, low, high});
    }
    description_.action = {{"action", hosted_.attr("action_low").cast<double>(),
                            hosted_.attr("action_high").cast<double>()}};
    description_.actions = hosted_.attr("actions").cast<std::uint32_t>();
    description_.max_steps = hosted_.attr("max_steps").cast<std::uint64_t>();
    description_.step = kNsPerSecond / 50;
  }
  PythonEnvironment(const PythonEnvironment&) = delete;
  PythonEnvironment& operator=(const PythonEnvironment&) = delete;
  ~PythonEnvironment() override {
    const Lock lock;
    hosted_ = py::object();
  }

  const environments::Description& description() const override { return description_; }

  std::string reset(std::uint64_t seed, std::uint64_t episode,
                    std::vector<double>& observation) override {
    return fault_of(host_, SPIKELOOP_LOG_WARNING, [&] {
      observation = hosted_.attr("reset")(seed, episode).cast<std::vector<double>>();
    });
  }

  std::string step(double action, std::vector<double>& observation, Outcome& outcome) override {
    return fault_of(host_, SPIKELOOP_LOG_WARNING, [&] {
      const py::tuple given = hosted_.attr("step")(action);
      observation = given[0].cast<std::vector<double>>();
      outcome = {.reward = given[1].cast<double>(),
                 .terminated = given[2].cast<bool>(),
                 .success = given[4].cast<bool>(),
                 .truncated = given[3].cast<bool>()};
    });
  }

 private:
  const spikeloop_host& host_;
  py::object hosted_;
  environments::Description description_;
};

}  // namespace
}  // namespace spikeloop::python

extern "C" __attribute__((visibility("default"))) spikeloop::environments::Script*
spikeloop_make_environment(const std::string& source, const spikeloop_host& host,
                           std::string& error) {
  namespace own = spikeloop::python;
  spikeloop::environments::Script* made = nullptr;
  try {
    own::start_package();
    error = own::fault_of(host, SPIKELOOP_LOG_INFO,
                          [&] { made = new own::PythonEnvironment(source, host); });
  } catch (const std::exception& exception) {
    error = exception.what();
  }
  return made;
}
