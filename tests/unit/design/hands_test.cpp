// SPDX-License-Identifier: MIT
// What paper and hands add to a card: how firmly its panels hold, and what it costs to fold it.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <catch2/catch.hpp>

#include "core/design/facets/facets.hpp"
#include "core/design/facets/silhouette.hpp"
#include "core/design/patches.hpp"
#include "core/design/spec/spec.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/hands/envelope.hpp"
#include "core/hands/fold_guide.hpp"
#include "core/hands/folding.hpp"
#include "core/hands/strip.hpp"
#include "core/hands/waste.hpp"
#include "core/hands/wobble.hpp"
#include "core/judge/sound_design.hpp"
#include "core/machines/machine.hpp"
#include "core/print/fold_guide_pages.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/box_card.hpp"
#include "tests/support/boxes.hpp"
#include "tests/support/random_lattice.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/value.hpp"

namespace hands_test {

using namespace popcut;

// ---- the same by other means: folds are drawn off their lines, and the panels laid to fit best

/// The root mean square over `draws` of how far each face's farthest corner is from its place.
std::vector<double> drawn_wobble(const Pattern& pattern, int draws, std::mt19937& random) {
  const auto faces = static_cast<int>(pattern.faces());
  const double far_mm = pattern.wall_mm + pattern.ground_mm;
  std::vector<int> first(pattern.faces(), -1);
  int unknowns = 0;
  for (int f = 0; f < faces; ++f) {
    const auto at = static_cast<std::size_t>(f);
    const bool is_card = std::ranges::any_of(pattern.face(at), [&](std::uint32_t corner) {
      const double u = pattern.u(pattern.vertices[corner]);
      return u < 1e-6 || u > far_mm - 1e-6;
    });
    if (!is_card) first[at] = unknowns, unknowns += 3;
  }
  struct Line {
    double length_mm{};
  };
  std::vector<Line> lines;
  Eigen::MatrixXd rows(2 * pattern.edges.size(), unknowns);
  rows.setZero();
  for (const PatternEdge& e : pattern.edges) {
    if (e.role != EdgeRole::Mountain && e.role != EdgeRole::Valley) continue;
    const PatternVertex& p = pattern.vertices[e.from];
    const auto row = static_cast<Eigen::Index>(2 * lines.size());
    for (const auto& [face, sign] : {std::pair{e.left, 1.0}, {e.right, -1.0}}) {
      const int at = first[static_cast<std::size_t>(face)];
      if (at < 0) continue;
      rows(row, at) = sign, rows(row, at + 2) = -sign * p.z;
      rows(row + 1, at + 1) = sign, rows(row + 1, at + 2) = sign * p.x;
    }
    lines.push_back({std::abs(pattern.vertices[e.to].v - p.v)});
  }
  rows.conservativeResize(static_cast<Eigen::Index>(2 * lines.size()), unknowns);
  const hands::Play play;
  Eigen::VectorXd weight(rows.rows());
  for (Eigen::Index r = 0; r < rows.rows(); ++r)
    weight[r] = std::sqrt(
        std::min(1.0, lines[static_cast<std::size_t>(r / 2)].length_mm / play.short_fold_mm));
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(weight.asDiagonal() * rows);
  std::normal_distribution<double> normal;
  std::vector<std::vector<double>> squares(pattern.faces());
  for (std::size_t f = 0; f < pattern.faces(); ++f) squares[f].assign(pattern.face(f).size(), 0.0);
  for (int d = 0; d < draws; ++d) {
    Eigen::VectorXd off(rows.rows());
    for (Eigen::Index r = 0; r < rows.rows(); r += 2) {
      // The line as a whole, and the middle of its two ends; what moves it along the sheet moves
      // the edge of both panels.
      const double by =
          play.line_mm * normal(random) + 0.5 * play.end_mm * (normal(random) + normal(random));
      off[r] = off[r + 1] = by;  // a shorter fold has the larger error 1 / weight, times its weight
    }
    const Eigen::VectorXd moved = solver.solve(off);
    for (std::size_t f = 0; f < pattern.faces(); ++f) {
      if (first[f] < 0) continue;
      const double a = moved[first[f]], c = moved[first[f] + 1], w = moved[first[f] + 2];
      for (std::size_t k = 0; k < squares[f].size(); ++k) {
        const PatternVertex& p = pattern.vertices[pattern.face(f)[k]];
        squares[f][k] += std::pow(a - w * p.z, 2) + std::pow(c + w * p.x, 2);
      }
    }
  }
  std::vector<double> out;
  for (const std::vector<double>& face : squares)
    out.push_back(std::sqrt(std::ranges::max(face) / draws));
  return out;
}

/// Boxes, and pyramids on some of them, cut out as layers.
FacetCard silhouette_of(std::mt19937& random, int layers, double min_fold_mm, bool rough = false) {
  TriangleSoup soup;
  for (int k = 0; k < 4; ++k) {
    const double x0 = testing::uniform(random, 0, 30), x = x0 + testing::uniform(random, 10, 30),
                 v = testing::uniform(random, 0, 60), w = testing::uniform(random, 15, 40),
                 z0 = k % 2 == 0 ? 0.0 : testing::uniform(random, 0, 20),
                 z = z0 + testing::uniform(random, 15, 40);
    soup.add({x, v, z0}, {x, v + w, z0}, {x, v + w, z});
    soup.add({x, v, z0}, {x, v + w, z}, {x, v, z});
    soup.add({x, v, z}, {x, v + w, z}, {(x0 + x) / 2, v + w / 2, z + 10});
    soup.add({x0, v, z}, {x, v, z}, {(x0 + x) / 2, v + w / 2, z + 10});
    soup.add({x0, v, z}, {x0, v + w, z}, {x, v + w, z});
  }
  FacetOptions options;
  options.to_mm = 100, options.pitch_mm = options.strip_mm = 1;
  options.layers = layers, options.min_fold_mm = min_fold_mm, options.rough = rough;
  return testing::value(facet_card(soup, options));
}

/// Boxes and slopes at random places, as facets.
FacetCard card_of(std::mt19937& random, bool in_paper) {
  std::uniform_real_distribution<double> any(0.0, 1.0);
  TriangleSoup soup;
  for (int k = 0; k < 3; ++k) {
    const double v = 30.0 * k, x = 20 + 20 * any(random), z = 15 + 25 * any(random);
    soup.add({x, v, 0}, {x, v + 24, 0}, {x, v + 24, z}, {x, v, z});
    soup.add({x, v, z}, {x, v + 24, z}, {x / 2, v + 12, z + 15 * any(random)});
    soup.add({0, v, z}, {x, v, z}, {x, v + 24, z}, {0, v + 24, z});
  }
  FacetOptions options;
  options.to_mm = 84, options.pitch_mm = 1, options.strip_mm = 3, options.in_paper = in_paper;
  return testing::value(facet_card(soup, options));
}

TEST_CASE("wobble is what folds drawn off their lines make of the panels", "[hands]") {
  std::mt19937 random(7);
  std::vector<Pattern> patterns{testing::box_card_pattern(), testing::row_of_boxes(4)};
  for (int k = 0; k < 3; ++k) patterns.push_back(card_of(random, k > 0).pattern.built.pattern);
  std::size_t compared = 0;
  for (const Pattern& pattern : patterns) {
    const auto wobble = testing::value(hands::wobble_of(pattern));
    const std::vector<double> drawn = drawn_wobble(pattern, 2000, random);
    REQUIRE(wobble.face_mm.size() == drawn.size());
    for (std::size_t f = 0; f < drawn.size(); ++f) {
      INFO("face " << f << " of " << pattern.faces());
      CHECK(wobble.face_mm[f] == Approx(drawn[f]).epsilon(0.1));
      compared += drawn[f] > 0.0 ? 1 : 0;
    }
    CHECK(wobble.largest_mm == Approx(*std::ranges::max_element(wobble.face_mm)));
    CHECK(wobble.mean_mm <= wobble.largest_mm);
  }
  CHECK(compared > 30);
}

TEST_CASE("a level panel whose two folds lie a millimetre apart moves far in paper", "[hands]") {
  // Wall, ground, and a deep level panel that two upright panels hold, `apart` from each other.
  const auto largest_mm = [](double apart) {
    Pattern p;
    p.wall_mm = p.ground_mm = 60, p.width_mm = 30;
    const auto quad = [&](std::vector<PatternVertex> corners) {
      if (p.face_first.empty()) p.face_first.push_back(0);
      for (const PatternVertex& v : corners) {
        p.face_vertices.push_back(static_cast<std::uint32_t>(p.vertices.size()));
        p.vertices.push_back(v);
      }
      p.face_first.push_back(static_cast<std::uint32_t>(p.face_vertices.size()));
    };
    const auto fold = [&](std::int32_t left, std::int32_t right, double x, double z, double v0,
                          double v1) {
      p.vertices.push_back({x, z, v0}), p.vertices.push_back({x, z, v1});
      const auto last = static_cast<std::uint32_t>(p.vertices.size());
      p.edges.push_back({last - 2, last - 1, left, right, EdgeRole::Mountain});
    };
    quad({{0, 60, 0}, {0, 60, 30}, {0, 0, 30}, {0, 0, 0}});        // 0: the wall
    quad({{0, 0, 0}, {0, 0, 30}, {60, 0, 30}, {60, 0, 0}});        // 1: the ground
    quad({{10, 20, 5}, {10, 20, 15}, {40, 20, 15}, {40, 20, 5}});  // 2: the level panel
    quad({{10, 20, 5}, {10, 20, 10}, {10, 0, 10}, {10, 0, 5}});    // 3
    quad({{10 + apart, 20, 10}, {10 + apart, 20, 15}, {10 + apart, 0, 15}, {10 + apart, 0, 10}});
    fold(3, 1, 10, 0, 5, 10), fold(4, 1, 10 + apart, 0, 10, 15);
    fold(2, 3, 10, 20, 5, 10), fold(2, 4, 10 + apart, 20, 10, 15);
    quad({{0, 10, 5}, {0, 10, 15}, {10, 10, 15}, {10, 10, 5}});  // 5: keeps 3 upright
    fold(0, 5, 0, 10, 5, 15), fold(5, 3, 10, 10, 5, 10);
    quad({{0, 5, 5}, {0, 5, 15}, {10 + apart, 5, 15}, {10 + apart, 5, 5}});  // 6: keeps 4
    fold(0, 6, 0, 5, 5, 15), fold(6, 4, 10 + apart, 5, 10, 15);
    const auto wobble = testing::value(hands::wobble_of(p));
    return wobble.face_mm[2];
  };
  CHECK(largest_mm(1) > 3.0);
  CHECK(largest_mm(30) < 0.5);
  CHECK(largest_mm(1) > largest_mm(5));
  CHECK(largest_mm(5) > largest_mm(15));
}

TEST_CASE("facets hold in paper where their spec does not ask for exact geometry", "[hands]") {
  std::mt19937 random(3);
  std::size_t loose_exact = 0;
  for (int k = 0; k < 4; ++k) {
    std::mt19937 same = random;
    const auto exact = hands::wobble_of(card_of(same, false).pattern.built.pattern);
    const auto paper = hands::wobble_of(card_of(random, true).pattern.built.pattern);
    REQUIRE((exact && paper));
    loose_exact += exact->loose;
    INFO("card " << k << ": " << paper->largest_mm << " mm, exact " << exact->largest_mm << " mm");
    CHECK(paper->largest_mm <= exact->largest_mm + 0.5);
    CHECK(paper->loose_share < 0.02);
  }
  CHECK(loose_exact > 0);
}

TEST_CASE("layers of a silhouette lie nearest to what is seen, as every choice of planes shows",
          "[hands]") {
  std::mt19937 random(11);
  const FacetGrid grid{1.0, 12, 24, 1.0, 4, 0.0};
  for (int k = 0; k < 30; ++k) {
    SeenTarget seen{{-12.0, 1.0, 0.0, 1.0, 24, 4}, {}, {}};
    for (std::size_t point = 0; point < 96; ++point) {
      const bool stands = testing::uniform(random, 0, 1) < 0.4;
      const double across = seen.raster.across_mm(point % 24);
      seen.facing.push_back(stands ? Facing::Elsewhere : Facing::Card);
      seen.depth_mm.push_back(static_cast<float>(
          std::abs(across) + (stands ? 2.0 * testing::whole(random, 0, 6) : 0.0)));
    }
    const int layers = 1 + k % 3;
    const FacetPlanes planes = silhouette_planes(seen, grid, layers, 12, 12);
    std::vector<int> chosen;
    for (std::size_t l = 2; l < planes.size(); ++l)
      if (planes[static_cast<Label>(l)].upright)
        chosen.push_back(planes[static_cast<Label>(l)].offset);
    const auto cost = [&](const std::vector<int>& offsets) {
      double sum = 0.0;
      for (std::size_t row = 0; row < 4; ++row)
        for (std::size_t c = 0; c < 24; ++c) {
          if (seen.facing[row * 24 + c] == Facing::Card) continue;
          const double x = std::clamp(std::round(seen.x_mm(row, c)), 1.0, 12.0);
          double least = 1e9;
          for (const int offset : offsets) least = std::min(least, std::abs(offset - x));
          sum += least;
        }
      return sum;
    };
    double least = 1e9;
    for (int a = 1; a <= 12; ++a)
      for (int b = a; b <= (layers > 1 ? 12 : a); ++b)
        for (int c = b; c <= (layers > 2 ? 12 : b); ++c) least = std::min(least, cost({a, b, c}));
    CAPTURE(k, layers, chosen);
    CHECK(cost(chosen) == Approx(least));
  }
}

TEST_CASE("a silhouette has few folds, none shorter than asked, and holds in paper", "[hands]") {
  std::mt19937 random(9);
  const int rounds = testing::rounds(40, 8);
  for (int k = 0; k < rounds; ++k) {
    const int layers = 1 + k % 4;
    const double min_fold_mm = testing::uniform(random, 6.0, 12.0);
    const FacetCard card = silhouette_of(random, layers, min_fold_mm);
    const Pattern& pattern = card.pattern.built.pattern;
    CAPTURE(k, layers, min_fold_mm);
    CHECK(card.pattern.motion.degrees_of_freedom == 1);
    CHECK(card.pattern.motion.pieces == 1);
    const auto wobble = testing::value(hands::wobble_of(pattern));
    CHECK(wobble.largest_mm <= hands::kFirm_mm);
    std::size_t folds = 0;
    for (const SheetLine& line : pattern.lines) {
      if (line.role != EdgeRole::Mountain && line.role != EdgeRole::Valley) continue;
      ++folds;
      const bool is_spine = std::abs(line.u0 - pattern.wall_mm) < 1e-6;
      if (!is_spine) CHECK(std::abs(line.v1 - line.v0) >= min_fold_mm - 1e-6);
    }
    CHECK(folds <= 3 + 10U * static_cast<std::size_t>(layers));
    PatchAssembly made;
    made.parts.emplace_back().pattern = pattern;
    made.parts.back().report.degrees_of_freedom = 1;
    made.parts.back().report.pieces = 1;
    CHECK_FALSE(judge::find_unsound(made));
  }
}

TEST_CASE("layers that need not hold tell how large most cards become", "[hands]") {
  constexpr int kRounds = 8;
  const auto size_mm = [](const FacetCard& card) {
    return card.pattern.built.pattern.wall_mm + card.pattern.built.pattern.ground_mm;
  };
  int equal = 0;
  for (int k = 0; k < kRounds; ++k) {
    CAPTURE(k);
    std::mt19937 random(k), again(k);
    const double held_mm = size_mm(silhouette_of(random, 1 + k % 4, 8.0)),
                 rough_mm = size_mm(silhouette_of(again, 1 + k % 4, 8.0, true));
    CHECK(std::abs(held_mm - rough_mm) < 0.2 * held_mm);
    equal += std::abs(held_mm - rough_mm) < 1e-6 ? 1 : 0;
  }
  CHECK(equal > kRounds / 2);  // of others, pieces are left out or painted over
}

TEST_CASE("paper between a figure and its tail hangs on no fold alone", "[hands]") {
  const auto spec =
      parse_design_spec(R"j({"popcut": 1, "style": "silhouette",
      "surface": {"type": "implicit", "f": ")j"
                        "max(abs(x - 24) - 4, min(max(abs(y - 30) - 18, z - 60), "
                        "min(max(abs(y - 60) - 14, z - 12), max(abs(y - 70) - 4, z - 50))))"
                        R"j("},
      "silhouette": {"layers": 1, "length_mm": 90}})j");
  REQUIRE(spec);
  const auto made = testing::value(design_assembly(*spec, {}));
  const DesignReport& report = made.parts.front().report;
  CHECK(report.degrees_of_freedom == 1);
  REQUIRE(report.wobble);
  CHECK(report.wobble->largest_mm <= hands::kFirm_mm);
}

