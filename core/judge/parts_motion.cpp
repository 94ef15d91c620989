// SPDX-License-Identifier: MIT
#include "core/judge/parts_motion.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include "core/geometry/angle.hpp"
#include "core/verify/parts/assembled.hpp"
#include "core/verify/parts/followed.hpp"
#include "core/verify/parts/joint_model.hpp"

namespace popcut::judge {
namespace parts_motion_parts {
namespace {

using Eigen::Isometry3d;
using verify::Assignment;
using verify::CardJoint;
using verify::JointKind;

constexpr double kShutAt_rad = radians(2.0), kFlatAt_rad = radians(179.0);
constexpr std::size_t kMostOpenings = 31, kFewestOpenings = 7, kMostPlaces = 1'500'000;
constexpr double kSheetGap_mm = 10.0, kWidestSheet_mm = 600.0;  // as `parts_drawing`

EdgeRole role_on_sheet(Assignment what) {
  switch (what) {
    case Assignment::Mountain:
      return EdgeRole::Mountain;
    case Assignment::Valley:
      return EdgeRole::Valley;
    case Assignment::Cut:
      return EdgeRole::Slit;
    default:
      return EdgeRole::Outline;
  }
}

/// A corner of the pattern: where it is on its own sheet, and with which panel it moves.
struct Corner {
  std::size_t part{}, face{};
  Vec2 flat;
};

/// What a tab is glued on, and how far it is shown above the front of that, mm.
struct TabBed {
  std::size_t part{}, face{};
  double above_mm{};
};

/// Where the eye of a person has its axes, in space.
struct Axes {
  Vec3 origin, toward, right, up;
};

class MovingCard {
 public:
  explicit MovingCard(verify::JointModel model) : model_(std::move(model)) {}

  Result<PartsMotion> run(const Progress& progress) {
    auto card = verify::whole_card(model_, "");
    if (!card) return tl::unexpected(card.error());
    card_ = std::move(*card);
    for (std::size_t p = 0; p < model_.parts.size(); ++p) add_part(p);
    count_tabs();
    tell(progress, "opening the card");
    if (auto done = open_card(); !done) return tl::unexpected(done.error());
    return std::move(out_);
  }

 private:
  // 1. The flat sheets.

  void add_part(std::size_t p) {
    const verify::FoldModel& flat = model_.parts[p].sheet;
    const verify::Sheet& sheet = card_.sheets[p];
    Pattern& all = out_.pattern;
    Eigen::AlignedBox2d box;
    for (const Vec2& at : flat.flat) box.extend(at);
    const Vec2 size = box.sizes();
    if (v_ > 0.0 && v_ + size.x() > kWidestSheet_mm) u_ += row_ + kSheetGap_mm, v_ = row_ = 0.0;
    ShownPart part;
    part.name = model_.parts[p].name;
    part.first_face = static_cast<std::uint32_t>(all.faces());
    part.faces = static_cast<std::uint32_t>(flat.faces());
    part.box_mm = {v_, u_, size.x(), size.y()};
    part.shift_mm = {u_ + box.max().y(), v_ - box.min().x()};
    const auto u = [&](const Vec2& at) { return part.shift_mm[0] - at.y(); };
    const auto v = [&](const Vec2& at) { return part.shift_mm[1] + at.x(); };
    if (all.face_first.empty()) all.face_first.push_back(0);
    // Both sides of a cut move on their own, so each panel has its corners to itself.
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known;
    const auto corner = [&](std::size_t f, std::uint32_t vertex) {
      const auto next = static_cast<std::uint32_t>(all.vertices.size());
      const auto [at, is_new] = known.try_emplace({sheet.panel_of_face[f], vertex}, next);
      if (is_new) {
        const Vec2& place = flat.flat[vertex];
        all.vertices.push_back({u(place), 0.0, v(place)});
        corners_.push_back({p, f, place});
      }
      return at->second;
    };
    for (std::size_t f = 0; f < flat.faces(); ++f) {
      const auto face = verify::face_of(flat, f);
      const auto number = static_cast<std::int32_t>(all.faces());
      for (std::size_t k = 0; k < face.size(); ++k) {
        const std::uint32_t from = corner(f, face[k]), to = corner(f, face[(k + 1) % face.size()]);
        all.face_vertices.push_back(from);
        const std::int32_t e = sheet.side_edge[flat.face_first[f] + k];
        if (e < 0 || verify::joins(flat.assignment[static_cast<std::size_t>(e)])) continue;
        all.edges.push_back(
            {from, to, number, -1, role_on_sheet(flat.assignment[static_cast<std::size_t>(e)])});
      }
      all.face_first.push_back(static_cast<std::uint32_t>(all.face_vertices.size()));
    }
    for (std::size_t e = 0; e < flat.edges.size(); ++e) {
      if (verify::joins(flat.assignment[e])) continue;
      const Vec2 &from = flat.flat[flat.edges[e][0]], &to = flat.flat[flat.edges[e][1]];
      all.lines.push_back({u(from), v(from), u(to), v(to), role_on_sheet(flat.assignment[e])});
    }
    std::set<std::pair<std::uint32_t, std::uint32_t>> creases;
    for (const verify::Hinge& hinge : sheet.hinges)
      if (!verify::joins(flat.assignment[hinge.edge]))
        creases.insert(
            std::minmax(sheet.panel_of_face[hinge.left], sheet.panel_of_face[hinge.right]));
    part.folds = creases.size();
    row_ = std::max(row_, size.y());
    v_ += size.x() + kSheetGap_mm;
    out_.parts.push_back(std::move(part));
  }

