// SPDX-License-Identifier: MIT
#include "core/verify/parts/assembled.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/geometry/disjoint_sets.hpp"

namespace popcut::verify {
namespace {

using Eigen::Isometry3d;

constexpr double kFits_mm = 1e-4;

/// The turn by an angle about a line of a flat sheet, as a valley fold turns what is left of it.
Isometry3d folded(Vec2 from, Vec2 to, double angle_rad) {
  const Vec3 at = lifted(from), along = unit(Vec3(lifted(to) - at));
  return Isometry3d(Eigen::Translation3d(at) * Eigen::AngleAxisd(angle_rad, along) *
                    Eigen::Translation3d(-at));
}

/// A way from one panel to another that is glued to it.
struct GluedTo {
  std::size_t panel{};
  Isometry3d lay;  ///< from the other's flat sheet to this one's
};

/// How far two motions move a panel's corners apart, at most.
double apart_mm(const Isometry3d& a, const Isometry3d& b, const std::array<Vec2, 2>& line,
                double reach_mm) {
  const Vec3 along = unit(Vec3(lifted(line[1]) - lifted(line[0])));
  double most = 0.0;
  for (const Vec3& p : {Vec3(lifted(line[0])), Vec3(lifted(line[1])),
                        Vec3(lifted(line[0]) + 0.1 * reach_mm * Vec3(-along.y(), along.x(), 0.0))})
    most = std::max(most, norm(Vec3(a * p - b * p)));
  return most;
}

class Assembler {
 public:
  Assembler(const JointModel& model, std::vector<Sheet> sheets, VerifyCheck& check)
      : model_(model), check_(check) {
    out_.sheets = std::move(sheets);
    std::size_t panels = 0;
    for (std::size_t p = 0; p < model.parts.size(); ++p) {
      out_.first_panel.push_back(panels);
      panels += out_.sheets[p].panels;
      Eigen::AlignedBox2d box;
      for (const Vec2& at : model.parts[p].sheet.flat) box.extend(at);
      out_.reach_mm = std::max(out_.reach_mm, box.diagonal().norm());
    }
    out_.body.assign(panels, kNone);
    out_.in_body.assign(panels, Isometry3d::Identity());
  }

