// SPDX-License-Identifier: MIT
#include "core/verify/target/target.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"

namespace popcut::verify {
namespace {

/// The pose nearest to the angle that the target stands at.
const Pose* pose_to_measure(const FoldModel& file, double angle_deg) {
  const double angle_rad = psi_rad_of(angle_deg);
  const auto off = [&](const Pose& pose) { return std::abs(*pose.psi_rad - angle_rad); };
  const Pose* best = nullptr;
  for (const Pose& pose : file.poses) {
    if (!pose.psi_rad || !(std::sin(*pose.psi_rad) > 0.1)) continue;
    if (best == nullptr || off(pose) < off(*best)) best = &pose;
  }
  return best;
}

void add(TargetDistance& to, double distance_mm) {
  ++to.vertices;
  to.rms_mm += distance_mm * distance_mm;  // sum of squares until `closed`
  to.max_mm = std::max(to.max_mm, distance_mm);
}

TargetDistance closed(TargetDistance sum) {
  if (sum.vertices > 0) sum.rms_mm = std::sqrt(sum.rms_mm / static_cast<double>(sum.vertices));
  return sum;
}

using Folds = std::vector<std::vector<FoldVertex>>;

/// The valley folds of each strip as (X, Z), each place once. Only folds along the spine: V-folds
/// run across, and split the crease that they are on.
Folds valleys_in(const FoldModel& file, const Pose& pose,
                 const std::vector<TargetStation>& stations) {
  Folds found(stations.size());
  double reach = 0.0;
  for (const Vec2& p : file.flat) reach = std::max({reach, std::abs(p.x()), std::abs(p.y())});
  const double same = 1e-9 * reach;
  for (std::size_t e = 0; e < file.edges.size(); ++e) {
    if (file.assignment[e] != Assignment::Valley) continue;
    const auto [a, b] = file.edges[e];
    if (std::abs(file.flat[a].x() - file.flat[b].x()) > same) continue;
    const double from = std::min(file.flat[a].y(), file.flat[b].y()) + same;
    const double to = std::max(file.flat[a].y(), file.flat[b].y()) - same;
    auto at = std::lower_bound(stations.begin(), stations.end(), from,
                               [](const TargetStation& s, double v) { return s.end_mm <= v; });
    for (; at != stations.end() && at->begin_mm < to; ++at)
      found[static_cast<std::size_t>(at - stations.begin())].push_back(
          unposed(0.5 * (pose.at[a] + pose.at[b]), *pose.psi_rad));
  }
  const double near = 1e-7 * reach;
  for (std::vector<FoldVertex>& folds : found) {
    std::sort(folds.begin(), folds.end(), [](const FoldVertex& p, const FoldVertex& q) {
      return p.x - p.z < q.x - q.z;  // increases along a falling strip
    });
    const auto last = std::unique(folds.begin(), folds.end(), [&](const auto& p, const auto& q) {
      return std::hypot(p.x - q.x, p.z - q.z) <= near;
    });
    folds.erase(last, folds.end());
  }
  return found;
}

/// The outermost fold on the wall and on the ground at one station; negative: none.
CurveEnds outermost(const std::vector<FoldVertex>& folds, double on_card) {
  CurveEnds ends{-1.0, -1.0};
  for (const FoldVertex& p : folds) {
    if (std::abs(p.x) <= on_card && p.z > on_card) ends.wall = std::max(ends.wall, p.z);
    if (std::abs(p.z) <= on_card && p.x > on_card) ends.ground = std::max(ends.ground, p.x);
  }
  return ends;
}

/// How far a connector's end is from the target's end on the slice that it came from: the
/// neighbouring slice that ends at the same place.
double end_error(double end, double left, double right, double left_target, double right_target,
                 double same) {
  const double from_left = std::abs(end - left_target);
  const double from_right = std::abs(end - right_target);
  const bool at_left = std::abs(end - left) <= same;
  const bool at_right = std::abs(end - right) <= same;
  if (at_left != at_right) return at_left ? from_left : from_right;
  return std::min(from_left, from_right);
}

/// Collects distances station by station.
class Measurement {
 public:
  Measurement(const TargetSurface& surface, const TargetWall& wall, const Pose& pose,
              VerifyCheck& check)
      : surface_(surface), wall_(wall), check_(check) {
    double reach = 0.0;
    for (const Vec3& p : pose.at) reach = std::max({reach, std::abs(p.x()), std::abs(p.z())});
    on_card_ = 1e-9 * reach;
  }