TEST_CASE("the outline of a silhouette is smooth, and lies where the shape ends", "[hands]") {
  // A disc of 30 mm that faces the diagonal: on the sheet a circle, stretched along u.
  TriangleSoup disc;
  const Vec3 middle(40, 40, 40), right(0, 1, 0), up(-std::sqrt(0.5), 0, std::sqrt(0.5));
  const auto rim = [&](int k) {
    const double turn = k * std::numbers::pi / 60;
    return Vec3(middle + 30 * std::cos(turn) * right + 30 * std::sin(turn) * up);
  };
  for (int k = 0; k < 120; ++k) disc.add(middle, rim(k), rim(k + 1));
  FacetOptions options;
  options.to_mm = 80, options.pitch_mm = options.strip_mm = 1, options.layers = 1;
  const auto card = testing::value(facet_card(disc, options));
  const Pattern& pattern = card.pattern.built.pattern;
  const double margin_mm = card.card.margin_mm;
  std::size_t on_rim = 0;
  for (const SheetLine& line : pattern.lines) {
    if (line.role != EdgeRole::Slit) continue;
    const auto off = [&](double u, double v) {  // from the circle, mm
      return std::abs(std::hypot((u - pattern.wall_mm) / std::sqrt(2.0), v - margin_mm - 40) - 30);
    };
    if (off(line.u0, line.v0) > 3 || off(line.u1, line.v1) > 3) continue;
    ++on_rim;
    CHECK(off(line.u0, line.v0) < 1.2);
    CHECK(off(line.u1, line.v1) < 1.2);
  }
  CHECK(on_rim > 10);
  CHECK(on_rim < 90);  // 240 in steps of a strip
}

