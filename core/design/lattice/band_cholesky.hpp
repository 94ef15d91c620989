// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

namespace popcut {

/// Cholesky factor of a symmetric, positive definite band matrix: `size` rows, nothing farther than
/// `band` from the diagonal. With the unknowns of a lattice in the order of its slices this is the
/// block tridiagonal factor, a block a slice, without the zeros outside of its band.
///
/// Works in blocks as LAPACK's dpbtrf does (Anderson et al., LAPACK Users' Guide, 1999): O(size
/// band^2), in place.
class BandCholesky {
 public:
  /// A matrix of zeros.
  BandCholesky(int size, int band);

  /// What a matrix of that shape takes, bytes.
  [[nodiscard]] static double bytes(double size, double band) { return 8.0 * size * (band + 1.0); }

  void set_zero();
  /// Adds to the entry of row `a` and column `b`, and so to that of row `b` and column `a`; they
  /// are at most `band` apart.
  void add(int a, int b, double amount) {
    const int low = a < b ? a : b, high = a < b ? b : a;
    value_[static_cast<std::size_t>(low) * static_cast<std::size_t>(band_) +
           static_cast<std::size_t>(high)] += amount;
  }

  /// Replaces the matrix by its factor; false where it is not positive definite (it is spoilt
  /// then).
  [[nodiscard]] bool factorize();
  /// Solves for `x`, in place, with the factor.
  void solve(std::vector<double>& x) const;

 private:
  [[nodiscard]] double* entry(int row, int column) {
    return value_.data() + static_cast<std::size_t>(column) * static_cast<std::size_t>(band_) + row;
  }
  [[nodiscard]] const double* entry(int row, int column) const {
    return value_.data() + static_cast<std::size_t>(column) * static_cast<std::size_t>(band_) + row;
  }
  [[nodiscard]] bool factorize_block(int begin, int count);

  int size_, band_;
  /// Column j's entries from the diagonal down at j (band + 1): an entry's place is row + column *
  /// band, as in a dense matrix of `band` rows whose columns overlap.
  std::vector<double> value_;
};

}  // namespace popcut