  void inner_folds(const std::vector<FoldVertex>& folds, const TargetStation& at) {
    for (const FoldVertex& p : folds) {
      if (std::abs(p.x) <= on_card_ || std::abs(p.z) <= on_card_) continue;
      const double off = distance_mm(at.s_mm, p);
      if (!is_distance(off) && ends_near(at, p)) {
        ++beyond;
        continue;
      }
      if (!take(off, at.s_mm)) return;
      add(inner, off);
    }
  }

  /// The ends of a connector against the target's ends on the two slices beside it.
  void ends(const std::vector<FoldVertex>& folds,
            std::array<const std::vector<FoldVertex>*, 2> beside, std::array<double, 2> s_mm) {
    const CurveEnds here = outermost(folds, on_card_);
    const CurveEnds left = outermost(*beside[0], on_card_);
    const CurveEnds right = outermost(*beside[1], on_card_);
    const CurveEnds a = surface_.ends_mm(s_mm[0]);
    const CurveEnds b = surface_.ends_mm(s_mm[1]);
    if (here.wall > 0.0 && a.wall > 0.0 && b.wall > 0.0)
      (void)take(end_error(here.wall, left.wall, right.wall, a.wall, b.wall, on_card_), s_mm[0]);
    if (here.ground > 0.0 && a.ground > 0.0 && b.ground > 0.0)
      (void)take(end_error(here.ground, left.ground, right.ground, a.ground, b.ground, on_card_),
                 s_mm[0]);
  }

  TargetDistance inner, all;  ///< sums of squares until `closed`
  std::size_t beyond{};       ///< vertices in a plane that the target ends before

 private:
  static bool is_distance(double off) { return off >= 0.0 && std::isfinite(off); }

  /// From where the fold stands when the card is open to the target's angle.
  [[nodiscard]] double distance_mm(double s_mm, const FoldVertex& p) const {
    return surface_.distance_mm(s_mm, p.x + p.z * wall_.cosine, p.z * wall_.sine);
  }

  /// Whether the target ends at a strip: it has a curve within the strip's reach to one side.
  [[nodiscard]] bool ends_near(const TargetStation& at, const FoldVertex& p) const {
    constexpr int kPlaces = 32;
    for (int k = 1; k <= kPlaces; ++k)
      for (const double side : {-1.0, 1.0}) {
        const double s = at.s_mm + side * at.reach_mm * k / kPlaces;
        if (is_distance(distance_mm(s, p))) return true;
      }
    return false;
  }

  bool take(double off, double s_mm) {
    if (!is_distance(off)) {
      check_.fail("", fmt::format("the target has no curve at s = {:.6g} mm", s_mm));
      return false;
    }
    add(all, off);
    return true;
  }

