// SPDX-License-Identifier: MIT
#include "core/verify/motion/rigid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/geometry/buckets.hpp"

namespace popcut::verify {
namespace {

using Vector = Eigen::VectorXd;

constexpr int kRowsOfLine = 6;
constexpr double kLargestTurn_rad = 0.5;  ///< limit per panel and step

Vec3 turned(const PanelMotion& motion, Vec2 way) {
  return way.x() * motion.along_u + way.y() * motion.along_v;
}

Vec2 middle_of(const HingeLine& line) { return 0.5 * (line.from + line.to); }

Vec2 direction_of(const HingeLine& line) {
  const Vec2 way = line.to - line.from;
  return (1.0 / norm(way)) * way;
}

/// `v` rotated about `axis`, whose length is the angle in radians.
Vec3 rotated(const Vec3& v, const Vec3& axis) {
  const double angle = norm(axis);
  if (angle < 1e-300) return v;
  const Vec3 k = (1.0 / angle) * axis;
  return std::cos(angle) * v + std::sin(angle) * cross(k, v) +
         (1.0 - std::cos(angle)) * dot(k, v) * k;
}

/// Makes the directions of a motion exactly orthonormal.
void straighten(PanelMotion& motion) {
  motion.along_u = unit(motion.along_u);
  motion.along_v = unit(motion.along_v - dot(motion.along_v, motion.along_u) * motion.along_u);
  motion.normal = cross(motion.along_u, motion.along_v);
}

/// Rotates a motion about its own image of `middle`, then translates it.
void apply(PanelMotion& motion, const Vec2& middle, const Vec3& turn, const Vec3& move) {
  const Vec3 at = motion(middle) + move;
  motion.along_u = rotated(motion.along_u, turn);
  motion.along_v = rotated(motion.along_v, turn);
  straighten(motion);
  motion.origin = at - turned(motion, middle);
}

double fold_angle_rad(const HingeLine& line, const RigidState& state) {
  const PanelMotion& left = state[line.left];
  const PanelMotion& right = state[line.right];
  const Vec3 axis = turned(left, direction_of(line));
  return std::atan2(dot(cross(right.normal, left.normal), axis), dot(left.normal, right.normal));
}

double gap_mm(const HingeLine& line, const RigidState& state) {
  return std::max(norm(state[line.left](line.from) - state[line.right](line.from)),
                  norm(state[line.left](line.to) - state[line.right](line.to)));
}

}  // namespace

RigidSheet rigid_sheet(const FoldModel& file, const Sheet& sheet, std::uint32_t held) {
  RigidSheet result;
  result.lines = hinge_lines(file, sheet);
  result.frames = panel_frames(result.lines, sheet.panels);
  const std::size_t panels = sheet.panels;
  const Buckets<std::uint32_t> beside(panels, [&](auto&& put) {
    for (std::uint32_t k = 0; k < result.lines.size(); ++k) {
      put(result.lines[k].left, k);
      put(result.lines[k].right, k);
    }
  });
  // Breadth first, so that few lines connect each panel to the held one.
  result.held.assign(panels, 0);
  result.hangs_on.assign(panels, -1);
  std::vector<std::uint8_t> seen(panels, 0);
  for (std::uint32_t root = 0; root <= panels; ++root) {
    const std::uint32_t from = root == 0 ? held : root - 1;
    if (panels == 0 || seen[from] != 0) continue;
    result.held[from] = seen[from] = 1;
    std::size_t at = result.order.size();
    result.order.push_back(from);
    for (; at < result.order.size(); ++at) {
      const std::uint32_t p = result.order[at];
      for (const std::uint32_t k : beside[p]) {
        const HingeLine& line = result.lines[k];
        const std::uint32_t q = line.left == p ? line.right : line.left;
        if (seen[q] != 0) continue;
        seen[q] = 1;
        result.hangs_on[q] = static_cast<std::int32_t>(k);
        result.order.push_back(q);
      }
    }
  }
  for (const HingeLine& line : result.lines) {
    for (const Vec2& p : {line.from, line.to})
      result.reach_mm = std::max(result.reach_mm, norm(p - result.lines.front().from));
  }
  return result;
}

RigidState state_from_tree(const RigidSheet& sheet, std::span<const double> angle_rad,
                           const PanelMotion& held) {
  RigidState state(sheet.frames.size());
  for (const std::uint32_t p : sheet.order) {
    if (sheet.hangs_on[p] < 0) {
      state[p] = held;
      continue;
    }
    const auto k = static_cast<std::size_t>(sheet.hangs_on[p]);
    const HingeLine& line = sheet.lines[k];
    const bool is_left = line.left == p;
    const PanelMotion& base = state[is_left ? line.right : line.left];
    // The left panel turns by +angle about the line relative to the right one.
    const Vec3 axis = (is_left ? angle_rad[k] : -angle_rad[k]) * turned(base, direction_of(line));
    const Vec2 pivot = middle_of(line);
    PanelMotion motion = base;
    apply(motion, pivot, axis, {});
    state[p] = motion;
  }
  return state;
}

std::vector<double> fold_angles_rad(const RigidSheet& sheet, const RigidState& state) {
  std::vector<double> angles;
  angles.reserve(sheet.lines.size());
  for (const HingeLine& line : sheet.lines) angles.push_back(fold_angle_rad(line, state));
  return angles;
}

double largest_gap_mm(const RigidSheet& sheet, const RigidState& state) {
  double largest = 0.0;
  for (const HingeLine& line : sheet.lines) largest = std::max(largest, gap_mm(line, state));
  return largest;
}

RigidSolver::RigidSolver(const RigidSheet& sheet) : sheet_(sheet) {
  for (const std::uint8_t is_held : sheet.held) {
    column_.push_back(is_held != 0 ? -1 : columns_);
    columns_ += is_held != 0 ? 0 : 6;
  }
}

Vector RigidSolver::residual(const RigidState& state, std::span<const AngleGoal> goals) const {
  const auto lines = static_cast<Eigen::Index>(sheet_.lines.size());
  Vector off(kRowsOfLine * lines + static_cast<Eigen::Index>(goals.size()));
  Eigen::Index row = 0;
  for (const HingeLine& line : sheet_.lines) {
    const PanelMotion& left = state[line.left];
    const PanelMotion& right = state[line.right];
    const Vec3 apart = left(middle_of(line)) - right(middle_of(line));
    const Vec2 way = direction_of(line);
    const Vec3 askew = lever(line) * (turned(left, way) - turned(right, way));
    for (const double value : {apart.x(), apart.y(), apart.z(), askew.x(), askew.y(), askew.z()})
      off[row++] = value;
  }
  for (const AngleGoal& goal : goals) {
    const HingeLine& line = sheet_.lines[goal.line];
    off[row++] = goal.weight * lever(line) *
                 std::remainder(fold_angle_rad(line, state) - goal.angle_rad, 2 * std::numbers::pi);
  }
  return off;
}

RigidSolver::Sparse RigidSolver::jacobian(const RigidState& state,
                                          std::span<const AngleGoal> goals) const {
  std::vector<Eigen::Triplet<double>> entries;
  int row = 0;
  // The columns of a panel: its angular velocity times its size, then the velocity of its middle.
  const auto put_cross = [&](int r, int c, double scale, Vec3 v) {  // scale * (w x v)
    entries.emplace_back(r, c + 1, scale * v.z()), entries.emplace_back(r, c + 2, -scale * v.y());
    entries.emplace_back(r + 1, c, -scale * v.z()),
        entries.emplace_back(r + 1, c + 2, scale * v.x());
    entries.emplace_back(r + 2, c, scale * v.y()),
        entries.emplace_back(r + 2, c + 1, -scale * v.x());
  };
  for (const HingeLine& line : sheet_.lines) {
    for (const auto& [p, sign] : {std::pair(line.left, 1.0), std::pair(line.right, -1.0)}) {
      if (column_[p] < 0) continue;
      const double size = sheet_.frames[p].size_mm;
      put_cross(row, column_[p], sign / size,
                turned(state[p], middle_of(line) - sheet_.frames[p].middle));
      for (int k = 0; k < 3; ++k) entries.emplace_back(row + k, column_[p] + 3 + k, sign);
      put_cross(row + 3, column_[p], sign * lever(line) / size,
                turned(state[p], direction_of(line)));
    }
    row += kRowsOfLine;
  }
  for (const AngleGoal& goal : goals) {
    const HingeLine& line = sheet_.lines[goal.line];
    for (const auto& [p, sign] : {std::pair(line.left, 1.0), std::pair(line.right, -1.0)}) {
      if (column_[p] < 0) continue;
      const double scale = sign * goal.weight * lever(line) / sheet_.frames[p].size_mm;
      const Vec3 axis = scale * turned(state[line.left], direction_of(line));
      entries.emplace_back(row, column_[p], axis.x());
      entries.emplace_back(row, column_[p] + 1, axis.y());
      entries.emplace_back(row, column_[p] + 2, axis.z());
    }
    ++row;
  }
  Sparse result(row, columns_);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

bool RigidSolver::step(RigidState& state, std::span<const AngleGoal> goals, const Vector& off,
                       double shift) {
  const Sparse j = jacobian(state, goals);
  Sparse normal = j.transpose() * j;
  Sparse identity(columns_, columns_);
  identity.setIdentity();
  normal += shift * identity;
  if (!ordered_) factor_.analyzePattern(normal);
  ordered_ = true;
  factor_.factorize(normal);
  if (factor_.info() != Eigen::Success) return false;
  Vector move = factor_.solve(-(j.transpose() * off));
  if (!move.allFinite()) return false;
  const auto part = [&](int c) { return Vec3{move[c], move[c + 1], move[c + 2]}; };
  double largest_turn = 0.0;
  for (std::size_t p = 0; p < state.size(); ++p) {
    if (column_[p] >= 0)
      largest_turn = std::max(largest_turn, norm(part(column_[p])) / sheet_.frames[p].size_mm);
  }
  if (largest_turn > kLargestTurn_rad) move *= kLargestTurn_rad / largest_turn;
  for (std::size_t p = 0; p < state.size(); ++p) {
    if (column_[p] < 0) continue;
    const PanelFrame& frame = sheet_.frames[p];
    apply(state[p], frame.middle, (1.0 / frame.size_mm) * part(column_[p]), part(column_[p] + 3));
  }
  ++iterations_;
  return true;
}

RigidSolver::End RigidSolver::correct(RigidState& state, std::span<const AngleGoal> goals,
                                      std::size_t most, double shift) {
  End end;
  // Rounding of coordinates causes about this much in a row.
  const double closed = 2e-15 * sheet_.reach_mm;
  double before = 0.0;
  std::size_t idle = 0;
  RigidState best = state;
  double least = 0.0;
  for (std::size_t i = 0;; ++i) {
    const Vector off = residual(state, goals);
    const double size = off.norm();
    if (i == 0 || size < least) {
      least = size;
      best = state;
    }
    const double largest = off.size() == 0 ? 0.0 : off.lpNorm<Eigen::Infinity>();
    idle = i > 0 && !(size < 0.5 * before) ? idle + 1 : 0;
    before = size;
    end.iterations = i;
    if (largest <= closed || i == most || idle == 3) break;
    if (!std::isfinite(size) || columns_ == 0) break;
    if (!step(state, goals, off, shift)) break;
  }
  state = std::move(best);
  end.gap_mm = largest_gap_mm(sheet_, state);
  for (const AngleGoal& goal : goals) {
    if (goal.weight < 1.0) continue;
    const double angle = fold_angle_rad(sheet_.lines[goal.line], state);
    end.goal_off_rad = std::max(
        end.goal_off_rad, std::abs(std::remainder(angle - goal.angle_rad, 2 * std::numbers::pi)));
  }
  return end;
}

Pose pose_of(const FoldModel& file, const Sheet& sheet, const RigidState& state, double psi_rad,
             std::string_view how) {
  Pose pose;
  pose.place = fmt::format("{} to psi {:.4f}", how, psi_rad);
  pose.psi_rad = psi_rad;
  pose.opened = true;
  pose.at.resize(file.flat.size());
  for (std::size_t i = 0; i < file.flat.size(); ++i)
    pose.at[i] = {file.flat[i].x(), file.flat[i].y(), 0.0};
  for (std::size_t f = 0; f < file.faces(); ++f) {
    for (const std::uint32_t v : face_of(file, f))
      pose.at[v] = state[sheet.panel_of_face[f]](file.flat[v]);
  }
  return pose;
}

}  // namespace popcut::verify
