// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "core/verify/target/target.hpp"

namespace popcut::verify {
namespace {

/// So many runs of patches that fit a pattern are measured; more are alike.
constexpr std::size_t kMostCandidates = 64;

/// The strips' borders on the sheet: positions along the spine that have vertices.
class Borders {
 public:
  Borders(const FoldModel& file, const Pose& pose) : file_(file), pose_(pose) {
    for (const Vec2& p : file.flat) v_.push_back(p.y());
    std::sort(v_.begin(), v_.end());
    same_ = 1e-7 * (v_.empty() ? 0.0 : v_.back() - v_.front());
    std::size_t kept = 0;
    for (std::size_t k = 0; k < v_.size(); ++k)
      if (k == 0 || v_[k] - v_[kept - 1] > same_) v_[kept++] = v_[k];
    v_.resize(kept);
    for (const Vec3& p : pose.at) reach_ = std::max({reach_, std::abs(p.x()), std::abs(p.z())});
  }

  [[nodiscard]] bool empty() const { return v_.empty(); }
  [[nodiscard]] double first() const { return v_.front(); }
  [[nodiscard]] double last() const { return v_.back(); }
  [[nodiscard]] double same() const { return same_; }
  [[nodiscard]] std::size_t index(double v) const {
    return static_cast<std::size_t>(std::lower_bound(v_.begin(), v_.end(), v - same_) - v_.begin());
  }
  [[nodiscard]] bool at(double v) const {
    const std::size_t k = index(v);
    return k < v_.size() && v_[k] <= v + same_;
  }
  [[nodiscard]] const std::vector<double>& all() const { return v_; }

  /// Whether panels other than those of wall and ground connect across the border at `v`. This
  /// marks a connector; a plain cut has no such panels.
  [[nodiscard]] bool joined(double v) {
    if (joined_.empty()) find_joined();
    const std::size_t k = index(v);
    return k < v_.size() && joined_[k] != 0;
  }
  /// Whether there is nothing but wall and ground from `begin` to `end`.
  [[nodiscard]] bool plain(double begin, double end) {
    if (joined_.empty()) find_joined();
    // Stretch k lies between borders k and k + 1; `begin` can lie inside one.
    std::size_t k = index(begin);
    if (k > 0 && !at(begin)) --k;
    for (; k + 1 < v_.size() && v_[k] < end - same_; ++k)
      if (structure_[k] != 0) return false;
    return true;
  }

 private:
  void find_joined() {
    joined_.assign(v_.size() + 1, 0);
    structure_.assign(v_.size() + 1, 0);
    const auto on_card = [&](std::uint32_t k) {
      const FoldVertex p = unposed(pose_.at[k], *pose_.psi_rad);
      return std::array{std::abs(p.x) <= 1e-9 * reach_, std::abs(p.z) <= 1e-9 * reach_};
    };
    // A face is one piece, so it goes through every border between its ends.
    std::vector<int> opens(v_.size() + 2), covers(v_.size() + 2);
    for (std::size_t f = 0; f < file_.faces(); ++f) {
      double low = v_.back(), high = v_.front();
      bool wall = true, ground = true;
      for (std::uint32_t k = file_.face_first[f]; k < file_.face_first[f + 1]; ++k) {
        const std::uint32_t at = file_.face_vertices[k];
        low = std::min(low, file_.flat[at].y()), high = std::max(high, file_.flat[at].y());
        const auto [on_wall, on_ground] = on_card(at);
        wall = wall && on_wall, ground = ground && on_ground;
      }
      if (wall || ground) continue;
      const std::size_t from = index(low) + 1, to = index(high);
      ++covers[from - 1], --covers[to];
      if (from < to) ++opens[from], --opens[to];
    }
    for (std::size_t k = 0, open = 0, covered = 0; k < v_.size(); ++k) {
      open += static_cast<std::size_t>(opens[k]);
      covered += static_cast<std::size_t>(covers[k]);
      joined_[k] = open > 0 ? 1 : 0;
      structure_[k] = covered > 0 ? 1 : 0;
    }
    for (std::size_t e = 0; e < file_.edges.size(); ++e) {
      const auto [a, b] = file_.edges[e];
      const double v = file_.flat[a].y();
      if (!joins(file_.assignment[e]) || std::abs(v - file_.flat[b].y()) > same_) continue;
      const auto at_a = on_card(a), at_b = on_card(b);
      if (!(at_a[0] && at_b[0]) && !(at_a[1] && at_b[1])) joined_[index(v)] = 1;
    }
  }

