// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "core/design/spline/loft.hpp"
#include "core/design/target/surface_kinds.hpp"
#include "core/fit/triangle_soup.hpp"

namespace popcut {
namespace {

/// What lies under the section and behind it: negative inside.
double above(const FallingCurve& section, double x, double z) {
  return x > section.d() ? x - section.d() : z - section.height(x);
}

/// Remembers the section of the last y that was asked for: solids are looked at plane by plane.
class SectionAt {
 public:
  explicit SectionAt(std::shared_ptr<const Loft> loft) : loft_(std::move(loft)) {}
  const std::optional<FallingCurve>& operator()(double y) {
    if (!known_ || y != y_) section_ = loft_->at(y), y_ = y, known_ = true;
    return section_;
  }

 private:
  std::shared_ptr<const Loft> loft_;
  bool known_{false};
  double y_{};
  std::optional<FallingCurve> section_;
};

/// The sections at even places along the spine, joined into bands; all at the same t.
TriangleSoup bands(const Loft& loft, const TargetPlacement& placement,
                   const TargetStretch& stretch) {
  const double reach = std::max(stretch.reach_x_mm, stretch.reach_z_mm);
  const double length = stretch.to_mm - stretch.from_mm;
  const auto parts = [&](double along_mm, double least, double most) {
    return static_cast<int>(
        std::clamp(std::ceil(std::sqrt(along_mm / stretch.finest_mm)), least, most));
  };
  const int across = parts(reach, 48.0, 256.0), along = parts(length, 64.0, 512.0);
  TriangleSoup out;
  std::vector<Vec3> last;
  for (int k = 0; k <= along; ++k) {
    const double s_mm = stretch.from_mm + length * k / along;
    const auto section = loft.at((s_mm - placement.translate_mm[1]) / placement.scale_mm);
    std::vector<Vec3> here;
    for (int i = 0; section && i <= across; ++i) {
      const auto [x, z] = section->at(-1.0 + 2.0 * i / across);
      here.emplace_back(placement.scale_mm * x, s_mm, placement.scale_mm * z);
    }
    if (!last.empty() && !here.empty())
      for (std::size_t i = 0; i + 1 < here.size(); ++i)
        out.add(last[i + 1], last[i], here[i], here[i + 1]);
    last = std::move(here);
  }
  return out;
}

}  // namespace

Result<Surface> surface_loft(const LoftSpec& spec, const TargetPlacement& placement, FitMode fit) {
  const auto loft = std::make_shared<const Loft>(spec.stations);
  if (!stays_upright(placement)) {
    const auto section_at = std::make_shared<SectionAt>(loft);
    return surface_of_solid(
        [section_at](double x, double y, double z) {
          const auto& section = (*section_at)(y);
          return section ? above(*section, x, z) : 1.0;
        },
        placement, fit, "loft");
  }
  const auto cut = [loft, placement, first = spec.stations.front().y,
                    last = spec.stations.back().y](double s_mm) -> Result<SurfaceSlice> {
    const double y = (s_mm - placement.translate_mm[1]) / placement.scale_mm;
    const auto section = loft->at(y);
    if (!section)
      return fail(ErrorKind::OutOfRange, fmt::format("/surface/stations at s = {:.6g} mm", s_mm),
                  fmt::format("there is no curve at y = {:.6g}; the stations reach from y = {:g} "
                              "to {:g}: use fewer or narrower slices, or more stations",
                              y, first, last),
                  ErrorReason::Misplaced);
    const double scale = placement.scale_mm;
    return SurfaceSlice{
        SliceCurve::sampled(
            scale * section->h(), scale * section->d(),
            [&](double t) { return scale * section->at(t)[0]; }, 1e-14, 12, section->knots()),
        {}};
  };
  return Surface(cut, [loft, placement](const TargetStretch& stretch) {
    return bands(*loft, placement, stretch);
  });
}

}  // namespace popcut
