// SPDX-License-Identifier: MIT
#include "core/design/placement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/design/design.hpp"
#include "core/design/reached_share.hpp"
#include "core/design/target/even_sections.hpp"
#include "core/design/target/monotone_fit.hpp"
#include "core/design/target/placement_map.hpp"
#include "core/design/target/section.hpp"
#include "core/design/target/surface_kinds.hpp"
#include "core/text/json_text.hpp"

namespace popcut {
namespace {

using Vec = std::array<double, 3>;

/// A way of standing.
struct Standing {
  TargetPlacement placement;
  Vec turn{};
  double shift{};  ///< along the spine, of half the length that the slices leave out: -1 to 1
  double length_mm{};
  double reached{};  ///< by the falling curves
};

/// Tries ways of standing.
class Placer {
 public:
  Placer(const DesignSpec& spec, const SurfaceAssets& assets, const TriangleMesh& mesh, Stand stand)
      : spec_(spec), assets_(assets), mesh_(mesh), stand_(stand) {
    points_ = area_points(mesh, kPoints);
    const MeshBox box = box_of(mesh);
    near_mm_ =
        kReachedWithin * spec.placement.scale_mm *
        std::hypot(box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]);
    const std::vector<double>& w = spec.widths_mm;
    if (!w.empty())
      extent_mm_ = std::accumulate(w.begin(), w.end(), 0.0) - 0.5 * (w.front() + w.back());
    if (spec.adaptive && spec.adaptive->length_mm) extent_mm_ = *spec.adaptive->length_mm;
  }

  /// @param turns  none: all by right angles, and those near the best of them
  Result<ProposedPlacement> run(const std::vector<Vec>& turns) {
    const std::vector<Vec> all = right_turns();
    for (const Vec& turn : turns.empty() ? all : turns)
      if (auto tried = consider(turn, 0.0); !tried) return tl::unexpected(tried.error());
    if (ways_.empty())
      return fail(ErrorKind::Infeasible, "/surface",
                  fmt::format("none of the {} ways to turn it by right angles can be sliced; is "
                              "the surface flat or empty?",
                              turns.empty() ? all.size() : turns.size()));
    if (turns.empty()) turn_on();
    for (const Standing& way : best(kDesigned))
      if (way.length_mm > extent_mm_ + near_mm_ && extent_mm_ > 0.0)
        for (const double shift : {-1.0, -0.5, 0.5, 1.0}) (void)consider(way.turn, shift);
    return choose();
  }

 private:
  /// Tries turns near the best ones.
  void turn_on() {
    for (const Standing& way : best(kTurnsKept))
      for (const double degrees : {-30.0, -15.0, 15.0, 30.0, 45.0})
        (void)consider(turned_on(way.turn, 1, degrees), 0.0);
    for (const double degrees : {8.0, 4.0, 2.0})
      for (const Standing& way : best(1))
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const double sign : {-1.0, 1.0})
            (void)consider(turned_on(way.turn, axis, sign * degrees), way.shift);
  }
  static constexpr std::size_t kPoints = 4096;
  static constexpr int kStrips = 64;
  static constexpr std::size_t kTurnsKept = 4;  ///< that are turned on
  static constexpr std::size_t kDesigned = 4;   ///< that are compared as designed
  /// Share of the area: `kPoints` tell no less apart.
  static constexpr double kClearlyMore = 0.01;

  [[nodiscard]] double extent_of(const Standing& way) const {
    return extent_mm_ > 0.0 ? extent_mm_ : way.length_mm;
  }

  [[nodiscard]] std::vector<Standing> best(std::size_t count) const {
    std::vector<Standing> out = ways_;
    std::stable_sort(out.begin(), out.end(), [](const Standing& a, const Standing& b) {
      constexpr double kClearly = 1e-3;  // else the plainer one, which was tried first
      return std::floor(a.reached / kClearly) > std::floor(b.reached / kClearly);
    });
    if (out.size() > count) out.resize(count);
    return out;
  }

