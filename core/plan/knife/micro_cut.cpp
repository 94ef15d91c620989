// SPDX-License-Identifier: MIT
#include "core/plan/knife/micro_cut.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <tuple>

#include <fmt/format.h>

#include "core/geometry/segment_grid.hpp"

namespace popcut {
namespace {

constexpr double kTouch = 0.05;    // mm; a fold and a cut this near meet
constexpr double kSteepest = 0.5;  // sine; at smaller angles the clearance stops growing
constexpr double kCorner = 0.98;   // cosine; sharper turns of a fold get clearance
constexpr double kSlack = 1e-9;
constexpr std::size_t kManyCuts = 1000;  // from here on a finer grid is worth its cost
constexpr std::size_t kFewCuts = 4;      // cuts of a cell that are looked at first

struct CutPiece {
  Segment segment;
  bool ends_at_a{}, ends_at_b{};  ///< whether a, b is an end of the whole stroke
};

std::vector<CutPiece> cut_pieces(const LineWork& work) {
  std::vector<CutPiece> pieces;
  for (const DrawnLine& line : work.lines) {
    if (!is_cut(line.operation)) continue;
    const auto points = work.points_of(line);
    const bool open = !closed(points);
    for (std::size_t i = 1; i < points.size(); ++i)
      if (points[i - 1] != points[i])
        pieces.push_back(
            {{points[i - 1], points[i]}, open && i == 1, open && i + 1 == points.size()});
  }
  return pieces;
}

// The stretches of a fold that keep their paper, in mm along the fold.
class Clearances {
 public:
  Clearances(const std::vector<CutPiece>& cuts, double clearance)
      : cuts_(cuts),
        whole_clearance_(clearance),
        clearance_(clearance),
        grid_(segments(cuts), std::max(clearance, kTouch), cuts.size() > kManyCuts),
        seen_(cuts.size(), 0) {}

  // `share`: of the whole clearance, at most 1.
  void find(std::span<const PagePoint> fold, double share, std::vector<Dash>& kept) {
    clearance_ = share * whole_clearance_;
    kept.clear();
    double t = 0.0;
    keep(kept, 0.0, clearance_);
    for (std::size_t i = 1; i < fold.size(); ++i) {
      const Segment piece{fold[i - 1], fold[i]};
      const double l = distance(piece.a, piece.b);
      if (l <= 0.0) continue;
      meet_cuts(piece, l, t, kept);
      t += l;
      if (i + 1 < fold.size() && turns(fold[i - 1], fold[i], fold[i + 1]))
        keep(kept, t, clearance_);
    }
    keep(kept, t, clearance_);
    std::sort(kept.begin(), kept.end(),
              [](const Dash& a, const Dash& b) { return a.from < b.from; });
  }

 private:
  static std::vector<Segment> segments(const std::vector<CutPiece>& cuts) {
    std::vector<Segment> out;
    out.reserve(cuts.size());
    for (const CutPiece& cut : cuts) out.push_back(cut.segment);
    return out;
  }
  // Often many cuts meet a fold in one place; skip those that the last stretch already covers.
  static void keep(std::vector<Dash>& kept, double at, double half) {
    const Dash stretch{at - half, at + half};
    if (!kept.empty() && kept.back().from <= stretch.from && kept.back().to >= stretch.to) return;
    kept.push_back(stretch);
  }
  static bool turns(const PagePoint& a, const PagePoint& b, const PagePoint& c) {
    const double dot = (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y);
    return dot < kCorner * distance(a, b) * distance(b, c);
  }

