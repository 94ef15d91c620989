// SPDX-License-Identifier: MIT
#include "core/verify/parts/paper_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/angle.hpp"

namespace popcut::verify {
namespace {

constexpr double kSlack_mm = 1e-4;
constexpr double kSlack_mm2 = 1e-3;

/// Triangles of one face or panel in the plane of another sheet, counter-clockwise.
using Shapes = std::vector<std::array<Vec2, 3>>;

double area_of(const Shapes& shapes) {
  double sum = 0.0;
  for (const auto& t : shapes) sum += 0.5 * cross(Vec2(t[1] - t[0]), Vec2(t[2] - t[0]));
  return sum;
}

double shared_area(const Shapes& a, const Shapes& b) {
  double sum = 0.0;
  for (const auto& s : a)
    for (const auto& t : b) sum += common_area(s, t);
  return sum;
}

void add_face(const FoldModel& sheet, const Triangles& triangles, std::size_t face,
              const Eigen::Isometry3d& lay, Shapes& out) {
  for (std::uint32_t t = triangles.first[face]; t < triangles.first[face + 1]; ++t) {
    std::array<Vec2, 3> shape;
    for (std::size_t k = 0; k < 3; ++k)
      shape[k] = Vec3(lay * lifted(sheet.flat[triangles.corners[t][k]])).head<2>();
    if (cross(Vec2(shape[1] - shape[0]), Vec2(shape[2] - shape[0])) < 0.0)
      std::swap(shape[1], shape[2]);
    out.push_back(shape);
  }
}

struct Span {
  double from{}, to{};
};

/// Where the line from a to b, as mm from a on, has paper of a panel.
std::vector<Span> paper_on_line(const FoldModel& sheet, const Sheet& faces, std::size_t panel,
                                const std::array<Vec2, 2>& line) {
  const Vec2 along = unit(Vec2(line[1] - line[0])), across{-along.y(), along.x()};
  std::vector<Span> out;
  for (std::size_t f = 0; f < sheet.faces(); ++f) {
    if (faces.panel_of_face[f] != panel) continue;
    const auto corners = face_of(sheet, f);
    std::vector<double> at;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Vec2 p = sheet.flat[corners[k]] - line[0],
                 q = sheet.flat[corners[(k + 1) % corners.size()]] - line[0];
      const double a = dot(p, across), b = dot(q, across);
      if ((a > 0.0) == (b > 0.0)) continue;
      at.push_back(dot(p, along) + a / (a - b) * (dot(q, along) - dot(p, along)));
    }
    std::sort(at.begin(), at.end());
    for (std::size_t k = 0; k + 1 < at.size(); k += 2) out.push_back({at[k], at[k + 1]});
  }
  return out;
}

/// Folds of a part along the line of a slit: where it is not cut.
std::vector<Span> folds_on_line(const FoldModel& sheet, const Sheet& faces,
                                const std::array<Vec2, 2>& line) {
  const Vec2 along = unit(Vec2(line[1] - line[0])), across{-along.y(), along.x()};
  std::vector<Span> out;
  for (const Hinge& hinge : faces.hinges) {
    const Vec2 p = sheet.flat[hinge.from] - line[0], q = sheet.flat[hinge.to] - line[0];
    if (std::abs(dot(p, across)) > kSlack_mm || std::abs(dot(q, across)) > kSlack_mm) continue;
    const auto [from, to] = std::minmax({dot(p, along), dot(q, along)});
    out.push_back({from, to});
  }
  return out;
}

double shared_length(const std::vector<Span>& a, const std::vector<Span>& b) {
  double most = 0.0;
  for (const Span& s : a)
    for (const Span& t : b) most = std::max(most, std::min(s.to, t.to) - std::max(s.from, t.from));
  return most;
}

/// Whether a tab lies on the face of the panel that it is glued to, not on its back: there is what
/// the tab is folded from.
bool lies_on_face(const JointModel& model, const Assembled& card, const CardJoint& joint,
                  const BodyState& opened) {
  const auto lay = [&](std::size_t part, std::size_t face) {
    const std::size_t panel = card.panel_of(part, face);
    return Eigen::Isometry3d(opened[card.body[panel]] * card.in_body[panel]);
  };
  const Eigen::Isometry3d under = lay(joint.b.part, joint.b.face);
  const Vec3 normal = under.linear() * Vec3(0.0, 0.0, 1.0);
  const FoldModel& sheet = model.parts[joint.a.part].sheet;
  double above = 0.0;
  for (const Hinge& hinge : card.sheets[joint.a.part].hinges)
    for (const auto& [tab, face] :
         {std::pair(hinge.left, hinge.right), std::pair(hinge.right, hinge.left)}) {
      if (tab != joint.a.face) continue;
      const Eigen::Isometry3d beside = lay(joint.a.part, face);
      for (const std::uint32_t v : face_of(sheet, face))
        above += dot(normal, Vec3(beside * lifted(sheet.flat[v]) - under.translation()));
    }
  return above > 0.0;
}

/// What holds two faces that cross: on their line each has paper, and beside it room for the
/// other's paper when the card is open.
void check_crossing(const JointModel& model, const Assembled& card, const CardJoint& joint,
                    const std::vector<Span>& on_a, const std::vector<Span>& on_b,
                    const Followed& motion, VerifyCheck& check) {
  const std::vector<Span> whole{{0.0, norm(Vec2(joint.a.line[1] - joint.a.line[0]))}};
  for (const auto& [side, own] : {std::pair(&joint.a, &on_a), std::pair(&joint.b, &on_b)})
    if (shared_length(*own, whole) <= kSlack_mm)
      check.fail(joint.place,
                 fmt::format("{:?} has no paper on the line in which both faces cross, "
                             "so nothing holds it there",
                             model.parts[side->part].name));
  if (motion.states.empty()) return;
  const auto normal = [&](const JointSide& side) {
    const std::size_t panel = card.panel_of(side.part, side.face);
    return Vec3((motion.states.back()[card.body[panel]] * card.in_body[panel]).linear().col(2));
  };
  constexpr double kLeastSine = 0.05, kRounding = 1.0 - 1e-6;
  const double sine = norm(cross(normal(joint.a), normal(joint.b)));
  if (sine < kLeastSine) return;
  const double needs = model.thickness_mm / sine;
  for (const auto& [side, other] : {std::pair(&joint.a, &on_b), std::pair(&joint.b, &on_a)}) {
    const Vec2 along = unit(Vec2(side->line[1] - side->line[0])), across{-along.y(), along.x()};
    double tight = 0.0;
    for (const double by : {-0.5 * kRounding * needs, 0.5 * kRounding * needs}) {
      std::array<Vec2, 2> line = side->line;
      for (Vec2& p : line) p += by * across;
      std::vector<Span> held;  // of the other's paper, within the stretch of the joint
      for (const Span& s : *other)
        held.push_back({std::max(s.from, 0.0), std::min(s.to, whole.front().to)});
      tight = std::max(
          tight,
          shared_length(paper_on_line(model.parts[side->part].sheet, card.sheets[side->part],
                                      card.sheets[side->part].panel_of_face[side->face], line),
                        held));
    }
    if (tight > kSlack_mm)
      check.fail(
          joint.place,
          fmt::format("the slot of {:?} is narrower than {:.3g} mm over {:.3g} mm, and paper "
                      "of {:g} mm does not go through it on open pages",
                      model.parts[side->part].name, needs, tight, model.thickness_mm));
  }
}

}  // namespace

