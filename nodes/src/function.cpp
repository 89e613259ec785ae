// `function`: expressions of the inputs, written in the section.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include "held_input.hpp"
#include "spikeloop/core/code.hpp"
#include "spikeloop/core/node.hpp"
#include "spikeloop/nodes/expression.hpp"

namespace spikeloop {

namespace {

Expressions expressions_of(const NodeSetup& setup) {
  const Parameters& given = setup.parameters;
  try {
    Expressions expressions(given.text("function"), setup.widths[0]);
    if (expressions.outputs() != setup.widths[1]) {
      throw ConfigurationError(
          with_code(Code::widths_differ,
                    "there are {} expressions, but port 'out' has {} channels; write one an "
                    "output, separated by ';'",
                    expressions.outputs(), setup.widths[1]));
    }
    return expressions;
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(given.where("function"),
                             fmt::format("key 'function': {}", error.what()));
  }
}

class Function final : public Node {
 public:
  explicit Function(const NodeSetup& setup)
      : input_(setup),
        expressions_(expressions_of(setup)),
        not_finite_(setup.parameters.text("not_finite")),
        arguments_(setup.widths[0]),
        results_(setup.widths[1]),
        values_(setup.widths[1], std::numeric_limits<double>::quiet_NaN()) {}

  void step(const Step& step) override {
    if (!input_.update(step)) {
      return;
    }
    const SignalOutput output = step.signal_output();
    if (!step.signal_input().valid()) {
      output.invalidate();
      return;
    }
    input_.copy_to(arguments_);
    expressions_.evaluate(arguments_, results_);
    for (std::size_t k = 0; k < values_.size(); ++k) {
      values_[k] = std::isfinite(results_[k]) ? results_[k] : instead(k);
    }
    if (std::ranges::all_of(values_, [](double value) { return std::isfinite(value); })) {
      std::ranges::copy(values_, output.values().begin());
      output.commit();
      ++updates_;
    }
  }

  std::vector<Counter> counters() const override {
    std::vector<Counter> counters = {{"updates", updates_}};
    input_.append_counters(counters);
    counters.push_back({"results_not_finite", not_finite_count_});
    return counters;
  }

 private:
  double instead(std::size_t k) {
    if (not_finite_ == "error") {
      const double shown = std::isnan(results_[k]) ? std::fabs(results_[k]) : results_[k];
      throw std::runtime_error(fmt::format(
          "expression {} ('{}') gave {}; keep its inputs where it has a value, or write "
          "not_finite = hold",
          k, expressions_.text(k), shown));
    }
    ++not_finite_count_;
    return not_finite_ == "zero" ? 0.0 : values_[k];
  }

  HeldInput input_;
  Expressions expressions_;
  std::string not_finite_;
  std::vector<double> arguments_;
  std::vector<double> results_;
  std::vector<double> values_;  // the last good ones; NaN: none yet
  std::uint64_t updates_ = 0;
  std::uint64_t not_finite_count_ = 0;
};

}  // namespace

/// out[k] = the k-th expression of the text `function`, in the language of `Expressions`, for
/// example "sin(pi*x0); x0*x1". A result that is NaN or infinite is treated as `not_finite` says:
/// hold, that output keeps its last value (`out` is invalid until every output has had one); zero;
/// error.
NodeClass function_class() {
  NodeDescription description;
  description.name = "function";
  description.text = "Evaluates expressions of the inputs, one per output";
  description.source = "the language of muParser 2.3";
  description.ports = {
      {"in", PortKind::signal, Direction::input, {}, "The variables x0, x1, ..."},
      {"out", PortKind::signal, Direction::output, {}, "One expression per channel"}};
  description.parameters = {{.name = "function",
                             .type = ParameterType::text,
                             .text = "Expressions of x0, x1, ... (with one input also x), "
                                     "separated by ';', e.g. sin(pi*x0); x0*x1"}};
  append_finite_input_policy(description.parameters);
  description.parameters.back().text =
      "NaN or infinite inputs and results: hold the channel's last finite value (inputs: 0 before "
      "the first; results: no output before it), use 0, or end the run with an error";
  return {description, [](const NodeSetup& setup) { return std::make_unique<Function>(setup); }};
}

}  // namespace spikeloop
