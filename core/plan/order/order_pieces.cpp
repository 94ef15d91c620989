// SPDX-License-Identifier: MIT
// Part of core/plan/order/order_group.hpp.
#include <cmath>

#include "core/geometry/angle.hpp"
#include "core/plan/order/order_group.hpp"

namespace popcut {
namespace {

constexpr std::size_t kMostPieces = 64;

// Whether the path p, q, r turns at q by more than the angle with this cosine.
bool sharp(const PagePoint& p, const PagePoint& q, const PagePoint& r, double cosine) {
  const double ux = q.x - p.x, uy = q.y - p.y, wx = r.x - q.x, wy = r.y - q.y;
  return ux * wx + uy * wy < cosine * std::hypot(ux, uy) * std::hypot(wx, wy);
}

// The vertices at which to split a line, in order.
std::vector<std::uint32_t> corners(std::span<const PagePoint> points, double cosine) {
  std::vector<std::uint32_t> at;
  const auto n = static_cast<std::uint32_t>(points.size());
  if (closed(points) && sharp(points[n - 2], points[0], points[1], cosine)) at.push_back(0);
  for (std::uint32_t i = 1; i + 1 < n; ++i)
    if (sharp(points[i - 1], points[i], points[i + 1], cosine)) at.push_back(i);
  if (closed(points) && at.size() == 1) {
    // With one part, the line would be closed again and could start anywhere.
    const std::uint32_t other = (at[0] + (n - 1) / 2) % (n - 1);
    at.insert(other < at[0] ? at.begin() : at.end(), other);
  }
  return at;
}

// Appends the parts of a line between its corners.
void append_pieces(const LineWork& work, std::uint32_t line, std::vector<std::uint32_t> at,
                   LinePieces& out) {
  const auto points = work.points_of(work.lines[line]);
  const auto last = static_cast<std::uint32_t>(points.size()) - 1;
  if (closed(points)) {
    at.push_back(at.front() + last);  // all the way round
  } else {
    at.insert(at.begin(), 0);
    at.push_back(last);
  }
  const std::uint32_t round = closed(points) ? last : last + 1;
  std::vector<PagePoint> piece;
  for (std::size_t i = 0; i + 1 < at.size(); ++i) {
    piece.clear();
    for (std::uint32_t v = at[i]; v <= at[i + 1]; ++v) piece.push_back(points[v % round]);
    out.work.append(work.lines[line].operation, piece);
    out.origin.push_back({line, at[i], false});
  }
}

}  // namespace

Visit LinePieces::visit_of(const Visit& visit) const {
  const Origin& from = origin[visit.line];
  if (from.whole) return {from.line, visit.reversed, visit.start, 0};
  return {from.line, visit.reversed, from.first, work.lines[visit.line].count};
}

LinePieces split_at_corners(const LineWork& work, const Nesting& nesting, double corner_deg) {
  const double cosine = std::cos(radians(corner_deg));
  std::vector<std::uint8_t> holds(work.lines.size(), 0);
  for (const std::uint32_t holder : nesting.holders) holds[holder] = 1;
  LinePieces out;
  out.first_piece.push_back(0);
  for (std::uint32_t line = 0; line < work.lines.size(); ++line) {
    const DrawnLine& drawn = work.lines[line];
    std::vector<std::uint32_t> at;
    if (is_cut(drawn.operation)) at = corners(work.points_of(drawn), cosine);
    if (at.empty() || (holds[line] != 0 && at.size() > kMostPieces)) {
      out.work.append(drawn.operation, work.points_of(drawn));
      out.origin.push_back({line, 0, true});
    } else {
      append_pieces(work, line, at, out);
    }
    out.first_piece.push_back(static_cast<std::uint32_t>(out.work.lines.size()));
  }
  return out;
}

Nesting nesting_of_pieces(const LinePieces& pieces, const Nesting& nesting) {
  Nesting out;
  out.first.push_back(0);
  for (const LinePieces::Origin& from : pieces.origin) {
    for (const std::uint32_t holder : nesting.around(from.line))
      for (std::uint32_t p = pieces.first_piece[holder]; p < pieces.first_piece[holder + 1]; ++p)
        out.holders.push_back(p);
    out.first.push_back(static_cast<std::uint32_t>(out.holders.size()));
  }
  return out;
}

}  // namespace popcut
