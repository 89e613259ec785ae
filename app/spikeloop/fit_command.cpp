#include "commands.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>

#include "fit_task.hpp"
#include "option_values.hpp"
#include "output.hpp"
#include "python_package.hpp"
#include "spikeloop/config/npy_file.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/file.hpp"
#include "spikeloop/processes/python.hpp"

namespace spikeloop::app::fit_command {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFooter = R"(Examples:
  spikeloop fit nef_encoder --neurons 200 --out readout.json
  spikeloop fit nef_encoder max_rate_high=300 --dimensions 2 --function "x0*x1" --out product.npy
  spikeloop fit nef_encoder --rates                     fits steady rates: no spikes, no kernel
  spikeloop fit --spikes run/encoder.h5 --target run/sensor.h5 --out readout.json

The neurons are those of a section with the same label (--name), seed and keys. The output shows
this section, because the older program names have other defaults.
Without --rates the input is band-limited noise, and spikes and target are filtered with the kernel
of the decoder, exp(-t / tau) / tau. The weights minimise
|activities weights - target|^2 + (regularisation * highest activity)^2 |weights|^2 over the first
three quarters of the samples. The held-out error is that of the last quarter.

The weights are a .json or .npy file, one row per output: weights=FILE in a linear_readout_decoder
with the same tau. A .json file has tau, too, and a readout with another one refuses it.

Exit codes: 0 success, 2 an option is invalid, 4 a file cannot be read or written)";

/// Weights of filtered spikes hold for one time constant, which is written with them.
void write_json(const std::string& path, const FitTask& task, const FitResult& result) {
  const bool filtered = !task.from_rates;
  std::string text = filtered ? fmt::format("{{\"tau_s\": {},\n\"weights\":\n", task.tau_s) : "";
  for (std::uint32_t row = 0; row < result.outputs; ++row) {
    const auto weights = std::span(result.weights).subspan(std::size_t{row} * result.neurons);
    text += fmt::format("{}{}]", row == 0 ? "[[" : ",\n [",
                        fmt::join(weights.first(result.neurons), ", "));
  }
  write_file(path, text + (filtered ? "]}\n" : "]\n"));
}

void write_weights(const FitTask& task, const FitResult& result) {
  const std::string& path = task.out;
  path.ends_with(".npy") ? write_npy(path, result.outputs, result.neurons, result.weights)
                         : write_json(path, task, result);
}

void draw(const FitTask& task, const FitResult& result) {
  const nlohmann::json data{{"title", task.encoder.empty() ? task.spikes : task.encoder},
                            {"time_s", result.trace.time_s},
                            {"input", result.trace.input},
                            {"target", result.trace.target},
                            {"decoded", result.trace.decoded},
                            {"training_error", result.training.total},
                            {"held_out_error", result.held_out.total}};
  if (!feed({"env", "PYTHONSAFEPATH=1", "PYTHONPATH=" + python_package(), "/usr/bin/python3", "-m",
             "spikeloop.fit_plot", fs::absolute(task.picture).string()},
            data.dump())) {
    throw FileError(fmt::format("the picture {} was not drawn; python3-matplotlib says above why",
                                task.picture));
  }
}

std::string report(const FitTask& task, const FitResult& result) {
  const std::string source =
      task.from_rates ? "rates" : fmt::format("spikes, tau {:g} s", task.tau_s);
  const std::string part = result.range > 0
                               ? fmt::format("   {:.2f} % of the target's range",
                                             100 * result.held_out.total / result.range)
                               : std::string("   of a target that stays the same");
  return fmt::format(
      "{}: {}, {}, {} ({})\n"
      "training error   {:.6f}\n"
      "held-out error   {:.6f}{}\n",
      task.encoder.empty() ? task.spikes : task.encoder, count_of(result.neurons, "neuron"),
      count_of(result.outputs, "output"), count_of(result.training.samples, "sample"), source,
      result.training.total, result.held_out.total, part);
}

/// Before hours of work.
void check_writable(const std::string& file) {
  if (file.empty()) {
    return;
  }
  const fs::path folder = fs::absolute(file).parent_path();
  if (::access(folder.c_str(), W_OK) != 0) {
    throw FileError("write to the folder of", file, errno);
  }
}

void check(const FitTask& task) {
  const bool recorded = !task.spikes.empty() || !task.target.empty();
  if (recorded == !task.encoder.empty()) {
    throw ConfigurationError(
        "fit takes an encoder or a recording: write  spikeloop fit nef_encoder  or  spikeloop fit "
        "--spikes FILE.h5 --target FILE.h5");
  }
  if (recorded && (task.spikes.empty() || task.target.empty())) {
    throw ConfigurationError("--spikes and --target belong together; write both");
  }
  if (!task.out.empty() && !task.out.ends_with(".npy") && !task.out.ends_with(".json")) {
    throw ConfigurationError(fmt::format(
        "--out {}: the name does not say the format; write a name with .json or .npy", task.out));
  }
  if (!task.picture.empty() && !task.picture.ends_with(".png")) {
    throw ConfigurationError(
        fmt::format("--picture {}: write the name of a .png file", task.picture));
  }
  check_writable(task.out);
  check_writable(task.picture);
}

