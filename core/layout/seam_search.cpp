// SPDX-License-Identifier: MIT
#include "core/layout/seam_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/layout/line_index.hpp"

namespace popcut {
namespace {

constexpr double kFoldCrossed = 8.0, kCutCrossed = 4.0;  // cost in mm of glue: a crossing,
constexpr double kUneven = 20.0;                         // a nearly empty piece

// Positions where a seam over `from`..`to` may run: every cut along it, and a grid between the
// cuts.
std::vector<double> candidates(const LineIndex& lines, bool vertical, double low, double high,
                               double from, double to) {
  std::vector<double> at;
  for (const std::uint32_t i : lines.between(!vertical, from, to)) {
    const Segment& s = lines.segments()[i];
    const double a = vertical ? s.a.x : s.a.y, b = vertical ? s.b.x : s.b.y;
    if (is_cut(lines.operation(i)) && std::abs(a - b) <= kOn && a > low + kOn && a < high - kOn)
      at.push_back(a);
  }
  const double step = std::max(1.0, (high - low) / 1500);
  for (double x = low + step; x < high - step / 2; x += step) at.push_back(x);
  sort_places(at);
  return at;
}

// Splits `low`..`high` so that no part with its tabs is longer than `most`. `tabs_low` and
// `tabs_high` are what its ends need for their own tabs.
double part(const std::vector<double>& at, const std::vector<double>& costs, double low,
            double high, double most, double depth, double tabs_low, double tabs_high, bool full,
            std::vector<double>& chosen) {
  const std::size_t n = at.size();
  std::vector<double> best(n + 1, kNoSeam);
  std::vector<std::ptrdiff_t> from(n + 1, -1);
  const auto position = [&](std::size_t i) { return i == n ? high : at[i]; };
  for (std::size_t i = 0; i <= n; ++i) {
    const double cost = i == n ? 0.0 : costs[i];
    if (cost == kNoSeam) continue;
    const double end_tab = i == n ? tabs_high : depth;
    const auto consider = [&](double start, double start_tab, double before, std::ptrdiff_t j) {
      const double length = position(i) - start + start_tab + end_tab;
      if (length > most + kOn) return false;
      const double empty = 1.0 - length / most;
      const double uneven = full ? empty * (1.0 - empty) : empty * empty;
      const double sum = before + cost + kOnePieceMore + kUneven * uneven;
      if (sum < best[i]) {
        best[i] = sum;
        from[i] = j;
      }
      return true;
    };
    for (std::size_t j = i; j-- > 0;) {
      if (position(i) - at[j] > most) break;
      if (best[j] < kNoSeam) (void)consider(at[j], depth, best[j], static_cast<std::ptrdiff_t>(j));
    }
    (void)consider(low, tabs_low, 0.0, -1);
  }
  if (best[n] == kNoSeam) return kNoSeam;
  const auto before = static_cast<std::ptrdiff_t>(chosen.size());
  for (std::ptrdiff_t i = from[n]; i >= 0; i = from[static_cast<std::size_t>(i)])
    chosen.push_back(at[static_cast<std::size_t>(i)]);
  std::reverse(chosen.begin() + before, chosen.end());
  return best[n];
}

Error invalid_seam(const char* name, double asked, double nearest) {
  return {
      ErrorKind::Infeasible, fmt::format("/options/seam-{}", name),
      fmt::format("{0} = {1:g} mm runs along a fold or leaves no room for a tab; {2}", name, asked,
                  nearest < kNoSeam ? fmt::format("the nearest valid place is {:.3f}", nearest)
                                    : std::string("no other place is valid either"))};
}

// Splits the stretches at `ys`.
void part_at(std::vector<SeamStretch>& stretches, const std::vector<double>& ys) {
  for (const double y : ys) {
    const auto at = std::find_if(stretches.begin(), stretches.end(), [&](const SeamStretch& s) {
      return y > s.from + kOn && y < s.to - kOn;
    });
    if (at == stretches.end()) continue;
    SeamStretch rest = *at;
    rest.from = y;
    at->to = y;
    stretches.insert(at + 1, rest);
  }
}

}  // namespace

bool ColumnEnds::allows(bool right_side, double y) const {
  const std::vector<SeamStretch>& stretches = right_side ? right : left;
  const auto after = std::upper_bound(stretches.begin(), stretches.end(), y,
                                      [](double at, const SeamStretch& s) { return at < s.from; });
  if (after == stretches.begin()) return true;
  const SeamStretch& s = *(after - 1);
  if (y >= s.to - kOn || y <= s.from + kOn) return true;
  return y - s.from >= least_mm && s.to - y >= least_mm;
}

double seam_cost(LineIndex& lines, const SearchLimits& limits, const AxisLine& line, double from,
                 double to) {
  for (const BannedSeam& ban : limits.banned)
    if (ban.bans(line, from, to)) return kNoSeam;
  SeamScan scan;
  lines.scan(line, from, to, limits.min_panel_mm, scan);
  if (scan.fold_mm > 0.0 || scan.sliver_mm > 0.0) return kNoSeam;
  std::vector<SeamStretch> stretches;
  uncut_stretches(lines, line, from, to, scan, stretches);
  TabFitter fitter(lines, limits.tabs);
  std::vector<Tab> tabs;
  double cost = kFoldCrossed * scan.folds_crossed + kCutCrossed * scan.cuts_crossed;
  for (const SeamStretch& stretch : stretches) {
    tabs.clear();
    double depth = fitter.fit(line, stretch, 1, tabs);
    if (depth < limits.tabs.depth_mm) depth = std::max(depth, fitter.fit(line, stretch, -1, tabs));
    if (depth == 0.0) return kNoSeam;
    cost += (stretch.to - stretch.from) * (1.3 - 0.3 * depth / limits.tabs.depth_mm);
  }
  return cost;
}

SeamSearch::Lines SeamSearch::priced(bool vertical, double from, double to,
                                     const ColumnEnds* ends) {
  const Box& box = lines_->box();
  const double low = vertical ? box.x0 : box.y0, high = vertical ? box.x1 : box.y1;
  Lines out{candidates(*lines_, vertical, low, high, from, to), {}};
  out.costs.reserve(out.at.size());
  const bool needed = high - low > (vertical ? limits_.width_mm : limits_.height_mm);
  for (const double at : out.at) {
    const bool valid = ends == nullptr || (ends->allows(false, at) && ends->allows(true, at));
    out.costs.push_back(needed && valid ? seam_cost(*lines_, limits_, {vertical, at}, from, to)
                                        : kNoSeam);
  }
  return out;
}

// Straight seams from `from` to `to`, including the requested ones.
Result<SeamSearch::Chosen> SeamSearch::straight(bool vertical, const Lines& lines, double from,
                                                double to) {
  const Box& box = lines_->box();
  const double low = vertical ? box.x0 : box.y0, high = vertical ? box.x1 : box.y1;
  const double most = vertical ? limits_.width_mm : limits_.height_mm;
  const double depth = limits_.tabs.depth_mm;
  std::vector<double> asked = vertical ? limits_.asked_x : limits_.asked_y;
  std::sort(asked.begin(), asked.end());
  Chosen all{{}, 0.0};
  double start = low, start_tab = 0.0;
  std::vector<double> some, prices;
  const auto stage = [&](double end, double end_tab) {
    some.clear();
    prices.clear();
    for (std::size_t i = 0; i < lines.at.size(); ++i)
      if (lines.at[i] > start + kOn && lines.at[i] < end - kOn) {
        some.push_back(lines.at[i]);
        prices.push_back(lines.costs[i]);
      }
    all.cost +=
        part(some, prices, start, end, most, depth, start_tab, end_tab, limits_.full, all.at);
  };
  for (double a : asked) {
    a += low;  // requested seams count from the drawing's edge
    const double cost = seam_cost(*lines_, limits_, {vertical, a}, from, to);
    if (cost == kNoSeam) {
      double nearest = kNoSeam;
      for (const double other : lines.at)
        if (std::abs(other - a) < std::abs(nearest - a) &&
            seam_cost(*lines_, limits_, {vertical, other}, from, to) < kNoSeam)
          nearest = other;
      return tl::unexpected(
          invalid_seam(vertical != limits_.swapped ? "x" : "y", a - low, nearest - low));
    }
    stage(a, depth);
    all.at.push_back(a);
    all.cost += cost;
    start = a;
    start_tab = depth;
  }
  stage(high, 0.0);
  return all;
}

std::vector<SeamStretch> SeamSearch::glued(double x) {
  const Box& box = lines_->box();
  std::vector<SeamStretch> out;
  if (x <= box.x0 + kOn || x >= box.x1 - kOn) return out;
  SeamScan scan;
  lines_->scan({true, x}, box.y0, box.y1, limits_.min_panel_mm, scan);
  uncut_stretches(*lines_, {true, x}, box.y0, box.y1, scan, out);
  return out;
}

Result<SeamSearch::Column> SeamSearch::rows(double left, double right, std::vector<double> met) {
  const Box& box = lines_->box();
  ColumnEnds ends{glued(left), glued(right),
                  limits_.tabs.min_stretch_mm() + limits_.tabs.min_depth_mm};
  part_at(ends.left, met);
  const auto chosen = straight(false, priced(false, left, right, &ends), left, right);
  if (!chosen) return tl::unexpected(chosen.error());
  Column column{left, right, std::move(met), {}, chosen->cost};
  for (const double y : chosen->at) column.seams.push_back({{left, right}, {y}});
  if (box.height() > limits_.height_mm && limits_.asked_y.empty()) {
    SteppedRows stepped = find_stepped(*lines_, limits_, ends, left, right);
    if (stepped.cost < column.cost) {
      column.cost = stepped.cost;
      column.seams = std::move(stepped.seams);
    }
  }
  return column;
}

void SeamSearch::ban(const std::vector<BannedSeam>& seams) {
  limits_.banned.insert(limits_.banned.end(), seams.begin(), seams.end());
  for (const BannedSeam& ban : seams) {
    if (ban.vertical && columns_)
      for (std::size_t i = 0; i < columns_->at.size(); ++i)
        if (ban.bans({true, columns_->at[i]}, -1e300, 1e300)) columns_->costs[i] = kNoSeam;
    if (!ban.vertical)
      std::erase_if(known_, [&](const Column& column) {
        return ban.from < column.right && ban.to > column.left;
      });
  }
}

Result<FoundSeams> SeamSearch::find() {
  const Box& box = lines_->box();
  FoundSeams found;
  found.partition.top = box.y0;
  found.partition.bottom = box.y1;
  if (!columns_) columns_ = priced(true, box.y0, box.y1, nullptr);
  const auto columns = straight(true, *columns_, box.y0, box.y1);
  if (!columns) return tl::unexpected(columns.error());
  if (columns->cost == kNoSeam)
    return fail(
        ErrorKind::Infeasible, "",
        "no valid seams give pieces that are narrow enough; use a larger mat or smaller tabs");
  found.cost = columns->cost;
  std::vector<double>& xs = found.partition.xs;
  xs = {box.x0};
  xs.insert(xs.end(), columns->at.begin(), columns->at.end());
  xs.push_back(box.x1);
  std::vector<double> met;
  for (std::size_t c = 0; c + 1 < xs.size(); ++c) {
    auto known = std::find_if(known_.begin(), known_.end(), [&](const Column& column) {
      return column.left == xs[c] && column.right == xs[c + 1] && column.met == met;
    });
    if (known == known_.end()) {
      auto column = rows(xs[c], xs[c + 1], met);
      if (!column) return tl::unexpected(column.error());
      known_.push_back(std::move(*column));
      known = known_.end() - 1;
    }
    if (known->cost == kNoSeam)
      return fail(
          ErrorKind::Infeasible, "",
          "no valid seams give pieces that are short enough; use a larger mat or smaller tabs");
    found.cost += known->cost;
    found.partition.rows.push_back(known->seams);
    met.clear();
    for (const StepSeam& seam : known->seams) met.push_back(seam.y.back());
  }
  found.partition.index();
  return found;
}

}  // namespace popcut
