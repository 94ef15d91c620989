// SPDX-License-Identifier: MIT
#include "core/judge/glue_guide.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"
#include "core/geometry/disjoint_sets.hpp"
#include "core/geometry/triangulate.hpp"
#include "core/judge/glue_order.hpp"
#include "core/judge/slide_order.hpp"
#include "core/text/utf8.hpp"
#include "core/verify/parts/assembled.hpp"
#include "core/verify/parts/followed.hpp"
#include "core/verify/parts/joint_model.hpp"

namespace popcut::judge {
namespace {

using Eigen::Isometry3d;
using verify::Assignment;
using verify::CardJoint;
using verify::JointKind;

constexpr double kHalfOpen_rad = radians(100.0), kOpen_rad = radians(165.0);
constexpr double kFinger_mm = 25.0;  ///< so much room a finger needs, on a slant
constexpr double kTouching_mm = 0.3;
constexpr double kAslant = 1e-4;  ///< sine of the angle between slots that count as parallel
constexpr std::size_t kMostGlued = 300;

std::string listed(const std::vector<std::string>& words) {
  if (words.size() < 2) return words.empty() ? std::string() : words.front();
  return fmt::format("{} and {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

/// A, B, ... Z, AA, AB, ...
std::string letter_of(std::size_t number) {
  std::string out(1, static_cast<char>('A' + number % 26));
  return number < 26 ? out : letter_of(number / 26 - 1) + out;
}

/// A flat sheet as a pattern without a card. Faces that lie in one plane have no line between them.
Pattern pattern_of(const std::string& name, const verify::FoldModel& sheet) {
  Pattern out;
  out.name = name;
  out.card = false;
  for (const Vec2& p : sheet.flat) out.vertices.push_back({p.x(), 0.0, p.y()});
  out.face_first = sheet.face_first;
  out.face_vertices = sheet.face_vertices;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::int32_t> left_of;
  for (std::size_t f = 0; f < sheet.faces(); ++f) {
    const auto corners = verify::face_of(sheet, f);
    for (std::size_t k = 0; k < corners.size(); ++k)
      left_of[{corners[k], corners[(k + 1) % corners.size()]}] = static_cast<std::int32_t>(f);
  }
  const auto face_at = [&](std::uint32_t from, std::uint32_t to) {
    const auto found = left_of.find({from, to});
    return found == left_of.end() ? -1 : found->second;
  };
  for (std::size_t e = 0; e < sheet.edges.size(); ++e) {
    const Assignment what = sheet.assignment[e];
    if (verify::joins(what) || what == Assignment::Unassigned) continue;
    const auto [from, to] = sheet.edges[e];
    out.edges.push_back({from, to, face_at(from, to), face_at(to, from),
                         what == Assignment::Mountain ? EdgeRole::Mountain
                         : what == Assignment::Valley ? EdgeRole::Valley
                         : what == Assignment::Cut    ? EdgeRole::Slit
                                                      : EdgeRole::Outline});
  }
  return out;
}

class CardGuide {
 public:
  CardGuide(verify::JointModel model, const Progress& progress)
      : model_(std::move(model)), progress_(progress) {}

  Result<GlueGuide> run() {
    // An order looks at all pairs of parts, and who has more of them does not glue by hand.
    if (model_.parts.size() > kMostGlued)
      return fail(ErrorKind::OutOfRange, "/file_frames",
                  fmt::format("has {} parts; a guide is made for at most {}", model_.parts.size(),
                              kMostGlued));
    if (auto done = find_units(); !done) return tl::unexpected(done.error());
    if (auto done = open_card(); !done) return tl::unexpected(done.error());
    if (auto done = add_parts(); !done) return tl::unexpected(done.error());
    name_pages();
    find_tabs();
    const std::vector<std::size_t> order = glue_order(units_.size(), contacts());
    for (std::size_t p = 0; p < model_.parts.size(); ++p)
      if (units_[unit_of_[p]].size() == 1 || !out_.parts[p].folds.folds.empty()) add_fold_steps(p);
    for (const std::vector<std::size_t>& unit : units_)
      if (auto done = add_slide_steps(unit); !done) return tl::unexpected(done.error());
    std::vector<std::size_t> standing;
    add_glue_steps(units_.front(), standing);
    std::vector<std::size_t> encloser(units_.size(), 0);
    for (const std::size_t unit : order) encloser[unit] = encloser_of(unit);
    for (const std::size_t unit : order) {
      if (encloser[unit] != 0) continue;
      for (const std::size_t inner : order)
        if (encloser[inner] == unit) add_inner_step(units_[inner].front(), units_[unit].front());
      add_glue_steps(units_[unit], standing);
    }
    if (out_.steps.empty() || out_.steps.back().kind == GlueStepKind::Fold) return std::move(out_);
    out_.steps.back().words += " The card is done.";
    return std::move(out_);
  }

 private:
  // 1. The card in space.

  /// Parts that cross in slots are put together before they are glued: they are one unit.
  Result<void> find_units() {
    DisjointSets sets(model_.parts.size());
    for (const CardJoint& joint : model_.joints) {
      if (joint.kind != JointKind::Cross) continue;
      if (joint.a.part == 0 || joint.b.part == 0)
        return fail(ErrorKind::Infeasible, joint.place,
                    "crosses the card itself in slots; a guide puts together only parts that stand "
                    "on it");
      sets.join(static_cast<std::uint32_t>(joint.a.part), static_cast<std::uint32_t>(joint.b.part));
    }
    units_.resize(sets.number(unit_of_));
    for (std::size_t p = 0; p < unit_of_.size(); ++p) units_[unit_of_[p]].push_back(p);
    return {};
  }

  Result<void> open_card() {
    auto card = verify::whole_card(model_, ", so they cannot be glued");
    if (!card) return tl::unexpected(card.error());
    card_ = std::move(*card);
    tell(progress_, "opening the card");
    const double open = std::min(kOpen_rad, radians(model_.opens_deg)),
                 half = std::min(kHalfOpen_rad, 0.6 * open);
    verify::Followed motion = verify::follow(card_, {half, open});
    for (verify::BodyState& state : motion.states) level(state);
    for (std::size_t k = 0; k < motion.states.size(); ++k)
      (motion.opening_rad[k] < 0.5 * (half + open) ? half_open_ : open_) =
          &states_.emplace_back(motion.states[k]);
    if (half_open_ == nullptr || open_ == nullptr)
      return fail(ErrorKind::Infeasible, "/popcut:joints",
                  "do not let the card open, so nobody can glue it; 'popcut verify' says where it "
                  "stops");
    return {};
  }

  /// Turns the card so that both pages slope alike.
  void level(verify::BodyState& state) const {
    const verify::BodyHinge& spine = card_.hinges[card_.drive];
    const Vec3 up = place(state, 0, 0).linear().col(2) +
                    place(state, 0, model_.parts.front().sheet.faces() - 1).linear().col(2);
    const Vec3 along = state[spine.right].linear() * spine.right_along;
    const Vec3 level_up = unit(Vec3(up - dot(up, along) * along));
    // Both are at right angles to the spine, so the turn between them is one about it.
    const Vec3 top(0.0, 0.0, 1.0);
    const double turn_rad = std::atan2(dot(level_up.cross(top), along), dot(level_up, top));
    const Isometry3d turn(Eigen::AngleAxisd(turn_rad, along));
    for (Isometry3d& body : state) body = turn * body;
  }

  [[nodiscard]] Isometry3d place(const verify::BodyState& state, std::size_t part,
                                 std::size_t face) const {
    const std::size_t panel = card_.panel_of(part, face);
    return state[card_.body[panel]] * card_.in_body[panel];
  }

  Result<void> add_parts() {
    out_.name = model_.title.empty() ? "card" : model_.title;
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      const verify::CardPart& part = model_.parts[p];
      GluePart one{part.name, pattern_of(part.name, part.sheet), {}, {}, {}};
      auto folds = hands::fold_guide(one.sheet);
      if (!folds) return tl::unexpected(within(part.place, folds.error()));
      one.folds = std::move(*folds);
      for (std::size_t f = 0; f < part.sheet.faces(); ++f) {
        one.half_open.push_back(place(*half_open_, p, f));
        one.open.push_back(place(*open_, p, f));
      }
      out_.parts.push_back(std::move(one));
    }
    return {};
  }

  /// The panels of the card are the left and the right page for who looks along its spine.
  void name_pages() {
    page_name_.assign(card_.sheets.front().panels, "the card");
    if (page_name_.size() != 2) return;
    const verify::FoldModel& sheet = model_.parts.front().sheet;
    std::array<double, 2> middle{}, corners{};
    for (std::size_t f = 0; f < sheet.faces(); ++f)
      for (const std::uint32_t v : verify::face_of(sheet, f)) {
        const std::size_t panel = card_.sheets.front().panel_of_face[f];
        middle[panel] += sheet.flat[v].x(), corners[panel] += 1.0;
      }
    const bool first_is_left = middle[0] / corners[0] < middle[1] / corners[1];
    page_name_ = {first_is_left ? "the left page" : "the right page",
                  first_is_left ? "the right page" : "the left page"};
  }

  // 2. Tabs, and what a finger reaches.

  void find_tabs() {
    for (std::size_t j = 0; j < model_.joints.size(); ++j) {
      const CardJoint& joint = model_.joints[j];
      if (joint.kind != JointKind::Glue) continue;
      GlueTab tab;
      tab.joint = j;
      tab.part = joint.a.part, tab.on_part = joint.b.part;
      tab.face = static_cast<std::uint32_t>(joint.a.face);
      tab.on_face = static_cast<std::uint32_t>(joint.b.face);
      const Isometry3d lay = verify::laid_on(joint.a.line, joint.b.line, joint.turned);
      const verify::FoldModel& sheet = model_.parts[tab.part].sheet;
      for (const std::uint32_t v : verify::face_of(sheet, tab.face)) {
        tab.outline.push_back(sheet.flat[v]);
        tab.place.push_back(Vec3(lay * verify::lifted(sheet.flat[v])).head<2>());
      }
      tab.on_front = lies_on_front(tab);
      tabs_.push_back(std::move(tab));
    }
    is_glued_.assign(tabs_.size(), false);
    inner_of_.resize(model_.parts.size());
  }

  /// Whether the panels that a tab is folded from are on the printed side of what it is glued on.
  [[nodiscard]] bool lies_on_front(const GlueTab& tab) const {
    const Isometry3d under = place(*half_open_, tab.on_part, tab.on_face);
    double above = 0.0;
    for (const verify::Hinge& hinge : card_.sheets[tab.part].hinges) {
      if (hinge.left != tab.face && hinge.right != tab.face) continue;
      const std::uint32_t beside = hinge.left == tab.face ? hinge.right : hinge.left;
      const Isometry3d lay = place(*half_open_, tab.part, beside);
      for (const std::uint32_t v : verify::face_of(model_.parts[tab.part].sheet, beside))
        above += dot(
            Vec3(under.linear().col(2)),
            Vec3(lay * verify::lifted(model_.parts[tab.part].sheet.flat[v]) - under.translation()));
    }
    return above > 0.0;
  }

  using Triangle3 = std::array<Vec3, 3>;

  [[nodiscard]] std::vector<Triangle3> triangles_of(std::size_t part) const {
    const verify::FoldModel& sheet = model_.parts[part].sheet;
    std::vector<Triangle3> out;
    for (std::size_t f = 0; f < sheet.faces(); ++f) {
      std::vector<Triangle> cut;
      if (!triangulate(sheet.flat, verify::face_of(sheet, f), cut)) continue;
      const Isometry3d lay = place(*open_, part, f);
      for (const Triangle& t : cut)
        out.push_back({lay * verify::lifted(sheet.flat[t[0]]),
                       lay * verify::lifted(sheet.flat[t[1]]),
                       lay * verify::lifted(sheet.flat[t[2]])});
    }
    return out;
  }

  /// Whether a way of `kFinger_mm` from a point goes through a triangle.
  static bool is_hit(const Vec3& from, const Vec3& way, const Triangle3& triangle) {
    const Vec3 e1 = triangle[1] - triangle[0], e2 = triangle[2] - triangle[0];
    const Vec3 p = cross(way, e2);
    const double turn = dot(e1, p);
    if (std::abs(turn) < 1e-12) return false;
    const Vec3 t = from - triangle[0];
    const double a = dot(t, p) / turn;
    if (a < 0.0 || a > 1.0) return false;
    const Vec3 q = cross(t, e1);
    const double b = dot(way, q) / turn;
    if (b < 0.0 || a + b > 1.0) return false;
    const double far = dot(e2, q) / turn;
    return far > kTouching_mm && far < kFinger_mm;
  }

  /// A finger presses a tab from above and from beyond its outer edge, since its panel stands at
  /// the other one; and a part that is put on a tab from its other side.
  [[nodiscard]] std::vector<GlueContact> contacts() const {
    std::vector<std::vector<Triangle3>> triangles;
    std::vector<Eigen::AlignedBox3d> near;  // of each part, and what a finger's way may begin in
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      triangles.push_back(triangles_of(p));
      Eigen::AlignedBox3d& box = near.emplace_back();
      for (const Triangle3& t : triangles.back())
        for (const Vec3& at : t) box.extend(at);
      box.min().array() -= kFinger_mm, box.max().array() += kFinger_mm;
    }
    const std::vector<std::size_t> depth = depths();
    std::vector<GlueContact> out;
    for (const GlueTab& tab : tabs_) {
      const std::uint32_t own_unit = unit_of_[tab.part], on_unit = unit_of_[tab.on_part];
      if (own_unit == on_unit) continue;
      const bool is_put_on = tab.on_part != 0 && depth[tab.on_part] > depth[tab.part];
      const CardJoint& joint = model_.joints[tab.joint];
      const Isometry3d lay = place(*open_, tab.on_part, tab.on_face);
      Vec2 middle{0.0, 0.0};
      for (const Vec2& p : tab.place) middle += p / static_cast<double>(tab.place.size());
      const Vec2 fold_middle = 0.5 * (joint.b.line[0] + joint.b.line[1]);
      const Vec3 up = (tab.on_front != is_put_on ? 1.0 : -1.0) * Vec3(lay.linear().col(2));
      const Vec3 outward = unit(Vec3(lay.linear() * verify::lifted(middle - fold_middle)));
      const Vec3 way = is_put_on ? up : unit(Vec3(up + outward));
      GlueContact contact{own_unit, on_unit, 0, {}};
      contact.hides.assign(units_.size(), 0);
      constexpr double kInward = 0.3;
      for (std::size_t k = 0; k < tab.place.size() && contact.places < 31; ++k) {
        const Vec3 from =
            lay * verify::lifted(Vec2(tab.place[k] + kInward * (middle - tab.place[k])));
        for (std::size_t q = 1; q < model_.parts.size(); ++q)
          if (unit_of_[q] != own_unit && unit_of_[q] != on_unit && near[q].contains(from) &&
              std::any_of(triangles[q].begin(), triangles[q].end(),
                          [&](const Triangle3& t) { return is_hit(from, way, t); }))
            contact.hides[unit_of_[q]] |= 1U << contact.places;
        ++contact.places;
      }
      out.push_back(std::move(contact));
    }
    for (const CardJoint& joint : model_.joints)  // what no tab holds
      if (joint.kind != JointKind::Glue && unit_of_[joint.a.part] != unit_of_[joint.b.part])
        out.push_back({unit_of_[joint.a.part], unit_of_[joint.b.part], 0,
                       std::vector<std::uint32_t>(units_.size(), 0)});
    return out;
  }

  /// How many joints a part is away from the card.
  [[nodiscard]] std::vector<std::size_t> depths() const {
    std::vector<std::size_t> depth(model_.parts.size(), model_.parts.size());
    depth[0] = 0;
    for (bool any = true; any;) {
      any = false;
      for (const CardJoint& joint : model_.joints)
        for (const auto& [p, q] :
             {std::pair(joint.a.part, joint.b.part), std::pair(joint.b.part, joint.a.part)})
          if (depth[p] + 1 < depth[q]) depth[q] = depth[p] + 1, any = true;
    }
    return depth;
  }

  /// The unit that a part stands inside of, and hangs on alone; else 0. Nobody reaches its tabs
  /// once that unit is closed around it.
  [[nodiscard]] std::size_t encloser_of(std::size_t unit) const {
    std::size_t on = 0;
    for (const CardJoint& joint : model_.joints) {
      const std::size_t a = unit_of_[joint.a.part], b = unit_of_[joint.b.part];
      if ((a == unit) == (b == unit)) continue;
      const std::size_t other = a == unit ? b : a;
      if (joint.kind != JointKind::Glue || other == 0 || (on != 0 && other != on)) return 0;
      on = other;
    }
    if (on == 0 || units_[unit].size() > 1 || units_[on].size() > 1) return 0;
    constexpr double kSlack_mm = 0.01;
    const Eigen::AlignedBox3d inner = box_of(units_[unit].front()),
                              around = box_of(units_[on].front());
    const bool is_inside = (inner.min().array() >= around.min().array() - kSlack_mm).all() &&
                           (inner.max().array() <= around.max().array() + kSlack_mm).all();
    return is_inside ? on : 0;
  }

  [[nodiscard]] Eigen::AlignedBox3d box_of(std::size_t part) const {
    Eigen::AlignedBox3d out;
    for (const Triangle3& t : triangles_of(part))
      for (const Vec3& at : t) out.extend(at);
    return out;
  }

  // 3. Steps.

  void add_fold_steps(std::size_t p) {
    const GluePart& part = out_.parts[p];
    const std::size_t folds = part.folds.folds.size(), waste = part.folds.waste.size();
    for (std::size_t first = 0; first < folds || (first == 0 && waste > 0);
         first += hands::kMostFoldsAStep) {
      GlueStep step{.kind = GlueStepKind::Fold, .part = p};
      std::size_t mountains = 0;
      for (std::size_t k = first; k < std::min(folds, first + hands::kMostFoldsAStep); ++k) {
        step.folds.push_back(static_cast<std::uint32_t>(k));
        mountains += part.folds.folds[k].is_mountain() ? 1 : 0;
      }
      const std::size_t valleys = step.folds.size() - mountains;
      std::vector<std::string> what;
      if (mountains > 0)
        what.push_back(mountains == 1
                           ? "1 mountain fold (red, its ridge toward you)"
                           : fmt::format("{} mountain folds (red, ridges toward you)", mountains));
      if (valleys > 0)
        what.push_back(fmt::format("{} valley fold{} (blue, away from you)", valleys,
                                   valleys == 1 ? "" : "s"));
      step.words = shown_text(part.name) + ":";
      if (first == 0 && waste > 0)
        step.words += fmt::format(" take out {} piece{} of waste{}", waste, waste == 1 ? "" : "s",
                                  what.empty() ? "." : ", then");
      if (!what.empty()) step.words += fmt::format(" crease {}.", listed(what));
      out_.steps.push_back(std::move(step));
      if (folds == 0) break;
    }
  }

  /// The panels of a part that cross others stand upright as one piece.
  Result<void> add_upright(std::size_t part, const Vec3& up, std::vector<UprightPiece>& out) const {
    std::size_t panel = 0;
    bool is_found = false;
    for (const CardJoint& joint : model_.joints) {
      if (joint.kind != JointKind::Cross) continue;
      for (const verify::JointSide* side : {&joint.a, &joint.b}) {
        if (side->part != part) continue;
        const Isometry3d lay = place(*open_, part, side->face);
        const Vec3 way = lay.linear() * unit(verify::lifted(side->line[1] - side->line[0]));
        const std::size_t own = card_.sheets[part].panel_of_face[side->face];
        if (norm(Vec3(cross(way, up))) > kAslant || (is_found && own != panel))
          return fail(ErrorKind::Infeasible, joint.place,
                      "crosses in another direction than the slots before; a guide puts parts "
                      "together that all slide in one direction, each with one panel");
        panel = own, is_found = true;
      }
    }
    const verify::FoldModel& sheet = model_.parts[part].sheet;
    UprightPiece& piece = out.emplace_back();
    for (std::size_t f = 0; f < sheet.faces(); ++f) {
      if (card_.sheets[part].panel_of_face[f] != panel) continue;
      const Isometry3d lay = place(*open_, part, f);
      if (piece.faces.empty()) {
        piece.along = unit(Vec3(cross(up, Vec3(lay.linear().col(2)))));
        piece.origin = lay.translation();
      }
      std::vector<Vec2>& face = piece.faces.emplace_back();
      for (const std::uint32_t v : verify::face_of(sheet, f)) {
        const Vec3 at = lay * verify::lifted(sheet.flat[v]);
        face.push_back({dot(Vec3(at - piece.origin), piece.along), dot(at, up)});
      }
    }
    return {};
  }

  /// Which way the parts of a unit are pushed together: up on the open card.
  [[nodiscard]] Vec3 up_of(const std::vector<std::size_t>& unit_parts) const {
    for (const CardJoint& joint : model_.joints) {
      if (joint.kind != JointKind::Cross || unit_of_[joint.a.part] != unit_of_[unit_parts.front()])
        continue;
      const Isometry3d lay = place(*open_, joint.a.part, joint.a.face);
      const Vec3 way = lay.linear() * unit(verify::lifted(joint.a.line[1] - joint.a.line[0]));
      return way.z() < 0.0 ? Vec3(-way) : way;
    }
    return {0.0, 0.0, 1.0};
  }

  Result<void> add_slide_steps(const std::vector<std::size_t>& unit_parts) {
    if (unit_parts.size() < 2) return {};
    const Vec3 up = up_of(unit_parts);
    std::vector<UprightPiece> pieces;
    for (const std::size_t p : unit_parts)
      if (auto done = add_upright(p, up, pieces); !done) return done;
    std::vector<std::size_t> stuck;
    const auto order = slide_order(pieces, up, stuck);
    if (!order) {
      std::vector<std::string> names;
      names.reserve(stuck.size());
      for (const std::size_t k : stuck)
        names.push_back(shown_text(model_.parts[unit_parts[k]].name));
      return fail(ErrorKind::Infeasible, "/popcut:joints",
                  fmt::format("do not let the parts be put together from above: {} {}",
                              listed(names), order.error().detail));
    }
    std::vector<std::size_t> standing;
    for (std::size_t n = 0; n < order->size(); ++n) {
      std::vector<std::size_t> parts;
      for (const std::size_t k : (*order)[n]) parts.push_back(unit_parts[k]);
      if (n == 0) {
        add_first_step(parts, pieces, (*order)[n], up);
        standing = std::move(parts);
        continue;
      }
      for (std::size_t k = 0; k < parts.size(); ++k) {
        add_slide_step(parts[k], pieces[(*order)[n][k]], up, standing);
        standing.push_back(parts[k]);
      }
    }
    return {};
  }

  /// "Take 2 pieces of waste out of x3"; empty without waste.
  [[nodiscard]] std::string waste_words(std::size_t part) const {
    const std::size_t waste = out_.parts[part].folds.waste.size();
    if (waste == 0 || !out_.parts[part].folds.folds.empty()) return {};
    return fmt::format("Take {} piece{} of waste out of {}", waste, waste == 1 ? "" : "s",
                       shown_text(model_.parts[part].name));
  }

  /// The parts that others come down on.
  void add_first_step(const std::vector<std::size_t>& parts,
                      const std::vector<UprightPiece>& pieces,
                      const std::vector<std::size_t>& which, const Vec3& up) {
    constexpr double kOnGround_mm = 1.0;
    std::vector<double> foot;
    for (const std::size_t k : which) {
      foot.push_back(1e9);
      for (const std::vector<Vec2>& face : pieces[k].faces)
        for (const Vec2& at : face) foot.back() = std::min(foot.back(), at.y());
    }
    const double ground = *std::min_element(foot.begin(), foot.end());
    GlueStep step{.kind = GlueStepKind::Slide, .part = parts.front()};
    step.with.assign(parts.begin() + 1, parts.end());
    step.up = up;
    std::vector<std::string> stand, hang;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      if (const std::string waste = waste_words(parts[k]); !waste.empty())
        step.words += waste + ". ";
      (foot[k] < ground + kOnGround_mm ? stand : hang)
          .push_back(shown_text(model_.parts[parts[k]].name));
    }
    step.words += stand.size() == 1
                      ? fmt::format("Stand up {}, with its slots up.", stand.front())
                      : fmt::format("Stand up {}, side by side in this order, with their slots up.",
                                    listed(stand));
    if (!hang.empty())
      step.words += fmt::format(" Hold {} in the air until the next parts hold {}.", listed(hang),
                                hang.size() == 1 ? "it" : "them");
    out_.steps.push_back(std::move(step));
  }

