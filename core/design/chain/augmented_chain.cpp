// SPDX-License-Identifier: MIT
#include "core/design/chain/augmented_chain.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <nlopt.h>

#include "core/curvature/star.hpp"
#include "core/design/chain/chain.hpp"

namespace popcut {
namespace {

// A vertex and its eight neighbours: the centre, the ring, the diagonals between the ring's.
constexpr std::size_t kStencil = 9;
constexpr std::array<int, kStencil> kLevelStep{0, 1, 0, -1, 0, 1, -1, -1, 1};
constexpr std::array<int, kStencil> kSliceStep{0, 0, 1, 0, -1, 1, 1, -1, -1};

using Number = star::Dual<kStencil>;
using Place = star::Vec<Number>;

/// The loss and its slopes for points given by value and tangent.
class StackLoss {
 public:
  StackLoss(const SliceStack& stack, const AugmentedSpec& spec, std::size_t first)
      : stack_(stack), spec_(spec), first_(first) {
    double sum = 0;
    for (const SliceCurve& curve : stack.curves) sum += 0.5 * (curve.d() + curve.h());
    size_ = sum / static_cast<double>(stack.curves.size());
  }

  [[nodiscard]] std::size_t levels() const { return static_cast<std::size_t>(stack_.units) + 1; }

  /// The added terms; `jets` has a point and tangent a vertex, `slope` (if any) is added to.
  [[nodiscard]] double curvature(std::span<const CurveJet> jets, std::span<double> slope) const {
    double sum = 0;
    std::size_t k = first_;
    for (std::size_t j = 1; j + 1 < stack_.curves.size(); ++j) {
      for (std::size_t i = 1; i + 1 < levels(); ++i, ++k) {
        const Number term = term_at(jets, j * levels() + i, j, k);
        sum += term.value;
        if (slope.empty()) continue;
        for (std::size_t n = 0; n < kStencil; ++n) slope[neighbour(j, i, n)] += term.by[n];
      }
    }
    return sum;
  }

  /// Sum of L_j.
  [[nodiscard]] double chains(std::span<const double> x, std::span<const double> z) const {
    double sum = 0;
    for (std::size_t j = 0; j < stack_.curves.size(); ++j)
      sum += chain_loss(x.subspan(j * levels(), levels()), z.subspan(j * levels(), levels()));
    return sum;
  }

 private:
  [[nodiscard]] std::size_t neighbour(std::size_t j, std::size_t i, std::size_t n) const {
    const auto row = static_cast<std::ptrdiff_t>(j) + kSliceStep[n];
    const auto level = static_cast<std::ptrdiff_t>(i) + kLevelStep[n];
    return static_cast<std::size_t>(row) * levels() + static_cast<std::size_t>(level);
  }

  [[nodiscard]] Place place(std::span<const CurveJet> jets, std::size_t at, std::size_t j,
                            std::size_t n) const {
    const CurveJet& jet = jets[at];
    Place p{jet.x, stack_.v_mm[j], jet.z};
    p.x.by[n] = jet.dx;
    p.z.by[n] = jet.dz;
    return p;
  }

  [[nodiscard]] Number term_at(std::span<const CurveJet> jets, std::size_t at, std::size_t j,
                               std::size_t k) const {
    const std::size_t i = at - j * levels();
    std::array<Place, kStencil> around;
    for (std::size_t n = 0; n < kStencil; ++n) {
      const auto row = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(j) + kSliceStep[n]);
      around[n] = place(jets, neighbour(j, i, n), row, n);
    }
    const std::span<const Place, 4> ring(around.data() + 1, 4);
    const auto c = star::curvature<Number>(around[0], ring);
    const auto squared = [](const Number& off) { return off * off; };
    Number sum = 0.0;
    if (spec_.weight_K > 0) {
      const Number off = c.defect / c.area - Number(target_of(spec_.K_area, k));
      sum = sum + Number(spec_.weight_K * std::pow(size_, 6)) * squared(off);
    }
    if (spec_.weight_H > 0) {
      const Number off = c.mean - Number(target_of(spec_.H, k));
      sum = sum + Number(spec_.weight_H * std::pow(size_, 4)) * squared(off);
    }
    if (spec_.weight_first > 0 || spec_.weight_second > 0) {
      const Place mixed = Number(0.25) * (around[5] - around[6] + around[7] - around[8]);
      const auto f = star::forms<Number>(around[0], ring, c.normal, mixed);
      const auto off = [&](const Number& ss, const Number& st, const Number& tt,
                           const std::array<double, 3>& to) {
        return squared(ss - Number(to[0])) + Number(2.0) * squared(st - Number(to[1])) +
               squared(tt - Number(to[2]));
      };
      const Number a = off(f.a_ss, f.a_st, f.a_tt, target_of(spec_.first, k));
      const Number b = off(f.b_ss, f.b_st, f.b_tt, target_of(spec_.second, k));
      sum =
          sum + Number(spec_.weight_first / (size_ * size_)) * a + Number(spec_.weight_second) * b;
    }
    return sum;
  }

