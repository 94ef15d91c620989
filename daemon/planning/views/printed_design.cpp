// SPDX-License-Identifier: MIT
#include "daemon/planning/views/printed_design.hpp"

#include <cmath>
#include <utility>

namespace popcut::planning {

double usual_shade(const PrintedDesign& design) {
  constexpr double kOfClay = 0.6;
  return design.coloured ? 0 : kOfClay;
}

PrintedDesign printed_design(const DesignSpec& spec, const PatchAssembly& made,
                             const std::optional<ColourMesh>& model) {
  PrintedDesign out;
  for (const Design& part : made.parts) {
    out.parts.push_back(part.pattern);
    out.models.push_back(model ? model_on_sheet(*model, spec.placement, part)
                               : clay_on_sheet(part));
  }
  out.coloured = model && model->coloured;
  return out;
}

Result<Artwork> planned_artwork(const PrintedDesign& design, const Plan& plan, const Texture* image,
                                ArtworkOptions how) {
  const Placement& map = plan.drawing_transform;
  const double scale = std::sqrt(std::abs(map.xx * map.yy - map.xy * map.yx));
  how.pixel_mm /= scale;
  how.trapping = {how.trapping.trap_mm / scale, how.trapping.bleed_mm / scale};
  std::vector<const Pattern*> parts;
  for (const Pattern& part : design.parts) parts.push_back(&part);
  return design_artwork(parts, design.models, image, how);
}

}  // namespace popcut::planning
