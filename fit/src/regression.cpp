#include "spikeloop/fit/regression.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "spikeloop/core/error.hpp"

namespace spikeloop::fit {

namespace {

constexpr Eigen::Index kBatch = 256;  // samples that are added up at once

}  // namespace

struct Regression::Impl {
  Impl(Eigen::Index neurons, Eigen::Index outputs)
      : activities(neurons, kBatch),
        targets(outputs, kBatch),
        gram(Eigen::MatrixXd::Zero(neurons, neurons)),
        projection(Eigen::MatrixXd::Zero(neurons, outputs)),
        squares(Eigen::VectorXd::Zero(outputs)) {}

  /// Column by column.
  void flush() {
    if (waiting == 0) {
      return;  // Eigen divides by the number of columns
    }
    const auto a = activities.leftCols(waiting);
    gram.selfadjointView<Eigen::Lower>().rankUpdate(a);
    projection.noalias() += a * targets.leftCols(waiting).transpose();
    squares += targets.leftCols(waiting).rowwise().squaredNorm();
    waiting = 0;
  }

  Eigen::MatrixXd activities;
  Eigen::MatrixXd targets;
  Eigen::MatrixXd gram;  // the lower triangle
  Eigen::MatrixXd projection;
  Eigen::Index waiting = 0;
  Eigen::VectorXd squares;  // of each target, summed up
  std::uint64_t samples = 0;
  double highest = 0;
};

Regression::Regression(std::uint32_t neurons, std::uint32_t outputs)
    : impl_(std::make_unique<Impl>(neurons, outputs)) {}

Regression::~Regression() = default;

void Regression::add(std::span<const double> activities, std::span<const double> targets) {
  Impl& own = *impl_;
  std::ranges::copy(activities, own.activities.col(own.waiting).begin());
  std::ranges::copy(targets, own.targets.col(own.waiting).begin());
  own.highest = std::max(own.highest, *std::ranges::max_element(activities));
  ++own.samples;
  if (++own.waiting == kBatch) {
    own.flush();
  }
}

std::vector<double> Regression::solve(double regularisation) const {
  Impl& own = *impl_;
  own.flush();
  if (own.samples == 0) {
    throw ConfigurationError("there is no sample to fit to; fit to a longer time");
  }
  if (own.highest == 0) {
    throw ConfigurationError(
        "no neuron has fired; give inputs at which the neurons fire, or a longer time");
  }
  const double strength = regularisation * own.highest;
  Eigen::MatrixXd matrix = own.gram;
  matrix.diagonal().array() += static_cast<double>(own.samples) * strength * strength;
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Lower> factors(matrix);  // in place
  if (factors.info() != Eigen::Success) {
    throw ConfigurationError(
        "the equations have no unique solution: some neurons do the same, or never fire; write a "
        "regularisation above 0, such as 0.01");
  }
  const Eigen::MatrixXd solution = factors.solve(own.projection);  // neurons x outputs
  return {solution.data(), solution.data() + solution.size()};     // by columns
}

Errors Regression::errors(std::span<const double> weights) const {
  Impl& own = *impl_;
  own.flush();
  Errors errors;
  errors.samples = own.samples;
  const auto count = static_cast<double>(own.samples);
  const Eigen::Index neurons = own.gram.rows();
  double sum = 0;
  for (Eigen::Index row = 0; row < own.squares.size(); ++row) {
    const Eigen::Map<const Eigen::VectorXd> w(weights.data() + row * neurons, neurons);
    // |A w - y|^2, which rounding may carry below 0 when it is tiny.
    const double squares = w.dot(own.gram.selfadjointView<Eigen::Lower>() * w) -
                           2 * w.dot(own.projection.col(row)) + own.squares[row];
    errors.of_output.push_back(std::sqrt(std::max(0.0, squares) / count));
    sum += std::max(0.0, squares);
  }
  errors.total = std::sqrt(sum / (count * static_cast<double>(own.squares.size())));
  return errors;
}

Evaluation::Evaluation(std::span<const double> weights, std::uint32_t neurons)
    : weights_(weights),
      neurons_(neurons),
      decoded_(weights.size() / neurons, 0.0),
      squares_(decoded_.size(), 0.0) {}

std::span<const double> Evaluation::add(std::span<const double> activities,
                                        std::span<const double> targets) {
  for (std::size_t row = 0; row < decoded_.size(); ++row) {
    const auto weights = weights_.subspan(row * neurons_, neurons_);
    decoded_[row] = Eigen::Map<const Eigen::VectorXd>(weights.data(), weights.size())
                        .dot(Eigen::Map<const Eigen::VectorXd>(activities.data(), weights.size()));
    squares_[row] += (decoded_[row] - targets[row]) * (decoded_[row] - targets[row]);
  }
  ++samples_;
  return decoded_;
}

Errors Evaluation::errors() const {
  Errors errors;
  errors.samples = samples_;
  double sum = 0;
  for (const double squares : squares_) {
    errors.of_output.push_back(std::sqrt(squares / static_cast<double>(samples_)));
    sum += squares;
  }
  errors.total = std::sqrt(sum / static_cast<double>(samples_ * squares_.size()));
  return errors;
}

}  // namespace spikeloop::fit
