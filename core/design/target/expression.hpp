// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace popcut {

/// A formula of named variables, as a spec gives it: + - * / ^, pi, e, muParser's functions (sqrt,
/// sin, exp, min, max and so on; docs/designs.md lists all), and floor, ceil, round and mod(a, b) =
/// a - b floor(a / b).
class Expression {
 public:
  /// Parses `text`; `variables` are the only names beside muParser's functions and constants, in
  /// the order in which `operator()` takes their values.
  ///
  /// @retval Malformed  it does not parse; the detail quotes the token and its column, and lists
  ///                    what is known where a name is not
  [[nodiscard]] static Result<Expression> parse(const std::string& text,
                                                const std::vector<std::string>& variables);

  Expression(Expression&&) noexcept;
  Expression& operator=(Expression&&) noexcept;
  ~Expression();

  /// The value at one to three variables; NaN where the formula has none.
  [[nodiscard]] double operator()(double a, double b = 0.0, double c = 0.0) const;

 private:
  struct Parser;
  explicit Expression(std::unique_ptr<Parser> parser);
  std::unique_ptr<Parser> parser_;
};

}  // namespace popcut
