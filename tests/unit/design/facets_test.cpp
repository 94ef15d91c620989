// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "core/deploy/loaded_pattern.hpp"
#include "core/design/design.hpp"
#include "core/design/facets/facets.hpp"
#include "core/design/facets/label_card.hpp"
#include "core/design/facets/label_holding.hpp"
#include "core/design/facets/label_pattern.hpp"
#include "core/design/facets/labelling.hpp"
#include "core/design/facets/labels.hpp"
#include "core/design/facets/patch_moves.hpp"
#include "core/design/facets/roofs.hpp"
#include "core/design/facets/seen_target.hpp"
#include "core/design/facets/strip_chain.hpp"
#include "core/design/facets/strip_moves.hpp"
#include "core/design/facets/windows.hpp"
#include "core/design/shape_fit.hpp"
#include "core/formats/fold/fold_reader.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/formats/lattice/lattice_blob.hpp"
#include "core/hands/folding.hpp"
#include "core/hands/wobble.hpp"
#include "core/judge/pattern_model.hpp"
#include "core/verify/verify.hpp"
#include "tests/support/lattice_reader.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/rounds.hpp"
#include "tests/support/value.hpp"

namespace facets_test {

using namespace popcut;
using testing::uniform;
using testing::whole;

void add_box(TriangleSoup& soup, const Vec3& low, const Vec3& high) {
  const auto at = [&](int i, int j, int k) {
    return Vec3(i ? high[0] : low[0], j ? high[1] : low[1], k ? high[2] : low[2]);
  };
  soup.add(at(1, 0, 0), at(1, 1, 0), at(1, 1, 1), at(1, 0, 1));
  soup.add(at(0, 0, 1), at(1, 0, 1), at(1, 1, 1), at(0, 1, 1));
  soup.add(at(0, 0, 0), at(1, 0, 0), at(1, 0, 1), at(0, 0, 1));
  soup.add(at(0, 1, 0), at(0, 1, 1), at(1, 1, 1), at(1, 1, 0));
}

// Calls `side` with both ends of every side of every face, in its turn around it.
template <typename Side>
void for_each_side(const Pattern& pattern, const Side& side) {
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    const auto face = pattern.face(f);
    for (std::size_t k = 0; k < face.size(); ++k)
      side(pattern.vertices[face[k]], pattern.vertices[face[(k + 1) % face.size()]]);
  }
}

// What a side adds to the area of its face, mm2: the shoelace formula.
double area_beside(const Pattern& pattern, const PatternVertex& a, const PatternVertex& b) {
  return 0.5 * (pattern.u(a) * b.v - pattern.u(b) * a.v);
}

TEST_CASE("the picture of a box shows its top, its front and the card around it", "[facets]") {
  TriangleSoup box;
  add_box(box, {0, 10, 0}, {20, 30, 15});
  const SeenTarget image = seen_target(box, {-30, 1, 0, 1, 60, 40}, false);
  const auto at = [&](double across, double v) {
    return std::pair(static_cast<std::size_t>(v), static_cast<std::size_t>(across + 30));
  };
  const auto [r1, c1] = at(-10.5, 20.5);  // on the top, where x - z = -10
  CHECK(image.z_mm(r1, c1) == Approx(15));
  CHECK(image.facing[r1 * 60 + c1] == Facing::Ground);
  const auto [r2, c2] = at(10.5, 20.5);  // on the front
  CHECK(image.x_mm(r2, c2) == Approx(20));
  CHECK(image.facing[r2 * 60 + c2] == Facing::Wall);
  const auto [r3, c3] = at(-20.5, 20.5);  // above it
  CHECK(image.x_mm(r3, c3) == Approx(0).margin(1e-5));
  CHECK(image.facing[r3 * 60 + c3] == Facing::Card);
  const auto [r4, c4] = at(10.5, 5.5);  // beside it
  CHECK(image.z_mm(r4, c4) == Approx(0).margin(1e-5));
}

TEST_CASE("parts behind the card are seen only where they are asked for", "[facets]") {
  TriangleSoup niche;  // a sheet 5 behind the wall
  niche.add({-5, 0, 10}, {-5, 10, 10}, {-5, 10, 40}, {-5, 0, 40});
  const SheetRaster raster{-50, 1, 0, 1, 100, 10};
  const SeenTarget closed = seen_target(niche, raster, false),
                   open = seen_target(niche, raster, true);
  CHECK(closed.x_mm(5, 20) == Approx(0).margin(1e-5));
  CHECK(open.x_mm(5, 20) == Approx(-5));
  CHECK(open.x_mm(5, 2) == Approx(0).margin(1e-5));  // nothing is there
}

/// The costs of a strip, and what their labels stand for.
struct OneStrip {
  const FacetPlanes& planes;
  const FacetGrid& grid;
  FacetChainProblem problem;
};

/// What it costs to go on from one label to the other at the line before a column.
double step_cost(const OneStrip& strip, int column, Label before, Label after) {
  const FacetChainProblem& problem = strip.problem;
  if (strip.planes.partner(before, strip.grid.across(column)) != after) return problem.jump;
  double cost = problem.fold;
  for (const FoldBeside& fold : problem.beside)
    if (fold.column == column && fold.into == after) cost -= fold.gain;
  return cost;
}

/// The cheapest chain by trying all.
double brute_force(const OneStrip& strip, std::vector<Label>& labels, int column) {
  const FacetChainProblem& problem = strip.problem;
  const int columns = strip.grid.columns;
  if (column == columns) {
    if (labels.front() != kWallLabel || labels.back() != kGroundLabel) return 1e30;
    double cost = 0.0;
    int run = 0;
    for (int i = 0; i < columns; ++i) {
      const auto at = static_cast<std::size_t>(i);
      cost += problem.cost[at * strip.planes.size() + static_cast<std::size_t>(labels[at])];
      if (i > 0 && labels[at] != labels[at - 1]) {
        if (run < problem.least_run) return 1e30;
        run = 0;
        cost += step_cost(strip, i, labels[at - 1], labels[at]);
      }
      ++run;
    }
    return run < problem.least_run ? 1e30 : cost;
  }
  double best = 1e30;
  for (std::size_t l = 0; l < strip.planes.size(); ++l) {
    labels[static_cast<std::size_t>(column)] = static_cast<Label>(l);
    best = std::min(best, brute_force(strip, labels, column + 1));
  }
  return best;
}

TEST_CASE("the labels of a strip are the best of all", "[facets]") {
  std::mt19937 random(20261125);
  const FacetPlanes planes({1, 2}, {1, 2});
  FacetGrid grid;
  grid.wall = 3, grid.columns = 6;
  FacetChainSolver solver(planes, grid);
  for (int k = 0; k < testing::rounds(60); ++k) {
    std::vector<double> cost(6 * planes.size());
    for (double& c : cost) c = uniform(random, 0.0, 2.0);
    const double fold = uniform(random, 0.0, 0.5);
    std::vector<FoldBeside> beside;
    for (int column = 1; k % 2 == 0 && column < grid.columns; ++column)
      beside.push_back(
          {column, static_cast<Label>(whole(random, 0, 5)), uniform(random, 0.0, 2.0)});
    const OneStrip strip{
        planes,
        grid,
        {cost, whole(random, 1, 3), fold,
         k % 3 == 0 ? kForbidden : std::max(0.0, fold + uniform(random, -0.5, 0.5)), beside}};
    std::vector<Label> labels(6);
    const double best = brute_force(strip, labels, 0);
    const FacetChain chain = solver.solve(strip.problem);
    INFO("round " << k);
    CHECK(chain.cost == Approx(best).epsilon(1e-9));
    std::vector<Label> same = chain.label;  // the labels cost what is said
    double sum = 0.0;
    for (std::size_t i = 0; i < 6; ++i) {
      sum += cost[i * planes.size() + static_cast<std::size_t>(same[i])];
      if (i > 0 && same[i] != same[i - 1])
        sum += step_cost(strip, static_cast<int>(i), same[i - 1], same[i]);
    }
    CHECK(sum == Approx(best).epsilon(1e-9));
  }
}

/// Random labels: strips of random runs, some of them folds.
LabelImage random_labels(std::mt19937& random, const FacetPlanes& planes, int strips) {
  LabelImage image;
  image.grid.step_mm = 1, image.grid.wall = 12, image.grid.columns = 24;
  image.grid.strip_mm = 2, image.grid.strips = strips;
  for (int s = 0; s < strips; ++s) {
    std::vector<Label> labels(24, kWallLabel);
    Label label = kWallLabel;
    for (int i = 0; i < 24; ++i) {
      if (i > 2 && i < 21 && whole(random, 0, 3) == 0) {
        const Label fold = planes.partner(label, image.grid.across(i));
        label = fold != kNoLabel && whole(random, 0, 5) > 0
                    ? fold
                    : static_cast<Label>(whole(random, 0, static_cast<int>(planes.size()) - 1));
      }
      labels[static_cast<std::size_t>(i)] = i >= 21 ? kGroundLabel : label;
    }
    if (s > 0 && whole(random, 0, 2) == 0)
      std::copy(image.label.end() - 24, image.label.end(), labels.begin());
    image.label.insert(image.label.end(), labels.begin(), labels.end());
  }
  return image;
}

TEST_CASE("labels that hold by propagation have one freedom, and what encloses others is filled",
          "[facets]") {
  std::mt19937 random(7);
  const FacetPlanes planes({2, 4, 6, 8}, {2, 4, 6, 8});
  const FacetCardSize card{12, 12, 3};
  int held = 0;
  for (int k = 0; k < testing::rounds(3000); ++k) {
    LabelImage image = random_labels(random, planes, whole(random, 1, 5));
    fill_enclosed(image, planes, 0.5);
    CHECK_FALSE(fill_enclosed(image, planes, 0.5));
    const auto pattern = pattern_of(image, planes, card, 0.5);
    INFO("round " << k);
    if (!pattern) FAIL(message(pattern.error()));
    const LabelHolding holding = holding_of(image, planes, {0.5});
    CHECK(holding.patches.count == pattern->built.pattern.faces());
    // Propagation finds what one face after the other determines; that is never too much.
    if (holding.open == 0) {
      ++held;
      CHECK(pattern->motion.degrees_of_freedom == 1);
      CHECK(pattern->motion.pieces == 1);
    }
    if (pattern->motion.degrees_of_freedom > 1) CHECK(holding.open > 0);
    CHECK(holding.pins >= 0);
    if (holding.open > 0) CHECK(holding.pins >= pattern->motion.degrees_of_freedom - 1);
  }
  CHECK(held > testing::rounds(3000) / 100);
}

TEST_CASE("a cut across a strip parts its panels and is one line", "[facets]") {
  // Wall, a shelf at z = 4, then a cut to the ground. The strip beside it folds down from the
  // shelf.
  const FacetPlanes planes({8}, {4});
  LabelImage image;
  image.grid = {1, 12, 24, 2, 2, 0};
  image.label.assign(48, kWallLabel);
  const Label front = planes.find({true, 8}), shelf = planes.find({false, 4});
  for (int s = 0; s < 2; ++s) {
    auto strip = image.strip(s);
    std::fill(strip.begin() + 8, strip.begin() + 16, shelf);
    std::fill(strip.begin() + 16, strip.begin() + 20, s == 0 ? front : kGroundLabel);
    std::fill(strip.begin() + 20, strip.end(), kGroundLabel);
  }
  const auto pattern = testing::value(pattern_of(image, planes, {12, 12, 3}, 0.5));
  CHECK(pattern.motion.degrees_of_freedom == 1);
  CHECK(pattern.motion.pieces == 1);
  const auto& lines = pattern.built.pattern.lines;
  const auto across = std::count_if(lines.begin(), lines.end(), [](const SheetLine& line) {
    return line.role == EdgeRole::Slit && line.u0 == line.u1;
  });
  REQUIRE(across == 1);
  const auto cut = std::find_if(lines.begin(), lines.end(), [](const SheetLine& line) {
    return line.role == EdgeRole::Slit && line.u0 == line.u1;
  });
  CHECK(cut->u0 == Approx(16));
  CHECK(std::abs(cut->v1 - cut->v0) == Approx(2));
}

FacetOptions coarse(double length_mm) {
  FacetOptions options;
  options.pitch_mm = options.strip_mm = 2;
  options.to_mm = length_mm;
  return options;
}

void add_ball(TriangleSoup& soup, const Vec3& middle, double radius) {
  constexpr int kRings = 24, kSectors = 48;
  const auto at = [&](int ring, int sector) {
    const double up = std::numbers::pi * ring / kRings - 0.5 * std::numbers::pi,
                 turn = 2.0 * std::numbers::pi * sector / kSectors;
    return Vec3(middle + radius * Vec3(std::cos(up) * std::cos(turn), std::cos(up) * std::sin(turn),
                                       std::sin(up)));
  };
  for (int ring = 0; ring < kRings; ++ring)
    for (int k = 0; k < kSectors; ++k)
      soup.add(at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k));
}

// In paper both are held by the same few places.
TEST_CASE(
    "in exact geometry curved parts that hold as a lattice come nearer to a ball than on struts",
    "[facets]") {
  TriangleSoup ball;
  add_ball(ball, {32, 40, 32}, 30);
  FacetOptions options = coarse(80);
  options.in_paper = false;
  const auto lattice = testing::value(facet_card(ball, options));
  options.lattice = false;
  const auto facets = testing::value(facet_card(ball, options));
  CHECK(lattice.pattern.motion.degrees_of_freedom == 1);
  CHECK(lattice.figures.shifted > 0);
  CHECK(lattice.moves > 0);
  CHECK(facets.figures.shifted == 0);
  CHECK(facets.moves == 0);
  CHECK(lattice.figures.depth_mean_mm < 0.97 * facets.figures.depth_mean_mm);
}

TEST_CASE("patches move only to where labels cost less and all holds", "[facets]") {
  std::mt19937 random(20261126);
  std::size_t moves = 0;
  for (int k = 0; k < testing::rounds(6); ++k) {
    INFO("round " << k);
    TriangleSoup scene;
    add_ball(scene, {uniform(random, 10, 30), uniform(random, 15, 35), uniform(random, 10, 30)},
             uniform(random, 8, 20));
    add_box(scene, {0, uniform(random, 0, 20), 0},
            {uniform(random, 5, 40), uniform(random, 25, 50), uniform(random, 5, 40)});
    FacetGrid grid;
    grid.step_mm = 0.5, grid.wall = 110, grid.columns = 220, grid.strip_mm = 2, grid.strips = 26;
    const SheetRaster raster{-55, 0.25, 0, 0.5, 440, 104};
    const SeenTarget image = seen_target(scene, raster, false);
    const FacetPlanes planes = planes_for(image, grid, 4, 100, 100, false);
    FacetLimits limits;
    limits.least_run = 1 + k % 3;
    Labelling labelling(image, planes, grid, {}, limits);
    // What no labels go below is the sum over strips of the best ones whose changes are free.
    const double least_mm3 = labelling.least_distance();
    FacetChainSolver solver(planes, grid);
    double free_mm3 = 0.0;
    for (int s = 0; s < grid.strips; ++s) {
      REQUIRE(labelling.keeps_costs(s));
      const auto kept = labelling.kept_costs(s);
      const std::vector<double> costs(kept.begin(), kept.end());
      free_mm3 += solver.solve({costs, limits.least_run, 0.0, 0.0}).cost;
    }
    CHECK(labelling.least_distance() == Approx(free_mm3).epsilon(1e-9));
    CHECK(least_mm3 == Approx(free_mm3).epsilon(1e-6));  // it was found before costs were rounded
    labelling.sweep(4, true);
    RepairOptions how;
    how.jumps = how.shifts = true;
    const double least_mm = limits.least_run * grid.step_mm;
    REQUIRE(repair(labelling, {55, 55, 3}, {least_mm}, how));
    REQUIRE(holding_of(labelling.image(), planes, {least_mm}).open == 0);
    const FacetPlanes fine = every_step(planes);
    Labelling moved(image, fine, grid, {}, limits);
    for (int s = 0; s < grid.strips; ++s) {
      std::vector<Label> labels;
      for (const Label label : std::as_const(labelling).image().strip(s))
        labels.push_back(fine.find(planes[label]));
      moved.set(s, labels);
    }
    const double before = moved.whole_cost();
    CHECK(before == Approx(labelling.whole_cost()));
    const std::size_t made = move_patches(moved, {least_mm}, 0.0, kMostRepairWork);
    moves += made;
    CHECK(moved.whole_cost() <= before + 1e-6);
    if (made == 0) CHECK(moved.whole_cost() == Approx(before));
    CHECK(holding_of(moved.image(), fine, {least_mm}).open == 0);
    for (int s = 0; s < grid.strips; ++s)
      for (const LabelRun& run : runs_of(std::as_const(moved).image().strip(s), fine, grid))
        CHECK(moved.allows(run));
    // Without work to do it leaves all as it is.
    Labelling still = moved;
    move_patches(still, {least_mm}, 0.0, 0);
    CHECK(still.whole_cost() <= moved.whole_cost() + 1e-6);
  }
  CHECK(moves > 0);
}

/// Folds of strips side by side between the same two planes, one by one; the card goes on at both
/// sides.
int hinges_of(const LabelImage& image, const FacetPlanes& planes) {
  const auto label = [&](int s, int column) {
    if (s < 0 || s >= image.grid.strips)
      return column < image.grid.wall ? kWallLabel : kGroundLabel;
    return image.strip(s)[static_cast<std::size_t>(column)];
  };
  int hinges = 0;
  for (int column = 1; column < image.grid.columns; ++column)
    for (int s = -1; s <= image.grid.strips; ++s) {
      const Label before = label(s, column - 1), after = label(s, column);
      if (before == after || !planes.meet(before, after, image.grid.across(column))) continue;
      if (s < 0 || label(s - 1, column - 1) != before || label(s - 1, column) != after) ++hinges;
    }
  return hinges;
}

TEST_CASE("a fold with a price costs it once, however many strips it crosses", "[facets]") {
  std::mt19937 random(20261127);
  const FacetPlanes planes({2, 4, 6, 8}, {2, 4, 6, 8});
  for (int k = 0; k < testing::rounds(20); ++k) {
    INFO("round " << k);
    const LabelImage image = random_labels(random, planes, whole(random, 1, 9));
    TriangleSoup box;
    add_box(box, {0, 0, 0}, {8, 10, 8});
    const SheetRaster raster{-12, 0.5, 0, 0.5, 48, static_cast<std::size_t>(4 * image.grid.strips)};
    const SeenTarget seen = seen_target(box, raster, false);
    Labelling labelling(seen, planes, image.grid, {0.0, 0.0, 0.0, 7.0}, {});
    double distance = 0.0;
    for (int s = 0; s < image.grid.strips; ++s) {
      const auto strip = image.strip(s);
      labelling.set(s, {strip.begin(), strip.end()});
      distance += labelling.distance(s, strip);
    }
    // The margins have the spine, which costs nothing.
    CHECK(labelling.whole_cost() - distance ==
          Approx(7.0 * (hinges_of(image, planes) - 2)).margin(1e-6));
    // What a strip says of a change is what all of them cost more then.
    const int changed = whole(random, 0, image.grid.strips - 1);
    const std::vector<Label> flat(labels_of(random_labels(random, planes, 1), 0));
    const double said = extra_cost(labelling, {{changed, flat}}), before = labelling.whole_cost();
    labelling.set(changed, flat);
    for (int s = 0; s < image.grid.strips; ++s)
      CHECK(labelling.cost_now(s) == labelling.cost(s, std::as_const(labelling).image().strip(s)));
    CHECK(labelling.whole_cost() - before == Approx(said).margin(1e-6));
  }
}

TEST_CASE("a price on folds makes fewer of them, and longer ones where that is asked for",
          "[facets]") {
  std::mt19937 random(20261128);
  std::size_t cheap = 0, dear = 0;
  double short_mm = 0.0, long_mm = 0.0;
  for (int k = 0; k < std::max(2, testing::rounds(4)); ++k) {
    INFO("round " << k);
    TriangleSoup scene;
    add_ball(scene, {uniform(random, 15, 30), uniform(random, 15, 45), uniform(random, 15, 30)},
             uniform(random, 12, 20));
    add_box(scene, {0, uniform(random, 0, 20), 0},
            {uniform(random, 10, 40), uniform(random, 30, 55), uniform(random, 10, 40)});
    FacetOptions options = coarse(60);
    options.pitch_mm = 4;
    const auto made_with = [&](double hinge_mm3, double widen_to_mm) {
      options.weights.hinge_mm3 = hinge_mm3, options.widen_to_mm = widen_to_mm;
      auto made = testing::value(facet_card(scene, options));
      CHECK(made.pattern.motion.degrees_of_freedom == 1);
      CHECK(made.pattern.motion.pieces == 1);
      CHECK(stands(made));
      return hands::handwork(made.pattern.built.pattern);
    };
    cheap += made_with(0.0, 0.0).folds;
    const hands::Handwork few = made_with(300.0, 0.0), wide = made_with(300.0, 6.0);
    dear += few.folds, short_mm += few.shortest_mm, long_mm += wide.shortest_mm;
  }
  CAPTURE(cheap, dear, short_mm, long_mm);
  CHECK(2 * dear < cheap);
  CHECK(long_mm > 1.5 * short_mm);
}

/// Three strips of two millimetres, steps of one, a wall of ten steps and as much ground. Planes
/// x = 4 and z = 5, 6, 7 besides.
class SmallCard {
 public:
  static constexpr Label kFront = 2, kTop = 4;  // x = 4, z = 6

  SmallCard() : planes_({4}, {5, 6, 7}), labelling_(image(), planes_, grid(), {}, {}) {
    for (int s = 0; s < 3; ++s) labelling_.set(s, bare());
  }

  /// The labels of a strip, by the column at which each of them ends.
  static std::vector<Label> labels(const std::vector<std::pair<int, Label>>& ends) {
    std::vector<Label> out;
    for (const auto& [end, label] : ends) out.resize(static_cast<std::size_t>(end), label);
    return out;
  }
  static std::vector<Label> bare() { return labels({{10, kWallLabel}, {20, kGroundLabel}}); }
  static std::vector<Label> box() {
    return labels({{4, kWallLabel}, {8, kTop}, {14, kFront}, {20, kGroundLabel}});
  }

  LabelCard with(const std::vector<Label>& middle) {
    labelling_.set(1, middle);
    return {labelling_, {1}};
  }
  [[nodiscard]] Label level(int z) const { return planes_.find({false, z}); }

 private:
  static FacetGrid grid() {
    FacetGrid out;
    out.step_mm = 1, out.wall = 10, out.columns = 20, out.strip_mm = 2, out.strips = 3;
    return out;
  }
  const SeenTarget& image() {
    TriangleSoup scene;
    add_box(scene, {0, 2, 0}, {4, 4, 6});
    image_ = seen_target(scene, {-10, 0.5, 0, 0.5, 40, 12}, false);
    return image_;
  }

  FacetPlanes planes_;
  SeenTarget image_;
  Labelling labelling_;
};

TEST_CASE("panels before and after what is left out meet in a fold", "[facets]") {
  SmallCard small;
  const LabelCard card = small.with(SmallCard::box());
  REQUIRE(card.planes()[SmallCard::kTop] == FacetPlane{false, 6});
  CHECK(card.holding.open == 0);
  CHECK(with_meeting(card, 1, 0, 3) == SmallCard::bare());
  CHECK_FALSE(with_meeting(card, 1, 0, 2));  // both are upright
}

TEST_CASE("a ledge fills a cut between two planes of one direction", "[facets]") {
  SmallCard small;
  const LabelCard card =
      small.with(SmallCard::labels({{8, kWallLabel}, {14, SmallCard::kFront}, {20, kGroundLabel}}));
  const auto ledges = with_ledges(card, 1, 1);
  REQUIRE_FALSE(ledges.empty());
  CHECK(ledges.front() == SmallCard::box());
  CHECK(with_ledges(card, 1, 2).empty());  // the front meets the ground in a fold
}

TEST_CASE("a panel is shifted to both planes beside its own, with its folds", "[facets]") {
  SmallCard small;
  const LabelCard card = small.with(SmallCard::box());
  const auto moved = shifted(card, 1, 1);
  REQUIRE(moved.size() == 2);
  CHECK(moved[0] ==
        SmallCard::labels(
            {{5, kWallLabel}, {9, small.level(5)}, {14, SmallCard::kFront}, {20, kGroundLabel}}));
  CHECK(moved[1] ==
        SmallCard::labels(
            {{3, kWallLabel}, {7, small.level(7)}, {14, SmallCard::kFront}, {20, kGroundLabel}}));
}

TEST_CASE("a loose panel is found, and what is painted over it holds", "[facets]") {
  SmallCard small;
  LabelCard card =
      small.with(SmallCard::labels({{4, kWallLabel}, {9, SmallCard::kTop}, {20, kGroundLabel}}));
  CHECK(card.holding.open > 0);
  const auto loose = loose_patches(card);
  REQUIRE(loose.size() == 1);
  CHECK(loose[0].area == 5);
  const LabelImage before = card.image();
  const NewStrips over = painted_over(card, loose[0], false);
  const NewStrips without = without_patch(card, loose[0], false);
  CHECK(card.image().label == before.label);  // both only propose
  REQUIRE(over.size() == 1);
  CHECK(over[0].strip == 1);
  CHECK(std::count(over[0].labels.begin(), over[0].labels.end(), SmallCard::kTop) == 0);
  CHECK(card.holding_with(over).open == 0);
  CHECK(card.holding.open > 0);
  card.take(without);
  CHECK(card.image().label != before.label);
}

TEST_CASE("planes at every step reach as far as those given, and stay those where too many",
          "[facets]") {
  const FacetPlanes every = every_step(FacetPlanes({4, -3}, {7}));
  CHECK(every.size() == 2 + 7 + 7);  // wall and ground, x from -3 to 4, z from 1 to 7
  for (int at = -3; at <= 4; ++at) CHECK(every.find({true, at}) != kNoLabel);
  for (int at = 0; at <= 7; ++at) CHECK(every.find({false, at}) != kNoLabel);
  CHECK(every.find({true, 5}) == kNoLabel);
  CHECK(every.find({false, -1}) == kNoLabel);
  CHECK(every_step(FacetPlanes({kMostLabels}, {})).size() == 3);
}

TEST_CASE("a village of boxes comes out without error and with its own patches", "[facets]") {
  // Boxes that stand against the wall, each apart from the others: two patches a box, and the
  // card's two.
  std::mt19937 random(3);
  for (int k = 0; k < testing::rounds(10); ++k) {
    TriangleSoup village;
    int boxes = 0;
    for (double v = 4; v < 80; v += 16, ++boxes)
      add_box(
          village, {0, v, 0},
          {2.0 * whole(random, 4, 15), v + 2.0 * whole(random, 3, 6), 2.0 * whole(random, 4, 15)});
    const auto made = testing::value(facet_card(village, coarse(90)));
    CHECK(made.figures.depth_mean_mm == Approx(0).margin(1e-4));
    CHECK(made.figures.patches == static_cast<std::size_t>(2 * boxes + 2));
    CHECK(made.pattern.motion.degrees_of_freedom == 1);
  }
}

TEST_CASE("stairs that the card does not hold get struts, and are loose without them", "[facets]") {
  TriangleSoup stairs;
  for (int k = 0; k < 4; ++k) add_box(stairs, {0, 10, 0}, {10.0 + 8 * k, 50, 40.0 - 8 * k});
  const auto made = testing::value(facet_card(stairs, coarse(60)));
  CHECK(made.figures.loose_before > 0);
  CHECK(made.pattern.motion.degrees_of_freedom == 1);
  CHECK(made.figures.dropped == 0);
  REQUIRE(!made.repaired.struts.empty());
  for (const FacetStrut& strut : made.repaired.struts) {
    LabelImage without = made.labels;
    std::copy(strut.without.begin(), strut.without.end(), without.strip(strut.strip).begin());
    const auto loose = testing::value(pattern_of(without, made.planes, made.card, 0.5));
    CHECK(loose.motion.degrees_of_freedom > 1);
  }
  // Most of each step is there.
  CHECK(made.figures.depth_mean_mm < 1.0);
}

TEST_CASE("what stands in the air hangs on one strip, and a least distance of 0 is said",
          "[facets]") {
  TriangleSoup box;
  add_box(box, {10, 20, 28}, {24, 40, 42});
  const auto made = testing::value(facet_card(box, coarse(60)));
  CHECK(made.pattern.motion.degrees_of_freedom == 1);
  CHECK(made.pattern.motion.pieces == 1);
  CHECK(made.repaired.bridges == 1);
  CHECK(made.figures.struts == 1);
  CHECK(made.figures.patches == 4);  // wall, ground, top and front
  CHECK(std::isinf(made.figures.over_least));
  // The front is as wide as the box: 20 mm of its upper edge fold.
  double edge_mm = 0.0;
  const Pattern& pattern = made.pattern.built.pattern;
  for_each_side(pattern, [&](const PatternVertex& a, const PatternVertex& b) {
    if (std::abs(a.x - 24) < 1e-9 && std::abs(b.x - 24) < 1e-9 && std::abs(a.z - 42) < 1e-9 &&
        std::abs(b.z - 42) < 1e-9)
      edge_mm += 0.5 * std::abs(a.v - b.v);  // a side of two faces
  });
  CHECK(edge_mm == Approx(20));
}

TEST_CASE("a gate is chosen over its pillars alone, since a window opens it", "[facets]") {
  TriangleSoup gate;
  add_box(gate, {20, 0, 0}, {26, 10, 40});
  add_box(gate, {20, 50, 0}, {26, 60, 40});
  add_box(gate, {20, 0, 40}, {26, 60, 46});
  const auto made = testing::value(facet_card(gate, coarse(60)));
  CHECK(made.pattern.motion.degrees_of_freedom == 1);
  CHECK(made.windows == 1);
  for (const double v : {5.0, 30.0, 55.0}) {  // x = 26, z = 43 of the beam, on all its length
    const int s = static_cast<int>(v / made.grid.strip_mm);
    const int column = made.grid.wall + static_cast<int>((26.0 - 43.0) / made.grid.step_mm);
    const FacetPlane& plane = made.planes[made.labels.strip(s)[static_cast<std::size_t>(column)]];
    CHECK(plane.upright);
    CHECK(plane.offset * made.grid.step_mm == Approx(26));
  }
}

TEST_CASE("no facets come nearer to the target than the least distance of their strips",
          "[facets]") {
  std::mt19937 random(11);
  for (int k = 0; k < testing::rounds(5); ++k) {
    TriangleSoup heap;
    for (int i = 0; i < 6; ++i) {
      const Vec3 low(uniform(random, 0, 30), uniform(random, 0, 50), uniform(random, 0, 30));
      add_box(heap, low,
              low + Vec3(uniform(random, 3, 20), uniform(random, 5, 30), uniform(random, 3, 20)));
    }
    const auto made = testing::value(facet_card(heap, coarse(80)));
    CHECK(made.figures.over_least >= 1.0 - 1e-9);
    CHECK(made.pattern.motion.degrees_of_freedom == 1);
  }
}

TEST_CASE("facets keep inside a card that is asked for, shut as well", "[facets]") {
  TriangleSoup box;
  add_box(box, {0, 10, 0}, {50, 40, 50});
  FacetOptions options = coarse(50);
  options.wall_mm = 60, options.ground_mm = 55;
  const auto made = testing::value(facet_card(box, options));
  CHECK(made.card.wall_mm == 60);
  for (const PatternVertex& p : made.pattern.built.pattern.vertices)
    if (p.x > 0 && p.z > 0) CHECK(p.x + p.z <= 55 + 1e-9);
}

TEST_CASE("cuts follow the contour of a disc, and the sheet stays whole", "[facets]") {
  // A disc that stands on a post, 30 before the wall: below its middle its contour is cut.
  const double x = 30, r = 20, middle_v = 30, middle_z = 40;
  TriangleSoup disc;
  for (int k = 0; k < 360; ++k) {
    const auto at = [&](int degrees) {
      const double a = degrees * 3.14159265358979 / 180;
      return Vec3(x, middle_v + r * std::cos(a), middle_z + r * std::sin(a));
    };
    disc.add(Vec3(x, middle_v, middle_z), at(k), at(k + 1));
  }
  add_box(disc, {0, 26, 0}, {x, 34, 40});
  const auto made = testing::value(facet_card(disc, coarse(60)));
  const Pattern& pattern = made.pattern.built.pattern;
  double area = 0.0;
  int slanted = 0;
  for_each_side(pattern, [&](const PatternVertex& a, const PatternVertex& b) {
    area += area_beside(pattern, a, b);
    if (std::abs(a.v - b.v) > 1e-9 && std::abs(pattern.u(a) - pattern.u(b)) > 1e-9) ++slanted;
  });
  CHECK(area == Approx((pattern.wall_mm + pattern.ground_mm) * pattern.width_mm));
  CHECK(slanted >= 16);
  // Each slanted cut is drawn once and lies on the circle, which the disc's plane shows
  // undistorted.
  int on_circle = 0;
  for (const SheetLine& line : pattern.lines) {
    if (line.u0 == line.u1 || line.v0 == line.v1) continue;
    CHECK(line.role == EdgeRole::Slit);
    for (const auto& [u, v] : {std::pair(line.u0, line.v0), std::pair(line.u1, line.v1)}) {
      const double z = x - (u - pattern.wall_mm);
      const double off = std::hypot(z - middle_z, v - 15 - middle_v) - r;
      if (std::abs(off) < 0.5) ++on_circle;
    }
  }
  CHECK(on_circle >= slanted / 2);
}

// The least distance from a corner of a face to a side of it that neither it nor its neighbours
// touch, through the face, mm.
double narrowest_mm(const Pattern& pattern, std::size_t face) {
  std::vector<Vec2> p;
  for (const std::uint32_t k : pattern.face(face))
    p.emplace_back(pattern.u(pattern.vertices[k]), pattern.vertices[k].v);
  const auto is_inside = [&](const Vec2& at) {
    bool inside = false;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const Vec2 &a = p[k], &b = p[(k + 1) % p.size()];
      if ((a[1] > at[1]) != (b[1] > at[1]) &&
          at[0] < a[0] + (b[0] - a[0]) * (at[1] - a[1]) / (b[1] - a[1]))
        inside = !inside;
    }
    return inside;
  };
  double least = 1e9;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t k = 0; k < p.size(); ++k) {
      const std::size_t ahead = (k + p.size() - i) % p.size();
      if (ahead < 2 || ahead + 3 > p.size()) continue;
      const Vec2 &a = p[k], side = p[(k + 1) % p.size()] - a;
      const double t = std::clamp((p[i] - a).dot(side) / side.squaredNorm(), 0.0, 1.0);
      const Vec2 near = a + t * side;
      const double far = (near - p[i]).norm();
      if (far > 1e-6 && far < least && is_inside(0.5 * (near + p[i]))) least = far;
    }
  return least;
}

TEST_CASE("a panel whose contours slant stays as wide as the least panel", "[facets]") {
  TriangleSoup pyramids;
  for (const auto& [x, y, wide, high] :
       {std::array{0.0, 0.0, 30.0, 30.0}, {5.0, 30.0, 20.0, 50.0}, {20.0, 20.0, 20.0, 20.0}}) {
    const Vec3 top(x + wide / 2, y + wide / 2, high);
    const std::array<Vec3, 5> foot{Vec3(x, y, 0), Vec3(x + wide, y, 0), Vec3(x + wide, y + wide, 0),
                                   Vec3(x, y + wide, 0), Vec3(x, y, 0)};
    for (std::size_t k = 0; k < 4; ++k) pyramids.add(foot[k], foot[k + 1], top);
  }
  FacetOptions options = coarse(50);
  options.min_panel_mm = 0.81;
  const auto made = testing::value(facet_card(pyramids, options));
  const Pattern& pattern = made.pattern.built.pattern;
  for (std::size_t f = 0; f < pattern.faces(); ++f) CHECK(narrowest_mm(pattern, f) > 0.81);
}

TEST_CASE("the inside of a letter is a window, and the letter stays one face", "[facets]") {
  TriangleSoup letter;  // a P: its bowl has an inside of 12 x 14
  add_box(letter, {0, 10, 0}, {20, 20, 60});
  add_box(letter, {0, 20, 50}, {20, 42, 60});
  add_box(letter, {0, 20, 26}, {20, 42, 36});
  add_box(letter, {0, 32, 36}, {20, 42, 50});
  const auto made = testing::value(facet_card(letter, coarse(50)));
  CHECK(made.windows == 1);
  CHECK(made.pattern.motion.degrees_of_freedom == 1);
  CHECK(made.pattern.motion.pieces == 1);
  const Pattern& pattern = made.pattern.built.pattern;
  double area = 0.0;
  for_each_side(pattern, [&](const PatternVertex& a, const PatternVertex& b) {
    area += area_beside(pattern, a, b);
  });
  const double window = (pattern.wall_mm + pattern.ground_mm) * pattern.width_mm - area;
  CHECK(window > 0.5 * 12 * 14);
  CHECK(window < 12 * 14);
  // Its sides are drawn once each, and a slit opens it: one face has no hole.
  double drawn = 0.0;
  for (const SheetLine& line : pattern.lines)
    if (line.role == EdgeRole::Slit) drawn += std::hypot(line.u1 - line.u0, line.v1 - line.v0);
  double sides = 0.0;
  for (const PatternEdge& edge : pattern.edges)
    if (edge.role == EdgeRole::Slit) {
      const PatternVertex &a = pattern.vertices[edge.from], &b = pattern.vertices[edge.to];
      sides += std::hypot(pattern.u(a) - pattern.u(b), a.v - b.v);
    }
  // All cuts have two sides of paper but those around the window.
  double around = 0.0;
  for (int s = 0; s < made.labels.grid.strips; ++s)
    for (int i = 0; i < made.labels.grid.columns; ++i) {
      const auto label = [&](int strip, int column) {
        return made.labels.strip(strip)[static_cast<std::size_t>(column)];
      };
      if (label(s, i) != kNoLabel) continue;
      for (const int way : {-1, 1}) {
        if (label(s + way, i) != kNoLabel) around += made.labels.grid.step_mm;
        if (label(s, i + way) != kNoLabel) around += made.labels.grid.strip_mm;
      }
    }
  CHECK(sides == Approx(2 * drawn - around));
}

TEST_CASE("a window needs edges: where a front only slopes back, its panel stays whole",
          "[facets]") {
  // A front of 60 x 40 mm in one plane, with a recess of 30 x 24 mm, 6 mm deep: a box, or a
  // pyramid.
  using Frame = std::array<Vec3, 4>;
  const Frame outer{Vec3(20, 0, 0), Vec3(20, 60, 0), Vec3(20, 60, 40), Vec3(20, 0, 40)},
      inner{Vec3(20, 15, 8), Vec3(20, 45, 8), Vec3(20, 45, 32), Vec3(20, 15, 32)};
  TriangleSoup pyramid;
  const auto add_quad = [](TriangleSoup& to, const Vec3& a, const Vec3& b, const Vec3& c,
                           const Vec3& d) { to.add(a, b, c), to.add(a, c, d); };
  for (std::size_t k = 0; k < 4; ++k)
    add_quad(pyramid, outer[k], outer[(k + 1) % 4], inner[(k + 1) % 4], inner[k]);
  TriangleSoup box = pyramid;
  const Vec3 back(-6, 0, 0);
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3 &a = inner[k], &b = inner[(k + 1) % 4];
    pyramid.add(a, b, Vec3(14, 30, 20));
    add_quad(box, a, b, b + back, a + back);
  }
  add_quad(box, inner[0] + back, inner[1] + back, inner[2] + back, inner[3] + back);

  FacetGrid grid;
  grid.step_mm = 1.0, grid.wall = 60, grid.columns = 100, grid.strip_mm = 2.0, grid.strips = 30;
  const FacetPlanes planes({20}, {40});
  const SheetRaster raster{-60.0, 0.5, 0.0, 0.5, 200, 120};
  for (const bool is_box : {true, false}) {
    CAPTURE(is_box);
    LabelImage image{grid, std::vector<Label>(3000, kGroundLabel)};
    for (int s = 0; s < grid.strips; ++s) {
      const auto strip = image.strip(s);
      std::fill_n(strip.begin(), 20, kWallLabel);
      std::fill_n(strip.begin() + 20, 20, planes.find({false, 40}));
      std::fill_n(strip.begin() + 40, 40, planes.find({true, 20}));
    }
    const SeenTarget seen = seen_target(is_box ? box : pyramid, raster, false);
    CHECK(cut_windows(image, planes, seen, 2.0, 0.5, 4.0) == (is_box ? 1 : 0));
  }
}