FitResult fitted(const FitTask& task) {
  try {
    return fit_weights(task);
  } catch (const std::bad_alloc&) {
    throw ConfigurationError(
        "there is not enough memory for so many neurons; write fewer --neurons");
  }
}

int fit(const FitTask& task) {
  check(task);
  const FitResult result = fitted(task);
  put_result(report(task, result));
  if (!result.section.empty()) {
    put_result(fmt::format("section          {}\n", result.section));
  }
  if (!task.out.empty()) {
    write_weights(task, result);
    put_result(fmt::format("weights          {}\n", task.out));
  }
  if (!task.picture.empty()) {
    draw(task, result);
    put_result(fmt::format("picture          {}\n", task.picture));
  }
  return 0;
}

/// From `least` to `most`, which CLI11's own check would let NaN pass.
CLI::Validator between(double least, double most) {
  return {[least, most](const std::string& text) {
            double value = 0;
            const bool good =
                CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
            return good ? std::string()
                        : fmt::format("'{}' is not a number from {:g} to {:g}; write one", text,
                                      least, most);
          },
          ""};
}

/// What draws neurons and makes them fire; a recording has it all.
std::vector<CLI::Option*> add_encoder_options(CLI::App& command, FitTask& task) {
  auto* neurons = command.add_option("--neurons", task.neurons, "Number of neurons")
                      ->check(CLI::Range(1U, kMostNeurons))
                      ->capture_default_str();
  auto* dimensions = command.add_option("--dimensions", task.dimensions, "Input channels")
                         ->check(CLI::Range(1U, 1000U))
                         ->capture_default_str();
  auto* name = command.add_option("--name", task.name, "Label of the encoder's section")
                   ->check(named("section"))
                   ->type_name("LABEL")
                   ->capture_default_str();
  auto* seed = command.add_option_function<std::string>(
      "--seed", [&task](const std::string& text) { task.seed = app::seed(text); },
      "Seed of the random numbers [1]");
  seed->type_name("NUMBER");
  auto* rates = command.add_flag("--rates", task.from_rates,
                                 "Fit to steady rates instead of filtered spikes");
  auto* points = command.add_option("--points", task.points, "Inputs for --rates [10 per neuron]")
                     ->check(CLI::Range(10U, 10'000'000U))
                     ->needs(rates);
  auto* duration = command.add_option("--duration", task.duration_s, "Simulated time, s")
                       ->check(between(0.1, 1e6))
                       ->excludes(rates)
                       ->capture_default_str();
  auto* cutoff =
      command.add_option("--cutoff", task.cutoff_Hz, "Highest frequency of the input noise, Hz")
          ->check(between(1e-3, 1000.0))
          ->excludes(rates)
          ->capture_default_str();
  return {neurons, dimensions, name, seed, rates, points, duration, cutoff};
}

void add_options(CLI::App& command, FitTask& task) {
  command.add_option("ENCODER", task.encoder, "Node class of the encoder");
  command.add_option("KEY=VALUE", task.keys, "Keys of the encoder");
  const auto of_encoder = add_encoder_options(command, task);
  auto* spikes =
      command.add_option("--spikes", task.spikes, "Recorded spikes, FILE.h5 or FILE.h5:STREAM");
  for (CLI::Option* option : of_encoder) {
    spikes->excludes(option);
  }
  command.add_option("--target", task.target, "Recorded signal to decode, in the same form");
  command
      .add_option("--function", task.function,
                  "Function to decode: expressions of x0, x1, ..., separated by ';'")
      ->type_name("EXPRESSION");
  command.add_option("--tau", task.tau_s, "Time constant of the decoder's kernel, s")
      ->check(between(1e-4, 100.0))
      ->capture_default_str();
  command.add_option("--regularisation", task.regularisation, "Fraction of the highest activity")
      ->check(between(0.0, 100.0))
      ->capture_default_str();
  command.add_option("--out", task.out, "File for the weights, .json or .npy");
  command.add_option("--picture", task.picture, "Figure of target, decoded signal and error, .png");
}

}  // namespace

void add(CLI::App& app, Action& action) {
  const auto task = std::make_shared<FitTask>();
  CLI::App* command = app.add_subcommand("fit", "Fit the weights of a decoder");
  add_options(*command, *task);
  command->footer(kFooter);
  command->callback([task, &action] { action = [task] { return fit(*task); }; });
}

}  // namespace spikeloop::app::fit_command