  /// One part comes down on those that are there.
  void add_slide_step(std::size_t part, const UprightPiece& piece, const Vec3& up,
                      const std::vector<std::size_t>& standing) {
    GlueStep step{.kind = GlueStepKind::Slide, .part = part};
    step.standing = standing, step.up = up;
    std::vector<std::pair<double, std::size_t>> along;  // where on its sheet, and which slot
    for (std::size_t j = 0; j < model_.joints.size(); ++j) {
      const CardJoint& joint = model_.joints[j];
      if (joint.kind != JointKind::Cross) continue;
      for (const auto& [own, other] :
           {std::pair(&joint.a, &joint.b), std::pair(&joint.b, &joint.a)}) {
        if (own->part != part ||
            std::find(standing.begin(), standing.end(), other->part) == standing.end())
          continue;
        // From left to right where up on the sheet is up; the slot goes up to the lowest paper.
        const Isometry3d lay = place(*open_, part, own->face);
        std::array<Vec2, 2> slot = own->line;
        if (dot(Vec3(lay.linear() * verify::lifted(slot[1] - slot[0])), up) < 0.0)
          std::swap(slot[0], slot[1]);
        const Vec2 up_here = unit(Vec2(slot[1] - slot[0]));
        const Vec3 foot = lay * verify::lifted(slot[0]);
        const PaperReach paper = reach_at(piece, dot(Vec3(foot - piece.origin), piece.along));
        const double slot_mm = paper.low - dot(foot, up);
        if (slot_mm > 0.0 && slot_mm < norm(Vec2(slot[1] - slot[0])))
          slot[1] = slot[0] + slot_mm * up_here;
        along.emplace_back(cross(slot[0], up_here), out_.slots.size());
        out_.slots.push_back({j, part, other->part, slot});
      }
    }
    std::sort(along.begin(), along.end());
    std::vector<std::string> onto;
    for (const auto& [at, slot] : along) {
      step.slots.push_back(slot);
      onto.push_back(shown_text(model_.parts[out_.slots[slot].onto].name));
    }
    const std::string waste = waste_words(part), name = shown_text(model_.parts[part].name);
    step.words = waste.empty() ? fmt::format("{}: slide it straight down", name)
                               : fmt::format("{}, and slide it straight down", waste);
    if (onto.size() == 1) step.words += " onto " + onto.front();
    if (onto.size() > 1)
      step.words += fmt::format(" onto {}, from left to right on its printed side", listed(onto));
    step.words += '.';
    out_.steps.push_back(std::move(step));
  }