  Result<Assembled> run() {
    glue();
    set_middles();
    for (std::size_t p = 0; p < model_.parts.size(); ++p) add_folds(p);
    if (out_.hinges.empty() || out_.hinges.front().part != 0)
      return fail(ErrorKind::OutOfRange, model_.parts.front().place,
                  "has no fold; the first part is the card, with the spine between its pages");
    double longest_mm = 0.0;
    for (std::size_t h = 0; h < out_.hinges.size() && out_.hinges[h].part == 0; ++h)
      if (out_.hinges[h].length_mm > longest_mm && is_of_pages(out_.hinges[h]))
        out_.drive = h, longest_mm = out_.hinges[h].length_mm;
    if (!(longest_mm > 0.0))
      return fail(ErrorKind::OutOfRange, "/popcut:pages",
                  "names two faces without a fold between them; name those on both sides of the "
                  "spine");
    for (std::size_t j = 0; j < model_.joints.size(); ++j) add_joint(j);
    return std::move(out_);
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  /// Whether a fold of the first part can be the spine.
  [[nodiscard]] bool is_of_pages(const BodyHinge& fold) const {
    if (!model_.pages) return true;
    const auto [a, b] = *model_.pages;
    return std::minmax(fold.right, fold.left) ==
           std::minmax(out_.body[out_.panel_of(0, a)], out_.body[out_.panel_of(0, b)]);
  }

  /// Numbers the bodies; each has the frame of its first panel's sheet.
  void glue() {
    std::vector<std::vector<std::pair<std::size_t, GluedTo>>> beside(out_.body.size());
    for (std::size_t j = 0; j < model_.joints.size(); ++j) {
      const CardJoint& joint = model_.joints[j];
      if (joint.kind != JointKind::Glue) continue;
      const std::size_t a = out_.panel_of(joint.a.part, joint.a.face),
                        b = out_.panel_of(joint.b.part, joint.b.face);
      const Isometry3d a_to_b = laid_on(joint.a.line, joint.b.line, joint.turned);
      beside[b].emplace_back(j, GluedTo{a, a_to_b});
      beside[a].emplace_back(j, GluedTo{b, a_to_b.inverse()});
    }
    for (std::size_t first = 0; first < out_.body.size(); ++first) {
      if (out_.body[first] != kNone) continue;
      out_.body[first] = static_cast<std::uint32_t>(out_.bodies++);
      std::deque<std::size_t> open{first};
      for (; !open.empty(); open.pop_front())
        for (const auto& [j, to] : beside[open.front()]) {
          const Isometry3d lies = out_.in_body[open.front()] * to.lay;
          if (out_.body[to.panel] == kNone) {
            out_.body[to.panel] = out_.body[first];
            out_.in_body[to.panel] = lies;
            open.push_back(to.panel);
            continue;
          }
          const CardJoint& joint = model_.joints[j];
          const bool is_a = to.panel == out_.panel_of(joint.a.part, joint.a.face);
          const double off = apart_mm(lies, out_.in_body[to.panel],
                                      is_a ? joint.a.line : joint.b.line, out_.reach_mm);
          if (off > kFits_mm && open.front() < to.panel)
            check_.fail(joint.place, fmt::format("the faces are glued in other ways too, and are "
                                                 "{:.3g} mm off here",
                                                 off));
        }
    }
  }

  void set_middles() {
    std::vector<Eigen::AlignedBox3d> box(out_.bodies);
    for (std::size_t p = 0; p < model_.parts.size(); ++p) {
      const FoldModel& sheet = model_.parts[p].sheet;
      for (std::size_t f = 0; f < sheet.faces(); ++f) {
        const std::size_t panel = out_.panel_of(p, f);
        for (const std::uint32_t v : face_of(sheet, f))
          box[out_.body[panel]].extend(Vec3(out_.in_body[panel] * lifted(sheet.flat[v])));
      }
    }
    for (const auto& one : box) out_.middle.push_back(one.center());
  }

  /// @param lay  from the flat sheet of `left` to that of `right`, in the opened pose
  void add_hinge(std::size_t part, std::size_t right, std::size_t left,
                 const std::array<Vec2, 2>& right_line, const std::array<Vec2, 2>& left_line,
                 double angle_rad, const Isometry3d& lay, bool turned = false) {
    BodyHinge out;
    out.right = out_.body[right], out.left = out_.body[left];
    if (out.right == out.left) return;  // glue holds both
    const auto place = [&](std::size_t panel, const std::array<Vec2, 2>& line, Vec3& at,
                           Vec3& along) {
      const Vec3 a = out_.in_body[panel] * lifted(line[0]),
                 b = out_.in_body[panel] * lifted(line[1]);
      at = 0.5 * (a + b), along = unit(Vec3(b - a)), out.length_mm = norm(Vec3(b - a));
    };
    place(right, right_line, out.right_at, out.right_along);
    place(left, left_line, out.left_at, out.left_along);
    out.right_beside = cross(Vec3(out_.in_body[right].linear().col(2)), out.right_along);
    out.left_beside = cross(Vec3(out_.in_body[left].linear().col(2)), out.left_along);
    if (turned) out.left_beside = -out.left_beside;
    out.angle_rad = angle_rad;
    out.left_to_right = out_.in_body[right] * lay * out_.in_body[left].inverse();
    out.part = part;
    out_.hinges.push_back(out);
  }

  void add_folds(std::size_t p) {
    const FoldModel& sheet = model_.parts[p].sheet;
    for (const HingeLine& line : hinge_lines(sheet, out_.sheets[p])) {
      double angle = sheet.fold_angle_deg[out_.sheets[p].hinges[line.hinge].edge];
      angle = std::isfinite(angle) ? angle * std::numbers::pi / 180.0 : 0.0;
      add_hinge(p, out_.first_panel[p] + line.right, out_.first_panel[p] + line.left,
                {line.from, line.to}, {line.from, line.to}, angle,
                folded(line.from, line.to, angle));
    }
  }

  void add_joint(std::size_t j) {
    const CardJoint& joint = model_.joints[j];
    const std::size_t a = out_.panel_of(joint.a.part, joint.a.face),
                      b = out_.panel_of(joint.b.part, joint.b.face);
    if (joint.kind == JointKind::Hinge || joint.kind == JointKind::Cross) {
      const double angle = joint.angle_deg * std::numbers::pi / 180.0;
      add_hinge(joint.a.part, a, b, joint.a.line, joint.b.line, angle,
                folded(joint.a.line[0], joint.a.line[1], angle) *
                    laid_on(joint.b.line, joint.a.line, joint.turned),
                joint.turned);
    } else if (joint.kind == JointKind::Slot) {
      BodySlot slot;
      slot.slit = out_.body[a], slot.slides = out_.body[b], slot.joint = j;
      for (std::size_t k = 0; k < 2; ++k) slot.at[k] = out_.in_body[a] * lifted(joint.a.line[k]);
      slot.origin = out_.in_body[b].translation();
      slot.normal = out_.in_body[b].linear() * Vec3(0.0, 0.0, 1.0);
      out_.slots.push_back(slot);
    }
  }

  const JointModel& model_;
  VerifyCheck& check_;
  Assembled out_;
};

}  // namespace

Isometry3d laid_on(const std::array<Vec2, 2>& from, const std::array<Vec2, 2>& to, bool turned) {
  const auto frame = [](const std::array<Vec2, 2>& line, double up) {
    Isometry3d out = Isometry3d::Identity();
    const Vec3 along = unit(Vec3(lifted(line[1]) - lifted(line[0]))), normal{0.0, 0.0, up};
    out.linear().col(0) = along;
    out.linear().col(1) = cross(normal, along);
    out.linear().col(2) = normal;
    out.translation() = lifted(line[0]);
    return out;
  };
  return frame(to, turned ? -1.0 : 1.0) * frame(from, 1.0).inverse();
}

Result<Assembled> assemble(const JointModel& model, std::vector<Sheet> sheets, VerifyCheck& check) {
  return Assembler(model, std::move(sheets), check).run();
}

}  // namespace popcut::verify
