// SPDX-License-Identifier: MIT
// Books of random shells: sound, one movement a card, cards apart at every opening, shut inside.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/book_fit.hpp"
#include "core/design/patches.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/verify/book.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/value.hpp"

namespace book_property_test {

using namespace popcut;

namespace {

/// A tube about a place near the spine, with bulges all around.
TriangleMesh shell(std::mt19937& random) {
  constexpr int kAround = 72, kAlong = 40;
  constexpr double kLength_mm = 80.0;
  std::uniform_real_distribution<double> part(0.0, 1.0);
  const double x = 12.0 * part(random) - 6.0, z = 12.0 * part(random) - 6.0;
  const double radius = 30.0 + 10.0 * part(random), bulge = 5.0 * part(random);
  const double lobes = std::floor(1.0 + 4.0 * part(random)), twist = 6.0 + 10.0 * part(random);
  const double wave = 4.0 * part(random), pitch = 8.0 + 10.0 * part(random);
  const auto at = [&](int i, int j) {
    const double turn = 2.0 * std::numbers::pi * (i % kAround) / kAround;
    const double y = kLength_mm * j / kAlong - 0.25 * kLength_mm;
    const double r =
        radius + bulge * std::sin(lobes * turn + y / twist) + wave * std::cos(y / pitch);
    return std::array{x + r * std::cos(turn), y, z + r * std::sin(turn)};
  };
  TriangleMesh out;
  const auto add = [&](const std::array<double, 3>& p) {
    for (const double value : p) out.corners.push_back(static_cast<float>(value));
  };
  for (int j = 0; j < kAlong; ++j)
    for (int i = 0; i < kAround; ++i) {
      for (const auto& [di, dj] : {std::pair(0, 0), std::pair(0, 1), std::pair(1, 1)})
        add(at(i + di, j + dj));
      for (const auto& [di, dj] : {std::pair(0, 0), std::pair(1, 1), std::pair(1, 0)})
        add(at(i + di, j + dj));
    }
  return out;
}

/// Directions, seen from the spine, in which a card's faces are when all cards are open to `psi`.
/// Looked at in many points of each face, from the pattern alone.
void check_in_wedge(const Pattern& pattern, std::size_t card, double psi) {
  const double from = static_cast<double>(card) * psi;
  const auto places = posed_vertices(pattern, psi);
  double least = 0.0, most = 0.0;
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    const auto face = pattern.face(f);
    for (std::size_t k = 0; k < face.size(); ++k)
      for (const double share : {0.0, 0.3, 0.7}) {
        const auto &a = places[face[k]], &b = places[face[(k + 1) % face.size()]];
        const double x = a[0] + share * (b[0] - a[0]), z = a[2] + share * (b[2] - a[2]);
        // In the book: turned on by the cards before.
        const double bx = x * std::cos(from) - z * std::sin(from);
        const double bz = x * std::sin(from) + z * std::cos(from);
        least = std::min(least, std::cos(from) * bz - std::sin(from) * bx);  // from the ground
        most = std::max(most, std::cos(from + psi) * bz - std::sin(from + psi) * bx);
      }
  }
  CHECK(least > -1e-9);
  CHECK(most < 1e-9);
}

}  // namespace

TEST_CASE("books of random shells are sound, with cards that never meet and that shut inside",
          "[property][design][verify][book]") {
  std::mt19937 random(20);
  for (int round = 0; round < testing::rounds(18, 3); ++round) {
    const int cards = 3 + round % 6;
    const std::string text = fmt::format(
        R"({{"popcut":1,"surface":{{"type":"mesh","file":"tube.stl"}},"rotate_deg":[0,0,0],
            "translate_mm":[0,0,0],"units_per_slice":{},"slices":{},"widths_mm":6,
            "book":{{"cards":{}}}}})",
        2 + round % 5, 4 + round % 7, cards);
    CAPTURE(text);
    const auto spec = testing::value(parse_design_spec(text));
    const auto book =
        testing::value(design_assembly(spec, {{"tube.stl", testing::binary_stl(shell(random))}}));
    std::vector<std::string> folds;
    std::vector<VerifiedCard> to_verify;
    for (const Design& card : book.parts) {
      std::ostringstream fold;
      REQUIRE(write_fold(card.pattern, {}, fold));
      folds.push_back(std::move(fold).str());
    }
    for (std::size_t i = 0; i < folds.size(); ++i)
      to_verify.push_back({fmt::format("card {}", i + 1), folds[i]});
    const auto report = testing::value(verify_book(to_verify));
    INFO(verify_text(report));
    CHECK(report.ok());
    CHECK(report.open_deg == Approx(360.0));
    for (const VerifyReport& card : report.cards) CHECK(card.degrees_of_freedom == 1);
    // By other means than the verifier's.
    const double whole = 2.0 * std::numbers::pi / cards;
    for (std::size_t i = 0; i < book.parts.size(); ++i)
      for (const double part : {0.02, 0.31, 0.77, 1.0})
        check_in_wedge(book.parts[i].pattern, i, part * whole);
    for (const Design& card : book.parts)
      for (const auto& [x, v, z] : posed_vertices(card.pattern, 0.0)) {
        CHECK(x <= book.book->page_mm + 1e-9);
        CHECK(v >= 0.0);
        CHECK(v <= book.book->width_mm + 1e-9);
        CHECK(std::abs(z) < 1e-9);
      }
    const auto fit = testing::value(book_fit(book));
    CHECK(fit.share_within[2] > 0.25);  // slices are 24 to 60 mm of 80
  }
}

}  // namespace book_property_test
