// SPDX-License-Identifier: MIT
// Elements of cards of several parts: their closed forms against motions that verify follows
// itself.
#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <random>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "core/design/boxes/boxed_card.hpp"
#include "core/geometry/angle.hpp"
#include "core/geometry/tent_section.hpp"
#include "core/judge/sound_boxes.hpp"
#include "core/parts/elements.hpp"
#include "core/parts/structure_fold.hpp"
#include "core/verify/parts/followed.hpp"
#include "core/verify/parts/parts.hpp"
#include "tests/support/random_numbers.hpp"
#include "tests/support/rounds.hpp"

namespace parts_property_test {

using namespace popcut;
using testing::uniform;
using testing::whole;

namespace {

constexpr double kPage_mm = 300.0, kLength_mm = 500.0;
constexpr unsigned kSeed = 42;

std::string text_of(const Structure& card) {
  const auto text = structure_fold(card, "test");
  if (!text) FAIL(message(text.error()));
  return *text;
}

PartsVerifyReport judged(const Structure& card) {
  PartsVerifyOptions options;
  options.openings = testing::fewer_rounds() ? 15 : 60;
  auto report = verify_parts(text_of(card), options);
  if (!report) FAIL(message(report.error()));
  return std::move(*report);
}

template <typename Kind>
Structure alone(const Kind& element, double page_mm = kPage_mm) {
  Structure card = plain_card(page_mm, kLength_mm);
  build(card, spine_of(card), element);
  return card;
}

VFoldElement random_v_fold(std::mt19937& random, double at_mm) {
  VFoldElement out;
  out.at_mm = at_mm;
  const auto angle = [&](double low, double high) { return radians(uniform(random, low, high)); };
  out.left_crease_rad = angle(15, 80), out.right_crease_rad = angle(15, 80);
  const double creases = out.left_crease_rad + out.right_crease_rad;
  const double sum = uniform(random, creases + radians(4), radians(178));
  out.left_panel_rad = sum - out.left_crease_rad, out.right_panel_rad = sum - out.right_crease_rad;
  out.crease_mm = uniform(random, 30, 90), out.ridge_mm = uniform(random, 20, 90);
  out.tabs_behind = whole(random, 0, 1) == 0;
  return out;
}

TentElement random_tent(std::mt19937& random, double from_mm) {
  TentElement out;
  out.from_mm = from_mm, out.to_mm = from_mm + uniform(random, 15, 80);
  out.left_foot_mm = uniform(random, 10, 50), out.right_foot_mm = uniform(random, 10, 50);
  const double feet = out.left_foot_mm + out.right_foot_mm;
  const double sum = uniform(random, 1.02 * feet, 2.0 * feet);
  out.left_panel_mm = sum - out.left_foot_mm, out.right_panel_mm = sum - out.right_foot_mm;
  return out;
}

LayerElement random_layer(std::mt19937& random, double from_mm) {
  LayerElement out;
  out.from_mm = from_mm, out.to_mm = from_mm + uniform(random, 15, 80);
  out.foot_mm = uniform(random, 20, 50), out.strut_at_mm = uniform(random, 15, 60);
  std::tie(out.strut_foot_mm, out.strut_mm) = upright_strut(out.foot_mm, out.strut_at_mm);
  out.height_mm = out.strut_at_mm + uniform(random, 9, 60);
  return out;
}

BoxElement random_box(std::mt19937& random, double from_mm) {
  BoxElement out;
  out.from_mm = from_mm, out.to_mm = from_mm + uniform(random, 30, 80);
  out.half_mm = uniform(random, 12, 35), out.height_mm = uniform(random, 15, 70);
  out.lid = static_cast<BoxLid>(whole(random, 0, 4));
  out.lid_mm = out.half_mm * uniform(random, 1.0, 2.0);
  const bool is_pyramid = out.lid == BoxLid::Pyramid;
  out.rise_mm = out.half_mm * (is_pyramid ? uniform(random, 1.0, 3.0) : uniform(random, 0.4, 2.0));
  const double slope = std::hypot(out.half_mm, out.rise_mm);
  out.eaves_mm =
      out.height_mm * slope / (slope + out.half_mm) * std::max(0.0, uniform(random, -0.5, 0.98));
  out.verge_mm = {uniform(random, 0.0, 6.0), uniform(random, 0.0, 6.0)};
  out.has_hips = {whole(random, 0, 2) > 0, true};
  if (whole(random, 0, 1) == 0) std::swap(out.has_hips[0], out.has_hips[1]);
  // One end at least folds outward where both would meet.
  const bool is_short = 2.0 * out.half_mm > out.to_mm - out.from_mm;
  for (bool& end : out.ends_out) end = out.lid == BoxLid::Floating || whole(random, 0, 1) == 0;
  if (is_short && !out.ends_out[0]) out.ends_out[1] = true;
  if (out.lid != BoxLid::Floating && whole(random, 0, 1) == 0)
    out.bend_mm = out.half_mm * uniform(random, 0.0, 0.25);
  if (out.lid == BoxLid::Pyramid) out.hip_bend_mm = out.half_mm * uniform(random, 0.0, 0.3);
  if (2.0 * std::hypot(out.half_mm, out.bend_mm) > out.to_mm - out.from_mm && !out.ends_out[0])
    out.ends_out[1] = true;
  if (out.ends_out[0] != out.ends_out[1] && whole(random, 0, 1) == 0)
    out.inner_mm = out.height_mm * uniform(random, 0.4, 1.0);
  return out;
}

DoubleCornerElement random_corner(std::mt19937& random, double from_mm) {
  DoubleCornerElement out;
  out.from_mm = from_mm, out.to_mm = from_mm + uniform(random, 50, 90);
  out.height_mm = uniform(random, 45, 80);
  out.lock_foot_mm = uniform(random, 10, 20);
  out.lock_panel_mm = out.lock_foot_mm * uniform(random, 1.3, 2.0);
  for (const bool right : {false, true})
    out.steps.push_back({right, from_mm + uniform(random, 0, 10),
                         out.to_mm - uniform(random, 0, 10), uniform(random, 15, 60),
                         uniform(random, 12, 44)});
  return out;
}

/// Adds one of the five elements, in the 200 mm from `begin_mm` on.
Result<void> add_random(Structure& card, std::mt19937& random, int kind, double begin_mm) {
  const Seat seat = spine_of(card);
  switch (kind) {
    case 0:
      return add(card, seat, random_v_fold(random, begin_mm + 100));
    case 1:
      return add(card, seat, random_tent(random, begin_mm + 40));
    case 2:
      return add(card, seat, random_layer(random, begin_mm + 40));
    case 3:
      return add(card, seat, random_box(random, begin_mm + 50));
    default:
      return add(card, seat, random_corner(random, begin_mm + 50));
  }
}

/// The largest distance of a corner between the closed form and the motion that verify follows,
/// seen from the right page.
double apart_mm(const Structure& card) {
  const auto model = verify::read_joint_model(text_of(card));
  if (!model) FAIL(message(model.error()));
  std::vector<verify::Sheet> sheets;
  VerifyCheck check;
  for (const auto& part : model->parts) sheets.push_back(verify::make_sheet(part.sheet, check));
  const auto whole_card = verify::assemble(*model, sheets, check);
  REQUIRE(whole_card);
  std::vector<double> openings{0.05, 0.4, 1.1, 1.5, 1.9, 2.6, 3.05};
  std::erase_if(openings, [&](double rad) { return rad > radians(card.opens_deg); });
  const auto motion = verify::follow(*whole_card, openings);
  INFO(motion.shut_stopped << motion.open_stopped);
  REQUIRE(motion.states.size() == openings.size());
  double most = 0.0;
  for (std::size_t k = 0; k < motion.states.size(); ++k) {
    const PartPoses closed = posed(card, motion.opening_rad[k]);
    const auto placed = [&](std::size_t p, std::size_t f) {
      const std::size_t panel = whole_card->panel_of(p, f);
      return Eigen::Isometry3d(motion.states[k][whole_card->body[panel]] *
                               whole_card->in_body[panel]);
    };
    const Eigen::Isometry3d page = closed[0][card.pages[1]] * placed(0, card.pages[1]).inverse();
    for (std::size_t p = 0; p < card.parts.size(); ++p)
      for (std::size_t f = 0; f < card.parts[p].faces.size(); ++f)
        for (const std::uint32_t v : card.parts[p].faces[f]) {
          const Vec3 flat{card.parts[p].vertices[v].x(), card.parts[p].vertices[v].y(), 0.0};
          most = std::max(most, norm(Vec3(page * (placed(p, f) * flat) - closed[p][f] * flat)));
        }
  }
  return most;
}

/// A house with a gabled roof over y, as OBJ text.
std::string house_obj(double half, double length, double walls, double rise) {
  std::string out;
  for (const double y : {0.0, length})
    for (const auto& [x, z] : {std::pair(-half, 0.0), std::pair(half, 0.0), std::pair(half, walls),
                               std::pair(0.0, walls + rise), std::pair(-half, walls)})
      out += fmt::format("v {} {} {}\n", x, y, z);
  return out +
         "f 1 2 3 4 5\nf 10 9 8 7 6\nf 1 6 7 2\nf 2 7 8 3\nf 3 8 9 4\nf 4 9 10 5\nf 5 10 6 1\n";
}

}  // namespace

TEST_CASE("random elements inside their conditions verify, and follow their closed forms",
          "[property][parts][verify]") {
  std::mt19937 random(kSeed);
  const int count = testing::rounds(300, 15);
  for (int k = 0; k < count; ++k) {
    CAPTURE(kSeed, k);
    Structure card = plain_card(kPage_mm, kLength_mm);
    if (auto done = add_random(card, random, k % 5, 150); !done) FAIL(message(done.error()));
    const PartsVerifyReport report = judged(card);
    if (!report.ok()) FAIL_CHECK(verify_text(report));
    CHECK(apart_mm(card) < 1e-9);
  }
}

TEST_CASE("random combinations, and elements on the creases of others, verify",
          "[property][parts][verify]") {
  std::mt19937 random(kSeed + 1);
  const int count = testing::rounds(100, 20);
  for (int k = 0; k < count; ++k) {
    CAPTURE(kSeed, k);
    Structure card = plain_card(kPage_mm, 840.0);
    for (int slot = 0; slot < 4; ++slot) {
      const std::size_t joints = card.joints.size();
      const int kind = whole(random, 0, 4);
      if (auto done = add_random(card, random, kind, 20.0 + 200.0 * slot); !done)
        FAIL(message(done.error()));
      if (kind != 1 || whole(random, 0, 1) == 0) continue;
      // On the outer side of a tent's right foot.
      const Seat seat = seat_beside(card, joints + 1);
      VFoldElement small;
      small.at_mm = 8.0;
      small.left_crease_rad = small.right_crease_rad = radians(40);
      small.left_panel_rad = small.right_panel_rad = radians(50);
      small.crease_mm = 7.0, small.ridge_mm = 5.0;
      small.left_tabs = small.right_tabs = {{3.0, 7.0}};
      small.tabs_behind = true;
      build(card, seat, small);
    }
    const PartsVerifyReport report = judged(card);
    if (!report.ok()) FAIL_CHECK(verify_text(report));
    CHECK(apart_mm(card) < 1e-9);
  }
}

TEST_CASE("elements 2 % outside their conditions are refused by the designer and by verify",
          "[property][parts][verify]") {
  std::mt19937 random(kSeed + 2);
  const int count = testing::rounds(60, 20);
  const auto refused = [](const auto& element, double page_mm = kPage_mm) {
    Structure card = plain_card(page_mm, kLength_mm);
    const auto done = add(card, spine_of(card), element);
    CHECK_FALSE(done);
    if (!done) CHECK(done.error().kind == ErrorKind::Infeasible);
    const PartsVerifyReport report = judged(alone(element, page_mm));
    INFO(verify_text(report));
    CHECK_FALSE(report.ok());
  };
  for (int k = 0; k < count; ++k) {
    CAPTURE(kSeed, k);
    VFoldElement v_fold = random_v_fold(random, 250);
    v_fold.right_panel_rad *= 1.02;
    refused(v_fold);
    v_fold = random_v_fold(random, 250);
    const double sum = 0.98 * (v_fold.left_crease_rad + v_fold.right_crease_rad);
    v_fold.left_panel_rad = sum - v_fold.left_crease_rad;
    v_fold.right_panel_rad = sum - v_fold.right_crease_rad;
    refused(v_fold);
    TentElement tent = random_tent(random, 200);
    tent.right_panel_mm *= k % 2 == 0 ? 1.02 : 0.98;
    refused(tent);
    tent = random_tent(random, 200);
    const double feet = 0.98 * (tent.left_foot_mm + tent.right_foot_mm);
    tent.left_panel_mm = feet - tent.left_foot_mm, tent.right_panel_mm = feet - tent.right_foot_mm;
    if (tent.left_panel_mm > 5.0 && tent.right_panel_mm > 5.0) refused(tent);
    LayerElement layer = random_layer(random, 200);
    refused(layer, (layer.foot_mm + layer.height_mm) / 1.02);
    layer.strut_mm *= 1.02;
    refused(layer);
    const BoxElement box = random_box(random, 200);
    refused(box, (box.height_mm + (box.lid == BoxLid::Floating ? box.lid_mm
                                   : box.lid == BoxLid::Roof   ? 2.0 * box.half_mm
                                   : box.lid == BoxLid::Gabled || box.lid == BoxLid::Pyramid
                                       ? box.half_mm + std::hypot(box.half_mm, box.rise_mm)
                                       : box.half_mm)) /
                     1.02);
    BoxElement inward = random_box(random, 200);
    inward.lid = BoxLid::None, inward.ends_out = {false, false};
    inward.bend_mm = inward.inner_mm = 0.0;
    inward.half_mm = 0.51 * (inward.to_mm - inward.from_mm);
    refused(inward);
  }
}

TEST_CASE("random gabled houses hold in paper, with at most 12 panels and 1 % of error",
          "[property][parts][boxes]") {
  std::mt19937 random(kSeed + 3);
  const int count = testing::rounds(60, 6);
  for (int k = 0; k < count; ++k) {
    const double half = uniform(random, 11.0, 45.0), length = uniform(random, 22.0, 120.0),
                 walls = half * uniform(random, 0.9, 4.0), rise = half * uniform(random, 0.3, 1.8);
    CAPTURE(kSeed, k, half, length, walls, rise);
    const auto spec = parse_design_spec(
        R"({"popcut":1,"style":"boxes","surface":{"type":"mesh","file":"a.obj"}})");
    REQUIRE(spec);
    const auto sound =
        judge::sound_boxes(*spec, {{"a.obj", house_obj(half, length, walls, rise)}}, "test");
    if (!sound) FAIL(message(sound.error()));
    REQUIRE(sound->made.boxes.size() == 1);
    CHECK(sound->made.panels <= 12);
    CHECK(sound->made.error() < 0.01);
    CHECK(sound->report.wobble_mm.value_or(9.0) <= 1.0);
  }
}

namespace {

/// A house with a flat or a pyramid roof, from `from` to `to` along the spine, for an OBJ file that
/// has `corners` corners before it.
std::string row_house_obj(std::mt19937& random, double from, double to, int& corners) {
  const double half = uniform(random, 10.0, 28.0), walls = uniform(random, 10.0, 65.0),
               rise = uniform(random, 6.0, 36.0), middle = 0.5 * (from + to);
  std::string out;
  for (const double z : {0.0, walls})
    for (const auto& [x, y] : {std::pair(-half, from), {half, from}, {half, to}, {-half, to}})
      out += fmt::format("v {} {} {}\n", x, y, z);
  const int b = corners;
  const auto face = [&](std::initializer_list<int> of) {
    out += "f";
    for (const int k : of) out += fmt::format(" {}", b + k);
    out += "\n";
  };
  face({4, 3, 2, 1});
  for (const auto& [p, q] : {std::pair(1, 2), {2, 3}, {3, 4}, {4, 1}}) face({p, q, q + 4, p + 4});
  corners += 8;
  if (whole(random, 0, 1) == 0) {
    face({5, 6, 7, 8});
    return out;
  }
  out += fmt::format("v 0 {} {}\n", middle, walls + rise);
  for (const auto& [p, q] : {std::pair(5, 6), {6, 7}, {7, 8}, {8, 5}}) face({p, q, 9});
  ++corners;
  return out;
}

}  // namespace

TEST_CASE("random rows of houses, however near to each other, are sound boxes or refused",
          "[property][parts][boxes]") {
  std::mt19937 random(kSeed + 4);
  const auto spec = parse_design_spec(
      R"({"popcut":1,"style":"boxes","surface":{"type":"mesh","file":"a.obj"},"boxes":{"most":9}})");
  REQUIRE(spec);
  const int count = testing::rounds(150, 10);
  int made = 0;
  for (int k = 0; k < count; ++k) {
    std::string obj;
    int corners = 0;
    double at = 0.0;
    for (int house = whole(random, 2, 3); house > 0; --house) {
      const double length = uniform(random, 12.0, 70.0);
      obj += row_house_obj(random, at, at + length, corners);
      at += length + (whole(random, 0, 3) == 0 ? 0.0 : uniform(random, 2.0, 50.0));
    }
    CAPTURE(kSeed, k, obj);
    const auto sound = judge::sound_boxes(*spec, {{"a.obj", obj}}, "test");
    if (sound)
      ++made;
    else if (sound.error().kind != ErrorKind::Infeasible)
      FAIL(message(sound.error()));
  }
  CHECK(made > count / 5);
}

// ---- glued roofs

namespace {

/// A house whose rear wall is `gap_mm` from the wall of its card.
Result<judge::SoundBoxes> glued(const std::string& obj, double half, double gap_mm,
                                const char* more = "") {
  const auto spec = parse_design_spec(
      fmt::format(R"({{"popcut":1,"style":"facets","surface":{{"type":"mesh","file":"a.obj"}},)"
                  R"("translate_mm":[{},0,0],"facets":{{"strip_mm":4,"sloped":"tents"{}}}}})",
                  half + gap_mm, more));
  REQUIRE(spec);
  return judge::sound_boxes(*spec, {{"a.obj", obj}}, "test");
}

/// The same card with another roof.
Structure with_roof(const BoxedCard& made, const TentSection& section) {
  Structure card = made.card;
  const Seat seat = card.elements.front().seat;
  const std::uint32_t front = card.joints.front().b.face;
  card.parts.resize(1), card.joints.clear(), card.elements.clear();
  const auto [from, to] = made.tents.front().along_mm;
  add_glued_roof(card, seat, front, section, "roof", from, to);
  return card;
}

bool fails(const PartsVerifyReport& report, const std::string& name) {
  return std::any_of(report.checks.begin(), report.checks.end(), [&](const VerifyCheck& check) {
    return check.name == name && check.failed > 0;
  });
}

}  // namespace

TEST_CASE("random glued roofs verify and follow their closed form; 2 % outside they are refused",
          "[property][parts][facets]") {
  std::mt19937 random(kSeed + 4);
  const int count = testing::rounds(40, 4);
  for (int k = 0; k < count; ++k) {
    const double half = uniform(random, 20.0, 40.0), length = uniform(random, 30.0, 90.0),
                 walls = uniform(random, 15.0, 50.0), rise = half * uniform(random, 1.0, 1.7),
                 gap = half * uniform(random, 0.3, 1.5);
    CAPTURE(kSeed, k, half, length, walls, rise, gap);
    const auto sound = glued(house_obj(half, length, walls, rise), half, gap);
    if (!sound) FAIL(message(sound.error()));
    const BoxedCard& made = sound->made;
    REQUIRE(made.tents.size() == 1);
    CHECK(sound->report.degrees_of_freedom == 1U);
    CHECK(sound->report.wobble_mm.value_or(9.0) <= 1.0);
    CHECK(apart_mm(made.card) < 1e-9);
    const TentSection& own = made.tents.front().section;
    CHECK(own.foot_mm + own.strut_at_mm == Approx(own.strut_foot_mm + own.strut_mm).epsilon(1e-12));
    for (const double psi : {0.05, 0.7, 1.5}) {
      // The sheet of the roof is turned over, so up the roof is -u.
      const Vec3 up = -posed(made.card, psi)[made.tents.front().roof_part][0].linear().col(0);
      CHECK(std::atan2(up.z(), up.x()) == Approx(own.roof_rad(psi)).margin(1e-9));
    }
    CHECK(judged(with_roof(made, own)).ok());
    TentSection too_long = own;
    too_long.strut_mm *= 1.02;
    CHECK(fails(judged(with_roof(made, too_long)), "opening"));
    // A ridge that reaches the wall goes through it.
    const TentSection behind = tent_at(own.foot_mm, 1.02 * own.foot_mm / std::cos(own.slope_rad),
                                       own.slope_rad, own.strut_at_mm);
    CHECK(behind.clearance_mm() < 0.0);
    CHECK_FALSE(firmest_tent(behind.foot_mm, behind.roof_mm, behind.slope_rad));
    CHECK(fails(judged(with_roof(made, behind)), "crossing"));
    Structure loose = made.card;
    loose.joints.erase(loose.joints.begin() + 1);  // the tab of the strut's foot
    CHECK(fails(judged(loose), "degrees_of_freedom"));
  }
}

TEST_CASE("a house and a church with glued roofs hold in paper; other roofs say why they cannot",
          "[property][parts][facets]") {
  const std::string house = house_obj(30.0, 60.0, 35.0, 36.0);
  const auto sound = glued(house, 30.0, 20.0);
  if (!sound) FAIL(message(sound.error()));
  CHECK(sound->made.panels == 6);
  CHECK(sound->made.tabs == 3);
  CHECK(sound->report.wobble_mm.value_or(9.0) <= 1.0);
  CHECK(sound->made.warnings.empty());
  // A tower beside the house becomes facets; the roof stays.
  std::string church = house;
  for (const double z : {0.0, 55.0})
    for (const auto& [x, y] : {std::pair(-10.0, 60.0), std::pair(10.0, 60.0), std::pair(10.0, 80.0),
                               std::pair(-10.0, 80.0)})
      church += fmt::format("v {} {} {}\n", x, y, z);
  church +=
      "f 14 13 12 11\nf 15 16 17 18\nf 11 12 16 15\nf 12 13 17 16\nf 13 14 18 17\n"
      "f 14 11 15 18\n";
  const auto with_tower = glued(church, 30.0, 20.0, R"(,"hinge_cost_mm3":800,"min_fold_mm":10)");
  if (!with_tower) FAIL(message(with_tower.error()));
  REQUIRE(with_tower->made.tents.size() == 1);
  CHECK(with_tower->report.degrees_of_freedom == 1U);
  CHECK(with_tower->report.wobble_mm.value_or(9.0) <= 1.0);
  CHECK(with_tower->made.panels > 6);
  const auto refused = [](const Result<judge::SoundBoxes>& made, const std::string& what) {
    REQUIRE_FALSE(made);
    CHECK(made.error().place == "/facets/sloped");
    CAPTURE(message(made.error()));
    CHECK(made.error().detail.find(what) != std::string::npos);
  };
  refused(glued(house_obj(40.0, 60.0, 35.0, 24.0), 40.0, 5.0), "would be loose");
  refused(glued(house, 30.0, -31.0), "through the wall");
}

}  // namespace parts_property_test
