// SPDX-License-Identifier: MIT
#include "core/design/strips/mobility.hpp"

#include <algorithm>
#include <span>

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include "core/geometry/buckets.hpp"
#include "core/geometry/disjoint_sets.hpp"

namespace popcut {
namespace {

/// One of the two systems: `line` faces carry an affine function, `node` faces one number each.
///
/// The functions that are affine over the whole always solve it. They are taken out by setting them
/// to zero on the first line; what follows from that by propagation is exactly zero, so that a
/// tight pattern needs no arithmetic at all. What is left over falls into components, loose ends
/// mostly. In each the numbers of the nodes are the unknowns, and every line with more than two
/// nodes says that those between its outermost two are interpolated: coefficients from 0 to 1, so
/// that nothing is extrapolated and rounding cannot grow along a chain.
class AffineSystem {
 public:
  AffineSystem(const BuiltPattern& built, bool lines_upright) : faces_(built.upright.size()) {
    is_line_.resize(faces_);
    for (std::size_t f = 0; f < faces_; ++f) is_line_[f] = (built.upright[f] != 0) == lines_upright;
    around_ = Buckets<Entry>(faces_, [&](auto&& put) {
      for (const Hinge& h : built.hinges) {
        const double place = lines_upright ? h.z : h.x;
        const auto a = static_cast<std::uint32_t>(h.from_face);
        const auto b = static_cast<std::uint32_t>(h.to_face);
        put(a, {b, place});
        put(b, {a, place});
      }
    });
    held_.assign(faces_, 0);
  }

  /// Number of independent solutions; marks in `loose` the faces that can leave the common motion.
  int solutions(std::vector<std::uint8_t>& loose) {
    const auto line = std::find(is_line_.begin(), is_line_.end(), std::uint8_t{1});
    if (line != is_line_.end()) hold(static_cast<std::uint32_t>(line - is_line_.begin()));
    while (!work_.empty()) {
      const std::uint32_t f = work_.back();
      work_.pop_back();
      if (!held_[f] && is_determined(f)) hold(f);
    }
    int count = 2;
    std::vector<std::uint8_t> seen(faces_, 0);
    for (std::uint32_t f = 0; f < faces_; ++f)
      if (!held_[f] && !seen[f]) count += free_in_component(f, seen, loose);
    return count;
  }

 private:
  struct Entry {
    std::uint32_t face{};
    double place{};
  };
  [[nodiscard]] std::span<const Entry> around(std::uint32_t f) const { return around_[f]; }

  /// The line f is zero, and so are its nodes; the lines at them may follow.
  void hold(std::uint32_t f) {
    held_[f] = 1;
    for (const Entry& entry : around(f)) {
      if (held_[entry.face]) continue;
      held_[entry.face] = 1;
      for (const Entry& next : around(entry.face))
        if (!held_[next.face]) work_.push_back(next.face);
    }
  }

  /// Two held nodes at different places determine a line.
  [[nodiscard]] bool is_determined(std::uint32_t f) const {
    const Entry* one = nullptr;
    for (const Entry& entry : around(f)) {
      if (!held_[entry.face]) continue;
      if (one && one->place != entry.place) return true;
      one = &entry;
    }
    return false;
  }

  /// The freedoms of the faces that hang together with f and are not held.
  int free_in_component(std::uint32_t f, std::vector<std::uint8_t>& seen,
                        std::vector<std::uint8_t>& loose) {
    members_.assign(1, f);
    seen[f] = 1;
    for (std::size_t k = 0; k < members_.size(); ++k)
      for (const Entry& entry : around(members_[k])) {
        if (held_[entry.face] || seen[entry.face]) continue;
        seen[entry.face] = 1;
        members_.push_back(entry.face);
      }
    column_.resize(faces_, -1);
    int nodes = 0, slopes = 0;
    for (const std::uint32_t m : members_)
      if (!is_line_[m]) column_[m] = nodes++;
    terms_.clear();
    equations_ = 0;
    for (const std::uint32_t m : members_)
      if (is_line_[m]) slopes += add_equations(m);
    const int nodes_free = nodes - rank(nodes);
    for (const std::uint32_t m : members_)
      if (nodes_free > 0 || (is_line_[m] && !has_two_places(m))) loose[m] = 1;
    return nodes_free + slopes;
  }

  [[nodiscard]] bool has_two_places(std::uint32_t line) const {
    for (const Entry& entry : around(line))
      if (entry.place != around(line).front().place) return true;
    return false;
  }

  /// The equations between the nodes of a line; returns how far they leave its function free.
  int add_equations(std::uint32_t line) {
    const auto entries = around(line);
    if (entries.empty()) return 2;
    const auto by_place = [](const Entry& a, const Entry& b) { return a.place < b.place; };
    const auto [low, high] = std::minmax_element(entries.begin(), entries.end(), by_place);
    const bool is_point = !(high->place > low->place);
    for (const Entry& entry : entries) {
      if (&entry == &*low || (!is_point && &entry == &*high)) continue;
      const double t = is_point ? 0.0 : (entry.place - low->place) / (high->place - low->place);
      put(entry.face, 1.0);
      put(low->face, t - 1.0);
      if (t != 0.0) put(high->face, -t);
      ++equations_;
    }
    return is_point ? 1 : 0;
  }
  void put(std::uint32_t node, double amount) {
    if (!held_[node]) terms_.emplace_back(equations_, column_[node], amount);
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

  std::size_t faces_;
  std::vector<std::uint8_t> is_line_;
  std::vector<std::uint8_t> held_;  ///< faces that follow the common motion
  Buckets<Entry> around_;
  std::vector<std::uint32_t> work_;
  // Of the component at hand:
  std::vector<std::uint32_t> members_;
  std::vector<int> column_;  ///< of each node
  std::vector<Eigen::Triplet<double>> terms_;
  int equations_{0};
};

int count_pieces(const BuiltPattern& built) {
  DisjointSets faces(built.upright.size());
  int pieces = static_cast<int>(built.upright.size());
  for (const Hinge& h : built.hinges)
    if (faces.join(static_cast<std::uint32_t>(h.from_face), static_cast<std::uint32_t>(h.to_face)))
      --pieces;
  return pieces;
}

}  // namespace

Mobility mobility(const BuiltPattern& built) {
  Mobility out;
  out.loose.assign(built.upright.size(), 0);
  out.pieces = count_pieces(built);
  AffineSystem by_height(built, true), by_offset(built, false);
  out.degrees_of_freedom = by_height.solutions(out.loose) + by_offset.solutions(out.loose) - 3;
  return out;
}

}  // namespace popcut
