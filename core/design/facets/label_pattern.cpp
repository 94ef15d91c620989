// SPDX-License-Identifier: MIT
#include "core/design/facets/label_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/buckets.hpp"
#include "core/geometry/disjoint_sets.hpp"

namespace popcut {
namespace {

PlaneId plane_id(Label label) { return label; }

/// Where the line before a column lies in a plane, in steps.
struct Place {
  int x{}, z{};
};
Place place_in(const FacetPlane& plane, int across) {
  return plane.upright ? Place{plane.offset, plane.offset - across}
                       : Place{plane.offset + across, plane.offset};
}

void write_margin(StripWriter& writer, const FacetCardSize& card) {
  writer.start(0.0, card.wall_mm);
  writer.panel_to(0.0, 0.0, kWallPlane);
  writer.panel_to(card.ground_mm, 0.0, kGroundPlane);
  writer.close(StripKind::Margin, -1, card.margin_mm);
}

void write_strip(StripWriter& writer, const std::vector<LabelRun>& runs, const FacetPlanes& planes,
                 const FacetGrid& grid, const FacetCardSize& card) {
  writer.start(0.0, card.wall_mm);
  const auto mm = [&](int steps) { return steps * grid.step_mm; };
  int level = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const LabelRun& run = runs[r];
    if (run.label == kNoLabel) continue;  // the cut before the next run is as long as this
    const FacetPlane& plane = planes[run.label];
    const bool is_last = r + 1 == runs.size();
    if (r > 0 && !run.folds_on) {
      const Place begin = place_in(plane, grid.across(run.begin));
      writer.panel_to(mm(begin.x), mm(begin.z), kNoPlane);
    }
    const Place end = place_in(plane, grid.across(run.end));
    const bool is_card = run.label == kWallLabel || run.label == kGroundLabel;
    writer.panel_to(is_last ? card.ground_mm : mm(end.x), is_last ? 0.0 : mm(end.z),
                    plane_id(run.label), is_card ? -1 : level++ / 2);
  }
}

/// Whether a window has nothing of itself in the strip before: it is opened there, upwards.
bool begins_window(const LabelImage& image, int s, const LabelRun& run) {
  if (s == 0) return true;
  const auto before = image.strip(s - 1);
  return std::find(before.begin() + run.begin, before.begin() + run.end, kNoLabel) ==
         before.begin() + run.end;
}

/// Graph of patches, to find those that lie inside of others: patch k is node k + 1, node 0 is
/// everything around the sheet.
class PatchGraph {
 public:
  explicit PatchGraph(const LabelPatches& patches) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> sides;
    const std::size_t strips = patches.first_run.size() - 1;
    const auto add = [&](std::uint32_t a, std::uint32_t b) {
      if (a != b) sides.emplace_back(a, b), sides.emplace_back(b, a);
    };
    for (std::size_t s = 0; s < strips; ++s) {
      const std::uint32_t first = patches.first_run[s], end = patches.first_run[s + 1];
      add(0, patches.patch[first] + 1);
      add(0, patches.patch[end - 1] + 1);
      for (std::uint32_t r = first; r + 1 < end; ++r)
        add(patches.patch[r] + 1, patches.patch[r + 1] + 1);
      if (s + 1 == strips) break;
      for (std::uint32_t r = first, q = end; r < end && q < patches.first_run[s + 2];) {
        add(patches.patch[r] + 1, patches.patch[q] + 1);
        const int stop = patches.runs[r].end, other = patches.runs[q].end;
        if (stop <= other) ++r;
        if (other <= stop) ++q;
      }
    }
    std::sort(sides.begin(), sides.end());
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    beside_ = Buckets<std::uint32_t>(patches.count + 1, [&](auto&& put) {
      for (const auto& [a, b] : sides) put(a, b);
    });
  }

  /// For each patch the outermost one that surrounds it, or -1 (Tarjan 1972: what is below a node
  /// that none of it can go around).
  [[nodiscard]] std::vector<std::int32_t> surrounding() const {
    const std::size_t nodes = beside_.size();
    std::vector<std::uint32_t> seen(nodes, 0), low(nodes, 0), parent(nodes, 0), next(nodes, 0);
    std::vector<std::uint32_t> order, stack{0};
    std::uint32_t clock = 0;
    seen[0] = low[0] = ++clock;
    order.push_back(0);
    while (!stack.empty()) {
      const std::uint32_t node = stack.back();
      const auto beside = beside_[node];
      if (next[node] < beside.size()) {
        const std::uint32_t other = beside[next[node]++];
        if (seen[other] == 0) {
          parent[other] = node;
          seen[other] = low[other] = ++clock;
          order.push_back(other);
          stack.push_back(other);
        } else if (other != parent[node]) {
          low[node] = std::min(low[node], seen[other]);
        }
        continue;
      }
      stack.pop_back();
      if (node != 0) low[parent[node]] = std::min(low[parent[node]], low[node]);
    }
    std::vector<std::int32_t> out(nodes, -1);
    for (const std::uint32_t node : order) {
      if (node == 0) continue;
      const std::uint32_t up = parent[node];
      if (out[up] >= 0)
        out[node] = out[up];
      else if (up != 0 && low[node] >= seen[up])
        out[node] = static_cast<std::int32_t>(up) - 1;
    }
    out.erase(out.begin());
    return out;
  }

 private:
  Buckets<std::uint32_t> beside_;
};

}  // namespace

LabelStrips strips_of(const LabelImage& image, const FacetPlanes& planes,
                      const FacetCardSize& card) {
  LabelStrips out;
  const FacetGrid& grid = image.grid;
  StripWriter writer;
  std::uint32_t written = 0;
  const auto margin = [&] {
    if (card.margin_mm > 0.0) write_margin(writer, card), ++written;
  };
  margin();
  std::int32_t group = 0;
  std::uint32_t panel = card.margin_mm > 0.0 ? 2 : 0;
  for (int s = 0, end = 0; s < grid.strips; s = end, ++group) {
    end = s + 1;
    const auto labels = image.strip(s);
    const std::vector<LabelRun> runs = runs_of(labels, planes, grid);
    for (std::size_t r = 0; r < runs.size(); ++r) {
      if (runs[r].label == kNoLabel) continue;
      if (r > 0 && !runs[r].folds_on) ++panel;  // the cut before it
      if (r + 1 < runs.size() && runs[r + 1].label == kNoLabel &&
          begins_window(image, s, runs[r + 1]))
        out.parted.push_back(panel);
      ++panel;
    }
    while (end < grid.strips && std::equal(labels.begin(), labels.end(), image.strip(end).begin()))
      ++end;
    write_strip(writer, runs, planes, grid, card);
    writer.close(StripKind::Slice, group, (end - s) * grid.strip_mm);
    out.strip_of.insert(out.strip_of.end(), static_cast<std::size_t>(end - s), written++);
  }
  margin();
  out.strips = writer.take();
  return out;
}

std::int32_t LabelPattern::face_of(int s, std::size_t run) const {
  const std::uint32_t strip = strips.strip_of[static_cast<std::size_t>(s)];
  std::size_t count = 0;
  for (std::uint32_t p = strips.strips.first_panel[strip]; p < strips.strips.first_panel[strip + 1];
       ++p)
    if (!strips.strips.is_cut(p) && count++ == run) return built.panel_face[p];
  return -1;
}

Result<LabelPattern> pattern_of(const LabelImage& image, const FacetPlanes& planes,
                                const FacetCardSize& card, double min_panel_mm) {
  LabelPattern out;
  out.strips = strips_of(image, planes, card);
  auto built = build_pattern(out.strips.strips, card.wall_mm, card.ground_mm, card.margin_mm > 0.0,
                             min_panel_mm, out.strips.parted);
  if (!built) return tl::unexpected(built.error());
  out.built = std::move(*built);
  out.motion = rigid::mobility(out.built.section());
  return out;
}

