// SPDX-License-Identifier: MIT
#include "core/design/layers/layer_outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace popcut {
namespace {

struct Corner {
  std::ptrdiff_t x{}, y{};
  friend bool operator==(const Corner&, const Corner&) = default;
};

/// Cells of one half: columns from the middle on.
struct HalfCells {
  std::size_t columns{}, rows{};
  std::vector<std::uint32_t> part;  ///< one a cell; 0: no paper

  [[nodiscard]] std::uint32_t at(std::ptrdiff_t x, std::ptrdiff_t y) const {
    return x >= 0 && y >= 0 && x < static_cast<std::ptrdiff_t>(columns) &&
                   y < static_cast<std::ptrdiff_t>(rows)
               ? part[static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)]
               : 0;
  }
};

/// Numbers what hangs together of the cells with `what`, from 1 on, without crossing the lines
/// before the columns of `lines`.
HalfCells numbered(const HalfCells& cells, bool paper, const std::vector<std::size_t>& lines,
                   std::uint32_t& count) {
  HalfCells out{cells.columns, cells.rows, std::vector<std::uint32_t>(cells.part.size(), 0)};
  const auto is_line = [&](std::size_t column) {
    return std::find(lines.begin(), lines.end(), column) != lines.end();
  };
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < out.part.size(); ++k) {
    if ((cells.part[k] != 0) != paper || out.part[k] != 0) continue;
    out.part[k] = ++count;
    open.push_back(k);
    while (!open.empty()) {
      const std::size_t at = open.back(), c = at % out.columns, r = at / out.columns;
      open.pop_back();
      const auto go = [&](std::size_t to) {
        if ((cells.part[to] != 0) == paper && out.part[to] == 0)
          out.part[to] = count, open.push_back(to);
      };
      if (c > 0 && !is_line(c)) go(at - 1);
      if (c + 1 < out.columns && !is_line(c + 1)) go(at + 1);
      if (r > 0) go(at - out.columns);
      if (r + 1 < out.rows) go(at + out.columns);
    }
  }
  return out;
}

/// Columns before which upright lines part all holes.
std::vector<std::size_t> lines_through_holes(const HalfCells& cells) {
  std::uint32_t count = 0;
  const HalfCells gaps = numbered(cells, false, {}, count);
  struct Gap {
    std::size_t from{std::numeric_limits<std::size_t>::max()}, to{};
    bool is_open{};
  };
  std::vector<Gap> all(count);
  for (std::size_t k = 0; k < gaps.part.size(); ++k) {
    if (gaps.part[k] == 0) continue;
    Gap& gap = all[gaps.part[k] - 1];
    const std::size_t c = k % cells.columns, r = k / cells.columns;
    gap.from = std::min(gap.from, c), gap.to = std::max(gap.to, c);
    gap.is_open = gap.is_open || c == 0 || c + 1 == cells.columns || r == 0 || r + 1 == cells.rows;
  }
  std::vector<std::size_t> lines;
  for (const Gap& gap : all)
    if (!gap.is_open && std::none_of(lines.begin(), lines.end(), [&](std::size_t line) {
          return line > gap.from && line <= gap.to;
        }))
      lines.push_back((gap.from + gap.to + 1) / 2);
  return lines;
}

/// The corners around a part, counter-clockwise, paper on the left.
std::vector<Corner> traced(const HalfCells& cells, std::uint32_t part) {
  const auto paper = [&](std::ptrdiff_t x, std::ptrdiff_t y) { return cells.at(x, y) == part; };
  constexpr std::array<Corner, 4> kSteps{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  // The cells left and right of a step ahead, from its corner.
  const auto left = [&](const Corner& at, int d) {
    return d == 0   ? paper(at.x, at.y)
           : d == 1 ? paper(at.x - 1, at.y)
           : d == 2 ? paper(at.x - 1, at.y - 1)
                    : paper(at.x, at.y - 1);
  };
  const auto right = [&](const Corner& at, int d) {
    return d == 0   ? paper(at.x, at.y - 1)
           : d == 1 ? paper(at.x, at.y)
           : d == 2 ? paper(at.x - 1, at.y)
                    : paper(at.x - 1, at.y - 1);
  };
  const auto first = static_cast<std::ptrdiff_t>(
      std::find(cells.part.begin(), cells.part.end(), part) - cells.part.begin());
  const auto columns = static_cast<std::ptrdiff_t>(cells.columns);
  const Corner begin{first % columns, first / columns};
  std::vector<Corner> out;
  Corner at = begin;
  int d = 0;
  do {
    out.push_back(at);
    const Corner& step = kSteps[static_cast<std::size_t>(d)];
    at = {at.x + step.x, at.y + step.y};
    for (const int turn : {1, 0, 3}) {
      const int next = (d + turn) % 4;
      if (left(at, next) && !right(at, next)) {
        d = next;
        break;
      }
    }
  } while (!(at == begin) && out.size() < 8 * cells.part.size());
  return out;
}

double off_line(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 d = b - a;
  const double length = norm(d);
  return length < 1e-12 ? norm(Vec2(p - a)) : std::abs(cross(d, Vec2(p - a))) / length;
}

/// Douglas and Peucker 1973 between two points that stay.
void simplify(const std::vector<Vec2>& points, std::size_t from, std::size_t to, double most,
              std::vector<Vec2>& out) {
  std::size_t far = from;
  double worst = most;
  for (std::size_t k = from + 1; k < to; ++k)
    if (const double off = off_line(points[k], points[from], points[to]); off > worst)
      worst = off, far = k;
  if (far == from) return;
  simplify(points, from, far, most, out);
  out.push_back(points[far]);
  simplify(points, far, to, most, out);
}

bool is_simple(const std::vector<Vec2>& polygon) {
  const std::size_t n = polygon.size();
  const auto side = [](Vec2 a, Vec2 b, Vec2 p) { return cross(Vec2(b - a), Vec2(p - a)); };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      const Vec2 a = polygon[i], b = polygon[(i + 1) % n], c = polygon[j], d = polygon[(j + 1) % n];
      if (side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0)
        return false;
    }
  return true;
}

