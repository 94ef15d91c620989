// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>

#include <fmt/format.h>

#include "core/plot/plot_parts.hpp"

namespace popcut::plot {
namespace {

constexpr int kBands = 24;

/// A colour of the scale, `t` from 0 to 1.
std::string colour_at(double t, bool diverging) {
  using Stop = std::array<double, 3>;
  static constexpr std::array<Stop, 5> kDiverging{
      {{24, 70, 140}, {120, 170, 215}, {247, 247, 245}, {232, 150, 120}, {165, 25, 40}}};
  static constexpr std::array<Stop, 5> kRising{
      {{45, 20, 85}, {50, 85, 145}, {35, 145, 140}, {120, 200, 95}, {250, 230, 60}}};
  const auto& stops = diverging ? kDiverging : kRising;
  const double at = std::clamp(t, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const double part = at - static_cast<double>(k);
  std::array<int, 3> rgb{};
  for (std::size_t c = 0; c < 3; ++c)
    rgb[c] = static_cast<int>(std::llround(stops[k][c] + part * (stops[k + 1][c] - stops[k][c])));
  return fmt::format("#{:02x}{:02x}{:02x}", rgb[0], rgb[1], rgb[2]);
}

/// Grid coordinates to the page.
struct GridFrame {
  const Frame& frame;
  const Map& map;
  [[nodiscard]] double x(double column) const {
    return frame.left + frame.width * column / static_cast<double>(map.columns - 1);
  }
  [[nodiscard]] double y(double row) const {
    return frame.top + frame.height * (1 - row / static_cast<double>(map.rows - 1));
  }
};

/// The part of one cell where the map is at least `level`, as a polygon in grid coordinates.
void clip_cell(const std::array<double, 4>& corner, double level, double column, double row,
               std::vector<PlotPoint>& out) {
  static constexpr std::array<PlotPoint, 4> kCorner{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
  out.clear();
  for (std::size_t k = 0; k < 4; ++k) {
    const std::size_t n = (k + 1) % 4;
    if (corner[k] >= level) out.push_back({column + kCorner[k][0], row + kCorner[k][1]});
    if ((corner[k] >= level) == (corner[n] >= level)) continue;
    const double t = (level - corner[k]) / (corner[n] - corner[k]);
    out.push_back({column + kCorner[k][0] + t * (kCorner[n][0] - kCorner[k][0]),
                   row + kCorner[k][1] + t * (kCorner[n][1] - kCorner[k][1])});
  }
}

/// All of the map that is at least `level`, as one path; whole cells in a row are one rectangle.
std::string path_above(const Map& map, double level, const GridFrame& to) {
  std::string path;
  std::vector<PlotPoint> polygon;
  const auto add = [&](std::span<const PlotPoint> points) {
    for (std::size_t k = 0; k < points.size(); ++k)
      put(path, "{}{:.2f},{:.2f}", k == 0 ? "M" : "L", to.x(points[k][0]), to.y(points[k][1]));
    path += "Z";
  };
  for (std::size_t row = 0; row + 1 < map.rows; ++row) {
    const auto low = static_cast<double>(row);
    double run = -1;  // where a run of whole cells began, -1: none
    const auto end_run = [&](double column) {
      if (run >= 0)
        add(std::array<PlotPoint, 4>{
            {{run, low}, {column, low}, {column, low + 1}, {run, low + 1}}});
      run = -1;
    };
    for (std::size_t column = 0; column + 1 < map.columns; ++column) {
      const std::size_t at = row * map.columns + column;
      const std::array<double, 4> corner{map.value[at], map.value[at + 1],
                                         map.value[at + map.columns + 1],
                                         map.value[at + map.columns]};
      const auto left = static_cast<double>(column);
      const auto above =
          std::count_if(corner.begin(), corner.end(), [&](double value) { return value >= level; });
      const bool finite = std::all_of(corner.begin(), corner.end(),
                                      [](double value) { return std::isfinite(value); });
      if (finite && above == 4) {
        if (run < 0) run = left;
        continue;
      }
      end_run(left);
      if (!finite || above == 0) continue;
      clip_cell(corner, level, left, low, polygon);
      add(polygon);
    }
    end_run(static_cast<double>(map.columns - 1));
  }
  return path;
}

void put_bands(std::string& svg, const Map& map, const GridFrame& to) {
  for (int band = 0; band < kBands; ++band) {
    const double level = band == 0 ? -1e300 : map.least + (map.largest - map.least) * band / kBands;
    const std::string path = path_above(map, level, to);
    if (path.empty()) break;
    put(svg, "<path d=\"{}\" fill=\"{}\"/>\n", path,
        colour_at((band + 0.5) / kBands, map.diverging));
  }
}

void put_contours(std::string& svg, const Map& map, const GridFrame& to,
                  const std::vector<double>& levels, const char* colour, double width) {
  for (const double level : levels) {
    std::string path;
    for (const auto& line : contour_lines(map, level)) {
      for (std::size_t k = 0; k < line.size(); ++k)
        put(path, "{}{:.2f},{:.2f}", k == 0 ? "M" : "L", to.x(line[k][0]), to.y(line[k][1]));
    }
    if (path.empty()) continue;
    put(svg,
        "<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\" "
        "stroke-linejoin=\"round\"/>\n",
        path, colour, width);
  }
}

void put_colour_bar(std::string& svg, const Map& map, const Frame& frame) {
  const Axis scale{map.label, map.least, map.largest, false};
  const Frame bar{frame.left + frame.width + 18, frame.top, 16, frame.height, {}, scale};
  const double step = bar.height / kBands;
  for (int band = 0; band < kBands; ++band)
    put(svg,
        "<rect x=\"{:.1f}\" y=\"{:.2f}\" width=\"{:.1f}\" height=\"{:.2f}\" "
        "fill=\"{}\"/>\n",
        bar.left, bar.top + bar.height - (band + 1) * step, bar.width, step + 0.3,
        colour_at((band + 0.5) / kBands, map.diverging));
  put(svg,
      "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"none\" "
      "stroke=\"#000000\" stroke-width=\"1\"/>\n",
      bar.left, bar.top, bar.width, bar.height);
  for (const double value : ticks(scale)) {
    const double y = bar.py(value);
    put_line(svg, bar.left + bar.width, y, bar.left + bar.width + 4, y, kBlack, 1);
    put_text(svg, bar.left + bar.width + 7, y + 4, tick_text(scale, value), "start", 11);
  }
  put_text(svg, bar.left + bar.width / 2, bar.top - 8, map.label, "middle", 12);
}

/// Where a contour crosses a cell's edge: edge 2 n goes from grid point n to the right, 2 n + 1 up.
struct Crossing {
  std::uint64_t edge{};
  PlotPoint at{};
};

/// A contour's way through one cell.
struct Segment {
  std::array<Crossing, 2> end;
  bool used{false};
};

std::vector<Segment> crossings(const Map& map, double level) {
  std::vector<Segment> segments;
  for (std::size_t row = 0; row + 1 < map.rows; ++row) {
    for (std::size_t column = 0; column + 1 < map.columns; ++column) {
      const std::size_t n = row * map.columns + column, up = n + map.columns;
      const std::array<double, 4> corner{map.value[n], map.value[n + 1], map.value[up + 1],
                                         map.value[up]};
      if (!std::all_of(corner.begin(), corner.end(), [](double v) { return std::isfinite(v); }))
        continue;
      const auto c = static_cast<double>(column), r = static_cast<double>(row);
      const auto part = [&](std::size_t a, std::size_t b) {
        return (level - corner[a]) / (corner[b] - corner[a]);
      };
      std::array<Crossing, 4> crossed;
      std::size_t count = 0;
      const auto above = [&](std::size_t k) { return corner[k] >= level; };
      if (above(0) != above(1)) crossed[count++] = {2 * n, {c + part(0, 1), r}};
      if (above(1) != above(2)) crossed[count++] = {2 * (n + 1) + 1, {c + 1, r + part(1, 2)}};
      if (above(3) != above(2)) crossed[count++] = {2 * up, {c + part(3, 2), r + 1}};
      if (above(0) != above(3)) crossed[count++] = {2 * n + 1, {c, r + part(0, 3)}};
      for (std::size_t k = 0; k + 1 < count; k += 2)
        segments.push_back({.end = {crossed[k], crossed[k + 1]}});
    }
  }
  return segments;
}

/// Joins segments that share an edge; each edge belongs to at most two.
std::vector<std::vector<PlotPoint>> chained(std::vector<Segment> segments) {
  constexpr std::size_t kNone = ~std::size_t{0};
  std::unordered_map<std::uint64_t, std::array<std::size_t, 2>> at_edge;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    for (const Crossing& end : segments[s].end) {
      auto& both = at_edge.try_emplace(end.edge, std::array{kNone, kNone}).first->second;
      (both[0] == kNone ? both[0] : both[1]) = s;
    }
  }
  const auto follow = [&](std::size_t s, int from) {
    std::vector<PlotPoint> line{segments[s].end[from].at};
    for (int out = 1 - from;;) {
      segments[s].used = true;
      const Crossing end = segments[s].end[out];
      line.push_back(end.at);
      const auto& both = at_edge[end.edge];
      const std::size_t next = both[0] == s ? both[1] : both[0];
      if (next == kNone || segments[next].used) return line;
      out = segments[next].end[0].edge == end.edge ? 1 : 0;
      s = next;
    }
  };
  const auto is_end = [&](const Crossing& end) { return at_edge[end.edge][1] == kNone; };
  std::vector<std::vector<PlotPoint>> lines;
  for (const bool closed : {false, true}) {
    for (std::size_t s = 0; s < segments.size(); ++s) {
      if (segments[s].used) continue;
      if (closed || is_end(segments[s].end[0])) {
        lines.push_back(follow(s, 0));
      } else if (is_end(segments[s].end[1])) {
        lines.push_back(follow(s, 1));
      }
    }
  }
  return lines;
}

}  // namespace

std::vector<std::vector<PlotPoint>> contour_lines(const Map& map, double level) {
  return chained(crossings(map, level));
}

void put_map(std::string& svg, const Map& map, const Frame& frame) {
  if (map.columns < 2 || map.rows < 2) return;
  const GridFrame to{frame, map};
  put_bands(svg, map, to);
  put_contours(svg, map, to, map.thin_contours, "#5a5a5a", 0.5);
  put_contours(svg, map, to, map.contours, kBlack, 2.2);
  put_colour_bar(svg, map, frame);
}

}  // namespace popcut::plot
