// SPDX-License-Identifier: MIT
#include "core/picture/slabs.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace popcut {
namespace {

SectionPlace at_v(const PatternVertex& a, const PatternVertex& b, double v) {
  const double t = (v - a.v) / (b.v - a.v);
  return {a.x + t * (b.x - a.x), a.z + t * (b.z - a.z)};
}

/// The strips' common borders, all distinct v of the pattern, and which of the stretches between
/// them are drawn.
class Borders {
 public:
  explicit Borders(const Pattern& pattern) {
    for (const PatternVertex& p : pattern.vertices) v.push_back(p.v);
    std::sort(v.begin(), v.end());
    v.erase(std::unique(v.begin(), v.end()), v.end());
    if (v.size() < 2) return;
    for (std::size_t s = 0; s + 1 < v.size(); ++s)
      drawn.push_back(s), first.push_back(s), group.push_back(s);
    first.push_back(v.size() - 1), group.push_back(v.size() - 1);
  }

  [[nodiscard]] std::size_t index(double at) const {
    return static_cast<std::size_t>(std::lower_bound(v.begin(), v.end(), at) - v.begin());
  }

  /// Puts neighbours together while they are narrower than `width_mm`; the middle one stands for
  /// all.
  void gather(double width_mm) {
    const std::size_t stretches = v.size() - 1;
    drawn.clear(), first.clear();
    for (std::size_t s = 0; s < stretches;) {
      std::size_t end = s + 1;
      while (end < stretches && v[end + 1] - v[s] <= width_mm) ++end;
      first.push_back(s);
      drawn.push_back((s + end - 1) / 2);
      s = end;
    }
    first.push_back(stretches);
    group.assign(stretches + 1, drawn.size());
    for (std::size_t g = drawn.size(); g-- > 0;)
      for (std::size_t s = g == 0 ? 0 : drawn[g - 1] + 1; s <= drawn[g]; ++s) group[s] = g;
  }

  std::vector<double> v;
  std::vector<std::size_t> drawn;  ///< the stretch that slab g shows
  std::vector<std::size_t> first;  ///< the first stretch of slab g; one more at the end
  std::vector<std::size_t> group;  ///< the first slab that shows this stretch or a later one
};

/// One crossing of a face's border through a slab.
struct Crossing {
  std::size_t slab{};
  double u_middle{};
  SectionPlace low, high;
};

SlabPanel panel_between(const Crossing& a, const Crossing& b, std::uint32_t face) {
  SlabPanel panel{a.low, a.high, b.low, b.high, PanelPlace::Structure, false, face};
  const bool same_x = panel.low_a.x == panel.low_b.x && panel.high_a.x == panel.high_b.x;
  const bool same_z = panel.low_a.z == panel.low_b.z && panel.high_a.z == panel.high_b.z;
  panel.is_upright = same_x && !same_z;
  if (panel.is_upright && panel.low_a.x == 0) panel.place = PanelPlace::Wall;
  if (!panel.is_upright && same_z && panel.low_a.z == 0) panel.place = PanelPlace::Ground;
  return panel;
}

void add_face(const Pattern& pattern, std::uint32_t f, const Borders& borders,
              std::vector<Crossing>& crossings, std::vector<Slab>& slabs) {
  const auto corners = pattern.face(f);
  crossings.clear();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const PatternVertex* a = &pattern.vertices[corners[i]];
    const PatternVertex* b = &pattern.vertices[corners[(i + 1) % corners.size()]];
    if (a->v > b->v) std::swap(a, b);
    const std::size_t end = borders.index(b->v);
    for (std::size_t g = borders.group[borders.index(a->v)];
         g < borders.drawn.size() && borders.drawn[g] < end; ++g) {
      const std::size_t s = borders.drawn[g];
      const SectionPlace low = at_v(*a, *b, borders.v[s]), high = at_v(*a, *b, borders.v[s + 1]);
      crossings.push_back({g, low.x - low.z + high.x - high.z, low, high});
    }
  }
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return std::pair(a.slab, a.u_middle) < std::pair(b.slab, b.u_middle);
  });
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
    slabs[crossings[i].slab].panels.push_back(panel_between(crossings[i], crossings[i + 1], f));
}

/// The kite of each face, and whether the face is its longer panel.
struct FaceOfKite {
  const Kite* kite{};
  bool is_roof{};
};
std::vector<FaceOfKite> kites_of(const Pattern& pattern) {
  std::vector<FaceOfKite> out(pattern.faces());
  for (const Kite& kite : pattern.kites)
    for (std::size_t k = 0; k < 2; ++k)
      out[kite.faces[k]] = {&kite, (k == 0) == kite.section.overhangs()};
  return out;
}

