// Functions that a user writes as text: "sin(pi*x0); x0*x1".
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace spikeloop {

/// Expressions separated by ';', each a function of the inputs x0, x1, ... (of a single input also
/// x), in the language of muParser 2.3:
///   + - * / ^, < > <= >= == !=, && ||, condition ? a : b, numbers, pi, e,
///   sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh exp ln log log2 log10 sqrt
///   sign rint abs min max sum avg.
/// `log` is the natural logarithm; ^ goes before a sign: -2^2 is -4. There are no assignments: an
/// expression has no memory.
class Expressions {
 public:
  /// @throws ConfigurationError (without location) with the text, the character, counted from 1,
  /// what is wrong there and what to write.
  Expressions(std::string_view text, std::size_t inputs);
  ~Expressions();
  Expressions(Expressions&&) noexcept;
  Expressions& operator=(Expressions&&) noexcept;

  std::size_t inputs() const;
  std::size_t outputs() const;
  /// The expression of output k, without blanks around it.
  const std::string& text(std::size_t k) const;

  /// `in` has inputs() values, `out` outputs(). Where an expression has no value, such as ln(-1) or
  /// 1/0, the result is NaN or infinite. One thread at a time.
  void evaluate(std::span<const double> in, std::span<double> out);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop
