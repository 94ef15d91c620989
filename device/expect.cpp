// SPDX-License-Identifier: MIT
#include "device/expect.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/plan/segment_grid.hpp"
#include "device/fold_chains.hpp"
#include "device/window.hpp"

namespace popcut {
namespace {

constexpr double kFloatNoiseMm = 1e-5;  // a sheet's file has 1e-6 mm
constexpr std::size_t kShown = 20;

/// A stretch of a line, mm along it.
struct Stretch {
  double from{}, to{};
};

/// A straight part of an expected line.
struct Wanted {
  Segment segment;
  double length{};
  double offset{};  ///< of its start along its line; of a fold, along its whole straight run
  std::uint32_t line{};
  bool fold{};  ///< to be dashed
};

/// A straight part of a stroke.
struct Drawn {
  Segment segment;
  double length{};
  std::uint32_t stroke{};
};

/// Stretch `on` of a wanted segment that a drawn segment runs along.
struct Cover {
  std::uint32_t wanted{};
  Stretch on;
};

/// Where `b` runs along `a`, as stretches of both; none if they only cross or touch. The ends of `b`
/// lie within `reach` along each axis of where they should, so beside `a` it is at most
/// reach (|cos| + |sin|) of the direction of `a`.
struct Along {
  Stretch a, b;
};

std::optional<Along> run_along(const Segment& a, double a_length, const Segment& b,
                               double reach) {
  const double ux = (a.b.x - a.a.x) / a_length;
  const double uy = (a.b.y - a.a.y) / a_length;
  const auto project = [&](PagePoint p) { return (p.x - a.a.x) * ux + (p.y - a.a.y) * uy; };
  const double s0 = project(b.a);
  const double s1 = project(b.b);
  const double from = std::max(0.0, std::min(s0, s1));
  const double to = std::min(a_length, std::max(s0, s1));
  const bool long_enough = to - from > std::sqrt(2.0) * reach || to - from > 0.5 * a_length;
  if (!long_enough || !(to > from)) return std::nullopt;
  // At both ends of the common stretch the two must be together: a mere crossing is not.
  const auto parameter = [&](double s) { return (s - s0) / (s1 - s0); };
  const auto apart = [&](double s) {
    return distance(along(a.a, a.b, s / a_length), along(b.a, b.b, parameter(s)));
  };
  const double aside = reach * (std::abs(ux) + std::abs(uy));
  if (apart(from) > aside || apart(to) > aside) return std::nullopt;
  const double b_length = distance(b.a, b.b);
  const double t0 = parameter(from) * b_length;
  const double t1 = parameter(to) * b_length;
  return Along{{from, to}, {std::min(t0, t1), std::max(t0, t1)}};
}

/// Vertices of the drawing: is one within half a unit of a point, along each axis?
class VertexGrid {
 public:
  VertexGrid(std::vector<PagePoint> points, double reach) : points_(std::move(points)), reach_(reach) {
    std::sort(points_.begin(), points_.end(), [&](PagePoint a, PagePoint b) {
      const double ca = column(a.x);
      const double cb = column(b.x);
      return ca != cb ? ca < cb : a.y < b.y;
    });
  }

  [[nodiscard]] bool near(PagePoint p) const {
    for (double c = column(p.x - reach_); c <= column(p.x + reach_); ++c) {
      const auto from = std::lower_bound(points_.begin(), points_.end(), p.y - reach_,
                                         [&](PagePoint q, double y) {
                                           const double cq = column(q.x);
                                           return cq != c ? cq < c : q.y < y;
                                         });
      for (auto it = from; it != points_.end() && column(it->x) == c && it->y <= p.y + reach_; ++it)
        if (std::abs(it->x - p.x) <= reach_) return true;
    }
    return false;
  }

 private:
  [[nodiscard]] double column(double x) const { return std::floor(x / (4 * reach_)); }
  std::vector<PagePoint> points_;
  double reach_;
};

class Check {
 public:
  Check(const Trace& trace, const Expected& expected)
      : trace_(trace), expected_(expected), drawing_(expected.drawing),
        reach_(trace.unit_mm / 2 + kFloatNoiseMm), slack_(std::sqrt(2.0) * reach_) {}

