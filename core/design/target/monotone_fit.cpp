// SPDX-License-Identifier: MIT
#include "core/design/target/monotone_fit.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace popcut {
namespace {

constexpr double kFollowed = 1e-5;  ///< of the size: what counts as on the target

/// Isotonic regression in place: the nondecreasing values nearest to `value` by weighted squares.
void pool_adjacent_violators(std::vector<double>& value, const std::vector<double>& weight) {
  struct Block {
    double mean{}, weight{};
    std::size_t count{};
  };
  std::vector<Block> blocks;
  for (std::size_t k = 0; k < value.size(); ++k) {
    Block block{value[k], weight[k], 1};
    while (!blocks.empty() && blocks.back().mean > block.mean) {
      const Block& last = blocks.back();
      const double sum = last.weight + block.weight;
      block.mean += (last.mean - block.mean) * last.weight / sum;
      block.weight = sum;
      block.count += last.count;
      blocks.pop_back();
    }
    blocks.push_back(block);
  }
  std::size_t k = 0;
  for (const Block& block : blocks)
    for (std::size_t i = 0; i < block.count; ++i) value[k++] = block.mean;
}

/// How far points lie behind the outermost ones: the largest step in x and z at once from a point
/// to another of the outline.
class Depth {
 public:
  explicit Depth(std::span<const OutlinePoint> outline) {
    std::vector<SectionPoint> all;
    all.reserve(outline.size());
    for (const OutlinePoint& p : outline) all.push_back(p.p);
    std::sort(all.begin(), all.end(), [](const SectionPoint& a, const SectionPoint& b) {
      return a.x != b.x ? a.x > b.x : a.z > b.z;
    });
    for (const SectionPoint& p : all)
      if (front_.empty() || p.z > front_.back().z) front_.push_back(p);
  }
  [[nodiscard]] double operator()(SectionPoint p) const {
    // Along the front x falls and z grows: the smaller of both steps is largest where they meet.
    const auto meet = std::partition_point(
        front_.begin(), front_.end(), [&](const SectionPoint& q) { return q.x - p.x > q.z - p.z; });
    double most = 0.0;
    if (meet != front_.end()) most = std::max(most, meet->x - p.x);
    if (meet != front_.begin()) most = std::max(most, std::prev(meet)->z - p.z);
    return most;
  }

 private:
  std::vector<SectionPoint> front_;
};

/// The nearer distance of an outline point: from where the fit moved it, or from the curve.
double miss(const SliceCurve& curve, SectionPoint p, double moved_mm) {
  return std::min(curve.nearest_distance(p), moved_mm + 1e-3 * (curve.h() + curve.d()));
}

SliceFit measure_fit(const Outline& outline, const FallingFit& fit, const SliceCurve& curve) {
  SliceFit out;
  out.outline_mm = outline.length_mm, out.visible_mm = outline.visible_mm;
  const double followed_mm = kFollowed * outline.size_mm;
  constexpr std::size_t kSamples = 400;
  const std::size_t stride = outline.points.size() / kSamples + 1;
  double sum = 0.0, weight = 0.0, reached = 0.0;
  for (std::size_t k = 0; k < outline.points.size(); ++k) {
    const double w = outline.points[k].weight_mm;
    if (fit.moved_mm[k] <= followed_mm) reached += w;
    if (k % stride != 0) continue;
    const double e = miss(curve, outline.points[k].p, fit.moved_mm[k]);
    sum += w * e * e, weight += w;
    out.max_mm = std::max(out.max_mm, e);
  }
  out.rms_mm = weight > 0.0 ? std::sqrt(sum / weight) : 0.0;
  out.unreachable_mm = std::max(0.0, outline.length_mm - std::min(reached, outline.visible_mm));
  if (out.unreachable_mm < 1e-9 * outline.length_mm) out.unreachable_mm = 0.0;
  return out;
}

/// What keeps an outline from being followed exactly, or nothing.
std::string obstacle(const Outline& outline, const FallingFit& fit, const char* what) {
  const double followed_mm = kFollowed * outline.size_mm;
  const SectionPoint first = outline.points.front().p, last = outline.points.back().p;
  const auto at = [](SectionPoint p) { return fmt::format("x = {:.4g}, z = {:.4g} mm", p.x, p.z); };
  if (outline.hole)
    return fmt::format("the {} has a hole there: its boundary ends in the open at {}", what,
                       at(*outline.hole));
  if (first.x > followed_mm)
    return fmt::format("the {} does not reach the wall: it begins at {}", what, at(first));
  if (last.z > followed_mm)
    return fmt::format("the {} does not reach the ground: it ends at {}", what, at(last));
  if (fit.max_moved_mm > followed_mm)
    return fmt::format(
        "the {} rises, overhangs or turns back near {}, {:.3g} mm off any curve that "
        "falls from wall to ground",
        what, at(fit.worst), fit.max_moved_mm);
  if (outline.gap_mm > followed_mm)
    return fmt::format("the {} has a gap of {:.3g} mm that begins at {}", what, outline.gap_mm,
                       at(outline.gap_at));
  return {};
}

/// Whether a placement can be proposed for it.
bool is_file(std::string_view what) { return what == "mesh" || what == "grid"; }

}  // namespace

