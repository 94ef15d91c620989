// SPDX-License-Identifier: MIT
#include "core/verify/parts/followed.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Sparse>

#include "core/geometry/angle.hpp"
#include "core/verify/motion/mobility.hpp"

namespace popcut::verify {
namespace {

using Eigen::Isometry3d;
using Eigen::VectorXd;
using Sparse = Eigen::SparseMatrix<double>;
using Entry = Eigen::Triplet<double>;

constexpr std::size_t kMostIterations = 60;
constexpr double kClosed = 1e-11;          ///< of the size: gaps that count as closed
constexpr double kExact = 1e-14;           ///< of the size: gaps of rounding alone
constexpr double kMostTurn_rad = 0.35;     ///< of a body, away from where it was expected
constexpr double kLongestStep_rad = 0.03;  ///< of the opening
constexpr int kMostHalvings = 9;
constexpr double kNoPlay = 0.02;  ///< of the play along the sheet, in directions that have none

/// The equations of all joints in a state, and how they change with the twists of the bodies: for
/// each body but the held one, its angular velocity times the card's size, and the velocity of its
/// middle.
class JointEquations {
 public:
  JointEquations(const Assembled& card, const BodyState& state, bool also_held)
      : card_(card), state_(state), size_(card.reach_mm) {
    for (std::size_t b = 0; b < card.bodies; ++b) middle_.push_back(state[b] * card.middle[b]);
    held_ = card.hinges[card.drive].right;
    also_ = also_held ? card.hinges[card.drive].left : held_;
    for (const BodyHinge& hinge : card.hinges) add(hinge);
    for (const BodySlot& slot : card.slots) add(slot);
  }

  /// One more equation: the opening.
  void drive(double opening_rad) {
    const BodyHinge& hinge = card_.hinges[card_.drive];
    const Vec3 axis = state_[hinge.right].linear() * hinge.right_along;
    double off = opening_of(card_, state_) - opening_rad;
    off -= 2.0 * std::numbers::pi * std::round(off / (2.0 * std::numbers::pi));
    // Left turns by the fold angle about the axis; the opening is pi less that.
    const int row = next(1, size_ * off, 1.0);
    turn(row, hinge.left, -axis, 1.0);
    turn(row, hinge.right, axis, 1.0);
  }

  [[nodiscard]] int unknowns() const {
    return 6 * (static_cast<int>(card_.bodies) - (also_ == held_ ? 1 : 2));
  }
  [[nodiscard]] int column(std::uint32_t body) const {
    if (body == held_ || body == also_) return -1;
    int c = static_cast<int>(body);
    c -= body > held_ ? 1 : 0;
    c -= also_ != held_ && body > also_ ? 1 : 0;
    return 6 * c;
  }
  [[nodiscard]] Sparse jacobian() const {
    Sparse out(rows_, unknowns());
    out.setFromTriplets(entries_.begin(), entries_.end());
    return out;
  }
  [[nodiscard]] Mobility free_speeds() const {
    constexpr double kNoise = 1e-11;
    std::vector<SpeedInEquation> all;
    all.reserve(entries_.size());
    for (const Entry& one : entries_) all.push_back({one.row(), one.col(), one.value()});
    return verify::free_speeds(all, rows_, unknowns(), kNoise);
  }
  [[nodiscard]] VectorXd residual() const {
    return Eigen::Map<const VectorXd>(residual_.data(), rows_);
  }
  /// One a row: 1 over what paper leaves it, in mm.
  [[nodiscard]] VectorXd weight() const {
    return Eigen::Map<const VectorXd>(weight_.data(), rows_);
  }
  [[nodiscard]] double size_mm() const { return size_; }

 private:
  int next(int count, double value, double weight) {
    const int row = rows_;
    rows_ += count;
    residual_.resize(static_cast<std::size_t>(rows_), value);
    weight_.resize(static_cast<std::size_t>(rows_), weight);
    return row;
  }
  void put(int row, std::uint32_t body, int k, double value) {
    if (const int c = column(body); c >= 0 && value != 0.0)
      entries_.emplace_back(row, c + k, value);
  }
  /// Row: `factor` times the change of `along . p` for a point p of a body.
  void move(int row, std::uint32_t body, const Vec3& along, const Vec3& p, double factor) {
    const Vec3 moment = cross(Vec3(p - middle_[body]), along);
    for (int k = 0; k < 3; ++k) {
      put(row, body, k, factor * moment[k] / size_);
      put(row, body, 3 + k, factor * along[k]);
    }
  }
  /// Row: `factor` times the size times the turn about `axis`.
  void turn(int row, std::uint32_t body, const Vec3& axis, double factor) {
    for (int k = 0; k < 3; ++k) put(row, body, k, factor * axis[k]);
  }

