// SPDX-License-Identifier: MIT
#include "daemon/planning/foreign_blob.hpp"

#include <algorithm>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/deploy/loaded_pattern.hpp"
#include "core/deploy/pose_table.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/lattice/lattice_blob.hpp"
#include "core/judge/sheet_motion.hpp"
#include "core/machines/machine.hpp"
#include "core/verify/verify.hpp"
#include "daemon/planning/plan_input.hpp"
#include "daemon/planning/plan_job.hpp"

namespace popcut::planning {
namespace {

/// A pattern from elsewhere, read.
struct Foreign {
  std::string fold;  ///< its text as a FOLD file
  LineWork lines;
  std::vector<Warning> warnings;
};

/// Drawings whose colours could mean several things are read as Origami Simulator does.
Result<Foreign> read_foreign(std::string text, InputKind kind, SvgReadOptions how) {
  auto drawn = drawing_from_text(text, kind, how, 1, {});
  if (!drawn && drawn.error().reason == ErrorReason::Unclear) {
    auto found = find_stroke_profile("origami-sim");
    if (!found) return tl::unexpected(found.error());
    found->colours = std::move(how.profile.colours);
    found->labels.merge(how.profile.labels);
    how.profile = std::move(*found);
    drawn = drawing_from_text(text, kind, how, 1, {});
  }
  if (!drawn) return tl::unexpected(drawn.error());
  Foreign foreign{{}, std::move(drawn->drawing), {}};
  foreign.warnings = foreign.lines.warnings;
  foreign.fold = kind == InputKind::Fold ? std::move(text) : fold_from_linework(foreign.lines);
  return foreign;
}

EdgeRole role_of(Operation operation) {
  switch (operation) {
    case Operation::FoldMountain:
      return EdgeRole::Mountain;
    case Operation::FoldValley:
      return EdgeRole::Valley;
    case Operation::Outline:
      return EdgeRole::Outline;
    default:
      return EdgeRole::Slit;
  }
}

/// Only the lines to cut and fold, on a page (x = v, y = u).
Pattern lines_alone(const LineWork& work) {
  Pattern pattern;
  pattern.name = work.name;
  pattern.card = false;
  for (const DrawnLine& line : work.lines) {
    const bool is_shown = is_fold(line.operation) || line.operation == Operation::Cut ||
                          line.operation == Operation::Outline;
    if (!is_shown) continue;
    const auto points = work.points_of(line);
    for (std::size_t i = 1; i < points.size(); ++i)
      pattern.lines.push_back(
          {points[i - 1].y, points[i - 1].x, points[i].y, points[i].x, role_of(line.operation)});
  }
  return pattern;
}

/// What the verifier says of it goes into `how`.
void judge(const std::string& fold, LatticeBlobOptions& how) {
  VerifyOptions options;
  options.quick = true;
  const auto report = verify_fold(fold, options);
  if (!report) return how.not_judged.push_back(message(report.error()));
  for (const VerifyCheck& check : report->checks) {
    if (!check.ran) {
      how.not_judged.push_back(fmt::format("{}: {}", check.name, check.detail));
      continue;
    }
    how.judged.push_back(check.name);
    if (check.ok() || check.failures.empty()) continue;
    const VerifyFailure& first = check.failures.front();
    how.warnings.push_back(
        {.code = "unsound",
         .message = fmt::format("{}: {} ({})", check.name, first.detail, first.place)});
  }
}

/// Opens the flat sheet as far as it goes.
Result<judge::SheetMotion> open_as_far(const std::string& fold, std::vector<Warning>& warnings) {
  using std::numbers::pi;
  const struct {
    double to_rad;
    int frames;
  } ways[] = {{0, 25}, {pi / 2, 13}, {0.75 * pi, 7}};
  std::string why;
  for (const auto& way : ways) {
    const auto angles = opening_angles(pi, way.to_rad, way.frames);
    if (!angles) return tl::unexpected(angles.error());
    auto opened = judge::open_flat_sheet(fold, *angles);
    if (opened) {
      if (!why.empty()) warnings.push_back({.code = "opens_partly", .message = why});
      return opened;
    }
    if (why.empty()) why = message(opened.error());
  }
  warnings.push_back({.code = "does_not_open", .message = why});
  const std::vector<double> flat{pi};
  return judge::open_flat_sheet(fold, flat);
}

Result<std::string> opened_blob(const Foreign& foreign, LatticeBlobOptions& how) {
  const auto file = read_fold(foreign.fold);
  const auto known =
      file ? pattern_from_fold(*file) : Result<Pattern>(tl::unexpected(file.error()));
  if (known) return lattice_blob(*known, how);
  auto opened = open_as_far(foreign.fold, how.warnings);
  if (!opened) return tl::unexpected(opened.error());
  if (file && file->design_psi_rad.value_or(0) > 0)
    opened->pattern.design_psi_rad = *file->design_psi_rad;
  if (!opened->motion) return lattice_blob(opened->pattern, how);
  const bool moves = opened->motion->psi_rad.size() > 1;
  return lattice_blob(
      opened->pattern,
      moves ? LatticeFrames{opened->motion->psi_rad, opened->motion->places} : LatticeFrames{},
      how);
}

}  // namespace

Result<std::string> foreign_blob(std::string text, InputKind kind, const SvgReadOptions& how_read) {
  const auto foreign = read_foreign(std::move(text), kind, how_read);
  if (!foreign) return tl::unexpected(foreign.error());
  LatticeBlobOptions how;
  how.quality = LatticeQuality::Stored;
  how.kind = name_of(kind);
  how.error = false;
  how.warnings = foreign->warnings;
  judge(foreign->fold, how);
  if (auto blob = opened_blob(*foreign, how)) return blob;
  return lattice_blob(lines_alone(foreign->lines), LatticeFrames{}, how);
}

Result<ForeignDrawing> foreign_drawing(std::string text, InputKind kind) {
  const auto how = read_options({}, {});
  if (!how) return tl::unexpected(how.error());
  auto foreign = read_foreign(std::move(text), kind, *how);
  if (!foreign) return tl::unexpected(foreign.error());
  ForeignDrawing drawing{std::move(foreign->lines), std::nullopt};
  if (const auto file = read_fold(foreign->fold))
    if (auto known = pattern_from_fold(*file)) drawing.pattern = std::move(*known);
  if (drawing.pattern) return drawing;
  const std::vector<double> angles{std::numbers::pi, std::numbers::pi / 2};
  if (auto opened = judge::open_flat_sheet(foreign->fold, angles); opened && !opened->motion)
    drawing.pattern = std::move(opened->pattern);
  return drawing;
}

}  // namespace popcut::planning