TEST_CASE("verify measures the same wobble with code of its own", "[hands][verify]") {
  std::mt19937 random(9);
  std::size_t loose = 0;
  std::vector<Pattern> patterns{testing::box_card_pattern()};
  for (int k = 0; k < 2; ++k) patterns.push_back(card_of(random, k > 0).pattern.built.pattern);
  for (const Pattern& pattern : patterns) {
    const auto designed = testing::value(hands::wobble_of(pattern));
    std::ostringstream fold;
    REQUIRE(write_fold(pattern, {}, fold));
    const auto report = testing::value(verify_fold(fold.str(), {}));
    REQUIRE(report.wobble);
    CHECK(report.wobble->largest_mm == Approx(designed.largest_mm).epsilon(0.03));
    CHECK(report.wobble->mean_mm == Approx(designed.mean_mm).epsilon(0.03));
    CHECK(report.wobble->loose.size() == designed.loose);
    loose += designed.loose;
    const bool is_told = std::ranges::any_of(report.notes, [](const std::string& note) {
      return note.find("by more than 1 mm in paper") != std::string::npos &&
             note.find("the panel near") != std::string::npos;
    });
    CHECK(is_told == (designed.loose > 0));
  }
  CHECK(loose > 0);
}

TEST_CASE("wobble is not measured of too many faces or of none that stands", "[hands]") {
  CHECK_FALSE(hands::wobble_of(Pattern{}));
  CHECK_FALSE(hands::wobble_of(testing::row_of_boxes(hands::kMostWobbleFaces / 2)));
}

