// The language of expressions against the compiler's, and every message.
#include "spikeloop/nodes/expression.hpp"

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "harness.hpp"

namespace spikeloop::testing {
namespace {

std::vector<double> results(const std::string& text, const std::vector<double>& in) {
  Expressions expressions(text, in.size());
  std::vector<double> out(expressions.outputs());
  expressions.evaluate(in, out);
  return out;
}

std::string failure(const std::string& text, std::size_t inputs = 2) {
  return message_of([&] { Expressions(text, inputs); });
}

TEST(Expressions, AreFunctionsOfTheInputs) {
  using Function = std::function<double(double, double)>;
  const std::vector<std::pair<std::string, Function>> cases = {
      {"sin(pi*x0)", [](double a, double) { return std::sin(std::numbers::pi * a); }},
      {"x0*x1", [](double a, double b) { return a * b; }},
      {"x0 + 2*x1 - x0/4", [](double a, double b) { return a + 2 * b - a / 4; }},
      {"(x0 + 1)^3", [](double a, double) { return std::pow(a + 1, 3); }},
      {"-x0^2", [](double a, double) { return -(a * a); }},
      {"2^3^2 + x0", [](double a, double) { return 512 + a; }},
      {"x0 < x1 ? x0 : x1", [](double a, double b) { return std::min(a, b); }},
      {"x0 >= 0 && x1 >= 0 || x0 != x0",
       [](double a, double b) { return a >= 0 && b >= 0 ? 1.0 : 0.0; }},
      {"max(x0, x1, 0.1) + min(x0, x1)",
       [](double a, double b) {
         return std::max({a, b, 0.1}) + std::min(a, b);
       }},
      {"sum(x0, x1, 1) + avg(x0, x1)", [](double a, double b) { return a + b + 1 + (a + b) / 2; }},
      {"exp(x0) + ln(2 + x1) + log(3 + x1)",
       [](double a, double b) { return std::exp(a) + std::log(2 + b) + std::log(3 + b); }},
      {"log2(2+x0) + log10(2+x0) + sqrt(2+x0)",
       [](double a, double) { return std::log2(2 + a) + std::log10(2 + a) + std::sqrt(2 + a); }},
      {"tan(x0) + asin(x0) + acos(x0) + atan(x0) + atan2(x0, x1)",
       [](double a, double b) {
         return std::tan(a) + std::asin(a) + std::acos(a) + std::atan(a) + std::atan2(a, b);
       }},
      {"sinh(x0) + cosh(x0) + tanh(x0) + asinh(x0) + acosh(2 + x0) + atanh(x0 / 2)",
       [](double a, double) {
         return std::sinh(a) + std::cosh(a) + std::tanh(a) + std::asinh(a) + std::acosh(2 + a) +
                std::atanh(a / 2);
       }},
      {"abs(x0) + sign(x1) + rint(10*x0) + cos(x1)",
       [](double a, double b) {
         return std::fabs(a) + (b > 0 ? 1 : b < 0 ? -1 : 0) + std::rint(10 * a) + std::cos(b);
       }},
      {"e + 1e-3 + .5 + 2.", [](double, double) { return std::numbers::e + 1e-3 + 2.5; }}};
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const auto& [text, expected] : cases) {
    Expressions expressions(text, 2);
    for (int i = 0; i < 200; ++i) {
      const double a = uniform(generator);
      const double b = uniform(generator);
      double out = 0;
      expressions.evaluate(std::vector<double>{a, b}, {&out, 1});
      ASSERT_NEAR(out, expected(a, b), 1e-12) << text << " of " << a << ", " << b;
    }
  }
}

TEST(Expressions, AreSeparatedBySemicolons) {
  EXPECT_EQ(results(" x0 ;x1\t; x0 - x1\n", {3, 5}), (std::vector<double>{3, 5, -2}));
  Expressions expressions(" x0 ;x1 * 2", 2);
  EXPECT_EQ(expressions.inputs(), 2U);
  EXPECT_EQ(expressions.outputs(), 2U);
  EXPECT_EQ(expressions.text(0), "x0");
  EXPECT_EQ(expressions.text(1), "x1 * 2");
  Expressions moved = std::move(expressions);
  std::vector<double> out(2);
  moved.evaluate(std::vector<double>{1, 2}, out);
  EXPECT_EQ(out, (std::vector<double>{1, 4}));
}

TEST(Expressions, ASingleInputIsAlsoX) {
  EXPECT_EQ(results("x + x0; exp(x) - exp(x0)", {4}), (std::vector<double>{8, 0}));
  EXPECT_EQ(failure("x", 2),
            "'x', character 1: there is no 'x'; the inputs are x0 to x1, constants are pi and e "
            "[SL0209]");
}

TEST(Expressions, TakeThousandsOfInputs) {
  std::vector<double> in(5000);
  in[4999] = 7;
  in[12] = 3;
  EXPECT_EQ(results("x4999 - x12 + max(x1, x2)", in), std::vector<double>{4});
}

TEST(Expressions, HaveNoMemory) {
  Expressions expressions("x0 == 1 ? x1 : 2*x1", 2);
  double out = 0;
  for (const double x : {1.0, 2.0, 1.0}) {
    expressions.evaluate(std::vector<double>{x, 10}, {&out, 1});
    EXPECT_EQ(out, x == 1 ? 10 : 20);
  }
}

TEST(Expressions, WithoutAValueGiveNoNumber) {
  const auto out = results("ln(x0); 1/x1; asin(x0 - 5)", {-1, 0});
  EXPECT_TRUE(std::isnan(out[0]));
  EXPECT_TRUE(std::isinf(out[1]));
  EXPECT_TRUE(std::isnan(out[2]));
}

TEST(Expressions, UnknownNamesAreNamed) {
  EXPECT_THAT(failure("x0 + y"), Fault("'x0 + y', character 6: ... 'y' ... x0 to x1 ... [SL0209]"));
  EXPECT_THAT(failure("x0; sni(x1)"),
              Fault("'x0; sni(x1)', character 5: ... 'sni' ... x0 to x1 ... 'sin' ... [SL0209]"));
  EXPECT_THAT(failure("x1", 1),
              Fault("'x1', character 1: ... 'x1'; the input is x0, or x ... [SL0209]"));
  EXPECT_THAT(failure("x2 + x0"),
              Fault("'x2 + x0', character 1: ... 'x2' ... x0 to x1 ... [SL0209]"));
  for (const char* odd : {"x01", "x00", "x99999999999999999999", "x0y"}) {
    EXPECT_EQ(failure(odd), std::string("'") + odd + "', character 1: there is no '" + odd +
                                "'; the inputs are x0 to x1, constants are pi and e [SL0209]");
  }
  EXPECT_EQ(failure("sin * 2"),
            "'sin * 2', character 1: 'sin' is a function; write its argument in parentheses: "
            "sin(...) [SL0209]");
}

TEST(Expressions, WhatIsMissingIsNamed) {
  EXPECT_EQ(
      failure(""),
      "'', character 1: an expression is missing; write one an output, separated by ';' [SL0209]");
  EXPECT_THAT(failure("x0;; x1"),
              Fault("'x0;; x1', character 4: ... separated by ';' ... [SL0209]"));
  EXPECT_THAT(failure("x0; "), Fault("'x0; ', character 5: ... separated by ';' ... [SL0209]"));
  for (const char* text : {"x0 *", "-", "sin(", "1 ? 2 :", "x0 +-", "x0 && ("}) {
    const std::string all = text;
    EXPECT_EQ(failure(all), "'" + all + "', character " + std::to_string(all.size()) +
                                ": there is no value behind '" + all.back() +
                                "'; write one [SL0209]");
  }
  EXPECT_THAT(failure("1 ? - : 2"), Fault("'1 ? - : 2', character 5: ... '-' ... [SL0209]"));
  EXPECT_EQ(failure("x1; (x0 + 2"),
            "'x1; (x0 + 2', character 11: a ')' is missing; write one for each '(' [SL0209]");
  for (const auto& [text, character] : {std::pair{"x0 ? 2", "6"}, {"x0 : 2", "5"}, {"? x0", "1"}}) {
    EXPECT_EQ(failure(text), std::string("'") + text + "', character " + character +
                                 ": '?' and ':' belong together; write condition ? value : other "
                                 "value [SL0209]");
  }
  EXPECT_EQ(failure("1 + atan2(x0)"),
            "'1 + atan2(x0)', character 5: 'atan2' has too few arguments; write atan2(y, x), one "
            "for the others, any number for min, max, sum and avg [SL0209]");
  EXPECT_THAT(failure("sin(x0, x1)"), Fault("'sin(x0, x1)', character 1: 'sin' has too many "
                                            "arguments; write atan2(y, x) ... max ... [SL0209]"));
}

TEST(Expressions, WhatCannotStandThereIsNamed) {
  const auto cannot = [](const std::string& text, int character, const std::string& token) {
    EXPECT_EQ(failure(text), "'" + text + "', character " + std::to_string(character) + ": '" +
                                 token +
                                 "' cannot stand here; write an operator (+ - * / ^) between two "
                                 "values, and arguments in parentheses [SL0209]");
  };
  cannot("x0 x1", 4, "x1");
  cannot("x0; 3x1", 6, "x1");
  cannot("* x0", 1, "*");
  cannot("x0 + 1)", 7, ")");
  cannot("x0(3)", 3, "(");
  cannot("max(x0,,x1)", 8, ",");
  cannot("5 sin(x0)", 3, "sin");
  EXPECT_EQ(failure("2 * (x0, x1)"),
            "'2 * (x0, x1)', character 12: ',' stands between the arguments of a function alone; "
            "write ';' between outputs [SL0209]");
  EXPECT_EQ(failure("x0, x1"),
            "'x0, x1', character 6: ',' makes 2 values of this expression; write ';' between the "
            "outputs [SL0209]");
}

TEST(Expressions, NothingCanBeAssigned) {
  EXPECT_EQ(failure("x0 = 3"),
            "'x0 = 3', character 4: '=' would change an input; write == to "
            "compare [SL0209]");
  EXPECT_EQ(results("x0 == 3; x0 <= 3; x0 >= 3; x0 != 3", {3}), (std::vector<double>{1, 1, 1, 0}));
}

TEST(Expressions, ForeignCharactersAreNamed) {
  for (const char* c : {"\"", "#", "@", "$", "\\", "[", "\x01", "\xc3"}) {
    const std::string message = failure(std::string("x0 + ") + c + "x1");
    EXPECT_NE(message.find("character 6: this character has no meaning here; write names, numbers, "
                           "+ - * / ^ ( ) , comparisons, && || and ? :"),
              std::string::npos)
        << message;
  }
}

TEST(Expressions, AVeryLongOneIsRefused) {
  std::string text = "x0";
  while (text.size() < 30'000) {
    text += "+x0";
  }
  EXPECT_NE(failure(text).find("character 1: the expression has " + std::to_string(text.size()) +
                               " characters, which is too long; write a shorter one"),
            std::string::npos);
}

TEST(Expressions, RandomTextEndsWithAMessageOrAFunction) {
  const std::vector<std::string> pieces = {
      "x0", "x1", "x",  "x9", "sin", "max(", "(", ")", "+",  "-",  "*",  "/",  "^", ",",  ";",
      "?",  ":",  "==", "=",  "<",   "1",    ".", "e", "2e", "pi", "&&", "||", "!", "\"", " "};
  std::mt19937_64 generator(2);
  int accepted = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string text;
    for (auto length = 1 + generator() % 9; length > 0; --length) {
      text += pieces[generator() % pieces.size()];
    }
    try {
      Expressions expressions(text, 2);
      std::vector<double> out(expressions.outputs());
      expressions.evaluate(std::vector<double>{0.5, -2}, out);
      ++accepted;
    } catch (const ConfigurationError& error) {
      ASSERT_NE(std::string(error.what()).find("character "), std::string::npos) << text;
    }
  }
  EXPECT_GT(accepted, 100);
}

TEST(Expressions, OtherWidthsAreABug) {
  Expressions expressions("x0", 1);
  std::vector<double> out(2);
  EXPECT_EQ(message_of([&] { expressions.evaluate(std::vector<double>{1}, out); }),
            "1 inputs and 2 outputs were given for expressions of 1 and 1");
}

}  // namespace
}  // namespace spikeloop::testing