  const TargetSurface& surface_;
  const TargetWall& wall_;
  VerifyCheck& check_;
  double on_card_{};
};

/// Measures the fold vertices at the stations of a run of patches.
TargetDistances measure_stations(const FoldModel& file, const Pose& pose, const Target& target,
                                 const TargetStations& stations, VerifyCheck& check) {
  std::vector<TargetStation> connectors;
  for (const auto& connector : stations.connectors) connectors.push_back(connector.at);
  Measurement measured(*target.surface, target.wall, pose, check);
  const Folds on_slices = valleys_in(file, pose, stations.slices);
  const Folds on_connectors = valleys_in(file, pose, connectors);
  for (std::size_t k = 0; k < connectors.size(); ++k) {
    const auto& [at, left, right] = stations.connectors[k];
    measured.inner_folds(on_connectors[k], at);
    measured.ends(on_connectors[k], {&on_slices[left], &on_slices[right]},
                  {stations.slices[left].s_mm, stations.slices[right].s_mm});
  }
  const TargetDistance inner = closed(measured.inner);
  const TargetDistance all = closed(measured.all);
  const auto has_folds = [](const std::vector<FoldVertex>& folds) { return !folds.empty(); };
  const bool any = std::any_of(on_slices.begin(), on_slices.end(), has_folds) ||
                   std::any_of(on_connectors.begin(), on_connectors.end(), has_folds);
  if (!any)
    check.fail(
        "",
        "no fold of the pattern lies on a slice or connector of the spec; is it the spec of this "
        "pattern?");
  check.detail = fmt::format(
      "{} inner fold vertices: rms {:.3g} mm, max {:.3g} mm; {} with the ends: rms {:.3g} mm, "
      "max {:.3g} mm",
      inner.vertices, inner.rms_mm, inner.max_mm, all.vertices, all.rms_mm, all.max_mm);
  if (target.angle_deg != 90.0)
    check.detail += fmt::format("; open to {:g} degrees", target.angle_deg);
  if (measured.beyond > 0)
    check.detail += fmt::format("; {} beyond the end of the target", measured.beyond);
  if (any && all.vertices == 0) check.not_judged("the target has no curve where the folds are");
  if (target.patches.size() > 1)
    check.detail +=
        stations.first_patch == stations.last_patch
            ? fmt::format("; of patch {}", stations.first_patch)
            : fmt::format("; of patches {} to {}", stations.first_patch, stations.last_patch);
  return {inner, all};
}

}  // namespace

FoldVertex unposed(Vec3 p, double psi_rad) {
  const double z = p.z() / std::sin(psi_rad);
  return {p.x() - z * std::cos(psi_rad), z};
}

std::optional<TargetDistances> measure_target(const FoldModel& file, const Target& target,
                                              VerifyCheck& check) {
  const Pose* pose = pose_to_measure(file, target.angle_deg);
  if (pose == nullptr) {
    check.fail(
        "/file_frames",
        "no frame states its opening angle; add frame_popcut:psi_rad to measure the distance "
        "from the target");
    return std::nullopt;
  }
  const auto found = find_stations(file, *pose, target);
  if (!found) {
    if (found.error().kind == ErrorKind::Infeasible)
      check.not_judged(found.error().detail);
    else
      check.fail("", found.error().detail);
    return std::nullopt;
  }
  VerifyCheck best_check = check;
  std::optional<TargetDistances> best;
  for (const TargetStations& stations : *found) {
    VerifyCheck here = check;
    const TargetDistances distances = measure_stations(file, *pose, target, stations, here);
    const bool better =
        !best || here.failed < best_check.failed ||
        (here.failed == best_check.failed && distances.all.rms_mm < best->all.rms_mm);
    if (better) best = distances, best_check = std::move(here);
  }
  check = std::move(best_check);
  return best;
}

void place_slices(std::vector<TargetSlice>& slices) {
  for (std::size_t j = 1; j < slices.size(); ++j)
    slices[j].s_mm = slices[j - 1].s_mm + 0.5 * (slices[j - 1].width_mm + slices[j].width_mm);
}

std::span<const TargetSlice> Target::slices_of(std::size_t first, std::size_t last) const {
  const std::size_t begin = patches[first].first_slice;
  const std::size_t end = last + 1 < patches.size() ? patches[last + 1].first_slice : slices.size();
  return std::span(slices).subspan(begin, end - begin);
}

}  // namespace popcut::verify
