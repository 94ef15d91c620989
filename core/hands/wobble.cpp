// SPDX-License-Identifier: MIT
#include "core/hands/wobble.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Sparse>

#include "core/geometry/angle.hpp"

namespace popcut::hands {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr double kSame_mm = 1e-6;
constexpr double kArm_mm = 50.0;  ///< turns are measured by how far they move a point so far away
constexpr double kFaint = 1e-8;   ///< beside the equations: a face that nothing holds stays finite
constexpr int kUnknowns = 3;      ///< of a face: two shifts of its middle, and its turn
constexpr std::int32_t kFixed = -1;

/// Of a symmetric matrix's inverse the entries where its Cholesky factor L has some, column by
/// column from the last one: Z = (L L^T)^-1 satisfies L^T Z = L^-1, whose part above the diagonal
/// is zero (Takahashi, Fagan and Chin 1973).
///
/// A column of Z takes the entries of Z between all rows of that column of L. Neighbouring columns
/// mostly have the same rows below them, so these entries are put into a dense matrix once for all
/// of them: O(sum over columns of rows^2), without a search.
class SparseInverse {
 public:
  explicit SparseInverse(const Sparse& factor) : L_(factor), Z_(factor) {
    for (Eigen::Index end = L_.cols(); end > 0;) {
      Eigen::Index begin = end - 1;
      while (begin > 0 && has_rows_of_next(begin - 1)) --begin;
      fill_columns(begin, end);
      end = begin;
    }
  }

  [[nodiscard]] double at(Eigen::Index i, Eigen::Index j) const {
    const auto [low, high] = std::minmax(i, j);
    const int* begin = Z_.innerIndexPtr() + Z_.outerIndexPtr()[low];
    const int* end = Z_.innerIndexPtr() + Z_.outerIndexPtr()[low + 1];
    const int* found = std::lower_bound(begin, end, static_cast<int>(high));
    return found != end && *found == high ? Z_.valuePtr()[found - Z_.innerIndexPtr()] : 0.0;
  }

 private:
  /// The rows of a column of L, the diagonal first.
  [[nodiscard]] std::span<const int> rows_of(Eigen::Index column) const {
    const int first = L_.outerIndexPtr()[column], end = L_.outerIndexPtr()[column + 1];
    return {L_.innerIndexPtr() + first, static_cast<std::size_t>(end - first)};
  }
  [[nodiscard]] bool has_rows_of_next(Eigen::Index column) const {
    const std::span<const int> own = rows_of(column).subspan(1), next = rows_of(column + 1);
    return std::equal(own.begin(), own.end(), next.begin(), next.end());
  }

  /// Columns of which each has the rows of the next one, and its own.
  void fill_columns(Eigen::Index begin, Eigen::Index end) {
    const std::span<const int> rows = rows_of(begin);
    size_ = rows.size();
    between_.assign(size_ * size_, 0.0);
    for (auto k = static_cast<std::size_t>(end - begin); k < size_; ++k) gather(rows, k);
    for (Eigen::Index j = end; j-- > begin;) fill_column(j, static_cast<std::size_t>(j - begin));
  }

  [[nodiscard]] double* between(std::size_t row) { return between_.data() + row * size_; }
  void set_between(std::size_t k, std::size_t p, double value) {
    between(k)[p] = between(p)[k] = value;
  }

  /// Takes over the entries of Z between row k and those after it.
  void gather(std::span<const int> rows, std::size_t k) {
    const int first = Z_.outerIndexPtr()[rows[k]];
    const std::span<const int> has = rows_of(rows[k]);
    std::size_t at = 0;
    for (std::size_t p = k; p < rows.size(); ++p) {
      while (at < has.size() && has[at] < rows[p]) ++at;
      if (at < has.size() && has[at] == rows[p])
        set_between(k, p, Z_.valuePtr()[first + static_cast<int>(at)]);
    }
  }

  /// @param own  its row in `between_`; those after it are known
  void fill_column(Eigen::Index j, std::size_t own) {
    const int first = L_.outerIndexPtr()[j];
    const double* const l = L_.valuePtr() + first;
    double* const z = Z_.valuePtr() + first;
    const std::size_t count = size_ - own;
    const auto between_own = [&](std::size_t row) { return between(own + row) + own; };
    // Each sum goes through the rows in their order, four at a time.
    sums_.assign(count, 0.0);
    double* const sum = sums_.data();
    std::size_t k = 1;
    for (; k + 4 <= count; k += 4) {
      const double *const a = between_own(k), *const b = between_own(k + 1);
      const double *const c = between_own(k + 2), *const d = between_own(k + 3);
      const double la = l[k], lb = l[k + 1], lc = l[k + 2], ld = l[k + 3];
      for (std::size_t p = 1; p < count; ++p)
        sum[p] = (((sum[p] + la * a[p]) + lb * b[p]) + lc * c[p]) + ld * d[p];
    }
    for (; k < count; ++k) {
      const double* const a = between_own(k);
      for (std::size_t p = 1; p < count; ++p) sum[p] += l[k] * a[p];
    }
    const double diagonal = l[0];
    double rest = 1.0 / diagonal;
    for (std::size_t p = 1; p < count; ++p) {
      z[p] = -sum[p] / diagonal;
      rest -= l[p] * z[p];
      set_between(own, own + p, z[p]);
    }
    z[0] = rest / diagonal;
    set_between(own, own, z[0]);
  }

