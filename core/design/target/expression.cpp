// SPDX-License-Identifier: MIT
#include "core/design/target/expression.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include <fmt/format.h>
#include <muParser.h>

#include "core/text/near_names.hpp"

namespace popcut {

struct Expression::Parser {
  mu::Parser mu;
  std::array<double, 4> values{};
};

namespace {

constexpr const char* kNameLetters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";

/// What muParser does not have. Its own are in docs/designs.md too.
void add_functions(mu::Parser& parser) {
  parser.DefineFun(
      "floor", +[](double a) { return std::floor(a); });
  parser.DefineFun(
      "ceil", +[](double a) { return std::ceil(a); });
  parser.DefineFun(
      "round", +[](double a) { return std::round(a); });
  parser.DefineFun(
      "mod", +[](double a, double b) { return a - b * std::floor(a / b); });
}

/// The names of all functions, as a list.
std::string function_names(const mu::Parser& parser) {
  std::string out;
  for (const auto& [name, ignored] : parser.GetFunDef()) out += (out.empty() ? "" : ", ") + name;
  return out;
}

/// "; did you mean sin?" of the name that `token` begins with; empty if none is near.
std::string meant(const std::string& token, const mu::Parser& parser,
                  const std::vector<std::string>& variables) {
  std::string name = token.substr(0, token.find_first_not_of(kNameLetters));
  std::transform(name.begin(), name.end(), name.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  std::vector<std::string> known = variables;
  known.insert(known.end(), {"pi", "e"});
  for (const auto& [function, ignored] : parser.GetFunDef()) known.push_back(function);
  const bool is_known = std::find(known.begin(), known.end(), name) != known.end();
  // Any letter is near to any other.
  const std::string near = is_known ? name : name.size() < 2 ? "" : nearest_word(name, known);
  return near.empty() ? "" : fmt::format("; did you mean {}?", near);
}

/// Where the text has a single "=": muParser would take it as an assignment to a variable.
std::size_t assignment_in(const std::string& text) {
  for (std::size_t k = text.find('='); k != std::string::npos; k = text.find('=', k + 1)) {
    const bool of_pair = k > 0 && std::string_view("=!<>").find(text[k - 1]) != std::string::npos;
    if (of_pair) continue;
    if (k + 1 >= text.size() || text[k + 1] != '=') return k;
    ++k;
  }
  return std::string::npos;
}

}  // namespace

Expression::Expression(std::unique_ptr<Parser> parser) : parser_(std::move(parser)) {}
Expression::Expression(Expression&&) noexcept = default;
Expression& Expression::operator=(Expression&&) noexcept = default;
Expression::~Expression() = default;

Result<Expression> Expression::parse(const std::string& text,
                                     const std::vector<std::string>& variables) {
  if (const std::size_t at = assignment_in(text); at != std::string::npos)
    return fail(ErrorKind::Malformed, "",
                fmt::format("the expression assigns at column {} (\"=\"); a formula of {} without "
                            "assignments is needed (== compares)",
                            at + 1, fmt::join(variables, ", ")));
  auto parser = std::make_unique<Parser>();
  std::string names;
  try {
    for (std::size_t i = 0; i < variables.size(); ++i) {
      parser->mu.DefineVar(variables[i], &parser->values.at(i));
      names += (i == 0 ? "" : ", ") + variables[i];
    }
    add_functions(parser->mu);
    parser->mu.DefineConst("pi", std::numbers::pi);
    parser->mu.DefineConst("e", std::numbers::e);
    parser->mu.SetExpr(text);
    int results = 0;
    parser->mu.Eval(results);
    if (results != 1)
      return fail(
          ErrorKind::Malformed, "",
          fmt::format("the expression has {} values; one formula of {} is needed", results, names));
  } catch (const mu::Parser::exception_type& e) {
    if (e.GetCode() == mu::ecUNASSIGNABLE_TOKEN)
      return fail(
          ErrorKind::Malformed, "",
          fmt::format(
              "the expression does not parse at column {} (near \"{}\"){}; it knows {}, pi, "
              "e, and the functions {}",
              e.GetPos() + 1, std::string(e.GetToken()).substr(0, 40),
              meant(e.GetToken(), parser->mu, variables), names, function_names(parser->mu)));
    return fail(
        ErrorKind::Malformed, "",
        fmt::format("the expression does not parse at column {} (near \"{}\"); a formula of {} is "
                    "needed, such as sqrt(36 - y^2)",
                    e.GetPos() + 1, std::string(e.GetToken()).substr(0, 40), names));
  }
  return Expression(std::move(parser));
}

double Expression::operator()(double a, double b, double c) const {
  parser_->values[0] = a;
  parser_->values[1] = b;
  parser_->values[2] = c;
  try {
    return parser_->mu.Eval();
  } catch (const mu::Parser::exception_type&) {  // some functions report a domain error this way
    return std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace popcut
