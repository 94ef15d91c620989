// SPDX-License-Identifier: MIT
#include "core/rigid/mobility.hpp"

#include <algorithm>

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include "core/geometry/disjoint_sets.hpp"

namespace popcut::rigid {
namespace {

/// One of the two systems: the panels of one direction are lines, the others nodes (`Propagation`).
///
/// The functions that are affine over the whole always solve it. They are taken out by setting them
/// to zero on the first line; what follows from that by propagation is exactly zero, so that a
/// tight pattern needs no arithmetic at all. What is left over falls into components, loose ends
/// mostly. In each the numbers of the nodes are the unknowns, and every line with more than two
/// nodes says that those between its outermost two are interpolated: coefficients from 0 to 1, so
/// that nothing is extrapolated and rounding cannot grow along a chain.
class AffineSystem {
 public:
  AffineSystem(const Section& section, bool lines_upright)
      : section_(section), lines_upright_(lines_upright), held_(section) {}

  /// Number of independent solutions; marks in `loose` the panels that can leave the common motion.
  int solutions(std::vector<std::uint8_t>& loose) {
    const auto panels = static_cast<std::uint32_t>(section_.panels());
    std::uint32_t first = 0;
    while (first < panels && !is_line(first)) ++first;
    if (first < panels) held_.hold(first);
    int count = 2;
    std::vector<std::uint8_t> seen(panels, 0);
    for (std::uint32_t p = 0; p < panels; ++p)
      if (!held_.is_held(p) && seen[p] == 0) count += free_in_component(p, seen, loose);
    return count;
  }

 private:
  [[nodiscard]] bool is_line(std::uint32_t panel) const {
    return (section_.upright[panel] != 0) == lines_upright_;
  }
  [[nodiscard]] double place(std::uint32_t node) const { return section_.offset[node]; }

  /// The freedoms of the panels that hang together with `panel` and are not held.
  int free_in_component(std::uint32_t panel, std::vector<std::uint8_t>& seen,
                        std::vector<std::uint8_t>& loose) {
    members_.assign(1, panel);
    seen[panel] = 1;
    for (std::size_t k = 0; k < members_.size(); ++k)
      for (const std::uint32_t other : section_.folds[members_[k]]) {
        if (held_.is_held(other) || seen[other] != 0) continue;
        seen[other] = 1;
        members_.push_back(other);
      }
    column_.resize(section_.panels(), -1);
    int nodes = 0, slopes = 0;
    for (const std::uint32_t m : members_)
      if (!is_line(m)) column_[m] = nodes++;
    terms_.clear();
    equations_ = 0;
    for (const std::uint32_t m : members_)
      if (is_line(m)) slopes += add_equations(m);
    const int nodes_free = nodes - rank(nodes);
    for (const std::uint32_t m : members_)
      if (nodes_free > 0 || (is_line(m) && !has_two_places(m))) loose[m] = 1;
    return nodes_free + slopes;
  }

  [[nodiscard]] bool has_two_places(std::uint32_t line) const {
    const auto nodes = section_.folds[line];
    return std::any_of(nodes.begin(), nodes.end(),
                       [&](std::uint32_t node) { return place(node) != place(nodes.front()); });
  }

  /// The equations between the nodes of a line; returns how far they leave its function free.
  int add_equations(std::uint32_t line) {
    const auto nodes = section_.folds[line];
    if (nodes.empty()) return 2;
    const auto [low, high] =
        std::minmax_element(nodes.begin(), nodes.end(),
                            [&](std::uint32_t a, std::uint32_t b) { return place(a) < place(b); });
    const double begin = place(*low), length = place(*high) - begin;
    const bool is_point = !(length > 0.0);
    for (auto node = nodes.begin(); node != nodes.end(); ++node) {
      if (node == low || (!is_point && node == high)) continue;
      const double t = is_point ? 0.0 : (place(*node) - begin) / length;
      put(*node, 1.0);
      put(*low, t - 1.0);
      if (t != 0.0) put(*high, -t);
      ++equations_;
    }
    return is_point ? 1 : 0;
  }
  void put(std::uint32_t node, double amount) {
    if (!held_.is_held(node)) terms_.emplace_back(equations_, column_[node], amount);
  }

  [[nodiscard]] int rank(int columns) const {
    constexpr double kThreshold = 1e-10;  // of interpolation weights, which are of the size of 1
    constexpr int kDenseColumns = 400;
    if (terms_.empty() || columns == 0) return 0;
    Eigen::SparseMatrix<double> sparse(equations_, columns);
    sparse.setFromTriplets(terms_.begin(), terms_.end());
    if (columns <= kDenseColumns) {
      Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(sparse.rows(), sparse.cols());
      qr.setThreshold(kThreshold);
      return static_cast<int>(qr.compute(Eigen::MatrixXd(sparse)).rank());
    }
    sparse.makeCompressed();
    Eigen::SparseQR<Eigen::SparseMatrix<double>, Eigen::COLAMDOrdering<int>> qr;
    qr.setPivotThreshold(kThreshold);
    qr.compute(sparse);
    return static_cast<int>(qr.rank());
  }

  const Section& section_;
  bool lines_upright_;
  Propagation held_;  ///< panels that follow the common motion
  // Of the component at hand:
  std::vector<std::uint32_t> members_;
  std::vector<int> column_;  ///< of each node
  std::vector<Eigen::Triplet<double>> terms_;
  int equations_{0};
};

int count_pieces(const Section& section) {
  DisjointSets sets(section.panels());
  int pieces = static_cast<int>(section.panels());
  for (std::uint32_t p = 0; p < section.panels(); ++p)
    for (const std::uint32_t other : section.folds[p]) pieces -= sets.join(p, other) ? 1 : 0;
  return pieces;
}

}  // namespace

Mobility mobility(const Section& section) {
  Mobility out;
  out.loose.assign(section.panels(), 0);
  out.pieces = count_pieces(section);
  AffineSystem by_height(section, true), by_offset(section, false);
  out.degrees_of_freedom = by_height.solutions(out.loose) + by_offset.solutions(out.loose) - 3;
  return out;
}

void Propagation::hold(std::uint32_t line) {
  work_.push_back(line);
  while (!work_.empty()) {
    const std::uint32_t next = work_.back();
    work_.pop_back();
    if (held_[next] != 0) continue;
    held_[next] = 1;
    for (const std::uint32_t node : section_.folds[next]) {
      if (held_[node] != 0) continue;
      held_[node] = 1;
      for (const std::uint32_t other : section_.folds[node]) reach(other, node);
    }
  }
}

/// A node of a line has become held.
void Propagation::reach(std::uint32_t line, std::uint32_t node) {
  if (held_[line] != 0) return;
  const double place = section_.offset[node];
  Ends& ends = ends_[line];
  if (ends.low > ends.high) {
    ends = {place, place};
    with_one_node_.push_back(line);
    return;
  }
  ends = {std::min(ends.low, place), std::max(ends.high, place)};
  const double apart = section_.apart.empty() ? 0.0 : section_.apart[line];
  if (ends.high > ends.low && ends.high - ends.low >= apart) work_.push_back(line);
}

int Propagation::pin(std::uint32_t line) {
  int pins = 0;
  while (!with_one_node_.empty()) {
    const std::uint32_t next = with_one_node_.back();
    with_one_node_.pop_back();
    if (held_[next] != 0) continue;
    ++pins;
    hold(next);
  }
  if (held_[line] != 0) return pins;
  hold(line);
  return pins + 2;
}

}  // namespace popcut::rigid
