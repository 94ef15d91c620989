// SPDX-License-Identifier: MIT
#include "device/compare/expect.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/drawing/clean.hpp"
#include "core/geometry/segment_grid.hpp"
#include "core/plan/knife/blade.hpp"
#include "device/compare/fold_chains.hpp"
#include "device/compare/fold_check.hpp"
#include "device/compare/run_along.hpp"
#include "device/sim/window.hpp"

namespace popcut {
namespace {

constexpr double kFloatNoiseMm = 1e-5;  // a sheet's file has 1e-6 mm
constexpr double kTipMm = 0.05;         // error of a trailing tip by rounding and chords
constexpr std::size_t kShown = 20;

/// A straight part of an expected line.
struct Wanted {
  Segment segment;
  double length{};
  double offset{};  ///< of its start along its line; of a fold, along its whole straight run
  std::uint32_t line{};
  bool fold{};  ///< should be dashed
};

/// A straight part of a stroke.
struct Drawn {
  Segment segment;
  double length{};
  std::uint32_t stroke{};
};

/// The stretch of a wanted segment that a drawn segment covers.
struct Cover {
  std::uint32_t wanted{};
  Stretch on;
};

/// Where along a line its coverage changes, or how often it should be covered.
struct Step {
  double at{};
  int by{};
  int spare{};  ///< how often it may be covered in addition
};

/// A stretch of a line on which a line of `operation` lies, perhaps itself.
struct Lying {
  Stretch on;
  PenOperation operation;
  bool dashed{};
};

class Check {
 public:
  Check(const Trace& trace, const Expected& expected)
      : trace_(trace),
        expected_(expected),
        drawing_(expected.drawing),
        reach_(trace.unit_mm / 2 + kFloatNoiseMm + (by_tip() ? kTipMm : 0.0)),
        slack_(std::sqrt(2.0) * reach_) {}