  Comparison run() {
    list_wanted(drawing_, wanted_, true);
    list_wanted(expected_.also_lawful, lawful_, false);
    find_fold_runs();
    list_drawn();
    compare_strokes();
    std::sort(covers_.begin(), covers_.end(), [](const Cover& a, const Cover& b) {
      return a.wanted != b.wanted ? a.wanted < b.wanted : a.on.from < b.on.from;
    });
    compare_lines();
    if (trace_.clipped_mm > kFloatNoiseMm)
      fail_with(fmt::format("{:.3f} mm fell outside the machine's window and was not cut",
                            trace_.clipped_mm));
    return std::move(result_);
  }

 private:
  void fail_with(std::string words) {
    ++result_.failed;
    if (result_.failures.size() < kShown) result_.failures.push_back(std::move(words));
  }

  void list_wanted(const LineWork& work, std::vector<Wanted>& list, bool count) {
    for (std::uint32_t i = 0; i < work.lines.size(); ++i) {
      const auto points = work.points_of(work.lines[i]);
      const bool fold = is_fold(work.lines[i].operation) && !work.dashed;
      double offset = 0;
      for (std::size_t k = 1; k < points.size(); ++k) {
        const double l = distance(points[k - 1], points[k]);
        if (!(l > 0)) continue;
        list.push_back({{points[k - 1], points[k]}, l, offset, i, fold});
        offset += l;
      }
      if (count) result_.expected_mm += offset;
    }
  }

  void list_drawn() {
    for (std::uint32_t i = 0; i < trace_.strokes.size(); ++i) {
      const auto points = trace_.points_of(trace_.strokes[i]);
      double drawn = 0;
      for (std::size_t k = 1; k < points.size(); ++k) {
        const double l = distance(points[k - 1], points[k]);
        if (!(l > 0)) continue;
        drawn_.push_back({{points[k - 1], points[k]}, l, i});
        drawn += l;
      }
      result_.drawn_mm += drawn;
      if (drawn == 0 && !points.empty())
        fail_with(fmt::format("stroke {} is a mere dot at ({:.3f}, {:.3f}) mm", i,
                              points.front().x, points.front().y));
    }
  }

  static std::vector<Segment> segments(const std::vector<Wanted>& list) {
    std::vector<Segment> out;
    out.reserve(list.size());
    for (const Wanted& wanted : list) out.push_back(wanted.segment);
    return out;
  }

  void find_fold_runs();
  void compare_strokes();
  void check_vertices(const Drawn& drawn, const std::vector<Stretch>& on_fold,
                      const std::vector<Stretch>& on_lawful, const VertexGrid& vertices);
  void compare_lines();
  void compare_cut(std::uint32_t index, std::span<const Cover> covers, SegmentGrid& grid);
  void compare_fold(std::span<const std::uint32_t> parts, SegmentGrid& grid);
  void covers_of(std::uint32_t wanted, std::vector<Stretch>& out) const;
  [[nodiscard]] PagePoint place(const Wanted& wanted, double s) const {
    return along(wanted.segment.a, wanted.segment.b, s / wanted.length);
  }
  void find_clearances(std::span<const std::uint32_t> parts, SegmentGrid& grid);
  void check_gap(std::uint32_t line, PagePoint at, Stretch gap);

