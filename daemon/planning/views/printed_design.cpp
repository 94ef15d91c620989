// SPDX-License-Identifier: MIT
#include "daemon/planning/views/printed_design.hpp"

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "core/artwork/boxes_artwork.hpp"
#include "core/artwork/colour_mesh_reader.hpp"
#include "core/artwork/layers_artwork.hpp"
#include "core/design/book.hpp"
#include "daemon/pictures/image_reader.hpp"

namespace popcut::planning {
namespace printed_design_parts {
namespace {

/// A file name for an asset, which has none: its ending says what the bytes are.
std::string named(const std::string& id, const std::string& bytes) {
  if (bytes.starts_with("glTF")) return id + ".glb";
  const std::size_t first = bytes.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  if (first != std::string::npos && bytes[first] == '{') return id + ".gltf";
  const bool stl = bytes.starts_with("solid") || bytes.find('\0') != std::string::npos;
  return id + (stl ? ".stl" : ".obj");
}

/// Assets stand alone: what they name is in them, or nowhere.
ModelFiles no_files_beside() {
  return {[](const std::string& name) -> Result<std::string> {
            return fail(ErrorKind::Malformed, name, "is not in the asset");
          },
          [](const std::string& name, std::string_view bytes, std::size_t most) {
            return read_image(name, bytes, most);
          },
          "upload the model with its pictures as one GLB and name that with `model`, or ask for "
          "`clay`"};
}

}  // namespace
}  // namespace printed_design_parts

Result<ColourMesh> asset_colours(const std::string& id, const std::string& bytes, bool clay) {
  using namespace printed_design_parts;
  const std::string name = named(id, bytes);
  auto mesh = read_colour_mesh(name, bytes, no_files_beside(), !clay);
  if (!mesh) {
    Error error = mesh.error();
    if (error.place.starts_with(name)) error.place.replace(0, name.size(), id);
    return tl::unexpected(std::move(error));
  }
  if (clay) make_clay(*mesh);
  return mesh;
}

double usual_shade(const PrintedDesign& design) {
  // Layers and boxes stand as the model's sides do, so the light of the room shades them too.
  constexpr double kOfClay = 0.6, kOfClayParts = 0.35;
  if (design.coloured) return 0;
  return design.layers || design.boxes ? kOfClayParts : kOfClay;
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

PrintedDesign printed_layers(const LayeredCard& made, const std::optional<ColourMesh>& model) {
  PrintedDesign out;
  out.coloured = model && model->coloured;
  out.layers = PrintedLayers{made, model ? model_on_card(made, *model) : clay_on_card(made)};
  return out;
}

PrintedDesign printed_boxes(const BoxedCard& made, const std::optional<ColourMesh>& model) {
  PrintedDesign out;
  out.coloured = model && model->coloured;
  out.boxes = PrintedBoxes{made, model ? model_on_card(made, *model) : clay_on_card(made)};
  return out;
}

Result<Artwork> planned_artwork(const PrintedDesign& design, const Plan& plan, const Texture* image,
                                ArtworkOptions how) {
  const Placement& map = plan.drawing_transform;
  const double scale = std::sqrt(std::abs(map.xx * map.yy - map.xy * map.yx));
  how.pixel_mm /= scale;
  how.trapping = {how.trapping.trap_mm / scale, how.trapping.bleed_mm / scale};
  if (design.layers)
    return layers_artwork(design.layers->card, design.layers->model, plan.parts, how);
  if (design.boxes) return boxes_artwork(design.boxes->card, design.boxes->model, plan.parts, how);
  std::vector<const Pattern*> parts;
  for (const Pattern& part : design.parts) parts.push_back(&part);
  return design_artwork(parts, design.models, image, how);
}

}  // namespace popcut::planning