  const FoldModel& file_;
  const Pose& pose_;
  std::vector<double> v_;
  double same_{}, reach_{};
  std::vector<std::uint8_t> joined_;     ///< one a border
  std::vector<std::uint8_t> structure_;  ///< one a stretch between borders
};

/// What lies between a slice and the next one; Blank: a plain cut, and the next one is blank.
enum class Between : std::uint8_t { Connector, Cut, Bridge, Blank };

/// Finds the strips of slices on the sheet. A pattern can have plain cuts and bridges beyond those
/// of its spec, and a slice without neighbours lies in two halves with its own connector between
/// them. So each boundary is a connector, a cut or a bridge, and among all ways to lay the slices
/// that fill the sheet the one is taken that best agrees with the pattern's borders.
///
/// A bridge connects slices whose levels do not pair. It takes half of each slice strip beside it.
/// Bridges are not measured, because they follow the target only where planes of both sides allow
/// it.
///
/// A slice can be blank, plain card of its whole width, if the target is not there or too small.
/// Slices beside it leave to it what they leave to a bridge.
class Layout {
 public:
  Layout(std::span<const TargetSlice> slices, Borders& borders)
      : slices_(slices), borders_(borders) {}

  /// Lays the slices from `begin_mm` to `end_mm`; none if no way fits.
  [[nodiscard]] std::optional<TargetStations> find(double begin_mm, double end_mm) {
    std::vector<Way> ways{{begin_mm, 0.0, -1, Between::Cut, true, Between::Cut},
                          {begin_mm, 0.0, -1, Between::Blank, true, Between::Blank}};
    std::size_t first = 0;
    for (std::size_t j = 0; j < slices_.size(); ++j) {
      const std::size_t last = ways.size();
      for (std::size_t k = first; k < last; ++k) {
        const bool is_last = j + 1 == slices_.size();
        if (ways[k].after == Between::Blank) {
          extend_blank(ways, k, j, Between::Cut);
          if (!is_last) extend_blank(ways, k, j, Between::Blank);
          continue;
        }
        if (is_last) {
          extend(ways, k, j, Between::Cut);
          continue;
        }
        const bool apart = slices_[j].cut_after || slices_[j].units == 1;
        if (!apart) extend(ways, k, j, Between::Connector);
        extend(ways, k, j, Between::Cut);
        extend(ways, k, j, Between::Blank);
        if (slices_[j].units > 1 || slices_[j + 1].units > 1) extend(ways, k, j, Between::Bridge);
      }
      first = last;
      keep_best(ways, first);
    }
    std::int32_t best = -1;
    const double near = 1e-6 * (borders_.last() - borders_.first());
    for (std::size_t k = first; k < ways.size(); ++k)
      if (std::abs(ways[k].v_mm - end_mm) <= near &&
          (best < 0 || ways[k].cost < ways[static_cast<std::size_t>(best)].cost))
        best = static_cast<std::int32_t>(k);
    if (best < 0) return std::nullopt;
    cost_ = ways[static_cast<std::size_t>(best)].cost;
    std::vector<Between> after(slices_.size());
    for (std::size_t j = slices_.size(); j-- > 0;) {
      const Way& way = ways[static_cast<std::size_t>(best)];
      after[j] = way.after;
      best = way.from;
    }
    return stations(after, ways[static_cast<std::size_t>(best)].after, begin_mm);
  }

  /// How badly the way that was found agrees with the pattern's borders; 0: in every place.
  [[nodiscard]] double cost() const { return cost_; }

 private:
  static constexpr double kWrong = 10.0;  ///< a border that the strips need is not there
  static constexpr double kOdd = 1.0;     ///< panels beside a plain cut that look joined
  static constexpr double kExtra = 0.5;   ///< a cut or bridge that the spec does not ask for
  static constexpr std::size_t kMostWays = 64;

  /// The first slices laid in one way, up to the end of the last one's own strips.
  struct Way {
    double v_mm{};
    double cost{};
    std::int32_t from{-1};
    Between after{};
    bool apart{};  ///< the next slice begins a run
    /// Bridge or Blank: the next slice gives its share to what is before it.
    Between before_next{};
  };

  [[nodiscard]] bool alone(bool apart_before, std::size_t j, Between after) const {
    return slices_[j].units > 1 && apart_before && after != Between::Connector;
  }
  /// What slice j adds to the width of a bridge beside it.
  [[nodiscard]] double share(std::size_t j, bool is_alone) const {
    return slices_[j].units == 1 ? 0.0 : slices_[j].width_mm * (is_alone ? 0.125 : 0.25);
  }
  [[nodiscard]] double own(std::size_t j, bool is_alone) const {
    const TargetSlice& slice = slices_[j];
    return slice.width_mm * (slice.units == 1 ? 1.0 : is_alone ? 0.75 : 0.5);
  }
  [[nodiscard]] double connector(std::size_t j) const {
    return 0.25 * (slices_[j].width_mm + slices_[j + 1].width_mm);
  }
  /// The cost of a border at `v` across which panels connect.
  [[nodiscard]] double joint(double v) {
    return (borders_.at(v) ? 0.0 : kWrong) + (borders_.joined(v) ? 0.0 : kWrong);
  }