  const Trace& trace_;
  const Expected& expected_;
  const LineWork& drawing_;
  double reach_;  ///< along each axis
  double slack_;  ///< in any direction
  std::vector<Wanted> wanted_, lawful_;
  std::vector<Drawn> drawn_;
  std::vector<Cover> covers_;
  std::vector<std::vector<std::uint32_t>> fold_runs_;  ///< into `wanted_`, in order along the fold
  std::vector<Stretch> clear_;  ///< stretches of the fold at hand that may stay bare
  mutable std::vector<std::uint32_t> near_;
  Comparison result_;
};

bool inside_any(const std::vector<Stretch>& stretches, double s, double slack) {
  return std::any_of(stretches.begin(), stretches.end(), [&](const Stretch& stretch) {
    return s >= stretch.from - slack && s <= stretch.to + slack;
  });
}

/// Folds are often drawn in parts, and dashed as a whole.
void Check::find_fold_runs() {
  std::vector<FoldPart> parts;
  std::vector<std::uint32_t> index;
  for (std::uint32_t i = 0; i < wanted_.size(); ++i) {
    if (!wanted_[i].fold) continue;
    parts.push_back({wanted_[i].segment,
                     static_cast<int>(drawing_.lines[wanted_[i].line].operation)});
    index.push_back(i);
  }
  for (const FoldChain& chain : chain_folds(parts)) {
    std::vector<std::uint32_t> run;
    double offset = 0;
    for (std::size_t k = 0; k < chain.parts.size(); ++k) {
      Wanted& part = wanted_[index[chain.parts[k]]];
      if (chain.turned[k]) std::swap(part.segment.a, part.segment.b);
      part.offset = offset;
      offset += part.length;
      run.push_back(index[chain.parts[k]]);
    }
    fold_runs_.push_back(std::move(run));
  }
}

/// Each stroke must run along expected lines, with its vertices where theirs are.
void Check::compare_strokes() {
  SegmentGrid grid(segments(wanted_), slack_);
  SegmentGrid lawful_grid(segments(lawful_), slack_);
  const VertexGrid vertices({drawing_.points.begin(), drawing_.points.end()}, reach_);
  std::vector<Stretch> on, on_fold, on_lawful;
  for (const Drawn& drawn : drawn_) {
    on.clear(), on_fold.clear(), on_lawful.clear();
    grid.near(drawn.segment, near_);
    for (const std::uint32_t index : near_) {
      const Wanted& wanted = wanted_[index];
      const auto common = run_along(wanted.segment, wanted.length, drawn.segment, reach_);
      if (!common) continue;
      covers_.push_back({index, common->a});
      on.push_back(common->b);
      if (wanted.fold) on_fold.push_back(common->b);
    }
    lawful_grid.near(drawn.segment, near_);
    for (const std::uint32_t index : near_) {
      const Wanted& wanted = lawful_[index];
      const auto common = run_along(wanted.segment, wanted.length, drawn.segment, reach_);
      if (!common) continue;
      on.push_back(common->b);
      on_lawful.push_back(common->b);
    }
    std::sort(on.begin(), on.end(), [](Stretch a, Stretch b) { return a.from < b.from; });
    double reached = 0;
    for (const Stretch& stretch : on) {
      if (stretch.from > reached + 2 * slack_) break;
      reached = std::max(reached, stretch.to);
    }
    if (reached < drawn.length - 2 * slack_) {
      const PagePoint at = along(drawn.segment.a, drawn.segment.b, reached / drawn.length);
      fail_with(fmt::format("stroke {} draws at ({:.3f}, {:.3f}) mm, where nothing is to be drawn",
                            drawn.stroke, at.x, at.y));
      continue;
    }
    check_vertices(drawn, on_fold, on_lawful, vertices);
  }
}

void Check::check_vertices(const Drawn& drawn, const std::vector<Stretch>& on_fold,
                           const std::vector<Stretch>& on_lawful, const VertexGrid& vertices) {
  for (const bool end : {false, true}) {
    const PagePoint p = end ? drawn.segment.b : drawn.segment.a;
    const double s = end ? drawn.length : 0;
    if (vertices.near(p) || inside_any(on_fold, s, kFloatNoiseMm) ||
        inside_any(on_lawful, s, kFloatNoiseMm))
      continue;
    fail_with(fmt::format("stroke {} has a vertex at ({:.3f}, {:.3f}) mm, more than half a unit of "
                          "{:g} mm beside the drawing's", drawn.stroke, p.x, p.y, trace_.unit_mm));
    return;
  }
}

void Check::covers_of(std::uint32_t wanted, std::vector<Stretch>& out) const {
  const auto first = std::lower_bound(
      covers_.begin(), covers_.end(), wanted,
      [](const Cover& cover, std::uint32_t index) { return cover.wanted < index; });
  for (auto it = first; it != covers_.end() && it->wanted == wanted; ++it) out.push_back(it->on);
}

void Check::compare_lines() {
  SegmentGrid grid(segments(wanted_), std::max(slack_, 2 * expected_.dashes.clearance_mm));
  std::size_t cover = 0;
  for (std::uint32_t i = 0; i < wanted_.size(); ++i) {
    if (wanted_[i].fold) continue;
    while (cover < covers_.size() && covers_[cover].wanted < i) ++cover;
    std::size_t end = cover;
    while (end < covers_.size() && covers_[end].wanted == i) ++end;
    compare_cut(i, std::span(covers_).subspan(cover, end - cover), grid);
    cover = end;
  }
  for (const std::vector<std::uint32_t>& run : fold_runs_) compare_fold(run, grid);
}

/// Each place of a cut is covered as often as it is to be. Steps of coverage may lie within the
/// slack of where they should.
void Check::compare_cut(std::uint32_t index, std::span<const Cover> covers, SegmentGrid& grid) {
  const Wanted& wanted = wanted_[index];
  struct Step {
    double at{};
    int by{};
  };
  std::vector<Step> steps;
  for (const Cover& cover : covers) {
    steps.push_back({cover.on.from, 1});
    steps.push_back({cover.on.to, -1});
  }
  if (drawing_.dashed) {
    grid.near(wanted.segment, near_);
    for (const std::uint32_t other : near_) {
      const auto common =
          run_along(wanted.segment, wanted.length, wanted_[other].segment, kFloatNoiseMm);
      if (!common) continue;
      steps.push_back({common->a.from, -1});
      steps.push_back({common->a.to, 1});
    }
  } else {
    const int passes = is_fold(drawing_.lines[wanted.line].operation) ? expected_.fold_passes
                                                                      : expected_.cut_passes;
    steps.push_back({0, -passes});
    steps.push_back({wanted.length, passes});
  }
  std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) { return a.at < b.at; });
  int excess = 0;
  for (std::size_t k = 0; k + 1 < steps.size(); ++k) {
    excess += steps[k].by;
    if (excess == 0 || steps[k + 1].at - steps[k].at <= 2 * slack_) continue;
    const PagePoint at = place(wanted, steps[k].at);
    fail_with(fmt::format("line {} ({}) is {} from {:.3f} to {:.3f} mm of its length, at ({:.3f}, "
                          "{:.3f}) mm", wanted.line,
                          operation_name(drawing_.lines[wanted.line].operation),
                          excess < 0 ? "not cut" : "cut more often than it should be",
                          wanted.offset + steps[k].at, wanted.offset + steps[k + 1].at, at.x, at.y));
    return;
  }
}

