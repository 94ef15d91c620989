// SPDX-License-Identifier: MIT
#include "core/drawing/near_lines.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/drawing/collinear.hpp"
#include "core/geometry/line_bins.hpp"

namespace popcut {
namespace {

constexpr double kStepMm = 0.25;
constexpr double kMostSteps = 1e6;
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

/// Steps that stay, by their places.
class Kept {
 public:
  Kept(double cell_mm, std::size_t expected)
      : cell_mm_(cell_mm), head_(std::bit_ceil(2 * expected + 16), -1) {}

  void add(const Step& step, std::uint32_t line) {
    const auto [x, y] = cell_of(between(step.a, step.b, 0.5));
    std::int32_t& head = head_[slot(x, y)];
    next_.push_back(head);
    head = static_cast<std::int32_t>(items_.size());
    items_.push_back({step, line});
  }

  struct Near {
    PagePoint at;
    double mm{};
    std::uint32_t line{};
    bool is_turn{};  ///< the line itself, which turns back near here
  };
  /// The nearest place within `within` mm of the middle of `step`. Of the line's own steps, those
  /// nearer than `guard_mm` along it count only if the line has turned back; `all_mm`: length of a
  /// closed line, else 0.
  [[nodiscard]] std::optional<Near> beside(const Step& step, std::uint32_t line, double within,
                                           double guard_mm, double all_mm) const {
    const PagePoint middle = between(step.a, step.b, 0.5);
    const auto [cx, cy] = cell_of(middle);
    std::optional<Near> best;
    for (std::int64_t x = cx - 1; x <= cx + 1; ++x)
      for (std::int64_t y = cy - 1; y <= cy + 1; ++y)
        for (std::int32_t i = head_[slot(x, y)]; i >= 0; i = next_[static_cast<std::size_t>(i)]) {
          const Item& item = items_[static_cast<std::size_t>(i)];
          bool is_turn = false;
          if (item.line == line) {
            const double way = std::abs(item.step.at_mm - step.at_mm);
            is_turn = std::min(way, all_mm > 0.0 ? all_mm - way : way) <= guard_mm;
          }
          const double along = cosine(item.step, step);
          if ((is_turn ? -along : std::abs(along)) < kAlongside) continue;
          Near near = nearest(item.step, middle);
          near.line = item.line;
          near.is_turn = is_turn;
          if (near.mm <= (best ? best->mm : within)) best = near;
        }
    return best;
  }

 private:
  struct Item {
    Step step;
    std::uint32_t line{};
  };

  /// The cosine of the angle between them.
  static double cosine(const Step& s, const Step& t) {
    const double sx = s.b.x - s.a.x, sy = s.b.y - s.a.y, tx = t.b.x - t.a.x, ty = t.b.y - t.a.y;
    return (sx * tx + sy * ty) / (std::hypot(sx, sy) * std::hypot(tx, ty));
  }
  static Near nearest(const Step& s, const PagePoint& p) {
    const double dx = s.b.x - s.a.x, dy = s.b.y - s.a.y, square = dx * dx + dy * dy;
    const double t = square > 0.0 ? ((p.x - s.a.x) * dx + (p.y - s.a.y) * dy) / square : 0.0;
    const PagePoint at = between(s.a, s.b, t);
    return {at, distance(at, p), 0, false};
  }
  [[nodiscard]] std::array<std::int64_t, 2> cell_of(const PagePoint& p) const {
    return {static_cast<std::int64_t>(std::floor(p.x / cell_mm_)),
            static_cast<std::int64_t>(std::floor(p.y / cell_mm_))};
  }
  [[nodiscard]] std::size_t slot(std::int64_t x, std::int64_t y) const {
    return mixed(static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL ^
                 static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FULL) &
           (head_.size() - 1);
  }

  double cell_mm_;
  std::vector<std::int32_t> head_, next_;
  std::vector<Item> items_;
};

class OnePass {
 public:
  OnePass(const LineWork& work, double within) : work_(work), within_(within) {}