  const SliceStack& stack_;
  const AugmentedSpec& spec_;
  std::size_t first_;
  double size_{1.0};
};

bool is_finite(double value) { return std::isfinite(value); }
bool is_finite(const std::array<double, 3>& form) {
  return std::isfinite(form[0] + form[1] + form[2]);
}

Result<void> check(const SliceStack& stack, const AugmentedSpec& spec, std::size_t first) {
  const auto wrong = [](std::string detail) {
    return fail(ErrorKind::OutOfRange, "", std::move(detail));
  };
  if (stack.inner() == 0) return wrong("curvature targets need 3 slices and 2 units or more");
  if (stack.v_mm.size() != stack.curves.size())
    return wrong(fmt::format("there are {} slices and {} places along the spine; one each",
                             stack.curves.size(), stack.v_mm.size()));
  for (std::size_t j = 1; j < stack.v_mm.size(); ++j)
    if (!(stack.v_mm[j] > stack.v_mm[j - 1])) return wrong("slices must rise along the spine");
  const auto fits = [&](const auto& list, const char* what, double weight) -> Result<void> {
    if (!(weight >= 0) || !std::isfinite(weight))
      return wrong(fmt::format("the weight of {} is {:g}; 0 or more", what, weight));
    if (weight == 0) return {};
    if (list.size() != 1 && list.size() < first + stack.inner())
      return wrong(fmt::format("there are {} targets of {}; one for all, or {}", list.size(), what,
                               stack.inner()));
    if (std::all_of(list.begin(), list.end(), [](const auto& one) { return is_finite(one); }))
      return {};
    return wrong(fmt::format("a target of {} is not a finite number", what));
  };
  if (auto ok = fits(spec.K_area, "K_area", spec.weight_K); !ok) return ok;
  if (auto ok = fits(spec.H, "H", spec.weight_H); !ok) return ok;
  if (auto ok = fits(spec.first, "first", spec.weight_first); !ok) return ok;
  return fits(spec.second, "second", spec.weight_second);
}

/// The unknowns: for each slice the logarithms of the N spacings of the curve parameter, up to a
/// common factor. So the order along the curve, and with it lx, lz >= 0, always holds.
class SpacedStack {
 public:
  SpacedStack(const SliceStack& stack, const StackLoss& loss)
      : stack_(stack),
        loss_(loss),
        gap_(stack.curves.size() * static_cast<std::size_t>(stack.units)),
        jets_(stack.curves.size() * loss.levels()),
        slope_(jets_.size()) {
    points_.x.resize(jets_.size());
    points_.z.resize(jets_.size());
  }

  /// Loss at the unknowns `q`, with its gradient where there is one.
  double evaluate(const double* q, double* gradient) {
    ++evaluations_;
    const std::size_t units = loss_.levels() - 1;
    for (std::size_t j = 0; j < stack_.curves.size(); ++j) place_slice(j, q + j * units);
    std::fill(slope_.begin(), slope_.end(), 0.0);
    AugmentedLoss at;
    at.curvature =
        loss_.curvature(jets_, gradient != nullptr ? std::span(slope_) : std::span<double>());
    at.chains = loss_.chains(points_.x, points_.z);
    if (gradient != nullptr) {
      for (double& slope : slope_) slope *= share_;
      for (std::size_t j = 0; j < stack_.curves.size(); ++j) {
        add_chain_slope(j);
        to_gaps(j, gradient + j * units);
      }
    }
    const double seen = at.chains + share_ * at.curvature;
    if (std::isfinite(at.total()) && (!best_ || at.total() < best_->loss.total()))
      best_ = {points_, {}, at, 0, false};
    if (gradient != nullptr) {
      for (std::size_t k = 0; k < gap_.size(); ++k) gradient[k] /= scale_;
    }
    return seen / scale_;
  }

