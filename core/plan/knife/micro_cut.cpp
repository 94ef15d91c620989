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
        clearance_(clearance),
        grid_(segments(cuts), std::max(clearance, kTouch), cuts.size() > kManyCuts),
        seen_(cuts.size(), 0) {}

  void find(std::span<const PagePoint> fold, std::vector<Dash>& kept) {
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
  double clearance_;
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

// Folds that could not be dashed as the material asks, for the warning.
struct UncutFolds {
  std::size_t count{};
  double longest_mm{};
  PagePoint where;
};

void warn_of_uncut(const UncutFolds& uncut, const DashShape& shape,
                   std::vector<std::string>& warnings) {
  if (uncut.count == 0) return;
  warnings.push_back(fmt::format(
      "{} stretches of folds stay uncut: they are too short for a dash of {} mm between "
      "clearances of {} mm; the longest is {:.2f} mm, at {:.2f},{:.2f} mm",
      uncut.count, shape.min_dash_mm, shape.clearance_mm, uncut.longest_mm, uncut.where.x,
      uncut.where.y));
}

// Puts dashes between the kept stretches. `uncut` counts places longer than a gap that get no dash.
void dash_between(std::span<const PagePoint> fold, double l, const std::vector<Dash>& kept,
                  const DashShape& shape, std::vector<Dash>& dashes, UncutFolds& uncut) {
  dashes.clear();
  double free_from = 0.0;
  for (const Dash& stretch : kept) {
    if (stretch.from > free_from + kSlack)
      append_dashes(std::min(stretch.from, l) - free_from, free_from, shape, dashes);
    free_from = std::max(free_from, stretch.to);
  }
  double paper_from = 0.0;
  for (std::size_t i = 0; i <= dashes.size(); ++i) {
    const double paper_to = i < dashes.size() ? dashes[i].from : l;
    const bool none = dashes.empty();
    if (none || paper_to - paper_from > std::max(shape.gap_mm, 2 * shape.clearance_mm) + kSlack) {
      ++uncut.count;
      if (paper_to - paper_from > uncut.longest_mm) {
        uncut.longest_mm = paper_to - paper_from;
        uncut.where = fold.front();
      }
    }
    paper_from = i < dashes.size() ? dashes[i].to : l;
  }
}

}  // namespace

std::size_t append_dashes(double free_mm, double offset_mm, const DashShape& shape,
                          std::vector<Dash>& dashes) {
  const double f = free_mm, d = shape.dash_mm, g = shape.gap_mm;
  if (!(f >= shape.min_dash_mm - kSlack)) return 0;
  const double least = std::ceil((f + g) / (d + g) - 1e-9);
  auto n = static_cast<std::size_t>(std::max(1.0, least));
  double gap = g, dash = f;
  if (n > 1) {
    const double count = static_cast<double>(n);
    gap = g * std::clamp(f / (count * d + (count - 1) * g), 0.75, 1.0);
    dash = (f - (count - 1) * gap) / count;
  }
  double lead = 0.0;
  if (n > 1 && dash < shape.min_dash_mm) {
    --n;
    gap = g;
    const double count = static_cast<double>(n);
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

Dashed micro_cut(const LineWork& work, const DashShape& shape) {
  Dashed out;
  out.work = work.without_lines();
  out.work.dashed = true;
  const std::vector<CutPiece> cuts = cut_pieces(work);
  Clearances clearances(cuts, shape.clearance_mm);
  std::vector<Dash> kept, dashes;
  std::vector<PagePoint> points;
  UncutFolds uncut;
  for (std::uint32_t i = 0; i < work.lines.size(); ++i) {
    const DrawnLine& line = work.lines[i];
    const auto fold = work.points_of(line);
    const bool dash_it = is_fold(line.operation) && !work.dashed;
    if (is_fold(line.operation)) out.fold_line_mm += length(fold);
    if (dash_it) {
      clearances.find(fold, kept);
      dash_between(fold, length(fold), kept, shape, dashes, uncut);
      for (const Dash& dash : dashes) {
        part_of(fold, dash, points);
        out.work.append(line.operation, points);
      }
    } else {
      out.work.append(line.operation, fold);
    }
    out.line.resize(out.work.lines.size(), i);
  }
  warn_of_uncut(uncut, shape, out.work.warnings);
  return out;
}

}  // namespace popcut