  [[nodiscard]] std::string target_name(const GlueTab& tab, std::size_t unit) const {
    const bool is_own = unit_of_[tab.part] == unit;
    const std::size_t on = is_own ? tab.on_part : tab.part;
    if (on == (is_own ? tab.part : tab.on_part)) return "itself";
    if (on != 0) return shown_text(model_.parts[on].name);
    return page_name_[card_.sheets.front()
                          .panel_of_face[on == tab.on_part ? tab.on_face : tab.face]];
  }

  /// What a step calls a part, or parts that were put together.
  [[nodiscard]] std::string unit_name(std::size_t unit) const {
    const std::string first = shown_text(model_.parts[units_[unit].front()].name);
    if (units_[unit].size() == 1) return first;
    const auto several = std::count_if(units_.begin(), units_.end(),
                                       [](const auto& parts) { return parts.size() > 1; });
    return several == 1 ? "All that you put together" : "What you put together with " + first;
  }

  /// A part is glued into another one, which is then folded around it.
  void add_inner_step(std::size_t part, std::size_t around) {
    GlueStep step{.kind = GlueStepKind::Glue, .part = part};
    step.standing = {around};
    const std::string target = shown_text(model_.parts[around].name);
    step.words = shown_text(model_.parts[part].name) + ":";
    for (std::size_t k = 0; k < tabs_.size(); ++k) {
      if (is_glued_[k] || (tabs_[k].part != part && tabs_[k].on_part != part)) continue;
      is_glued_[k] = true;
      GlueTab tab = tabs_[k];
      tab.letter = letter_of(out_.tabs.size());
      const bool is_own = tab.part == part;
      step.words += step.tabs.empty() ? std::string(" While ") + target + " is open, glue"
                                      : " Fold " + target + " around it, and glue";
      step.words += is_own ? fmt::format(" tab {} on it, on outline {}.", tab.letter, tab.letter)
                           : fmt::format(" its tab {} on outline {}.", tab.letter, tab.letter);
      step.tabs.push_back(out_.tabs.size());
      out_.tabs.push_back(std::move(tab));
    }
    inner_of_[around].push_back(part);
    out_.steps.push_back(std::move(step));
  }