  void extend(std::vector<Way>& ways, std::size_t k, std::size_t j, Between after) {
    const Way& before = ways[k];
    const bool is_alone = alone(before.apart, j, after);
    Way way{before.v_mm, before.cost, static_cast<std::int32_t>(k), after, true, Between::Cut};
    if (before.before_next != Between::Cut) way.v_mm += share(j, is_alone);
    if (before.before_next == Between::Bridge) way.cost += joint(way.v_mm);
    const double begin = way.v_mm;
    if (is_alone)
      way.cost +=
          joint(begin + 0.25 * slices_[j].width_mm) + joint(begin + 0.5 * slices_[j].width_mm);
    way.v_mm += own(j, is_alone);
    if (j + 1 < slices_.size()) {
      if (after == Between::Connector) {
        way.cost += joint(way.v_mm);
        way.v_mm += connector(j);
        way.cost += joint(way.v_mm);
        way.apart = false;
      } else if (after == Between::Bridge) {
        way.cost += joint(way.v_mm) + (slices_[j].cut_after ? 0.0 : kExtra);
        way.v_mm += share(j, is_alone);
        way.before_next = Between::Bridge;
      } else if (after == Between::Blank) {
        way.v_mm += share(j, is_alone);
        if (!borders_.at(way.v_mm - share(j, is_alone))) way.cost += kWrong;
      } else {
        // Boxes of the same size beside each other show no border at all.
        const bool boxes = slices_[j].units == 1 && slices_[j + 1].units == 1;
        if (!boxes)
          way.cost += (borders_.at(way.v_mm) ? 0.0 : kWrong) +
                      (borders_.joined(way.v_mm) ? kOdd : 0.0) +
                      (slices_[j].cut_after ? 0.0 : kExtra);
      }
    }
    ways.push_back(way);
  }

  /// Lays slice j blank, if there is nothing but card.
  void extend_blank(std::vector<Way>& ways, std::size_t k, std::size_t j, Between after) {
    const Way& before = ways[k];
    const double end = before.v_mm + slices_[j].width_mm;
    if (!borders_.plain(before.v_mm, end)) return;
    ways.push_back({end, before.cost, static_cast<std::int32_t>(k), after, true,
                    after == Between::Blank ? Between::Cut : Between::Blank});
  }

  /// Removes ways from `first` on that lead to the same place as a better one, and the worst of too
  /// many.
  void keep_best(std::vector<Way>& ways, std::size_t first) const {
    const auto begin = ways.begin() + static_cast<std::ptrdiff_t>(first);
    const auto same = [&](const Way& a, const Way& b) {
      return a.apart == b.apart && a.before_next == b.before_next &&
             (a.after == Between::Blank) == (b.after == Between::Blank) &&
             std::abs(a.v_mm - b.v_mm) <= borders_.same();
    };
    std::stable_sort(begin, ways.end(), [](const Way& a, const Way& b) { return a.cost < b.cost; });
    auto kept = begin;
    for (auto it = begin; it != ways.end(); ++it) {
      if (static_cast<std::size_t>(kept - begin) == kMostWays) break;
      if (std::none_of(begin, kept, [&](const Way& way) { return same(way, *it); })) *kept++ = *it;
    }
    ways.erase(kept, ways.end());
  }

  [[nodiscard]] TargetStations stations(const std::vector<Between>& after, Between before,
                                        double begin_mm) const {
    TargetStations out;
    double v = begin_mm;
    bool apart = true, gives = false;
    for (std::size_t j = 0; j < slices_.size(); before = after[j++]) {
      if (before == Between::Blank) {
        v += slices_[j].width_mm;
        apart = gives = true;
        continue;
      }
      const double w = slices_[j].width_mm, s = slices_[j].s_mm;
      const bool is_alone = alone(apart, j, after[j]);
      // A slice that stands alone in halves has one curve, from all of its width.
      const auto take = [&](double width, double at_s, double reach) {
        const TargetStation made{v, v + width, at_s, reach};
        v += width;
        return made;
      };
      if (gives) v += share(j, is_alone);
      out.slices.push_back(take(is_alone ? 0.25 * w : own(j, false), s, 0.5 * w));
      const std::size_t left = out.slices.size() - 1;
      if (slices_[j].units == 1) {
        out.connectors.push_back({out.slices.back(), left, left});
      } else if (is_alone) {
        out.connectors.push_back({take(0.25 * w, s, 0.5 * w), left, left + 1});
        out.slices.push_back(take(0.25 * w, s, 0.5 * w));
      }
      if (j + 1 == slices_.size()) break;
      if (after[j] == Between::Connector)
        out.connectors.push_back(
            {take(connector(j), s + (3.0 * w + slices_[j + 1].width_mm) / 8.0, 0.5 * connector(j)),
             left, left + 1});
      gives = after[j] == Between::Bridge;
      if (gives || after[j] == Between::Blank) v += share(j, is_alone);
      apart = after[j] != Between::Connector;
    }
    return out;
  }

