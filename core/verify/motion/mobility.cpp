// SPDX-License-Identifier: MIT
#include "core/verify/motion/mobility.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <utility>

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include "core/verify/sheet/hinge_lines.hpp"
#include "core/verify/sheet/loops.hpp"

namespace popcut::verify {
namespace {

using Matrix = Eigen::MatrixXd;
using Sparse = Eigen::SparseMatrix<double>;

constexpr Eigen::Index kDenseColumns = 120;
constexpr double kLargestZero = 1e-5;  ///< singular values above this never count as zero
constexpr double kClearGap = 100.0;
constexpr std::size_t kShown = 12;

Vec3 any_across(Vec3 axis) {
  const Vec3 other = std::abs(axis.x()) < 0.5 ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0};
  return unit(cross(axis, other));
}

/// The constraints on the velocities of the panels, for sheets without loops: hinges must stay
/// closed. Rows are equations, columns the twists of all panels except the busiest one, which is
/// held.
Sparse hinge_constraints(const Sheet& sheet, const PoseMotion& pose,
                         const std::vector<HingeLine>& lines, double& least_mm) {
  const std::vector<PanelFrame> frames = panel_frames(lines, sheet.panels);
  const auto busiest = std::max_element(
      frames.begin(), frames.end(),
      [](const PanelFrame& a, const PanelFrame& b) { return a.hinges < b.hinges; });
  for (const PanelFrame& frame : frames) least_mm = std::min(least_mm, frame.size_mm);
  const auto held = static_cast<std::uint32_t>(busiest - frames.begin());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(lines.size() * 42);
  int row = 0;
  for (const HingeLine& line : lines) {
    const Vec3 from = pose.panel[line.left](line.from);
    const Vec3 to = pose.panel[line.left](line.to);
    const Vec3 middle = 0.5 * (from + to);
    const Vec3 across = any_across(unit(to - from));
    const std::array<Vec3, 2> normals{across, cross(unit(to - from), across)};
    const double lever = std::min(frames[line.left].size_mm, frames[line.right].size_mm);
    for (const auto& [p, sign] : {std::pair(line.left, 1.0), std::pair(line.right, -1.0)}) {
      if (p == held) continue;
      const int column = 6 * static_cast<int>(p > held ? p - 1 : p);
      const double size = frames[p].size_mm;
      const Vec3 arm = (sign / size) * (middle - pose.panel[p](frames[p].middle));
      const auto put = [&](int r, int c, double value) {
        if (value != 0.0) entries.emplace_back(row + r, column + c, value);
      };
      // velocity of the middle: v + w x arm
      put(0, 1, arm.z()), put(0, 2, -arm.y()), put(0, 3, sign);
      put(1, 0, -arm.z()), put(1, 2, arm.x()), put(1, 4, sign);
      put(2, 0, arm.y()), put(2, 1, -arm.x()), put(2, 5, sign);
      for (int k = 0; k < 2; ++k) {
        const Vec3 n = (sign * lever / size) * normals[static_cast<std::size_t>(k)];
        put(3 + k, 0, n.x()), put(3 + k, 1, n.y()), put(3 + k, 2, n.z());
      }
    }
    row += 5;
  }
  Sparse jacobian(row, 6 * (static_cast<Eigen::Index>(frames.size()) - 1));
  jacobian.setFromTriplets(entries.begin(), entries.end());
  return jacobian;
}

std::vector<double> ascending(const Eigen::VectorXd& values, Eigen::Index columns) {
  std::vector<double> result(values.data(), values.data() + values.size());
  result.resize(static_cast<std::size_t>(columns), 0.0);  // there are fewer equations than unknowns
  std::sort(result.begin(), result.end());
  return result;
}

/// Splits ascending singular values at their widest gap, starting above the rounding error `noise`.
void split(const std::vector<double>& values, double noise, Mobility& result) {
  double widest = 0.0;
  std::size_t zeros = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double below = i == 0 ? noise : std::max(noise, values[i - 1]);
    if (i > 0 && values[i - 1] > std::max(kLargestZero, noise)) break;
    const double ratio = values[i] / below;
    if (ratio > widest) {
      widest = ratio;
      zeros = i;
    }
  }
  if (widest < 1.0) zeros = values.size();
  result.degrees_of_freedom = zeros;
  result.largest_zero = zeros > 0 ? values[zeros - 1] : 0.0;
  result.smallest_nonzero = zeros < values.size() ? values[zeros] : 0.0;
  result.gap = widest;
  result.clear =
      widest >= kClearGap || (zeros == values.size() && result.largest_zero <= kLargestZero);
  result.smallest.assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(std::min(
                                                              values.size(), zeros + kShown)));
}

