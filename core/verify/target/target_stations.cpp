// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/verify/target/target.hpp"

namespace popcut::verify {
namespace {

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

 private:
  void find_joined() {
    joined_.assign(v_.size() + 1, 0);
    const auto on_card = [&](std::uint32_t k) {
      const FoldVertex p = unposed(pose_.at[k], *pose_.psi_rad);
      return std::array{std::abs(p.x) <= 1e-9 * reach_, std::abs(p.z) <= 1e-9 * reach_};
    };
    // A face is one piece, so it goes through every border between its ends.
    std::vector<int> opens(v_.size() + 2);
    for (std::size_t f = 0; f < file_.faces(); ++f) {
      double low = v_.back(), high = v_.front();
      bool wall = true, ground = true;
      for (std::uint32_t k = file_.face_first[f]; k < file_.face_first[f + 1]; ++k) {
        const std::uint32_t at = file_.face_vertices[k];
        low = std::min(low, file_.flat[at].y()), high = std::max(high, file_.flat[at].y());
        const auto [on_wall, on_ground] = on_card(at);
        wall = wall && on_wall, ground = ground && on_ground;
      }
      const std::size_t from = index(low) + 1, to = index(high);
      if (wall || ground || from >= to) continue;
      ++opens[from], --opens[to];
    }
    for (std::size_t k = 0, open = 0; k < v_.size(); ++k) {
      open += static_cast<std::size_t>(opens[k]);
      joined_[k] = open > 0;
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
  std::vector<std::uint8_t> joined_;
};

/// Lays out the slices from left to right: the stations, and where the last strip ends.
struct LaidOut {
  TargetStations stations;
  double end_mm{};
};

/// With `borders`, a plain cut across which panels connect is a bridge: a connector between slices
/// whose levels do not pair, half as wide as the two slice strips beside it together. Bridges are
/// not measured, because they follow the target only where planes of both sides allow it.
LaidOut lay_out(const std::vector<TargetSlice>& slices, double begin_mm,
                Borders* borders = nullptr) {
  const auto is_alone = [&](std::size_t j) {
    return slices[j].units > 1 && (j + 1 == slices.size() || slices[j].cut_after) &&
           (j == 0 || slices[j - 1].cut_after);
  };
  const auto bridge_share = [&](std::size_t j) {
    return slices[j].units == 1 ? 0.0 : slices[j].width_mm * (is_alone(j) ? 0.125 : 0.25);
  };
  LaidOut out;
  TargetStations& st = out.stations;
  double v = begin_mm, s = 0.0;
  const auto take = [&](double width) {
    const TargetStation made{v, v + width, s};
    v += width;
    return made;
  };
  for (std::size_t j = 0; j < slices.size(); ++j) {
    const double w = slices[j].width_mm;
    const bool last = j + 1 == slices.size();
    const bool apart = last || slices[j].cut_after || slices[j].units == 1;
    const bool alone = apart && (j == 0 || slices[j - 1].cut_after);
    if (slices[j].units == 1) {
      st.slices.push_back(take(w));
      const std::size_t own = st.slices.size() - 1;
      st.connectors.push_back({st.slices.back(), own, own});
    } else if (alone) {
      st.slices.push_back(take(0.25 * w));
      const std::size_t left = st.slices.size() - 1;
      st.connectors.push_back({take(0.25 * w), left, left + 1});
      st.slices.push_back(take(0.25 * w));
    } else {
      st.slices.push_back(take(0.5 * w));
    }
    if (last) break;
    const double next = slices[j + 1].width_mm;
    if (!apart) {
      const std::size_t left = st.slices.size() - 1;
      TargetStation connector = take(0.25 * (w + next));
      connector.s_mm = s + (3.0 * w + next) / 8.0;
      st.connectors.push_back({connector, left, left + 1});
    }
    if (slices[j].cut_after && borders != nullptr && borders->joined(v))
      v += bridge_share(j) + bridge_share(j + 1);
    s += 0.5 * (w + next);
  }
  out.end_mm = v;
  return out;
}

/// The slices with the plain cuts that the pattern has beyond those of the spec.
std::vector<TargetSlice> with_shown_cuts(std::vector<TargetSlice> slices, double begin_mm,
                                         Borders& borders) {
  double v = begin_mm;
  for (std::size_t j = 0; j + 1 < slices.size(); ++j) {
    TargetSlice& slice = slices[j];
    const double w = slice.width_mm;
    if (slice.units == 1) {
      v += w;
      continue;
    }
    const bool starts = j == 0 || slices[j - 1].cut_after || slices[j - 1].units == 1;
    // A slice without neighbours has two halves: its first strip is half as wide, a connector
    // follows, and nothing connects after the last one.
    if (starts && borders.at(v + 0.25 * w) && borders.joined(v + 0.25 * w) &&
        !borders.joined(v + 0.75 * w)) {
      slice.cut_after = true;
      v += 0.75 * w;
      continue;
    }
    v += 0.5 * w;
    slice.cut_after = slice.cut_after || !borders.joined(v);
    if (!slice.cut_after) v += 0.25 * (w + slices[j + 1].width_mm);
  }
  return slices;
}

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
      out.push_back({width[k], 1, false});
      continue;
    }
    const bool connector = k + 2 < width.size() && borders.joined(v);
    out.push_back({2.0 * width[k], units, !connector});
    if (connector) v += width[++k];
  }
  return out;
}

}  // namespace

Result<TargetStations> find_stations(const FoldModel& file, const Pose& pose,
                                     const Target& target) {
  Borders borders(file, pose);
  if (borders.empty()) return fail(ErrorKind::CheckFailed, "", "the pattern has no vertices");
  const double begin = borders.first() + target.margin_mm, end = borders.last() - target.margin_mm;
  const bool chosen = target.slices.empty();
  const std::vector<TargetSlice> slices =
      chosen ? shown_slices(target.chosen_units, begin, end, borders) : target.slices;
  LaidOut laid = lay_out(slices, begin);
  const double same = 1e-6 * (borders.last() - borders.first());
  if (std::abs(laid.end_mm - end) <= same) return std::move(laid.stations);
  LaidOut bridged = lay_out(slices, begin, &borders);
  if (std::abs(bridged.end_mm - end) <= same) return std::move(bridged.stations);
  const LaidOut cut = lay_out(with_shown_cuts(slices, begin, borders), begin);
  if (std::abs(cut.end_mm - end) <= same) return cut.stations;
  return fail(ErrorKind::CheckFailed, "",
              fmt::format("the pattern's strips cover {:.6g} mm of the spine, those of the spec "
                          "{:.6g} mm; is it the spec of this pattern?",
                          end - begin, laid.end_mm - begin));
}

}  // namespace popcut::verify