  /// A part, or parts that were put together, is glued tab by tab; those on one target together.
  /// Then it stands.
  void add_glue_steps(const std::vector<std::size_t>& unit_parts,
                      std::vector<std::size_t>& standing) {
    const std::size_t unit = unit_of_[unit_parts.front()];
    const auto is_in = [&](std::size_t p) { return unit_of_[p] == unit; };
    const auto is_there = [&](std::size_t p) {
      return is_in(p) || std::find(standing.begin(), standing.end(), p) != standing.end();
    };
    add_glue_step(unit, is_in, is_there, standing);
    standing.insert(standing.end(), unit_parts.begin(), unit_parts.end());
    const std::vector<std::size_t>& inner = inner_of_[unit_parts.front()];
    standing.insert(standing.end(), inner.begin(), inner.end());
  }

  template <typename IsIn, typename IsThere>
  void add_glue_step(std::size_t unit, const IsIn& is_in, const IsThere& is_there,
                     const std::vector<std::size_t>& standing) {
    struct Group {
      std::string target;
      bool is_itself{}, is_page{};
      std::vector<std::string> own, others;  ///< letters: its own tabs, and tabs of the target
    };
    GlueStep step{.kind = GlueStepKind::Glue, .part = units_[unit].front()};
    step.with.assign(units_[unit].begin() + 1, units_[unit].end());
    const std::vector<std::size_t>& inner = inner_of_[units_[unit].front()];
    step.with.insert(step.with.end(), inner.begin(), inner.end());
    step.standing = standing;
    std::vector<Group> groups;
    for (const bool itself : {true, false})
      for (std::size_t k = 0; k < tabs_.size(); ++k) {
        const GlueTab& found = tabs_[k];
        if (is_glued_[k] || itself != (found.part == found.on_part)) continue;
        if ((!is_in(found.part) && !is_in(found.on_part)) || !is_there(found.part) ||
            !is_there(found.on_part))
          continue;
        is_glued_[k] = true;
        GlueTab tab = found;
        tab.letter = letter_of(out_.tabs.size());
        step.tabs.push_back(out_.tabs.size());
        const std::string target = target_name(tab, unit);
        auto group = std::find_if(groups.begin(), groups.end(),
                                  [&](const Group& one) { return one.target == target; });
        if (group == groups.end())
          group = groups.insert(groups.end(),
                                {target, itself, tab.on_part == 0 || tab.part == 0, {}, {}});
        (is_in(tab.part) ? group->own : group->others).push_back(tab.letter);
        out_.tabs.push_back(std::move(tab));
      }
    const std::vector<std::string> slides = slides_into(is_in, is_there);
    if (groups.empty() && slides.empty()) return;
    step.words = unit_name(unit) + ":";
    for (const std::string& words : slides) step.words += fmt::format(" {}.", words);
    std::size_t pages = 0;
    for (std::size_t k = 0; k < groups.size(); ++k) {
      const Group& group = groups[k];
      const auto tabs = [](const std::vector<std::string>& letters) {
        return fmt::format("tab{} {}", letters.size() == 1 ? "" : "s", listed(letters));
      };
      const auto outlines = [](const std::vector<std::string>& letters) {
        return fmt::format("outline{} {}", letters.size() == 1 ? "" : "s", listed(letters));
      };
      pages += group.is_page ? 1 : 0;
      if (!group.own.empty() && pages == 2 && group.is_page)
        step.words += fmt::format(
            " Put glue on {}, shut the card so that {} takes it on {}, press, and open it.",
            tabs(group.own), group.target, outlines(group.own));
      else if (!group.own.empty())
        step.words +=
            fmt::format(" {}lue {} on {}, on {}.", group.is_page ? "Fold it flat, and g" : "G",
                        tabs(group.own), group.target, outlines(group.own));
      if (!group.others.empty())
        step.words += fmt::format(" Glue it on {} of {}, with {} of its own there.",
                                  tabs(group.others), group.target, outlines(group.others));
    }
    out_.steps.push_back(std::move(step));
  }