  // Where there are many cuts, look at a few of each cell first: these mostly keep everything that
  // the others would keep.
  void meet_cuts(const Segment& piece, double l, double t, std::vector<Dash>& kept) {
    ++query_;
    const std::size_t first = kept.size();
    rest_.clear();
    const PagePoint u{(piece.b.x - piece.a.x) / l, (piece.b.y - piece.a.y) / l};
    grid_.each_cell(piece, [&](const PagePoint& centre, std::span<const std::uint32_t> cuts) {
      const std::size_t some = std::min(cuts.size(), kFewCuts);
      meet_some(cuts.first(some), piece, l, t, kept);
      const double at = (centre.x - piece.a.x) * u.x + (centre.y - piece.a.y) * u.y;
      if (some < cuts.size()) rest_.push_back({t + at, cuts.subspan(some)});
    });
    if (rest_.empty()) return;
    merge_from(kept, first);
    const std::vector<Dash> whole(kept.begin() + static_cast<std::ptrdiff_t>(first), kept.end());
    const double reach =
        grid_.cell_mm() * std::numbers::sqrt2 / 2 + clearance_ / kSteepest + kTouch;
    for (const Rest& rest : rest_) {
      const auto after =
          std::upper_bound(whole.begin(), whole.end(), rest.at,
                           [](double at, const Dash& stretch) { return at < stretch.from; });
      const bool all_kept = after != whole.begin() && std::prev(after)->from <= rest.at - reach &&
                            std::prev(after)->to >= rest.at + reach;
      if (!all_kept) meet_some(rest.cuts, piece, l, t, kept);
    }
  }

  // Joins overlapping stretches from `first` on, in order.
  static void merge_from(std::vector<Dash>& kept, std::size_t first) {
    const auto begin = kept.begin() + static_cast<std::ptrdiff_t>(first);
    std::sort(begin, kept.end(), [](const Dash& a, const Dash& b) { return a.from < b.from; });
    auto last = begin;
    for (auto next = begin; next != kept.end(); ++next)
      if (next == begin || next->from > last->to)
        *(next == begin ? last : ++last) = *next;
      else
        last->to = std::max(last->to, next->to);
    if (begin != kept.end()) kept.erase(last + 1, kept.end());
  }

  void meet_some(std::span<const std::uint32_t> cuts, const Segment& piece, double l, double t,
                 std::vector<Dash>& kept) {
    const double ux = (piece.b.x - piece.a.x) / l, uy = (piece.b.y - piece.a.y) / l;
    const auto along = [&](const PagePoint& p) {
      return (p.x - piece.a.x) * ux + (p.y - piece.a.y) * uy;
    };
    const auto aside = [&](const PagePoint& p) {
      return (p.y - piece.a.y) * ux - (p.x - piece.a.x) * uy;
    };
    for (const std::uint32_t c : cuts) {
      if (seen_[c] == query_) continue;
      seen_[c] = query_;
      const CutPiece& cut = cuts_[c];
      const double h0 = aside(cut.segment.a), h1 = aside(cut.segment.b);
      const double s0 = along(cut.segment.a), s1 = along(cut.segment.b);
      const double sine = std::abs(h1 - h0) / distance(cut.segment.a, cut.segment.b);
      if (std::min(h0, h1) <= kTouch && std::max(h0, h1) >= -kTouch && sine > 0.01) {
        const double at = s0 + (s1 - s0) * std::clamp(h0 / (h0 - h1), 0.0, 1.0);
        if (at >= -kTouch && at <= l + kTouch)
          keep(kept, t + at, clearance_ / std::max(sine, kSteepest));
      }
      for (const auto& [ends, s, h] : {std::tuple{cut.ends_at_a, s0, h0}, {cut.ends_at_b, s1, h1}})
        if (ends && std::abs(h) < clearance_ && s > -clearance_ && s < l + clearance_)
          keep(kept, t + s, std::sqrt(clearance_ * clearance_ - h * h));
    }
  }

