// SPDX-License-Identifier: MIT
#include "core/design/placement.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <nlohmann/json.hpp>

#include "core/design/target/placement_map.hpp"
#include "core/design/target/surface_kinds.hpp"
#include "core/text/json_text.hpp"

namespace popcut {
namespace {

using Vec = std::array<double, 3>;

/// The 24 turns by right angles, each once, in degrees.
std::vector<Vec> right_turns() {
  std::vector<Vec> out;
  std::vector<TurnMatrix> seen;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 4; ++z) {
        const Vec degrees{90.0 * x, 90.0 * y, 90.0 * z};
        const TurnMatrix turn = turn_of(degrees);
        if (std::find(seen.begin(), seen.end(), turn) != seen.end()) continue;
        seen.push_back(turn);
        out.push_back(degrees);
      }
  return out;
}

/// From the first slice's middle to the last one's.
double slices_extent(const DesignSpec& spec) {
  const std::vector<double>& w = spec.widths_mm;
  if (w.empty()) return 0.0;
  return std::accumulate(w.begin(), w.end(), 0.0) - 0.5 * (w.front() + w.back());
}

/// What falling curves reach of a placed mesh, in nine sections inside the slices' range.
std::optional<SliceFit> try_slices(const TriangleMesh& mesh, double from_mm, double to_mm) {
  const auto surface = surface_of_triangles(mesh, FitMode::Nearest, "mesh", false);
  if (!surface) return std::nullopt;
  constexpr int kSections = 9;
  SliceFit sum;
  for (int k = 0; k < kSections; ++k) {
    const auto cut = surface->cut(from_mm + (to_mm - from_mm) * (k + 0.5) / kSections);
    if (!cut) return std::nullopt;
    accumulate(sum, cut->fit);
  }
  return sum;
}

}  // namespace

Result<ProposedPlacement> propose_placement(const DesignSpec& spec, const SurfaceAssets& assets,
                                            Stand stand) {
  if (!spec.patches.empty())
    return fail(ErrorKind::OutOfRange, "/patches",
                "a placement is proposed for one design; give each patch's own spec");
  if (asset_of(spec.surface).empty())
    return fail(ErrorKind::Infeasible, "/surface/type",
                "a placement is proposed for meshes and grids only; set rotate_deg and "
                "translate_mm by hand");
  const auto mesh = triangles_of(*spec.surface, assets);
  if (!mesh) return tl::unexpected(mesh.error());
  const double extent = slices_extent(spec);
  std::optional<ProposedPlacement> best;
  for (const Vec& turn : right_turns()) {
    ProposedPlacement now;
    now.placement = {spec.placement.scale_mm, turn, {}};
    auto turned = placed(*mesh, now.placement);
    if (!turned) return tl::unexpected(turned.error());
    const MeshBox box = box_of(*turned);
    now.length_mm = box.high[1] - box.low[1], now.slices_mm = extent;
    const auto stands = [&](std::size_t axis) {
      return stand == Stand::Whole ? -box.low[axis] : -0.5 * (box.low[axis] + box.high[axis]);
    };
    now.placement.translate_mm = {stands(0), 0.5 * (extent - box.low[1] - box.high[1]), stands(2)};
    for (double& shift : now.placement.translate_mm) shift = std::round(shift * 1e6) / 1e6 + 0.0;
    auto standing = placed(*mesh, now.placement);
    if (!standing) return tl::unexpected(standing.error());
    const double shorter = std::min(extent, now.length_mm);
    const auto fit = try_slices(*standing, 0.5 * (extent - shorter), 0.5 * (extent + shorter));
    if (!fit || !(fit->outline_mm > 0.0)) continue;
    now.unreachable_share = fit->unreachable_mm / fit->outline_mm;
    now.rms_mm = fit->rms_mm, now.max_mm = fit->max_mm;
    constexpr double kClearly = 1e-6;
    if (!best || now.unreachable_share < best->unreachable_share - kClearly) best = now;
  }
  if (!best)
    return fail(ErrorKind::Infeasible, "/surface",
                "none of the 24 ways to turn it by right angles can be sliced; is the surface flat "
                "or empty?");
  return *best;
}

Result<std::string> with_placement(std::string_view spec_json, const ProposedPlacement& proposed) {
  if (const auto sound = parse_json(spec_json); !sound) return tl::unexpected(sound.error());
  auto spec = nlohmann::ordered_json::parse(spec_json, nullptr, false);
  if (spec.is_discarded() || !spec.is_object())
    return fail(ErrorKind::Malformed, "", "the spec is not a JSON object");
  spec["rotate_deg"] = proposed.placement.rotate_deg;
  spec["translate_mm"] = proposed.placement.translate_mm;
  if (proposed.unreachable_share > 0.0 || proposed.max_mm > 0.0) spec["fit"] = "nearest";
  return spec.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace popcut
