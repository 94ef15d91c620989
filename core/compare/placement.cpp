// SPDX-License-Identifier: MIT
#include "core/compare/placement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "core/compare/comparison.hpp"
#include "core/geometry/angle.hpp"

namespace popcut::likeness {
namespace {

constexpr int kPixels = 72;
constexpr double kFar = 0.08;  ///< of the diagonal: depths that differ by more do not agree at all

/// What a pixel counts that only the structure covers. Cards fill what lies behind and below the
/// model, so it is less than that of a pixel which only the model covers.
constexpr double kOnlyCard = 0.75;

/// Fewer triangles of about the same shape: corners are moved to the cells of a grid.
std::vector<float> coarse(Triangles triangles, double cell_mm) {
  std::vector<float> out;
  const auto on_grid = [&](float value) {
    return static_cast<float>(std::round(static_cast<double>(value) / cell_mm) * cell_mm);
  };
  for (std::size_t k = 0; k + 8 < triangles.size(); k += 9) {
    std::array<float, 9> p{};
    for (std::size_t i = 0; i < 9; ++i) p[i] = on_grid(triangles[k + i]);
    const auto same = [&](std::size_t a, std::size_t b) {
      return p[a] == p[b] && p[a + 1] == p[b + 1] && p[a + 2] == p[b + 2];
    };
    if (same(0, 3) || same(3, 6) || same(6, 0)) continue;
    out.insert(out.end(), p.begin(), p.end());
  }
  return out;
}

/// How much a placed model looks like a structure.
class Resemblance {
 public:
  Resemblance(Triangles structure, const std::optional<Corner>& corner)
      : target_(structure, {few_views(corner), kPixels, corner}),
        diagonal_mm_(target_.box().diagonal()) {}

  [[nodiscard]] bool is_blind() const { return target_.is_unseen(); }

  /// Mean over the pixels that show either: the depth difference as a share of `kFar`, at most 1;
  /// `kOnlyCard` where only the structure is.
  [[nodiscard]] double misfit(Triangles model, const ModelPlacement& placement) {
    moved_ = placed(model, placement);
    const auto far = static_cast<float>(kFar * diagonal_mm_);
    double sum = 0.0, count = 0.0;
    for (std::size_t k = 0; k < target_.scene().views.size(); ++k) {
      target_.draw_view(k, moved_, image_);
      const DepthImage& own = target_.image(k);
      for (std::size_t p = 0; p < own.depth.size(); ++p) {
        const bool a = own.depth[p] != kNothing, b = image_.depth[p] != kNothing;
        if (!a && !b) continue;
        const float off = std::abs(own.depth[p] - image_.depth[p]);
        sum += a && b ? static_cast<double>(std::min(1.0f, off / far)) : b ? 1.0 : kOnlyCard;
        count += 1.0;
      }
    }
    return count > 0.0 ? sum / count : 1.0;
  }

