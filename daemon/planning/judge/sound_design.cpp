// SPDX-License-Identifier: MIT
#include "daemon/planning/judge/sound_design.hpp"

#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/verify/verify.hpp"
#include "daemon/planning/judge/pattern_model.hpp"

namespace popcut::planning {
namespace {

/// Without a card freedoms are many, and counting them costs more than O(faces).
constexpr std::size_t kMostLooseFaces = 2000;

/// Rectangular units open as one affine family, so that one pose stands for all; splayed ones are
/// looked at in several.
std::vector<double> poses_of(const Pattern& pattern) {
  if (pattern.v_folds.empty()) return {1.1};
  return {2.6, std::numbers::pi / 2, 1.1};
}

Result<VerifyReport> judge(const Design& part) {
  auto model = pattern_model(part.pattern, poses_of(part.pattern));
  if (!model) return tl::unexpected(model.error());
  VerifyOptions how;
  how.quick = true;
  how.name_coordinates = true;
  if (part.pattern.card || part.pattern.faces() <= kMostLooseFaces)
    how.degrees_of_freedom = static_cast<std::size_t>(part.report.degrees_of_freedom);
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

}  // namespace

std::optional<Unsound> find_unsound(const PatchAssembly& made) {
  std::string what;
  auto parts = nlohmann::ordered_json::array();
  for (std::size_t p = 0; p < made.parts.size(); ++p) {
    const auto report = judge(made.parts[p]);
    if (report && report->ok()) continue;
    const std::string wrong = report ? summary(*report) : message(report.error());
    if (what.empty())
      what = made.parts.size() == 1
                 ? wrong
                 : fmt::format("{} {}: {}", made.book ? "card" : "part", p + 1, wrong);
    nlohmann::ordered_json one{{"part", p + 1}, {"name", made.parts[p].pattern.name}};
    one["verify"] = report ? nlohmann::ordered_json::parse(verify_json(*report))
                           : nlohmann::ordered_json{{"ok", false}, {"error", wrong}};
    parts.push_back(std::move(one));
  }
  if (parts.empty()) return std::nullopt;
  const nlohmann::ordered_json json{{"sound", false}, {"parts", std::move(parts)}};
  return Unsound{
      {ErrorKind::Internal, "",
       "the pattern that popcut made for it is not sound, so no pattern is given: " + what +
           "; this is a fault in popcut: report it with the design, and try other units, "
           "widths or another lattice"},
      json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n"};
}

Result<PatchAssembly> sound_design(const DesignSpec& spec, const SurfaceAssets& assets,
                                   std::string* report, const Progress& progress) {
  auto made = design_assembly(spec, assets, progress);
  if (!made) return made;
  tell(progress, "checking that the pattern is sound");
  if (auto unsound = find_unsound(*made)) {
    if (report) *report = std::move(unsound->report);
    return tl::unexpected(std::move(unsound->error));
  }
  return made;
}

}  // namespace popcut::planning
