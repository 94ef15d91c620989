// SPDX-License-Identifier: MIT
#include "daemon/planning/views/parts_card.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "core/compare/depth_image.hpp"
#include "core/compare/picture.hpp"
#include "core/compare/view.hpp"
#include "core/design/boxes/boxed_report.hpp"
#include "core/design/layers/layered_report.hpp"
#include "core/design/slices/sliced_report.hpp"
#include "core/geometry/triangulate.hpp"
#include "core/judge/boxes_likeness.hpp"
#include "core/judge/layers_likeness.hpp"
#include "core/judge/parts_motion.hpp"
#include "core/judge/sound_boxes.hpp"
#include "core/judge/sound_layers.hpp"
#include "core/judge/sound_slices.hpp"
#include "core/parts/structure_fold.hpp"
#include "core/text/svg_document.hpp"
#include "daemon/digest/digest.hpp"
#include "daemon/pictures/png.hpp"

namespace popcut::planning {
namespace parts_card_parts {
namespace {

constexpr const char* kPartsCreator = "popcut " POPCUT_VERSION;

/// All corners of a motion's first pose as triangles, three numbers each.
std::vector<float> open_triangles(const judge::PartsMotion& moves) {
  const Pattern& pattern = moves.pattern;
  const std::vector<Vec3>& places = moves.motion.places.front();
  std::vector<Vec2> flat;
  for (const PatternVertex& p : pattern.vertices) flat.push_back({pattern.u(p), p.v});
  std::vector<float> out;
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    std::vector<Triangle> cut;
    if (!triangulate(flat, pattern.face(f), cut)) continue;
    for (const Triangle& t : cut)
      for (const std::uint32_t corner : t)
        for (const double at : {places[corner].x(), places[corner].y(), places[corner].z()})
          out.push_back(static_cast<float>(at));
  }
  return out;
}

}  // namespace
}  // namespace parts_card_parts

std::string PartsCard::report() const {
  return layers   ? layered_report_json(*layers, judge::layers_likeness(*layers, {}), 0.0)
         : slices ? sliced_report_json(*slices, 0.0)
                  : boxed_report_json(*boxes, judge::boxes_likeness(*boxes, {}), 0.0);
}

Result<PartsCard> parts_card(const DesignSpec& spec, const SurfaceAssets& assets, bool is_checked,
                             const Progress& progress) {
  using namespace parts_card_parts;
  PartsCard out;
  if (spec.style == DesignStyle::Layers) {
    auto made = layered_card(spec, assets, progress);
    if (!made) return tl::unexpected(made.error());
    out.layers = std::move(*made);
  } else if (spec.style == DesignStyle::Boxes && !is_checked) {
    auto made = boxed_card(spec, assets, progress);
    if (!made) return tl::unexpected(made.error());
    out.boxes = std::move(*made);
  } else if (is_of_boxes(spec)) {
    // Which roofs are glued on depends on what verify finds.
    auto made = judge::sound_boxes(spec, assets, kPartsCreator, progress);
    if (!made) return tl::unexpected(made.error());
    out.boxes = std::move(made->made), out.fold = std::move(made->fold);
    return out;
  } else {
    auto made = sliced_card(spec, assets, progress);
    if (!made) return tl::unexpected(made.error());
    out.slices = std::move(*made);
  }
  auto fold = structure_fold(out.card(), kPartsCreator);
  if (!fold) return tl::unexpected(fold.error());
  out.fold = std::move(*fold);
  if (!is_checked) return out;
  const char* const instead =
      out.layers ? "try other layers or another size" : "try other numbers of slices";
  if (auto sound = judge::sound_report(out.fold, instead, progress); !sound)
    return tl::unexpected(sound.error());
  return out;
}

Result<std::string> parts_blob(std::string_view fold, LatticeBlobOptions how) {
  auto moves = judge::parts_motion(fold);
  if (!moves) return tl::unexpected(moves.error());
  for (judge::ShownPart& part : moves->parts)
    how.parts.push_back(
        {std::move(part.name), part.faces, part.folds, part.tabs, part.box_mm, part.shift_mm});
  how.error = false;
  return lattice_blob(
      moves->pattern,
      LatticeFrames{std::move(moves->motion.psi_rad), std::move(moves->motion.places)}, how);
}

Result<std::string> shown_blob(const PartsCard& made, LatticeQuality quality) {
  LatticeBlobOptions how;
  how.quality = quality;
  how.warnings = made.warnings();
  how.report = made.report();
  return parts_blob(made.fold, std::move(how));
}

Result<std::string> small_parts_svg(std::string_view fold) {
  using namespace parts_card_parts;
  constexpr int kSide_px = 400;
  constexpr double kRoom = 0.85;  // of the diagonal: a card is wider than high
  const auto moves = judge::parts_motion(fold);
  if (!moves) return tl::unexpected(moves.error());
  const std::vector<float> triangles = open_triangles(*moves);
  const likeness::Box box = likeness::box_of(triangles);
  const likeness::Frame frame{likeness::view_from(Vec3{1.0, 0.3, 0.6}), box.centre(),
                              kRoom * box.diagonal(), kSide_px};
  likeness::DepthImage image;
  likeness::draw(frame, triangles, image);
  const likeness::Pixels pixels = likeness::shaded(
      image, frame.pitch_mm(), static_cast<float>(likeness::kWithin * box.diagonal()),
      likeness::kPaperColour);
  const auto png = png_of_pixels(pixels.rgb, pixels.size, pixels.size);
  if (!png) return tl::unexpected(png.error());
  return svg_head(fmt::format("width=\"{0}\" height=\"{0}\" viewBox=\"0 0 {0} {0}\"", kSide_px), {},
                  SvgPlace::Inside) +
         fmt::format(
             "<image width=\"{0}\" height=\"{0}\" href=\"data:image/png;base64,{1}\"/>\n"
             "</svg>\n",
             kSide_px, daemon::base64(*png));
}

}  // namespace popcut::planning