  void count_tabs() {
    for (const CardJoint& joint : model_.joints)
      if (joint.kind == JointKind::Glue) ++out_.parts[joint.a.part].tabs;
    out_.pattern.name = model_.title;
    out_.pattern.card = false;
    out_.pattern.design_psi_rad = radians(model_.opens_deg);
  }

  // 2. The movement.

  Result<void> open_card() {
    const double open = std::min(radians(model_.opens_deg), kFlatAt_rad);
    const std::size_t count = std::clamp(kMostPlaces / std::max<std::size_t>(corners_.size(), 1),
                                         kFewestOpenings, kMostOpenings);
    std::vector<double> goals;
    for (std::size_t k = 0; k < count; ++k)
      goals.push_back(kShutAt_rad + (open - kShutAt_rad) * static_cast<double>(k) /
                                        static_cast<double>(count - 1));
    const verify::Followed moved = verify::follow(card_, goals);
    if (moved.states.size() < 2)
      return fail(ErrorKind::Infeasible, "/popcut:joints",
                  "do not let the card open; 'popcut verify' says where it stops");
    out_.stopped = moved.shut_stopped.empty() ? moved.open_stopped : moved.shut_stopped;
    if (model_.opens_deg < 180.0) find_ground();
    find_beds(moved.states[moved.states.size() / 2]);
    find_front(moved.states.back());
    for (std::size_t k = moved.states.size(); k-- > 0;) {
      const verify::BodyState& state = moved.states[k];
      const Axes axes = axes_of(state);
      std::vector<Vec3> places;
      places.reserve(corners_.size());
      for (const Corner& corner : corners_) {
        Vec3 at =
            place(state, corner.part, corner.face) * verify::lifted(corner.flat) - axes.origin;
        if (const auto bed = beds_.find({corner.part, corner.face}); bed != beds_.end())
          at += bed->second.above_mm *
                Vec3(place(state, bed->second.part, bed->second.face).linear().col(2));
        places.emplace_back(dot(at, axes.toward), dot(at, axes.right), dot(at, axes.up));
      }
      // The last one of a card that lies flat is a degree less than that.
      const double psi_rad = moved.opening_rad[k];
      out_.motion.psi_rad.push_back(psi_rad >= kFlatAt_rad - 1e-9 ? std::numbers::pi : psi_rad);
      out_.motion.places.push_back(std::move(places));
    }
    return {};
  }

  [[nodiscard]] Isometry3d place(const verify::BodyState& state, std::size_t part,
                                 std::size_t face) const {
    const std::size_t panel = card_.panel_of(part, face);
    return state[card_.body[panel]] * card_.in_body[panel];
  }

  /// Tabs lie on the side of a panel on which their own part stands. Two faces in one plane could
  /// not be drawn apart.
  void find_beds(const verify::BodyState& state) {
    constexpr double kAbove_mm = 0.2;
    for (const CardJoint& joint : model_.joints) {
      if (joint.kind != JointKind::Glue) continue;
      const Isometry3d under = place(state, joint.b.part, joint.b.face);
      const verify::FoldModel& flat = model_.parts[joint.a.part].sheet;
      double above = 0.0;
      for (const verify::Hinge& hinge : card_.sheets[joint.a.part].hinges) {
        if (hinge.left != joint.a.face && hinge.right != joint.a.face) continue;
        const std::uint32_t beside = hinge.left == joint.a.face ? hinge.right : hinge.left;
        const Isometry3d lay = place(state, joint.a.part, beside);
        for (const std::uint32_t v : verify::face_of(flat, beside))
          above += dot(Vec3(under.linear().col(2)),
                       Vec3(lay * verify::lifted(flat.flat[v]) - under.translation()));
      }
      beds_[{joint.a.part, joint.a.face}] = {joint.b.part, joint.b.face,
                                             above < 0.0 ? -kAbove_mm : kAbove_mm};
    }
  }