  /// What NLopt sees is divided by `scale`, so that its first step has a sensible length.
  void set_scale(double scale) { scale_ = scale; }
  /// Takes only this share of the added terms; the best point is that of the whole loss.
  void set_share(double share) { share_ = share; }
  [[nodiscard]] const std::optional<AugmentedChains>& best() const { return best_; }
  [[nodiscard]] int evaluations() const { return evaluations_; }

 private:
  void place_slice(std::size_t j, const double* q) {
    const std::size_t units = loss_.levels() - 1;
    double* const gap = gap_.data() + j * units;
    const double top = *std::max_element(q, q + units);
    double sum = 0;
    for (std::size_t k = 0; k < units; ++k) sum += gap[k] = std::exp(q[k] - top);
    double t = -1.0;
    for (std::size_t k = 0; k <= units; ++k) {
      const std::size_t at = j * (units + 1) + k;
      jets_[at] = stack_.curves[j].at(k == units ? 1.0 : std::min(t, 1.0));
      if (k == 0 || k == units) jets_[at].dx = jets_[at].dz = 0;  // the ends stay
      points_.x[at] = jets_[at].x;
      points_.z[at] = jets_[at].z;
      if (k < units) t += 2.0 * (gap[k] /= sum);
    }
  }

  /// Adds dL_j/dt to the slopes.
  void add_chain_slope(std::size_t j) {
    const std::size_t units = loss_.levels() - 1, first = j * (units + 1);
    for (const bool along_x : {true, false}) {
      const double* const p = (along_x ? points_.x : points_.z).data() + first;
      const double even = (p[units] - p[0]) / static_cast<double>(units);
      const auto step = [&](std::size_t k) { return p[k] - p[k - 1]; };  // k = 1 .. N
      const auto by_step = [&](std::size_t k) {
        double slope = 2.0 * (step(k) - even);
        if (k > 1) slope += 2.0 * (step(k) - step(k - 1));
        if (k < units) slope -= 2.0 * (step(k + 1) - step(k));
        return slope;
      };
      for (std::size_t k = 1; k < units; ++k) {
        const CurveJet& jet = jets_[first + k];
        slope_[first + k] += (by_step(k) - by_step(k + 1)) * (along_x ? jet.dx : jet.dz);
      }
    }
  }

  /// From slopes by the curve parameter to slopes by the logarithms of the spacings.
  void to_gaps(std::size_t j, double* gradient) const {
    const std::size_t units = loss_.levels() - 1;
    const double* const gap = gap_.data() + j * units;
    const double* const by_t = slope_.data() + j * (units + 1);
    double behind = 0, mean = 0;
    for (std::size_t k = units; k-- > 0;) {
      if (k + 1 < units) behind += 2.0 * by_t[k + 1];
      gradient[k] = behind;
      mean += gap[k] * behind;
    }
    for (std::size_t k = 0; k < units; ++k) gradient[k] = gap[k] * (gradient[k] - mean);
  }

  const SliceStack& stack_;
  const StackLoss& loss_;
  std::vector<double> gap_;
  std::vector<CurveJet> jets_;
  std::vector<double> slope_;
  StackPoints points_;
  std::optional<AugmentedChains> best_;
  int evaluations_{0};
  double scale_{1.0}, share_{1.0};
};

double evaluate_of(unsigned, const double* q, double* gradient, void* data) {
  return static_cast<SpacedStack*>(data)->evaluate(q, gradient);
}

/// A search's time is measured as NLopt does itself.
class Deadline {
 public:
  explicit Deadline(double budget_s) : budget_s_(budget_s) {}
  [[nodiscard]] double left_s() const {
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start_;
    return budget_s_ - spent.count();
  }

