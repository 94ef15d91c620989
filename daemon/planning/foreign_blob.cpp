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
#include "core/text/fold_text.hpp"
#include "core/verify/parts/parts.hpp"
#include "core/verify/verify.hpp"
#include "daemon/planning/plan_input.hpp"
#include "daemon/planning/plan_job.hpp"
#include "daemon/planning/views/parts_card.hpp"

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

/// Only the lines, on a page (x = v, y = u); those neither cut nor folded go into `others`.
Pattern lines_alone(const LineWork& work, std::vector<SheetLine>& others) {
  Pattern pattern;
  pattern.name = work.name;
  pattern.card = false;
  for (const DrawnLine& line : work.lines) {
    const bool is_other = line.operation == Operation::Score || line.operation == Operation::Draw;
    const auto points = work.points_of(line);
    for (std::size_t i = 1; i < points.size(); ++i)
      (is_other ? others : pattern.lines)
          .push_back({points[i - 1].y, points[i - 1].x, points[i].y, points[i].x,
                      role_of(line.operation)});
  }
  return pattern;
}

std::size_t folds_of(const LineWork& lines) {
  return static_cast<std::size_t>(
      std::count_if(lines.lines.begin(), lines.lines.end(),
                    [](const DrawnLine& line) { return is_fold(line.operation); }));
}

/// An error for who looks at a picture: without the place in a file that nobody wrote, and without
/// options of a command.
std::string plain_words(const Error& error) {
  std::string text = error.detail.substr(0, error.detail.find("; give --"));
  if (const std::size_t at = text.find("psi = "); at != std::string::npos) text.erase(at, 6);
  return text.substr(0, text.find("; 'popcut "));
}

/// What the verifier says of it goes into `how`.
void judge(const Foreign& foreign, LatticeBlobOptions& how) {
  constexpr std::size_t kFewFolds = 300;  // freedoms of more take long to count
  VerifyOptions options;
  options.quick = true;
  if (folds_of(foreign.lines) <= kFewFolds) options.degrees_of_freedom = 1;
  const auto report = verify_fold(foreign.fold, options);
  if (!report) return how.not_judged.push_back(plain_words(report.error()));
  const std::size_t ways = report->degrees_of_freedom.value_or(1);
  for (const VerifyCheck& check : report->checks) {
    // A net is folded up by hand: the one way in which the solver opens it says nothing.
    if (ways > 1 && (check.name == "opening" || check.name == "crossing")) continue;
    if (!check.ran) {
      how.not_judged.push_back(fmt::format("{}: {}", check.name, check.detail));
      continue;
    }
    how.judged.push_back(check.name);
    if (check.ok() || check.failures.empty()) continue;
    if (check.name == "degrees_of_freedom" && ways > 1) {
      how.warnings.push_back(
          {.code = "many_ways",
           .message = fmt::format("{}: moves in {} ways, as the net of a box does; a card opens "
                                  "in one movement",
                                  check.name, ways)});
      continue;
    }
    const VerifyFailure& first = check.failures.front();
    how.warnings.push_back(
        {.code = "unsound",
         .message = fmt::format("{}: {}{}", check.name, first.detail,
                                first.place.empty() ? "" : fmt::format(" ({})", first.place))});
  }
}

/// Opens the flat sheet as far as it goes.
Result<judge::SheetMotion> open_as_far(const std::string& fold, std::vector<Warning>& warnings) {
  const bool is_said = std::any_of(warnings.begin(), warnings.end(), [](const Warning& one) {
    return one.code == "unsound" || one.code == "many_ways";
  });
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
      if (!why.empty() && !is_said) warnings.push_back({.code = "opens_partly", .message = why});
      return opened;
    }
    if (why.empty()) why = plain_words(opened.error());
  }
  if (!is_said) warnings.push_back({.code = "does_not_open", .message = why});
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

/// A card of several parts: what verify says of it, and its motion.
Result<std::string> joined_blob(const std::string& fold, LatticeBlobOptions how) {
  const auto report = verify_parts(fold);
  if (!report) return tl::unexpected(report.error());
  const auto take = [&](const std::vector<VerifyCheck>& checks, const std::string& of) {
    for (const VerifyCheck& check : checks) {
      if (std::find(how.judged.begin(), how.judged.end(), check.name) == how.judged.end())
        how.judged.push_back(check.name);
      if (!check.ok() && !check.failures.empty())
        how.warnings.push_back(
            {.code = "unsound",
             .message = fmt::format("{}: {}{}", check.name, of, check.failures.front().detail)});
    }
  };
  take(report->checks, "");
  for (std::size_t p = 0; p < report->parts.size(); ++p)
    take(report->parts[p].checks, report->names[p] + ": ");
  return parts_blob(fold, std::move(how));
}

}  // namespace

Result<std::string> foreign_blob(std::string text, InputKind kind, const SvgReadOptions& how_read) {
  const std::string joined = kind == InputKind::Fold && lists_joints(text) ? text : std::string();
  const auto foreign = read_foreign(std::move(text), kind, how_read);
  if (!foreign) return tl::unexpected(foreign.error());
  LatticeBlobOptions how;
  how.quality = LatticeQuality::Stored;
  how.kind = name_of(kind);
  how.error = false;
  how.warnings = foreign->warnings;
  if (!joined.empty())
    if (auto blob = joined_blob(joined, how)) return blob;
  // Without a fold nothing opens, and there is no movement to judge.
  const bool has_folds = kind == InputKind::Fold || folds_of(foreign->lines) > 0;
  if (has_folds) {
    judge(*foreign, how);
    if (auto blob = opened_blob(*foreign, how)) return blob;
  }
  const Pattern lines = lines_alone(foreign->lines, how.others);
  return lattice_blob(lines, LatticeFrames{}, how);
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