  void add(const BodyHinge& hinge) {
    const Vec3 a = state_[hinge.right] * hinge.right_at, b = state_[hinge.left] * hinge.left_at;
    const Vec3 da = state_[hinge.right].linear() * hinge.right_along,
               db = state_[hinge.left].linear() * hinge.left_along;
    // A fold that is off its line by d leaves a gap of d (left - right), the directions beside it
    // in both panels: none while it is flat. In other directions a hinge has no play.
    const Vec3 off = state_[hinge.left].linear() * hinge.left_beside -
                     state_[hinge.right].linear() * hinge.right_beside;
    const double wide = norm(off);
    const Vec3 plays = wide > kNoPlay ? Vec3(off / wide) : Vec3(da.unitOrthogonal());
    for (const Vec3& e : {plays, da, cross(plays, da)}) {
      const bool is_free = dot(e, plays) > 0.5;
      const double share = is_free ? std::max(kNoPlay, wide) : kNoPlay;
      const int row = next(1, dot(e, Vec3(a - b)), 1.0 / (kLinePlay_mm * share));
      move(row, hinge.right, e, a, 1.0);
      move(row, hinge.left, e, b, -1.0);
      const int also = next(1, size_ * dot(e, Vec3(da - db)),
                            0.5 * hinge.length_mm / (kEndPlay_mm * share * size_));
      turn(also, hinge.right, cross(da, e), 1.0);
      turn(also, hinge.left, cross(db, e), -1.0);
    }
  }

  void add(const BodySlot& slot) {
    const Vec3 normal = state_[slot.slides].linear() * slot.normal,
               origin = state_[slot.slides] * slot.origin;
    for (const Vec3& at : slot.at) {
      const Vec3 p = state_[slot.slit] * at;
      const int row = next(1, dot(normal, Vec3(p - origin)), 1.0 / kLinePlay_mm);
      move(row, slot.slit, normal, p, 1.0);
      move(row, slot.slides, normal, p, -1.0);
    }
  }

  const Assembled& card_;
  const BodyState& state_;
  double size_;
  std::vector<Vec3> middle_;
  std::uint32_t held_{}, also_{};
  std::vector<Entry> entries_;
  std::vector<double> residual_, weight_;
  int rows_{};
};

Eigen::Matrix3d turned(const Vec3& by) {
  const double angle = norm(by);
  if (angle < 1e-300) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, by / angle).toRotationMatrix();
}

Vec3 turn_between(const Isometry3d& from, const Isometry3d& to) {
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(to.linear() * from.linear().transpose()));
  return turn.angle() * turn.axis();
}

/// Moves on by `by` steps past `to`, where the last one came from `from`.
BodyState further_on(const Assembled& card, const BodyState& from, const BodyState& to, double by) {
  BodyState out = to;
  for (std::size_t b = 0; b < to.size(); ++b) {
    const Vec3 was = from[b] * card.middle[b], is = to[b] * card.middle[b];
    out[b].linear() = turned(by * turn_between(from[b], to[b])) * to[b].linear();
    out[b].translation() = is + by * (is - was) - out[b].linear() * card.middle[b];
  }
  return out;
}

double most_turn(const BodyState& a, const BodyState& b) {
  double most = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, norm(turn_between(a[k], b[k])));
  return most;
}

/// Closes the joints of `state` at an opening. The largest gap that is left, mm.
double close(const Assembled& card, BodyState& state, double opening_rad) {
  double least = std::numeric_limits<double>::infinity();
  BodyState best = state;
  int worse = 0;
  for (std::size_t i = 0; i < kMostIterations; ++i) {
    JointEquations equations(card, state, false);
    equations.drive(opening_rad);
    const VectorXd off = equations.residual();
    const double gap = off.cwiseAbs().maxCoeff();
    worse = gap < 0.5 * least ? 0 : worse + 1;
    if (gap < least) least = gap, best = state;
    const bool is_closed = gap < kClosed * card.reach_mm;
    if (!(gap < 1e3 * card.reach_mm) || worse > 4 || gap < kExact * card.reach_mm ||
        (is_closed && worse > 0))
      break;
    const Sparse jacobian = equations.jacobian();
    Sparse normal = jacobian.transpose() * jacobian;
    Sparse one(normal.rows(), normal.cols());
    one.setIdentity();
    normal += 1e-13 * one;
    const Eigen::SimplicialLDLT<Sparse> factor(normal);
    if (factor.info() != Eigen::Success) break;
    const VectorXd step = factor.solve(VectorXd(-(jacobian.transpose() * off)));
    if (!step.allFinite()) break;
    for (std::uint32_t b = 0; b < card.bodies; ++b) {
      const int c = equations.column(b);
      if (c < 0) continue;
      const Vec3 at = state[b] * card.middle[b];
      state[b].linear() = turned(step.segment<3>(c) / card.reach_mm) * state[b].linear();
      state[b].linear() =
          Eigen::Quaterniond(Eigen::Matrix3d(state[b].linear())).normalized().toRotationMatrix();
      state[b].translation() = at + step.segment<3>(c + 3) - state[b].linear() * card.middle[b];
    }
  }
  state = best;
  return least;
}

