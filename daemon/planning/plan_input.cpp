// SPDX-License-Identifier: MIT
#include "daemon/planning/plan_input.hpp"

#include <utility>

#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/layout/layout.hpp"
#include "core/plan/plan.hpp"

namespace popcut::planning {
namespace {

Result<DrawingInput> from_spec(const std::string& text, const SpecSources& sources) {
  const auto spec = parse_design_spec(text);
  if (!spec) return tl::unexpected(spec.error());
  const auto assets = sources.assets(*spec);
  if (!assets) return tl::unexpected(assets.error());
  auto made = design_assembly(*spec, *assets);
  if (!made) return tl::unexpected(made.error());
  if (sources.designed)
    if (const auto kept = sources.designed(*spec, *made); !kept)
      return tl::unexpected(kept.error());
  if (made->parts.size() > 1) {
    std::vector<const Pattern*> parts;
    for (const Design& part : made->parts) parts.push_back(&part.pattern);
    JoinedParts joined = join_parts(parts);
    joined.drawing.name = made->name;
    return DrawingInput{std::move(joined.drawing), spec->material, std::move(joined.seams_x)};
  }
  return DrawingInput{linework_from_pattern(made->parts.front().pattern), spec->material, {}};
}

Result<DrawingInput> only_drawing(Result<LineWork> drawing) {
  if (!drawing) return tl::unexpected(drawing.error());
  return DrawingInput{std::move(*drawing), std::nullopt, {}};
}

Result<DrawingInput> from_dxf(const std::string& text, const SvgReadOptions& how, unsigned factor) {
  DxfOptions options = DxfOptions{}.raised(factor);
  if (how.profile.name == "origami-sim") options.colours = DxfColours::OrigamiSim;
  if (how.profile.name == "lightburn") options.colours = DxfColours::Lightburn;
  options.tolerance_mm = how.tolerance_mm;
  return only_drawing(linework_from_dxf(text, options));
}

Result<DrawingInput> from_fold(const std::string& text, unsigned factor) {
  return only_drawing(linework_from_fold(text, FoldLimits{}.raised(factor)));
}

}  // namespace

Result<DrawingInput> drawing_from_text(std::string text, InputKind kind, const SvgReadOptions& how,
                                       unsigned factor, const SpecSources& sources) {
  switch (kind) {
    case InputKind::Spec:
      return from_spec(text, sources);
    case InputKind::Fold:
      return from_fold(text, factor);
    case InputKind::Dxf:
      return from_dxf(text, how, factor);
    case InputKind::Svg:
      break;
  }
  return only_drawing(linework_from_svg(std::move(text), how));
}

DrawingInput test_shape_input() { return {test_shape(), std::nullopt, {}, PagePoint{5, 5}}; }

}  // namespace popcut::planning