  SinglePass run() {
    if (!find_crowded()) {
      out_.once = work_;
      out_.once.warnings.clear();
      return std::move(out_);
    }
    Kept kept(within_ + step_mm_, steps_expected_);
    std::vector<std::uint8_t> changed(work_.lines.size(), 0);
    std::vector<LineWork> parts(work_.lines.size());
    for (const std::uint32_t i : order_) changed[i] = take(i, kept, parts[i]) ? 1 : 0;
    out_.once = work_.without_lines();
    out_.once.warnings.clear();
    for (std::uint32_t i = 0; i < work_.lines.size(); ++i) {
      const DrawnLine& line = work_.lines[i];
      if (changed[i] == 0) out_.once.append(line.operation, work_.points_of(line));
      for (const DrawnLine& part : parts[i].lines)
        out_.once.append(line.operation, parts[i].points_of(part));
    }
    return std::move(out_);
  }

 private:
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
    double all = 0.0;
    std::vector<double> mm(work_.lines.size(), 0.0);
    std::size_t points = 0;
    for (const std::uint32_t i : order_) {
      mm[i] = length(work_.points_of(work_.lines[i]));
      all += mm[i];
      points += work_.lines[i].count;
    }
    step_mm_ = std::max(kStepMm, all / kMostSteps);
    steps_expected_ = static_cast<std::size_t>(all / step_mm_) + points;
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
      const double count = std::max(1.0, std::ceil(l / step_mm_));
      const bool crowded = crowded_[line.first + k] != 0;
      for (double n = 0; n < count; ++n)
        steps_.push_back({between(points[k], points[k + 1], n / count),
                          between(points[k], points[k + 1], (n + 1) / count),
                          way + (n + 0.5) * l / count, k, crowded});
      way += l;
    }
    all_mm_ = way;
  }

  /// Decides what of a line stays. Returns whether anything does not; then `left` has the rest.
  bool take(std::uint32_t i, Kept& kept, LineWork& left) {
    const DrawnLine& line = work_.lines[i];
    split(line);
    const std::size_t n = steps_.size();
    const bool ring = closed(work_.points_of(line));
    beside_.assign(n, std::nullopt);
    std::vector<std::uint8_t> stays(n, 1);
    for (std::size_t k = 0; k < n; ++k) {
      if (steps_[k].crowded)
        beside_[k] =
            kept.beside(steps_[k], i, within_, 3.0 * within_ + step_mm_, ring ? all_mm_ : 0.0);
      if (beside_[k])
        stays[k] = 0;
      else
        kept.add(steps_[k], i);
    }
    // Short runs stay. What little is left between long ones goes.
    each_run(stays, ring, [&](std::size_t from, std::size_t count, bool stay, double mm) {
      if (stay || count == n || mm >= kLeastRun * within_) return;
      for (std::size_t k = from; k < from + count; ++k) {
        stays[k % n] = 1;
        kept.add(steps_[k % n], i);
      }
    });
    if (std::all_of(stays.begin(), stays.end(), [](std::uint8_t one) { return one != 0; }))
      return false;
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
    each_run(stays, ring, [&](std::size_t from, std::size_t count, bool stay, double) {
      if (stay) add_run(line, from, count, ring, left);
    });
    return true;
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

  void add_run(const DrawnLine& line, std::size_t from, std::size_t count, bool ring,
               LineWork& left) const {
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
    left.append(line.operation, run);
  }

  const LineWork& work_;
  double within_;
  double step_mm_{kStepMm}, all_mm_{};
  std::size_t steps_expected_{};
  std::vector<std::uint8_t> crowded_;  ///< by the edge's first point
  std::vector<std::uint32_t> order_;
  std::vector<Step> steps_;  ///< of the line that is taken
  std::vector<std::optional<Kept::Near>> beside_;
  SinglePass out_;
};

}  // namespace

SinglePass in_one_pass(const LineWork& work, double within_mm) {
  return OnePass(work, within_mm).run();
}

}  // namespace popcut