void check_tabs(const JointModel& model, const Assembled& card,
                const std::vector<Triangles>& triangles, const BodyState* opened,
                VerifyCheck& check) {
  struct Tab {
    std::size_t joint{}, panel{};
    bool is_on_face{};
    Shapes shape;
  };
  std::vector<Tab> tabs;
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const CardJoint& joint = model.joints[j];
    if (joint.kind != JointKind::Glue) continue;
    const CardPart &a = model.parts[joint.a.part], &b = model.parts[joint.b.part];
    Shapes tab, paper;
    add_face(a.sheet, triangles[joint.a.part], joint.a.face,
             laid_on(joint.a.line, joint.b.line, joint.turned), tab);
    const std::size_t panel = card.sheets[joint.b.part].panel_of_face[joint.b.face];
    for (std::size_t f = 0; f < b.sheet.faces(); ++f)
      if (card.sheets[joint.b.part].panel_of_face[f] == panel)
        add_face(b.sheet, triangles[joint.b.part], f, Eigen::Isometry3d::Identity(), paper);
    const double off = area_of(tab) - shared_area(tab, paper);
    if (off > kSlack_mm2)
      check.fail(joint.place,
                 fmt::format("{:.3g} mm2 of the tab of {:?} are not on paper of the panel of {:?} "
                             "that it is glued to",
                             off, a.name, b.name));
    const bool is_on_face = opened != nullptr && lies_on_face(model, card, joint, *opened);
    for (const Tab& other : tabs) {
      if (opened == nullptr || other.panel != card.first_panel[joint.b.part] + panel ||
          other.is_on_face != is_on_face)
        continue;
      if (const double both = shared_area(tab, other.shape); both > kSlack_mm2)
        check.fail(joint.place, fmt::format("the tab lies on that of {} by {:.3g} mm2",
                                            model.joints[other.joint].place, both));
    }
    tabs.push_back({j, card.first_panel[joint.b.part] + panel, is_on_face, std::move(tab)});
  }
  check.detail = fmt::format("{} tab{} on paper", tabs.size(), tabs.size() == 1 ? "" : "s");
}

