// SPDX-License-Identifier: MIT
#include "core/drawing/near_lines.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/drawing/collinear.hpp"
#include "core/geometry/cell_walk.hpp"
#include "core/geometry/line_bins.hpp"

namespace popcut {
namespace {

constexpr double kStepMm = 0.25;
constexpr double kMostSteps = 1e6;
constexpr double kMostCells = 1e6;    // that all lines pass
constexpr double kAlongside = 0.966;  // cosine of 15 degrees
constexpr double kLeastRun = 5.0;     // times the distance
constexpr double kStub = 2.0;         // times the distance: what is left between is left out too

/// A short straight part of a line.
struct Step {
  PagePoint a, b;
  double at_mm{};          ///< its middle along the line
  std::uint32_t corner{};  ///< the line's point at or before `a`
  bool crowded{};
};

/// A straight part of a line that stays.
struct KeptPart {
  PagePoint a, b;
  double at_mm{};  ///< where `a` is along the line
  std::uint32_t line{};
};

/// Parts that stay, by the cells of the page near which they pass.
class Kept {
 public:
  Kept(double within, double cell_mm, double all_mm)
      : within_(within),
        cell_mm_(cell_mm),
        head_(std::bit_ceil(static_cast<std::size_t>(all_mm / cell_mm) + 16), -1) {}

  void add(const KeptPart& part) {
    const auto own = static_cast<std::uint32_t>(parts_.size());
    parts_.push_back(part);
    // A point beside a slope is up to 1.42 times as far from it along an axis.
    walk_cells({part.a, part.b}, cell_mm_, 1.5 * within_, [&](std::int64_t x, std::int64_t y) {
      std::int32_t& head = head_[slot(x, y)];
      entries_.push_back({own, head});
      head = static_cast<std::int32_t>(entries_.size()) - 1;
      return true;
    });
  }

  struct Near {
    PagePoint at;
    double mm{};
    std::uint32_t line{};
    bool is_turn{};  ///< the line itself, which turns back near here
  };
  /// The nearest place within reach of the middle of `step`. Of the line's own parts, those nearer
  /// than `guard_mm` along it count only if the line has turned back; `all_mm`: length of a closed
  /// line, else 0.
  [[nodiscard]] std::optional<Near> beside(const Step& step, std::uint32_t line, double guard_mm,
                                           double all_mm) const {
    const PagePoint middle = between(step.a, step.b, 0.5);
    std::optional<Near> best;
    for (std::int32_t e = head_[slot(cell_of(middle.x), cell_of(middle.y))]; e >= 0;
         e = entries_[static_cast<std::size_t>(e)].next) {
      const KeptPart& part = parts_[entries_[static_cast<std::size_t>(e)].part];
      const double along = cosine_squared(part, step);
      if (std::abs(along) < kAlongside * kAlongside) continue;
      Near near = nearest(part, middle);
      if (near.mm > (best ? best->mm : within_)) continue;
      if (part.line == line) {
        const double way = std::abs(part.at_mm + distance(part.a, near.at) - step.at_mm);
        near.is_turn = std::min(way, all_mm > 0.0 ? all_mm - way : way) <= guard_mm;
      }
      if (near.is_turn && along > 0.0) continue;
      near.line = part.line;
      best = near;
    }
    return best;
  }

 private:
  struct Entry {
    std::uint32_t part{};
    std::int32_t next{};  ///< of the same slot; -1: none
  };

  /// The square of the cosine of the angle between them, with the sign of the cosine.
  static double cosine_squared(const KeptPart& s, const Step& t) {
    const double sx = s.b.x - s.a.x, sy = s.b.y - s.a.y, tx = t.b.x - t.a.x, ty = t.b.y - t.a.y;
    const double dot = sx * tx + sy * ty;
    return dot * std::abs(dot) / ((sx * sx + sy * sy) * (tx * tx + ty * ty));
  }
  static Near nearest(const KeptPart& s, const PagePoint& p) {
    const double dx = s.b.x - s.a.x, dy = s.b.y - s.a.y, square = dx * dx + dy * dy;
    const double t = square > 0.0 ? ((p.x - s.a.x) * dx + (p.y - s.a.y) * dy) / square : 0.0;
    const PagePoint at = between(s.a, s.b, t);
    return {at, distance(at, p), 0, false};
  }
  [[nodiscard]] std::int64_t cell_of(double at) const {
    return static_cast<std::int64_t>(std::floor(at / cell_mm_));
  }
  [[nodiscard]] std::size_t slot(std::int64_t x, std::int64_t y) const {
    return mixed(static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL ^
                 static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FULL) &
           (head_.size() - 1);
  }

  double within_, cell_mm_;
  std::vector<std::int32_t> head_;
  std::vector<Entry> entries_;
  std::vector<KeptPart> parts_;
};

class OnePass {
 public:
  OnePass(const LineWork& work, double within) : work_(work), within_(within) {}

