// SPDX-License-Identifier: MIT
#include "core/verify/mobility.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include "core/verify/hinge_lines.hpp"

namespace popcut::verify {
namespace {

using Matrix = Eigen::MatrixXd;
using Sparse = Eigen::SparseMatrix<double>;

constexpr Eigen::Index kDenseColumns = 120;
constexpr double kLargestZero = 1e-5;  ///< singular values above this never count as zero
constexpr double kClearGap = 100.0;
constexpr std::size_t kShown = 12;

Vec3 any_across(Vec3 axis) {
  const Vec3 other = std::abs(axis.x) < 0.5 ? Vec3{1.0, 0.0, 0.0} : Vec3{0.0, 1.0, 0.0};
  return unit(cross(axis, other));
}

/// The hinge constraints: rows are equations, columns the twists of all panels but `held`.
Sparse constraints(const std::vector<HingeLine>& lines, const std::vector<PanelFrame>& frames,
                   const PoseMotion& pose, std::uint32_t held) {
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
      put(0, 1, arm.z), put(0, 2, -arm.y), put(0, 3, sign);
      put(1, 0, -arm.z), put(1, 2, arm.x), put(1, 4, sign);
      put(2, 0, arm.y), put(2, 1, -arm.x), put(2, 5, sign);
      for (int k = 0; k < 2; ++k) {
        const Vec3 n = (sign * lever / size) * normals[static_cast<std::size_t>(k)];
        put(3 + k, 0, n.x), put(3 + k, 1, n.y), put(3 + k, 2, n.z);
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
  result.resize(static_cast<std::size_t>(columns), 0.0);  // fewer equations than unknowns
  std::sort(result.begin(), result.end());
  return result;
}

/// Splits ascending singular values at their widest gap, counting from what rounding can give.
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

/// Orthonormal columns that span those of `x`.
Matrix orthonormal(const Matrix& x) {
  const Eigen::HouseholderQR<Matrix> qr(x);
  return qr.householderQ() * Matrix::Identity(x.rows(), x.cols());
}

/// Inverse iteration on J^T J, factored once.
class SmallestSingularValues {
 public:
  explicit SmallestSingularValues(const Sparse& jacobian) : jacobian_(jacobian) {
    Sparse normal = jacobian.transpose() * jacobian;
    // A shift far below any singular value that counts, far above rounding, makes it definite.
    Sparse shift(normal.rows(), normal.cols());
    shift.setIdentity();
    normal += 1e-12 * shift;
    factor_.compute(normal);
  }
  [[nodiscard]] bool sound() const { return factor_.info() == Eigen::Success; }

  /// The `count` smallest singular values, ascending; the largest of them are only upper bounds.
  [[nodiscard]] std::vector<double> smallest(Eigen::Index count, double noise) const {
    std::mt19937 random(20261121);
    std::normal_distribution<double> normal;
    Matrix x = Matrix::NullaryExpr(jacobian_.cols(), count, [&] { return normal(random); });
    std::vector<double> values;
    std::size_t steady = 0;
    for (int step = 0; step < 60 && steady < 3; ++step) {
      x = orthonormal(factor_.solve(x));
      const Matrix image = jacobian_ * x;
      const Matrix triangle = Eigen::HouseholderQR<Matrix>(image)
                                  .matrixQR()
                                  .topRows(std::min(count, image.rows()))
                                  .triangularView<Eigen::Upper>();
      const Eigen::JacobiSVD<Matrix> svd(triangle, Eigen::ComputeFullV);
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

/// Widens the block until the gap lies inside it, as far as memory allows.
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

}  // namespace

Mobility mobility(const FoldFile& file, const Sheet& sheet, const PoseMotion& pose,
                  double noise_mm) {
  Mobility result;
  const std::vector<HingeLine> lines = hinge_lines(file, sheet);
  result.hinges = lines.size();
  if (sheet.panels < 2) {
    result.clear = true;
    return result;
  }
  const std::vector<PanelFrame> frames = panel_frames(lines, sheet.panels);
  const auto busiest = std::max_element(
      frames.begin(), frames.end(),
      [](const PanelFrame& a, const PanelFrame& b) { return a.hinges < b.hinges; });
  const Sparse jacobian =
      constraints(lines, frames, pose, static_cast<std::uint32_t>(busiest - frames.begin()));
  result.unknowns = static_cast<std::size_t>(jacobian.cols());
  double least_mm = busiest->size_mm;
  for (const PanelFrame& frame : frames) least_mm = std::min(least_mm, frame.size_mm);
  result.noise = std::max(1e-13, noise_mm / least_mm);
  result.sparse = jacobian.cols() > kDenseColumns;
  if (result.sparse) {
    split_sparse(jacobian, result.noise, result);
  } else {
    const Eigen::JacobiSVD<Matrix> svd{Matrix(jacobian)};
    split(ascending(svd.singularValues(), jacobian.cols()), result.noise, result);
  }
  return result;
}

}  // namespace popcut::verify