  const Sparse& L_;
  Sparse Z_;
  // Of the columns at hand:
  std::size_t size_{};           ///< how many rows they have together
  std::vector<double> between_;  ///< Z between these
  std::vector<double> sums_;
};

/// A face seen along the spine.
struct Section {
  std::int32_t number{kFixed};  ///< among those that move
  double x_mm{}, z_mm{};        ///< its middle
  double area_mm2{};
};

class Measure {
 public:
  Measure(const Pattern& pattern, const Play& play) : pattern_(pattern), play_(play) {}

  std::optional<Wobble> run() {
    if (pattern_.faces() > kMostWobbleFaces) return std::nullopt;
    at_ = pattern_.vertices;
    for (const Kite& kite : pattern_.kites)
      for (const std::uint32_t i : kite.vertices) {
        const KitePoint p = kite.section.posed(at_[i].x, at_[i].z, 0.5 * kPi);
        at_[i].x = p.x, at_[i].z = p.z;
      }
    look_at_faces();
    if (moving_ == 0) return std::nullopt;
    add_folds();
    const Eigen::Index n = Eigen::Index{kUnknowns} * moving_;
    Sparse normal(n, n);
    normal.setFromTriplets(terms_.begin(), terms_.end());
    Eigen::SimplicialLLT<Sparse> cholesky(normal);
    if (cholesky.info() != Eigen::Success) return std::nullopt;
    const Sparse factor = cholesky.matrixL();
    const SparseInverse inverse(factor);
    const auto& place = cholesky.permutationP().indices();
    Wobble out;
    out.face_mm.assign(pattern_.faces(), 0.0);
    for (std::size_t f = 0; f < pattern_.faces(); ++f) {
      const Section& s = sections_[f];
      if (s.number == kFixed) continue;
      Eigen::Matrix3d covariance;
      for (int r = 0; r < kUnknowns; ++r)
        for (int c = 0; c < kUnknowns; ++c)
          covariance(r, c) =
              inverse.at(place[kUnknowns * s.number + r], place[kUnknowns * s.number + c]);
      out.face_mm[f] = farthest(f, covariance);
    }
    follow_v_folds(out.face_mm);
    sum_up(out);
    return out;
  }

 private:
  void look_at_faces() {
    sections_.resize(pattern_.faces());
    const double far_mm = pattern_.wall_mm + pattern_.ground_mm;
    for (std::size_t f = 0; f < pattern_.faces(); ++f) {
      Section& s = sections_[f];
      const auto corners = pattern_.face(f);
      bool at_edge = false;
      const PatternVertex* before = &pattern_.vertices[corners.back()];
      for (const std::uint32_t corner : corners) {
        const PatternVertex& p = pattern_.vertices[corner];
        s.x_mm += at_[corner].x / static_cast<double>(corners.size());
        s.z_mm += at_[corner].z / static_cast<double>(corners.size());
        s.area_mm2 += 0.5 * (pattern_.u(*before) * p.v - pattern_.u(p) * before->v);
        const double u_mm = pattern_.u(p);
        at_edge |= u_mm < kSame_mm || u_mm > far_mm - kSame_mm;
        before = &p;
      }
      if (!at_edge) s.number = moving_++;
    }
  }

  /// The two equations of each fold, as their part of J^T J.
  void add_folds() {
    const double variance_mm2 = play_.line_mm * play_.line_mm + 0.5 * play_.end_mm * play_.end_mm;
    for (const PatternEdge& edge : pattern_.edges) {
      if (edge.role != EdgeRole::Mountain && edge.role != EdgeRole::Valley) continue;
      if (edge.left < 0 || edge.right < 0 || edge.left == edge.right) continue;
      const PatternVertex &from = at_[edge.from], &to = at_[edge.to];
      if (std::abs(from.x - to.x) > kSame_mm || std::abs(from.z - to.z) > kSame_mm) continue;
      const double length_mm = std::max(std::abs(to.v - from.v), kSame_mm);
      add_fold(edge, from.x, from.z, std::min(1.0, length_mm / play_.short_fold_mm) / variance_mm2);
    }
    for (int k = 0; k < kUnknowns * moving_; ++k) terms_.emplace_back(k, k, kFaint / variance_mm2);
  }

