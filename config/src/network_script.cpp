#include "spikeloop/config/network_script.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <sstream>

#include "spikeloop/config/weight_file.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/core/files_read.hpp"
#include "spikeloop/core/reason.hpp"
#include "spikeloop/processes/process_tree.hpp"
#include "spikeloop/processes/python.hpp"
#include "spikeloop/processes/scratch_folder.hpp"

namespace spikeloop {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSuffix = ".py";
constexpr const char* kResult = "network.json";
constexpr const char* kParameters = "parameters";  // that the function takes
constexpr const char* kValues = "values";          // of them
constexpr const char* kFiles = "files";            // that the function opened, beside the script
constexpr std::uint64_t kMostScriptBytes = 1'000'000'000;

/// To the error stream. Returns whether more may come.
bool pass_on(int output) {
  std::array<char, 65536> text;
  ssize_t size = 0;
  while ((size = read(output, text.data(), text.size())) > 0) {
    for (ssize_t at = 0; at < size;) {
      const ssize_t written = write(STDERR_FILENO, text.data() + at, size - at);
      if (written < 0 && errno != EINTR) {
        return true;  // nobody reads: it is lost, as when Python wrote itself
      }
      at += std::max<ssize_t>(0, written);
    }
  }
  return size < 0;
}

/// Runs a module of our package to its end. Returns its exit code.
int run_python(const std::vector<std::string>& arguments, const ScratchFolder& scratch) {
  ProgramStart start{{python_name(), "-m"},
                     {{"PYTHONPATH", python_path()},
                      {"PYTHONSAFEPATH", "1"},  // no module of the working directory's
                      {"PYTHONUNBUFFERED", "1"}},
                     "",
                     scratch.descriptor()};
  start.arguments.insert(start.arguments.end(), arguments.begin(), arguments.end());
  ProcessTree python(start);
  pollfd files[] = {{python.fd(), POLLIN, 0}, {python.out(), POLLIN, 0}, {python.err(), POLLIN, 0}};
  while (!python.gone()) {
    files[0].fd = python.fd();
    poll(files, std::size(files), 100);
    for (pollfd& output : std::span(files).subspan(1)) {
      output.fd = output.fd >= 0 && pass_on(output.fd) ? output.fd : -1;
    }
  }
  pass_on(python.out());
  pass_on(python.err());
  return exit_code(python.status().value_or(0));
}

// What Python says of its own fault: the line in the file, 0 for none, and the text.
[[noreturn]] void refuse(const std::string& file, const std::string& function,
                         const fs::path& folder, int exit_code) {
  const fs::path fault = folder / "fault";
  if (!fs::exists(fault)) {
    throw ConfigurationError(
        {file, 0, 0}, with_code(Code::script,
                                "Python ended with exit code {} before the function '{}' was "
                                "over; what it said stands above",
                                exit_code, function));
  }
  const FilesRead unnoted;
  std::istringstream told(read_file(fault.string(), "fault", kMostScriptBytes));
  int line = 0;
  std::string text;
  told >> line >> std::ws;
  std::getline(told, text, '\0');
  throw ConfigurationError({file, line, line > 0 ? 1 : 0}, with_code(Code::script, text));
}

// The line of the user's file behind each line of the network file that Python wrote.
Location behind(const Location& where, const std::string& file, const fs::path& folder) {
  std::istringstream lines(
      read_file((folder / "lines").string(), "lines of the network file", kMostScriptBytes));
  int line = 0;
  for (int i = 0; i < where.line && lines >> line; ++i) {
  }
  return {file, line, line > 0 ? 1 : 0};
}

// Places in the file that Python wrote would tell nobody anything, nor do the names of its weights.
void set_places(NetworkFile& network, const Location& where, const fs::path& folder) {
  network.resolution_where = where;
  for (auto& population : network.populations) {
    population.where = where;
  }
  for (auto& projection : network.projections) {
    projection.where = where;
    if (projection.rule.starts_with(folder.string())) {
      projection.rule = "array";
    }
  }
  for (auto& record : network.record) {
    record.where = where;
  }
}

NetworkFile parse_result(const std::string& file, const fs::path& folder) {
  const std::string text = read_file((folder / kResult).string(), "network file", kMostScriptBytes);
  try {
    NetworkFile network = parse_network(text, file, [](const std::string& weights) {
      return read_weights(weights, {.short_forms = false});
    });
    set_places(network, {file, 0, 0}, folder);
    return network;
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(behind(error.where(), file, folder), reason_of(error));
  }
}

/// With the files that the function read, and without ours.
NetworkFile read_result(const std::string& file, const fs::path& folder) {
  std::set<std::string> files{file};
  NetworkFile network;
  {
    const FilesRead read;
    network = parse_result(file, folder);
    files.insert(read.paths().begin(), read.paths().end());
    std::istringstream opened(read_file((folder / kFiles).string(), "list", kMostScriptBytes));
    for (std::string path; std::getline(opened, path);) {
      files.insert(path);
    }
  }
  for (const std::string& path : files) {
    if (!path.starts_with(folder.string())) {
      FilesRead::note(path);
    }
  }
  return network;
}

/// Parameter.plain() of each argument.
std::vector<ParameterDescription> read_parameters(const fs::path& folder) {
  const FilesRead unnoted;
  std::vector<ParameterDescription> parameters;
  for (const nlohmann::json& plain : nlohmann::json::parse(
           read_file((folder / kParameters).string(), "parameters", kMostScriptBytes))) {
    ParameterDescription& parameter = parameters.emplace_back();
    parameter.name = plain[0];
    parameter.type = parameter_type(plain[1].get<std::string>());
    parameter.unit = plain[2];
    if (!plain[3].is_null()) {
      parameter.default_value = plain[3].get<std::string>();
    }
    parameter.minimum = plain[4].is_null() ? parameter.minimum : plain[4].get<double>();
    parameter.maximum = plain[5].is_null() ? parameter.maximum : plain[5].get<double>();
    parameter.choices = plain[6];
    parameter.text = plain[7];
  }
  return parameters;
}

/// Those that the user wrote; Python has the defaults.
std::string json_of(const std::vector<ParameterDescription>& parameters, const Parameters& values) {
  nlohmann::json written = nlohmann::json::object();
  for (const ParameterDescription& parameter : parameters) {
    const std::string& name = parameter.name;
    if (!values.given(name)) {
      continue;
    }
    switch (parameter.type) {
      case ParameterType::number:
        written[name] = values.number(name);
        break;
      case ParameterType::integer:
        written[name] = values.integer(name);
        break;
      case ParameterType::boolean:
        written[name] = values.boolean(name);
        break;
      default:
        written[name] = values.text(name);
    }
  }
  return written.dump();
}

}  // namespace

