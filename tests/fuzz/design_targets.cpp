// SPDX-License-Identifier: MIT
// What a design is made from: specs, models, fonts, segments.
#include <string>

#include "core/artwork/colour_mesh_reader.hpp"
#include "core/design/outline/bridges.hpp"
#include "core/design/outline/drawing_outline.hpp"
#include "core/design/outline/extrusion.hpp"
#include "core/design/outline/text_outline.hpp"
#include "core/design/spec/spec.hpp"
#include "core/formats/csv/segments_reader.hpp"
#include "core/model/height_grid.hpp"
#include "core/model/model.hpp"
#include "daemon/pictures/image_reader.hpp"
#include "tests/fuzz/targets.hpp"

namespace popcut::fuzzing {
namespace {

void check(const DesignSpec& spec) {
  for (const DesignSpec& patch : spec.patches) check(patch);
  if (!spec.patches.empty()) {
    demand(spec.joins.size() + 1 == spec.patches.size());
    return;
  }
  long slices = 0;
  for (const RegionSpec& region : spec.regions) {
    demand(region.units_per_slice >= 1 && region.units_per_slice <= kMaxUnitsPerSlice);
    slices += region.slices;
  }
  demand(slices <= kMaxSlices);
  for (const double width : spec.widths_mm) demand(width > 0 && std::isfinite(width));
}

/// A spec is refused with a reason and a place, or all of it is within its limits.
void design_spec(std::string_view text) {
  const auto spec = parse_design_spec(text);
  if (accepted(spec))
    check(*spec);
  else
    demand(!spec.error().place.empty());
}

void check(const Result<TriangleMesh>& mesh) {
  if (!accepted(mesh)) return;
  demand(mesh->size() > 0 && mesh->size() <= kMaxTriangles && mesh->corners.size() % 9 == 0);
  for (const float one : mesh->corners) demand(std::isfinite(one));
}

/// The first byte chooses the name of the rest; the triangles read are finite numbers.
void mesh(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::string_view rest = bytes.substr(1);
  switch (static_cast<unsigned char>(bytes[0]) % 4) {
    case 0:
      return check(read_mesh("model.stl", rest));
    case 1:
      return check(read_mesh("model.obj", rest));
    case 2:
      return check(read_mesh("model", rest));
    default:
      return check(read_height_grid("heights.csv", rest));
  }
}

void check(const Result<ColourMesh>& mesh) {
  if (!accepted(mesh)) return;
  demand(mesh->size() > 0 && mesh->surfacing_of.size() == mesh->size());
  for (std::size_t t = 0; t < mesh->size(); ++t) {
    const Colour colour = colour_of(*mesh, t, {0.25, 0.5, 0.25}, texels_across(*mesh, t, 10));
    demand(colour.r >= 0 && colour.r <= 256);
  }
}

/// The first byte chooses what the rest is; an OBJ's materials and pictures are the rest too.
void colour_mesh(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::string_view rest = bytes.substr(1);
  const ModelFiles files{
      [rest](const std::string&) -> Result<std::string> { return std::string(rest); },
      [](const std::string& name, std::string_view picture, std::size_t most) {
        constexpr std::size_t kMostPixels = 1u << 20;
        return read_image(name, picture, std::min(most, kMostPixels));
      }};
  switch (static_cast<unsigned char>(bytes[0]) % 4) {
    case 0:
      return check(read_colour_mesh("model.obj", rest, files));
    case 1:
      return check(read_colour_mesh("model.glb", rest, files));
    case 2:
      return check(read_colour_mesh("model.gltf", rest, files));
    default:
      (void)accepted(read_image("picture", rest));
  }
}

void check(const Result<std::vector<Area>>& areas) {
  if (!accepted(areas)) return;
  demand(!areas->empty());
  const auto solid = extruded(*areas, 5.0);
  demand(!solid.empty() && solid.size() % 9 == 0);
  const auto joined = with_bridges(*areas, 2.0);
  if (accepted(joined)) demand(!joined->areas.empty());
}

/// The usual font with three bytes changed for each five of `changes`: a place, and the new bytes.
std::string changed_font(std::string_view changes) {
  std::string font(usual_font());
  for (std::size_t k = 0; k + 4 < changes.size(); k += 5) {
    std::size_t place = 0;
    for (std::size_t i = 0; i < 2; ++i)
      place = 256 * place + static_cast<unsigned char>(changes[k + i]);
    for (std::size_t i = 0; i < 3; ++i) font[(place + i) % font.size()] = changes[k + 2 + i];
  }
  return font;
}

/// The first byte chooses what the rest is: a text, a drawing, or changes in a font.
void outline(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::string rest(bytes.substr(1));
  switch (static_cast<unsigned char>(bytes[0]) % 3) {
    case 0:
      return check(text_areas(rest, usual_font(), 30.0));
    case 1:
      return check(drawing_areas(rest, 40.0));
    default:
      return check(text_areas("Pop\u00FC", changed_font(rest), 30.0));
  }
}

void segments(std::string_view text) {
  for (const auto convention : {SegmentConvention::Popcut, SegmentConvention::Paper}) {
    const auto panels = read_segments_csv(text, convention);
    if (!accepted(panels)) continue;
    demand(!panels->empty() && panels->size() <= kMaxSegments);
    for (const SegmentPanel& panel : *panels) {
      demand(panel.width > 0 && std::isfinite(panel.width));
      for (const double place : {panel.x0, panel.z0, panel.x1, panel.z1, panel.v})
        demand(std::isfinite(place));
    }
  }
}

constexpr Target kTargets[] = {{"design_spec", design_spec},
                               {"mesh", mesh},
                               {"colour_mesh", colour_mesh},
                               {"outline", outline, true},
                               {"segments", segments}};

}  // namespace

std::span<const Target> design_targets() { return kTargets; }

}  // namespace popcut::fuzzing