/// Stretches of a fold that may stay bare: at its ends, at its corners, and where cuts come near.
/// Lengths are along the whole fold; stretches under a cut count too.
void Check::find_clearances(std::span<const std::uint32_t> parts, SegmentGrid& grid) {
  clear_.clear();
  const double room = 2 * expected_.dashes.clearance_mm;  // a cut at a slant needs up to twice
  const Wanted& last = wanted_[parts.back()];
  clear_.push_back({-room, room});
  for (const std::uint32_t part : parts) {
    const Wanted& fold = wanted_[part];
    grid.near(fold.segment, near_);
    for (const std::uint32_t other : near_) {
      const Wanted& cut = wanted_[other];
      if (cut.fold) continue;
      if (const auto common = run_along(fold.segment, fold.length, cut.segment, reach_)) {
        clear_.push_back({fold.offset + common->a.from, fold.offset + common->a.to});
        continue;
      }
      // Nearest place of the cut to the fold, as a stretch of the fold.
      const auto s_of = [&](PagePoint p) {
        return ((p.x - fold.segment.a.x) * (fold.segment.b.x - fold.segment.a.x) +
                (p.y - fold.segment.a.y) * (fold.segment.b.y - fold.segment.a.y)) / fold.length;
      };
      const Window corridor{0, -room, fold.length, room};
      const auto turned = [&](PagePoint p) {
        const double dx = (fold.segment.b.x - fold.segment.a.x) / fold.length;
        const double dy = (fold.segment.b.y - fold.segment.a.y) / fold.length;
        return PagePoint{s_of(p), (p.y - fold.segment.a.y) * dx - (p.x - fold.segment.a.x) * dy};
      };
      const PagePoint a = turned(cut.segment.a);
      const PagePoint b = turned(cut.segment.b);
      const auto inside = clip({corridor.left - room, corridor.top, corridor.right + room,
                                corridor.bottom}, a, b);
      if (!inside) continue;
      const double from = along(a, b, inside->from).x;
      const double to = along(a, b, inside->to).x;
      clear_.push_back({fold.offset + std::min(from, to) - room,
                        fold.offset + std::max(from, to) + room});
    }
  }
  clear_.push_back({last.offset + last.length - room, last.offset + last.length + room});
  std::sort(clear_.begin(), clear_.end(), [](Stretch a, Stretch b) { return a.from < b.from; });
}

/// A bare stretch is lawful if it is no longer than a gap, or if what clearance leaves of it has no
/// room for a dash.
void Check::check_gap(std::uint32_t line, PagePoint at, Stretch gap) {
  const DashShape& shape = expected_.dashes;
  if (gap.to - gap.from <= shape.gap_mm + 2 * slack_) return;
  double free_from = gap.from;
  double free = 0;
  for (const Stretch& stretch : clear_) {
    if (stretch.from >= gap.to) break;
    free = std::max(free, std::min(stretch.from, gap.to) - free_from);
    free_from = std::max(free_from, stretch.to);
  }
  free = std::max(free, gap.to - free_from);
  if (free <= shape.min_dash_mm + 2 * slack_) return;
  fail_with(fmt::format("line {} ({}) is not dashed from {:.3f} to {:.3f} mm of its length, more "
                        "than a gap of {:g} mm; near ({:.3f}, {:.3f}) mm", line,
                        operation_name(drawing_.lines[line].operation), gap.from, gap.to,
                        shape.gap_mm, at.x, at.y));
}