TEST_CASE("folding costs its folds by their length, its waste and its tabs", "[hands]") {
  const std::vector<double> lengths{30, 12, 10, 9.9, 5, 4.9, 1};
  const hands::Handwork work = hands::handwork(lengths, 2, 1);
  CHECK(work.folds == 7);
  CHECK(work.shortest_mm == 1.0);
  CHECK(work.time_s == 3 * 10 + 2 * 20 + 2 * 40 + 2 * 5 + 45);
  CHECK(work.label == "hard");
  CHECK(hands::handwork_words(work) ==
        "7 folds, the shortest 1 mm; about 3 minutes to fold (hard)");
  CHECK(hands::handwork(std::vector<double>(25, 8.0), 0, 0).label == "easy");
  CHECK(hands::handwork(std::vector<double>(26, 8.0), 0, 0).label == "medium");
  CHECK(hands::handwork(std::vector<double>(25, 7.9), 0, 0).label == "medium");
  CHECK(hands::handwork(std::vector<double>(81, 8.0), 0, 0).label == "hard");
  CHECK(hands::handwork({}, 0, 0).label == "easy");
  CHECK(hands::handwork_words(hands::handwork({}, 0, 0)) == "no folds");
}

TEST_CASE("a table of hands is read, and what is wrong in it is named", "[hands]") {
  const auto table = testing::value(hands::read_hands(
      R"({"popcut": 1, "folds": [{"from_mm": 0, "fold_s": 3}], "waste_s": 1, "tab_s": 2, "labels": []})"));
  CHECK(hands::handwork(std::vector<double>{4, 5}, 1, 1, table).time_s == 9);
  CHECK(hands::handwork(std::vector<double>{4}, 1, 1, table).label == "hard");
  const auto place = [](const std::string& text) {
    const auto read = hands::read_hands(text);
    return read ? std::string("read") : read.error().place;
  };
  const std::string rest = R"(, "waste_s": 1, "tab_s": 2, "labels": []})";
  CHECK(place(R"({"popcut": 1, "folds": [{"from_mm": 5, "fold_s": 3}])" + rest) == "/folds");
  CHECK(place(R"({"popcut": 1, "folds": [])" + rest) == "/folds");
  CHECK(
      place(R"({"popcut": 1, "folds": [{"from_mm": 0, "fold_s": 3}, {"from_mm": 2, "fold_s": 3}])" +
            rest) == "/folds/1/from_mm");
  CHECK(place(R"({"popcut": 1, "folds": [{"from_mm": 0, "fold_s": -3}])" + rest) ==
        "/folds/0/fold_s");
}

