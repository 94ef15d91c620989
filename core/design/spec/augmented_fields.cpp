// SPDX-License-Identifier: MIT
#include "core/design/spec/augmented_fields.hpp"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text/field_reader.hpp"

namespace popcut {
namespace {

using nlohmann::json;

constexpr double kMostCurvature = 1e6;  ///< of 1/mm and 1/mm^2: a radius of a nanometre
constexpr double kMostForm = 1e10;      ///< of mm and mm^2: the square of the longest sheet
constexpr double kMostWeight = 1e9;
constexpr std::size_t kMostTargets = 2'000'000;
constexpr const char* kPlace = "/curvature";

Result<double> number_of(const json& value, const std::string& place, double most) {
  if (!value.is_number())
    return fail(ErrorKind::Malformed, place,
                fmt::format("is {}; a number is needed", json_type(value)));
  const double got = value.get<double>();
  if (!(std::abs(got) <= most))
    return fail(ErrorKind::OutOfRange, place,
                fmt::format("is {:g}; a number from {:g} to {:g} is needed", got, -most, most));
  return got;
}

Result<void> check_size(const json& list, const std::string& place) {
  if (!list.empty() && list.size() <= kMostTargets) return {};
  return fail(
      ErrorKind::OutOfRange, place,
      fmt::format("has {} values; one for all, or one an inner vertex (at most {}) is needed",
                  list.size(), kMostTargets));
}

/// One number, or a list of them.
Result<std::vector<double>> numbers(const json* value, const char* name) {
  std::vector<double> out;
  if (!value) return out;
  const std::string place = fmt::format("{}/{}", kPlace, name);
  if (value->is_number()) {
    const auto one = number_of(*value, place, kMostCurvature);
    if (!one) return tl::unexpected(one.error());
    return std::vector<double>{*one};
  }
  if (!value->is_array())
    return fail(ErrorKind::Malformed, place,
                fmt::format("is {}; a number or a list of numbers is needed", json_type(*value)));
  if (auto sized = check_size(*value, place); !sized) return tl::unexpected(sized.error());
  for (std::size_t k = 0; k < value->size(); ++k) {
    const auto one = number_of((*value)[k], fmt::format("{}/{}", place, k), kMostCurvature);
    if (!one) return tl::unexpected(one.error());
    out.push_back(*one);
  }
  return out;
}

/// One form of three numbers, or a list of forms.
Result<std::vector<std::array<double, 3>>> forms(const json* value, const char* name) {
  std::vector<std::array<double, 3>> out;
  if (!value) return out;
  const std::string place = fmt::format("{}/{}", kPlace, name);
  const auto wrong = [&](const json& what, const std::string& where) {
    return fail(
        ErrorKind::Malformed, where,
        fmt::format("is {}; a form [ss, st, tt] of three numbers is needed",
                    what.is_array() ? fmt::format("a list of {}", what.size()) : json_type(what)));
  };
  const auto add = [&](const json& form, const std::string& where) -> Result<void> {
    if (!form.is_array() || form.size() != 3) return wrong(form, where);
    std::array<double, 3> read{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto one = number_of(form[k], fmt::format("{}/{}", where, k), kMostForm);
      if (!one) return tl::unexpected(one.error());
      read[k] = *one;
    }
    out.push_back(read);
    return {};
  };
  if (!value->is_array() || value->empty()) return wrong(*value, place);
  if (!value->front().is_array()) {
    if (auto one = add(*value, place); !one) return tl::unexpected(one.error());
    return out;
  }
  if (auto sized = check_size(*value, place); !sized) return tl::unexpected(sized.error());
  for (std::size_t k = 0; k < value->size(); ++k)
    if (auto one = add((*value)[k], fmt::format("{}/{}", place, k)); !one)
      return tl::unexpected(one.error());
  return out;
}

/// Weights are 1 for what is asked for, and lawful for nothing else.
Result<void> parse_weights(const json* value, AugmentedSpec& spec) {
  const json none = json::object();
  FieldReader fields(value ? *value : none, std::string(kPlace) + "/weights");
  const auto read = [&](const char* name, bool asked, double& weight) {
    if (!asked && fields.has(name))
      fields.refuse(name, ErrorKind::Malformed,
                    fmt::format("weighs what is not asked for; give {}/{} too", kPlace,
                                name == std::string("K") ? "K_area" : name));
    weight = fields.number(name, asked ? 1.0 : 0.0, 0.0, kMostWeight);
  };
  read("K", !spec.K_area.empty(), spec.weight_K);
  read("H", !spec.H.empty(), spec.weight_H);
  read("first", !spec.first.empty(), spec.weight_first);
  read("second", !spec.second.empty(), spec.weight_second);
  if (auto done = fields.finish(); !done) return done;
  if (spec.weight_K + spec.weight_H + spec.weight_first + spec.weight_second > 0.0) return {};
  return fail(ErrorKind::OutOfRange, std::string(kPlace) + "/weights",
              "are all 0; one above 0 is needed, or leave curvature out");
}

}  // namespace

Result<AugmentedSpec> parse_augmented(const json& value) {
  FieldReader fields(value, kPlace);
  const json* const weights = fields.value("weights");
  auto K_area = numbers(fields.value("K_area"), "K_area");
  auto H = numbers(fields.value("H"), "H");
  auto first = forms(fields.value("first"), "first");
  auto second = forms(fields.value("second"), "second");
  if (auto done = fields.finish(); !done) return tl::unexpected(done.error());
  for (const auto* read : {&K_area, &H})
    if (!*read) return tl::unexpected(read->error());
  for (const auto* read : {&first, &second})
    if (!*read) return tl::unexpected(read->error());
  AugmentedSpec spec{std::move(*K_area), std::move(*H), std::move(*first), std::move(*second)};
  if (spec.K_area.empty() && spec.H.empty() && spec.first.empty() && spec.second.empty())
    return fail(ErrorKind::Malformed, kPlace,
                "asks for nothing; K_area, H, first or second is needed");
  for (std::size_t k = 0; k < spec.first.size(); ++k) {
    const auto& [ss, st, tt] = spec.first[k];
    if (ss > 0.0 && tt > 0.0 && ss * tt > st * st) continue;
    return fail(
        ErrorKind::OutOfRange,
        fmt::format("{}/first{}", kPlace, spec.first.size() == 1 ? "" : fmt::format("/{}", k)),
        fmt::format("is [{:g}, {:g}, {:g}], which measures no area; ss > 0, tt > 0 and "
                    "ss tt > st^2 are needed",
                    ss, st, tt));
  }
  if (auto weighed = parse_weights(weights, spec); !weighed) return tl::unexpected(weighed.error());
  return spec;
}

json augmented_schema() {
  const auto numbers = [](const char* text) {
    return json{
        {"description", text},
        {"oneOf",
         json::array({{{"type", "number"}},
                      {{"type", "array"}, {"minItems", 1}, {"items", {{"type", "number"}}}}})}};
  };
  const auto forms = [](const char* text) {
    const json form{
        {"type", "array"}, {"minItems", 3}, {"maxItems", 3}, {"items", {{"type", "number"}}}};
    return json{
        {"description", text},
        {"oneOf", json::array({form, {{"type", "array"}, {"minItems", 1}, {"items", form}}})}};
  };
  const auto weight = [](const char* text) {
    return json{{"type", "number"}, {"minimum", 0}, {"default", 1}, {"description", text}};
  };
  return {
      {"type", "object"},
      {"description",
       "what the surface through the chains' vertices is to be (the augmented loss): one value for "
       "all inner vertices, or a list with one for each: levels 1 to units - 1 of the second "
       "slice, then of the third, up to the last but one. Makes \"slices\" the default lattice"},
      {"additionalProperties", false},
      {"minProperties", 1},
      {"properties",
       {{"K_area", numbers("Gaussian curvature, 1/mm^2")},
        {"H", numbers("mean curvature, 1/mm, above 0 where convex")},
        {"first", forms("first fundamental form [a_ss, a_st, a_tt], mm^2, s by level, t by slice")},
        {"second", forms("second fundamental form [b_ss, b_st, b_tt], mm")},
        {"weights",
         {{"type", "object"},
          {"additionalProperties", false},
          {"properties",
           {{"K", weight("of K_area")},
            {"H", weight("of H")},
            {"first", weight("of first")},
            {"second", weight("of second")}}}}}}}};
}

}  // namespace popcut