TEST_CASE("a bridged island has a window above and one below its bridges", "[facets]") {
  TriangleSoup ring;  // a frame, and in it a block that two level bridges hold
  add_box(ring, {0, 0, 0}, {20, 60, 8});
  add_box(ring, {0, 0, 62}, {20, 60, 70});
  add_box(ring, {0, 0, 8}, {20, 8, 62});
  add_box(ring, {0, 52, 8}, {20, 60, 62});
  add_box(ring, {0, 22, 30}, {20, 38, 44});
  add_box(ring, {0, 8, 35}, {20, 22, 39});
  add_box(ring, {0, 38, 35}, {20, 52, 39});
  FacetOptions options = coarse(60);
  options.lattice = false;  // else struts hold what is seen in the hole
  const auto made = testing::value(facet_card(ring, options));
  CHECK(made.windows >= 2);
  CHECK(made.pattern.motion.degrees_of_freedom == 1);
  CHECK(made.pattern.motion.pieces == 1);
  // The block is paper, in front of the frame's hole above and below it.
  const auto label = [&](double v, double z) {
    const int s = static_cast<int>(v / made.grid.strip_mm);
    const int column = made.grid.wall + static_cast<int>((20.0 - z) / made.grid.step_mm);
    return made.labels.strip(s)[static_cast<std::size_t>(column)];
  };
  CHECK(label(30, 37) != kNoLabel);
  CHECK(label(30, 55) == kNoLabel);
  CHECK(label(30, 26) == kNoLabel);
}

TEST_CASE("what is seen in the hole of a frame stands there, where a strut for it costs little",
          "[facets]") {
  TriangleSoup frame;  // through the hole one sees the top of its sill, and of a block
  add_box(frame, {0, 0, 0}, {20, 60, 8});
  add_box(frame, {0, 0, 62}, {20, 60, 70});
  add_box(frame, {0, 0, 8}, {20, 8, 62});
  add_box(frame, {0, 52, 8}, {20, 60, 62});
  add_box(frame, {0, 22, 8}, {20, 38, 44});
  const auto made = testing::value(facet_card(frame, coarse(60)));
  CHECK(made.pattern.motion.degrees_of_freedom == 1);
  CHECK(made.pattern.motion.pieces == 1);
  CHECK(made.repaired.bridges == 0);  // nothing of it hangs in the air
  CHECK(made.repaired.inner + made.repaired.struts.size() > 0);
  CHECK(made.figures.struts == made.repaired.inner + made.repaired.struts.size());
  const auto plane_at = [&](double v, double x_less_z) {
    const int s = static_cast<int>(v / made.grid.strip_mm);
    const int column = made.grid.wall + static_cast<int>(x_less_z / made.grid.step_mm);
    return made.planes[made.labels.strip(s)[static_cast<std::size_t>(column)]];
  };
  const FacetPlane top = plane_at(30, 9 - 44);
  CHECK_FALSE(top.upright);
  CHECK(top.offset * made.grid.step_mm == Approx(44));
}

TEST_CASE("the page shows facets as other designs", "[facets]") {
  const auto spec = testing::value(parse_design_spec(
      R"j({"popcut": 1, "style": "facets", "surface": {"type": "implicit",
           "f": "max(max(x - 30, abs(y - 30) - 20), z - 30)"}, "facets": {"length_mm": 60}})j"));
  const auto made = testing::value(design(spec));
  CHECK(made.report.facets);
  CHECK(made.report.degrees_of_freedom == 1);
  REQUIRE(surface_fit(made));
  CHECK(surface_fit(made)->to_target.mean_mm < 1.0);
  LatticeBlobOptions options;
  options.error = true;
  const auto blob = testing::value(lattice_blob(made, options));
  CHECK(blob.size() > 1000);
}

/// A design of facets of a solid, with a card or without.
Design facets_of(const std::string& solid, const std::string& card) {
  const auto spec = testing::value(parse_design_spec(
      R"j({"popcut": 1, "style": "facets", "surface": {"type": "implicit", "f": ")j" + solid +
      R"j("}, "facets": {"length_mm": 60})j" + card + "}"));
  return testing::value(design(spec));
}

/// The warning with this code; empty if there is none.
std::string warning_of(const Design& made, const std::string& code) {
  for (const Warning& warning : made.report.warnings)
    if (warning.code == code) return warning.message;
  return {};
}

TEST_CASE("a card that is too small for its shape says what would be large enough", "[facets]") {
  const std::string box = "max(max(x - 20, abs(y - 30) - 20), z - 30)";
  const Design made = facets_of(box, R"(, "card": {"wall_mm": 25, "ground_mm": 90})");
  const std::string said = warning_of(made, "flattened_by_card");
  CHECK_THAT(said, Catch::Contains("30.0 mm up, 20.0 mm forward and, shut, 49."));
  CHECK_THAT(said, Catch::Contains("wall_mm = 25 mm") && Catch::Contains("wall_mm at least 65 mm"));
  CHECK(said.find("ground_mm") == std::string::npos);
  CHECK(warning_of(facets_of(box, ""), "flattened_by_card").empty());
  CHECK(warning_of(facets_of(box, R"(, "card": {"wall_mm": 65, "ground_mm": 65})"),
                   "flattened_by_card")
            .empty());
  // What may stick out of the shut card needs only as much as it is high and deep.
  CHECK(warning_of(facets_of(box, R"(, "card": {"wall_mm": 35, "ground_mm": 40, "shut": "free"})"),
                   "flattened_by_card")
            .empty());
}

TEST_CASE("a part that hangs in the air on one strip is named in a warning", "[facets]") {
  const Design made = facets_of("max(max(abs(x - 17) - 7, abs(y - 30) - 10), abs(z - 35) - 7)", "");
  CHECK_THAT(warning_of(made, "hangs_on_one_strip"),
             Catch::Contains("a part of the shape touches neither wall nor ground") &&
                 Catch::Contains("strip_mm"));
  CHECK(
      warning_of(facets_of("max(max(x - 20, abs(y - 30) - 20), z - 30)", ""), "hangs_on_one_strip")
          .empty());
}

TEST_CASE("a warning says that paper fills the gaps of a drawing", "[facets]") {
  const auto drawn = [](const std::string& shapes) {
    const auto spec = testing::value(parse_design_spec(
        R"({"popcut": 1, "style": "facets",
            "surface": {"type": "outline", "file": "a.svg", "height": 60, "depth": 20}})"));
    auto made = design(
        spec, {{"a.svg", R"(<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="60mm"
                              viewBox="0 0 60 60">)" +
                             shapes + "</svg>"}});
    if (!made) FAIL(message(made.error()));
    return warning_of(*made, "gaps_filled");
  };
  std::string dots;
  for (const char* y : {"6", "18", "30", "42", "54"})
    dots += std::string(R"(<circle cx="10" r="4" cy=")") + y + R"("/>)";
  CHECK_THAT(drawn(dots), Catch::Contains("the drawing") && Catch::Contains("come out as one"));
  CHECK(drawn(R"(<circle cx="30" cy="30" r="30"/>)").empty());
  CHECK(drawn(R"(<path d="M0 50h16v10h-16zM40 0h16v60h-16z"/>)").empty());
}

TEST_CASE("a profile that touches the ground ends there", "[facets]") {
  const std::string start = R"j({"popcut": 1, "surface": {"type": "profile", "z": ")j";
  for (const std::string& z : {"40*(1-x/90)^2", "20*(1+cos(x*pi/90))", "40*(1-x/(90+y/10))^2"}) {
    CAPTURE(z);
    const auto spec = testing::value(parse_design_spec(
        start + z + R"j("}, "style": "facets", "facets": {"length_mm": 8, "strip_mm": 4}})j"));
    const auto made = testing::value(design(spec));
    CHECK(made.pattern.ground_mm < 120.0);
    CHECK(made.pattern.wall_mm < 120.0);
    // The target of the fit ends there too.
    const auto lattice = testing::value(parse_design_spec(
        start + z + R"j("}, "units_per_slice": 4, "slices": 3, "widths_mm": 3})j"));
    const auto strips = testing::value(design(lattice));
    const auto fit = testing::value(surface_fit(strips));
    CHECK(fit.out_of_reach.overhang < 0.05);
  }
}

TEST_CASE("a solid that does not end is refused, however thin it is", "[facets]") {
  for (const std::string& f : {"z - 20", "abs(z - 0.41*x) - 1", "(x-z)^2 + (y-20)^2 - 100",
                               "max(abs(y-20) - 20, abs(z - 2*x) - 5)"}) {
    CAPTURE(f);
    const auto spec =
        parse_design_spec(R"j({"popcut": 1, "style": "facets", "surface": {"type": "implicit",
                               "f": ")j" +
                          f + R"j("}, "facets": {"length_mm": 40}})j");
    REQUIRE(spec);
    const auto made = design(*spec);
    REQUIRE_FALSE(made);
    CHECK(made.error().kind == ErrorKind::Infeasible);
    CHECK_THAT(made.error().detail, Catch::Contains("does not end"));
  }
  // One that does end is made, thin as it is.
  const Design made = facets_of("max(abs(z - 0.41*x) - 1, x - 50)", "");
  CHECK(made.pattern.ground_mm < 120.0);
}