 private:
  static std::vector<View> few_views(const std::optional<Corner>& corner) {
    const auto all = cone_views(corner.value_or(Corner{}).opening_rad);
    return {all[0], all[1], all[3], all[5], all[7]};
  }
  Target target_;
  double diagonal_mm_;
  std::vector<float> moved_;
  DepthImage image_;
};

/// The turn by `angle_rad` about axis 0, 1 or 2.
Eigen::Matrix3d about(int axis, double angle_rad) {
  return Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
}

/// One of seven small changes: the size, a turn about an axis through the model's middle, a shift.
ModelPlacement changed(const ModelPlacement& from, int which, double step, const Vec3& middle,
                       double diagonal_mm) {
  ModelPlacement to = from;
  if (which < 3) {
    to.shift_mm[which] += step * diagonal_mm;
    return to;
  }
  const Vec3 at = from.turn * (from.scale_mm * middle) + from.shift_mm;
  if (which == 3)
    to.scale_mm *= 1.0 + step;
  else
    to.turn = about(which - 4, 2.0 * step) * from.turn;
  to.shift_mm = at - to.turn * (to.scale_mm * middle);
  return to;
}

/// Improves a placement by steps along `which`, from `step` down to `least`.
void improve(Resemblance& seen, Triangles model, FoundPlacement& found, std::span<const int> which,
             double step, double least, double diagonal_mm) {
  const Vec3 middle = box_of(model).centre();
  while (step > least) {
    bool better = false;
    for (const int one : which)
      for (const double sign : {1.0, -1.0}) {
        const ModelPlacement tried =
            changed(found.placement, one, sign * step, middle, diagonal_mm);
        const double misfit = seen.misfit(model, tried);
        if (misfit >= found.misfit) continue;
        found = {tried, misfit};
        better = true;
        break;
      }
    if (!better) step *= 0.5;
  }
}

/// What of the structure stands in the corner, or all of it where nothing does.
std::vector<float> standing(Triangles structure, const std::optional<Corner>& corner) {
  const double touch = 1e-4 * box_of(structure).diagonal();
  std::vector<float> out;
  if (corner) out = without_card(structure, *corner, touch);
  if (out.empty()) out.assign(structure.begin(), structure.end());
  return out;
}

std::vector<Eigen::Matrix3d> right_turns() {
  std::vector<Eigen::Matrix3d> out;
  for (const double x : {0.0, 90.0, 180.0, 270.0})
    for (const double y : {0.0, 90.0, 180.0, 270.0})
      for (const double z : {0.0, 90.0, 180.0, 270.0}) {
        const Eigen::Matrix3d turn = ModelPlacement::turn_of({x, y, z});
        if (std::none_of(out.begin(), out.end(), [&](const auto& t) { return t == turn; }))
          out.push_back(turn);
      }
  return out;
}

/// A start: the model turned, its box as large as the structure's along the axis where that makes
/// it the smallest (`rank` 0), the middle one or the largest, in the corner or with its middle on
/// the spine.
ModelPlacement start_of(const Eigen::Matrix3d& turn, Triangles model, const Box& structure,
                        std::size_t rank, bool on_spine) {
  ModelPlacement out;
  out.turn = turn;
  const Box own = box_of(placed(model, out));
  const Vec3 size = own.high - own.low, due = structure.high - structure.low;
  std::array<double, 3> ratio{};
  for (int k = 0; k < 3; ++k)
    ratio[static_cast<std::size_t>(k)] =
        due[k] / std::max(size[k], 1e-9) * (on_spine && k != 1 ? 2.0 : 1.0);
  std::sort(ratio.begin(), ratio.end());
  out.scale_mm = std::clamp(ratio.at(rank), 1e-9, 1e9);
  const Vec3 low = out.scale_mm * own.low, middle = out.scale_mm * own.centre();
  const double v = structure.centre().y() - middle.y();
  out.shift_mm = on_spine ? Vec3(-middle.x(), v, -middle.z()) : Vec3(-low.x(), v, -low.z());
  return out;
}

}  // namespace

Eigen::Matrix3d ModelPlacement::turn_of(const std::array<double, 3>& degrees) {
  Eigen::Matrix3d out = Eigen::Matrix3d::Identity();
  for (int axis = 0; axis < 3; ++axis) {
    const double turns = std::remainder(degrees[static_cast<std::size_t>(axis)], 360.0) / 90.0;
    Eigen::Matrix3d one = about(axis, 0.5 * std::numbers::pi * turns);
    if (turns == std::round(turns)) one = one.array().round().matrix();
    out = one * out;
  }
  return out;
}

std::array<double, 3> ModelPlacement::degrees() const {
  const double y = std::asin(std::clamp(-turn(2, 0), -1.0, 1.0));
  const bool is_upright = std::abs(turn(2, 0)) > 1.0 - 1e-12;  // x and z turn about one axis
  const double x = is_upright ? 0.0 : std::atan2(turn(2, 1), turn(2, 2));
  const double z =
      is_upright ? std::atan2(-turn(0, 1), turn(1, 1)) : std::atan2(turn(1, 0), turn(0, 0));
  return {x * kDegrees + 0.0, y * kDegrees + 0.0, z * kDegrees + 0.0};  // never -0
}

std::vector<float> placed(Triangles model, const ModelPlacement& placement) {
  std::vector<float> out(model.size() / 9 * 9);
  const Eigen::Matrix3d m = placement.scale_mm * placement.turn;
  const double a = m(0, 0), b = m(0, 1), c = m(0, 2), d = m(1, 0), e = m(1, 1), f = m(1, 2),
               g = m(2, 0), h = m(2, 1), i = m(2, 2);
  const double x = placement.shift_mm.x(), v = placement.shift_mm.y(), z = placement.shift_mm.z();
  for (std::size_t k = 0; k < out.size(); k += 3) {
    const auto p = static_cast<double>(model[k]), q = static_cast<double>(model[k + 1]),
               r = static_cast<double>(model[k + 2]);
    out[k] = static_cast<float>(a * p + b * q + c * r + x);
    out[k + 1] = static_cast<float>(d * p + e * q + f * r + v);
    out[k + 2] = static_cast<float>(g * p + h * q + i * r + z);
  }
  return out;
}

FoundPlacement find_placement(Triangles model, Triangles structure,
                              const std::optional<Corner>& corner) {
  constexpr std::size_t kKept = 16;
  constexpr std::array<int, 7> kAll{0, 1, 2, 3, 4, 5, 6};
  const std::vector<float> stands = standing(structure, corner);
  const Box box = box_of(stands);
  const std::vector<float> rough = coarse(model, box_of(model).diagonal() / 64.0);
  const Triangles few = rough.empty() ? model : Triangles(rough);
  Resemblance seen(stands, corner);
  if (seen.is_blind() || few.empty()) return {{}, 1.0};
  std::vector<FoundPlacement> starts;
  for (const Eigen::Matrix3d& turn : right_turns())
    for (const bool on_spine : {false, true})
      for (const std::size_t rank : {0U, 1U, 2U}) {
        const ModelPlacement start = start_of(turn, few, box, rank, on_spine);
        starts.push_back({start, seen.misfit(few, start)});
      }
  const auto by_misfit = [](const auto& a, const auto& b) { return a.misfit < b.misfit; };
  std::stable_sort(starts.begin(), starts.end(), by_misfit);
  starts.resize(std::min(starts.size(), kKept));
  for (FoundPlacement& start : starts) improve(seen, few, start, kAll, 0.08, 0.015, box.diagonal());
  FoundPlacement best = *std::min_element(starts.begin(), starts.end(), by_misfit);
  improve(seen, few, best, kAll, 0.015, 0.0005, box.diagonal());
  return best;
}

FoundPlacement find_shift_along_spine(Triangles model, const ModelPlacement& placement,
                                      Triangles structure, const std::optional<Corner>& corner) {
  constexpr std::array<int, 1> kAlong{1};
  constexpr int kSteps = 40;
  const std::vector<float> stands = standing(structure, corner);
  const Box box = box_of(stands), own = box_of(placed(model, placement));
  Resemblance seen(stands, corner);
  if (seen.is_blind() || own.empty()) return {placement, 1.0};
  // From where the model's end touches the structure's beginning to the other way round.
  const double from = box.low.y() - own.high.y(), to = box.high.y() - own.low.y();
  FoundPlacement best{placement, 2.0};
  for (int k = 0; k <= kSteps; ++k) {
    ModelPlacement tried = placement;
    tried.shift_mm.y() += from + (to - from) * k / kSteps;
    const double misfit = seen.misfit(model, tried);
    if (misfit < best.misfit) best = {tried, misfit};
  }
  improve(seen, model, best, kAlong, (to - from) / kSteps / box.diagonal(), 1e-4, box.diagonal());
  return best;
}

}  // namespace popcut::likeness
