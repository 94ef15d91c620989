// SPDX-License-Identifier: MIT
#include "core/layout/layout.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <unordered_map>

#include <fmt/format.h>

#include "core/layout/line_index.hpp"
#include "core/layout/marks.hpp"
#include "core/layout/nest.hpp"
#include "core/layout/packing.hpp"
#include "core/layout/partition.hpp"
#include "core/layout/seam_search.hpp"

namespace popcut {
namespace {

constexpr double kMargin = 10.0;  // mm around the pieces on a sheet, where there is room
constexpr int kMostRounds = 60;   // of searching again after a tab found no room
constexpr std::size_t kMostPieces = 10'000;
// Number of segments above which only the cheapest layout is finished.
constexpr std::size_t kLarge = 20'000;

LineWork swapped(LineWork work) {
  for (PagePoint& p : work.points) std::swap(p.x, p.y);
  return work;
}

// The placed tabs in a grid of cells, so that new tabs can keep clear of them.
class PlacedTabs {
 public:
  PlacedTabs(const TabShape& shape, const std::vector<Tab>& tabs)
      : cell_(shape.pitch_mm + 2 * shape.depth_mm),
        clearance_mm_(shape.clearance_mm),
        tabs_(tabs) {}

  [[nodiscard]] bool meets(const Tab& tab) const {
    const auto [cx, cy] = cell(tab);
    for (std::int64_t dx = -1; dx <= 1; ++dx)
      for (std::int64_t dy = -1; dy <= 1; ++dy) {
        const auto found = cells_.find(key(cx + dx, cy + dy));
        if (found == cells_.end()) continue;
        for (const std::uint32_t i : found->second)
          if (tabs_meet(tabs_[i], tab, clearance_mm_)) return true;
      }
    return false;
  }
  void add(std::uint32_t i) {
    const auto [cx, cy] = cell(tabs_[i]);
    cells_[key(cx, cy)].push_back(i);
  }

