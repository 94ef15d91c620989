// SPDX-License-Identifier: MIT
#include <cmath>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "core/drawing/clean.hpp"
#include "core/drawing/collinear.hpp"
#include "core/drawing/near_lines.hpp"
#include "core/geometry/angle.hpp"
#include "core/geometry/overlap.hpp"

namespace crowding_property_test {

using namespace popcut;

namespace {

/// Segments on few lines, of short and long ones, some a little beside the line, some drawn
/// backwards, and some anywhere.
struct Draft {
  std::vector<PagePoint> nodes;
  std::vector<NodeEdge> edges;

  void add(const PagePoint& a, const PagePoint& b) {
    const auto n = static_cast<std::uint32_t>(nodes.size());
    nodes.insert(nodes.end(), {a, b});
    edges.push_back({n, n + 1});
  }
  [[nodiscard]] Segment at(std::size_t e) const { return {nodes[edges[e].a], nodes[edges[e].b]}; }
};

Draft random_draft(std::mt19937& random, double size, double longest) {
  std::uniform_real_distribution<double> chance(0, 1);
  const double angles[] = {0.0, 1e-4, 3.1415, 1.5707963267948966, 3.14159265 * chance(random)};
  Draft draft;
  for (int line = 0; line < 12; ++line) {
    const double angle = angles[random() % 5], x = size * chance(random), y = size * chance(random);
    const double ux = std::cos(angle), uy = std::sin(angle);
    for (int k = 0; k < 8; ++k) {
      const double from = size * (chance(random) - 0.5), aside = 0.03 * (chance(random) - 0.5);
      const double to = from + (chance(random) < 0.5 ? longest : 2.0) * (chance(random) - 0.5);
      const double turn = 0.01 * (chance(random) - 0.5) / std::max(1.0, std::abs(to - from));
      draft.add({x + from * ux - aside * uy, y + from * uy + aside * ux},
                {x + to * ux - (aside + turn) * uy, y + to * uy + (aside + turn) * ux});
    }
  }
  for (int k = 0; k < 30; ++k)
    draft.add({size * chance(random), size * chance(random)},
              {size * chance(random), size * chance(random)});
  return draft;
}

}  // namespace

TEST_CASE("all edges that overlap another are checked again", "[core][plan][clean]") {
  std::size_t sharing = 0, marked = 0, all = 0;
  for (std::uint32_t seed = 1; seed <= 120; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    const double size = seed % 3 == 0 ? 20'000 : seed % 3 == 1 ? 300 : 20;
    const Draft draft = random_draft(random, size, seed % 2 == 0 ? 4.0 : size / 3);
    const auto crowded = crowded_edges(draft.edges, draft.nodes, kOverlapTolerance);
    REQUIRE(crowded.size() == draft.edges.size());
    for (std::size_t s = 0; s < crowded.size(); ++s) {
      bool shares = false;
      const double l = distance(draft.at(s).a, draft.at(s).b);
      const auto tiny = [&](std::size_t e) { return distance(draft.at(e).a, draft.at(e).b) < 0.1; };
      for (std::size_t t = 0; t < crowded.size() && !tiny(s); ++t) {
        double from = 0.0, to = 0.0;
        if (t == s || tiny(t) || !overlap(draft.at(s), l, draft.at(t), kOverlapTolerance, from, to))
          continue;
        shares = true;
        CAPTURE(s, t, from, to);
        CHECK(int{crowded[s]} + int{crowded[t]} == 2);
      }
      sharing += shares ? 1 : 0;
      marked += crowded[s];
      ++all;
    }
  }
  CHECK(sharing > 1500);
  CHECK(marked < 2 * sharing);
  CHECK(marked < all);
}

TEST_CASE(
    "what runs beside other lines is the same wherever the drawing lies and however it is turned",
    "[core][plan][clean]") {
  constexpr double kWithin = 0.3, kStep = 0.25;
  double found = 0.0;
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> chance(0, 1);
    std::vector<std::vector<PagePoint>> lines;
    for (int k = 0; k < 60; ++k) {
      std::vector<PagePoint> line{{80 * chance(random), 80 * chance(random)}};
      double turn = 2 * kPi * chance(random);
      for (int corner = 0; corner < 1 + k % 4; ++corner) {
        const double mm = 2 + 20 * chance(random);
        line.push_back({line.back().x + mm * std::cos(turn), line.back().y + mm * std::sin(turn)});
        turn += chance(random) - 0.5;
      }
      lines.push_back(line);
      // Its twin beside it; a little shorter, so that their order is certain.
      if (k % 3 != 0) continue;
      for (PagePoint& p : line) p = {p.x + 0.1, p.y + 0.1 * chance(random)};
      line.back() = between(line.back(), line[line.size() - 2], 0.1);
      lines.push_back(line);
    }
    const auto moved = [&](double angle, double dx, double dy) {
      LineWork work;
      for (std::vector<PagePoint> line : lines) {
        for (PagePoint& p : line)
          p = {dx + p.x * std::cos(angle) - p.y * std::sin(angle),
               dy + p.x * std::sin(angle) + p.y * std::cos(angle)};
        work.append(Operation::Cut, line);
      }
      return doubled_lines(work, kWithin);
    };
    const DoubledLines still = moved(0, 0, 0);
    CHECK(still.doubled_mm > 50.0);
    CHECK(still.apart_mm <= kWithin);
    found += still.doubled_mm;
    for (int k = 0; k < 6; ++k) {
      const DoubledLines other =
          moved(2 * kPi * chance(random), 3000 * (chance(random) - 0.5), 500 * chance(random));
      // A step at the limit may fall to either side by rounding.
      CHECK(other.doubled_mm == Approx(still.doubled_mm).margin(2 * kStep));
      CHECK(other.apart_mm == Approx(still.apart_mm).margin(0.01));
    }
  }
  CHECK(found > 3000.0);
}

}  // namespace crowding_property_test