  const std::vector<CutPiece>& cuts_;
  double whole_clearance_;
  double clearance_;  ///< that is kept now
  SegmentGrid grid_;
  struct Rest {
    double at{};  ///< middle of a cell, along the fold
    std::span<const std::uint32_t> cuts;
  };
  std::vector<std::uint32_t> seen_;  ///< last query that looked at the cut
  std::uint32_t query_{};
  std::vector<Rest> rest_;
};

// Appends the part of a line between two lengths along it.
void part_of(std::span<const PagePoint> line, const Dash& dash, std::vector<PagePoint>& out) {
  out.clear();
  double t = 0.0;
  for (std::size_t i = 1; i < line.size() && t < dash.to; ++i) {
    const double l = distance(line[i - 1], line[i]);
    const auto at = [&](double s) {
      const double f = l > 0.0 ? std::clamp((s - t) / l, 0.0, 1.0) : 0.0;
      return lerp(line[i - 1], line[i], f);
    };
    if (t + l > dash.from) {
      if (out.empty()) out.push_back(at(dash.from));
      out.push_back(at(dash.to));
    }
    t += l;
  }
}

// Calls `use(from, to)` for each free stretch between the kept ones of a line of length l.
template <typename Use>
void each_free(const std::vector<Dash>& kept, double l, Use&& use) {
  double from = 0.0;
  for (const Dash& stretch : kept) {
    if (stretch.from > from + kSlack) use(from, std::min(stretch.from, l));
    from = std::max(from, stretch.to);
  }
}

// Calls `use(from, to)` for each stretch without a dash that is too long to stay so. Cuts that meet
// a fold within kTouch of each other meet it in one place.
template <typename Use>
void each_bare(const std::vector<Dash>& dashes, double l, const DashShape& shape, Use&& use) {
  const double most = std::max(shape.gap_mm, 2 * shape.clearance_mm) + kTouch;
  double from = 0.0;
  for (std::size_t i = 0; i <= dashes.size(); ++i) {
    const double to = i < dashes.size() ? dashes[i].from : l;
    if (dashes.empty() || to - from > most) use(from, to);
    from = i < dashes.size() ? dashes[i].to : l;
  }
}

// The dashes of one fold after another.
class Dasher {
 public:
  Dasher(const std::vector<CutPiece>& cuts, const DashShape& shape)
      : shape_(shape), clearances_(cuts, shape.clearance_mm) {}

  /// The dashes of a fold of length l, in order. @return how many of them were shortened
  std::size_t find(std::span<const PagePoint> fold, double l, std::vector<Dash>& dashes) {
    dashes.clear();
    if (has_room(l, 1.0)) {
      clearances_.find(fold, 1.0, kept_);
      each_free(kept_, l,
                [&](double from, double to) { append_dashes(to - from, from, shape_, dashes); });
    }
    std::size_t shortened = 0;
    for (int tenths = 9; tenths >= kLeastTenths && is_bare(dashes, l); --tenths)
      shortened += shorten(fold, l, 0.1 * tenths, dashes);
    return shortened;
  }

 private:
  static constexpr int kLeastTenths = static_cast<int>(10 * kLeastShare);

  /// Whether a dash can fit between the clearances of a fold's ends, wherever cuts meet it: most
  /// folds of a fine lattice are too short, and their cuts need no look.
  [[nodiscard]] bool has_room(double l, double share) const {
    return l > share * shortest_good_fold_mm(shape_) - 2 * kSlack;
  }

  [[nodiscard]] bool is_bare(const std::vector<Dash>& dashes, double l) const {
    bool any = false;
    each_bare(dashes, l, shape_, [&](double, double) { any = true; });
    return any;
  }

  // Adds the dashes that fit into bare stretches with a share of clearance and of shortest dash.
  std::size_t shorten(std::span<const PagePoint> fold, double l, double share,
                      std::vector<Dash>& dashes) {
    if (!has_room(l, share)) return 0;
    DashShape small = shape_;
    small.min_dash_mm *= share;
    small.clearance_mm *= share;
    clearances_.find(fold, share, kept_);
    bare_.clear();
    each_bare(dashes, l, shape_, [&](double from, double to) { bare_.push_back({from, to}); });
    const std::size_t before = dashes.size();
    auto bare = bare_.begin();
    each_free(kept_, l, [&](double from, double to) {
      while (bare != bare_.end() && bare->to < to - kSlack) ++bare;
      // A free stretch that reaches out of the bare one has a dash already.
      if (bare != bare_.end() && bare->from <= from + kSlack)
        append_dashes(to - from, from, small, dashes);
    });
    std::sort(dashes.begin(), dashes.end(),
              [](const Dash& a, const Dash& b) { return a.from < b.from; });
    return dashes.size() - before;
  }