TEST_CASE("a person's own table is made of the times for a strip, and found among their tables",
          "[hands]") {
  const Pattern strip = hands::folding_strip();
  CHECK(hands::handwork(strip).folds == 10);
  // Pieces of one line that touch are creased as one; others are folds of their own.
  Pattern pieces;
  const auto fold = [&](double u0, double v0, double u1, double v1, EdgeRole role) {
    SheetLine line{};
    line.u0 = u0, line.v0 = v0, line.u1 = u1, line.v1 = v1, line.role = role;
    pieces.lines.push_back(line);
  };
  fold(10, 0, 10, 7, EdgeRole::Valley);
  fold(10, 20, 10, 7, EdgeRole::Valley);
  fold(10, 20, 10, 25, EdgeRole::Mountain);
  fold(10, 31, 10, 40, EdgeRole::Valley);
  fold(11, 20, 11, 30, EdgeRole::Valley);
  fold(0, 0, 3, 4, EdgeRole::Mountain);
  fold(6, 8, 3, 4, EdgeRole::Mountain);
  const hands::Handwork creases = hands::handwork(pieces);
  CHECK(creases.folds == 5);
  CHECK(creases.shortest_mm == Approx(5));
  CHECK(strip.width_mm < 200);
  const std::string own = hands::own_hands_json({18, 22, 60, 120});
  const auto table = testing::value(hands::hands_of({R"({"popcut": 1, "machines": []})", own}));
  CHECK(hands::handwork(strip, table).time_s == 18 + 22 + 60 + 120);
  CHECK(table.waste_s == hands::built_in_hands().waste_s);
  CHECK(table.grades.size() == hands::built_in_hands().grades.size());
  CHECK(hands::handwork(std::vector<double>{25, 15, 6, 1}, 0, 0, table).time_s == 9 + 11 + 20 + 40);
  const auto other = testing::value(hands::hands_of({}));
  CHECK(other.folds.size() == hands::built_in_hands().folds.size());
  const auto wrong = hands::hands_of({own, R"({"popcut": 1, "hands": {"waste_s": -1}})"});
  REQUIRE_FALSE(wrong);
  CHECK(wrong.error().place == "table 2: /hands/waste_s");
  CHECK(find_machine("cameo3", {own}));  // each reader passes over the others' tables
}

TEST_CASE("waste is what falls out of a sheet, and slits are none", "[hands]") {
  CHECK(hands::waste_pieces(testing::box_card_pattern()) == 0);
  // A sheet of 30 x 30 mm in two faces around a hole in the middle.
  Pattern p;
  p.wall_mm = 0;
  for (const auto& [u, v] : {std::pair{0., 0.},
                             {15, 0},
                             {30, 0},
                             {30, 30},
                             {15, 30},
                             {0, 30},
                             {15, 10},
                             {20, 10},
                             {20, 20},
                             {15, 20}})
    p.vertices.push_back({u, 0, v});
  const auto edges = [&](std::vector<std::uint32_t> loop, EdgeRole role) {
    for (std::size_t k = 0; k + 1 < loop.size(); ++k)
      p.edges.push_back({loop[k], loop[k + 1], 0, -1, role});
  };
  edges({0, 1, 2, 3, 4, 5, 0}, EdgeRole::Outline);
  CHECK(hands::waste_pieces(p) == 0);
  edges({6, 9, 8, 7, 6}, EdgeRole::Slit);  // clockwise: the paper is to its left
  CHECK(hands::waste_pieces(p) == 1);
}

// ---- a person who follows the guide

/// How a fold turns when the card begins to shut, by the normals of its two faces and with its role
/// unread: positive where the paper rises toward the eye that sees the pop-up side.
double turn_of(const Pattern& pattern, const PatternEdge& edge) {
  const auto at = posed_vertices(pattern, 2.6);
  const auto point = [&](std::uint32_t k) { return Eigen::Vector3d(at[k][0], at[k][1], at[k][2]); };
  const auto normal = [&](std::int32_t face) {
    const auto corners = pattern.face(static_cast<std::size_t>(face));
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < corners.size(); ++k)
      sum += point(corners[k]).cross(point(corners[(k + 1) % corners.size()]));
    return sum;
  };
  return normal(edge.left).cross(normal(edge.right)).dot(point(edge.to) - point(edge.from));
}

