#include "fit_task.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

#include "output.hpp"
#include "spikeloop/core/registry.hpp"
#include "spikeloop/fit/samples.hpp"
#include "spikeloop/nodes/expression.hpp"
#include "spikeloop/nodes/register.hpp"
#include "spikeloop/record/reader.hpp"

namespace spikeloop::app {
namespace {

constexpr double kTraining = 0.75;  // of the samples
constexpr std::size_t kMostTraced = 4000;
constexpr double kTracedSeconds = 5;

/// A line on a terminal, written over and over again.
class ProgressLine {
 public:
  ~ProgressLine() {
    if (shown_) {
      put(stderr, "\r\033[K");
    }
  }
  void show(double part) {
    const auto now = Clock::now();
    if (terminal_ && now - last_ > std::chrono::milliseconds(200)) {
      put(stderr, fmt::format("\rspikeloop: {:.0f} % of the samples", 100 * part));
      last_ = now;
      shown_ = true;
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  bool terminal_ = ::isatty(STDERR_FILENO) == 1;
  bool shown_ = false;
  Clock::time_point last_ = Clock::now();
};

/// Each neuron has an encoding vector and weights, and a fit sums up 256 samples at once.
void check_memory(std::uint64_t neurons, std::uint64_t dimensions, std::uint64_t outputs) {
  constexpr std::uint64_t kMost = 100'000'000;  // numbers; 0.8 GB
  if (neurons * std::max(dimensions, outputs) > kMost) {
    throw ConfigurationError(fmt::format(
        "{} neurons for {} dimensions and {} outputs do not fit into memory; write fewer", neurons,
        dimensions, outputs));
  }
}

/// Takes samples in order: first those for training, then those to be judged by.
class Fit {
 public:
  Fit(std::uint32_t neurons, std::uint32_t outputs, double regularisation)
      : regularisation_(regularisation), regression_(neurons, outputs) {
    result_.neurons = neurons;
    result_.outputs = outputs;
    result_.trace.target.resize(outputs);
    result_.trace.decoded.resize(outputs);
  }

  void train(const fit::Sample& sample) { regression_.add(sample.activities, sample.targets); }

  void judge(const fit::Sample& sample) {
    if (!evaluation_) {
      solve();
    }
    const auto decoded = evaluation_->add(sample.activities, sample.targets);
    const auto [least, greatest] = std::ranges::minmax(sample.targets);
    least_ = std::min(least_, least);
    greatest_ = std::max(greatest_, greatest);
    trace(sample, decoded);
  }

  FitResult result() {
    if (!evaluation_) {
      solve();  // which may have more to complain of
      throw ConfigurationError("there is no sample to judge the weights by; fit to a longer time");
    }
    result_.held_out = evaluation_->errors();
    result_.range = greatest_ - least_;
    return std::move(result_);
  }

 private:
  void solve() {
    result_.weights = regression_.solve(regularisation_);
    result_.training = regression_.errors(result_.weights);
    evaluation_.emplace(result_.weights, result_.neurons);
  }

  void trace(const fit::Sample& sample, std::span<const double> decoded) {
    FitTrace& trace = result_.trace;
    const bool moves = sample.time_s > 0;
    if (trace.input.size() >= kMostTraced ||
        (moves && !trace.time_s.empty() && sample.time_s > trace.time_s[0] + kTracedSeconds)) {
      return;
    }
    if (moves) {
      trace.time_s.push_back(sample.time_s);
    }
    trace.input.push_back(sample.input.empty() ? 0 : sample.input[0]);
    for (std::size_t k = 0; k < decoded.size(); ++k) {
      trace.target[k].push_back(sample.targets[k]);
      trace.decoded[k].push_back(decoded[k]);
    }
  }

  double regularisation_;
  fit::Regression regression_;
  std::optional<fit::Evaluation> evaluation_;
  FitResult result_;
  double least_ = std::numeric_limits<double>::infinity();
  double greatest_ = -std::numeric_limits<double>::infinity();
};

WrittenValues written_keys(const std::vector<std::string>& keys) {
  WrittenValues written;
  for (const std::string& key : keys) {
    const auto equals = key.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw ConfigurationError(fmt::format(
          "'{}' is not a key of the encoder; write KEY=VALUE, as in max_rate_high=300", key));
    }
    written[key.substr(0, equals)] = {key.substr(equals + 1), {}};
  }
  return written;
}

void check_class(const NodeDescription& description) {
  const auto& ports = description.ports;
  const bool encodes = ports.size() == 2 && ports[0].kind == PortKind::signal &&
                       ports[0].direction == Direction::input &&
                       ports[1].kind == PortKind::spikes && ports[1].direction == Direction::output;
  if (!encodes) {
    throw ConfigurationError(
        fmt::format("'{}' is not an encoder: it does not turn one continuous input into spikes; "
                    "spikeloop describe lists the encoders",
                    description.name));
  }
}

/// The widths that the node would get from its connections.
void check_widths(const NodeDescription& description, const FitTask& task) {
  const WidthRule& in = description.ports[0].width;
  const WidthRule& out = description.ports[1].width;
  if (out.kind == WidthRule::Kind::same_as && task.neurons != task.dimensions) {
    throw ConfigurationError(fmt::format(
        "{} has one neuron a dimension, not {} for {}; write --neurons {} --dimensions {}",
        description.name, task.neurons, task.dimensions, task.neurons, task.neurons));
  }
  if ((in.kind == WidthRule::Kind::fixed && in.value != task.dimensions) ||
      (out.kind == WidthRule::Kind::fixed && out.value != task.neurons)) {
    throw ConfigurationError(fmt::format("{} has ports of other widths; see spikeloop describe {}",
                                         description.name, description.name));
  }
}

/// What a section with the same neurons says: an older program's defaults are others.
std::string section_of(const FitTask& task) {
  std::string text =
      fmt::format("[{}] binary=spikeloop-node node={} seed={}", task.name, task.encoder, task.seed);
  for (const std::string& key : task.keys) {
    text += " " + key;
  }
  return text;
}

/// Of the represented value, and how many outputs it has.
std::pair<fit::Function, std::uint32_t> function_of(const std::string& text,
                                                    std::uint32_t dimensions) {
  if (text.empty()) {
    return {[](std::span<const double> x, std::span<double> y) { std::ranges::copy(x, y.begin()); },
            dimensions};
  }
  auto expressions = std::make_shared<Expressions>(text, dimensions);
  const auto outputs = static_cast<std::uint32_t>(expressions->outputs());
  return {[expressions, text](std::span<const double> x, std::span<double> y) {
            expressions->evaluate(x, y);
            if (!std::ranges::all_of(y, [](double value) { return std::isfinite(value); })) {
              throw ConfigurationError(
                  fmt::format("--function '{}' has no value at x0 = {}; write one that is defined "
                              "for all inputs",
                              text, x[0]));
            }
          },
          outputs};
}

FitResult fit_encoder(const FitTask& task) {
  Registry registry;
  register_nodes(registry);
  const NodeClass& node_class = registry.find(task.encoder);
  check_class(node_class.description);
  check_widths(node_class.description, task);
  fit::Encoder encoder{
      .node_class = &node_class,
      .parameters = resolve(node_class.description.parameters, written_keys(task.keys), {}),
      .name = task.name,
      .seed = task.seed,
      .dimensions = task.dimensions,
      .neurons = task.neurons};
  if (encoder.parameters.all().contains("radius")) {
    encoder.radius = encoder.parameters.number("radius");
  }
  if (encoder.parameters.all().contains("out_of_range") &&
      encoder.parameters.text("out_of_range") == "pass") {
    encoder.bound = std::numeric_limits<double>::infinity();
  }
  const auto [function, outputs] = function_of(task.function, task.dimensions);
  check_memory(task.neurons, task.dimensions, outputs);
  Fit fit(task.neurons, outputs, task.regularisation);
  ProgressLine progress;
  if (task.from_rates) {
    const std::uint32_t points =
        task.points != 0 ? task.points : std::max(1000U, 10 * task.neurons);
    std::uint32_t done = 0;
    fit::sample_rates(encoder, points, 0, function, outputs, [&](const fit::Sample& sample) {
      fit.train(sample);
      progress.show(static_cast<double>(++done) / (4.0 / 3 * points));
    });
    fit::sample_rates(encoder, std::max(1U, points / 3), 1, function, outputs,
                      [&](const fit::Sample& sample) { fit.judge(sample); });
  } else {
    const fit::RunSettings settings{
        .tau_s = task.tau_s, .duration_s = task.duration_s, .cutoff_Hz = task.cutoff_Hz};
    const double settled_s = fit::settling_time_s(settings);
    const double split_s = settled_s + kTraining * (task.duration_s - settled_s);
    fit::sample_spikes(encoder, settings, function, outputs, [&](const fit::Sample& sample) {
      sample.time_s < split_s ? fit.train(sample) : fit.judge(sample);
      progress.show(sample.time_s / task.duration_s);
    });
  }
  FitResult result = fit.result();
  result.section = section_of(task);
  return result;
}

struct Stream {
  std::string file;
  record::FileInfo info;
  std::string name;
};

/// "run/encoder.h5:out": the file, and which of its streams; the only one when it is not named.
Stream stream_of(const std::string& written, const char* option, bool spikes) {
  const auto colon = written.rfind(".h5:");
  const std::string file = colon == std::string::npos ? written : written.substr(0, colon + 3);
  const record::FileInfo info = record::read_info(file);
  const auto& streams = spikes ? info.spikes : info.signals;
  if (colon != std::string::npos) {
    return {file, info, written.substr(colon + 4)};
  }
  if (streams.size() != 1) {
    throw ConfigurationError(fmt::format(
        "{} {}: the file has {} streams of {}; write one of them behind a colon: {}:STREAM{}",
        option, file, streams.size(), spikes ? "spikes" : "signals", file,
        streams.empty() ? "" : fmt::format(", as in {}:{}", file, streams.front())));
  }
  return {file, info, streams.front()};
}

/// What is not wrong, but should be known.
void warn_of(const Stream& stream, std::uint64_t dropped) {
  if (dropped > 0) {
    put(stderr, fmt::format("spikeloop: warning: {}: the recorder lost {} entries of the stream\n",
                            stream.file, dropped));
  }
  if (!stream.info.complete) {
    put(stderr, fmt::format("spikeloop: warning: {}: the recording was not closed\n", stream.file));
  }
}

void warn_of_two_runs(const Stream& a, const Stream& b) {
  if (a.info.seed != b.info.seed || a.info.tick != b.info.tick) {
    put(stderr, fmt::format("spikeloop: warning: {} and {} are of different runs (seed {} and {}, "
                            "tick {} and {})\n",
                            a.file, b.file, a.info.seed, b.info.seed, format_time(a.info.tick),
                            format_time(b.info.tick)));
  }
}

FitResult fit_recording(const FitTask& task) {
  const Stream spike_stream = stream_of(task.spikes, "--spikes", true);
  const Stream target_stream = stream_of(task.target, "--target", false);
  const auto spikes = record::read_spikes(spike_stream.file, spike_stream.name);
  const auto signal = record::read_signal(target_stream.file, target_stream.name);
  warn_of(spike_stream, spikes.dropped);
  warn_of(target_stream, signal.dropped);
  warn_of_two_runs(spike_stream, target_stream);
  if (spikes.width > kMostNeurons) {
    throw ConfigurationError(fmt::format("--spikes {}: {} channels; at most {} can be fitted",
                                         spike_stream.file, spikes.width, kMostNeurons));
  }
  const TimeNs end = std::min(spikes.until, signal.until);
  const auto [function, outputs] = function_of(task.function, signal.width);
  Fit fit(spikes.width, outputs, task.regularisation);
  const fit::RunSettings settings{.tau_s = task.tau_s};
  const double begin_s =
      signal.times.empty() ? 0 : to_seconds(signal.times[0]) + fit::settling_time_s(settings);
  const double split_s = begin_s + kTraining * (to_seconds(end) - begin_s);
  fit::sample_recording({.spikes = spikes.spikes,
                         .neurons = spikes.width,
                         .times = signal.times,
                         .values = signal.values,
                         .width = signal.width,
                         .end = end},
                        settings, function, outputs, [&](const fit::Sample& sample) {
                          sample.time_s < split_s ? fit.train(sample) : fit.judge(sample);
                        });
  return fit.result();
}

}  // namespace

FitResult fit_weights(const FitTask& task) {
  return task.encoder.empty() ? fit_recording(task) : fit_encoder(task);
}

}  // namespace spikeloop::app
