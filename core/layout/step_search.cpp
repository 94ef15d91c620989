// SPDX-License-Identifier: MIT
// Part of core/layout/seam_search.hpp.
#include <algorithm>
#include <cmath>

#include "core/layout/line_index.hpp"
#include "core/layout/seam_search.hpp"

namespace popcut {
namespace {

constexpr double kStep = 6.0;  // cost in mm of glue: a step
constexpr std::size_t kMostStrips = 20'000;

// A strip between two neighbouring lines along y, and what lies in it.
struct Strip {
  double left{}, right{};
  std::vector<SeamStretch> across;      // y of every line in it, sorted by `from`
  std::vector<SeamStretch> cut_beside;  // y where its right side is cut, merged
  std::vector<SeamStretch> beside;      // y where any line runs along its right side, merged
};

std::vector<Strip> strips_of(const LineIndex& lines, double left, double right) {
  const std::vector<std::uint32_t> inside = lines.between(true, left, right);
  std::vector<double> at{left, right};
  for (const std::uint32_t i : inside) {
    const Segment& s = lines.segments()[i];
    if (std::abs(s.a.x - s.b.x) <= kOn && s.a.x > left + kOn && s.a.x < right - kOn)
      at.push_back(s.a.x);
  }
  sort_places(at);
  std::vector<Strip> strips(at.size() - 1);
  for (std::size_t i = 0; i < strips.size(); ++i) {
    strips[i].left = at[i];
    strips[i].right = at[i + 1];
  }
  const auto strip_at = [&](double x) {  // the first strip whose right side lies beyond x
    const auto k = std::upper_bound(at.begin() + 1, at.end() - 1, x + kOn) - at.begin() - 1;
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(k, 0));
  };
  for (const std::uint32_t i : inside) {
    const Segment& s = lines.segments()[i];
    const double x0 = std::min(s.a.x, s.b.x), x1 = std::max(s.a.x, s.b.x);
    const SeamStretch y{std::min(s.a.y, s.b.y), std::max(s.a.y, s.b.y), 0, 0};
    if (x1 < left - kOn || x0 > right + kOn) continue;
    if (x1 - x0 <= kOn) {
      if (x0 <= left + kOn || x0 >= right - kOn) continue;
      Strip& before = strips[strip_at(x0) - 1];
      before.beside.push_back(y);
      if (is_cut(lines.operation(i))) before.cut_beside.push_back(y);
      continue;
    }
    for (std::size_t k = strip_at(std::max(x0, left)); k < strips.size(); ++k) {
      if (strips[k].left >= x1 - kOn) break;
      strips[k].across.push_back(y);
    }
  }
  for (Strip& strip : strips) {
    std::sort(strip.across.begin(), strip.across.end(),
              [](const SeamStretch& a, const SeamStretch& b) { return a.from < b.from; });
    merge_stretches(strip.cut_beside);
    merge_stretches(strip.beside);
  }
  return strips;
}

class Steps {
 public:
  Steps(LineIndex& lines, const SearchLimits& limits, const ColumnEnds& ends, double left,
        double right)
      : lines_(lines), limits_(limits), ends_(ends), strips_(strips_of(lines, left, right)) {}

  [[nodiscard]] bool worth_it() const {
    return strips_.size() > 1 && strips_.size() <= kMostStrips;
  }

  // The cheapest way within the band; `y` is empty if there is none.
  StepSeam across(double low, double high, double& cost) {
    const std::size_t count =
        std::clamp<std::size_t>(static_cast<std::size_t>((high - low) / 0.5) + 1, 1, 400);
    ys_.resize(count);
    for (std::size_t j = 0; j < count; ++j)
      ys_[j] = count == 1
                   ? (low + high) / 2
                   : low + (high - low) * static_cast<double>(j) / static_cast<double>(count - 1);
    // Two states per height: tabs below, tabs above. A glued stretch has its tabs on one side.
    std::vector<double> best(2 * count, 0.0), next(2 * count);
    std::vector<std::uint32_t> from(strips_.size() * 2 * count);
    since_.assign(count, strips_.front().left);
    paper_.assign(count, false);
    for (std::size_t i = 0; i < strips_.size(); ++i) {
      if (i > 0) {
        end_stretches(strips_[i - 1], false, best);
        step_over(strips_[i - 1], best, from.data() + i * 2 * count);
      }
      price(strips_[i], next);
      for (std::size_t j = 0; j < count; ++j)
        if ((i == 0 && !ends_.allows(false, ys_[j])) ||
            (i + 1 == strips_.size() && !ends_.allows(true, ys_[j])))
          next[j] = next[count + j] = kNoSeam;
      for (std::size_t j = 0; j < best.size(); ++j) best[j] += next[j];
    }
    end_stretches(strips_.back(), true, best);
    const auto end = std::min_element(best.begin(), best.end());
    cost = *end;
    StepSeam seam;
    if (cost == kNoSeam) return seam;
    seam.y.resize(strips_.size());
    auto j = static_cast<std::uint32_t>(end - best.begin());
    for (std::size_t i = strips_.size(); i-- > 0;) {
      seam.y[i] = ys_[j % count];
      if (i > 0) j = from[i * 2 * count + j];
    }
    for (const Strip& strip : strips_) seam.x.push_back(strip.left);
    seam.x.push_back(strips_.back().right);
    return seam;
  }

