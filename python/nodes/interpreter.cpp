#include "interpreter.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace spikeloop::python {

namespace py = pybind11;
namespace fs = std::filesystem;

namespace {

std::string file_of(const void* symbol) {
  Dl_info found{};
  return dladdr(symbol, &found) != 0 && found.dli_fname != nullptr ? found.dli_fname : "";
}

/// PREFIX/share/spikeloop/python of an installed library, the sources' directory in the build tree.
std::string package_directory() {
  const fs::path library = fs::absolute(file_of(reinterpret_cast<const void*>(&start_interpreter)));
  const fs::path prefix = library.parent_path().parent_path().parent_path();
  const fs::path installed = prefix / "share/spikeloop/python";
  std::error_code error;
  return fs::exists(installed / "spikeloop", error) ? installed.string() : SPIKELOOP_PYTHON;
}

/// A virtual environment that is active counts when it is one of our version of Python.
std::string executable() {
  const char* written = std::getenv("VIRTUAL_ENV");
  const fs::path environment = written == nullptr ? "" : written;
  std::error_code error;
  const bool ours = !environment.empty() &&
                    fs::exists(environment / "lib/python" SPIKELOOP_PYTHON_VERSION, error);
  return ours ? (environment / "bin/python3").string() : SPIKELOOP_INTERPRETER;
}

/// Python's own extensions (NumPy's) expect its symbols to be in the program, but we were opened
/// with RTLD_LOCAL.
void make_python_global() {
  const std::string library = file_of(reinterpret_cast<const void*>(&Py_InitializeFromConfig));
  if (dlopen(library.c_str(), RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD) == nullptr) {
    throw std::runtime_error("Python's library '" + library + "' cannot be opened; reinstall it");
  }
}

void check(const PyStatus& status) {
  if (PyStatus_Exception(status) != 0) {
    throw std::runtime_error(std::string("Python does not start: ") +
                             (status.err_msg == nullptr ? "no reason given" : status.err_msg) +
                             "; unset PYTHONHOME and PYTHONPATH, or install python3 again");
  }
}

/// Python's own signal handlers stay out, Ctrl-C is the program's; so does the locale. Text is
/// UTF-8.
void initialize() {
  PyPreConfig before;
  PyPreConfig_InitPythonConfig(&before);
  before.configure_locale = 0;
  before.coerce_c_locale = 0;
  before.utf8_mode = 1;
  check(Py_PreInitialize(&before));
  PyConfig config;
  PyConfig_InitPythonConfig(&config);
  config.install_signal_handlers = 0;
  config.parse_argv = 0;
  const PyStatus named =
      PyConfig_SetBytesString(&config, &config.program_name, executable().c_str());
  const PyStatus started =
      PyStatus_Exception(named) != 0 ? named : Py_InitializeFromConfig(&config);
  PyConfig_Clear(&config);
  check(started);
}

py::module_*& imported_host() {
  static py::module_* host = nullptr;  // never deleted: the interpreter outlives everything
  return host;
}

}  // namespace

void start_interpreter() {
  if (Py_IsInitialized() != 0) {
    return;
  }
  make_python_global();
  initialize();
  PyEval_SaveThread();
}

void start_package() {
  start_interpreter();
  const Lock lock;
  try {
    node_host();
  } catch (const py::error_already_set& raised) {
    const std::string text = raised.what();
    throw std::runtime_error(
        "nodes in Python need NumPy and the package spikeloop: " + text.substr(0, text.find('\n')) +
        "; install python3-numpy, or Spikeloop again");
  }
}

const py::module_& node_host() {
  auto*& host = imported_host();
  if (host == nullptr) {
    py::module_::import("numpy");
    py::module_::import("sys").attr("path").attr("insert")(0, package_directory());
    py::module_ module = py::module_::import("spikeloop.node_host");
    module.attr("begin")();
    host = new py::module_(std::move(module));
  }
  return *host;
}

std::string described(const py::error_already_set& error, const spikeloop_host& host,
                      std::uint32_t level) {
  try {
    const py::tuple report = node_host().attr("report")(
        error.value(),
        error.trace() ? py::reinterpret_borrow<py::object>(error.trace()) : py::none());
    for (const py::handle line : report[1]) {
      host.log(level, line.cast<std::string>().c_str());
    }
    return report[0].cast<std::string>();
  } catch (py::error_already_set&) {
    // Out of memory, or out of stack: nothing can be said but what it is.
    const auto* type = reinterpret_cast<const PyTypeObject*>(error.type().ptr());
    return std::string(type->tp_name) + ", and an error while its place was looked for";
  }
}

void write_error(const std::string& text, char* error, std::uint64_t error_size) {
  const std::size_t length = std::min<std::size_t>(text.size(), error_size - 1);
  std::memcpy(error, text.data(), length);
  error[length] = '\0';
}

}  // namespace spikeloop::python