 private:
  [[nodiscard]] std::pair<std::int64_t, std::int64_t> cell(const Tab& tab) const {
    const PagePoint& p = tab.corners[0];
    return {static_cast<std::int64_t>(std::floor(p.x / cell_)),
            static_cast<std::int64_t>(std::floor(p.y / cell_))};
  }
  static std::uint64_t key(std::int64_t x, std::int64_t y) {
    return static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL ^
           static_cast<std::uint64_t>(y + 0x40000000);
  }
  double cell_, clearance_mm_;
  const std::vector<Tab>& tabs_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

// The seam to ban because `stretch` of `run` has no room for a tab.
BannedSeam ban_for(const SeamRun& run, const SeamStretch& stretch, const Box& box,
                   const TabShape& shape) {
  // Where another seam ends on this one, it is that other seam which leaves too little room.
  const double low = run.vertical ? box.y0 : box.x0, high = run.vertical ? box.y1 : box.x1;
  const bool first = stretch.from <= run.from + kOn && run.from > low + kOn;
  const bool last = stretch.to >= run.to - kOn && run.to < high - kOn;
  const double beside = shape.min_stretch_mm();
  if (run.vertical && (first || last))
    return {false, first ? run.from : run.to, run.at - beside, run.at + beside, beside / 2};
  return {run.vertical, run.at, stretch.from, stretch.to, run.vertical ? kOn : 0.3};
}

// Places tabs on one side of a stretch, clear of those already placed: over its whole length, or
// with space at its ends, where another seam's tabs may lie. Returns the least depth of these tabs,
// 0 if one has no room.
double fit_beside(TabFitter& fitter, const PlacedTabs& placed, const SeamRun& run,
                  const SeamStretch& stretch, int side, const TabShape& shape,
                  std::vector<Tab>& out) {
  const double back = shape.depth_mm + shape.clearance_mm;
  for (const auto& [low, high] : {std::pair{0.0, 0.0}, {back, 0.0}, {0.0, back}, {back, back}}) {
    const SeamStretch part{stretch.from + low, stretch.to - high, 0, 0};
    if (part.to - part.from < shape.min_stretch_mm()) continue;
    out.clear();
    const double depth = fitter.fit({run.vertical, run.at}, part, side, out);
    if (depth > 0.0 &&
        std::none_of(out.begin(), out.end(), [&](const Tab& tab) { return placed.meets(tab); }))
      return depth;
  }
  return 0.0;
}

// Places tabs on every stretch of every run, the short ones first because they have the least
// choice. Returns the seams to ban because a stretch has no room.
std::vector<BannedSeam> place_tabs(std::vector<SeamRun>& runs, LineIndex& lines,
                                   const TabShape& shape, std::vector<Tab>& tabs) {
  struct Task {
    std::uint32_t run{}, stretch{};
    double length{};
  };
  std::vector<Task> tasks;
  for (std::uint32_t r = 0; r < runs.size(); ++r)
    for (std::uint32_t s = 0; s < runs[r].uncut.size(); ++s)
      tasks.push_back({r, s, runs[r].uncut[s].to - runs[r].uncut[s].from});
  std::stable_sort(tasks.begin(), tasks.end(),
                   [](const Task& a, const Task& b) { return a.length < b.length; });
  tabs.clear();
  std::vector<BannedSeam> banned;
  TabFitter fitter(lines, shape);
  PlacedTabs placed(shape, tabs);
  std::array<std::vector<Tab>, 2> tried;
  for (const Task& task : tasks) {
    SeamRun& run = runs[task.run];
    SeamStretch& stretch = run.uncut[task.stretch];
    std::array<double, 2> depth{};
    for (std::size_t side = 0; side < 2; ++side)
      depth[side] =
          fit_beside(fitter, placed, run, stretch, side == 0 ? 1 : -1, shape, tried[side]);
    const std::size_t side = depth[0] >= depth[1] ? 0 : 1;
    if (depth[side] == 0.0) {
      banned.push_back(ban_for(run, stretch, lines.box(), shape));
      continue;
    }
    stretch.first_tab = static_cast<std::uint32_t>(tabs.size());
    stretch.tabs = static_cast<std::uint32_t>(tried[side].size());
    for (Tab& tab : tried[side]) {
      tab.run = task.run;
      // A tab towards larger coordinates lies under the upper piece.
      tab.on = side == 0 ? run.lower : run.upper;
      tab.under = side == 0 ? run.upper : run.lower;
      tabs.push_back(tab);
      placed.add(static_cast<std::uint32_t>(tabs.size() - 1));
    }
  }
  return banned;
}

// One way to lay out the drawing: the direction of the straight seams, and how pieces lie.
struct Arrangement {
  bool swap{};
  SeamSearch search;
  Result<FoundSeams> found{tl::unexpect, Error{}};
  [[nodiscard]] double cost() const {
    return found ? found->cost : std::numeric_limits<double>::infinity();
  }
};

struct Laid {
  bool swap{};
  double cost{};
  Partition partition;
  std::vector<SeamRun> runs;
  std::vector<Tab> tabs;
};

// Tries all arrangements, cheapest first, until one has room for all of its tabs.
class Search {
 public:
  Search(const LineWork& drawing, const LayoutOptions& options)
      : options_(options),
        reach_(options.tabs.depth_mm + options.tabs.clearance_mm + 8.0),
        lines_{LineIndex(drawing, reach_), LineIndex(swapped(drawing), reach_)} {}