  const DashShape& shape_;
  Clearances clearances_;
  std::vector<Dash> kept_, bare_;
};

}  // namespace

std::size_t append_dashes(double free_mm, double offset_mm, const DashShape& shape,
                          std::vector<Dash>& dashes) {
  const double f = free_mm, d = shape.dash_mm, g = shape.gap_mm;
  if (!(f >= shape.min_dash_mm - kSlack)) return 0;
  const double least = std::ceil((f + g) / (d + g) - 1e-9);
  auto n = static_cast<std::size_t>(std::max(1.0, least));
  double gap = g, dash = f;
  if (n > 1) {
    const auto count = static_cast<double>(n);
    gap = g * std::clamp(f / (count * d + (count - 1) * g), 0.75, 1.0);
    dash = (f - (count - 1) * gap) / count;
  }
  double lead = 0.0;
  if (n > 1 && dash < shape.min_dash_mm) {
    --n;
    gap = g;
    const auto count = static_cast<double>(n);
    const double most_lead = std::max(0.0, g - shape.clearance_mm);
    const double least_dash = (f - 2 * most_lead - (count - 1) * gap) / count;
    dash = std::min(std::max(d, least_dash), (f - (count - 1) * gap) / count);
    lead = (f - count * dash - (count - 1) * gap) / 2;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const double from = offset_mm + lead + static_cast<double>(i) * (dash + gap);
    dashes.push_back({from, from + dash});
  }
  return n;
}

double shortest_good_fold_mm(const DashShape& shape) {
  return shape.min_dash_mm + 2 * shape.clearance_mm;
}

Dashed micro_cut(const LineWork& work, const DashShape& shape) {
  Dashed out;
  out.work = work.without_lines();
  out.work.dashed = true;
  const std::vector<CutPiece> cuts = cut_pieces(work);
  Dasher dasher(cuts, shape);
  std::vector<Dash> dashes;
  std::vector<PagePoint> points;
  for (std::uint32_t i = 0; i < work.lines.size(); ++i) {
    const DrawnLine& line = work.lines[i];
    const auto fold = work.points_of(line);
    const double l = is_fold(line.operation) ? length(fold) : 0.0;
    out.fold_line_mm += l;
    if (is_fold(line.operation) && !work.dashed) {
      out.shortened += dasher.find(fold, l, dashes);
      for (const Dash& dash : dashes) {
        part_of(fold, dash, points);
        out.work.append(line.operation, points);
      }
      each_bare(dashes, l, shape, [&](double from, double to) {
        part_of(fold, {0.5 * (from + to), to}, points);
        out.left_out.push_back({i, {from, to}, points.empty() ? fold.front() : points.front()});
      });
    } else {
      out.work.append(line.operation, fold);
    }
    out.line.resize(out.work.lines.size(), i);
  }
  return out;
}

void score_left_out(const LineWork& drawing, const DashShape& shape, Dashed& dashed) {
  dashed.first_scored = dashed.work.lines.size();
  std::vector<PagePoint> points;
  for (const LeftOut& left : dashed.left_out) {
    const DrawnLine& line = drawing.lines[left.line];
    const auto fold = drawing.points_of(line);
    const double from = left.on.from > 0.0 ? left.on.from + 0.5 * shape.clearance_mm : 0.0;
    const double to =
        left.on.to < length(fold) ? left.on.to - 0.5 * shape.clearance_mm : left.on.to;
    part_of(fold, {from, to}, points);
    dashed.work.append(line.operation, points);
    dashed.line.resize(dashed.work.lines.size(), left.line);
  }
}

std::optional<Warning> left_out_warning(const Dashed& dashed, const DashShape& shape,
                                        std::string_view done) {
  if (dashed.left_out.empty()) return std::nullopt;
  const auto mm = [](const LeftOut& left) { return left.on.to - left.on.from; };
  const LeftOut& longest =
      *std::max_element(dashed.left_out.begin(), dashed.left_out.end(),
                        [&](const LeftOut& a, const LeftOut& b) { return mm(a) < mm(b); });
  return Warning{
      .code = "fold_short_for_dash",
      .message = fmt::format("{} stretches of folds {}: they are too short for a dash of {:g} mm "
                             "between clearances of "
                             "{:g} mm; the longest is {:.2f} mm, at {:.2f},{:.2f} mm",
                             dashed.left_out.size(), done, kLeastShare * shape.min_dash_mm,
                             kLeastShare * shape.clearance_mm, mm(longest), longest.where.x,
                             longest.where.y)};
}

}  // namespace popcut