void check_slots(const JointModel& model, const Assembled& card, const Followed& motion,
                 VerifyCheck& check) {
  std::size_t slots = 0, crossings = 0;
  for (const BodySlot& slot : card.slots) {
    const CardJoint& joint = model.joints[slot.joint];
    const FoldModel& slit = model.parts[joint.a.part].sheet;
    const FoldModel& sliding = model.parts[joint.b.part].sheet;
    const std::size_t panel = card.sheets[joint.b.part].panel_of_face[joint.b.face];
    const Eigen::Isometry3d& in_body = card.in_body[card.first_panel[joint.b.part] + panel];
    const std::vector<Span> whole = folds_on_line(slit, card.sheets[joint.a.part], joint.a.line);
    const std::vector<Span> cut{{0.0, norm(Vec2(joint.a.line[1] - joint.a.line[0]))}};
    ++slots;
    if (shared_length(whole, cut) > kSlack_mm)
      check.fail(joint.place, "a fold runs along the slit; it must be cut");
    for (std::size_t k = 0; k < motion.states.size(); ++k) {
      const Eigen::Isometry3d back = (motion.states[k][slot.slides] * in_body).inverse();
      std::array<Vec2, 2> line;
      for (std::size_t e = 0; e < 2; ++e)
        line[e] = Vec3(back * (motion.states[k][slot.slit] * slot.at[e])).head<2>();
      const std::vector<Span> paper =
          paper_on_line(sliding, card.sheets[joint.b.part], panel, line);
      const std::string at = fmt::format("{:.1f} degrees", degrees(motion.opening_rad[k]));
      if (shared_length(paper, cut) <= kSlack_mm) {
        check.fail(joint.place, fmt::format("at {} nothing of {:?} is in the slit", at,
                                            model.parts[joint.b.part].name));
        break;
      }
      if (const double hit = shared_length(paper, whole); hit > kSlack_mm) {
        check.fail(joint.place, fmt::format("at {} {:?} is {:.3g} mm wider than the slit", at,
                                            model.parts[joint.b.part].name, hit));
        break;
      }
    }
  }
  for (const CardJoint& joint : model.joints) {
    if (joint.kind != JointKind::Cross) continue;
    ++crossings;
    const auto paper = [&](const JointSide& side) {
      return paper_on_line(model.parts[side.part].sheet, card.sheets[side.part],
                           card.sheets[side.part].panel_of_face[side.face], side.line);
    };
    const std::vector<Span> on_a = paper(joint.a), on_b = paper(joint.b);
    if (const double both = shared_length(on_a, on_b); both > kSlack_mm)
      check.fail(joint.place, fmt::format("both faces have paper on {:.3g} mm of the line in which "
                                          "they cross; cut one of them there",
                                          both));
    check_crossing(model, card, joint, on_a, on_b, motion, check);
  }
  check.detail = fmt::format("{} slots that slide, {} that cross", slots, crossings);
}

}  // namespace popcut::verify