  /// Valid layouts: one for each way of laying out a small drawing, only the cheapest for a
  /// large one.
  Result<std::vector<Laid>> run() {
    std::vector<Arrangement> arrangements = all_arrangements();
    std::optional<Error> asked;
    for (Arrangement& arrangement : arrangements) {
      arrangement.found = arrangement.search.find();
      if (!arrangement.found && arrangement.found.error().place.starts_with("/options/"))
        asked = arrangement.found.error();
    }
    std::stable_sort(
        arrangements.begin(), arrangements.end(),
        [](const Arrangement& a, const Arrangement& b) { return a.cost() < b.cost(); });
    const std::size_t wanted = lines_[0].segments().size() > kLarge ? 1 : arrangements.size();
    std::vector<Laid> all;
    for (std::size_t i = 0; i < arrangements.size() && all.size() < wanted; ++i) {
      Arrangement& arrangement = arrangements[i];
      if (!arrangement.found) continue;
      if (arrangement.found->partition.pieces() > kMostPieces)
        return fail(ErrorKind::Infeasible, "",
                    fmt::format("the drawing would need {} pieces, more than {}; use a larger mat",
                                arrangement.found->partition.pieces(), kMostPieces));
      if (auto laid = settle(arrangement)) all.push_back(std::move(*laid));
    }
    if (!all.empty()) return all;
    if (asked) return tl::unexpected(*asked);
    const TabShape& tabs = options_.tabs;
    const bool with_asked = !options_.seams_x.empty() || !options_.seams_y.empty();
    return fail(
        ErrorKind::Infeasible,
        !with_asked                ? ""
        : options_.seams_y.empty() ? "/options/seam-x"
                                   : "/options/seam-y",
        fmt::format(
            "no seams{} split the drawing into pieces of at most {:.1f} x {:.1f} mm with room "
            "for a tab of {:g} mm (at least {:g}) on every stretch; use {}a larger mat, "
            "or a material with smaller tabs",
            with_asked ? " besides the requested ones" : "",
            options_.area_mm[0] - options_.origin.x, options_.area_mm[1] - options_.origin.y,
            tabs.depth_mm, tabs.min_depth_mm, with_asked ? "other seams, " : ""));
  }

  LineIndex& index(bool swap) { return lines_[swap ? 1 : 0]; }

 private:
  LineIndex& index(const Arrangement& arrangement) { return index(arrangement.swap); }

  // Searches again until every stretch has its tabs.
  std::optional<Laid> settle(Arrangement& arrangement) {
    for (int round = 0; round < kMostRounds && arrangement.found; ++round) {
      Laid laid{arrangement.swap, arrangement.cost(), arrangement.found->partition, {}, {}};
      laid.runs = seam_runs(laid.partition, index(arrangement), options_.min_panel_mm);
      const auto banned = place_tabs(laid.runs, index(arrangement), options_.tabs, laid.tabs);
      if (banned.empty()) return laid;
      arrangement.search.ban(banned);
      arrangement.found = arrangement.search.find();
    }
    return std::nullopt;
  }

  std::vector<Arrangement> all_arrangements() {
    const double width = options_.area_mm[0] - options_.origin.x;
    const double height = options_.area_mm[1] - options_.origin.y;
    std::vector<Arrangement> arrangements;
    const bool small = lines_[0].segments().size() <= kLarge;
    for (const int kind : {0, 1, 2, 3, 4, 5, 6, 7}) {
      const bool swap = (kind & 1) != 0, turn = (kind & 2) != 0, full = (kind & 4) != 0;
      if (turn && std::abs(width - height) <= kOn) continue;
      if (full && !small) continue;
      const SearchLimits limits{swap == turn ? width : height,
                                swap == turn ? height : width,
                                options_.tabs,
                                options_.min_panel_mm,
                                swap ? options_.seams_y : options_.seams_x,
                                swap ? options_.seams_x : options_.seams_y,
                                {},
                                swap,
                                full};
      arrangements.push_back({swap, SeamSearch(index(swap), limits)});
    }
    return arrangements;
  }

