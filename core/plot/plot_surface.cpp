// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/plot/plot_parts.hpp"

namespace popcut::plot {
namespace {

using Place = std::array<double, 3>;  // in the unit cube

/// Looking at the cube from above its front: x to the right and nearer, y to the right and farther.
struct View {
  double left{}, top{};

  [[nodiscard]] PlotPoint page(const Place& p) const {
    constexpr double kScale = 205, kRise = 0.42;
    const double a = kCos * (p[0] - 0.5) + kSin * (p[1] - 0.5);
    const double b = -kSin * (p[0] - 0.5) + kCos * (p[1] - 0.5);
    return {left + 252 + kScale * a, top + 225 - kScale * (kRise * b + 0.95 * (p[2] - 0.5))};
  }
  /// Greater is farther.
  [[nodiscard]] static double depth(const Place& p) {
    return -kSin * p[0] + kCos * p[1] - 0.45 * p[2];
  }
  static constexpr double kCos = 0.866, kSin = 0.5;
};

struct Facet {
  std::array<Place, 3> corner;
  std::size_t level{};
  double depth{};
};

Place between(const Place& p, const Place& q, double t) {
  return {p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1]), p[2] + t * (q[2] - p[2])};
}

/// The surface of one level within a tetrahedron: nothing, one facet or two.
void cut_tetrahedron(const std::array<Place, 4>& p, const std::array<double, 4>& f, double level,
                     std::size_t index, std::vector<Facet>& out) {
  std::array<std::size_t, 4> order{};
  std::size_t above = 0, below = 4;
  for (std::size_t k = 0; k < 4; ++k) order[f[k] >= level ? above++ : --below] = k;
  if (above == 0 || above == 4) return;
  const auto on = [&](std::size_t a, std::size_t b) {
    const std::size_t i = order[a], j = order[b];
    return between(p[i], p[j], (level - f[i]) / (f[j] - f[i]));
  };
  const auto add = [&](const Place& a, const Place& b, const Place& c) {
    out.push_back({{a, b, c}, index, (View::depth(a) + View::depth(b) + View::depth(c)) / 3});
  };
  if (above == 1) return add(on(0, 1), on(0, 2), on(0, 3));
  if (above == 3) return add(on(0, 3), on(1, 3), on(2, 3));
  add(on(0, 2), on(0, 3), on(1, 3));
  add(on(0, 2), on(1, 3), on(1, 2));
}

std::vector<Facet> facets_of(const IsoPanel& panel) {
  const std::size_t n = panel.samples;
  std::vector<double> value(n * n * n);
  const auto part = [&](std::size_t k) {
    return static_cast<double>(k) / static_cast<double>(n - 1);
  };
  const auto along = [&](std::size_t axis, std::size_t k) {
    return panel.axis[axis].from + part(k) * (panel.axis[axis].to - panel.axis[axis].from);
  };
  for (std::size_t c = 0; c < n; ++c)
    for (std::size_t b = 0; b < n; ++b)
      for (std::size_t a = 0; a < n; ++a)
        value[(c * n + b) * n + a] = panel.value(along(0, a), along(1, b), along(2, c));
  // Each cell as six tetrahedra about its long diagonal.
  static constexpr std::array<std::array<std::size_t, 3>, 6> kWay{
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  std::vector<Facet> facets;
  for (std::size_t c = 0; c + 1 < n; ++c)
    for (std::size_t b = 0; b + 1 < n; ++b)
      for (std::size_t a = 0; a + 1 < n; ++a)
        for (const auto& way : kWay) {
          std::array<std::size_t, 3> at{a, b, c};
          std::array<Place, 4> p;
          std::array<double, 4> f{};
          for (std::size_t k = 0; k < 4; ++k) {
            p[k] = {part(at[0]), part(at[1]), part(at[2])};
            f[k] = value[(at[2] * n + at[1]) * n + at[0]];
            if (k < 3) ++at[way[k]];
          }
          if (!std::all_of(f.begin(), f.end(), [](double v) { return std::isfinite(v); })) continue;
          for (std::size_t l = 0; l < panel.levels.size(); ++l)
            cut_tetrahedron(p, f, panel.levels[l].value, l, facets);
        }
  std::sort(facets.begin(), facets.end(),
            [](const Facet& a, const Facet& b) { return a.depth > b.depth; });
  return facets;
}

/// How bright a facet is, 0.66 to 1, lit from above and the left.
double light(const Facet& facet) {
  const auto& [p, q, r] = facet.corner;
  const Place e{q[0] - p[0], q[1] - p[1], q[2] - p[2]}, f{r[0] - p[0], r[1] - p[1], r[2] - p[2]};
  const Place n{e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]};
  const double size = std::hypot(n[0], n[1], n[2]);
  if (!(size > 0)) return 1.0;
  return 0.66 + 0.34 * std::abs(-0.3 * n[0] - 0.5 * n[1] + 0.81 * n[2]) / size;
}

