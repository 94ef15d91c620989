// SPDX-License-Identifier: MIT
#include "core/design/strips/strip_builder.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace popcut {
namespace {

void write_plain(const CardFrame& frame, StripKind kind, int slice, double width_mm,
                 StripWriter& writer) {
  writer.start(0.0, frame.wall_mm);
  writer.panel_to(0.0, 0.0, kWallPlane);
  writer.panel_to(frame.ground_mm, 0.0, kGroundPlane);
  writer.close(kind, slice, width_mm);
}

void write_margin(const CardFrame& frame, StripWriter& writer) {
  write_plain(frame, StripKind::Margin, -1, frame.margin_mm, writer);
}

/// What a slice strip leaves to the connector that does not follow it; boxes have their full width.
double left_over(const std::vector<LaidSlice>& laid, const Run& run, int slice_of_run) {
  if (run.planes.units == 1) return 0.0;
  return 0.25 * laid[static_cast<std::size_t>(run.first + slice_of_run)].width_mm;
}

/// The blank slices before run r (after the last one: r is their number), from `next` on.
void write_blanks(const std::vector<LaidSlice>& laid, const std::vector<Run>& runs, std::size_t r,
                  const StripOptions& options, std::size_t& next, StripWriter& writer) {
  const std::vector<BlankSlice>& blanks = options.blanks;
  const std::size_t first = next;
  for (; next < blanks.size() && blanks[next].before_run == r; ++next) {
    double width = blanks[next].width_mm;
    if (next == first && r > 0) width += left_over(laid, runs[r - 1], runs[r - 1].count - 1);
    const bool is_last = next + 1 == blanks.size() || blanks[next + 1].before_run != r;
    if (is_last && r < runs.size()) width += left_over(laid, runs[r], 0);
    write_plain(options.frame, StripKind::Blank, blanks[next].slice, width, writer);
  }
}

/// One run on its way to strips.
class RunLayer {
 public:
  RunLayer(const std::vector<LaidSlice>& laid, const Run& run, PlaneId first_plane,
           const StripOptions& options, std::vector<MergedPlace>& merged, std::vector<int>& apart)
      : laid_(laid),
        run_(run),
        first_plane_(first_plane),
        options_(options),
        merged_(merged),
        apart_(apart),
        n_(run.planes.units),
        dead_(run.planes.value.size(), 0) {}

  void lay(StripWriter& writer) {
    for (int j = 0; j < run_.count; ++j) reduce_slice(j);
    for (int k = 0; k + 1 < run_.count; ++k) levels_.push_back(connector_levels(k, false));
    drop_unheld();
    for (int j = 0; j < run_.count; ++j) {
      if (j > 0) lay_connector(writer, j - 1);
      lay_slice(writer, j);
    }
  }

 private:
  [[nodiscard]] const LaidSlice& slice(int j) const {
    return laid_[static_cast<std::size_t>(run_.first + j)];
  }
  [[nodiscard]] std::size_t at(int j, int i) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(n_ + 1) +
           static_cast<std::size_t>(i);
  }
  [[nodiscard]] PlaneId plane(int j, int i) const {
    return first_plane_ + static_cast<PlaneId>(at(j, i));
  }
  [[nodiscard]] bool is_loose(const std::vector<std::uint8_t>& loose, int j, int i) const {
    return !loose.empty() && loose[at(j, i)] != 0;
  }
  [[nodiscard]] bool is_ended(int j, int i) const { return run_.planes.value[at(j, i)] == 0.0; }

  /// The last level at which slice j's own X planes have ended at the wall; -1 for none.
  [[nodiscard]] int wall_level(int j) const {
    for (int i = n_; i >= 0; --i)
      if (!Planes::holds_height(j, i) && is_ended(j, i)) return i;
    return -1;
  }
  /// The first level at which its Z planes have ended at the ground; N + 1 for none.
  [[nodiscard]] int ground_level(int j, int after) const {
    for (int i = after + 1; i <= n_; ++i)
      if (Planes::holds_height(j, i) && is_ended(j, i)) return i;
    return n_ + 1;
  }