void accumulate(SliceFit& total, const SliceFit& slice) {
  const double sum = total.visible_mm + slice.visible_mm;
  if (sum > 0.0)
    total.rms_mm = std::sqrt((total.rms_mm * total.rms_mm * total.visible_mm +
                              slice.rms_mm * slice.rms_mm * slice.visible_mm) /
                             sum);
  total.outline_mm += slice.outline_mm;
  total.unreachable_mm += slice.unreachable_mm;
  total.visible_mm = sum;
  total.max_mm = std::max(total.max_mm, slice.max_mm);
}

FallingFit nearest_falling(std::span<const OutlinePoint> outline) {
  FallingFit out;
  if (outline.empty()) return out;
  const std::size_t n = outline.size() + 2;
  double total = 0.0;
  for (const OutlinePoint& p : outline) total += p.weight_mm;
  std::vector<double> x(n), fall(n), weight(n, 1e-12 * (total > 0.0 ? total : 1.0));
  double most_x = 0.0, most_z = 0.0;
  for (const OutlinePoint& p : outline)
    most_x = std::max(most_x, p.p.x), most_z = std::max(most_z, p.p.z);
  const Depth depth(outline);
  constexpr double kBehind = 0.1;
  x[0] = 0.0, fall[0] = -outline.front().p.z;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    x[k + 1] = outline[k].p.x, fall[k + 1] = -outline[k].p.z;
    if (depth(outline[k].p) <= kBehind * (most_x + most_z)) weight[k + 1] += outline[k].weight_mm;
  }
  x[n - 1] = outline.back().p.x, fall[n - 1] = 0.0;
  pool_adjacent_violators(x, weight);
  pool_adjacent_violators(fall, weight);
  out.moved_mm.reserve(outline.size());
  out.points.reserve(n);
  for (std::size_t k = 0; k < n; ++k) {
    const SectionPoint p{std::max(0.0, x[k]), std::max(0.0, -fall[k])};
    if (k > 0 && k + 1 < n) {
      const SectionPoint was = outline[k - 1].p;
      out.moved_mm.push_back(std::hypot(p.x - was.x, p.z - was.z));
      if (out.moved_mm.back() > out.max_moved_mm)
        out.max_moved_mm = out.moved_mm.back(), out.worst = was;
    }
    if (out.points.empty() || p.x != out.points.back().x || p.z != out.points.back().z)
      out.points.push_back(p);
  }
  return out;
}

SliceCurve strictly_falling(std::vector<SectionPoint> points) {
  const double h = points.front().z, d = points.back().x;
  double level = 0.0;  // of the chord's extent of 2
  for (std::size_t k = 1; k < points.size(); ++k) {
    const double dx = (points[k].x - points[k - 1].x) / d;
    const double dz = (points[k - 1].z - points[k].z) / h;
    if (std::min(dx, dz) < 0.5 * kFallMargin * (dx + dz)) level += dx + dz;
  }
  if (level > 0.02) {
    for (SectionPoint& p : points) {
      const double t = p.x / d - p.z / h;
      const double n = 1.0 + (1.0 - kFallMargin) * (p.x / d + p.z / h - 1.0);
      p = {0.5 * d * (n + t), 0.5 * h * (n - t)};
    }
  }
  return SliceCurve::through(points);
}

Result<SurfaceSlice> fit_section(const Section& section, FitMode mode, const std::string& place,
                                 const char* what) {
  const Outline outline = seen_from_outside(section);
  if (outline.points.empty())
    return fail(
        ErrorKind::Infeasible, place,
        fmt::format("no part of the {} is in the corner there; move it with translate_mm or "
                    "use fewer slices",
                    what),
        ErrorReason::Misplaced);
  FallingFit fit = nearest_falling(outline.points);
  if (mode == FitMode::Exact) {
    if (const std::string why = obstacle(outline, fit, what); !why.empty())
      return fail(ErrorKind::Infeasible, place,
                  fmt::format("{}; use \"fit\": \"nearest\" or another placement{}", why,
                              is_file(what) ? ", as 'popcut design --place' proposes" : ""));
  }
  const double h = fit.points.front().z, d = fit.points.back().x;
  if (!(std::min(h, d) > 1e-9 * std::max(h, d)))
    return fail(
        ErrorKind::Infeasible, place,
        fmt::format("the {} spans only {:.4g} x {:.4g} mm of the corner there; a curve from "
                    "wall to ground is needed",
                    what, d, h),
        ErrorReason::Misplaced);
  SliceCurve curve = mode == FitMode::Exact ? SliceCurve::through(fit.points)
                                            : strictly_falling(std::move(fit.points));
  SliceFit figures = measure_fit(outline, fit, curve);
  return SurfaceSlice{std::move(curve), figures};
}

}  // namespace popcut
