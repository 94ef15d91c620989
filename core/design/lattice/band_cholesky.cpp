// SPDX-License-Identifier: MIT
#include "core/design/lattice/band_cholesky.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

namespace popcut {
namespace {

constexpr int kBlock = 16;
using Dense = Eigen::MatrixXd;
using View = Eigen::Map<Dense, 0, Eigen::OuterStride<>>;

}  // namespace

BandCholesky::BandCholesky(int size, int band)
    : size_(size),
      // A column's entries end where those of the next but `band` begin, so a band has a width.
      band_(std::max(1, std::min(band, size - 1))),
      value_(static_cast<std::size_t>(size) * (static_cast<std::size_t>(band_) + 1)) {}

void BandCholesky::set_zero() { std::fill(value_.begin(), value_.end(), 0.0); }

/// Cholesky of the block on the diagonal, column by column.
bool BandCholesky::factorize_block(int begin, int count) {
  for (int c = begin; c < begin + count; ++c) {
    double* const column = entry(0, c);
    const int end = std::min(begin + count, c + band_ + 1);
    for (int k = std::max(begin, c - band_); k < c; ++k) {
      const double* const other = entry(0, k);
      const double factor = other[c];
      const int reach = std::min(end, k + band_ + 1);
      for (int r = c; r < reach; ++r) column[r] -= factor * other[r];
    }
    if (!(column[c] > 0.0) || !std::isfinite(column[c])) return false;
    const double root = std::sqrt(column[c]);
    for (int r = c; r < end; ++r) column[r] /= root;
  }
  return true;
}

bool BandCholesky::factorize() {
  const int block = std::min(kBlock, band_);
  Dense corner(block, block);  // rows below the band of the block's first columns, zeros left of it
  for (int k = 0; k < size_; k += block) {
    const int count = std::min(block, size_ - k);
    if (!factorize_block(k, count)) return false;
    const int middle = std::max(0, std::min(band_ - count, size_ - k - count));
    const int last = std::max(0, std::min(count, size_ - k - band_));
    const auto view = [&](int row, int column, int rows, int columns) {
      return View(entry(row, column), rows, columns, Eigen::OuterStride<>(band_));
    };
    const auto diagonal = view(k, k, count, count);
    View below = view(k + count, k, middle, count);
    if (middle > 0) {
      diagonal.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(below);
      view(k + count, k + count, middle, middle)
          .selfadjointView<Eigen::Lower>()
          .rankUpdate(below, -1.0);
    }
    if (last == 0) continue;
    auto foot = corner.topLeftCorner(last, count);
    foot.setZero();
    for (int c = 0; c < count; ++c)
      for (int r = 0; r <= std::min(c, last - 1); ++r) foot(r, c) = *entry(k + band_ + r, k + c);
    diagonal.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(foot);
    if (middle > 0) view(k + band_, k + count, last, middle).noalias() -= foot * below.transpose();
    view(k + band_, k + band_, last, last).selfadjointView<Eigen::Lower>().rankUpdate(foot, -1.0);
    for (int c = 0; c < count; ++c)
      for (int r = 0; r <= std::min(c, last - 1); ++r) *entry(k + band_ + r, k + c) = foot(r, c);
  }
  return true;
}

void BandCholesky::solve(std::vector<double>& x) const {
  for (int c = 0; c < size_; ++c) {
    const double* const column = entry(0, c);
    const double now = x[static_cast<std::size_t>(c)] /= column[c];
    const int end = std::min(size_, c + band_ + 1);
    for (int r = c + 1; r < end; ++r) x[static_cast<std::size_t>(r)] -= now * column[r];
  }
  for (int c = size_ - 1; c >= 0; --c) {
    const double* const column = entry(0, c);
    const int end = std::min(size_, c + band_ + 1);
    double sum = x[static_cast<std::size_t>(c)];
    for (int r = c + 1; r < end; ++r) sum -= column[r] * x[static_cast<std::size_t>(r)];
    x[static_cast<std::size_t>(c)] = sum / column[c];
  }
}

}  // namespace popcut