void mark(std::vector<Slab>& slabs, const std::vector<FaceOfKite>& kites) {
  for (Slab& slab : slabs)
    for (SlabPanel& panel : slab.panels)
      panel.kite = kites[panel.face].kite, panel.is_roof = kites[panel.face].is_roof;
}

void add_edge(const Pattern& pattern, const PatternEdge& edge, const std::vector<FaceOfKite>& kites,
              const Borders& borders, std::vector<Slab>& slabs) {
  FaceOfKite of;
  for (const std::int32_t face : {edge.left, edge.right})
    if (face >= 0 && kites[static_cast<std::size_t>(face)].kite != nullptr && !of.is_roof)
      of = kites[static_cast<std::size_t>(face)];
  PatternVertex a = pattern.vertices[edge.from], b = pattern.vertices[edge.to];
  const bool fold = edge.role == EdgeRole::Mountain || edge.role == EdgeRole::Valley;
  if (a.v == b.v) {  // along a slab's border: drawn with its face
    const bool face_above = (pattern.u(b) > pattern.u(a)) == (edge.left >= 0);
    const std::size_t border = borders.index(a.v);
    const std::size_t slab = face_above || border == 0 ? border : border - 1;
    return slabs[std::min(slab, slabs.size() - 1)].strokes.push_back(
        {a, b, fold, of.kite, of.is_roof});
  }
  if (a.v > b.v) std::swap(a, b);
  for (std::size_t s = borders.index(a.v); s < borders.index(b.v); ++s) {
    const double low = borders.v[s], high = borders.v[s + 1];
    const SectionPlace from = at_v(a, b, low), to = at_v(a, b, high);
    slabs[s].strokes.push_back(
        {{from.x, from.z, low}, {to.x, to.z, high}, fold, of.kite, of.is_roof});
  }
}

bool meet(const SectionPlace& a, const SectionPlace& b) {
  constexpr double kSame_mm = 1e-6;
  return std::abs(a.x - b.x) < kSame_mm && std::abs(a.z - b.z) < kSame_mm;
}

/// The corner between two points of a falling staircase.
SectionPlace corner(const SectionPlace& a, const SectionPlace& b, bool upright_first) {
  return upright_first ? SectionPlace{a.x, b.z} : SectionPlace{b.x, a.z};
}

/// Draws `steps` steps that hang together as one.
void thin(std::vector<SlabPanel>& panels, std::size_t steps) {
  std::vector<SlabPanel> kept;
  for (std::size_t i = 0; i < panels.size();) {
    std::size_t end = i + 1;
    while (end < panels.size() && end - i < 2 * steps && panels[i].place == PanelPlace::Structure &&
           panels[end].place == PanelPlace::Structure && panels[i].kite == nullptr &&
           panels[end].kite == nullptr && meet(panels[end - 1].low_b, panels[end].low_a))
      ++end;
    if (end - i > 2) {
      SlabPanel one = panels[i], two = panels[end - 1];
      const bool upright = one.is_upright;
      one.low_b = corner(one.low_a, two.low_b, upright);
      one.high_b = corner(one.high_a, two.high_b, upright);
      two.low_a = one.low_b, two.high_a = one.high_b, two.is_upright = !upright;
      kept.insert(kept.end(), {one, two});
    } else {
      kept.insert(kept.end(), panels.begin() + static_cast<std::ptrdiff_t>(i),
                  panels.begin() + static_cast<std::ptrdiff_t>(end));
    }
    i = end;
  }
  panels = std::move(kept);
}

/// How many panels there are between neighbouring borders.
std::size_t count_panels(const Pattern& pattern, const Borders& borders) {
  std::size_t sides = 0;
  for (std::uint32_t f = 0; f < pattern.faces(); ++f) {
    const auto corners = pattern.face(f);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const double a = pattern.vertices[corners[i]].v;
      const double b = pattern.vertices[corners[(i + 1) % corners.size()]].v;
      if (b > a) sides += borders.index(b) - borders.index(a);
    }
  }
  return sides;
}

