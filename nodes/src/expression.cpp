#include "spikeloop/nodes/expression.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <cctype>
#include <deque>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "spikeloop/core/code.hpp"
#include "spikeloop/core/error.hpp"

namespace spikeloop {

struct Expressions::Impl {
  std::vector<double> values;  // of the inputs; the parsers point to them
  std::vector<std::string> texts;
  std::deque<mu::Parser> parsers;
};

namespace {

constexpr std::string_view kBlanks = " \t\r\n";
// What the language is made of; muParser knows more (strings, comments), which has no meaning here.
constexpr std::string_view kSigns = "_.+-*/^(),<>=!&|?: \t\r\n";

// One expression and where it stands in the whole text.
class Reader {
 public:
  Reader(std::string_view whole, std::string_view part, std::size_t inputs)
      : whole_(whole), part_(part), inputs_(inputs) {}

  void read(mu::Parser& parser, std::vector<double>& values) const {
    if (part_.empty()) {
      fail(0, "an expression is missing; write one an output, separated by ';'");
    }
    check_characters();
    define_names(parser, values);
    try {
      parser.SetExpr(std::string(part_));
      int results = 0;
      parser.Eval(results);  // the first evaluation compiles
      if (results != 1) {
        fail(part_.size() - 1, fmt::format("',' makes {} values of this expression; write ';' "
                                           "between the outputs",
                                           results));
      }
    } catch (const mu::ParserError& error) {
      explain(error);
    }
  }

 private:
  // `place` counts within the expression, from 0.
  [[noreturn]] void fail(std::size_t place, const std::string& what) const {
    const auto begin = static_cast<std::size_t>(part_.data() - whole_.data());
    throw ConfigurationError(
        with_code(Code::expression, "'{}', character {}: {}", whole_, begin + place + 1, what));
  }

  void check_characters() const {
    for (std::size_t i = 0; i < part_.size(); ++i) {
      const char c = part_[i];
      if (std::isalnum(static_cast<unsigned char>(c)) == 0 &&
          kSigns.find(c) == std::string_view::npos) {
        fail(i,
             "this character has no meaning here; write names, numbers, + - * / ^ ( ) , "
             "comparisons, && || and ? :");
      }
      if (assigns(i)) {
        fail(i, "'=' would change an input; write == to compare");
      }
    }
  }

  // '=' that belongs to none of == <= >= !=.
  bool assigns(std::size_t i) const {
    if (part_[i] != '=') {
      return false;
    }
    const char before = i > 0 ? part_[i - 1] : ' ';
    const char after = i + 1 < part_.size() ? part_[i + 1] : ' ';
    return after != '=' && std::string_view("=<>!").find(before) == std::string_view::npos;
  }

  // Only the variables that the text can mean: there may be many thousand inputs.
  void define_names(mu::Parser& parser, std::vector<double>& values) const {
    parser.DefineConst("pi", std::numbers::pi);
    parser.DefineConst("e", std::numbers::e);
    if (inputs_ == 1) {
      parser.DefineVar("x", values.data());
    }
    for (std::size_t i = part_.find('x'); i != std::string_view::npos; i = part_.find('x', i + 1)) {
      const std::size_t end = std::min(part_.find_first_not_of("0123456789", i + 1), part_.size());
      const std::string name(part_.substr(i, end - i));
      if (const auto index = index_of(name); index < inputs_) {
        parser.DefineVar(name, &values[index]);
      }
    }
  }

  // The number of the input of this name; the number of inputs when there is none.
  std::size_t index_of(const std::string& name) const {
    constexpr std::size_t kLongest = 9;  // digits
    if (name.size() < 2 || name.size() > kLongest + 1) {
      return inputs_;
    }
    const std::size_t index = std::stoul(name.substr(1));
    return fmt::format("x{}", index) == name ? std::min(index, inputs_) : inputs_;
  }

