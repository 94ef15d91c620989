// SPDX-License-Identifier: MIT
// Drawings and patterns: SVG, DXF, FOLD, crease patterns.
#include <algorithm>
#include <string>
#include <vector>

#include "core/formats/dxf/dxf_reader.hpp"
#include "core/formats/fold/crease_pattern.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/formats/svg/svg_dash.hpp"
#include "core/formats/svg/svg_reader.hpp"
#include "core/formats/svg/syntax/svg_colour.hpp"
#include "core/formats/svg/syntax/svg_css.hpp"
#include "core/formats/svg/syntax/svg_path.hpp"
#include "core/formats/svg/syntax/svg_transform.hpp"
#include "core/formats/svg/syntax/svg_units.hpp"
#include "core/verify/parts/joint_model.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "tests/fuzz/targets.hpp"

namespace popcut::fuzzing {
namespace {

void svg_path(std::string_view text) {
  SvgLines lines;
  (void)read_svg_path(text, 0.02, 100'000, lines);
}

void svg_transform(std::string_view text) {
  if (const auto transform = parse_svg_transform(text)) {
    (void)transform->largest_scale();
    (void)(*transform)({1.0, -1.0});
  }
}

/// The text is a style sheet, and each of its declarations a colour, a length and dashes too.
void svg_css(std::string_view text) {
  static const pugi::xml_document document = [] {
    pugi::xml_document made;
    made.load_string(
        "<svg><g class='a b' id='i'><path class='cut a' id='p' data-x='yes no'/></g></svg>");
    return made;
  }();
  CssSheets sheets;
  (void)sheets.add(text);
  const pugi::xml_node path = document.child("svg").child("g").child("path");
  std::size_t steps = 100'000;
  std::vector<const CssRule*> found;
  (void)sheets.find(path, "path", "p", "cut a", steps, found);
  for (const CssRule* rule : found) {
    std::string_view rest = rule->declarations;
    CssDeclaration one;
    while (next_declaration(rest, one)) {
      (void)parse_svg_paint(one.value);
      (void)parse_svg_length(one.value);
      (void)parse_svg_dashes(one.value);
    }
  }
}

SvgReadOptions svg_options(const char* profile) {
  SvgReadOptions how;
  how.profile = *find_stroke_profile(profile);
  how.limits = {100'000, 8u << 20, 20'000, 2'000'000, 100};
  return how;
}

void svg_document(std::string_view text) {
  static const SvgReadOptions plain = svg_options("popcut"), rules = svg_options("rabbit-ear");
  const SvgReadOptions& how = text.size() % 2 == 0 ? rules : plain;
  const auto work = linework_from_svg(std::string(text), how);
  if (!accepted(work)) return;
  demand(work->points.size() <= how.limits.points);
  demand_sound(*work);
  std::size_t points = 0;
  for (const DrawnLine& line : work->lines) {
    demand(line.first == points);
    points += line.count;
  }
  demand(points == work->points.size());
}

void dxf(std::string_view text) {
  DxfOptions options;
  options.most_points = 100'000;
  options.most_lines = 100'000;
  options.colours = DxfColours::OrigamiSim;
  const auto work = linework_from_dxf(text, options);
  if (!accepted(work)) return;
  demand(work->points.size() <= options.most_points);
  demand_sound(*work);
}

void fold(std::string_view text) {
  if (const auto file = read_fold(text); accepted(file))
    for (const FoldFrame& frame : file->frames) {
      const std::size_t count = frame.vertices.size();
      for (const auto& edge : frame.edges) demand(std::max(edge[0], edge[1]) < count);
      for (const auto& face : frame.faces)
        for (const std::uint32_t v : face) demand(v < count);
      demand(frame.assignments.size() == frame.edges.size());
      demand(frame.fold_angles_deg.size() == frame.edges.size());
    }
  if (const auto work = linework_from_fold(text)) demand_sound(*work);
}

/// Lines of numbers or XML, and then the FOLD text that is made of them.
void crease_pattern(std::string_view text) {
  if (const auto made = fold_of_crease_pattern(text); accepted(made)) fold(*made);
}

/// What verify reads as a pattern: arrays that agree and indices that exist.
void verify_fold(std::string_view text) {
  const auto file = verify::read_fold_model(text);
  if (!accepted(file)) return;
  const std::size_t count = file->flat.size();
  for (const Vec2& p : file->flat)
    demand(std::abs(p.x()) <= verify::kMaxCoordinate_mm &&
           std::abs(p.y()) <= verify::kMaxCoordinate_mm);
  for (const auto& edge : file->edges)
    for (const std::uint32_t v : edge) demand(v < count);
  demand(file->assignment.size() == file->edges.size());
  for (const std::uint32_t v : file->face_vertices) demand(v < count);
  for (std::size_t face = 0; face < file->faces(); ++face)
    demand(file->face_first[face] <= file->face_first[face + 1]);
}

/// A card of several parts: every joint names a face that exists, on a line with a length.
void verify_parts(std::string_view text) {
  const auto card = verify::read_joint_model(text);
  if (!accepted(card)) return;
  demand(card->parts.size() <= verify::kMostParts && card->joints.size() <= verify::kMostJoints);
  for (const verify::CardJoint& joint : card->joints)
    for (const verify::JointSide& side : {joint.a, joint.b}) {
      demand(side.part < card->parts.size());
      demand(side.face < card->parts[side.part].sheet.faces());
    }
}

constexpr Target kTargets[] = {{"svg_path", svg_path},
                               {"svg_transform", svg_transform},
                               {"svg_css", svg_css},
                               {"svg_document", svg_document},
                               {"dxf", dxf},
                               {"fold", fold},
                               {"crease_pattern", crease_pattern},
                               {"verify_fold", verify_fold},
                               {"verify_parts", verify_parts}};

}  // namespace

std::span<const Target> drawing_targets() { return kTargets; }

}  // namespace popcut::fuzzing