  /// The page that most tabs are glued on.
  void find_ground() {
    const verify::BodyHinge& spine = card_.hinges[card_.drive];
    std::size_t right = 0, left = 0;
    for (const CardJoint& joint : model_.joints) {
      if (joint.kind != JointKind::Glue || joint.b.part != 0) continue;
      const std::uint32_t body = card_.body[card_.panel_of(0, joint.b.face)];
      right += body == spine.right ? 1 : 0, left += body == spine.left ? 1 : 0;
    }
    stands_on_ = left > right ? Ground::Left : Ground::Right;
  }

  /// The axes without the choice of a front: `toward` is along the spine, or away from it on the
  /// level page.
  [[nodiscard]] Axes plain_axes(const verify::BodyState& state) const {
    const verify::BodyHinge& spine = card_.hinges[card_.drive];
    const Vec3 along = state[spine.right].linear() * spine.right_along;
    Axes axes;
    axes.origin = state[spine.right] * spine.right_at;
    if (stands_on_ == Ground::Both) {
      const Vec3 up = place(state, 0, 0).linear().col(2) +
                      place(state, 0, model_.parts.front().sheet.faces() - 1).linear().col(2);
      axes.up = unit(Vec3(up - dot(up, along) * along));
      axes.toward = along;
    } else {
      const bool is_left = stands_on_ == Ground::Left;
      axes.toward = is_left ? Vec3(state[spine.left].linear() * spine.left_beside)
                            : Vec3(-(state[spine.right].linear() * spine.right_beside));
      axes.toward = unit(Vec3(axes.toward - dot(axes.toward, along) * along));
      axes.up = unit(Vec3(cross(axes.toward, along)));
      const std::size_t last = model_.parts.front().sheet.faces() - 1;
      for (const std::size_t f : {std::size_t{0}, last})
        if (card_.body[card_.panel_of(0, f)] == (is_left ? spine.left : spine.right) &&
            dot(Vec3(place(state, 0, f).linear().col(2)), axes.up) < 0.0)
          axes.up = -axes.up;
    }
    axes.right = cross(axes.up, axes.toward);
    return axes;
  }

  /// What stands on the pages shows its printed side to the front.
  void find_front(const verify::BodyState& open) {
    if (stands_on_ != Ground::Both) return;
    const Axes axes = plain_axes(open);
    Vec3 sum{0.0, 0.0, 0.0};
    for (std::size_t p = 1; p < model_.parts.size(); ++p)
      for (std::size_t f = 0; f < model_.parts[p].sheet.faces(); ++f)
        sum += verify::area(model_.parts[p].sheet, f) * Vec3(place(open, p, f).linear().col(2));
    turn_ = dot(sum, axes.toward) < 0.0 ? -1.0 : 1.0;
  }

  [[nodiscard]] Axes axes_of(const verify::BodyState& state) const {
    Axes axes = plain_axes(state);
    axes.toward *= turn_, axes.right *= turn_;
    return axes;
  }

  enum class Ground : std::uint8_t { Both, Right, Left };

  verify::JointModel model_;
  verify::Assembled card_;
  std::vector<Corner> corners_;                                 ///< one a vertex of the pattern
  std::map<std::pair<std::size_t, std::size_t>, TabBed> beds_;  ///< by part and face of the tab
  double u_{}, v_{}, row_{};                                    ///< where the next sheet lies
  Ground stands_on_{Ground::Both};
  double turn_{1.0};
  PartsMotion out_;
};

}  // namespace
}  // namespace parts_motion_parts

Result<PartsMotion> parts_motion(std::string_view fold_text, const Progress& progress) {
  auto model = verify::read_joint_model(fold_text);
  if (!model) return tl::unexpected(model.error());
  return parts_motion_parts::MovingCard(std::move(*model)).run(progress);
}

}  // namespace popcut::judge