/// All panels, V-folds left out, of the slabs that are drawn.
std::vector<Slab> panels_of(const Pattern& pattern, const Borders& borders,
                            const std::vector<std::uint8_t>& is_tip,
                            const std::vector<FaceOfKite>& kites, int every_step) {
  std::vector<Slab> slabs(borders.drawn.size());
  for (std::size_t g = 0; g < slabs.size(); ++g) {
    slabs[g].low_mm = borders.v[borders.first[g]];
    slabs[g].high_mm = borders.v[borders.first[g + 1]];
  }
  std::vector<Crossing> crossings;
  for (std::uint32_t f = 0; f < pattern.faces(); ++f) {
    const auto face = pattern.face(f);
    if (std::none_of(face.begin(), face.end(), [&](std::uint32_t c) { return is_tip[c] != 0; }))
      add_face(pattern, f, borders, crossings, slabs);
  }
  mark(slabs, kites);
  for (Slab& slab : slabs) {
    std::stable_sort(slab.panels.begin(), slab.panels.end(),
                     [](const SlabPanel& a, const SlabPanel& b) {
                       return a.low_a.x - a.low_a.z + a.low_b.x - a.low_b.z <
                              b.low_a.x - b.low_a.z + b.low_b.x - b.low_b.z;
                     });
    if (every_step > 1) thin(slab.panels, static_cast<std::size_t>(every_step));
  }
  return slabs;
}

}  // namespace

std::array<PatternVertex, 4> SlabPanel::corners(double low_mm, double high_mm) const {
  return {{{low_a.x, low_a.z, low_mm},
           {low_b.x, low_b.z, low_mm},
           {high_b.x, high_b.z, high_mm},
           {high_a.x, high_a.z, high_mm}}};
}

std::vector<SlabPanel> Slab::holes() const {
  if (panels.empty()) return {};
  // Where the wall's paper ends and the ground's begins, or where a structure without card does.
  SectionPlace top_low = panels.front().low_a, top_high = panels.front().high_a;
  SectionPlace end_low = panels.back().low_b, end_high = panels.back().high_b;
  for (const SlabPanel& panel : panels) {
    if (panel.place == PanelPlace::Wall && panel.low_b.z < top_low.z)
      top_low = panel.low_b, top_high = panel.high_b;
    if (panel.place == PanelPlace::Ground && panel.low_a.x < end_low.x)
      end_low = panel.low_a, end_high = panel.high_a;
  }
  std::vector<SlabPanel> out;
  if (top_low.z > 0 || top_high.z > 0)
    out.push_back({{0, top_low.z}, {0, top_high.z}, {0, 0}, {0, 0}, PanelPlace::Wall, true});
  if (end_low.x > 0 || end_high.x > 0)
    out.push_back({{0, 0}, {0, 0}, {end_low.x, 0}, {end_high.x, 0}, PanelPlace::Ground, false});
  return out;
}

Slabs cut_into_slabs(const Pattern& pattern, std::size_t most_panels) {
  Slabs out;
  Borders borders(pattern);
  if (borders.v.size() < 2) return out;
  // The triangles of V-folds leave their panels, so they are painted over their strip at the end.
  std::vector<std::uint8_t> is_tip(pattern.vertices.size(), 0);
  for (const VFold& fold : pattern.v_folds) is_tip[fold.tip] = 1;

  const std::vector<FaceOfKite> kites = kites_of(pattern);
  const auto most = static_cast<double>(std::max<std::size_t>(1, most_panels));
  const auto stretches = static_cast<double>(borders.v.size() - 1);
  const double share = static_cast<double>(count_panels(pattern, borders)) / most;
  if (share > 1) {
    out.every_strip = static_cast<int>(std::ceil(std::sqrt(share)));
    out.every_step = static_cast<int>(std::ceil(share / out.every_strip));
  }
  for (;;) {
    if (share > 1)
      borders.gather((borders.v.back() - borders.v.front()) * out.every_strip / stretches);
    out.slabs = panels_of(pattern, borders, is_tip, kites, out.every_step);
    std::size_t panels = 0;
    for (const Slab& slab : out.slabs) panels += slab.panels.size();
    // Staircases of few steps do not become thinner, so that fewer strips must do.
    const double left = static_cast<double>(panels) / most;
    if (share <= 1 || left <= 1.5 || out.every_strip >= stretches) break;
    out.every_strip = static_cast<int>(std::ceil(out.every_strip * left));
  }

  const auto leaves = [&](std::uint32_t vertex) { return is_tip[vertex] != 0; };
  if (share <= 1)
    for (const PatternEdge& edge : pattern.edges)
      if (!leaves(edge.from) && !leaves(edge.to))
        add_edge(pattern, edge, kites, borders, out.slabs);
  for (std::uint32_t k = 0; k < pattern.v_folds.size(); ++k) {
    const double end = pattern.vertices[pattern.v_folds[k].tip].v;
    const std::size_t s = std::max<std::size_t>(borders.index(end), 1) - 1;
    const auto after = std::upper_bound(borders.first.begin(), borders.first.end(), s);
    out.slabs[static_cast<std::size_t>(after - borders.first.begin()) - 1].v_folds.push_back(k);
  }
  return out;
}

}  // namespace popcut