  std::span<const TargetSlice> slices_;
  Borders& borders_;
  double cost_{};
};

/// The widths of the strips between the margins, alternating slice and connector.
std::vector<TargetSlice> shown_slices(int units, double begin_mm, double end_mm, Borders& borders) {
  std::vector<TargetSlice> out;
  std::vector<double> width;
  double last = begin_mm;
  for (const double v : borders.all()) {
    if (v <= begin_mm + borders.same() || v > end_mm + borders.same()) continue;
    width.push_back(v - last);
    last = v;
  }
  double v = begin_mm;
  for (std::size_t k = 0; k < width.size(); ++k) {
    v += width[k];
    if (units == 1) {
      out.push_back({width[k], 1, false, 0.0});
      continue;
    }
    const bool connector = k + 2 < width.size() && borders.joined(v);
    out.push_back({2.0 * width[k], units, !connector, 0.0});
    if (connector) v += width[++k];
  }
  place_slices(out);
  return out;
}

/// The strips' width if all slices are connected, and with every slice apart.
struct WidthRange {
  double least_mm{}, most_mm{};
};
WidthRange widths_of(std::span<const TargetSlice> slices) {
  // A slice takes at least half its width, and at most all of it with what it adds to connectors.
  WidthRange out;
  for (const TargetSlice& slice : slices) {
    out.least_mm += slice.width_mm * (slice.units == 1 ? 1.0 : 0.5);
    out.most_mm += slice.width_mm;
  }
  return out;
}

}  // namespace

Result<std::vector<TargetStations>> find_stations(const FoldModel& file, const Pose& pose,
                                                  const Target& target) {
  Borders borders(file, pose);
  if (borders.empty()) return fail(ErrorKind::CheckFailed, "", "the pattern has no vertices");
  const double same = 1e-6 * (borders.last() - borders.first());
  const auto inside = [&](std::size_t first, std::size_t last) {
    return std::array{borders.first() + target.patches[first].margin_mm,
                      borders.last() - target.patches[last].margin_mm};
  };
  if (target.chosen_units > 0) {
    const auto [begin, end] = inside(0, 0);
    const auto slices = shown_slices(target.chosen_units, begin, end, borders);
    if (auto found = Layout(slices, borders).find(begin, end))
      return std::vector<TargetStations>{std::move(*found)};
    return fail(ErrorKind::Infeasible, "/widths_mm",
                "the widths that popcut chose cannot be read off this pattern; give the list of "
                "widths that report.json shows");
  }
  std::vector<TargetStations> out;
  double least_cost = std::numeric_limits<double>::infinity();
  const std::size_t patches = target.patches.size();
  for (std::size_t first = 0; first < patches; ++first) {
    for (std::size_t last = first; last < patches && out.size() < kMostCandidates; ++last) {
      const auto slices = target.slices_of(first, last);
      const auto [begin, end] = inside(first, last);
      const WidthRange range = widths_of(slices);
      if (range.least_mm > end - begin + same) break;
      if (slices.empty() || range.most_mm < end - begin - same) continue;
      Layout layout(slices, borders);
      auto found = layout.find(begin, end);
      if (!found || layout.cost() > least_cost) continue;
      if (layout.cost() < least_cost) out.clear();
      least_cost = layout.cost();
      found->first_patch = first, found->last_patch = last;
      out.push_back(std::move(*found));
    }
  }
  if (!out.empty()) return out;
  const WidthRange all = widths_of(target.slices);
  const auto [begin, end] = inside(0, patches - 1);
  return fail(ErrorKind::CheckFailed, "",
              fmt::format("the pattern's strips cover {:.6g} mm of the spine, and the {:.6g} mm of "
                          "slices of the spec cannot be laid on them; is it the spec of this "
                          "pattern?",
                          end - begin, all.most_mm));
}

}  // namespace popcut::verify