  /// Stands it in this way and adds what falling curves reach, if it can be cut at all.
  Result<void> consider(const Vec& turn, double shift) {
    Standing way;
    way.turn = turn, way.shift = shift;
    way.placement = {spec_.placement.scale_mm, turn, {}};
    auto turned = placed(mesh_, way.placement);
    if (!turned) return tl::unexpected(turned.error());
    const MeshBox box = box_of(*turned);
    way.length_mm = box.high[1] - box.low[1];
    const double extent = extent_of(way);
    const auto stands = [&](std::size_t axis) {
      return stand_ == Stand::Whole ? -box.low[axis] : -0.5 * (box.low[axis] + box.high[axis]);
    };
    const double spare = std::max(0.0, way.length_mm - extent);
    way.placement.translate_mm = {
        stands(0), 0.5 * (extent - box.low[1] - box.high[1]) + 0.5 * shift * spare, stands(2)};
    for (double& by : way.placement.translate_mm) by = std::round(by * 1e6) / 1e6 + 0.0;
    const auto strips = falling_strips(*turned, box, way.placement.translate_mm, extent);
    if (strips.empty()) return {};
    way.reached = reached_share(standing_points(way.placement), strips, near_mm_);
    ways_.push_back(way);
    return {};
  }

  /// The nearest falling curves in the strips that the slices take of a turned mesh, when it is
  /// moved by `shift_mm`.
  [[nodiscard]] std::vector<ProfileStrip> falling_strips(const TriangleMesh& turned,
                                                         const MeshBox& box, const Vec& shift_mm,
                                                         double extent_mm) const {
    constexpr int kSamples = 128;
    std::vector<ProfileStrip> out;
    const double ends = spec_.widths_mm.empty() ? 0.0 : 0.25 * spec_.widths_mm.front();
    const double from = std::max(box.low[1] + shift_mm[1], -ends);
    const double to = std::min(box.high[1] + shift_mm[1], extent_mm + ends);
    if (!(to > from)) return out;
    const double width = (to - from) / kStrips;
    const auto sections = even_sections(turned, shift_mm, {from + 0.5 * width, width, kStrips});
    bool any = false;
    for (std::size_t k = 0; k < sections.size(); ++k) {
      const double begin = from + width * static_cast<double>(k);
      ProfileStrip strip{begin, begin + width, {}};
      const Outline outline = seen_from_outside(sections[k], kSamples);
      if (!outline.points.empty()) strip.profile = nearest_falling(outline.points).points;
      any = any || !strip.profile.empty();
      out.push_back(std::move(strip));
    }
    if (!any) out.clear();
    return out;
  }

  [[nodiscard]] std::vector<Vec3> standing_points(const TargetPlacement& placement) const {
    const PlacementMap map(placement);
    std::vector<Vec3> out = points_;
    for (Vec3& p : out) {
      const Vec stands = map.to_corner({p.x(), p.y(), p.z()});
      p = Vec3(stands.data());
    }
    return out;
  }

  /// Designs the spec as it then stands, and the share of the area that the structure reaches.
  struct Reached {
    double share{};
    SliceFit fit;
  };
  [[nodiscard]] Result<Reached> reached_by_design(const TargetPlacement& placement) const {
    DesignSpec spec = spec_;
    spec.placement = placement;
    if (!is_of_facets(spec.style)) spec.fit = FitMode::Nearest;
    const auto made = design(spec, assets_);
    if (!made) return tl::unexpected(made.error());
    std::vector<double> s_mm;
    for (const SliceReport& slice : made->report.slices) s_mm.push_back(slice.s_mm);
    const auto strips = profile_strips(made->strips, s_mm);
    return Reached{reached_share(standing_points(placement), strips, near_mm_), made->report.fit};
  }

  /// Designs the best ways and takes, of those that clearly reach most, the plainest.
  [[nodiscard]] Result<ProposedPlacement> choose() const {
    std::vector<std::pair<Standing, Reached>> designed;
    std::optional<Error> refusal;
    int refused = 0;
    for (const Standing& way : best(ways_.size())) {
      if (designed.size() == kDesigned) break;
      const auto reached = reached_by_design(way.placement);
      if (reached) {
        designed.emplace_back(way, *reached);
        continue;
      }
      if (!refusal) refusal = reached.error();
      if (designed.empty()) ++refused;
    }
    if (designed.empty()) {
      refusal->detail +=
          "; this is the best way to stand it, and no other can be "
          "designed either";
      return tl::unexpected(*refusal);
    }
    const auto before = reached_by_design(spec_.placement);
    double enough = 0.0;
    for (const auto& [way, reached] : designed) enough = std::max(enough, reached.share);
    enough = std::max(enough - kClearlyMore, before ? std::min(before->share, enough) : 0.0);
    const auto& [way, reached] =
        *std::find_if(designed.begin(), designed.end(),
                      [&](const auto& one) { return one.second.share >= enough; });
    ProposedPlacement out;
    out.placement = way.placement, out.reached = reached.share;
    out.always_nearest = is_of_facets(spec_.style);
    out.unreachable_share = unreachable_share(reached.fit);
    out.rms_mm = reached.fit.rms_mm, out.max_mm = reached.fit.max_mm;
    out.length_mm = way.length_mm, out.slices_mm = extent_of(way);
    out.tried = static_cast<int>(ways_.size());
    out.refused = refused;
    if (refused > 0) out.refusal = message(*refusal);
    if (before)
      out.reached_before = before->share;
    else
      out.refused_before = message(before.error());
    return out;
  }