/// Orthonormal columns with the same span as those of `x`.
Matrix orthonormal(const Matrix& x) {
  const Eigen::HouseholderQR<Matrix> qr(x);
  return qr.householderQ() * Matrix::Identity(x.rows(), x.cols());
}

/// The upper triangle of a QR factorisation of `x`, with as many rows as columns: rows that `x`
/// lacks are zero. It has the singular values and the right singular vectors of `x`.
Matrix triangle(const Matrix& x) {
  const Eigen::Index rows = std::min(x.rows(), x.cols());
  Matrix result = Matrix::Zero(x.cols(), x.cols());
  const Eigen::HouseholderQR<Matrix> qr(x);
  result.topRows(rows) = qr.matrixQR().topRows(rows).triangularView<Eigen::Upper>();
  return result;
}

using SquareSvd = Eigen::JacobiSVD<Matrix, Eigen::NoQRPreconditioner>;

/// Inverse iteration on J^T J, factored once.
class SmallestSingularValues {
 public:
  explicit SmallestSingularValues(const Sparse& jacobian) : jacobian_(jacobian) {
    Sparse normal = jacobian.transpose() * jacobian;
    // A shift far below any relevant singular value and far above rounding makes it definite.
    Sparse shift(normal.rows(), normal.cols());
    shift.setIdentity();
    normal += 1e-12 * shift;
    factor_.compute(normal);
  }
  [[nodiscard]] bool sound() const { return factor_.info() == Eigen::Success; }

  /// The `count` smallest singular values, ascending; the largest of these are only upper bounds.
  [[nodiscard]] std::vector<double> smallest(Eigen::Index count, double noise) const {
    std::mt19937 random(20261121);
    std::normal_distribution<double> normal;
    Matrix x = Matrix::NullaryExpr(jacobian_.cols(), count, [&] { return normal(random); });
    std::vector<double> values;
    std::size_t steady = 0;
    for (int step = 0; step < 60 && steady < 3; ++step) {
      x = orthonormal(factor_.solve(x));
      const SquareSvd svd(triangle(jacobian_ * x), Eigen::ComputeFullV);
      x = x * svd.matrixV();
      std::vector<double> now = ascending(svd.singularValues(), count);
      Mobility before;
      Mobility after;
      split(values, noise, before);
      split(now, noise, after);
      const bool same = !values.empty() && before.degrees_of_freedom == after.degrees_of_freedom &&
                        std::abs(after.smallest_nonzero - before.smallest_nonzero) <=
                            1e-3 * after.smallest_nonzero;
      steady = same ? steady + 1 : 0;
      values = std::move(now);
    }
    return values;
  }

 private:
  const Sparse& jacobian_;
  Eigen::SimplicialLLT<Sparse, Eigen::Lower, Eigen::AMDOrdering<int>> factor_;
};

/// Enlarges the block until it contains the gap, as far as memory allows.
void split_sparse(const Sparse& jacobian, double noise, Mobility& result) {
  const SmallestSingularValues solver(jacobian);
  if (!solver.sound()) {
    result.counted = false;
    return;
  }
  const Eigen::Index most = std::clamp<Eigen::Index>(20'000'000 / jacobian.cols(), 12, 512);
  for (Eigen::Index block = 12;; block = std::min(4 * block, most)) {
    split(solver.smallest(std::min(block, jacobian.cols()), noise), noise, result);
    const bool inside = static_cast<Eigen::Index>(result.degrees_of_freedom) + 3 <= block;
    if (inside || block >= jacobian.cols()) return;
    if (block == most) {
      result.counted = false;
      result.clear = false;
      return;
    }
  }
}

/// By the dense method, or by the sparse one.
void count(const Sparse& jacobian, Mobility& result) {
  result.sparse = jacobian.cols() > kDenseColumns;
  if (result.sparse) return split_sparse(jacobian, result.noise, result);
  const SquareSvd svd(triangle(Matrix(jacobian)));
  split(ascending(svd.singularValues(), jacobian.cols()), result.noise, result);
}