  void note(int j, int level, const char* where, std::string reason) {
    merged_.push_back({slice(j).slice, level, where, std::move(reason)});
  }
  [[nodiscard]] std::string too_short(double step) const {
    return fmt::format("a step of {:.4g} mm is under min_panel_mm = {:g}", step,
                       options_.min_panel_mm);
  }

  /// Leaves pairs of planes (a height and the offset after it) out of slice j until each panel of
  /// its strip is at least min_panel long.
  void reduce_slice(int j) {
    const int first = wall_level(j) + 1, last = ground_level(j, first - 1) - 1;
    for (int i = 0; i <= n_; ++i)
      if (i < first || i > last) dead_[at(j, i)] = 1;
    const auto drop = [&](int i, double step) {
      dead_[at(j, i)] = dead_[at(j, i + 1)] = 1;
      note(j, i, "slice", too_short(step));
    };
    double x = 0.0, z = options_.frame.wall_mm;
    bool any = false;
    std::vector<int> pairs;
    for (int i = first; i < last; i += 2) {
      const double height = run_.planes.value[at(j, i)], offset = run_.planes.value[at(j, i + 1)];
      const double step = std::min(offset - x, any ? z - height : options_.min_panel_mm);
      if (is_loose(run_.loose_planes, j, i) || is_loose(run_.loose_planes, j, i + 1)) {
        dead_[at(j, i)] = dead_[at(j, i + 1)] = 1;
        note(j, i, "slice", "nothing would hold its panels there");
        continue;
      }
      if (step < options_.min_panel_mm) {
        drop(i, step);
        continue;
      }
      x = offset, z = height, any = true;
      pairs.push_back(i);
    }
    while (!pairs.empty()) {
      const int kept = pairs.back();
      const double height = run_.planes.value[at(j, kept)];
      if (height >= options_.min_panel_mm) break;
      drop(kept, height);
      pairs.pop_back();
    }
  }

  void begin_strip(StripWriter& writer, double first_height, PlaneId wall_plane, double wall_end,
                   bool has_own_wall) const {
    if (options_.frame.card) {
      writer.start(0.0, options_.frame.wall_mm);
      writer.panel_to(0.0, first_height, kWallPlane, -1);
    } else if (has_own_wall && wall_end - first_height >= options_.min_panel_mm) {
      writer.start(0.0, wall_end);
      writer.panel_to(0.0, first_height, wall_plane, 0);
    } else {
      writer.start(0.0, first_height);
    }
  }
  void end_strip(StripWriter& writer, double last_offset, PlaneId ground_plane, double ground_end,
                 bool has_own_ground) const {
    if (options_.frame.card)
      writer.panel_to(options_.frame.ground_mm, 0.0, kGroundPlane, -1);
    else if (has_own_ground && ground_end - last_offset >= options_.min_panel_mm)
      writer.panel_to(ground_end, 0.0, ground_plane, n_);
  }

  void lay_slice(StripWriter& writer, int j) {
    double height = 0.0, x = 0.0;
    bool begun = false;
    for (int i = 0; i <= n_; ++i) {
      if (dead_[at(j, i)] != 0) continue;
      const double value = run_.planes.value[at(j, i)];
      if (Planes::holds_height(j, i)) {
        if (!begun) {
          begin_strip(writer, value, plane(j, 0), end_of(options_.wall_ends, j),
                      !Planes::holds_height(j, 0));
        } else {
          writer.panel_to(x, value, plane(j, last_), last_);  // down the offset before it
        }
        height = value, begun = true;
      } else {
        writer.panel_to(value, height, plane(j, last_), last_);  // along the height before it
        x = value;
      }
      last_ = i;
    }
    if (!begun) {  // nothing is left of the slice but wall and ground
      begin_strip(writer, 0.0, plane(j, 0), end_of(options_.wall_ends, j), true);
    } else {
      writer.panel_to(x, 0.0, plane(j, last_), last_);
    }
    end_strip(writer, x, plane(j, n_), end_of(options_.ground_ends, j),
              Planes::holds_height(j, n_));
    writer.close(StripKind::Slice, slice(j).slice, 0.5 * slice(j).width_mm);
  }