/// @param is_design  its lines are whole folds
void check_followed(const Pattern& pattern, bool is_design = true) {
  const auto guide = testing::value(hands::fold_guide(pattern));
  if (is_design) CHECK(guide.folds.size() == hands::handwork(pattern).folds);
  CHECK(guide.waste.size() == hands::waste_pieces(pattern));
  std::vector<int> creased(pattern.edges.size(), 0);
  const auto lies_on = [&](const PatternEdge& edge, const hands::GuideFold& fold) {
    const auto far = [&](std::uint32_t k) {
      const PatternVertex& p = pattern.vertices[k];
      const double u0 = pattern.u(fold.from), v0 = fold.from.v, du = pattern.u(fold.to) - u0,
                   dv = fold.to.v - v0, length = std::hypot(du, dv);
      const double along = ((pattern.u(p) - u0) * du + (p.v - v0) * dv) / length;
      const double aside = ((pattern.u(p) - u0) * dv - (p.v - v0) * du) / length;
      return std::max({std::abs(aside), -along, along - length});
    };
    return std::max(far(edge.from), far(edge.to)) < 1e-6;
  };
  std::vector<int> made(guide.folds.size(), 0);
  bool has_pushed = false;
  for (std::size_t s = 0; s < guide.steps.size(); ++s) {
    const hands::GuideStep& step = guide.steps[s];
    CHECK(step.folds.size() <= hands::kMostFoldsAStep);
    CHECK_FALSE(step.words.empty());
    CHECK((step.kind != hands::StepKind::Waste || s == 0));
    CHECK((step.kind == hands::StepKind::Crease) == !step.folds.empty());
    CHECK_FALSE((has_pushed && step.kind != hands::StepKind::Push));
    has_pushed |= step.kind == hands::StepKind::Push;
    for (const std::uint32_t k : step.folds) {
      ++made[k];
      const hands::GuideFold& fold = guide.folds[k];
      for (std::size_t e = 0; e < pattern.edges.size(); ++e) {
        const PatternEdge& edge = pattern.edges[e];
        if (edge.role != EdgeRole::Mountain && edge.role != EdgeRole::Valley) continue;
        if (!lies_on(edge, fold)) continue;
        ++creased[e];
        if ((turn_of(pattern, edge) > 0) != fold.is_mountain())
          FAIL_CHECK("fold " << k << " is creased the wrong way");
      }
    }
    for (const std::uint32_t panel : step.panels) CHECK(panel < pattern.faces());
  }
  CHECK(std::ranges::all_of(made, [](int times) { return times == 1; }));
  for (std::size_t e = 0; e < pattern.edges.size(); ++e) {
    const EdgeRole role = pattern.edges[e].role;
    const bool is_fold = role == EdgeRole::Mountain || role == EdgeRole::Valley;
    if (creased[e] != (is_fold ? 1 : 0)) FAIL_CHECK("edge " << e << " is creased " << creased[e]);
  }
  CHECK((guide.folds.empty() || has_pushed));
  for (const auto& page : {std::array{210., 297.}, std::array{215.9, 279.4}}) {
    const auto pages = testing::value(fold_guide_pages(pattern, guide, page));
    CHECK(pages.size() == std::max<std::size_t>(1, (guide.folds.size() + 39) / 40));
  }
}

TEST_CASE("a person who follows the fold guide creases every fold once and the right way",
          "[hands]") {
  SECTION("boxes") {
    check_followed(testing::box_card_pattern());
    check_followed(testing::row_of_boxes(9), false);
  }
  SECTION("sloped panels") {
    const auto spec = testing::value(parse_design_spec(R"json({"popcut": 1, "style": "facets",
        "surface": {"type": "implicit",
                    "f": "max(max(x - 60, abs(y - 45) - 35), z + 0.55 * abs(x - 35) - 43.75)"},
        "facets": {"length_mm": 90, "strip_mm": 10, "pitch_mm": 5, "sloped": "kites"}})json"));
    const auto made = testing::value(design(spec));
    REQUIRE(made.pattern.kites.size() == 1);
    check_followed(made.pattern);
    CHECK(hands::wobble_of(made.pattern)->loose == 0);
  }
  SECTION("lattices") {
    std::mt19937 random(11);
    for (int k = 0; k < 8; ++k) {
      const auto spec = testing::value(parse_design_spec(testing::random_lattice_spec(random)));
      const auto made = design(spec);
      if (!made || made->report.folds > 300) continue;
      INFO("lattice " << k);
      check_followed(made->pattern);
    }
  }
  SECTION("facets") {
    std::mt19937 random(5);
    for (int k = 0; k < 2; ++k) check_followed(card_of(random, true).pattern.built.pattern);
  }
  SECTION("V-folds") {
    const auto spec = testing::value(parse_design_spec(
        R"({"popcut":1,"surface":{"type":"profile","z":"90 - x"},"units_per_slice":3,"slices":3,
            "widths_mm":20,"splay":{"alpha":0.9}})"));
    const auto made = testing::value(design(spec));
    check_followed(made.pattern);
  }
}