 private:
  std::chrono::steady_clock::time_point start_{std::chrono::steady_clock::now()};
  double budget_s_;
};

/// Moves `q` downhill. NLopt ends an L-BFGS line search that gains nothing more with a failure
/// code; so the code tells nothing, and the search goes on from there until it gains nothing.
void minimise(SpacedStack& problem, std::vector<double>& q, int most_evaluations,
              const Deadline& deadline) {
  problem.set_scale(1.0);
  double last = problem.evaluate(q.data(), nullptr);
  if (!(last > 0) || !std::isfinite(last)) return;
  problem.set_scale(last);
  last = 1.0;
  nlopt_opt opt = nlopt_create(NLOPT_LD_LBFGS, static_cast<unsigned>(q.size()));
  nlopt_set_min_objective(opt, evaluate_of, &problem);
  nlopt_set_ftol_rel(opt, 1e-15);
  nlopt_set_xtol_rel(opt, 1e-13);
  nlopt_set_maxeval(opt, most_evaluations);
  constexpr int kRestarts = 8;
  for (int round = 0; round < kRestarts; ++round) {
    std::vector<double> next = q;
    double value = 0.0;
    const double left_s = deadline.left_s();
    if (left_s <= 0.0) break;
    nlopt_set_maxtime(opt, left_s);
    nlopt_optimize(opt, next.data(), &value);
    const double now = problem.evaluate(next.data(), nullptr);
    if (!(now < last)) break;
    q = std::move(next);
    if (now > last * (1 - 1e-9)) break;
    last = now;
  }
  nlopt_destroy(opt);
}

/// The plain chains as unknowns.
Result<std::vector<double>> plain_start(const SliceStack& stack) {
  const auto units = static_cast<std::size_t>(stack.units);
  std::vector<double> q(stack.curves.size() * units), x(units + 1), z(units + 1);
  ChainSolver solver;
  for (std::size_t j = 0; j < stack.curves.size(); ++j) {
    const SliceCurve& curve = stack.curves[j];
    if (auto done = solver.solve(curve, stack.units, x, z); !done)
      return tl::unexpected(within(fmt::format("slice {}", j), done.error()));
    const auto t = [&](std::size_t k) { return x[k] / curve.d() - z[k] / curve.h(); };
    constexpr double kLeast = 1e-12;
    for (std::size_t k = 0; k < units; ++k)
      q[j * units + k] = std::log(std::max(0.5 * (t(k + 1) - t(k)), kLeast));
  }
  return q;
}

}  // namespace

Result<AugmentedLoss> augmented_loss(const SliceStack& stack, const StackPoints& points,
                                     const AugmentedSpec& spec, std::size_t first) {
  if (auto ok = check(stack, spec, first); !ok) return tl::unexpected(ok.error());
  const StackLoss loss(stack, spec, first);
  const std::size_t count = stack.curves.size() * loss.levels();
  if (points.x.size() != count || points.z.size() != count) {
    return fail(ErrorKind::OutOfRange, "",
                fmt::format("there are {} points; {} slices of {} units have {}", points.x.size(),
                            stack.curves.size(), stack.units, count));
  }
  std::vector<CurveJet> jets(count);
  for (std::size_t k = 0; k < count; ++k) jets[k].x = points.x[k], jets[k].z = points.z[k];
  return AugmentedLoss{loss.chains(points.x, points.z), loss.curvature(jets, {})};
}

Result<AugmentedChains> solve_chain_augmented(const SliceStack& stack, const AugmentedSpec& spec,
                                              std::size_t first, int most_evaluations,
                                              double budget_s) {
  if (auto ok = check(stack, spec, first); !ok) return tl::unexpected(ok.error());
  const auto plain = plain_start(stack);
  if (!plain) return tl::unexpected(plain.error());
  const StackLoss loss(stack, spec, first);
  SpacedStack problem(stack, loss);
  problem.evaluate(plain->data(), nullptr);
  if (!problem.best()) {
    return fail(ErrorKind::Infeasible, "",
                "the curvature of the plain chains is not finite; no star may vanish");
  }
  const AugmentedLoss start = problem.best()->loss;
  const Deadline deadline(budget_s);
  // Straight to it, then by growing weights, which stays nearer to the plain chains: the best
  // counts.
  std::vector<double> direct = *plain;
  minimise(problem, direct, most_evaluations, deadline);
  std::vector<double> grown = *plain;
  constexpr int kStages = 6;
  for (int stage = 1 - kStages; stage <= 0; ++stage) {
    problem.set_share(std::pow(10.0, stage));
    minimise(problem, grown, most_evaluations, deadline);
  }
  AugmentedChains out = *problem.best();
  out.start = start;
  out.evaluations = problem.evaluations();
  out.out_of_time = deadline.left_s() <= 0.0;
  return out;
}

}  // namespace popcut