std::string shaded(const std::string& colour, double by) {
  std::string out = "#";
  for (std::size_t k = 1; k < 7; k += 2) {
    const int value = std::stoi(colour.substr(k, 2), nullptr, 16);
    out += fmt::format("{:02x}", static_cast<int>(value * by));
  }
  return out;
}

void put_edge(std::string& svg, const View& view, const Place& p, const Place& q, double width) {
  const PlotPoint a = view.page(p), b = view.page(q);
  put_line(svg, a[0], a[1], b[0], b[1], "#404040", width);
}

void put_box(std::string& svg, const View& view, bool front) {
  constexpr Place kNear{0, 0, 0};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (int corner = 0; corner < 4; ++corner) {
      Place p{};
      p[(axis + 1) % 3] = corner & 1;
      p[(axis + 2) % 3] = corner >> 1;
      Place q = p;
      q[axis] = 1;
      // Hidden: the edges at the far corner (0, 1, 0).
      const bool hidden =
          (p[0] == 0 && p[1] == 1 && p[2] == 0) || (q[0] == 0 && q[1] == 1 && q[2] == 0);
      if (hidden != front && p != kNear) put_edge(svg, view, p, q, hidden ? 0.5 : 1.0);
      if (p == kNear && hidden != front) put_edge(svg, view, p, q, 1.0);
    }
  }
}

void put_scales(std::string& svg, const IsoPanel& panel, const View& view) {
  struct Edge {
    Place from, to;
    double off_x, off_y;
    const char* anchor;
  };
  const std::array<Edge, 3> edges{{{{0, 0, 0}, {1, 0, 0}, -8, 16, "end"},
                                   {{1, 0, 0}, {1, 1, 0}, 8, 14, "start"},
                                   {{0, 0, 0}, {0, 0, 1}, -8, 4, "end"}}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Axis& scale = panel.axis[axis];
    const Edge& edge = edges[axis];
    for (const double value : ticks(scale, 4)) {
      const double t = (value - scale.from) / (scale.to - scale.from);
      const PlotPoint p = view.page(between(edge.from, edge.to, t));
      put_text(svg, p[0] + edge.off_x, p[1] + edge.off_y, tick_text(scale, value), edge.anchor, 11);
    }
    const PlotPoint middle = view.page(between(edge.from, edge.to, 0.5));
    const double out = axis == 2 ? 6.5 : 2.6;
    put_text(svg, middle[0] + out * edge.off_x, middle[1] + (axis == 2 ? 4 : out * edge.off_y),
             scale.label, edge.anchor, 14);
  }
}

}  // namespace

void put_surfaces(std::string& svg, const IsoPanel& panel, double left, double top) {
  const View view{left, top};
  put_text(svg, left + 247, top + 26, panel.title, "middle", 15);
  put_box(svg, view, false);
  if (panel.samples >= 2) {
    for (const Facet& facet : facets_of(panel)) {
      const PlotPoint a = view.page(facet.corner[0]), b = view.page(facet.corner[1]);
      const PlotPoint c = view.page(facet.corner[2]);
      const std::string colour = shaded(panel.levels[facet.level].colour, light(facet));
      put(svg,
          "<path d=\"M{:.1f},{:.1f}L{:.1f},{:.1f}L{:.1f},{:.1f}Z\" fill=\"{}\" "
          "stroke=\"{}\" stroke-width=\"0.5\"/>\n",
          a[0], a[1], b[0], b[1], c[0], c[1], colour, colour);
    }
  }
  put_box(svg, view, true);
  put_scales(svg, panel, view);
  put_text(svg, left + 247, top + 430, panel.remark, "middle", 12);
  double y = top + 50;
  for (const IsoPanel::Level& level : panel.levels) {
    put(svg, "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"14\" height=\"14\" fill=\"{}\"/>\n",
        left + 400, y - 11, level.colour);
    put_text(svg, left + 420, y, level.name, "start", 12);
    y += 20;
  }
}

}  // namespace popcut::plot