TEST_CASE("nothing in the corner is an error that says so", "[facets]") {
  TriangleSoup away;
  add_box(away, {-20, 0, -20}, {-10, 10, -10});
  const auto made = facet_card(away, coarse(10));
  REQUIRE_FALSE(made);
  CHECK(made.error().kind == ErrorKind::Infeasible);
}

// ---- sloped panels

using Section = std::vector<std::pair<KitePoint, KitePoint>>;

/// Whether two segments go through each other; one that only touches the other does not.
bool cross_over(const std::pair<KitePoint, KitePoint>& s,
                const std::pair<KitePoint, KitePoint>& t) {
  const auto side = [](const std::pair<KitePoint, KitePoint>& of, const KitePoint& p) {
    const double turn = (of.second.x - of.first.x) * (p.z - of.first.z) -
                        (of.second.z - of.first.z) * (p.x - of.first.x);
    return turn / std::hypot(of.second.x - of.first.x, of.second.z - of.first.z);
  };
  constexpr double kTouch = 1e-7;
  const auto parts = [&](double a, double b) {
    return std::min(a, b) < -kTouch && std::max(a, b) > kTouch;
  };
  return parts(side(s, t.first), side(s, t.second)) && parts(side(t, s.first), side(t, s.second));
}

/// A kite on its level and its upright plane, with long wall and ground, opened to psi: by turning
/// about its hinges, not by mirrors.
Section opened(const KiteSection& kite, double psi) {
  const auto at = [&](double x, double z) {
    return KitePoint{x + z * std::cos(psi), z * std::sin(psi)};
  };
  const KitePoint q = at(kite.q.x, kite.q.z), e = at(kite.e.x, kite.e.z);
  const double far = std::hypot(e.x - q.x, e.z - q.z), p = kite.p_mm(), r = kite.q_mm();
  const double along = (far * far + r * r - p * p) / (2.0 * far),
               aside = std::sqrt(std::max(0.0, r * r - along * along));
  const double ux = (e.x - q.x) / far, uz = (e.z - q.z) / far;
  const KitePoint top{q.x + along * ux - aside * uz, q.z + along * uz + aside * ux};
  return {{at(0, 500), at(0, 0)}, {at(0, 0), at(500, 0)}, {at(0, kite.q.z), q}, {q, top}, {top, e},
          {e, at(kite.e.x, 0)}};
}

bool ever_crosses(const KiteSection& kite) {
  constexpr int kOpenings = 60;
  for (int k = 1; k < kOpenings; ++k) {
    const Section section = opened(kite, std::numbers::pi * k / kOpenings);
    for (std::size_t a = 0; a < section.size(); ++a)
      for (std::size_t b = a + 1; b < section.size(); ++b)
        if (cross_over(section[a], section[b])) return true;
  }
  // Near shut it comes nearest to wall and ground.
  const Section shut = opened(kite, 1e-4);
  for (std::size_t a = 0; a < shut.size(); ++a)
    for (std::size_t b = a + 1; b < shut.size(); ++b)
      if (cross_over(shut[a], shut[b])) return true;
  return false;
}

TEST_CASE("a kite is the mirror image of a stair, and is the same sheet", "[facets][kites]") {
  std::mt19937 random(11);
  for (int round = 0; round < testing::rounds(300); ++round) {
    const double p = uniform(random, 5, 40), q = uniform(random, 5, 40);
    if (std::abs(p - q) < 0.5) continue;
    const KitePoint top{uniform(random, 0, 90), uniform(random, 45, 90)};
    const KiteSection kite{top, {top.x + p, top.z - q}};
    for (const double psi : {3.1, 2.0, std::numbers::pi / 2, 0.7, 0.01}) {
      const KitePoint r = kite.posed(kite.q.x, kite.e.z, psi);
      const Section section = opened(kite, psi);
      CHECK(r.x == Approx(section[3].second.x).margin(1e-6));
      CHECK(r.z == Approx(section[3].second.z).margin(1e-6));
      // The bend at Q, as the angle between the level panel and QR.
      const KitePoint a = section[3].first;
      const double bend = std::abs(std::atan2(r.z - a.z, r.x - a.x));
      CHECK(std::abs(kite.bend_rad(psi)) == Approx(bend).margin(1e-6));
    }
    const double roof = kite.slope_rad();
    const KitePoint r = kite.r(), low = kite.overhangs() ? r : kite.e,
                    high = kite.overhangs() ? kite.q : r;
    CHECK(std::atan2(high.z - low.z, low.x - high.x) == Approx(roof).margin(1e-9));
    // Seen along the diagonal it is as long as its paper.
    CHECK(kite.depth_mm(kite.q.x - kite.q.z + 1e-9) >= kite.q.x + kite.q.z - 1e-6);
    CHECK(kite.depth_mm(kite.e.x - kite.e.z - 1e-9) >= kite.e.x + kite.e.z - 1e-6);
    CHECK(std::isnan(kite.depth_mm(kite.e.x - kite.e.z + 1e4)));
  }
}

TEST_CASE("kites within their bound cross nothing, and two percent outside they do",
          "[facets][kites]") {
  std::mt19937 random(12);
  int of_each[2] = {0, 0};
  for (int round = 0; round < testing::rounds(400); ++round) {
    const bool overhangs = round % 2 == 1;
    const double slope = uniform(random, 20, 70) * std::numbers::pi / 180.0;
    const double room = uniform(random, 30, 120);
    const double longest =
        overhangs ? longest_at_ridge_mm(room, slope) : longest_at_eave_mm(room, slope);
    for (const double part : {0.5, 0.9999, 1.02}) {
      const double length = part * longest;
      const KiteSection kite = overhangs
                                   ? kite_at_ridge({uniform(random, 1, 60), room}, slope, length)
                                   : kite_at_eave({room, uniform(random, 1, 60)}, slope, length);
      CAPTURE(overhangs, slope, room, part);
      REQUIRE(kite.overhangs() == overhangs);
      REQUIRE(kite.slope_rad() == Approx(slope));
      CHECK(kite.clears_card() == (part < 1.0));
      CHECK(ever_crosses(kite) == (part > 1.0));
    }
    ++of_each[overhangs ? 1 : 0];
  }
  CHECK(std::min(of_each[0], of_each[1]) > 0);
}

/// A house with its ridge along the spine: a front wall below its eave, and a roof.
struct RandomHouse {
  KitePoint ridge, eave;
  double front_x{};

  [[nodiscard]] TriangleSoup triangles(double width_mm) const {
    TriangleSoup out;
    out.add({front_x, 0, 0}, {front_x, width_mm, 0}, {front_x, width_mm, eave.z},
            {front_x, 0, eave.z});
    out.add({eave.x, 0, eave.z}, {eave.x, width_mm, eave.z}, {ridge.x, width_mm, ridge.z},
            {ridge.x, 0, ridge.z});
    return out;
  }
};

/// A house whose roof has `part` of the longest length of one type, and is too long for the other.
RandomHouse random_house(std::mt19937& random, bool overhangs, double part) {
  for (;;) {
    const double slope = uniform(random, 20, 70) * std::numbers::pi / 180.0;
    const double room = uniform(random, 60, 120), other = uniform(random, 8, 60);
    const double length =
        part * (overhangs ? longest_at_ridge_mm(room, slope) : longest_at_eave_mm(room, slope));
    const double forward = length * std::cos(slope), down = length * std::sin(slope);
    RandomHouse house;
    if (overhangs)
      house = {{other, room}, {other + forward, room - down}, other + forward};
    else
      house = {{room - forward, other + down}, {room, other}, room};
    const double longest_else = overhangs ? longest_at_eave_mm(house.eave.x, slope)
                                          : longest_at_ridge_mm(house.ridge.z, slope);
    if (length < 10 || house.eave.z < 4 || house.ridge.x < 4 || length < 1.02 * longest_else)
      continue;
    return house;
  }
}

FacetOptions broad_with_kites() {
  FacetOptions options;
  options.pitch_mm = 10, options.strip_mm = 6, options.to_mm = 36;
  options.kites = true;
  return options;
}