  const LayoutOptions& options_;
  double reach_;
  std::array<LineIndex, 2> lines_;
};

void unswap(Laid& laid, std::vector<LineWork>& works) {
  for (LineWork& work : works) work = swapped(std::move(work));
  for (SeamRun& run : laid.runs) run.vertical = !run.vertical;
  for (Tab& tab : laid.tabs)
    for (PagePoint& p : tab.corners) std::swap(p.x, p.y);
}

constexpr std::uint32_t kNoPiece = std::numeric_limits<std::uint32_t>::max();

// Names the pieces of runs and tabs as `to` says. Drops runs beyond the paper, or beside it.
void rename_pieces(Laid& laid, const std::vector<std::uint32_t>& to) {
  std::vector<std::uint32_t> run_to;
  std::vector<SeamRun> kept;
  for (SeamRun& run : laid.runs) {
    run.lower = to[run.lower], run.upper = to[run.upper];
    const bool has_paper = run.lower != kNoPiece && run.upper != kNoPiece &&
                           (!run.uncut.empty() || !run.covered.empty());
    run_to.push_back(has_paper ? static_cast<std::uint32_t>(kept.size()) : kNoPiece);
    if (has_paper) kept.push_back(std::move(run));
  }
  laid.runs = std::move(kept);
  for (Tab& tab : laid.tabs)
    tab.run = run_to[tab.run], tab.on = to[tab.on], tab.under = to[tab.under];
  std::erase_if(laid.tabs, [](const Tab& tab) { return tab.run == kNoPiece; });
}

// Makes the pieces with their lines. Drops pieces without any, which lie beyond the paper.
std::vector<SheetPiece> make_pieces(std::vector<LineWork>& works, Laid& laid) {
  std::vector<SheetPiece> pieces;
  std::vector<std::uint32_t> to;
  const Partition& partition = laid.partition;
  for (std::uint32_t c = 0; c < partition.rows.size(); ++c)
    for (std::size_t r = 0; r <= partition.rows[c].size(); ++r) {
      LineWork& work = works[to.size()];
      to.push_back(work.lines.empty() ? kNoPiece : static_cast<std::uint32_t>(pieces.size()));
      if (work.lines.empty()) continue;
      SheetPiece piece;
      piece.work = std::move(work);
      piece.box = bounds(piece.work);
      piece.share = partition.share(c, r);
      if (laid.swap)
        for (PagePoint& p : piece.share) std::swap(p.x, p.y);
      piece.first_mark = static_cast<std::uint32_t>(piece.work.lines.size());
      piece.column = c;
      pieces.push_back(std::move(piece));
    }
  rename_pieces(laid, to);
  return pieces;
}

void name_seams(Layout& layout, std::size_t letters_taken) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> ids;
  for (SeamRun& run : layout.runs) {
    const auto key = std::minmax(run.lower, run.upper);
    const auto [at, fresh] = ids.try_emplace(key, static_cast<std::uint32_t>(layout.seams.size()));
    if (fresh)
      layout.seams.push_back({key.first, key.second, 0.0, seam_label(letters_taken + at->second)});
    run.seam = at->second;
    for (const SeamStretch& stretch : run.uncut)
      layout.seams[run.seam].glue_mm += stretch.to - stretch.from;
  }
  for (const PieceSeam& seam : layout.seams) layout.glue_mm += seam.glue_mm;
}

// Glues the pieces of each column one after the other, then the columns to each other.
void order_glueing(Layout& layout) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> between;
  for (std::uint32_t s = 0; s < layout.seams.size(); ++s) {
    const PieceSeam& seam = layout.seams[s];
    const std::uint32_t a = layout.pieces[seam.lower].column, b = layout.pieces[seam.upper].column;
    if (a == b)
      layout.steps.push_back({s});
    else
      between[std::max(a, b)].push_back(s);
  }
  for (auto& [column, seams] : between) layout.steps.push_back(std::move(seams));
}

/// The area of the sheets that pieces take: the last one as far as they reach along it.
double used_mm2(const std::vector<NestedPiece>& places,
                const std::vector<std::array<double, 2>>& sizes,
                const std::array<double, 2>& area) {
  std::uint32_t last = 0;
  for (const NestedPiece& at : places) last = std::max(last, at.sheet);
  double end = 0.0;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i].sheet == last)
      end = std::max(end, places[i].y + sizes[i][places[i].quarters % 2 == 0 ? 1 : 0]);
  return area[0] * (last * area[1] + end);
}

/// Pieces that nearly fill their boxes are packed as boxes; others are nested by their shapes,
/// where that needs no more sheets.
std::vector<NestedPiece> places_of(Layout& layout, const std::vector<std::array<double, 2>>& sizes,
                                   const std::array<double, 2>& area, double spacing_mm) {
  constexpr double kFull = 0.9;
  constexpr std::size_t kMostNested = 400;  // more take seconds
  const std::vector<PackedBox> packed = pack(sizes, area, spacing_mm);
  std::vector<NestedPiece> rows;
  std::uint32_t sheets = 0;
  for (const PackedBox& box : packed) {
    rows.push_back({box.sheet, box.turned ? 1U : 0U, box.x, box.y});
    sheets = std::max(sheets, box.sheet + 1);
  }
  double boxes = 0.0, paper = 0.0;
  std::vector<const LineWork*> works;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    works.push_back(&layout.pieces[i].work);
    boxes += sizes[i][0] * sizes[i][1], paper += paper_mm2(*works.back());
  }
  SheetUse& use = layout.use;
  use = {paper, used_mm2(rows, sizes, area), used_mm2(rows, sizes, area), sheets};
  if (sizes.size() < 2 || sizes.size() > kMostNested || paper > kFull * boxes) return rows;
  Nest shapes = nest(works, area, spacing_mm);
  if (shapes.sheets > sheets) return rows;
  use.used_mm2 = used_mm2(shapes.places, sizes, area);
  return std::move(shapes.places);
}