/// The constraints on the speeds of the hinge lines: each loop of panels must close. Angular
/// velocities around it sum to zero, and so do their moments about the loop's middle, which are
/// scaled by the loop's size.
Sparse loop_constraints(const FoldModel& file, const Sheet& sheet, const PoseMotion& pose,
                        const std::vector<HingeLine>& lines, const Loops& loops, double& least_mm) {
  // 1. The line that each fold belongs to, and whether the fold runs against it.
  struct OfLine {
    std::int32_t line{-1};
    double sign{1.0};
  };
  std::vector<OfLine> of_line(sheet.hinges.size());
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> between;
  for (std::uint32_t k = 0; k < lines.size(); ++k)
    between[std::minmax({lines[k].left, lines[k].right})].push_back(k);
  for (std::uint32_t h = 0; h < sheet.hinges.size(); ++h) {
    const Hinge& hinge = sheet.hinges[h];
    const std::uint32_t left = sheet.panel_of_face[hinge.left];
    const std::uint32_t right = sheet.panel_of_face[hinge.right];
    if (left == right) continue;
    const Vec2 from = file.flat[hinge.from];
    const Vec2 to = file.flat[hinge.to];
    double nearest = 0.0;
    for (const std::uint32_t k : between[std::minmax({left, right})]) {
      const HingeLine& line = lines[k];
      const Vec2 way = line.to - line.from;
      const double off =
          (std::abs(cross(way, from - line.from)) + std::abs(cross(way, to - line.from))) /
          norm(way);
      if (of_line[h].line >= 0 && off >= nearest) continue;
      nearest = off;
      of_line[h].line = static_cast<std::int32_t>(k);
      of_line[h].sign = (line.left == left ? 1.0 : -1.0) * (dot(way, to - from) > 0.0 ? 1.0 : -1.0);
    }
  }
  // 2. Six rows per loop.
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(6 * loops.crossings.size());
  // Position, and the direction in which it turns the rest of the loop.
  std::vector<std::pair<Vec3, Vec3>> axis;
  int row = 0;
  for (std::size_t k = 0; k < loops.size(); ++k) {
    axis.clear();
    Vec3 middle;
    for (std::uint32_t c = loops.first[k]; c < loops.first[k + 1]; ++c) {
      const Crossing& crossing = loops.crossings[c];
      const Hinge& hinge = sheet.hinges[crossing.hinge];
      const PanelMotion& motion = pose.panel[sheet.panel_of_face[hinge.left]];
      const Vec3 from = motion(file.flat[hinge.from]);
      const Vec3 to = motion(file.flat[hinge.to]);
      const double sign = (crossing.to_left ? 1.0 : -1.0) * of_line[crossing.hinge].sign;
      axis.emplace_back(0.5 * (from + to), sign * unit(to - from));
      middle = middle + 0.5 * (from + to);
    }
    if (axis.empty()) continue;
    middle = (1.0 / static_cast<double>(axis.size())) * middle;
    double size = 0.0;
    for (const auto& [at, way] : axis) size = std::max(size, norm(at - middle));
    if (!(size > 0.0)) size = 1.0;
    least_mm = std::min(least_mm, size);
    for (std::size_t i = 0; i < axis.size(); ++i) {
      const std::int32_t line = of_line[loops.crossings[loops.first[k] + i].hinge].line;
      if (line < 0) continue;  // a flat crease
      const auto& [at, way] = axis[i];
      const Vec3 moment = (1.0 / size) * cross(at - middle, way);
      int r = row;
      for (const double value : {way.x(), way.y(), way.z(), moment.x(), moment.y(), moment.z()})
        entries.emplace_back(r++, line, value);
    }
    row += 6;
  }
  Sparse jacobian(row, static_cast<Eigen::Index>(lines.size()));
  jacobian.setFromTriplets(entries.begin(), entries.end());
  return jacobian;
}

}  // namespace

Mobility mobility(const FoldModel& file, const Sheet& sheet, const PoseMotion& pose,
                  double noise_mm, MobilityForm form) {
  Mobility result;
  const std::vector<HingeLine> lines = hinge_lines(file, sheet);
  result.hinges = lines.size();
  if (sheet.panels < 2) {
    result.clear = true;
    return result;
  }
  const auto loops = form == MobilityForm::Panels ? std::nullopt : loops_of(file, sheet);
  double least_mm = 1e300;
  const Sparse jacobian = loops ? loop_constraints(file, sheet, pose, lines, *loops, least_mm)
                                : hinge_constraints(sheet, pose, lines, least_mm);
  result.unknowns = static_cast<std::size_t>(jacobian.cols());
  if (jacobian.rows() == 0) {  // a tree of panels: every hinge turns freely
    result.degrees_of_freedom = loops ? lines.size() : result.unknowns;
    result.clear = true;
    return result;
  }
  result.noise = std::max(1e-13, noise_mm / least_mm);
  count(jacobian, result);
  return result;
}

Mobility free_speeds(std::span<const SpeedInEquation> entries, int equations, int speeds,
                     double noise) {
  std::vector<Eigen::Triplet<double>> all;
  all.reserve(entries.size());
  for (const auto& [equation, speed, factor] : entries) all.emplace_back(equation, speed, factor);
  Sparse jacobian(equations, speeds);
  jacobian.setFromTriplets(all.begin(), all.end());
  Mobility result;
  result.unknowns = static_cast<std::size_t>(speeds);
  result.noise = noise;
  count(jacobian, result);
  return result;
}

}  // namespace popcut::verify