TEST_CASE("a pattern of which only the flat sheet is known is guided by the sheet alone",
          "[hands]") {
  const Pattern card = testing::box_card_pattern();
  Pattern flat = card;
  for (PatternVertex& p : flat.vertices) p = {card.u(p) - card.wall_mm, 0.0, p.v};
  flat.wall_mm = 0.0, flat.ground_mm = card.wall_mm + card.ground_mm;
  const auto guide = hands::fold_guide(flat), standing = hands::fold_guide(card);
  REQUIRE((guide && standing));
  CHECK(standing->stands);
  CHECK_FALSE(guide->stands);
  REQUIRE(guide->steps.size() == standing->steps.size());
  CHECK(guide->steps[0].words == standing->steps[0].words);
  const auto pages = testing::value(fold_guide_pages(flat, *guide, {210, 297}));
  CHECK(pages.front().svg.find("Seen from") == std::string::npos);
}

TEST_CASE(
    "the guide of a net ends with folding it up: it has no wall and ground, and nothing shuts",
    "[hands]") {
  const Pattern card = testing::box_card_pattern();
  Pattern net = card;
  for (PatternVertex& p : net.vertices) p = {card.u(p) - card.wall_mm, 0.0, p.v};
  net.wall_mm = 0.0, net.ground_mm = card.wall_mm + card.ground_mm, net.card = false;
  const auto guide = testing::value(hands::fold_guide(net));
  REQUIRE(guide.steps.size() == 2);
  CHECK(guide.steps[0].words ==
        "Crease 1 mountain fold (red, its ridge toward you) and 4 valley folds (blue, away from "
        "you).");
  CHECK(guide.steps[1].words ==
        "Fold it up along its creases, until its edges meet. Glue or tape the edges that belong "
        "together.");
}

TEST_CASE("a fold guide goes from wall and ground inward, and ends with shutting the card",
          "[hands]") {
  const auto guide = testing::value(hands::fold_guide(testing::box_card_pattern()));
  REQUIRE(guide.steps.size() == 2);
  CHECK(guide.steps[0].words ==
        "Crease 1 mountain fold (red, its ridge toward you) and 4 valley folds (blue, away from "
        "you): the main fold, and the figure, from wall and ground inward.");
  CHECK(guide.steps[0].panels.size() == 2);
  CHECK(guide.steps[1].words ==
        "Shut the card halfway. From behind, push the lit panels of the figure out, toward you. "
        "Shut the card, press it, and open it.");
  CHECK(hands::fold_guide(testing::row_of_boxes(500))->steps.size() < 800);
  const auto many = hands::fold_guide(testing::row_of_boxes(1000));
  REQUIRE_FALSE(many);
  CHECK(many.error().kind == ErrorKind::OutOfRange);
  CHECK_FALSE(fold_guide_pages(testing::box_card_pattern(), guide, {50, 60}));
}