 private:
  // The cost of each height in a strip: the strip's width where a tab has room below or above.
  void price(const Strip& strip, std::vector<double>& out) {
    const std::size_t count = ys_.size();
    const double width = strip.right - strip.left;
    const double need = limits_.tabs.min_depth_mm + limits_.tabs.clearance_mm;
    const double full = limits_.tabs.depth_mm + limits_.tabs.clearance_mm;
    double reached = -1e300;  // lower end of all lines that begin above
    std::size_t next = 0;
    for (std::size_t j = 0; j < count; ++j) {
      const double y = ys_[j];
      for (; next < strip.across.size() && strip.across[next].from <= y; ++next)
        reached = std::max(reached, strip.across[next].to);
      const double above = y - reached;
      const double below = next < strip.across.size() ? strip.across[next].from - y : 1e300;
      paper_[j] = lines_.is_paper({(strip.left + strip.right) / 2, y});
      if (!paper_[j]) {
        out[j] = out[count + j] = above > kOn && below > kOn ? 0.0 : kNoSeam;
        continue;
      }
      const bool valid = above >= limits_.min_panel_mm && below >= limits_.min_panel_mm &&
                         std::max(above, below) >= need && !banned(strip, y);
      const auto with = [&](double room) {
        return valid && room >= need ? width * (1.3 - 0.3 * std::min(1.0, room / full)) : kNoSeam;
      };
      out[j] = with(below);
      out[count + j] = with(above);
    }
  }

  // A glued stretch ends where a line runs along the strip's right side. At that height no path is
  // valid whose stretch, over one or more strips, was too short for a tab. Paths change their
  // height only where stretches end, so each has been at one height since its stretch began.
  void end_stretches(const Strip& strip, bool last, std::vector<double>& best) {
    const std::size_t count = ys_.size();
    std::size_t next = 0;
    for (std::size_t j = 0; j < count; ++j) {
      while (next < strip.beside.size() && strip.beside[next].to < ys_[j] - kOn) ++next;
      const bool ends =
          last || (next < strip.beside.size() && strip.beside[next].from <= ys_[j] + kOn);
      if (!ends) continue;
      if (paper_[j] && strip.right - since_[j] < limits_.tabs.min_stretch_mm())
        best[j] = best[count + j] = kNoSeam;
      since_[j] = strip.right;
    }
  }

  [[nodiscard]] bool banned(const Strip& strip, double y) const {
    return std::any_of(limits_.banned.begin(), limits_.banned.end(), [&](const BannedSeam& ban) {
      return ban.bans({false, y}, strip.left + kOn, strip.right - kOn);
    });
  }

  // From one strip to the next: straight on, or along a cut to any height that the cut reaches.
  void step_over(const Strip& before, std::vector<double>& best, std::uint32_t* from) const {
    const std::size_t count = ys_.size();
    for (std::size_t j = 0; j < best.size(); ++j) from[j] = static_cast<std::uint32_t>(j);
    const std::vector<double> old = best;
    const auto take = [&](std::size_t to, std::size_t of, double step) {
      if (old[of] + step >= best[to]) return;
      best[to] = old[of] + step;
      from[to] = static_cast<std::uint32_t>(of);
    };
    for (const SeamStretch& cut : before.cut_beside) {
      const auto j0 = static_cast<std::size_t>(
          std::lower_bound(ys_.begin(), ys_.end(), cut.from - kOn) - ys_.begin());
      const auto j1 = static_cast<std::size_t>(
          std::upper_bound(ys_.begin(), ys_.end(), cut.to + kOn) - ys_.begin());
      if (j0 >= j1) continue;
      std::size_t least = j0;
      for (std::size_t j = j0; j < j1; ++j)
        for (const std::size_t k : {j, count + j})
          if (old[k] < old[least]) least = k;
      for (std::size_t j = j0; j < j1; ++j) {
        take(j, count + j, 0.0);
        take(count + j, j, 0.0);
        take(j, least, kStep);
        take(count + j, least, kStep);
      }
    }
  }

  LineIndex& lines_;
  const SearchLimits& limits_;
  const ColumnEnds& ends_;
  std::vector<Strip> strips_;
  std::vector<double> ys_;
  std::vector<double> since_;  // start of the stretch at each height
  std::vector<bool> paper_;    // whether each height of the strip has paper
};

}  // namespace

SteppedRows find_stepped(LineIndex& lines, const SearchLimits& limits, const ColumnEnds& ends,
                         double left, double right) {
  SteppedRows found;
  Steps steps(lines, limits, ends, left, right);
  if (!steps.worth_it()) return found;
  const Box& box = lines.box();
  const double height = box.height(), depth = limits.tabs.depth_mm;
  const double inner = limits.height_mm - 2 * depth;
  if (inner <= 0.0) return found;
  const auto least = static_cast<std::size_t>(std::ceil(height / inner - 1e-9));
  for (std::size_t count = std::max<std::size_t>(least, 2); count <= least + 3; ++count) {
    // One band per seam; two neighbouring seams can never be more than `inner` apart. The bands
    // make about equal pieces, or full pieces and a rest.
    const double share = limits.full ? 0.8 * inner : height / static_cast<double>(count);
    const double half = limits.full ? 0.1 * inner : (inner - share) / 2;
    const double shift = limits.full ? half : 0.0;
    if (half < 0.0 || share * static_cast<double>(count) < height - 2 * half) continue;
    SteppedRows rows;
    rows.cost = kOnePieceMore * static_cast<double>(count);
    for (std::size_t k = 1; k < count && rows.cost < kNoSeam; ++k) {
      const double middle = box.y0 + share * static_cast<double>(k) + shift;
      const double low = std::max(middle - half, box.y0 + depth);
      const double high = std::min(middle + half, box.y1 - depth);
      double cost = kNoSeam;
      if (low <= high) rows.seams.push_back(steps.across(low, high, cost));
      rows.cost += cost;
    }
    if (rows.cost < found.cost) found = std::move(rows);
    if (found.cost < kNoSeam) break;
  }
  return found;
}

}  // namespace popcut