TEST_CASE(
    "roofs within their bound become sloped panels that verify; two percent longer ones are "
    "refused",
    "[facets][kites]") {
  std::mt19937 random(13);
  std::vector<double> poses;
  for (int k = 1; k < 60; ++k) poses.push_back(std::numbers::pi * (60 - k) / 60);
  VerifyOptions how;
  how.quick = true, how.degrees_of_freedom = 1;
  for (int round = 0; round < testing::rounds(200); ++round) {
    const bool overhangs = round % 2 == 1;
    CAPTURE(round, overhangs);
    const RandomHouse house = random_house(random, overhangs, uniform(random, 0.6, 1.0));
    const auto card = testing::value(facet_card(house.triangles(36), broad_with_kites()));
    const Pattern& pattern = card.pattern.built.pattern;
    REQUIRE(pattern.kites.size() == 1);
    CHECK(pattern.kites[0].section.overhangs() == overhangs);
    CHECK(pattern.faces() == 6);
    CHECK(card.pattern.motion.degrees_of_freedom == 1);
    auto model = testing::value(judge::pattern_model(pattern, poses));
    const auto report = testing::value(verify_model(std::move(model), how));
    for (const VerifyCheck& check : report.checks) {
      CAPTURE(check.name);
      CHECK(check.ok());
    }

    const RandomHouse longer = random_house(random, overhangs, 1.02);
    const auto refused = facet_card(longer.triangles(36), broad_with_kites());
    REQUIRE_FALSE(refused);
    CHECK(refused.error().place == "/facets/sloped");
    CHECK_THAT(refused.error().detail, Catch::Contains("must be at most"));
  }
}

TEST_CASE("sloped panels hang on folds as long as is asked, where the roof is wide enough",
          "[facets][kites]") {
  std::mt19937 random(14);
  const TriangleSoup house = random_house(random, false, 0.9).triangles(20);
  for (const auto& [asked_mm, dormer_mm] : {std::pair{0.0, 2.0}, {7.0, 8.0}, {30.0, 10.0}}) {
    FacetOptions options = broad_with_kites();
    options.strip_mm = 2, options.to_mm = 20, options.widen_to_mm = asked_mm;
    const auto card = testing::value(facet_card(house, options));
    const Pattern& pattern = card.pattern.built.pattern;
    REQUIRE(pattern.kites.size() == 1);
    CHECK(card.pattern.motion.degrees_of_freedom == 1);
    CHECK(hands::handwork(pattern).shortest_mm == Approx(dormer_mm).margin(1e-6));
  }
}

TEST_CASE("streets of houses, boxes and balls with sloped panels verify", "[facets][kites]") {
  std::mt19937 random(15);
  const std::array poses{2.9, 2.2, 1.5, 0.8, 0.3, 0.05};
  VerifyOptions how;
  how.quick = true, how.degrees_of_freedom = 1;
  for (int round = 0; round < testing::rounds(20); ++round) {
    CAPTURE(round);
    TriangleSoup street;
    double v = 0;
    for (int k = whole(random, 2, 4); k > 0; --k) {
      const double wide = uniform(random, 15, 40);
      const int kind = k == 1 ? 0 : whole(random, 0, 2);
      if (kind == 0) {
        const RandomHouse house = random_house(random, whole(random, 0, 1) == 1, 0.9);
        const TriangleSoup one = house.triangles(wide);
        for (std::size_t c = 0; c < one.corners.size(); ++c)
          street.corners.push_back(one.corners[c] + (c % 3 == 1 ? v : 0.0));
      } else if (kind == 1) {
        add_box(street, {0, v, 0}, {uniform(random, 10, 60), v + wide, uniform(random, 10, 60)});
      } else {
        add_ball(street, {30, v + 0.5 * wide, 25}, 0.5 * wide);
      }
      v += wide + uniform(random, 0, 4);
    }
    FacetOptions options;
    options.pitch_mm = whole(random, 3, 8), options.strip_mm = uniform(random, 2, 6);
    options.to_mm = v, options.kites = true, options.rough = whole(random, 0, 1) == 1;
    options.in_paper = whole(random, 0, 1) == 1;
    const auto card = testing::value(facet_card(street, options));
    const Pattern& pattern = card.pattern.built.pattern;
    CHECK_FALSE(pattern.kites.empty());
    CHECK(card.pattern.motion.degrees_of_freedom == 1);
    auto model = testing::value(judge::pattern_model(pattern, poses));
    const auto report = testing::value(verify_model(std::move(model), how));
    for (const VerifyCheck& check : report.checks) {
      CAPTURE(check.name);
      CHECK(check.ok());
    }
  }
}

TEST_CASE("verify refuses a sloped roof outside of its bound, and no other", "[facets][kites]") {
  std::mt19937 random(16);
  std::vector<double> poses;
  for (int k = 1; k < 60; ++k) poses.push_back(std::numbers::pi * (60 - k) / 60);
  poses.push_back(0.001);
  const FacetGrid grid{1.0, 200, 400, 6.0, 6, 0.0};
  int sound = 0, unsound = 0;
  for (int round = 0; round < testing::rounds(100); ++round) {
    const int p = whole(random, 10, 40), q = whole(random, 10, 40);
    const int x = whole(random, 2, 60), z = whole(random, 2, 60);
    const LabelKite kite{x, z + q, x + p, z};
    const KiteSection section = kite.section(grid.step_mm);
    const double room = section.overhangs() ? section.e.z : section.q.x;
    const bool is_within = section.clears_card();
    if (p == q || (!is_within && section.clearance_mm() < 1.02 * room)) continue;
    CAPTURE(p, q, room, is_within);
    const FacetPlanes planes({kite.ex}, {kite.qz}, {kite});
    LabelImage labels{grid, std::vector<Label>(6 * 400)};
    for (int s = 0; s < grid.strips; ++s) {
      const auto strip = kite_labels(planes, grid, {0, 0, grid.strips, 1}, s);
      std::copy(strip.begin(), strip.end(), labels.strip(s).begin());
    }
    auto made = testing::value(pattern_of(labels, planes, {200, 200, 15}, 0.5));
    mark_kites(made, planes, grid.step_mm);
    auto model = testing::value(judge::pattern_model(made.built.pattern, poses));
    VerifyOptions how;
    how.quick = true, how.degrees_of_freedom = 1;
    const auto report = testing::value(verify_model(std::move(model), how));
    CHECK(report.ok() == is_within);
    ++(is_within ? sound : unsound);
  }
  CHECK(std::min(sound, unsound) > 0);
}

TEST_CASE("a card with sloped panels comes back from its file, and moves the same on the page",
          "[facets][kites]") {
  std::mt19937 random(14);
  for (const bool overhangs : {false, true}) {
    CAPTURE(overhangs);
    const RandomHouse house = random_house(random, overhangs, 0.8);
    auto card = testing::value(facet_card(house.triangles(36), broad_with_kites()));
    const Pattern& pattern = card.pattern.built.pattern;
    std::ostringstream text;
    REQUIRE(write_fold(pattern, {}, text));
    const auto file = testing::value(read_fold(text.str()));
    const auto back = testing::value(pattern_from_fold(file));
    REQUIRE(back.kites.size() == 1);
    CHECK(back.kites[0].vertices == pattern.kites[0].vertices);
    for (const double psi : {2.5, 0.3}) {
      const auto is = posed_vertices(back, psi), due = posed_vertices(pattern, psi);
      for (std::size_t k = 0; k < due.size(); ++k)
        CHECK(norm(Vec3(vec3(is[k]) - vec3(due[k]))) < 1e-6);
    }
    // The page opens it by frames; flat and shut they are those of a stair.
    const auto blob = testing::value(lattice_blob(pattern));
    const testing::LatticeReader read(blob);
    CHECK(read.head["motion"] == "frames");
    // Both sides measure how firmly it holds, each by its own code.
    const auto report = testing::value(verify_fold(text.str(), {}));
    const auto wobble = testing::value(hands::wobble_of(pattern));
    REQUIRE(report.wobble);
    CHECK(report.wobble->largest_mm == Approx(wobble.largest_mm).epsilon(0.02));
  }
}

TEST_CASE("a shape without a roof is refused sloped panels, and the error says why",
          "[facets][kites]") {
  TriangleSoup box;
  add_box(box, {0, 0, 0}, {20, 36, 15});
  const auto refused = facet_card(box, broad_with_kites());
  REQUIRE_FALSE(refused);
  CHECK_THAT(refused.error().detail, Catch::Contains("no roof is seen"));
}

}  // namespace facets_test
