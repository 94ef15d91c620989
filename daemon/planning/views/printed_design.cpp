// SPDX-License-Identifier: MIT
#include "daemon/planning/views/printed_design.hpp"

#include <cmath>
#include <cstddef>
#include <utility>

#include "core/design/book.hpp"

namespace popcut::planning {

double usual_shade(const PrintedDesign& design) {
  constexpr double kOfClay = 0.6;
  return design.coloured ? 0 : kOfClay;
}

Result<PrintedDesign> printed_design(const DesignSpec& spec, const SurfaceAssets& assets,
                                     const PatchAssembly& made,
                                     const std::optional<ColourMesh>& model) {
  std::optional<TargetPlacement> of_book;
  if (model && made.book) {
    auto placement = book_placement(spec, assets);
    if (!placement) return tl::unexpected(placement.error());
    of_book = *placement;
  }
  PrintedDesign out;
  for (std::size_t k = 0; k < made.parts.size(); ++k) {
    const Design& part = made.parts[k];
    out.parts.push_back(part.pattern);
    if (!model)
      out.models.push_back(clay_on_sheet(part));
    else
      out.models.push_back(model_on_sheet(
          *model, of_book ? card_of_book(spec, *of_book, k).placement : spec.placement, part));
  }
  out.coloured = model && model->coloured;
  out.around = made.book.has_value();
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
