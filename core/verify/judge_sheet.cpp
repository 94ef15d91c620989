// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/verify/judge.hpp"

namespace popcut::verify {
namespace {

void check_pieces(const Subject& subject, VerifyReport& report) {
  VerifyCheck check = named("pieces");
  const Sheet& sheet = subject.sheet;
  report.pieces = sheet.pieces;
  check.detail = fmt::format("{} piece{}, {} rigid faces ({} faces in the file)", sheet.pieces,
                             sheet.pieces == 1 ? "" : "s", sheet.panels, subject.file.faces());
  std::vector<std::size_t> size(sheet.pieces, 0);
  std::vector<std::size_t> first(sheet.pieces, subject.file.faces());
  for (std::size_t f = 0; f < subject.file.faces(); ++f) {
    ++size[sheet.piece_of_face[f]];
    first[sheet.piece_of_face[f]] = std::min(first[sheet.piece_of_face[f]], f);
  }
  const auto largest = std::max_element(size.begin(), size.end()) - size.begin();
  for (std::size_t p = 0; p < sheet.pieces; ++p) {
    if (static_cast<std::ptrdiff_t>(p) == largest) continue;
    check.fail(face_place(first[p]), fmt::format("{} face{} cut off from the rest of the sheet",
                                                 size[p], size[p] == 1 ? " is" : "s are"));
  }
  report.checks.push_back(std::move(check));
}

/// Adds a note if unassigned edges of an assigned pattern with a face on one side count as borders.
void note_unassigned_borders(const Subject& subject, VerifyReport& report) {
  if (!subject.file.assigned || subject.file.from_popcut) return;
  std::vector<std::uint8_t> sides(subject.file.edges.size(), 0);
  for (const std::int32_t e : subject.sheet.side_edge)
    if (e >= 0) ++sides[static_cast<std::size_t>(e)];
  std::size_t count = 0;
  for (std::size_t e = 0; e < sides.size(); ++e)
    count += sides[e] == 1 && subject.file.assignment[e] == Assignment::Unassigned ? 1 : 0;
  if (count == 0) return;
  report.notes.push_back(fmt::format(
      "{} unassigned edge{} with a face on one side only count{} as border; assign B to {}", count,
      count == 1 ? "" : "s", count == 1 ? "s" : "", count == 1 ? "it" : "them"));
}

}  // namespace

Limits limits_of(const FoldModel& file) {
  if (file.from_popcut) return {};
  double reach = 0.0;
  const Vec2 origin = file.flat[file.edges.front()[0]];
  for (const auto& edge : file.edges) {
    for (const std::uint32_t v : edge) reach = std::max(reach, norm(file.flat[v] - origin));
  }
  // A drawing is only as exact as its author made it: allow panels to give a little.
  const double drawn_mm = file.drawn ? 3e-4 * reach : 0.0;
  return {.slack_mm = 1e-6 * reach,
          .isometry_mm = std::max({1e-5 * reach, 2.0 * file.moved_mm, drawn_mm}),
          .angle_deg = 0.1};
}

std::string near_place(const Subject& subject, const char* what, Vec2 p) {
  return subject.page ? fmt::format("{} near x {:.2f}, y {:.2f} mm", what, p.y(), p.x())
                      : fmt::format("{} near ({:.6g}, {:.6g}) mm", what, p.x(), p.y());
}

VerifyCheck named(const char* name) {
  VerifyCheck check;
  check.name = name;
  return check;
}

void judge_flat_sheet(Subject& subject, VerifyCheck faces, VerifyReport& report) {
  subject.triangles = check_faces(subject.file, faces);
  faces.detail = faces.ok() ? fmt::format("{} simple faces, each fold between two of them",
                                          subject.file.faces())
                            : fmt::format("{} wrong", faces.failed);
  check_pieces(subject, report);
  report.checks.push_back(std::move(faces));

  VerifyCheck lines = named("lines");
  check_lines(subject.file, subject.sheet, subject.limits.slack_mm, lines);
  report.checks.push_back(std::move(lines));

  VerifyCheck tiling = named("tiling");
  static_cast<Tiling&>(report) =
      check_tiling(subject.file, subject.sheet, subject.triangles, subject.limits.slack_mm, tiling);
  report.checks.push_back(std::move(tiling));
  note_unassigned_borders(subject, report);
  report.vertices = subject.file.flat.size();
  report.edges = subject.file.edges.size();
  report.fold_faces = subject.file.faces();
  report.faces = subject.sheet.panels;
}

}  // namespace popcut::verify