/// The hinges of each body.
std::vector<std::vector<std::size_t>> hinges_of_bodies(const Assembled& card) {
  std::vector<std::vector<std::size_t>> out(card.bodies);
  for (std::size_t h = 0; h < card.hinges.size(); ++h)
    for (const std::uint32_t body : {card.hinges[h].right, card.hinges[h].left})
      out[body].push_back(h);
  return out;
}

/// The pose that the file's fold angles give.
BodyState first_state(const Assembled& card) {
  BodyState state(card.bodies, Isometry3d::Identity());
  std::vector<bool> placed(card.bodies, false);
  const auto beside = hinges_of_bodies(card);
  std::deque<std::uint32_t> open{card.hinges[card.drive].right};
  placed[open.front()] = true;
  for (; !open.empty(); open.pop_front())
    for (const std::size_t h : beside[open.front()]) {
      const BodyHinge& hinge = card.hinges[h];
      const bool is_right = hinge.right == open.front();
      const std::uint32_t to = is_right ? hinge.left : hinge.right;
      if (placed[to]) continue;
      placed[to] = true;
      state[to] = state[open.front()] *
                  (is_right ? hinge.left_to_right : Isometry3d(hinge.left_to_right.inverse()));
      open.push_back(to);
    }
  return state;
}

/// Continues a motion from one state towards the openings of `goals`, in their order.
class Follower {
 public:
  Follower(const Assembled& card, const BodyState& start, double opening_rad, Followed& out)
      : card_(card), before_(start), at_(start), opening_(opening_rad), out_(out) {}

  std::string run(const std::vector<double>& goals) {
    for (const double goal : goals) {
      if (!go(goal))
        return fmt::format("it stops at {:.1f} degrees: the panels cannot move on",
                           degrees(opening_));
      out_.opening_rad.push_back(goal);
      out_.states.push_back(at_);
    }
    return {};
  }

 private:
  bool go(double goal) {
    double step =
        std::copysign(std::min(kLongestStep_rad, std::abs(goal - opening_)), goal - opening_);
    int halvings = 0;
    while (opening_ != goal) {
      const double next = std::abs(goal - opening_) <= std::abs(step) ? goal : opening_ + step;
      const double by = last_step_ == 0.0 ? 0.0 : (next - opening_) / last_step_;
      const BodyState expected = further_on(card_, before_, at_, by);
      BodyState state = expected;
      const double gap = close(card_, state, next);
      if (gap > kClosed * card_.reach_mm * 10.0 || most_turn(expected, state) > kMostTurn_rad) {
        if (++halvings > kMostHalvings) return false;
        step *= 0.5;
        continue;
      }
      out_.gap_mm = std::max(out_.gap_mm, gap);
      last_step_ = next - opening_;
      before_ = std::exchange(at_, std::move(state));
      opening_ = next;
    }
    return true;
  }

  const Assembled& card_;
  BodyState before_, at_;
  double opening_, last_step_{0.0};
  Followed& out_;
};

}  // namespace

double opening_of(const Assembled& card, const BodyState& state) {
  const BodyHinge& hinge = card.hinges[card.drive];
  // By how much left is turned past its flat place, about the line.
  const Eigen::Matrix3d flat =
      hinge.left_to_right.linear() *
      Eigen::AngleAxisd(-hinge.angle_rad, hinge.left_along).toRotationMatrix();
  const Eigen::Matrix3d turn =
      state[hinge.right].linear().transpose() * state[hinge.left].linear() * flat.transpose();
  const Vec3 axis = hinge.right_along;
  const Vec3 side = axis.unitOrthogonal(), moved = turn * side;
  return std::numbers::pi - std::atan2(dot(axis, cross(side, moved)), dot(side, moved));
}