  /// Where slice j ends at the wall or the ground without a card, by what its own level 0 or N
  /// holds: its strip has a loose panel there.
  [[nodiscard]] double end_of(const std::vector<double>& ends, int j) const {
    return ends.empty() ? 0.0 : ends[static_cast<std::size_t>(run_.first + j)];
  }

  [[nodiscard]] static int height_holder(int j, int i) {
    return Planes::holds_height(j, i) ? j : j + 1;
  }
  [[nodiscard]] static int offset_holder(int j, int i) {
    return Planes::holds_height(j, i) ? j + 1 : j;
  }

  /// The levels that the connector after slice j uses: the first stands on the wall, the last on
  /// the ground, and each step between is at least min_panel long. Empty where there is no such
  /// connector.
  [[nodiscard]] std::vector<int> connector_levels(int j, bool say) {
    const auto vertex = [&](int i) { return run_.planes.vertex(j, i); };
    int first = 0, last = n_;
    for (int i = 0; i <= n_; ++i)
      if (vertex(i).x == 0.0) first = i;
    for (int i = n_; i > first; --i)
      if (vertex(i).z == 0.0) last = i;
    // Only planes that the slices have can be joined: the first height, the last offset.
    while (first < last && dead_[at(height_holder(j, first), first)] != 0) ++first;
    while (last > first && dead_[at(offset_holder(j, last), last)] != 0) --last;
    if (first == last || vertex(last).x < options_.min_panel_mm ||
        vertex(first).z < options_.min_panel_mm)
      return {};
    std::vector<int> kept{first};
    // The first level's offset is the wall, the last one's height the ground.
    const auto step = [&](int a, int b) {
      return std::min(vertex(b).x - (a == first ? 0.0 : vertex(a).x),
                      vertex(a).z - (b == last ? 0.0 : vertex(b).z));
    };
    for (int i = first + 1; i < last; ++i) {
      const bool gone =
          dead_[at(j, i)] != 0 || dead_[at(j + 1, i)] != 0 || is_loose(run_.loose_levels, j, i);
      const double short_step = step(kept.back(), i);
      if (!gone && short_step >= options_.min_panel_mm)
        kept.push_back(i);
      else if (say)
        note(j, i, "connector", gone ? "its slices have no such panels" : too_short(short_step));
    }
    while (kept.size() > 1 && step(kept.back(), last) < options_.min_panel_mm) {
      if (say) note(j, kept.back(), "connector", too_short(step(kept.back(), last)));
      kept.pop_back();
    }
    kept.push_back(last);
    return kept;
  }

  /// What a slice's panel along a plane and a connector's panel in the same plane have in common.
  struct Overlap {
    double length_mm{};      ///< 0: the connector has no such panel, or beside it
    bool ends_with_slice{};  ///< at its end; else the slice's panel begins last
  };
  /// The overlap of connector k with `low .. high`, the reach of slice j's panel in its plane i.
  [[nodiscard]] Overlap overlap(int k, int j, int i, double low, double high) const {
    if (k < 0 || k + 1 >= run_.count) return {};
    const std::vector<int>& levels = levels_[static_cast<std::size_t>(k)];
    const auto it = std::lower_bound(levels.begin(), levels.end(), i);
    if (it == levels.end() || *it != i) return {};
    double from = 0.0, to = 0.0;
    if (Planes::holds_height(j, i)) {
      if (it + 1 == levels.end()) return {};
      from = it == levels.begin() ? 0.0 : run_.planes.vertex(k, i).x;
      to = run_.planes.vertex(k, *(it + 1)).x;
      return {std::min(to, high) - std::max(from, low), high < to};
    }
    if (it == levels.begin()) return {};
    from = it + 1 == levels.end() ? 0.0 : run_.planes.vertex(k, i).z;
    to = run_.planes.vertex(k, *(it - 1)).z;
    return {std::min(to, high) - std::max(from, low), low > from};
  }

