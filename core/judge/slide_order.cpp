// SPDX-License-Identifier: MIT
#include "core/judge/slide_order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace popcut::judge {
namespace {

constexpr double kMeeting_mm = 2e-3;  ///< rounding of files and poses
constexpr double kParallel = 1e-6, kOnePlane_mm = 0.01;

/// Which of two pieces may come after the other.
struct Pair {
  bool second_after{true}, first_after{true};

  void meet(const PaperReach& first, const PaperReach& second) {
    if (first.low > first.high || second.low > second.high) return;
    if (first.high > second.low + kMeeting_mm) second_after = false;
    if (second.high > first.low + kMeeting_mm) first_after = false;
  }
};

std::vector<double> places_along(const UprightPiece& piece, double turn, double by) {
  std::vector<double> out;
  for (const std::vector<Vec2>& face : piece.faces)
    for (const Vec2& p : face) out.push_back(turn * p.x() + by);
  return out;
}

/// Both in one plane: they meet wherever both have paper above one another.
void meet_in_plane(const UprightPiece& a, const UprightPiece& b, Pair& pair) {
  const double turn = dot(a.along, b.along) > 0.0 ? 1.0 : -1.0;
  const double by = dot(Vec3(b.origin - a.origin), a.along);
  std::vector<double> at = places_along(a, 1.0, 0.0);
  const std::vector<double> more = places_along(b, turn, by);
  at.insert(at.end(), more.begin(), more.end());
  std::sort(at.begin(), at.end());
  for (std::size_t k = 0; k + 1 < at.size(); ++k) {
    if (at[k + 1] - at[k] < kMeeting_mm) continue;
    const double middle = 0.5 * (at[k] + at[k + 1]);
    pair.meet(reach_at(a, middle), reach_at(b, turn * (middle - by)));
  }
}

Pair pair_of(const UprightPiece& a, const UprightPiece& b, const Vec3& up) {
  Pair pair;
  const auto cross_above = [&](const Vec3& p, const Vec3& q) { return dot(up, Vec3(cross(p, q))); };
  const double turn = cross_above(a.along, b.along);
  const Vec3 between = b.origin - a.origin;
  if (std::abs(turn) < kParallel) {
    if (std::abs(cross_above(a.along, between)) < kOnePlane_mm) meet_in_plane(a, b, pair);
    return pair;
  }
  pair.meet(reach_at(a, cross_above(between, b.along) / turn),
            reach_at(b, cross_above(between, a.along) / turn));
  return pair;
}

}  // namespace

PaperReach reach_at(const UprightPiece& piece, double at_mm) {
  constexpr double kFar_mm = std::numeric_limits<double>::infinity();
  PaperReach out{kFar_mm, -kFar_mm};
  for (const std::vector<Vec2>& face : piece.faces)
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Vec2 &a = face[k], &b = face[(k + 1) % face.size()];
      if ((a.x() < at_mm) == (b.x() < at_mm)) continue;
      const double high = a.y() + (at_mm - a.x()) / (b.x() - a.x()) * (b.y() - a.y());
      out.low = std::min(out.low, high), out.high = std::max(out.high, high);
    }
  return out;
}

Result<std::vector<std::vector<std::size_t>>> slide_order(const std::vector<UprightPiece>& pieces,
                                                          const Vec3& up,
                                                          std::vector<std::size_t>& stuck) {
  const std::size_t n = pieces.size();
  stuck.clear();
  std::vector<std::vector<std::size_t>> after(n);
  std::vector<std::size_t> waits(n, 0);
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b) {
      const Pair pair = pair_of(pieces[a], pieces[b], up);
      if (pair.second_after && pair.first_after) continue;
      if (!pair.second_after && !pair.first_after) {
        stuck = {a, b};
        return fail(ErrorKind::Infeasible, "", "cannot come down past each other");
      }
      after[pair.second_after ? a : b].push_back(pair.second_after ? b : a);
      ++waits[pair.second_after ? b : a];
    }
  std::vector<std::vector<std::size_t>> steps;
  std::size_t placed = 0;
  std::vector<std::size_t> ready;
  for (std::size_t p = 0; p < n; ++p)
    if (waits[p] == 0) ready.push_back(p);
  while (!ready.empty()) {
    placed += ready.size();
    std::vector<std::size_t> next;
    for (const std::size_t p : ready)
      for (const std::size_t q : after[p])
        if (--waits[q] == 0) next.push_back(q);
    std::sort(next.begin(), next.end());
    steps.push_back(std::move(ready));
    ready = std::move(next);
  }
  if (placed == n) return steps;
  for (std::size_t p = 0; p < n; ++p)
    if (waits[p] > 0) stuck.push_back(p);
  return fail(ErrorKind::Infeasible, "", "wait for each other in a circle");
}

}  // namespace popcut::judge
