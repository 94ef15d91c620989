// SPDX-License-Identifier: MIT
#include "core/curvature/fold_lines.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace popcut {
namespace {

constexpr std::int32_t kNoLine = -1;

/// Which folds meet at a vertex: straight ones by role and side, and slanting valleys.
struct Joint {
  std::int32_t lower[2]{kNoLine,
                        kNoLine};  ///< valley, mountain that ends here, coming from lower v
  std::int32_t higher[2]{kNoLine, kNoLine};  ///< that begins here
  int slanting{};
  double slope{};  ///< |du/dv| of the slanting valleys, the steepest
};

class LineCollector {
 public:
  LineCollector(const FoldFrame& frame, double mm, double tolerance)
      : frame_(frame), mm_(mm), tolerance_(tolerance), joints_(frame.vertices.size()) {}

  std::vector<FoldLine> collect() {
    for (std::size_t e = 0; e < frame_.edges.size(); ++e) add_edge(e);
    chain();
    join_over_v_folds();
    return std::move(lines_);
  }

 private:
  struct Straight {
    std::uint32_t from{}, to{};  ///< vertices, from lower to higher v
    bool mountain{};
    bool has_before{};
  };

  [[nodiscard]] double u(std::uint32_t vertex) const { return frame_.vertices[vertex][0] * mm_; }
  [[nodiscard]] double v(std::uint32_t vertex) const { return frame_.vertices[vertex][1] * mm_; }

  void add_edge(std::size_t e) {
    const char role = frame_.assignments[e];
    if (role != 'M' && role != 'V' && role != 'B') return;
    auto [from, to] = frame_.edges[e];
    if (v(from) > v(to)) std::swap(from, to);
    const double du = std::abs(u(to) - u(from)), dv = v(to) - v(from);
    if (!(dv > tolerance_)) return;
    const bool mountain = role == 'M';
    if (role == 'B') {
      if (du <= tolerance_) lines_.push_back({u(from), v(from), v(to), false, true, std::nullopt});
      return;
    }
    if (du > tolerance_) {
      if (mountain) return;
      for (const std::uint32_t end : {from, to}) {
        ++joints_[end].slanting;
        joints_[end].slope = std::max(joints_[end].slope, du / dv);
      }
      return;
    }
    const auto id = static_cast<std::int32_t>(straight_.size());
    straight_.push_back({from, to, mountain, false});
    joints_[from].higher[mountain] = id;
    joints_[to].lower[mountain] = id;
  }

  /// Joins straight folds of one role that share a vertex.
  void chain() {
    for (Straight& s : straight_) s.has_before = joints_[s.from].lower[s.mountain] != kNoLine;
    for (const Straight& first : straight_) {
      if (first.has_before) continue;
      std::uint32_t end = first.to;
      while (joints_[end].higher[first.mountain] != kNoLine)
        end = straight_[static_cast<std::size_t>(joints_[end].higher[first.mountain])].to;
      lines_.push_back({u(first.from), v(first.from), v(end), first.mountain, false, std::nullopt});
      if (first.mountain) note_v_fold(first.from, end);
    }
  }

  /// A mountain from O to A is a V-fold's centre where a valley comes in at O from the other side,
  /// and two slanting valleys go out.
  void note_v_fold(std::uint32_t from, std::uint32_t to) {
    const auto apex_at = [&](const Joint& joint, std::int32_t crease) {
      return joint.slanting == 2 && crease != kNoLine;
    };
    const bool forward = apex_at(joints_[from], joints_[from].lower[0]);
    const bool backward = apex_at(joints_[to], joints_[to].higher[0]);
    if (forward == backward) return;
    const std::uint32_t apex = forward ? from : to;
    const CreaseVFold fold{v(apex), v(to) - v(from), joints_[apex].slope, forward ? 1.0 : -1.0};
    lines_.back().v_fold = fold;
  }

  /// crease - V-fold - crease becomes one valley with the V-fold on it.
  void join_over_v_folds() {
    std::sort(lines_.begin(), lines_.end(), [](const FoldLine& a, const FoldLine& b) {
      return a.u != b.u ? a.u < b.u : a.v0 < b.v0;
    });
    std::vector<bool> gone(lines_.size(), false);
    for (std::size_t m = 0; m < lines_.size(); ++m) {
      if (!lines_[m].mountain || !lines_[m].v_fold) continue;
      const FoldLine centre = lines_[m];
      const auto before = valley_at(centre.u, centre.v0, m, &FoldLine::v1);
      const auto after = valley_at(centre.u, centre.v1, m, &FoldLine::v0);
      if (before) gone[*before] = true;
      if (after) gone[*after] = true;
      lines_[m] = {centre.u,
                   before ? lines_[*before].v0 : centre.v0,
                   after ? lines_[*after].v1 : centre.v1,
                   false,
                   false,
                   centre.v_fold};
    }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < lines_.size(); ++k) {
      if (!gone[k]) lines_[kept++] = lines_[k];
    }
    lines_.resize(kept);
  }

  /// The valley near line `m` whose end (`v0` or `v1`) is at (u, v).
  [[nodiscard]] std::optional<std::size_t> valley_at(double at_u, double at_v, std::size_t m,
                                                     double FoldLine::*end) const {
    const auto fits = [&](std::size_t k) {
      return !lines_[k].mountain && !lines_[k].border &&
             std::abs(lines_[k].*end - at_v) <= tolerance_;
    };
    for (std::size_t k = m; k-- > 0 && at_u - lines_[k].u <= tolerance_;) {
      if (fits(k)) return k;
    }
    for (std::size_t k = m + 1; k < lines_.size() && lines_[k].u - at_u <= tolerance_; ++k) {
      if (fits(k)) return k;
    }
    return std::nullopt;
  }

  const FoldFrame& frame_;
  double mm_, tolerance_;
  std::vector<Joint> joints_;
  std::vector<Straight> straight_;
  std::vector<FoldLine> lines_;
};

}  // namespace

std::vector<FoldLine> fold_lines(const FoldFrame& frame, double mm_a_unit, double tolerance_mm) {
  return LineCollector(frame, mm_a_unit, tolerance_mm).collect();
}

}  // namespace popcut