  /// Leaves a pair of planes out of slice j where its joint with a connector would be too narrow:
  /// the one at `q` of its `own` and the one that ends it. Whether there was one.
  bool drop_neck(int j, const std::vector<int>& own, std::size_t q, double low, double high) {
    for (const int k : {j - 1, j}) {
      const Overlap shared = overlap(k, j, own[q], low, high);
      if (shared.length_mm <= 0.0 || is_joint(shared.length_mm, options_.min_panel_mm)) continue;
      const bool with_next = q == 0 || (shared.ends_with_slice && q + 1 < own.size());
      if (own.size() < 2 || (with_next && q + 1 == own.size())) return false;
      const std::size_t first = with_next ? q : q - 1;
      dead_[at(j, own[first])] = dead_[at(j, own[first + 1])] = 1;
      note(j, own[first], "slice",
           fmt::format("a joint of {:.4g} mm is under min_panel_mm = {:g}", shared.length_mm,
                       options_.min_panel_mm));
      return true;
    }
    return false;
  }

  /// A slice's planes that no connector joins hang between those that are joined. One or two in a
  /// row are held by their neighbours, a third would swing freely: pairs are left out until two are
  /// left. What a slice loses its connectors lose too, so the neighbours are looked at again.
  void drop_unheld() {
    std::vector<int> work, own, hanging;
    for (int j = run_.count; run_.count > 1 && j-- > 0;) work.push_back(j);
    while (!work.empty()) {
      const int j = work.back();
      work.pop_back();
      own.clear();
      for (int i = 0; i <= n_; ++i)
        if (dead_[at(j, i)] == 0) own.push_back(i);
      bool dropped = false;
      hanging.clear();
      for (std::size_t q = 0; q <= own.size(); ++q) {
        if (q < own.size()) {
          // A height reaches between the offsets beside it, an offset between the heights.
          const double before = q > 0 ? run_.planes.value[at(j, own[q - 1])] : 0.0;
          const double after = q + 1 < own.size() ? run_.planes.value[at(j, own[q + 1])] : 0.0;
          const double low = std::min(before, after), high = std::max(before, after);
          if (drop_neck(j, own, q, low, high)) {
            dropped = true;
            break;
          }
          if (overlap(j - 1, j, own[q], low, high).length_mm <= 0.0 &&
              overlap(j, j, own[q], low, high).length_mm <= 0.0) {
            hanging.push_back(own[q]);
            continue;
          }
        }
        for (std::size_t k = 1; k + 1 < hanging.size(); k += 2) {
          dead_[at(j, hanging[k])] = dead_[at(j, hanging[k + 1])] = 1;
          note(j, hanging[k], "slice", "nothing would hold its panels there");
          dropped = true;
        }
        hanging.clear();
      }
      if (!dropped) continue;
      for (const int k : {j - 1, j})
        if (k >= 0 && k + 1 < run_.count)
          levels_[static_cast<std::size_t>(k)] = connector_levels(k, false);
      for (const int other : {j - 1, j, j + 1})
        if (other >= 0 && other < run_.count) work.push_back(other);
    }
  }

  void lay_connector(StripWriter& writer, int j) {
    const std::vector<int> levels = connector_levels(j, true);
    if (levels.empty()) {
      apart_.push_back(run_.first + j);
      return;
    }
    const auto height = [&](int i) { return run_.planes.value[at(height_holder(j, i), i)]; };
    const auto offset = [&](int i) { return run_.planes.value[at(offset_holder(j, i), i)]; };
    begin_strip(writer, height(levels.front()), -1, 0.0, false);
    for (std::size_t k = 1; k < levels.size(); ++k) {
      const int a = levels[k - 1], b = levels[k];
      writer.panel_to(offset(b), height(a), plane(height_holder(j, a), a), a);
      const bool at_ground = k + 1 == levels.size();
      writer.panel_to(offset(b), at_ground ? 0.0 : height(b), plane(offset_holder(j, b), b), b);
    }
    end_strip(writer, offset(levels.back()), -1, 0.0, false);
    writer.close(StripKind::Connector, slice(j).slice,
                 0.25 * (slice(j).width_mm + slice(j + 1).width_mm));
  }

