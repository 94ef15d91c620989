// SPDX-License-Identifier: MIT
#include "core/design/mobility.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Dense>

namespace popcut {
namespace {

/// A linear combination of parameters, sorted by index.
using Combination = std::vector<std::pair<int, double>>;

Combination blend(double a, const Combination& p, double b, const Combination& q) {
  Combination out;
  std::size_t i = 0, j = 0;
  const auto keep = [&](int index, double value) {
    if (std::abs(value) > 1e-11) out.emplace_back(index, value);
  };
  while (i < p.size() || j < q.size()) {
    if (j == q.size() || (i < p.size() && p[i].first < q[j].first)) {
      keep(p[i].first, a * p[i].second), ++i;
    } else if (i == p.size() || q[j].first < p[i].first) {
      keep(q[j].first, b * q[j].second), ++j;
    } else {
      keep(p[i].first, a * p[i].second + b * q[j].second), ++i, ++j;
    }
  }
  return out;
}

/// One of the two systems: `line` faces carry an affine function, `node` faces one number each.
class AffineSystem {
 public:
  AffineSystem(const BuiltPattern& built, bool lines_upright) : faces_(built.upright.size()) {
    is_line_.resize(faces_);
    for (std::size_t f = 0; f < faces_; ++f) is_line_[f] = (built.upright[f] != 0) == lines_upright;
    first_.assign(faces_ + 1, 0);
    for (const Hinge& h : built.hinges)
      ++first_[static_cast<std::size_t>(h.from_face) + 1],
          ++first_[static_cast<std::size_t>(h.to_face) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    entries_.resize(first_.back());
    std::vector<std::uint32_t> fill(first_.begin(), first_.end() - 1);
    double size = 1.0;
    for (const Hinge& h : built.hinges) size = std::max({size, h.x, h.z});
    for (const Hinge& h : built.hinges) {
      const double place = (lines_upright ? h.z : h.x) / size;
      const auto a = static_cast<std::uint32_t>(h.from_face),
                 b = static_cast<std::uint32_t>(h.to_face);
      entries_[fill[a]++] = {b, place};
      entries_[fill[b]++] = {a, place};
    }
    known_.assign(faces_, 0);
    value_.resize(faces_);
    solved_.assign(faces_, 0);
  }

  /// Number of independent solutions; marks in `loose` the faces that can leave the common motion.
  ///
  /// The functions that are affine over the whole always solve the system. They are taken out by
  /// setting them to zero on the first face, so that a tight pattern is all exact zeros: nothing is
  /// extrapolated, and rounding cannot grow along the levels.
  int solutions(std::vector<std::uint8_t>& loose) {
    for (std::uint32_t f = 0; f < faces_; ++f)
      if (is_line_[f]) {
        give_line(f, 0.0, {}, {});
        break;
      }
    for (;;) {
      while (!work_.empty()) {
        const std::uint32_t f = work_.back();
        work_.pop_back();
        solve(f);
      }
      if (!set_parameter()) break;
    }
    int count = 2 + parameters_ - rank();
    for (std::uint32_t f = 0; f < faces_; ++f) {
      if (is_line_[f] && !solved_[f]) ++count, loose[f] = 1;
      if (!value_[f].empty()) loose[f] = 1;
    }
    return count;
  }

 private:
  struct Entry {
    std::uint32_t face{};
    double place{};
  };
  void learn(std::uint32_t node, Combination value) {
    known_[node] = 1;
    value_[node] = std::move(value);
    for (std::uint32_t e = first_[node]; e < first_[node + 1]; ++e)
      if (!solved_[entries_[e].face]) work_.push_back(entries_[e].face);
  }

  /// All nodes of line f get base + (place - origin) * slope.
  void give_line(std::uint32_t f, double origin, const Combination& base,
                 const Combination& slope) {
    solved_[f] = 1;
    for (std::uint32_t e = first_[f]; e < first_[f + 1]; ++e) {
      const auto [node, place] = entries_[e];
      Combination here = blend(1.0, base, place - origin, slope);
      if (!known_[node]) {
        learn(node, std::move(here));
      } else {
        Combination off = blend(1.0, here, -1.0, value_[node]);
        // What is small beside its terms is their rounding, not an equation.
        double largest = 0.0;
        for (const Combination* terms : {&here, &value_[node]})
          for (const auto& [index, amount] : *terms) largest = std::max(largest, std::abs(amount));
        std::erase_if(off,
                      [&](const auto& term) { return std::abs(term.second) < 1e-7 * largest; });
        if (!off.empty()) equations_.push_back(std::move(off));
      }
    }
  }

  /// Two known nodes at different places determine the line.
  void solve(std::uint32_t f) {
    if (solved_[f]) return;
    const Entry* low = nullptr;
    const Entry* high = nullptr;
    for (std::uint32_t e = first_[f]; e < first_[f + 1]; ++e) {
      const Entry& entry = entries_[e];
      if (!known_[entry.face]) continue;
      if (!low || entry.place < low->place) low = &entry;
      if (!high || entry.place > high->place) high = &entry;
    }
    if (!low || !(high->place > low->place)) return;
    const double span = high->place - low->place;
    const Combination base = value_[low->face];
    give_line(f, low->place, base, blend(1.0 / span, value_[high->face], -1.0 / span, base));
  }

  /// Sets a new parameter where nothing more follows; false when all nodes are known.
  bool set_parameter() {
    std::uint32_t island = static_cast<std::uint32_t>(faces_);
    for (std::uint32_t f = next_stalled_; f < faces_; ++f) {
      if (!is_line_[f] || solved_[f]) {
        if (f == next_stalled_) ++next_stalled_;
        continue;
      }
      const Entry* known = nullptr;
      bool open = false;
      for (std::uint32_t e = first_[f]; e < first_[f + 1]; ++e) {
        if (known_[entries_[e].face])
          known = &entries_[e];
        else
          open = true;
      }
      if (known && open) {
        const Combination base = value_[known->face];
        give_line(f, known->place, base, {{parameters_++, 1.0}});
        return true;
      }
      if (open && island == faces_) island = f;
    }
    if (island < faces_) {  // another piece moves as it likes
      give_line(island, 0.0, {{parameters_, 1.0}}, {{parameters_ + 1, 1.0}});
      parameters_ += 2;
      return true;
    }
    return false;
  }

  [[nodiscard]] int rank() const {
    if (equations_.empty()) return 0;
    Eigen::MatrixXd m =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(equations_.size()), parameters_);
    for (std::size_t r = 0; r < equations_.size(); ++r) {
      double most = 0.0;
      for (const auto& [index, amount] : equations_[r]) most = std::max(most, std::abs(amount));
      for (const auto& [index, amount] : equations_[r])
        m(static_cast<Eigen::Index>(r), index) = amount / most;
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(m);
    qr.setThreshold(1e-9);
    return static_cast<int>(qr.rank());
  }

  std::size_t faces_;
  std::vector<std::uint8_t> is_line_, known_, solved_;
  std::vector<std::uint32_t> first_;
  std::vector<Entry> entries_;
  std::vector<Combination> value_;
  std::vector<Combination> equations_;
  std::vector<std::uint32_t> work_;
  int parameters_{0};
  std::uint32_t next_stalled_{0};
};

int count_pieces(const BuiltPattern& built) {
  std::vector<std::uint32_t> parent(built.upright.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto find = [&](std::uint32_t a) {
    while (parent[a] != a) a = parent[a] = parent[parent[a]];
    return a;
  };
  int pieces = static_cast<int>(parent.size());
  for (const Hinge& h : built.hinges) {
    const std::uint32_t a = find(static_cast<std::uint32_t>(h.from_face));
    const std::uint32_t b = find(static_cast<std::uint32_t>(h.to_face));
    if (a != b) parent[a] = b, --pieces;
  }
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