/// The border of a part of a half as a simple polygon.
///
/// @param lines  upright ones that stay, beside the middle and the page
std::vector<Vec2> smooth_border(const std::vector<Corner>& corners,
                                const std::vector<std::size_t>& lines, double cell_mm) {
  const auto is_upright = [&](std::ptrdiff_t x) {
    return x == 0 ||
           std::find(lines.begin(), lines.end(), static_cast<std::size_t>(x)) != lines.end();
  };
  const auto place = [&](double x, double y) { return Vec2{x * cell_mm, y * cell_mm}; };
  // Corners on lines stay; of other sides the middles do.
  std::vector<Vec2> points;
  std::vector<std::size_t> fixed;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Corner &a = corners[k], &b = corners[(k + 1) % corners.size()];
    if (is_upright(a.x) || a.y == 0) {
      fixed.push_back(points.size());
      points.push_back(place(static_cast<double>(a.x), static_cast<double>(a.y)));
    }
    const bool on_line = (a.x == b.x && is_upright(a.x)) || (a.y == b.y && a.y == 0);
    if (!on_line)
      points.push_back(
          place(0.5 * static_cast<double>(a.x + b.x), 0.5 * static_cast<double>(a.y + b.y)));
  }
  if (fixed.empty()) fixed.push_back(0);
  for (const double most : {0.75, 0.4, 0.0}) {
    std::vector<Vec2> out;
    for (std::size_t k = 0; k < fixed.size(); ++k) {
      const std::size_t from = fixed[k];
      out.push_back(points[from]);
      if (k + 1 < fixed.size()) {
        simplify(points, from, fixed[k + 1], most * cell_mm, out);
        continue;
      }
      std::vector<Vec2> last(points.begin() + static_cast<std::ptrdiff_t>(from), points.end());
      last.insert(last.end(), points.begin(),
                  points.begin() + static_cast<std::ptrdiff_t>(fixed.front()) + 1);
      simplify(last, 0, last.size() - 1, most * cell_mm, out);
    }
    // Corners in the run of a line are none.
    std::vector<Vec2> turning;
    for (std::size_t k = 0; k < out.size(); ++k) {
      const Vec2 before = out[(k + out.size() - 1) % out.size()], after = out[(k + 1) % out.size()];
      if (std::abs(cross(Vec2(out[k] - before), Vec2(after - out[k]))) > 1e-9)
        turning.push_back(out[k]);
    }
    if (most == 0.0 || is_simple(turning)) return turning;
  }
  return {};
}

HalfCells half_of(const LayerGrid& grid, const LayerMask& mask, bool is_right) {
  HalfCells out{grid.columns / 2, grid.rows, std::vector<std::uint32_t>(grid.cells() / 2)};
  for (std::size_t r = 0; r < out.rows; ++r)
    for (std::size_t c = 0; c < out.columns; ++c)
      out.part[r * out.columns + c] =
          mask[grid.at(is_right ? out.columns + c : out.columns - 1 - c, r)];
  return out;
}

}  // namespace

std::vector<std::vector<Vec2>> half_outlines(const LayerGrid& grid, const LayerMask& mask,
                                             bool is_right) {
  const HalfCells cells = half_of(grid, mask, is_right);
  const std::vector<std::size_t> lines = lines_through_holes(cells);
  std::uint32_t count = 0;
  const HalfCells parts = numbered(cells, true, lines, count);
  std::vector<std::vector<Vec2>> out;
  for (std::uint32_t part = 1; part <= count; ++part)
    out.push_back(smooth_border(traced(parts, part), lines, grid.cell_mm));
  return out;
}

double foot_mm(const LayerGrid& grid, const LayerMask& mask, bool is_right) {
  const HalfCells cells = half_of(grid, mask, is_right);
  std::size_t c = 0;
  while (c < cells.columns && cells.part[c] != 0) ++c;
  return static_cast<double>(c) * grid.cell_mm;
}

}  // namespace popcut