void mark_kites(LabelPattern& made, const FacetPlanes& planes, double step_mm) {
  if (planes.kites().empty()) return;
  Pattern& pattern = made.built.pattern;
  const Strips& strips = made.strips.strips;
  std::vector<std::int32_t> kite_of(pattern.faces(), -1);  // by face, index into the pattern's
  for (std::uint32_t p = 0; p + 1 < strips.panels(); ++p) {
    const PlaneId plane = strips.plane[p];
    if (plane == kNoPlane || planes[static_cast<Label>(plane)].kite < 0) continue;
    const FacetPlane& first = planes[static_cast<Label>(plane)];
    if (!first.upright) continue;  // the panel after it is the other one
    const auto upper = static_cast<std::size_t>(made.built.panel_face[p]),
               lower = static_cast<std::size_t>(made.built.panel_face[p + 1]);
    if (kite_of[upper] >= 0) continue;
    kite_of[upper] = kite_of[lower] = static_cast<std::int32_t>(pattern.kites.size());
    Kite kite;
    kite.section = planes.kites()[static_cast<std::size_t>(first.kite)].section(step_mm);
    kite.faces = {static_cast<std::uint32_t>(upper), static_cast<std::uint32_t>(lower)};
    pattern.kites.push_back(std::move(kite));
  }
  for (Kite& kite : pattern.kites) {
    kite.v0_mm = pattern.width_mm;
    for (const std::uint32_t face : kite.faces)
      for (const std::uint32_t i : pattern.face(face)) {
        const PatternVertex& p = pattern.vertices[i];
        kite.v0_mm = std::min(kite.v0_mm, p.v), kite.v1_mm = std::max(kite.v1_mm, p.v);
        if (kite.section.has(p.x, p.z)) kite.vertices.push_back(i);
      }
    std::sort(kite.vertices.begin(), kite.vertices.end());
    kite.vertices.erase(std::unique(kite.vertices.begin(), kite.vertices.end()),
                        kite.vertices.end());
    const bool overhangs = kite.section.overhangs();
    const auto role_at = [&](double across_mm) {
      const auto is_at = [&](double x, double z) {
        return std::abs(across_mm - (x - z)) <= kSamePlace_mm;
      };
      if (is_at(kite.section.q.x, kite.section.e.z)) return EdgeRole::Mountain;
      return is_at(kite.section.q.x, kite.section.q.z) != overhangs ? EdgeRole::Valley
                                                                    : EdgeRole::Mountain;
    };
    const auto is_fold = [](EdgeRole role) {
      return role == EdgeRole::Mountain || role == EdgeRole::Valley;
    };
    for (std::uint32_t e = 0; e < pattern.edges.size(); ++e) {
      PatternEdge& edge = pattern.edges[e];
      if (!is_fold(edge.role) || edge.left < 0 || edge.right < 0) continue;
      const auto is_own = [&](std::int32_t face) {
        return kite.faces[0] == static_cast<std::uint32_t>(face) ||
               kite.faces[1] == static_cast<std::uint32_t>(face);
      };
      if (!is_own(edge.left) && !is_own(edge.right)) continue;
      const PatternVertex& at = pattern.vertices[edge.from];
      edge.role = role_at(at.x - at.z);
      if (is_own(edge.left) != is_own(edge.right)) kite.edges.push_back(e);
    }
    const double begin = pattern.wall_mm + kite.section.q.x - kite.section.q.z,
                 end = pattern.wall_mm + kite.section.e.x - kite.section.e.z;
    for (SheetLine& line : pattern.lines)
      if (is_fold(line.role) && line.u0 >= begin - kSamePlace_mm &&
          line.u0 <= end + kSamePlace_mm &&
          std::min(line.v0, line.v1) >= kite.v0_mm - kSamePlace_mm &&
          std::max(line.v0, line.v1) <= kite.v1_mm + kSamePlace_mm)
        line.role = role_at(line.u0 - pattern.wall_mm);
  }
}

StripRuns strip_runs(const LabelImage& image, const FacetPlanes& planes) {
  const FacetGrid& grid = image.grid;
  const std::vector<LabelRun> card{{0, grid.wall, kWallLabel, false},
                                   {grid.wall, grid.columns, kGroundLabel, true}};
  StripRuns out{card};
  for (int s = 0; s < grid.strips; ++s) out.push_back(runs_of(image.strip(s), planes, grid));
  out.push_back(card);
  return out;
}

LabelPatches patches_of(const LabelImage& image, const FacetPlanes& planes, double min_panel_mm) {
  return patches_of(strip_runs(image, planes), image.grid, min_panel_mm);
}

LabelPatches patches_of(const StripRuns& strips, const FacetGrid& grid, double min_panel_mm) {
  LabelPatches out;
  out.first_run.push_back(0);
  for (const std::vector<LabelRun>& runs : strips) {
    out.runs.insert(out.runs.end(), runs.begin(), runs.end());
    out.first_run.push_back(static_cast<std::uint32_t>(out.runs.size()));
  }
  DisjointSets sets(out.runs.size());
  for (std::size_t s = 0; s + 2 < out.first_run.size(); ++s) {
    const std::uint32_t end = out.first_run[s + 1];
    for (std::uint32_t r = out.first_run[s], q = end; r < end && q < out.first_run[s + 2];) {
      const LabelRun &a = out.runs[r], &b = out.runs[q];
      const int overlap = std::min(a.end, b.end) - std::max(a.begin, b.begin);
      if (a.label == b.label && is_joint(overlap * grid.step_mm, min_panel_mm)) sets.join(r, q);
      if (a.end <= b.end) ++r;
      if (b.end <= a.end) ++q;
    }
  }
  out.count = sets.number(out.patch);
  return out;
}

bool fill_enclosed(LabelImage& image, const FacetPlanes& planes, double min_panel_mm) {
  const LabelPatches patches = patches_of(image, planes, min_panel_mm);
  const std::vector<std::int32_t> around = PatchGraph(patches).surrounding();
  std::vector<Label> label_of(patches.count);
  for (std::size_t r = 0; r < patches.runs.size(); ++r)
    label_of[patches.patch[r]] = patches.runs[r].label;
  bool any = false;
  for (int s = 0; s < image.grid.strips; ++s) {
    const auto at = static_cast<std::size_t>(s) + 1;
    for (std::uint32_t r = patches.first_run[at]; r < patches.first_run[at + 1]; ++r) {
      const std::int32_t outer = around[patches.patch[r]];
      if (outer < 0) continue;
      any = true;
      const auto strip = image.strip(s);
      std::fill(strip.begin() + patches.runs[r].begin, strip.begin() + patches.runs[r].end,
                label_of[static_cast<std::size_t>(outer)]);
    }
  }
  return any;
}

}  // namespace popcut
