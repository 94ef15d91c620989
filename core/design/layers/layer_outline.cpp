// SPDX-License-Identifier: MIT
#include "core/design/layers/layer_outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace popcut {
namespace {

struct Corner {
  std::ptrdiff_t x{}, y{};
  friend bool operator==(const Corner&, const Corner&) = default;
};

/// The corners around the piece that begins at (0, 0), counter-clockwise, paper on the left.
std::vector<Corner> traced(std::size_t columns, std::size_t rows, const LayerMask& half) {
  const auto paper = [&](std::ptrdiff_t x, std::ptrdiff_t y) {
    return x >= 0 && y >= 0 && x < static_cast<std::ptrdiff_t>(columns) &&
           y < static_cast<std::ptrdiff_t>(rows) &&
           half[static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x)] != 0;
  };
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
  std::vector<Corner> out;
  Corner at{0, 0};
  int d = 0;
  do {
    out.push_back(at);
    at = {at.x + kSteps[static_cast<std::size_t>(d)].x,
          at.y + kSteps[static_cast<std::size_t>(d)].y};
    for (const int turn : {1, 0, 3}) {
      const int next = (d + turn) % 4;
      if (left(at, next) && !right(at, next)) {
        d = next;
        break;
      }
    }
  } while (!(at == Corner{0, 0}) && out.size() < 8 * columns * rows);
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

}  // namespace

std::vector<Vec2> half_outline(const LayerGrid& grid, const LayerMask& mask, bool is_right) {
  const std::size_t columns = grid.columns / 2;
  LayerMask half(columns * grid.rows);
  for (std::size_t r = 0; r < grid.rows; ++r)
    for (std::size_t c = 0; c < columns; ++c)
      half[r * columns + c] = mask[grid.at(is_right ? columns + c : columns - 1 - c, r)];
  const std::vector<Corner> corners = traced(columns, grid.rows, half);
  // Corners on the middle and on the page stay; of other sides the middles do.
  std::vector<Vec2> points;
  std::vector<std::size_t> fixed;
  const auto on_border = [](const Corner& at) { return at.x == 0 || at.y == 0; };
  const auto place = [&](double x, double y) { return Vec2{x * grid.cell_mm, y * grid.cell_mm}; };
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Corner &a = corners[k], &b = corners[(k + 1) % corners.size()];
    if (on_border(a)) {
      fixed.push_back(points.size());
      points.push_back(place(static_cast<double>(a.x), static_cast<double>(a.y)));
    }
    if (!on_border(a) || !on_border(b) || (a.x != b.x && a.y != 0) || (a.y != b.y && a.x != 0))
      points.push_back(
          place(0.5 * static_cast<double>(a.x + b.x), 0.5 * static_cast<double>(a.y + b.y)));
  }
  for (const double most : {0.75, 0.4, 0.0}) {
    std::vector<Vec2> out;
    for (std::size_t k = 0; k < fixed.size(); ++k) {
      const std::size_t from = fixed[k];
      out.push_back(points[from]);
      if (k + 1 < fixed.size()) {
        simplify(points, from, fixed[k + 1], most * grid.cell_mm, out);
        continue;
      }
      std::vector<Vec2> last(points.begin() + static_cast<std::ptrdiff_t>(from), points.end());
      last.push_back(points[fixed.front()]);
      simplify(last, 0, last.size() - 1, most * grid.cell_mm, out);
    }
    // Corners in the run of the middle or of the page are none.
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

}  // namespace popcut