std::vector<std::uint32_t> loose_bodies(const Assembled& card) {
  const auto beside = hinges_of_bodies(card);
  std::vector<bool> seen(card.bodies, false);
  std::vector<std::uint32_t> open{card.hinges[card.drive].right};
  seen[open.front()] = true;
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    for (const std::size_t h : beside[at])
      for (const std::uint32_t to : {card.hinges[h].right, card.hinges[h].left})
        if (!seen[to]) seen[to] = true, open.push_back(to);
  }
  std::vector<std::uint32_t> out;
  for (std::uint32_t b = 0; b < card.bodies; ++b)
    if (!seen[b]) out.push_back(b);
  return out;
}

Result<Assembled> whole_card(const JointModel& model, std::string_view therefore) {
  std::vector<Sheet> sheets;
  VerifyCheck check;
  for (const CardPart& part : model.parts) sheets.push_back(make_sheet(part.sheet, check));
  auto card = assemble(model, std::move(sheets), check);
  if (card && (check.failed > 0 || !loose_bodies(*card).empty()))
    return fail(ErrorKind::Infeasible, "/popcut:joints",
                fmt::format("do not hold all parts together{}; 'popcut verify' says what is wrong",
                            therefore));
  return card;
}

Followed follow(const Assembled& card, const std::vector<double>& opening_rad) {
  Followed out;
  BodyState start = first_state(card);
  const double opening = opening_of(card, start);
  out.first_gap_mm = JointEquations(card, start, false).residual().cwiseAbs().maxCoeff();
  if (!(opening > 0.0 && opening < std::numbers::pi)) {
    out.shut_stopped = out.open_stopped =
        "the file's pose is flat or shut; give the fold angles of a card that is half open";
    return out;
  }
  const double gap = close(card, start, opening);
  if (gap > 10.0 * kClosed * card.reach_mm) {
    out.shut_stopped = out.open_stopped = fmt::format(
        "the joints do not close in the file's pose, at {:.1f} degrees: {:.3g} mm are left",
        degrees(opening), gap);
    return out;
  }
  out.gap_mm = gap;
  std::vector<double> down, up;
  for (const double goal : opening_rad) (goal < opening ? down : up).push_back(goal);
  std::reverse(down.begin(), down.end());
  out.shut_stopped = Follower(card, start, opening, out).run(down);
  std::reverse(out.opening_rad.begin(), out.opening_rad.end());
  std::reverse(out.states.begin(), out.states.end());
  out.open_stopped = Follower(card, start, opening, out).run(up);
  return out;
}

JointRank rank_of(const Assembled& card, const BodyState& state) {
  const JointEquations equations(card, state, false);
  const Mobility free = equations.free_speeds();
  return {free.degrees_of_freedom, free.largest_zero, free.smallest_nonzero,
          free.counted && free.clear};
}

std::vector<double> play_mm(const Assembled& card, const BodyState& state,
                            const std::vector<std::vector<Vec3>>& points) {
  const JointEquations equations(card, state, true);
  const VectorXd weight = equations.weight();
  Sparse weighted = equations.jacobian();
  for (int column = 0; column < weighted.outerSize(); ++column)
    for (Sparse::InnerIterator at(weighted, column); at; ++at) at.valueRef() *= weight[at.row()];
  const Sparse normal = weighted.transpose() * weighted;
  const Eigen::SimplicialLDLT<Sparse> factor(normal);
  if (factor.info() != Eigen::Success) return {};
  const VectorXd pivots = factor.vectorD();
  if (!(pivots.minCoeff() > 1e-12 * pivots.maxCoeff())) return {};
  std::vector<double> out(card.bodies, 0.0);
  for (std::uint32_t b = 0; b < card.bodies; ++b) {
    const int c = equations.column(b);
    if (c < 0) continue;
    Eigen::Matrix<double, 6, 6> spread;  // of the body's own twist
    for (int k = 0; k < 6; ++k) {
      VectorXd one = VectorXd::Zero(normal.cols());
      one[c + k] = 1.0;
      spread.col(k) = factor.solve(one).segment<6>(c);
    }
    for (const Vec3& point : points[b]) {
      // A point moves by its body's velocity and by the turn times its lever.
      const Vec3 lever = state[b].linear() * (point - card.middle[b]) / equations.size_mm();
      Eigen::Matrix<double, 3, 6> moves;
      for (int k = 0; k < 3; ++k) moves.col(k) = cross(Vec3(Vec3::Unit(k)), lever);
      moves.rightCols<3>().setIdentity();
      const double variance = (moves * spread * moves.transpose()).trace();
      out[b] = std::max(out[b], std::sqrt(std::max(0.0, variance)));
    }
  }
  return out;
}

}  // namespace popcut::verify
