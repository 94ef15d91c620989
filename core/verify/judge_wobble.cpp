// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/SparseCholesky>

#include "core/geometry/angle.hpp"
#include "core/verify/judge.hpp"

namespace popcut::verify {
namespace {

constexpr double kLine_mm = 0.1, kEnd_mm = 0.15, kWholeFold_mm = 4.0, kFirm_mm = 1.05;
constexpr std::size_t kMostPanels = 2000;
constexpr double kHeld = 1e-8;  ///< beside the equations: panels that nothing holds stay finite

/// The pose nearest to a right angle, the wall square to the ground.
std::optional<std::size_t> square_pose(const Subject& subject) {
  std::optional<std::size_t> best;
  double least = 0.3;
  for (std::size_t k = 0; k < subject.motions.size(); ++k) {
    const auto psi = subject.file.poses[k].psi_rad;
    if (!psi || !subject.motions[k].bent || !(std::abs(*psi - kPi / 2) < least)) continue;
    least = std::abs(*psi - kPi / 2), best = k;
  }
  return best;
}

/// The direction of all folds on the flat sheet; none if they have several.
std::optional<Vec2> fold_direction(const Subject& subject) {
  Vec2 along = Vec2::Zero();
  const auto way_of = [&](const Hinge& hinge) {
    return Vec2(subject.file.flat[hinge.to] - subject.file.flat[hinge.from]);
  };
  for (const Hinge& hinge : subject.sheet.hinges)
    if (way_of(hinge).norm() > along.norm()) along = way_of(hinge);
  if (!(along.norm() > 0)) return std::nullopt;
  along.normalize();
  for (const Hinge& hinge : subject.sheet.hinges) {
    const Vec2 way = way_of(hinge);
    if (std::abs(along.x() * way.y() - along.y() * way.x()) > 2 * subject.limits.slack_mm)
      return std::nullopt;
  }
  return along;
}

/// Panels as stiff plates in the plane across their folds, on springs at the folds: how far each
/// plate shifts and turns if the springs' rest places are off at random.
class Plates {
 public:
  Plates(const Subject& subject, const Pose& pose, Vec2 axis)
      : subject_(subject), pose_(pose), across_{-axis.y(), axis.x()} {}

  PaperWobble measure() {
    find_plane();
    find_plates();
    PaperWobble out;
    if (plates_ == 0) return out;
    add_springs();
    using Sparse = Eigen::SparseMatrix<double>;
    const Eigen::Index n = Eigen::Index{3} * plates_;
    Sparse stiffness(n, n);
    stiffness.setFromTriplets(terms_.begin(), terms_.end());
    const Eigen::SimplicialLDLT<Sparse> solver(stiffness);
    if (solver.info() != Eigen::Success) return out;
    double area_mm2 = 0;
    for (std::size_t p = 0; p < plate_.size(); ++p) {
      if (plate_[p] < 0) continue;
      Eigen::Matrix3d spread;  // of shift and turn
      for (int c = 0; c < 3; ++c) {
        const Eigen::Index first = Eigen::Index{3} * plate_[p];
        Eigen::VectorXd load = Eigen::VectorXd::Zero(n);
        load[first + c] = 1;
        spread.col(c) = solver.solve(load).segment<3>(first);
      }
      const double moves_mm = std::sqrt(farthest_mm2(p, spread));
      out.largest_mm = std::max(out.largest_mm, moves_mm);
      out.mean_mm += moves_mm * area_mm2_[p];
      area_mm2 += area_mm2_[p];
      if (moves_mm > kFirm_mm) out.loose.push_back({static_cast<std::uint32_t>(p), moves_mm});
    }
    if (area_mm2 > 0) out.mean_mm /= area_mm2;
    std::ranges::sort(out.loose, std::greater<>(), &LoosePanelFigure::moves_mm);
    return out;
  }

 private:
  /// Two directions square to the folds in space.
  void find_plane() {
    Vec3 along = Vec3::Zero();
    for (const Hinge& hinge : subject_.sheet.hinges) {
      Vec3 way = pose_.at[hinge.to] - pose_.at[hinge.from];
      if (way.dot(along) < 0) way = -way;
      along += way;
    }
    along.normalize();
    first_ = along.unitOrthogonal(), second_ = along.cross(first_);
  }

  [[nodiscard]] Vec2 seen(std::uint32_t vertex) const {
    return {pose_.at[vertex].dot(first_), pose_.at[vertex].dot(second_)};
  }

