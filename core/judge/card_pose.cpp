// SPDX-License-Identifier: MIT
#include "core/judge/card_pose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/deploy/loaded_pattern.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/geometry/angle.hpp"
#include "core/geometry/triangulate.hpp"
#include "core/judge/pattern_model.hpp"
#include "core/judge/sheet_motion.hpp"
#include "core/verify/judge.hpp"
#include "core/verify/motion/motion.hpp"
#include "core/verify/motion/opening.hpp"
#include "core/verify/sheet/hinge_lines.hpp"
#include "core/verify/sheet/sheet.hpp"

namespace popcut::judge {
namespace {

using verify::FoldModel;
using verify::Pose;
using verify::Sheet;

constexpr const char* kListedByVerify = "'popcut verify' lists the places";
constexpr double kSameAngleRad = 1e-6;

/// The model with one pose left.
FoldModel with_pose(FoldModel model, Pose pose) {
  model.poses.clear();
  model.poses.push_back(std::move(pose));
  return model;
}

/// The sheet of a file that has faces.
Result<Sheet> sheet_of(const FoldModel& model) {
  VerifyCheck faces = verify::named("faces");
  Sheet sheet = verify::make_sheet(model, faces);
  if (!faces.ok())
    return fail(ErrorKind::OutOfRange, faces.failures.front().place,
                fmt::format("{}; {}", faces.failures.front().detail, kListedByVerify));
  return sheet;
}

/// Whether a pose is bent, and rigid as panels of paper are.
Result<bool> is_bent(const FoldModel& model, const Sheet& sheet, const Pose& pose) {
  const auto motion = verify::measure(model, sheet, verify::make_panels(model, sheet), pose);
  const double limit_mm = verify::limits_of(model).isometry_mm;
  const double off = std::max(motion.isometry_mm, motion.hinge_gap_mm);
  if (!(off <= limit_mm))
    return fail(ErrorKind::OutOfRange, pose.place + "/vertices_coords",
                fmt::format("the pose stretches the sheet by {:.2g} mm; {}", off, kListedByVerify));
  return motion.bent && !motion.shut;
}

/// The frame that shows the card as it is to be compared; none: it has to be opened.
Result<std::optional<Pose>> chosen_pose(const FoldModel& model, std::optional<double> psi_rad) {
  if (!model.faces_given || model.faces() == 0 || model.poses.empty()) return std::nullopt;
  const auto sheet = sheet_of(model);
  if (!sheet) return tl::unexpected(sheet.error());
  const double wanted = psi_rad.value_or(model.design_psi_rad.value_or(std::numbers::pi / 2));
  for (const Pose& pose : model.poses) {
    if (!pose.psi_rad || std::abs(*pose.psi_rad - wanted) > kSameAngleRad) continue;
    const auto sound = is_bent(model, *sheet, pose);
    if (!sound) return tl::unexpected(sound.error());
    return pose;
  }
  if (psi_rad || model.from_popcut) return std::nullopt;
  for (const Pose& pose : model.poses) {
    const auto bent = is_bent(model, *sheet, pose);
    if (!bent) return tl::unexpected(bent.error());
    if (*bent) return pose;
  }
  return std::nullopt;
}

/// Opens a pattern that has no frame at `psi_rad`.
Result<FoldModel> opened_model(std::string_view text, double psi_rad, const Progress& progress) {
  const std::array angles{psi_rad};
  if (const auto file = read_fold(text))
    if (const auto pattern = pattern_from_fold(*file)) return pattern_model(*pattern, angles);
  const auto opened = open_flat_sheet(text, angles, progress);
  if (!opened) return tl::unexpected(opened.error());
  auto model = pattern_model(opened->pattern, opened->motion ? std::span<const double>() : angles);
  if (!model || !opened->motion) return model;
  Pose pose;
  pose.at = opened->motion->places.front();
  pose.psi_rad = psi_rad;
  return with_pose(std::move(*model), std::move(pose));
}

/// Carries a pose of its own axes to where a card stands: spine along v, ground in z = 0.
void stand_up(FoldModel& model, const Sheet& sheet) {
  const auto hinge_at = verify::driving_hinge(model, sheet);
  if (!hinge_at) return;
  const verify::Hinge& hinge = sheet.hinges[*hinge_at];
  Pose& pose = model.poses.front();
  const auto motion = verify::measure(model, sheet, verify::make_panels(model, sheet), pose);
  const double angle_deg = motion.hinge_angle_deg[*hinge_at];
  // Seen from the side to which the fold opens, the ground is at the right of the spine.
  const double side = angle_deg < 0 ? -1.0 : 1.0;
  const Vec3 from = pose.at[hinge.from];
  const Vec3 along = side * unit(Vec3(pose.at[hinge.to] - from));
  const Vec3 up = side * motion.panel[sheet.panel_of_face[hinge.right]].normal;
  const Vec3 out = cross(along, up);
  double least = std::numeric_limits<double>::infinity();
  for (Vec3& p : pose.at) {
    const Vec3 off = p - from;
    p = Vec3(dot(off, out), dot(off, along), dot(off, up));
    least = std::min(least, p.y());
  }
  for (Vec3& p : pose.at) p.y() -= least;
  pose.psi_rad = std::numbers::pi - std::abs(angle_deg) / kDegrees;
}

Result<void> add_triangles(CardPose& card) {
  std::vector<Triangle> triangles;
  for (std::size_t f = 0; f < card.file.faces(); ++f) {
    const auto face = verify::face_of(card.file, f);
    std::vector<std::uint32_t> round(face.begin(), face.end());
    if (twice_area(card.file.flat, round) < 0) std::reverse(round.begin(), round.end());
    if (!triangulate(card.file.flat, round, triangles))
      return fail(ErrorKind::OutOfRange, face_place(f),
                  fmt::format("is not a simple polygon; {}", kListedByVerify));
  }
  const std::vector<Vec3>& at = card.file.poses.front().at;
  card.triangles.reserve(9 * triangles.size());
  for (const Triangle& triangle : triangles)
    for (const std::uint32_t corner : triangle)
      for (const double value : at[corner]) card.triangles.push_back(static_cast<float>(value));
  return {};
}

void add_joints(const FoldModel& file, const Sheet& sheet, CardPose& card) {
  card.folds = verify::hinge_lines(file, sheet).size();
  card.pieces = sheet.pieces;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> joints;
  for (const verify::Hinge& hinge : sheet.hinges) {
    const auto [a, b] =
        std::minmax(sheet.panel_of_face[hinge.left], sheet.panel_of_face[hinge.right]);
    if (a != b) joints[{a, b}] += norm(Vec2(file.flat[hinge.to] - file.flat[hinge.from]));
  }
  for (const auto& [panels, length] : joints)
    if (card.smallest_joint_mm == 0.0 || length < card.smallest_joint_mm)
      card.smallest_joint_mm = length;
}

}  // namespace

Result<CardPose> open_card(std::string_view fold_text, std::optional<double> psi_rad,
                           const Progress& progress) {
  auto model = verify::read_fold_model(fold_text);
  if (!model) return tl::unexpected(std::move(model.error()));
  CardPose card;
  card.notes = model->notes;
  const double design_rad = model->design_psi_rad.value_or(std::numbers::pi / 2);
  const auto placement = model->model_placement;
  const bool has_angles = model->from_popcut;
  auto pose = chosen_pose(*model, psi_rad);
  if (!pose) return tl::unexpected(std::move(pose.error()));
  const bool as_it_stands = pose->has_value();
  if (as_it_stands) {
    card.file = with_pose(std::move(*model), std::move(**pose));
  } else {
    if (model->faces_given && model->faces() > 0)
      if (const auto own = sheet_of(*model)) add_joints(*model, *own, card);
    auto opened = opened_model(fold_text, psi_rad.value_or(design_rad), progress);
    if (!opened) return tl::unexpected(std::move(opened.error()));
    card.file = std::move(*opened);
    card.notes.push_back(fmt::format("opened to {:.1f} degrees: the file has no such pose",
                                     degrees(psi_rad.value_or(design_rad))));
  }
  VerifyCheck known;  // what is wrong with the file's own faces was said when its pose was chosen
  const Sheet sheet = verify::make_sheet(card.file, known);
  if (as_it_stands && !has_angles) stand_up(card.file, sheet);
  card.psi_rad = card.file.poses.front().psi_rad.value_or(std::numbers::pi / 2);
  card.corner.opening_rad = card.psi_rad;
  if (placement && std::abs(card.psi_rad - design_rad) <= kSameAngleRad)
    card.model = {
        (*placement)[0],
        likeness::ModelPlacement::turn_of({(*placement)[1], (*placement)[2], (*placement)[3]}),
        Vec3((*placement)[4], (*placement)[5], (*placement)[6])};
  if (auto done = add_triangles(card); !done) return tl::unexpected(done.error());
  if (card.folds == 0) add_joints(card.file, sheet, card);
  return card;
}

}  // namespace popcut::judge
