// SPDX-License-Identifier: MIT
#include <cmath>
#include <random>
#include <vector>

#include <catch2/catch.hpp>

#include "core/compare/comparison.hpp"
#include "tests/support/boxes.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/rounds.hpp"

namespace compare_property_test {

using namespace popcut;
using namespace popcut::likeness;
using namespace popcut::testing;
using Catch::WithinAbs;
using Catch::WithinRel;

namespace {

Vec3 random_direction(std::mt19937& random) {
  const double z = uniform(random, -1, 1), turn = uniform(random, 0, 2 * M_PI);
  const double across = std::sqrt(1 - z * z);
  return {across * std::cos(turn), across * std::sin(turn), z};
}

Vec3 corner_at(const std::vector<float>& corners, std::size_t k) {
  return {static_cast<double>(corners[k]), static_cast<double>(corners[k + 1]),
          static_cast<double>(corners[k + 2])};
}

struct Hit {
  double depth{-INFINITY};
  double margin_mm{INFINITY};  ///< of the ray from the nearest edge that it passes
};

/// The nearest triangle along a ray toward the eye, by Moller and Trumbore (1997), and how close
/// the ray comes to any edge.
Hit cast(const std::vector<float>& corners, const Vec3& from, const Vec3& way) {
  Hit hit;
  for (std::size_t k = 0; k + 8 < corners.size(); k += 9) {
    const Vec3 a = corner_at(corners, k), b = corner_at(corners, k + 3),
               c = corner_at(corners, k + 6);
    for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
      // Both lines seen along the ray: a segment and a point.
      const Vec3 along = (q - p) - dot(Vec3(q - p), way) * way;
      const Vec3 off = (from - p) - dot(Vec3(from - p), way) * way;
      const double square = dot(along, along);
      const double t = square > 0 ? std::clamp(dot(off, along) / square, 0.0, 1.0) : 0.0;
      hit.margin_mm = std::min(hit.margin_mm, norm(Vec3(off - t * along)));
    }
    const Vec3 e1 = b - a, e2 = c - a, h = cross(way, e2);
    const double det = dot(e1, h);
    if (std::abs(det) < 1e-12) continue;
    const Vec3 s = from - a;
    const double u = dot(s, h) / det;
    const Vec3 q = cross(s, e1);
    const double v = dot(way, q) / det;
    if (u < 0 || v < 0 || u + v > 1) continue;
    hit.depth = std::max(hit.depth, dot(e2, q) / det);
  }
  return hit;
}

std::vector<float> random_triangles(std::mt19937& random, int count, double size_mm) {
  std::vector<float> out;
  for (int k = 0; k < count; ++k) {
    const Vec3 at(uniform(random, 0, 100), uniform(random, 0, 100), uniform(random, 0, 100));
    for (int corner = 0; corner < 3; ++corner)
      for (int i = 0; i < 3; ++i)
        out.push_back(static_cast<float>(at[i] + uniform(random, -size_mm, size_mm)));
  }
  return out;
}

}  // namespace

TEST_CASE("images of random triangles are those that rays find", "[core][compare]") {
  std::mt19937 random(20);
  for (int round = 0; round < rounds(6, 2); ++round) {
    CAPTURE(round);
    // From slivers between pixels to triangles that reach far beyond the image.
    const double size = std::array{2.0, 30.0, 3000.0}.at(static_cast<std::size_t>(round % 3));
    const auto triangles = random_triangles(random, 24, size);
    const Frame frame{view_from(random_direction(random)), Vec3(50, 50, 50), 160, 24};
    DepthImage image;
    draw(frame, triangles, image);
    const double pitch = frame.pitch_mm();
    std::size_t compared = 0;
    for (int row = 0; row < frame.pixels; ++row)
      for (int column = 0; column < frame.pixels; ++column) {
        const Vec3 from = frame.centre +
                          (pitch * (column + 0.5) - 0.5 * frame.side_mm) * frame.view.right +
                          (pitch * (row + 0.5) - 0.5 * frame.side_mm) * frame.view.up;
        const Hit hit = cast(triangles, from, frame.view.toward);
        if (hit.margin_mm < 2e-3 * pitch) continue;  // the grid of the corners: 1/4096
        ++compared;
        const auto found = static_cast<double>(image.at(column, row));
        if (std::isinf(hit.depth))
          REQUIRE(found == hit.depth);
        else  // as steep as a triangle is seen, its corners' places in the grid count so much
          REQUIRE_THAT(found, WithinAbs(hit.depth, 2e-3 * size + 1e-3));
      }
    CHECK(compared > 400);
  }
}

TEST_CASE("figures are shares, and both ways of the contour are one", "[core][compare]") {
  std::mt19937 random(21);
  // Both scenes have the same box, so that both look from the same distance.
  const std::vector<float> pins{0,   0,   0,   0.5,  0,   0,   0,   0.5,  0,
                                100, 100, 100, 99.5, 100, 100, 100, 99.5, 100};
  for (int round = 0; round < rounds(20); ++round) {
    CAPTURE(round);
    auto a = random_boxes(random, whole(random, 1, 6)),
         b = random_boxes(random, whole(random, 1, 6));
    append(a, pins), append(b, pins);
    const Scene scene{cone_views(), 96,
                      round % 2 == 0 ? std::optional<Corner>(Corner{}) : std::nullopt};
    const Target to_a(a, scene), to_b(b, scene);
    const Figures ab = to_a.measure(b), ba = to_b.measure(a);
    CHECK_THAT(ab.contour_mm, WithinRel(ba.contour_mm, 1e-9));
    CHECK_THAT(ab.mean_mm, WithinRel(ba.mean_mm, 1e-9));
    for (const Figures* one : {&ab, &ba}) {
      CHECK(one->cover >= 0.0);
      CHECK(one->cover <= 1.0);
      CHECK(one->mean_mm <= one->diagonal_mm * 1.25);
      CHECK(one->error() > 0.0);
    }
    CHECK(to_a.measure(a).error() == 0.0);
    CHECK(to_b.measure(b).error() == 0.0);
  }
}

TEST_CASE("moving both scenes together changes no figure", "[core][compare]") {
  std::mt19937 random(22);
  for (int round = 0; round < rounds(12); ++round) {
    CAPTURE(round);
    const auto a = random_boxes(random, 4);
    auto b =
        shifted(a, Vec3(uniform(random, -3, 3), uniform(random, -3, 3), uniform(random, -3, 3)));
    const Vec3 by(uniform(random, -500, 500), uniform(random, -500, 500),
                  uniform(random, -500, 500));
    // Without the corner, which stays where it is.
    const Scene scene{cone_views(), 128, std::nullopt};
    const Figures here = Target(a, scene).measure(b);
    const Figures there = Target(shifted(a, by), scene).measure(shifted(b, by));
    // Pixels on a border may fall on the other side of it.
    CHECK_THAT(there.mean_mm, WithinRel(here.mean_mm, 0.02));
    CHECK_THAT(there.contour_mm, WithinAbs(here.contour_mm, 0.02 * here.contour_mm + 0.02));
    CHECK_THAT(there.cover, WithinAbs(here.cover, 0.005));
    // Along the spine with the corner.
    const Scene with_corner{cone_views(), 128, Corner{}};
    const Vec3 along(0, by.y(), 0);
    const Figures first = Target(a, with_corner).measure(b);
    const Figures second = Target(shifted(a, along), with_corner).measure(shifted(b, along));
    CHECK_THAT(second.mean_mm, WithinRel(first.mean_mm, 0.02));
    CHECK_THAT(second.cover, WithinAbs(first.cover, 0.005));
  }
}

TEST_CASE("one target serves any number of structures with the same buffers", "[core][compare]") {
  std::mt19937 random(23);
  const Target target(random_boxes(random, 5), {cone_views(), 64, Corner{}});
  Buffers buffers;
  for (int round = 0; round < rounds(20); ++round) {
    const auto structure = random_boxes(random, whole(random, 0, 5));
    const Figures kept = target.measure(structure, buffers), fresh = target.measure(structure);
    CHECK(kept.error() == fresh.error());
    CHECK(kept.p95_mm == fresh.p95_mm);
  }
}

}  // namespace compare_property_test
