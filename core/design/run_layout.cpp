// SPDX-License-Identifier: MIT
#include "core/design/run_layout.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace popcut {

std::optional<double> given_side_mm(const DesignSpec& spec) {
  if (!spec.card || spec.card->shut == CardShut::Free) return std::nullopt;
  const auto &wall = spec.card->wall_mm, &ground = spec.card->ground_mm;
  if (wall && ground) return std::min(*wall, *ground);
  return wall ? wall : ground;
}

RunLayout lay_runs(const Slicing& sliced, const std::vector<std::uint8_t>& cut_after,
                   const DesignSpec& spec) {
  RunLayout out;
  for (int j = 0; j < sliced.slices();) {
    if (const auto k = static_cast<std::size_t>(j); sliced.is_blank(k)) {
      out.blanks.push_back({j++, sliced.width_mm[k], out.runs.size()});
      continue;
    }
    int end = j + 1;
    while (end < sliced.slices() && cut_after[static_cast<std::size_t>(end - 1)] == 0) ++end;
    const int units = sliced.units[static_cast<std::size_t>(j)];
    const bool halved = end == j + 1 && units >= 2;
    Run run{static_cast<int>(out.laid.size()), halved ? 2 : end - j, {}, {}, {}};
    RunTarget target;
    target.units = units;
    target.min_panel_mm = spec.min_panel_mm;
    target.max_step_over_mean = spec.max_step_over_mean;
    if (const auto side_mm = given_side_mm(spec))
      target.shut_reach_mm = *side_mm - spec.card->margin_mm;
    std::vector<double> connector_s;
    const auto add = [&](int slice, double share) {
      const auto k = static_cast<std::size_t>(slice);
      out.laid.push_back({slice, sliced.s_mm[k], share * sliced.width_mm[k]});
      target.slice_curves.push_back(sliced.curves[k]);
      target.slice_s_mm.push_back(sliced.s_mm[k]);
      target.slice_width_mm.push_back(share * sliced.width_mm[k]);
      const auto begin = static_cast<std::ptrdiff_t>(sliced.chain_first[k]);
      const auto stop = static_cast<std::ptrdiff_t>(sliced.chain_first[k + 1]);
      target.chain_x.insert(target.chain_x.end(), sliced.chain_x.begin() + begin,
                            sliced.chain_x.begin() + stop);
      target.chain_z.insert(target.chain_z.end(), sliced.chain_z.begin() + begin,
                            sliced.chain_z.begin() + stop);
    };
    if (halved) {
      add(j, 0.5), add(j, 0.5);
      target.connector_curves.push_back(sliced.curves[static_cast<std::size_t>(j)]);
      connector_s.push_back(sliced.s_mm[static_cast<std::size_t>(j)]);
    } else {
      for (int k = j; k < end; ++k) add(k, 1.0);
      for (int k = j; units > 1 && k + 1 < end; ++k) {
        target.connector_curves.push_back(sliced.between[static_cast<std::size_t>(k)]);
        connector_s.push_back(sliced.between_s_mm[static_cast<std::size_t>(k)]);
      }
    }
    target.connector_s_mm = connector_s;
    out.runs.push_back(std::move(run));
    out.targets.push_back(std::move(target));
    out.connector_s.push_back(std::move(connector_s));
    j = end;
  }
  return out;
}

Result<void> fill_planes(RunLayout& layout, LatticeMethod method, const Progress& progress) {
  for (std::size_t r = 0; r < layout.runs.size(); ++r) {
    const RunTarget& target = layout.targets[r];
    Planes& planes = layout.runs[r].planes;
    if (target.units == 1) {
      planes = Planes{1, {}};
      for (const SliceCurve& c : target.slice_curves) {
        planes.value.push_back(c.h());
        planes.value.push_back(c.d());
      }
      continue;
    }
    switch (method) {
      case LatticeMethod::Branching:
        planes = lattice_branching(target);
        break;
      case LatticeMethod::Slices:
        planes = lattice_slices(target);
        break;
      case LatticeMethod::Levels:
        planes = lattice_levels(target);
        break;
      case LatticeMethod::Direct: {
        auto direct = lattice_direct(target, nullptr, progress);
        if (!direct) return tl::unexpected(direct.error());
        planes = std::move(*direct);
        break;
      }
      case LatticeMethod::Auto:
        return fail(ErrorKind::Internal, "/lattice", "auto is to be replaced by what it chose");
      case LatticeMethod::Conformal: {
        auto conformal = lattice_conformal(target, std::nullopt, nullptr, progress);
        if (!conformal) return tl::unexpected(within("/units_per_slice", conformal.error()));
        planes = std::move(*conformal);
      }
    }
  }
  return {};
}

bool mark_loose(RunLayout& layout, const Strips& strips, const BuiltPattern& built,
                const rigid::Mobility& motion) {
  for (const bool connectors : {false, true}) {
    bool any = false;
    std::size_t r = 0;
    int left = -1;  // slice strips so far in this run
    for (std::size_t s = 0; s < strips.size(); ++s) {
      const StripKind kind = strips.kind[s];
      const bool is_slice = kind == StripKind::Slice || kind == StripKind::Box;
      if (!is_slice && kind != StripKind::Connector) continue;
      if (is_slice && ++left == layout.runs[r].count) ++r, left = 0;
      if (kind == StripKind::Box || (kind == StripKind::Connector) != connectors) continue;
      Run& run = layout.runs[r];
      std::vector<std::uint8_t>& marks = connectors ? run.loose_levels : run.loose_planes;
      marks.resize(run.planes.value.size());
      for (std::uint32_t p = strips.first_panel[s]; p < strips.first_panel[s + 1]; ++p) {
        if (strips.level[p] < 0 || motion.loose[static_cast<std::size_t>(built.panel_face[p])] == 0)
          continue;
        const std::size_t at =
            static_cast<std::size_t>(left) * static_cast<std::size_t>(run.planes.units + 1) +
            static_cast<std::size_t>(strips.level[p]);
        any = any || marks[at] == 0;
        marks[at] = 1;
      }
    }
    if (any) return true;
  }
  return false;
}

}  // namespace popcut