  /// Finds what runs beside other lines.
  const DoubledLines& measure() {
    if (!find_crowded()) return out_;
    Kept kept(within_, std::max(4.0 * within_, all_mm_ / kMostCells), all_mm_);
    for (const std::uint32_t i : order_) take(i, kept);
    return out_;
  }

  /// The drawing without it, once it is measured.
  [[nodiscard]] LineWork left() const {
    LineWork out = work_.without_lines();
    out.warnings.clear();
    std::vector<std::uint32_t> first(work_.lines.size(), kUnchanged);
    for (std::uint32_t c = 0; c < changed_.size(); ++c) first[changed_[c].line] = c;
    for (std::uint32_t i = 0; i < work_.lines.size(); ++i) {
      const DrawnLine& line = work_.lines[i];
      if (first[i] == kUnchanged) {
        out.append(line.operation, work_.points_of(line));
        continue;
      }
      const Changed& changed = changed_[first[i]];
      for (const DrawnLine& part : std::span(rest_.lines).subspan(changed.first, changed.parts))
        out.append(line.operation, rest_.points_of(part));
    }
    return out;
  }

 private:
  static constexpr std::uint32_t kUnchanged = ~std::uint32_t{0};
  /// A line of which something does not stay, and the parts of `rest_` that do.
  struct Changed {
    std::uint32_t line{}, first{}, parts{};
  };

  /// Finds the lines with edges that may run beside others, the strongest and longest first.
  bool find_crowded() {
    std::vector<NodeEdge> edges;
    std::vector<std::uint32_t> lines;
    for (std::uint32_t i = 0; i < work_.lines.size(); ++i) {
      const DrawnLine& line = work_.lines[i];
      if (line.operation == Operation::Draw) continue;
      for (std::uint32_t k = 1; k < line.count; ++k) {
        edges.push_back({line.first + k - 1, line.first + k});
        lines.push_back(i);
      }
    }
    const auto crowded = crowded_edges(edges, work_.points, within_);
    crowded_.assign(work_.points.size(), 0);
    for (std::size_t e = 0; e < edges.size(); ++e)
      if (crowded[e] != 0) {
        crowded_[edges[e].a] = 1;
        if (order_.empty() || order_.back() != lines[e]) order_.push_back(lines[e]);
      }
    if (order_.empty()) return false;
    std::vector<double> mm(work_.lines.size(), 0.0);
    for (const std::uint32_t i : order_) {
      mm[i] = length(work_.points_of(work_.lines[i]));
      all_mm_ += mm[i];
    }
    step_mm_ = std::max(kStepMm, all_mm_ / kMostSteps);
    std::stable_sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
      const int sa = strength(work_.lines[a].operation), sb = strength(work_.lines[b].operation);
      return sa != sb ? sa > sb : mm[a] > mm[b];
    });
    return true;
  }

  void split(const DrawnLine& line) {
    steps_.clear();
    double way = 0.0;
    const auto points = work_.points_of(line);
    for (std::uint32_t k = 0; k + 1 < points.size(); ++k) {
      const double l = distance(points[k], points[k + 1]);
      if (!(l > 0.0)) continue;
      const bool crowded = crowded_[line.first + k] != 0;
      const double count = crowded ? std::max(1.0, std::ceil(l / step_mm_)) : 1.0;
      for (double n = 0; n < count; ++n)
        steps_.push_back({between(points[k], points[k + 1], n / count),
                          between(points[k], points[k + 1], (n + 1) / count),
                          way + (n + 0.5) * l / count, k, crowded});
      way += l;
    }
    line_mm_ = way;
  }

  /// Adds the steps of a line from one on, of which `count` stay, to what is kept: those of one
  /// edge as one part.
  void keep(std::uint32_t i, std::size_t from, std::size_t count, Kept& kept) const {
    const std::size_t n = steps_.size();
    for (std::size_t k = from; k < from + count;) {
      const Step& first = steps_[k % n];
      std::size_t last = k;
      while (last + 1 < from + count && (last + 1) % n != 0 &&
             steps_[(last + 1) % n].corner == first.corner)
        ++last;
      kept.add({first.a, steps_[last % n].b, first.at_mm - 0.5 * distance(first.a, first.b), i});
      k = last + 1;
    }
  }

