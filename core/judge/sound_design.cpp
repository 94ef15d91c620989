// SPDX-License-Identifier: MIT
#include "core/judge/sound_design.hpp"

#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/judge/pattern_model.hpp"
#include "core/judge/rectangular_motion.hpp"
#include "core/text/json_text.hpp"
#include "core/verify/judge.hpp"
#include "core/verify/verify_json.hpp"

namespace popcut::judge {
namespace {

using Json = nlohmann::ordered_json;

/// Without a card freedoms are many, and counting them costs more than O(faces).
constexpr std::size_t kMostLooseFaces = 2000;

/// Rectangular units open as one affine family, so that one pose stands for all; splayed ones are
/// looked at in several.
std::vector<double> poses_of(const Pattern& pattern) {
  if (!pattern.kites.empty()) return {2.9, 2.3, std::numbers::pi / 2, 1.1, 0.7, 0.4, 0.2, 0.05};
  if (pattern.v_folds.empty()) return {1.1};
  return {2.6, std::numbers::pi / 2, 1.1};
}

/// How many freedoms a part must have; none: they are not counted.
std::optional<int> freedoms_of(const Design& part) {
  if (!part.pattern.card && part.pattern.faces() > kMostLooseFaces) return std::nullopt;
  return part.report.degrees_of_freedom;
}

/// Whether the verifier finds the flat sheet sound, and the motion follows from rectangular units.
bool is_proven(const Design& part) {
  if (!part.pattern.v_folds.empty() || !part.pattern.kites.empty()) return false;
  auto model = pattern_model(part.pattern, {});
  if (!model) return false;
  verify::Subject subject;
  subject.file = std::move(*model);
  subject.limits = verify::limits_of(subject.file);
  VerifyCheck faces = verify::named("faces");
  subject.sheet = verify::make_sheet(subject.file, faces);
  if (!faces.ok() || !has_rectangular_motion(part.pattern, subject.sheet, freedoms_of(part)))
    return false;
  VerifyReport report;
  verify::judge_flat_sheet(subject, std::move(faces), report);
  return report.ok();
}

Result<VerifyReport> verified(const Design& part) {
  auto model = pattern_model(part.pattern, poses_of(part.pattern));
  if (!model) return tl::unexpected(model.error());
  VerifyOptions how;
  how.quick = true;
  how.name_coordinates = true;
  if (const auto freedoms = freedoms_of(part))
    how.degrees_of_freedom = static_cast<std::size_t>(*freedoms);
  return verify_model(std::move(*model), how);
}

/// The checks that fail, with a count each, and the first place.
std::string summary(const VerifyReport& report) {
  std::string checks, first;
  for (const VerifyCheck& check : report.checks) {
    if (check.ok()) continue;
    checks += fmt::format("{}{} ({})", checks.empty() ? "" : ", ", check.name, check.failed);
    if (first.empty() && !check.failures.empty())
      first = fmt::format("; first: {}{}{}", check.failures.front().place,
                          check.failures.front().place.empty() ? "" : ": ",
                          check.failures.front().detail);
  }
  return checks + first;
}

std::string what_fails(const Result<VerifyReport>& report) {
  return report ? summary(*report) : message(report.error());
}

}  // namespace

std::optional<DesignFault> find_unsound(const PatchAssembly& made) {
  std::string first;
  DesignFault fault;
  for (std::size_t p = 0; p < made.parts.size(); ++p) {
    if (is_proven(made.parts[p])) continue;
    auto report = verified(made.parts[p]);
    if (report && report->ok()) continue;
    if (fault.parts.empty()) {
      if (made.parts.size() > 1) first = fmt::format("{} {}: ", made.book ? "card" : "part", p + 1);
      first += what_fails(report);
    }
    fault.parts.push_back({p + 1, made.parts[p].pattern.name, std::move(report)});
  }
  if (fault.parts.empty()) return std::nullopt;
  fault.error = {
      ErrorKind::Internal, "",
      "the pattern that popcut made for it is not sound, so no pattern is given: " + first +
          "; this is a fault in popcut: report it with the design, and try other units, "
          "widths or another lattice"};
  return fault;
}

std::string unsound_json(const std::vector<UnsoundPart>& parts) {
  const auto part_json = [](const UnsoundPart& part) {
    return Json{{"part", part.number},
                {"name", part.name},
                {"verify", part.report ? verify_report_json(*part.report)
                                       : Json{{"ok", false}, {"error", what_fails(part.report)}}}};
  };
  return json_file(Json{{"sound", false}, {"parts", json_list(parts, part_json)}});
}

tl::expected<PatchAssembly, DesignFault> sound_design(const DesignSpec& spec,
                                                      const SurfaceAssets& assets,
                                                      const Progress& progress) {
  auto made = design_assembly(spec, assets, progress);
  if (!made) return tl::unexpected(DesignFault{std::move(made.error()), {}});
  tell(progress, "checking that the pattern is sound");
  if (auto fault = find_unsound(*made)) return tl::unexpected(std::move(*fault));
  return std::move(*made);
}

}  // namespace popcut::judge
