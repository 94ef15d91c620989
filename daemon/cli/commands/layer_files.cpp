// SPDX-License-Identifier: MIT
#include "daemon/cli/commands/layer_files.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/design/boxes/boxed_report.hpp"
#include "core/design/layers/layered_report.hpp"
#include "core/design/slices/sliced_report.hpp"
#include "core/drawing/linework.hpp"
#include "core/formats/write/pattern_files.hpp"
#include "core/geometry/angle.hpp"
#include "core/plan/knife/micro_cut.hpp"
#include "core/text/utf8.hpp"
#include "daemon/cli/view/book_picture.hpp"
#include "daemon/pictures/png.hpp"
#include "daemon/planning/design_export.hpp"

namespace popcut::cli {
namespace layer_files_parts {
namespace {

/// As a person sees it who looks at the front: x towards that person, then up.
std::vector<float> as_seen(const TriangleSoup& soup, bool looks_along_spine, bool from_aside) {
  std::vector<float> out;
  if (from_aside) {
    for (std::size_t k = 0; k < soup.corners.size(); k += 3)
      for (const std::size_t axis : {0U, 2U, 1U})
        out.push_back(static_cast<float>((axis == 1 ? -1.0 : 1.0) * soup.corners[k + axis]));
    return out;
  }
  out.reserve(soup.corners.size());
  const double along = looks_along_spine ? -1.0 : 1.0;
  for (std::size_t k = 0; k < soup.corners.size(); k += 3) {
    out.push_back(static_cast<float>(along * soup.corners[k + 1]));
    out.push_back(static_cast<float>(soup.corners[k + 2]));
    out.push_back(static_cast<float>(along * soup.corners[k]));
  }
  return out;
}

/// The card at an opening, both pages sloping alike.
PartPoses level_pose(const Structure& card, double opening_rad) {
  PartPoses out = posed(card, opening_rad);
  const Eigen::Isometry3d turn(
      Eigen::AngleAxisd(-0.5 * (std::numbers::pi - opening_rad), Vec3{0.0, 1.0, 0.0}));
  for (auto& part : out)
    for (Eigen::Isometry3d& face : part) face = turn * face;
  return out;
}

/// A card of several parts, as its files show it.
struct PartsToWrite {
  const Structure& card;
  const std::string& fold;
  const TriangleSoup& target;
  bool looks_along_spine{};
  const char* what{};  ///< "layers"
  std::size_t count{};
  std::string report;
  std::function<PartPoses(double opening_rad)> pose;
  bool from_aside{};  ///< looked at along the pages' x axis, with the spine from left to right
};

Result<std::string> picture_of(const PartsToWrite& made) {
  std::vector<OpenedCard> openings;
  const std::array<double, 3> flat{180.0, 120.0, 50.0}, corner{90.0, 60.0, 30.0};
  for (const double opening_deg : made.card.opens_deg < 180.0 ? corner : flat)
    openings.push_back({fmt::format("{:g} degrees", opening_deg),
                        as_seen(faces_in_space(made.card, made.pose(radians(opening_deg))),
                                made.looks_along_spine, made.from_aside)});
  return opened_picture(openings, as_seen(made.target, made.looks_along_spine, made.from_aside),
                        fmt::format("{}: {} {} on pages of {:.0f} x {:.0f} mm", made.card.name,
                                    made.count, made.what, made.card.page_mm, made.card.length_mm));
}

Result<std::string> add_files(const PartsToWrite& made, const Material& material,
                              const std::function<bool(std::string_view)>& wants,
                              OutputFolder& folder) {
  constexpr int kLargestPx = 1600;
  const Pattern drawing = parts_drawing(made.card);
  std::string names;
  const auto add = [&](const char* name, const std::string& text) {
    names += fmt::format(" {}", name);
    return folder.add(name, text);
  };
  const auto drawn = [](const auto& write) {
    std::ostringstream out;
    write(out);
    return std::move(out).str();
  };
  const std::string look = drawn([&](std::ostream& out) { write_pattern_svg(drawing, out); });
  if (wants("fold"))
    if (auto done = add("pattern.fold", made.fold); !done) return tl::unexpected(done.error());
  if (wants("svg"))
    if (auto done = add("pattern.svg", look); !done) return tl::unexpected(done.error());
  if (wants("cut")) {
    const Dashed dashed = micro_cut(linework_from_pattern(drawing), material.dashes);
    const std::string text = drawn(
        [&](std::ostream& out) { write_cut_svg(drawing, planning::micro_cuts(dashed.work), out); });
    if (auto done = add("cut.svg", text); !done) return tl::unexpected(done.error());
  }
  if (wants("dxf")) {
    const std::string text = drawn([&](std::ostream& out) { write_pattern_dxf(drawing, out); });
    if (auto done = add("pattern.dxf", text); !done) return tl::unexpected(done.error());
  }
  if (wants("png") || wants("picture")) {
    const auto picture = picture_of(made);
    if (!picture) return tl::unexpected(picture.error());
    if (wants("picture"))
      if (auto done = add("deployed.svg", *picture); !done) return tl::unexpected(done.error());
    for (const auto& [name, svg] :
         {std::pair("pattern.png", &look), std::pair("deployed.png", &*picture)}) {
      if (!wants("png")) break;
      const auto png = png_of_svg(*svg, kLargestPx);
      if (!png) return tl::unexpected(png.error());
      if (auto done = add(name, *png); !done) return tl::unexpected(done.error());
    }
  }
  if (wants("report"))
    if (auto done = add("report.json", made.report); !done) return tl::unexpected(done.error());
  return names;
}

}  // namespace
}  // namespace layer_files_parts

Result<std::string> add_layer_files(const judge::SoundLayers& sound,
                                    const likeness::PrintedFigures& printed,
                                    const Material& material, double seconds,
                                    const std::function<bool(std::string_view)>& wants,
                                    OutputFolder& folder) {
  const LayeredCard& made = sound.made;
  return layer_files_parts::add_files(
      {made.card, sound.fold, made.target, made.looks_along_spine, "layers", made.layers.size(),
       layered_report_json(made, printed, seconds),
       [&](double opening_rad) { return pose_at(made, opening_rad); }},
      material, wants, folder);
}

Result<std::string> add_slice_files(const judge::SoundSlices& sound, const Material& material,
                                    double seconds,
                                    const std::function<bool(std::string_view)>& wants,
                                    OutputFolder& folder) {
  const SlicedCard& made = sound.made;
  return layer_files_parts::add_files(
      {made.card, sound.fold, made.target, false, "slices", made.lattice.pieces.size(),
       sliced_report_json(made, seconds),
       [&](double opening_rad) { return layer_files_parts::level_pose(made.card, opening_rad); }},
      material, wants, folder);
}

namespace layer_files_parts {
namespace {

void say_looks(const likeness::PrintedFigures& printed, bool opens_flat) {
  fmt::print(stderr, "  looks    {} when printed, {}: error {:.4f}\n",
             likeness::name_of(likeness::looks(printed)),
             opens_flat ? "from 20 to 60 degrees above the page" : "from around the diagonal",
             printed.error());
}

std::size_t count_of(const BoxedCard& made) {
  return made.is_of_facets() ? made.tents.size() : made.boxes.size();
}

const char* word_of(const BoxedCard& made) {
  const bool is_one = count_of(made) == 1;
  if (made.is_of_facets()) return is_one ? "glued roof" : "glued roofs";
  return is_one ? "box" : "boxes";
}

}  // namespace
}  // namespace layer_files_parts

Result<std::string> add_box_files(const judge::SoundBoxes& sound,
                                  const likeness::PrintedFigures& printed, const Material& material,
                                  double seconds,
                                  const std::function<bool(std::string_view)>& wants,
                                  OutputFolder& folder) {
  const BoxedCard& made = sound.made;
  return layer_files_parts::add_files(
      {made.card, sound.fold, made.target, false, layer_files_parts::word_of(made),
       layer_files_parts::count_of(made), boxed_report_json(made, printed, seconds),
       [&](double opening_rad) { return pose_at(made, opening_rad); }, !made.faces_along_spine()},
      material, wants, folder);
}

void say_boxes(const judge::SoundBoxes& sound, const likeness::PrintedFigures& printed) {
  const BoxedCard& made = sound.made;
  const char* const word = layer_files_parts::word_of(made);
  fmt::print(stderr, "{}: {} {} on a card that opens {}, in one movement\n",
             shown_text(made.card.name), layer_files_parts::count_of(made), word,
             made.is_of_facets() ? "to 90 degrees" : "flat");
  fmt::print(stderr,
             "  pages    {:.1f} mm from the spine, {:.1f} mm along it; shut, the {} reach{} "
             "{:.1f} mm, and the stack is {:.1f} mm high\n",
             made.card.page_mm, made.card.length_mm, word,
             layer_files_parts::count_of(made) == 1 ? "es" : "", sound.report.closed_mm,
             sound.report.stack_mm);
  for (const CardTent& tent : made.tents)
    fmt::print(
        stderr,
        "  {:<8} {:.1f} mm long, {:.1f} across, falls at {:.0f} degrees; its strut is {:.1f} "
        "mm\n",
        tent.name, tent.along_mm[1] - tent.along_mm[0], tent.section.roof_mm,
        degrees(tent.section.slope_rad), tent.section.strut_mm);
  for (const CardBox& box : made.boxes)
    fmt::print(
        stderr, "  {:<8} {:.1f} mm long, {:.1f} wide, {:.1f} high; {}, {} panels\n", box.name,
        box.block.to_mm - box.block.from_mm, 2.0 * box.block.half_mm, box.block.top_mm(),
        box.block.is_tent()
            ? "slopes alone"
            : fmt::format("walls {:.1f} mm, {} roof", box.block.height_mm, roof_word(box.block)),
        box.panels);
  fmt::print(stderr, "  pieces   {}, with {} tabs to glue\n", made.card.parts.size(), made.tabs);
  fmt::print(stderr, "  by hand  {}\n", hands::handwork_words(made.handwork));
  if (sound.report.wobble_mm)
    fmt::print(stderr, "  holds    panels move {:.2g} mm at most, when folds are 0.1 mm off\n",
               *sound.report.wobble_mm);
  layer_files_parts::say_looks(printed, !made.is_of_facets());
  fmt::print(stderr, "  shape    {:.2f} % of its size off on average; {:.0f} % of it within 2 %\n",
             100.0 * made.error(), 100.0 * made.fit.share_within[1]);
  for (const Warning& warning : made.warnings)
    fmt::print(stderr, "  warning  {}\n", shown_text(warning.message));
}

void say_slices(const judge::SoundSlices& sound) {
  const SlicedCard& made = sound.made;
  fmt::print(stderr, "{}: {} slices on a card that opens flat, in one movement\n",
             shown_text(made.card.name), made.lattice.pieces.size());
  fmt::print(stderr,
             "  pages    {:.1f} mm from the spine, {:.1f} mm along it; shut, the slices reach "
             "{:.1f} mm, and the stack is {:.1f} mm high\n",
             made.card.page_mm, made.card.length_mm, sound.report.closed_mm, sound.report.stack_mm);
  fmt::print(stderr, "  slots    {} crossings, slots {:.2f} mm wide; {} tabs to glue\n",
             made.lattice.crossings.size(), made.slot_mm, made.tabs);
  const auto steps = assembly_steps(made);
  for (std::size_t k = 0; k < steps.size(); ++k)
    fmt::print(stderr, "  {:<8} {} {}\n", k == 0 ? "assembly" : "",
               k == 0 ? "stand up" : "then, from above,", fmt::join(steps[k], " "));
  for (const Warning& warning : made.warnings)
    fmt::print(stderr, "  warning  {}\n", shown_text(warning.message));
}

void say_layers(const judge::SoundLayers& sound, const likeness::PrintedFigures& printed) {
  const LayeredCard& made = sound.made;
  const bool is_one = made.layers.size() == 1;
  fmt::print(stderr, "{}: {} layer{} on a card that opens {}, in one movement\n",
             shown_text(made.card.name), made.layers.size(), is_one ? "" : "s",
             made.opens_flat ? "flat" : "to 90 degrees");
  fmt::print(stderr,
             "  pages    {:.1f} mm from the spine, {:.1f} mm along it; shut, the layer{} "
             "{:.1f} mm, and the stack is {:.1f} mm high\n",
             made.card.page_mm, made.card.length_mm, is_one ? " reaches" : "s reach",
             sound.report.closed_mm, sound.report.stack_mm);
  fmt::print(stderr, "  pieces   {}, with {} tabs to glue\n", made.card.parts.size(), made.tabs);
  fmt::print(stderr, "  by hand  {}\n", hands::handwork_words(made.handwork));
  if (sound.report.wobble_mm)
    fmt::print(stderr, "  holds    panels move {:.2g} mm at most, when folds are 0.1 mm off\n",
               *sound.report.wobble_mm);
  layer_files_parts::say_looks(printed, made.opens_flat);
  for (const Warning& warning : made.warnings)
    fmt::print(stderr, "  warning  {}\n", shown_text(warning.message));
}

}  // namespace popcut::cli