  void add_fold(const PatternEdge& edge, double x_mm, double z_mm, double weight) {
    // The rows of one face: how its unknowns move the fold along x and along z.
    const auto rows = [&](const Section& s, double sign) {
      return std::array<std::array<double, kUnknowns>, 2>{
          {{sign, 0.0, -sign * (z_mm - s.z_mm) / kArm_mm},
           {0.0, sign, sign * (x_mm - s.x_mm) / kArm_mm}}};
    };
    const std::array faces{&sections_[static_cast<std::size_t>(edge.left)],
                           &sections_[static_cast<std::size_t>(edge.right)]};
    for (std::size_t a = 0; a < 2; ++a)
      for (std::size_t b = 0; b < 2; ++b) {
        const Section &one = *faces[a], &other = *faces[b];
        if (one.number == kFixed || other.number == kFixed) continue;
        const auto left = rows(one, a == 0 ? 1.0 : -1.0), right = rows(other, b == 0 ? 1.0 : -1.0);
        for (int r = 0; r < kUnknowns; ++r)
          for (int c = 0; c < kUnknowns; ++c) {
            const auto at = static_cast<std::size_t>(r), to = static_cast<std::size_t>(c);
            const double sum = left[0][at] * right[0][to] + left[1][at] * right[1][to];
            terms_.emplace_back(kUnknowns * one.number + r, kUnknowns * other.number + c,
                                weight * sum);
          }
      }
  }

  /// The root mean square of the movement of a face's farthest corner.
  [[nodiscard]] double farthest(std::size_t face, const Eigen::Matrix3d& covariance) const {
    const Section& s = sections_[face];
    double most_mm2 = 0.0;
    for (const std::uint32_t corner : pattern_.face(face)) {
      const PatternVertex& p = at_[corner];
      const double x = (p.x - s.x_mm) / kArm_mm, z = (p.z - s.z_mm) / kArm_mm;
      most_mm2 = std::max(most_mm2, covariance(0, 0) + covariance(1, 1) +
                                        2.0 * (x * covariance(1, 2) - z * covariance(0, 2)) +
                                        (x * x + z * z) * covariance(2, 2));
    }
    return std::sqrt(most_mm2);
  }

  void follow_v_folds(std::vector<double>& face_mm) {
    for (const VFold& fold : pattern_.v_folds) {
      const PatternEdge &b = pattern_.edges[fold.edge_b], &c = pattern_.edges[fold.edge_c];
      std::vector<std::int32_t> triangles, panels;
      for (const std::int32_t f : {b.left, b.right, c.left, c.right}) {
        if (f < 0) continue;
        const auto corners = pattern_.face(static_cast<std::size_t>(f));
        const bool has_tip = std::find(corners.begin(), corners.end(), fold.tip) != corners.end();
        (has_tip ? triangles : panels).push_back(f);
      }
      double most_mm = 0.0;
      for (const std::int32_t f : panels)
        most_mm = std::max(most_mm, face_mm[static_cast<std::size_t>(f)]);
      for (const std::int32_t f : triangles) face_mm[static_cast<std::size_t>(f)] = most_mm;
    }
  }

  void sum_up(Wobble& out) const {
    double area_mm2 = 0.0, loose_mm2 = 0.0;
    for (std::size_t f = 0; f < pattern_.faces(); ++f) {
      if (sections_[f].number == kFixed) continue;
      const double face_mm = out.face_mm[f], face_mm2 = std::abs(sections_[f].area_mm2);
      out.largest_mm = std::max(out.largest_mm, face_mm);
      out.mean_mm += face_mm * face_mm2;
      area_mm2 += face_mm2;
      if (face_mm > kFirm_mm) ++out.loose, loose_mm2 += face_mm2;
    }
    if (!(area_mm2 > 0.0)) return;
    out.mean_mm /= area_mm2;
    out.loose_share = loose_mm2 / area_mm2;
  }

  const Pattern& pattern_;
  Play play_;
  std::vector<PatternVertex> at_;  ///< where the vertices are at psi = pi/2
  std::vector<Section> sections_;
  int moving_{};
  std::vector<Eigen::Triplet<double>> terms_;
};

}  // namespace

std::optional<Wobble> wobble_of(const Pattern& pattern, const Play& play) {
  return Measure(pattern, play).run();
}

}  // namespace popcut::hands