  const std::vector<LaidSlice>& laid_;
  const Run& run_;
  PlaneId first_plane_;
  const StripOptions& options_;
  std::vector<MergedPlace>& merged_;
  std::vector<int>& apart_;
  int n_;
  std::vector<std::uint8_t> dead_;        ///< planes that no strip of the slice has
  std::vector<std::vector<int>> levels_;  ///< of each connector
  int last_{-1};
};

/// N = 1: one box a slice of its full width. Equal neighbours share their planes.
void lay_boxes(const std::vector<LaidSlice>& laid, const Run& run, PlaneId first_plane,
               const StripOptions& options, StripWriter& writer) {
  PlaneId top = first_plane, front = first_plane + 1;
  double last_h = -1.0, last_d = -1.0;
  for (int j = 0; j < run.count; ++j) {
    // Planes of a box: `at(j, 0)` its height and `at(j, 1)` its offset, whatever the parity.
    const double h = run.planes.at(j, 0), d = run.planes.at(j, 1);
    if (h != last_h) top = first_plane + 2 * j;
    if (d != last_d) front = first_plane + 2 * j + 1;
    last_h = h, last_d = d;
    const LaidSlice& slice = laid[static_cast<std::size_t>(run.first + j)];
    if (options.frame.card) {
      writer.start(0.0, options.frame.wall_mm);
      writer.panel_to(0.0, h, kWallPlane, -1);
    } else {
      writer.start(0.0, h);
    }
    writer.panel_to(d, h, top, 0);
    writer.panel_to(d, 0.0, front, 1);
    if (options.frame.card) writer.panel_to(options.frame.ground_mm, 0.0, kGroundPlane);
    writer.close(StripKind::Box, slice.slice, slice.width_mm);
  }
}

[[nodiscard]] bool is_height(const Run& run, int slice, int level) {
  return run.planes.units == 1 ? level == 0 : Planes::holds_height(slice, level);
}

/// Planes and ends that agree but for rounding become equal.
void unify(std::vector<Run>& runs, StripOptions& options) {
  std::vector<double*> heights, offsets;
  for (Run& run : runs)
    for (int j = 0; j < run.count; ++j)
      for (int i = 0; i <= run.planes.units; ++i)
        (is_height(run, j, i) ? heights : offsets).push_back(&run.planes.at(j, i));
  for (double& end : options.wall_ends) heights.push_back(&end);
  for (double& end : options.ground_ends) offsets.push_back(&end);
  unify_places(heights);
  unify_places(offsets);
}

}  // namespace

LaidStrips build_strips(const std::vector<LaidSlice>& laid, std::vector<Run> runs,
                        StripOptions options) {
  LaidStrips out;
  unify(runs, options);
  StripWriter writer;
  const bool margins = options.frame.card && options.frame.margin_mm > 0.0;
  if (margins) write_margin(options.frame, writer);
  PlaneId next_plane = kGroundPlane + 1;
  std::size_t next_blank = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const Run& run = runs[r];
    write_blanks(laid, runs, r, options, next_blank, writer);
    if (run.planes.units == 1)
      lay_boxes(laid, run, next_plane, options, writer);
    else
      RunLayer(laid, run, next_plane, options, out.merged, out.apart).lay(writer);
    next_plane += static_cast<PlaneId>(run.planes.value.size());
  }
  write_blanks(laid, runs, runs.size(), options, next_blank, writer);
  if (margins) write_margin(options.frame, writer);
  out.strips = writer.take();
  unify_planes(out.strips);
  return out;
}

Reach reach_of(const std::vector<Run>& runs) {
  Reach reach;
  for (const Run& run : runs)
    for (int j = 0; j < run.count; ++j)
      for (int i = 0; i <= run.planes.units; ++i) {
        double& most = is_height(run, j, i) ? reach.wall_mm : reach.ground_mm;
        most = std::max(most, run.planes.at(j, i));
      }
  return reach;
}

}  // namespace popcut