/// A box turned by quarters, its upper left corner at a place.
Placement turned_to(const Box& box, std::uint32_t quarters, const PagePoint& at) {
  switch (quarters) {
    case 1:
      return {0, -1, at.x + box.y1, 1, 0, at.y - box.x0};
    case 2:
      return {-1, 0, at.x + box.x1, 0, -1, at.y + box.y1};
    case 3:
      return {0, 1, at.x - box.y0, -1, 0, at.y + box.x1};
    default:
      return {1, 0, at.x - box.x0, 0, 1, at.y - box.y0};
  }
}

Result<void> put_on_sheets(Layout& layout, const LayoutOptions& options) {
  const std::array<double, 2> area{options.area_mm[0] - options.origin.x,
                                   options.area_mm[1] - options.origin.y};
  std::vector<std::array<double, 2>> sizes;
  for (std::size_t i = 0; i < layout.pieces.size(); ++i) {
    const Box& box = layout.pieces[i].box;
    const double w = box.width(), h = box.height();
    const auto fits = [&](double x, double y) { return x <= area[0] + kOn && y <= area[1] + kOn; };
    if (!fits(w, h) && !fits(h, w))
      return fail(
          ErrorKind::Infeasible, "",
          fmt::format("piece {} with its tabs is {:.1f} x {:.1f} mm, but the area holds {:.1f} "
                      "x {:.1f} mm; use a larger mat or shallower tabs",
                      i + 1, w, h, area[0], area[1]));
    sizes.push_back({w, h});
  }
  std::vector<NestedPiece> placed = places_of(layout, sizes, area, options.spacing_mm);
  const auto size_of = [&](std::size_t i) -> std::array<double, 2> {
    const bool is_turned = placed[i].quarters % 2 != 0;
    return {sizes[i][is_turned ? 1 : 0], sizes[i][is_turned ? 0 : 1]};
  };
  // Sheets are numbered in the order of their first pieces.
  std::map<std::uint32_t, std::uint32_t> number;
  for (NestedPiece& at : placed)
    at.sheet =
        number.try_emplace(at.sheet, static_cast<std::uint32_t>(number.size())).first->second;
  // Free space on a sheet becomes margin, up to kMargin on each side.
  std::vector<std::array<double, 2>> margins;
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const NestedPiece& at = placed[i];
    if (margins.size() <= at.sheet) margins.resize(at.sheet + 1, {kMargin, kMargin});
    const std::array<double, 2> size = size_of(i), end{at.x + size[0], at.y + size[1]};
    for (std::size_t k = 0; k < 2; ++k)
      margins[at.sheet][k] = std::min(margins[at.sheet][k], std::max(0.0, (area[k] - end[k]) / 2));
  }
  for (std::uint32_t i = 0; i < placed.size(); ++i) {
    SheetPiece& piece = layout.pieces[i];
    const NestedPiece& at = placed[i];
    const double x = at.x + options.origin.x + margins[at.sheet][0];
    const double y = at.y + options.origin.y + margins[at.sheet][1];
    piece.sheet = at.sheet;
    piece.transform = turned_to(piece.box, at.quarters, {x, y});
    if (layout.sheets.size() <= at.sheet) layout.sheets.resize(at.sheet + 1);
    LayoutSheet& sheet = layout.sheets[at.sheet];
    sheet.pieces.push_back(i);
    const std::array<double, 2> size = size_of(i);
    sheet.used_mm[0] = std::max(sheet.used_mm[0], x + size[0]);
    sheet.used_mm[1] = std::max(sheet.used_mm[1], y + size[1]);
  }
  return {};
}