std::string network_source(const std::string& written) {
  const auto colon = written.rfind(':');
  const bool named = colon != std::string::npos && written.find('/', colon) == std::string::npos &&
                     std::string_view(written).substr(0, colon).ends_with(kSuffix);
  return named ? written.substr(0, colon) : written;
}

bool is_network_script(const std::string& written) {
  return network_source(written).ends_with(kSuffix);
}

NetworkScript::NetworkScript(const std::string& written) : written_(written) {
  run("");
}

NetworkFile NetworkScript::network(const Parameters& values) {
  if (!parameters_.empty()) {
    run(json_of(parameters_, values));
  }
  return std::move(network_);
}

// With `values` of the arguments, or for a first time without.
void NetworkScript::run(const std::string& values) {
  const std::string file = network_source(written_);
  const std::string function =
      file.size() == written_.size() ? "make" : written_.substr(file.size() + 1);
  if (!fs::exists(file)) {
    throw FileError("read the network's function from", file, ENOENT);
  }
  require_regular_file(file, "network script");
  require_code_may_run(fmt::format("network '{}'", written_));
  const ScratchFolder scratch(fs::temp_directory_path().string());
  const fs::path folder = scratch.path();
  if (!values.empty()) {
    write_file((folder / kValues).string(), values);
  }
  const int code = run_python({"spikeloop.network", file, function, folder.string()}, scratch);
  if (code == 0 && fs::exists(folder / kParameters)) {
    parameters_ = read_parameters(folder);
  } else if (code == 0 && fs::exists(folder / kResult)) {
    network_ = read_result(file, folder);
  } else {
    refuse(file, function, folder, code);
  }
}

}  // namespace spikeloop