  const DesignSpec& spec_;
  const SurfaceAssets& assets_;
  const TriangleMesh& mesh_;
  Stand stand_;
  std::vector<Vec3> points_;  ///< in units of the surface
  double near_mm_{}, extent_mm_{};
  std::vector<Standing> ways_;
};

/// A file in metres or inches is a speck beside the slices, one in micrometres a mountain; what is
/// further from them has no unit of length that files are in.
constexpr double kOtherUnit = 10.0, kFarthestUnit = 1e7;

/// The scale at which the surface is as long as the slices, if the spec names none and its own unit
/// is clearly not the millimetre.
std::optional<double> scale_to_slices(const DesignSpec& spec, const TriangleMesh& mesh) {
  if (spec.placement.scale_mm != 1.0 || spec.widths_mm.empty()) return {};
  const MeshBox box = box_of(mesh);
  double longest = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    longest = std::max(longest, box.high[axis] - box.low[axis]);
  const double slices_mm = std::accumulate(spec.widths_mm.begin(), spec.widths_mm.end(), 0.0);
  const double ratio = slices_mm / longest;
  const double apart = std::max(ratio, 1.0 / ratio);
  if (!(apart > kOtherUnit && apart < kFarthestUnit)) return {};
  constexpr double kShare = 0.8;  // of the slices, so that no end is cut off
  const double scale = kShare * ratio, step = std::pow(10.0, std::floor(std::log10(scale)) - 2.0);
  return std::round(scale / step) * step;
}

}  // namespace

Result<ProposedPlacement> propose_placement(const DesignSpec& spec, const SurfaceAssets& assets,
                                            Stand stand, std::vector<std::array<double, 3>> turns) {
  if (!spec.patches.empty())
    return fail(ErrorKind::OutOfRange, "/patches",
                "a placement is proposed for one design; give each patch's own spec");
  if (spec.book)
    return fail(ErrorKind::OutOfRange, "/book",
                "a book stands about the middle of its model by itself; leave out --place, or "
                "leave out rotate_deg and translate_mm");
  if (spec.placement.design_angle_deg != 90.0)
    return fail(
        ErrorKind::Infeasible, "/design_angle_deg",
        fmt::format("is {:g}; a placement is proposed for cards that are open to 90 degrees "
                    "only; set rotate_deg and translate_mm by hand, or leave it out for the "
                    "proposal",
                    spec.placement.design_angle_deg));
  if (solid_word(spec.surface) == nullptr)
    return fail(ErrorKind::Infeasible, "/surface/type",
                "a placement is proposed for meshes, grids, texts and drawings only; set "
                "rotate_deg and translate_mm by hand");
  const auto mesh = triangles_of(*spec.surface, assets);
  if (!mesh) return tl::unexpected(mesh.error());
  DesignSpec sized = spec;
  if (const auto scale = scale_to_slices(spec, *mesh)) sized.placement.scale_mm = *scale;
  return Placer(sized, assets, *mesh, stand).run(turns);
}

Result<std::string> with_placement(std::string_view spec_json, const ProposedPlacement& proposed) {
  if (const auto sound = parse_json(spec_json); !sound) return tl::unexpected(sound.error());
  auto spec = nlohmann::ordered_json::parse(spec_json, nullptr, false);
  if (spec.is_discarded() || !spec.is_object())
    return fail(ErrorKind::Malformed, "", "the spec is not a JSON object");
  if (const double scale = proposed.placement.scale_mm; scale != spec.value("scale_mm", 1.0))
    spec["scale_mm"] = scale;
  spec["rotate_deg"] = proposed.placement.rotate_deg;
  spec["translate_mm"] = proposed.placement.translate_mm;
  if (!proposed.always_nearest) spec["fit"] = "nearest";
  return spec.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace popcut