  /// What of a part is pushed through slits, or joined without a tab.
  template <typename IsIn, typename IsThere>
  [[nodiscard]] std::vector<std::string> slides_into(const IsIn& is_in,
                                                     const IsThere& is_there) const {
    std::vector<std::string> out;
    for (const CardJoint& joint : model_.joints) {
      if (joint.kind == JointKind::Glue || joint.kind == JointKind::Cross ||
          joint.a.part == joint.b.part || (!is_in(joint.a.part) && !is_in(joint.b.part)) ||
          !is_there(joint.a.part) || !is_there(joint.b.part))
        continue;
      const std::string a = shown_text(model_.parts[joint.a.part].name),
                        b = shown_text(model_.parts[joint.b.part].name);
      std::string words = joint.kind == JointKind::Slot
                              ? fmt::format("Push {} through the slit of {}", b, a)
                              : fmt::format("Join {} and {} with tape where they meet", a, b);
      if (std::find(out.begin(), out.end(), words) == out.end()) out.push_back(std::move(words));
    }
    return out;
  }

  verify::JointModel model_;
  const Progress& progress_;
  verify::Assembled card_;
  std::deque<verify::BodyState> states_;
  const verify::BodyState *half_open_{}, *open_{};
  std::vector<std::vector<std::size_t>> units_;  ///< parts that are put together; the card is first
  std::vector<std::uint32_t> unit_of_;           ///< one a part
  std::vector<std::string> page_name_;
  std::vector<GlueTab> tabs_;                       ///< without letters, as in the file
  std::vector<bool> is_glued_;                      ///< one a tab: it has its step
  std::vector<std::vector<std::size_t>> inner_of_;  ///< one a part: what is glued into it
  GlueGuide out_;
};

}  // namespace

Result<GlueGuide> glue_guide(std::string_view fold_text, const Progress& progress) {
  auto model = verify::read_joint_model(fold_text);
  if (!model) return tl::unexpected(model.error());
  return CardGuide(std::move(*model), progress).run();
}

hands::Handwork handwork(const GlueGuide& guide, const hands::Hands& hands) {
  std::vector<double> lengths_mm;
  std::size_t waste = 0;
  for (const GluePart& part : guide.parts) {
    waste += part.folds.waste.size();
    for (const hands::GuideFold& fold : part.folds.folds) lengths_mm.push_back(fold.length_mm());
  }
  return hands::handwork(lengths_mm, waste, guide.tabs.size(), hands);
}

std::string_view name_of(GlueStepKind kind) {
  return kind == GlueStepKind::Fold ? "fold" : kind == GlueStepKind::Slide ? "slide" : "glue";
}

}  // namespace popcut::judge