  Comparison run() {
    list_wanted(drawing_, wanted_, true);
    list_wanted(expected_.also_allowed, allowed_, false);
    find_fold_runs();
    list_drawn();
    compare_strokes();
    cover_by_allowed();
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
      const bool fold = is_fold(work.lines[i].operation) && !work.dashed && !expected_.folds_whole;
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

  /// Calls `use(stretch)` for what allowed lines cover of wanted segment `index`.
  template <typename Use>
  void each_allowed(std::uint32_t index, Use&& use) const {
    const auto first =
        std::lower_bound(allowed_covers_.begin(), allowed_covers_.end(), index,
                         [](const Cover& cover, std::uint32_t i) { return cover.wanted < i; });
    for (auto it = first; it != allowed_covers_.end() && it->wanted == index; ++it) use(it->on);
  }

  [[nodiscard]] bool by_tip() const {
    return expected_.blade_offset_mm > 0 && expected_.blade_tools != 0;
  }

  /// The stroke's path of the tip.
  std::span<const PagePoint> drawn_points(const TraceStroke& stroke, Blade& blade) {
    const auto points = trace_.points_of(stroke);
    if (!by_tip() || (expected_.blade_tools >> stroke.tool & 1) == 0) return points;
    tip_ = without_straight_vertices(tip_path(points, blade), kTipMm / 2);
    return tip_;
  }

  void list_drawn() {
    Blade blade{.offset_mm = expected_.blade_offset_mm};
    for (std::uint32_t i = 0; i < trace_.strokes.size(); ++i) {
      const auto points = drawn_points(trace_.strokes[i], blade);
      double drawn = 0;
      for (std::size_t k = 1; k < points.size(); ++k) {
        const double l = distance(points[k - 1], points[k]);
        if (!(l > 0)) continue;
        drawn_.push_back({{points[k - 1], points[k]}, l, i});
        drawn += l;
      }
      result_.drawn_mm += drawn;
      if (drawn == 0 && !points.empty())
        fail_with(fmt::format("stroke {} is only a dot at ({:.3f}, {:.3f}) mm", i, points.front().x,
                              points.front().y));
    }
  }

  static std::vector<Segment> segments(const std::vector<Wanted>& list) {
    std::vector<Segment> out;
    out.reserve(list.size());
    for (const Wanted& wanted : list) out.push_back(wanted.segment);
    return out;
  }

  /// Many lines on each other are all near each other. False once that has cost too much.
  [[nodiscard]] bool affordable(std::size_t near) {
    if (near <= budget_) {
      budget_ -= near;
      return true;
    }
    if (!given_up_) fail_with("too many lines lie on each other to compare them");
    given_up_ = true;
    budget_ = 0;
    return false;
  }
  void find_fold_runs();
  void compare_strokes();
  void cover_by_allowed();
  void check_vertices(const Drawn& drawn, const std::vector<Stretch>& on_fold,
                      const std::vector<Stretch>& on_allowed, const VertexGrid& vertices);
  void compare_lines();
  [[nodiscard]] int passes_of(PenOperation operation) const;
  void add_passes(std::uint32_t index, SegmentGrid& grid, std::vector<Step>& steps);
  void compare_cut(std::uint32_t index, std::span<const Cover> covers, SegmentGrid& grid);
  void compare_fold(std::span<const std::uint32_t> run, SegmentGrid& grid);
  [[nodiscard]] FoldState state_of(std::span<const std::uint32_t> run, SegmentGrid& grid);
  void find_cuts_near(const Wanted& fold, SegmentGrid& grid, FoldState& state);
  void covers_of(std::uint32_t wanted, std::vector<Stretch>& out) const;
  [[nodiscard]] PagePoint place(const Wanted& wanted, double s) const {
    return along(wanted.segment.a, wanted.segment.b, s / wanted.length);
  }

  const Trace& trace_;
  const Expected& expected_;
  const LineWork& drawing_;
  double reach_;  ///< along each axis
  double slack_;  ///< in any direction
  std::vector<Wanted> wanted_, allowed_;
  std::vector<Drawn> drawn_;
  std::vector<PagePoint> tip_;
  std::vector<Cover> covers_;
  std::vector<Cover> allowed_covers_;                  ///< of wanted segments, by `also_allowed`
  std::vector<std::vector<std::uint32_t>> fold_runs_;  ///< into `wanted_`, in order along the fold
  std::vector<std::uint32_t> near_;
  std::size_t budget_{200'000'000};
  bool given_up_{false};
  Comparison result_;
};

bool inside_any(const std::vector<Stretch>& stretches, double s, double slack) {
  return std::any_of(stretches.begin(), stretches.end(), [&](const Stretch& stretch) {
    return s >= stretch.from - slack && s <= stretch.to + slack;
  });
}

/// A fold is often drawn in parts but dashed as a whole.
void Check::find_fold_runs() {
  std::vector<FoldPart> parts;
  std::vector<std::uint32_t> index;
  for (std::uint32_t i = 0; i < wanted_.size(); ++i) {
    if (!wanted_[i].fold) continue;
    const PenOperation operation = drawing_.lines[wanted_[i].line].operation;
    parts.push_back(
        {wanted_[i].segment, static_cast<int>(operation.operation) * 256 + operation.pen});
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
  SegmentGrid allowed_grid(segments(allowed_), slack_);
  std::vector<PagePoint> places = drawing_.points;
  places.insert(places.end(), expected_.also_allowed.points.begin(),
                expected_.also_allowed.points.end());
  const VertexGrid vertices(std::move(places), reach_);
  std::vector<Stretch> on, on_fold, on_allowed;
  for (const Drawn& drawn : drawn_) {
    on.clear(), on_fold.clear(), on_allowed.clear();
    grid.near(drawn.segment, near_);
    if (!affordable(near_.size())) return;
    for (const std::uint32_t index : near_) {
      const Wanted& wanted = wanted_[index];
      const auto common = run_along(wanted.segment, drawn.segment, reach_);
      if (!common) continue;
      covers_.push_back({index, common->a});
      on.push_back(common->b);
      if (wanted.fold) on_fold.push_back(common->b);
    }
    allowed_grid.near(drawn.segment, near_);
    if (!affordable(near_.size())) return;
    for (const std::uint32_t index : near_) {
      const Wanted& wanted = allowed_[index];
      const auto common = run_along(wanted.segment, drawn.segment, reach_);
      if (!common) continue;
      on.push_back(common->b);
      on_allowed.push_back(common->b);
    }
    std::sort(on.begin(), on.end(), [](Stretch a, Stretch b) { return a.from < b.from; });
    double reached = 0;
    for (const Stretch& stretch : on) {
      if (stretch.from > reached + 2 * slack_) break;
      reached = std::max(reached, stretch.to);
    }
    if (reached < drawn.length - 2 * slack_) {
      const PagePoint at = along(drawn.segment.a, drawn.segment.b, reached / drawn.length);
      fail_with(fmt::format("stroke {} draws at ({:.3f}, {:.3f}) mm, where nothing should be drawn",
                            drawn.stroke, at.x, at.y));
      continue;
    }
    if (!by_tip()) check_vertices(drawn, on_fold, on_allowed, vertices);
  }
}

/// Expected lines may be covered once more where allowed lines run along them.
void Check::cover_by_allowed() {
  if (allowed_.empty()) return;
  SegmentGrid grid(segments(wanted_), slack_);
  for (const Wanted& allowed : allowed_) {
    grid.near(allowed.segment, near_);
    if (!affordable(near_.size())) return;
    for (const std::uint32_t index : near_)
      if (const auto common = run_along(wanted_[index].segment, allowed.segment, reach_))
        allowed_covers_.push_back({index, common->a});
  }
  std::sort(allowed_covers_.begin(), allowed_covers_.end(),
            [](const Cover& a, const Cover& b) { return a.wanted < b.wanted; });
}

void Check::check_vertices(const Drawn& drawn, const std::vector<Stretch>& on_fold,
                           const std::vector<Stretch>& on_allowed, const VertexGrid& vertices) {
  for (const bool end : {false, true}) {
    const PagePoint p = end ? drawn.segment.b : drawn.segment.a;
    const double s = end ? drawn.length : 0;
    if (vertices.near(p) || inside_any(on_fold, s, kFloatNoiseMm) ||
        inside_any(on_allowed, s, kFloatNoiseMm))
      continue;
    fail_with(
        fmt::format("stroke {} has a vertex at ({:.3f}, {:.3f}) mm, more than half a unit of "
                    "{:g} mm away from the drawing's",
                    drawn.stroke, p.x, p.y, trace_.unit_mm));
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

/// How often a line is to be cut.
int Check::passes_of(PenOperation operation) const {
  const std::size_t pen = operation.pen;
  if (pen > 0 && pen <= expected_.pen_passes.size() && expected_.pen_passes[pen - 1] > 0)
    return expected_.pen_passes[pen - 1];
  switch (operation.operation) {
    case Operation::Score:
      return expected_.score_passes;
    case Operation::Draw:
      return expected_.draw_passes;
    default:
      return is_fold(operation) ? expected_.fold_passes : expected_.cut_passes;
  }
}

/// How often a line is to be covered. Where lines of several operations lie on each other, the
/// strongest of the knife and the stylus takes the place, and what the pen draws comes on top.
void Check::add_passes(std::uint32_t index, SegmentGrid& grid, std::vector<Step>& steps) {
  const Wanted& wanted = wanted_[index];
  const PenOperation own = drawing_.lines[wanted.line].operation;
  std::vector<Lying> here{{{0, wanted.length}, own, false}};
  grid.near(wanted.segment, near_);
  if (!affordable(near_.size())) return;
  for (const std::uint32_t other : near_) {
    const PenOperation operation = drawing_.lines[wanted_[other].line].operation;
    if (operation == own) continue;
    if (const auto common = run_along(wanted.segment, wanted_[other].segment, kOverlapTolerance))
      here.push_back({common->a, operation, wanted_[other].fold});
  }
  std::vector<double> ends;
  for (const Lying& line : here) ends.insert(ends.end(), {line.on.from, line.on.to});
  std::sort(ends.begin(), ends.end());
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
    const double middle = (ends[k] + ends[k + 1]) / 2;
    const auto strongest = [&](bool pen) {
      const Lying* found = nullptr;
      for (const Lying& line : here)
        if ((line.operation == Operation::Draw) == pen && line.on.from <= middle &&
            middle <= line.on.to &&
            (found == nullptr || line.operation.operation > found->operation.operation))
          found = &line;
      return found;
    };
    for (const bool pen : {false, true}) {
      const Lying* first = strongest(pen);
      if (first == nullptr) continue;
      // Of several pens for one operation, any may be the one.
      int least = passes_of(first->operation), most = least;
      for (const Lying& line : here)
        if (line.operation.operation == first->operation.operation && line.on.from <= middle &&
            middle <= line.on.to) {
          least = std::min(least, passes_of(line.operation));
          most = std::max(most, passes_of(line.operation));
        }
      if (first->dashed) least = 0;
      steps.push_back({ends[k], -least, most - least});
      steps.push_back({ends[k + 1], least, least - most});
    }
  }
}

/// Each place of a cut must be covered as often as requested. Where the coverage changes may be off
/// by the slack.
void Check::compare_cut(std::uint32_t index, std::span<const Cover> covers, SegmentGrid& grid) {
  const Wanted& wanted = wanted_[index];
  std::vector<Step> steps;
  for (const Cover& cover : covers) {
    steps.push_back({cover.on.from, 1, 0});
    steps.push_back({cover.on.to, -1, 0});
  }
  if (drawing_.dashed) {
    grid.near(wanted.segment, near_);
    if (!affordable(near_.size())) return;
    for (const std::uint32_t other : near_) {
      const auto common = run_along(wanted.segment, wanted_[other].segment, kFloatNoiseMm);
      if (!common) continue;
      steps.push_back({common->a.from, -1, 0});
      steps.push_back({common->a.to, 1, 0});
    }
  } else {
    add_passes(index, grid, steps);
  }
  each_allowed(index, [&](const Stretch& on) {
    steps.push_back({on.from, 0, 1});
    steps.push_back({on.to, 0, -1});
  });
  std::sort(steps.begin(), steps.end(), [](const Step& a, const Step& b) { return a.at < b.at; });
  int excess = 0, spare = 0;
  for (std::size_t k = 0; k + 1 < steps.size(); ++k) {
    excess += steps[k].by;
    spare += steps[k].spare;
    if ((excess >= 0 && excess <= spare) || steps[k + 1].at - steps[k].at <= 2 * slack_) continue;
    const PagePoint at = place(wanted, steps[k].at);
    fail_with(
        fmt::format("line {} ({}) is {} from {:.3f} to {:.3f} mm of its length, at ({:.3f}, "
                    "{:.3f}) mm",
                    wanted.line, operation_name(drawing_.lines[wanted.line].operation),
                    excess < 0 ? "not cut" : "cut more often than it should be",
                    wanted.offset + steps[k].at, wanted.offset + steps[k + 1].at, at.x, at.y));
    return;
  }
}

/// Where cuts near a fold leave it bare, and where they run along it. Lengths are along the whole
/// run that `fold` is a part of.
void Check::find_cuts_near(const Wanted& fold, SegmentGrid& grid, FoldState& state) {
  const double room = 2 * expected_.dashes.clearance_mm;  // a cut at a slant needs up to twice
  const double ux = (fold.segment.b.x - fold.segment.a.x) / fold.length;
  const double uy = (fold.segment.b.y - fold.segment.a.y) / fold.length;
  const auto seen_along = [&](PagePoint p) {
    const double dx = p.x - fold.segment.a.x;
    const double dy = p.y - fold.segment.a.y;
    return PagePoint{dx * ux + dy * uy, dy * ux - dx * uy};
  };
  const Window corridor{-room, -room, fold.length + room, room};
  grid.near(fold.segment, near_);
  if (!affordable(near_.size())) return;
  for (const std::uint32_t other : near_) {
    const Wanted& cut = wanted_[other];
    if (cut.fold) continue;
    if (const auto common = run_along(fold.segment, cut.segment, reach_)) {
      const Stretch under{fold.offset + common->a.from, fold.offset + common->a.to};
      state.cut.push_back(under);
      state.bare.push_back(under);
      continue;
    }
    const PagePoint a = seen_along(cut.segment.a);
    const PagePoint b = seen_along(cut.segment.b);
    const auto inside = clip(corridor, a, b);
    if (!inside) continue;
    const double from = along(a, b, inside->from).x;
    const double to = along(a, b, inside->to).x;
    state.bare.push_back(
        {fold.offset + std::min(from, to) - room, fold.offset + std::max(from, to) + room});
  }
}

FoldState Check::state_of(std::span<const std::uint32_t> run, SegmentGrid& grid) {
  const Wanted& last = wanted_[run.back()];
  const double room = 2 * expected_.dashes.clearance_mm;
  FoldState state;
  state.length_mm = last.offset + last.length;
  state.bare.push_back({-room, room});
  state.bare.push_back({state.length_mm - room, state.length_mm + room});
  std::vector<Stretch> on_part;
  for (const std::uint32_t part : run) {
    const Wanted& fold = wanted_[part];
    find_cuts_near(fold, grid, state);
    each_allowed(part, [&](const Stretch& on) {  // scored for want of room for a dash
      state.cut.push_back({fold.offset + on.from - slack_, fold.offset + on.to + slack_});
    });
    on_part.clear();
    covers_of(part, on_part);
    for (const Stretch& dash : on_part)
      state.dashes.push_back({fold.offset + dash.from, fold.offset + dash.to});
  }
  for (std::vector<Stretch>* list : {&state.dashes, &state.bare, &state.cut})
    std::sort(list->begin(), list->end(),
              [](const Stretch& a, const Stretch& b) { return a.from < b.from; });
  return state;
}

void Check::compare_fold(std::span<const std::uint32_t> run, SegmentGrid& grid) {
  int passes = 1;
  for (const std::uint32_t index : run)
    passes = std::max(passes, passes_of(drawing_.lines[wanted_[index].line].operation));
  const auto fault = check_fold(state_of(run, grid), expected_.dashes, passes, 2 * slack_);
  if (!fault) return;
  const auto part = std::find_if(run.begin(), run.end(), [&](std::uint32_t index) {
    return fault->where.from <= wanted_[index].offset + wanted_[index].length;
  });
  const Wanted& fold = wanted_[part == run.end() ? run.back() : *part];
  const PagePoint at = place(fold, std::max(0.0, fault->where.from - fold.offset));
  fail_with(
      fmt::format("line {} ({}) is {} from {:.3f} to {:.3f} mm of its run, at ({:.3f}, "
                  "{:.3f}) mm",
                  fold.line, operation_name(drawing_.lines[fold.line].operation),
                  words_of(fault->kind), fault->where.from, fault->where.to, at.x, at.y));
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