  /// All panels but those at the two ends of the sheet across its folds.
  void find_plates() {
    const std::size_t panels = subject_.sheet.panels;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::uint32_t v : subject_.file.face_vertices) {
      const double t = subject_.file.flat[v].dot(across_);
      low = std::min(low, t), high = std::max(high, t);
    }
    const double slack = subject_.limits.slack_mm;
    std::vector<bool> is_end(panels, false);
    std::vector<double> corners(panels, 0);
    middle_.assign(panels, Vec2::Zero()), area_mm2_.assign(panels, 0);
    for (std::size_t f = 0; f < subject_.file.faces(); ++f) {
      const std::uint32_t p = subject_.sheet.panel_of_face[f];
      area_mm2_[p] += std::abs(area(subject_.file, f));
      for (const std::uint32_t v : face_of(subject_.file, f)) {
        const double t = subject_.file.flat[v].dot(across_);
        if (t < low + slack || t > high - slack) is_end[p] = true;
        middle_[p] += seen(v), ++corners[p];
      }
    }
    plate_.assign(panels, -1);
    for (std::size_t p = 0; p < panels; ++p) {
      if (corners[p] > 0) middle_[p] /= corners[p];
      if (!is_end[p]) plate_[p] = plates_++;
    }
  }

  void add_springs() {
    const double off_mm2 = kLine_mm * kLine_mm + kEnd_mm * kEnd_mm / 2;
    for (const Hinge& hinge : subject_.sheet.hinges) {
      const std::array panels{subject_.sheet.panel_of_face[hinge.left],
                              subject_.sheet.panel_of_face[hinge.right]};
      if (panels[0] == panels[1]) continue;
      const double length_mm = (pose_.at[hinge.to] - pose_.at[hinge.from]).norm();
      const double stiff = std::min(1.0, length_mm / kWholeFold_mm) / off_mm2;
      const Vec2 place = seen(hinge.from);
      Eigen::Matrix<double, 2, 6> gap;  // between the two plates, of both their movements
      for (Eigen::Index side = 0; side < 2; ++side) {
        const Vec2 arm = place - middle_[panels[static_cast<std::size_t>(side)]];
        const double sign = side == 0 ? 1 : -1;
        gap.block<2, 3>(0, 3 * side) << sign, 0, -sign * arm.y(), 0, sign, sign * arm.x();
      }
      const Eigen::Matrix<double, 6, 6> block = stiff * gap.transpose() * gap;
      for (int r = 0; r < 6; ++r)
        for (int c = 0; c < 6; ++c) {
          const int at = plate_[panels[static_cast<std::size_t>(r / 3)]],
                    to = plate_[panels[static_cast<std::size_t>(c / 3)]];
          if (at >= 0 && to >= 0) terms_.emplace_back(3 * at + r % 3, 3 * to + c % 3, block(r, c));
        }
    }
    for (int k = 0; k < 3 * plates_; ++k) terms_.emplace_back(k, k, kHeld / off_mm2);
  }

  [[nodiscard]] double farthest_mm2(std::size_t panel, const Eigen::Matrix3d& spread) const {
    double most = 0;
    for (const std::uint32_t v : subject_.panels.vertices[panel]) {
      const Vec2 arm = seen(v) - middle_[panel];
      Eigen::Matrix<double, 2, 3> moves;
      moves << 1, 0, -arm.y(), 0, 1, arm.x();
      most = std::max(most, (moves * spread * moves.transpose()).trace());
    }
    return most;
  }

  const Subject& subject_;
  const Pose& pose_;
  Vec2 across_;
  Vec3 first_, second_;
  std::vector<Vec2> middle_;  ///< of each panel, across the folds
  std::vector<double> area_mm2_;
  std::vector<int> plate_;  ///< of each panel; -1: it is held
  int plates_{0};
  std::vector<Eigen::Triplet<double>> terms_;
};

Vec2 middle_of_panel(const Subject& subject, std::uint32_t panel) {
  Vec2 sum = Vec2::Zero();
  double count = 0;
  for (const std::uint32_t v : subject.panels.vertices[panel]) sum += subject.file.flat[v], ++count;
  return count > 0 ? Vec2(sum / count) : sum;
}

}  // namespace

void measure_wobble(const Subject& subject, VerifyReport& report) {
  if (subject.quick || subject.sheet.panels > kMostPanels) return;
  const auto axis = fold_direction(subject);
  const auto pose = square_pose(subject);
  if (!axis || !pose) return;
  PaperWobble found = Plates(subject, subject.file.poses[*pose], *axis).measure();
  if (!found.loose.empty()) {
    constexpr std::size_t kNamed = 3;
    std::string worst;
    for (std::size_t k = 0; k < std::min(kNamed, found.loose.size()); ++k)
      worst += fmt::format(
          "{}{}: {:.1f} mm", k == 0 ? "" : "; ",
          near_place(subject, "the panel", middle_of_panel(subject, found.loose[k].panel)),
          found.loose[k].moves_mm);
    report.notes.push_back(fmt::format(
        "{} panel{} move{} by more than 1 mm in paper, when folds lie {:g} mm off their lines: "
        "{}{}",
        found.loose.size(), found.loose.size() == 1 ? "" : "s", found.loose.size() == 1 ? "s" : "",
        kLine_mm, worst, found.loose.size() > kNamed ? "; ..." : ""));
  }
  report.wobble = std::move(found);
}

}  // namespace popcut::verify