  /// Decides what of a line stays.
  void take(std::uint32_t i, Kept& kept) {
    const DrawnLine& line = work_.lines[i];
    split(line);
    const std::size_t n = steps_.size();
    const bool ring = closed(work_.points_of(line));
    beside_.assign(n, std::nullopt);
    std::vector<std::uint8_t> stays(n, 1);
    for (std::size_t k = 0; k < n;) {
      // A straight edge does not run beside itself: it is kept at its end.
      std::size_t from = k;
      for (const std::uint32_t corner = steps_[k].corner; k < n && steps_[k].corner == corner;
           ++k) {
        if (steps_[k].crowded)
          beside_[k] = kept.beside(steps_[k], i, 3.0 * within_ + step_mm_, ring ? line_mm_ : 0.0);
        if (!beside_[k]) continue;
        stays[k] = 0;
        keep(i, from, k - from, kept);
        from = k + 1;
      }
      keep(i, from, k - from, kept);
    }
    // Short runs stay. What little is left between long ones goes.
    each_run(stays, ring, [&](std::size_t from, std::size_t count, bool stay, double mm) {
      if (stay || count == n || mm >= kLeastRun * within_) return;
      for (std::size_t k = from; k < from + count; ++k) stays[k % n] = 1;
      keep(i, from, count, kept);
    });
    if (std::all_of(stays.begin(), stays.end(), [](std::uint8_t one) { return one != 0; })) return;
    each_run(stays, ring, [&](std::size_t from, std::size_t count, bool stay, double mm) {
      if (stay && mm <= kStub * within_)
        for (std::size_t k = from; k < from + count; ++k) stays[k % n] = 0;
    });
    for (std::size_t k = 0; k < n; ++k) {
      if (stays[k] != 0) continue;
      const double mm = distance(steps_[k].a, steps_[k].b);
      out_.doubled_mm += mm;
      const bool cut = beside_[k] && is_cut(work_.lines[beside_[k]->line].operation);
      if (cut && is_fold(line.operation)) out_.cut_folds_mm += mm;
      if (beside_[k]) out_.apart_mm = std::max(out_.apart_mm, beside_[k]->mm);
    }
    Changed changed{i, static_cast<std::uint32_t>(rest_.lines.size()), 0};
    each_run(stays, ring, [&](std::size_t from, std::size_t count, bool stay, double) {
      if (stay) add_run(line, from, count, ring);
    });
    changed.parts = static_cast<std::uint32_t>(rest_.lines.size()) - changed.first;
    changed_.push_back(changed);
  }

  /// Calls `visit(first step, steps, whether they stay, mm)` for each run; of a closed line one run
  /// may go through its seam.
  template <typename Visit>
  void each_run(const std::vector<std::uint8_t>& stays, bool ring, Visit visit) const {
    const std::size_t n = stays.size();
    const std::vector<std::uint8_t> as_they_are = stays;
    std::size_t begin = 0;
    if (ring)
      while (begin < n && as_they_are[begin] == as_they_are[n - 1]) ++begin;
    if (begin == n) begin = 0;
    for (std::size_t k = begin; k < begin + n;) {
      std::size_t end = k;
      double mm = 0.0;
      while (end < begin + n && as_they_are[end % n] == as_they_are[k % n]) {
        mm += distance(steps_[end % n].a, steps_[end % n].b);
        ++end;
      }
      visit(k, end - k, as_they_are[k % n] != 0, mm);
      k = end;
    }
  }

  void add_run(const DrawnLine& line, std::size_t from, std::size_t count, bool ring) {
    const std::size_t n = steps_.size();
    std::vector<PagePoint> run;
    // Led to the line beside which it came, so that no bridge of paper stays between.
    const auto lead = [&](std::size_t k) {
      if (beside_[k] && !beside_[k]->is_turn) run.push_back(beside_[k]->at);
    };
    if (ring || from > 0) lead((from + n - 1) % n);
    for (std::size_t k = from; k < from + count; ++k) {
      const Step& step = steps_[k % n];
      const bool begins = k == from || steps_[(k + n - 1) % n].corner != step.corner;
      const bool ends = k + 1 == from + count || steps_[(k + 1) % n].corner != step.corner;
      if (begins && (run.empty() || run.back() != step.a)) run.push_back(step.a);
      if (ends) run.push_back(step.b);
    }
    if (ring || from + count < n) lead((from + count) % n);
    rest_.append(line.operation, run);
  }

  const LineWork& work_;
  double within_;
  double step_mm_{kStepMm};
  double all_mm_{};                    ///< of all lines that may run beside others
  double line_mm_{};                   ///< of the line that is taken
  std::vector<std::uint8_t> crowded_;  ///< by the edge's first point
  std::vector<std::uint32_t> order_;
  std::vector<Step> steps_;  ///< of the line that is taken
  std::vector<std::optional<Kept::Near>> beside_;
  std::vector<Changed> changed_;
  LineWork rest_;  ///< of changed lines
  DoubledLines out_;
};

}  // namespace

DoubledLines doubled_lines(const LineWork& work, double within_mm) {
  return OnePass(work, within_mm).measure();
}

SinglePass in_one_pass(const LineWork& work, double within_mm) {
  OnePass pass(work, within_mm);
  const DoubledLines doubled = pass.measure();
  return {doubled, pass.left()};
}

}  // namespace popcut