Result<void> check(const LayoutOptions& options) {
  for (const double side : options.area_mm)
    if (!(side >= 1.0 && side <= kMaxCoordinate))
      return fail(ErrorKind::OutOfRange, "",
                  fmt::format("an area cannot be {:g} mm wide; use 1 mm to 100 m", side));
  if (options.area_mm[0] - options.origin.x < 1.0 || options.area_mm[1] - options.origin.y < 1.0)
    return fail(
        ErrorKind::Infeasible, "/options/at",
        fmt::format("{:g},{:g} leaves nothing of the {:.1f} x {:.1f} mm area; use a smaller offset",
                    options.origin.x, options.origin.y, options.area_mm[0], options.area_mm[1]));
  return check_tab_shape(options.tabs, "/tabs");
}

// Checks that the requested seams lie on the drawing.
Result<void> check_asked(const std::vector<double>& seams, double extent, const char* option,
                         const char* axis) {
  for (const double mm : seams)
    if (!(mm > kOn && mm < extent - kOn))
      return fail(
          ErrorKind::OutOfRange, option,
          fmt::format("{0} = {1:g} mm is outside the drawing; use a value between 0 and {2:.1f} mm",
                      axis, mm, extent));
  return {};
}

// Finishes the pieces of one layout: borders, marks, places on sheets.
Result<Layout> finish(const LineWork& drawing, const LayoutOptions& options, Search& search,
                      Laid& laid) {
  std::vector<LineWork> works = split_lines(laid.swap ? swapped(drawing) : drawing, laid.partition);
  const bool outlined =
      std::any_of(drawing.lines.begin(), drawing.lines.end(),
                  [](const DrawnLine& line) { return line.operation == Operation::Outline; });
  add_borders(laid.runs, laid.tabs, search.index(laid.swap),
              outlined ? Operation::Outline : Operation::Cut, works);
  if (laid.swap) unswap(laid, works);
  Layout layout;
  layout.pieces = make_pieces(works, laid);
  layout.runs = std::move(laid.runs);
  layout.tabs = std::move(laid.tabs);
  name_seams(layout, options.letters_taken);
  order_glueing(layout);
  if (options.labels) add_marks(layout, search.index(false), options.tabs.clearance_mm);
  if (auto put = put_on_sheets(layout, options); !put) return tl::unexpected(put.error());
  return layout;
}

}  // namespace

Result<Layout> lay_out(const LineWork& drawing, const LayoutOptions& options) {
  if (auto valid = check(options); !valid) return tl::unexpected(valid.error());
  const Box box = bounds(drawing);
  auto asked = check_asked(options.seams_x, box.width(), "/options/seam-x", "x").and_then([&] {
    return check_asked(options.seams_y, box.height(), "/options/seam-y", "y");
  });
  if (!asked) return tl::unexpected(asked.error());
  Search search(drawing, options);
  auto layouts = search.run();
  if (!layouts) return tl::unexpected(layouts.error());
  std::optional<Layout> best;
  Error error;
  double cost = 0.0;
  for (Laid& laid : *layouts) {
    auto layout = finish(drawing, options, search, laid);
    if (!layout) {
      error = layout.error();
      continue;
    }
    const auto worse = [&] {
      return std::pair(best->sheets.size(), cost) <= std::pair(layout->sheets.size(), laid.cost);
    };
    if (best && worse()) continue;
    best = std::move(*layout);
    cost = laid.cost;
  }
  if (!best) return tl::unexpected(error);
  const double paper = best->use.paper_mm2;
  best->least_sheets = std::max<std::uint32_t>(
      1, static_cast<std::uint32_t>(std::ceil(std::min(paper, box.width() * box.height()) /
                                                  (options.area_mm[0] * options.area_mm[1]) -
                                              1e-9)));
  return std::move(*best);
}

LineWork sheet_work(const Layout& layout, std::uint32_t sheet,
                    std::vector<std::uint32_t>& piece_of) {
  LineWork out;
  piece_of.clear();
  std::vector<PagePoint> points;
  for (const std::uint32_t i : layout.sheets[sheet].pieces) {
    const SheetPiece& piece = layout.pieces[i];
    for (const DrawnLine& line : piece.work.lines) {
      points.clear();
      for (const PagePoint& p : piece.work.points_of(line)) points.push_back(piece.transform(p));
      out.append(line.operation, points);
      piece_of.resize(out.lines.size(), i);
    }
  }
  return out;
}

}  // namespace popcut
