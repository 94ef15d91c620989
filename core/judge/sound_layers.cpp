// SPDX-License-Identifier: MIT
#include "core/judge/sound_layers.hpp"

#include <utility>

#include <fmt/format.h>

#include "core/hands/wobble.hpp"
#include "core/parts/structure_fold.hpp"

namespace popcut::judge {
namespace {

/// The first thing that fails, with its place.
std::string first_fault(const PartsVerifyReport& report) {
  const auto in = [](const std::vector<VerifyCheck>& checks) -> std::string {
    for (const VerifyCheck& check : checks)
      if (!check.failures.empty())
        return fmt::format("{}: {}: {}", check.name, check.failures.front().place,
                           check.failures.front().detail);
    return {};
  };
  for (const VerifyReport& part : report.parts)
    if (std::string fault = in(part.checks); !fault.empty()) return fault;
  return in(report.checks);
}

}  // namespace

Result<PartsVerifyReport> sound_report(const std::string& fold, const char* try_instead,
                                       const Progress& progress) {
  PartsVerifyOptions how;
  how.progress = progress;
  auto report = verify_parts(fold, how);
  if (report && !report->ok())
    return fail(ErrorKind::Internal, "",
                fmt::format("the card that popcut made for it is not sound, so none is given: {}; "
                            "this is a fault in popcut: report it with the design, and {}",
                            first_fault(*report), try_instead));
  return report;
}

void warn_of_moves(const PartsVerifyReport& report, const char* what_helps,
                   std::vector<Warning>& warnings) {
  if (report.wobble_mm.value_or(0.0) <= kHolds_mm) return;
  warnings.push_back(
      {.code = "moves_in_paper",
       .message =
           fmt::format("{} moves by {:.2f} mm where folds are {:g} mm off their lines; {}",
                       report.wobbles_most, *report.wobble_mm, hands::Play{}.line_mm, what_helps)});
}

Result<SoundLayers> sound_layers(const DesignSpec& spec, const SurfaceAssets& assets,
                                 const std::string& creator, const Progress& progress) {
  auto made = layered_card(spec, assets, progress);
  if (!made) return tl::unexpected(made.error());
  return sound_layers(std::move(*made), creator, progress);
}

Result<SoundLayers> sound_layers(LayeredCard made, const std::string& creator,
                                 const Progress& progress) {
  auto fold = structure_fold(made.card, creator);
  if (!fold) return tl::unexpected(fold.error());
  auto report = sound_report(*fold, "try other layers or another size", progress);
  if (!report) return tl::unexpected(report.error());
  warn_of_moves(*report, "crease and glue it exactly", made.warnings);
  return SoundLayers{std::move(made), std::move(*fold), std::move(*report)};
}

}  // namespace popcut::judge