void Check::compare_fold(std::span<const std::uint32_t> parts, SegmentGrid& grid) {
  const std::uint32_t line = wanted_[parts.front()].line;
  const DashShape& shape = expected_.dashes;
  const double whole = wanted_[parts.back()].offset + wanted_[parts.back()].length;
  find_clearances(parts, grid);
  std::vector<Stretch> dashes, part_dashes;
  for (const std::uint32_t part : parts) {
    part_dashes.clear();
    covers_of(part, part_dashes);
    for (const Stretch& d : part_dashes)
      dashes.push_back({wanted_[part].offset + d.from, wanted_[part].offset + d.to});
  }
  std::sort(dashes.begin(), dashes.end(), [](Stretch a, Stretch b) { return a.from < b.from; });
  // What lies under a cut belongs to the cut.
  const auto under_cut = [&](double s) {
    for (const std::uint32_t part : parts) {
      const Wanted& fold = wanted_[part];
      if (s < fold.offset || s > fold.offset + fold.length) continue;
      grid.near(fold.segment, near_);
      for (const std::uint32_t other : near_) {
        if (wanted_[other].fold) continue;
        const auto common =
            run_along(fold.segment, fold.length, wanted_[other].segment, reach_);
        if (common && s >= fold.offset + common->a.from && s <= fold.offset + common->a.to)
          return true;
      }
    }
    return false;
  };
  const auto place_on = [&](double s) {
    for (const std::uint32_t part : parts)
      if (s <= wanted_[part].offset + wanted_[part].length)
        return place(wanted_[part], std::max(0.0, s - wanted_[part].offset));
    return wanted_[parts.back()].segment.b;
  };
  const double end_paper = 0.5 * shape.clearance_mm;
  if (!dashes.empty() && !under_cut(dashes.front().from) && !under_cut(dashes.back().to) &&
      (dashes.front().from < end_paper || dashes.back().to > whole - end_paper)) {
    const PagePoint at = place_on(dashes.front().from < end_paper ? 0 : whole);
    fail_with(fmt::format("line {} ({}) is cut up to its end at ({:.3f}, {:.3f}) mm", line,
                          operation_name(drawing_.lines[line].operation), at.x, at.y));
    return;
  }
  double reached = 0;
  double solid_from = 0;
  int layers = 0;
  for (std::size_t k = 0; k <= dashes.size(); ++k) {
    const double from = k < dashes.size() ? dashes[k].from : whole;
    if (from > reached + 2 * slack_) {
      check_gap(line, place_on(reached), {reached, from});
      solid_from = from;
      layers = 0;
    }
    if (k == dashes.size()) break;
    const bool again = dashes[k].from < reached - 2 * slack_;
    layers = again ? layers + 1 : layers;
    reached = std::max(reached, dashes[k].to);
    const bool too_often = layers >= expected_.fold_passes;
    const bool solid = reached - solid_from > shape.dash_mm + shape.gap_mm + 2 * slack_;
    if ((too_often || solid) && !under_cut((solid_from + reached) / 2)) {
      const PagePoint at = place_on(solid_from);
      fail_with(fmt::format("line {} ({}) is {} from {:.3f} to {:.3f} mm of its length, at ({:.3f}, "
                            "{:.3f}) mm", line, operation_name(drawing_.lines[line].operation),
                            too_often ? "dashed more often than it should be" : "cut solid",
                            solid_from, reached, at.x, at.y));
      return;
    }
  }
}

}  // namespace

Comparison compare(const Trace& trace, const Expected& expected) {
  return Check(trace, expected).run();
}

Result<void> expect(const Trace& trace, const Expected& expected) {
  const Comparison result = compare(trace, expected);
  if (result.failed == 0) return {};
  std::string words;
  for (const std::string& failure : result.failures) {
    if (!words.empty()) words += "; ";
    words += failure;
  }
  if (result.failed > result.failures.size())
    words += fmt::format("; and {} more", result.failed - result.failures.size());
  return fail(ErrorKind::CheckFailed, "", words);
}

}  // namespace popcut