namespace {

/// Where the faces of a net are once it is folded up, all folds mountains: by a right angle at
/// walls, else by two. The first face stays where it is, its printed side up.
std::vector<std::vector<Vec3>> folded_up(const Pattern& net, double wall_mm) {
  const auto corner = [&](std::uint32_t v) {
    return Vec3{net.vertices[v].x, net.vertices[v].v, 0.0};
  };
  const auto is_wall = [&](std::int32_t f) {
    double least = 1e9;
    const auto face = net.face(static_cast<std::size_t>(f));
    for (std::size_t k = 0; k < face.size(); ++k)
      least = std::min(least, norm(Vec3(corner(face[k]) - corner(face[(k + 1) % face.size()]))));
    return wall_mm > 0.0 && least < wall_mm + 1e-9;
  };
  std::vector<Eigen::Isometry3d> pose(net.faces(), Eigen::Isometry3d::Identity());
  std::vector<bool> is_placed(net.faces(), false);
  is_placed[0] = true;
  for (std::size_t round = 0; round < net.faces(); ++round)
    for (const PatternEdge& e : net.edges) {
      if (e.right < 0) continue;
      CHECK(e.role == EdgeRole::Mountain);
      const auto left = static_cast<std::size_t>(e.left), right = static_cast<std::size_t>(e.right);
      if (is_placed[left] == is_placed[right]) continue;
      const std::size_t from = is_placed[left] ? left : right, to = from == left ? right : left;
      const double angle =
          is_wall(e.left) || is_wall(e.right) ? std::numbers::pi / 2 : std::numbers::pi;
      const Vec3 a = corner(e.from), b = corner(e.to);
      // A face on the right of a line that runs away turns down about it; one on the left, up.
      const Eigen::AngleAxisd turn(from == left ? angle : -angle, unit(Vec3(b - a)));
      pose[to] = pose[from] * Eigen::Translation3d(a) * turn * Eigen::Translation3d(Vec3(-a));
      is_placed[to] = true;
    }
  CHECK(std::count(is_placed.begin(), is_placed.end(), false) == 0);
  std::vector<std::vector<Vec3>> out;
  for (std::size_t f = 0; f < net.faces(); ++f) {
    out.emplace_back();
    for (const std::uint32_t v : net.face(f)) out.back().push_back(pose[f] * corner(v));
  }
  return out;
}

/// Whether a place lies in a convex face, both seen from above.
bool lies_in(double x, double y, const std::vector<Vec3>& face) {
  bool left = false, right = false;
  for (std::size_t k = 0; k < face.size(); ++k) {
    const Vec3 &a = face[k], &b = face[(k + 1) % face.size()];
    const double turn = (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
    if (turn > 1e-9) left = true;
    if (turn < -1e-9) right = true;
  }
  return !(left && right);
}

}  // namespace

TEST_CASE("an envelope folds up around the shut card, is glued below its back, and closes",
          "[core][hands]") {
  for (const hands::ShutCard& card :
       {hands::ShutCard{120.0, 90.0, 0.6}, hands::ShutCard{80.0, 130.0, 1.4},
        hands::ShutCard{150.0, 110.0, 4.2}}) {
    const auto size = testing::value(hands::envelope_mm("fit", card));
    const double wide = size[0], high = size[1];
    const double wall = card.stack_mm > hands::kFlat_mm ? card.stack_mm : 0.0;
    CAPTURE(wide, high, wall);
    CHECK(wide == Approx(std::max(card.along_mm, card.out_mm) + card.stack_mm + hands::kEase_mm));
    CHECK(high == Approx(std::min(card.along_mm, card.out_mm) + card.stack_mm + hands::kEase_mm));
    const Pattern net = hands::envelope(card, size);
    CHECK(net.faces() == (wall > 0.0 ? 9U : 5U));
    CHECK(std::count_if(net.edges.begin(), net.edges.end(),
                        [](const PatternEdge& e) { return e.right >= 0; }) == (wall > 0.0 ? 8 : 4));
    for (const PatternVertex& p : net.vertices) {
      CHECK((p.x > -1e-9 && p.x < net.ground_mm + 1e-9));
      CHECK((p.v > -1e-9 && p.v < net.width_mm + 1e-9));
    }
    CHECK(net.lines.size() == net.edges.size());
    const auto faces = folded_up(net, wall);
    const std::vector<Vec3>& front = faces.front();
    std::vector<std::vector<Vec3>> behind;  // back, flap, sides
    for (std::size_t f = faces.size() - 4; f < faces.size(); ++f) {
      behind.push_back(faces[f]);
      for (const Vec3& p : faces[f]) {
        CHECK(p.z() == Approx(-wall).margin(1e-9));
        CHECK(lies_in(p.x(), p.y(), front));
      }
    }
    // Nothing of the flat net lies on another part of it.
    for (std::size_t a = 0; a < net.faces(); ++a)
      for (std::size_t b = 0; b < net.faces(); ++b) {
        if (a == b) continue;
        std::vector<Vec3> flat_b;
        Vec3 middle{0.0, 0.0, 0.0};
        for (const std::uint32_t v : net.face(b))
          flat_b.push_back({net.vertices[v].x, net.vertices[v].v, 0.0});
        for (const std::uint32_t v : net.face(a))
          middle += Vec3{net.vertices[v].x, net.vertices[v].v, 0.0} /
                    static_cast<double>(net.face(a).size());
        CHECK_FALSE(lies_in(middle.x(), middle.y(), flat_b));
        for (const std::uint32_t v : net.face(a)) {
          const Vec3 p{net.vertices[v].x, net.vertices[v].v, 0.0};
          const Vec3 within = middle + 0.999 * (p - middle);
          CHECK_FALSE(lies_in(within.x(), within.y(), flat_b));
        }
      }
    // By samples: the sides are glued below the back over much of them; flap and back leave no gap.
    std::size_t of_sides = 0, glued = 0, open = 0, closed = 0;
    const double x0 = front[0].x(), y0 = front[0].y();
    for (double x = 0.5; x < wide; x += 1.0)
      for (double y = 0.5; y < high; y += 1.0) {
        const auto in = [&](std::size_t k) { return lies_in(x0 + x, y0 + y, behind[k]); };
        if (in(2) || in(3)) ++of_sides, glued += in(0) ? 1 : 0;
        if (std::abs(x - 0.5 * wide) < 0.25 * wide) {
          if (in(0) && in(1)) ++closed;
          if (!in(0) && !in(1)) ++open;
        }
      }
    CHECK(glued > of_sides / 2);
    CHECK(open == 0);
    CHECK(static_cast<double>(closed) > 14.0 * 0.49 * wide);
  }
}

TEST_CASE("an envelope of a known size holds the card, or says what the card needs",
          "[core][hands]") {
  const hands::ShutCard card{120.0, 90.0, 1.0};
  const auto a2 = testing::value(hands::envelope_mm("A2", card));
  CHECK(a2[0] == Approx(146.05));
  CHECK(a2[1] == Approx(111.125));
  CHECK((*hands::envelope_mm("120x170", card))[0] == 170.0);
  const auto refused = hands::envelope_mm("DL", {120.0, 108.0, 3.0});
  REQUIRE_FALSE(refused);
  CHECK(refused.error().kind == ErrorKind::Infeasible);
  CHECK(refused.error().detail ==
        "DL is 220.0 x 110.0 mm; the shut card, 3.0 mm high, needs at least 127.0 x 115.0 mm");
  for (const char* word : {"", "A9", "12x", "5x5", "120x170x3", "fitt"}) {
    const auto wrong = hands::envelope_mm(word, card);
    REQUIRE_FALSE(wrong);
    CHECK(wrong.error().kind == ErrorKind::Usage);
  }
  const Pattern thin = hands::cover({120.0, 90.0, 1.0}), thick = hands::cover({120.0, 90.0, 3.0});
  CHECK(thin.faces() == 2);
  CHECK(thick.faces() == 3);
  CHECK(thick.ground_mm == Approx(2.0 * 92.0 + 3.0));
  CHECK(thick.width_mm == Approx(124.0));
}

}  // namespace hands_test