  [[noreturn]] void explain(const mu::ParserError& error) const {
    const std::size_t last = part_.size() - 1;
    const std::size_t place =
        error.GetPos() < 0 ? last : std::min(static_cast<std::size_t>(error.GetPos()), last);
    std::string token = error.GetToken();
    token.erase(token.find_last_not_of(kBlanks) + 1);
    switch (error.GetCode()) {
      case mu::ecUNASSIGNABLE_TOKEN:
        fail(place, unknown(token));
      case mu::ecUNEXPECTED_EOF:
      case mu::ecINTERNAL_ERROR:
        fail(lonely_sign(),
             fmt::format("there is no value behind '{}'; write one", part_[lonely_sign()]));
      case mu::ecMISSING_PARENS:
        fail(last, "a ')' is missing; write one for each '('");
      case mu::ecMISSING_ELSE_CLAUSE:
      case mu::ecMISPLACED_COLON:
      case mu::ecUNEXPECTED_CONDITIONAL:
        fail(place, "'?' and ':' belong together; write condition ? value : other value");
      case mu::ecUNEXPECTED_ARG:
        fail(place,
             "',' stands between the arguments of a function alone; write ';' between "
             "outputs");
      case mu::ecTOO_MANY_PARAMS:
      case mu::ecTOO_FEW_PARAMS:
        fail(std::min(part_.rfind(token, place), last),
             fmt::format("'{}' has too {} arguments; write atan2(y, x), one for the others, any "
                         "number for min, max, sum and avg",
                         token, error.GetCode() == mu::ecTOO_MANY_PARAMS ? "many" : "few"));
      case mu::ecEXPRESSION_TOO_LONG:
        fail(0, fmt::format("the expression has {} characters, which is too long; write a "
                            "shorter one",
                            part_.size()));
      default:
        fail(place, fmt::format("'{}' cannot stand here; write an operator (+ - * / ^) between "
                                "two values, and arguments in parentheses",
                                token));
    }
  }

  // A sign that has nothing behind it, which muParser notices late; else the last character.
  std::size_t lonely_sign() const {
    for (std::size_t i = 0; i < part_.size(); ++i) {
      const std::size_t next = part_.find_first_not_of(kBlanks, i + 1);
      if (std::string_view("+-").find(part_[i]) != std::string_view::npos &&
          (next == std::string_view::npos || part_[next] == '?' || part_[next] == ':')) {
        return i;
      }
    }
    return part_.size() - 1;
  }

  std::string unknown(const std::string& token) const {
    static const std::vector<std::string> kFunctions = {
        "sin",  "cos",   "tan",   "asin",  "acos", "atan", "atan2", "sinh", "cosh",
        "tanh", "asinh", "acosh", "atanh", "exp",  "ln",   "log",   "log2", "log10",
        "sqrt", "sign",  "rint",  "abs",   "min",  "max",  "sum",   "avg"};
    if (std::ranges::find(kFunctions, token) != kFunctions.end()) {
      return fmt::format("'{0}' is a function; write its argument in parentheses: {0}(...)", token);
    }
    const std::string inputs = inputs_ == 1 ? "the input is x0, or x"
                                            : fmt::format("the inputs are x0 to x{}", inputs_ - 1);
    const std::string near = nearest(token, kFunctions);
    return fmt::format("there is no '{}'; {}, constants are pi and e{}", token, inputs,
                       near.empty() ? "" : fmt::format("; did you mean '{}'?", near));
  }

  std::string_view whole_;
  std::string_view part_;  // a piece of `whole_`
  std::size_t inputs_;
};

std::string_view without_blanks(std::string_view text) {
  const std::size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
  const std::size_t end = text.find_last_not_of(kBlanks) + 1;  // npos + 1 is 0
  return text.substr(begin, end > begin ? end - begin : 0);
}

}  // namespace

Expressions::Expressions(std::string_view text, std::size_t inputs)
    : impl_(std::make_unique<Impl>()) {
  impl_->values.assign(inputs, 0.0);
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(';', begin), text.size());
    const std::string_view part = without_blanks(text.substr(begin, end - begin));
    Reader(text, part, inputs).read(impl_->parsers.emplace_back(), impl_->values);
    impl_->texts.emplace_back(part);
    begin = end + 1;
  }
}

Expressions::~Expressions() = default;
Expressions::Expressions(Expressions&&) noexcept = default;
Expressions& Expressions::operator=(Expressions&&) noexcept = default;

std::size_t Expressions::inputs() const {
  return impl_->values.size();
}

std::size_t Expressions::outputs() const {
  return impl_->parsers.size();
}

const std::string& Expressions::text(std::size_t k) const {
  return impl_->texts[k];
}

void Expressions::evaluate(std::span<const double> in, std::span<double> out) {
  if (in.size() != inputs() || out.size() != outputs()) {
    throw std::logic_error(
        fmt::format("{} inputs and {} outputs were given for expressions of {} "
                    "and {}",
                    in.size(), out.size(), inputs(), outputs()));
  }
  std::ranges::copy(in, impl_->values.begin());
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k] = impl_->parsers[k].Eval();
  }
}

}  // namespace spikeloop
