// SPDX-License-Identifier: MIT
#include "core/layout/marks.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace popcut {
namespace {

constexpr double kTick = 2.5;  // length in mm, into the panel
constexpr double kLeastTick = 0.8;
constexpr std::array kHeights{5.0, 4.0, 3.0, 2.2};  // of letters, mm
constexpr double kMarkDash = 0.7, kMarkGap = 0.5;   // mm; dashes of marks that the knife cuts
constexpr double kGap = 1.0;                        // between seam and letters

struct Place {
  const SeamRun* run{};
  SeamStretch stretch{};
};

using Strokes = std::vector<std::vector<PagePoint>>;

class Marks {
 public:
  Marks(Layout& layout, LineIndex& lines, double clearance_mm)
      : layout_(layout), lines_(lines), clearance_mm_(clearance_mm), taken_(layout.pieces.size()) {}

  // Draws ticks near both ends of a long stretch, or one in its middle. Draws both sides or none.
  bool tick(const Place& place) {
    const double length = place.stretch.to - place.stretch.from;
    bool any = false;
    const auto at = [&](double part) {
      const double t = place.stretch.from + part * length;
      const double room = std::min(depth(place, t, t, 1), depth(place, t, t, -1));
      if (room < kLeastTick) return;
      const auto low = tick_at(*place.run, t, room, -1), high = tick_at(*place.run, t, room, 1);
      if (!is_free(low, place.run->lower) || !is_free(high, place.run->upper)) return;
      draw(low, place.run->lower);
      draw(high, place.run->upper);
      any = true;
    };
    if (has_two(place)) {
      at(0.1);
      at(0.9);
    } else {
      at(0.5);
    }
    return any;
  }
  static bool has_two(const Place& place) { return place.stretch.to - place.stretch.from >= 24.0; }

  // Draws the seam's letter on both sides of the stretch, or on none.
  bool letter(const Place& place, const std::string& label) {
    const SeamRun& run = *place.run;
    const std::string low = fmt::format("{}{}", run.lower + 1, label);
    const std::string high = fmt::format("{}{}", run.upper + 1, label);
    for (const double part : {0.5, 0.3, 0.7}) {
      const Strokes below = text_at(place, part, low, -1, run.lower);
      const Strokes above = text_at(place, part, high, 1, run.upper);
      if (below.empty() || above.empty()) continue;
      draw(below, run.lower);
      draw(above, run.upper);
      return true;
    }
    return false;
  }

 private:
  [[nodiscard]] double depth(const Place& place, double from, double to, int side) {
    const AxisLine line{place.run->vertical, place.run->at};
    const double a = std::max(from - clearance_mm_, place.stretch.from);
    const double b = std::min(to + clearance_mm_, place.stretch.to);
    return lines_.free_depth(line, a, b, side, kTick + clearance_mm_) - clearance_mm_;
  }

  static Strokes tick_at(const SeamRun& run, double t, double room, int side) {
    const AxisLine line{run.vertical, run.at};
    const double far = std::min(kTick, room);
    return {{line.point(t, side * std::min(0.3, far / 3)), line.point(t, side * far)}};
  }

  static Box box_of(const Strokes& strokes) {
    Box box;
    for (const std::vector<PagePoint>& stroke : strokes)
      for (const PagePoint& p : stroke) box.add(p);
    return box;
  }

  // Whether the strokes lie within the piece and clear of its other marks: on a narrow piece, those
  // of the seam on its other side.
  [[nodiscard]] bool is_free(const Strokes& strokes, std::uint32_t piece) const {
    const Box box = box_of(strokes), all = bounds(layout_.pieces[piece].share);
    if (box.x0 < all.x0 || box.y0 < all.y0 || box.x1 > all.x1 || box.y1 > all.y1) return false;
    return std::none_of(taken_[piece].begin(), taken_[piece].end(), [&](const Box& other) {
      return box.x0 < other.x1 + clearance_mm_ && other.x0 < box.x1 + clearance_mm_ &&
             box.y0 < other.y1 + clearance_mm_ && other.y0 < box.y1 + clearance_mm_;
    });
  }

  void draw(const Strokes& strokes, std::uint32_t piece) {
    for (const std::vector<PagePoint>& stroke : strokes)
      layout_.pieces[piece].work.append(Operation::Draw, stroke);
    taken_[piece].push_back(box_of(strokes));
  }

  // The text in the largest letters that have room on this side of the stretch, about `part` of it;
  // empty: in none.
  Strokes text_at(const Place& place, double part, const std::string& text, int side,
                  std::uint32_t piece) {
    const AxisLine line{place.run->vertical, place.run->at};
    const double length = place.stretch.to - place.stretch.from;
    const double middle = place.stretch.from + part * length;
    for (const double height : kHeights) {
      const PagePoint size = single_stroke_size(text, height);
      if (size.x > (part == 0.5 ? 0.7 : 0.4) * length) continue;
      const double need = kGap + size.y + clearance_mm_;
      if (lines_.free_depth(line, middle - size.x / 2, middle + size.x / 2, side, need) < need)
        continue;
      // Letters stand upright beside a seam along x; beside a seam along y you read them from
      // below.
      const double bar = size.y - height;
      Strokes strokes = single_stroke(text, height);
      for (std::vector<PagePoint>& stroke : strokes)
        for (PagePoint& p : stroke) {
          const double along = p.x - size.x / 2;
          const double across = (side > 0 ? kGap + height : -(kGap + bar)) + p.y;
          // Along y the text turns by 90 degrees counter-clockwise: up is towards smaller x.
          p = place.run->vertical ? PagePoint{line.at + across, middle - along}
                                  : PagePoint{middle + along, line.at + across};
        }
      if (is_free(strokes, piece)) return strokes;
    }
    return {};
  }

  Layout& layout_;
  LineIndex& lines_;
  double clearance_mm_;
  std::vector<std::vector<Box>> taken_;  ///< by marks, for each piece
};

}  // namespace

void cut_marks(Layout& layout) {
  for (SheetPiece& piece : layout.pieces) {
    LineWork work;
    work.name = piece.work.name;
    for (std::uint32_t l = 0; l < piece.first_mark; ++l)
      work.append(piece.work.lines[l].operation, piece.work.points_of(piece.work.lines[l]));
    for (std::size_t l = piece.first_mark; l < piece.work.lines.size(); ++l) {
      const auto points = piece.work.points_of(piece.work.lines[l]);
      for (std::size_t i = 1; i < points.size(); ++i) {
        const PagePoint &a = points[i - 1], &b = points[i];
        const double l_mm = distance(a, b);
        if (l_mm <= kMarkGap) continue;
        // Leave half a gap at both ends so that the paper holds at corners.
        const double n = std::max(1.0, std::round(l_mm / (kMarkDash + kMarkGap)));
        const double share = l_mm / n;
        for (int k = 0; k < static_cast<int>(n); ++k) {
          const auto at = [&](double mm) { return lerp(a, b, mm / l_mm); };
          work.append(Operation::Cut,
                      std::array{at(k * share + kMarkGap / 2), at((k + 1) * share - kMarkGap / 2)});
        }
      }
    }
    piece.work = std::move(work);
  }
}

std::string seam_label(std::size_t i) {
  std::string label;
  for (++i; i > 0; i = (i - 1) / 26)
    label.insert(label.begin(), static_cast<char>('A' + (i - 1) % 26));
  return label;
}

void add_marks(Layout& layout, LineIndex& lines, double clearance_mm) {
  for (SheetPiece& piece : layout.pieces)
    piece.first_mark = static_cast<std::uint32_t>(piece.work.lines.size());
  // The stretches of each seam, longest first: letters go where there is most room.
  std::vector<std::vector<Place>> places(layout.seams.size());
  for (const SeamRun& run : layout.runs)
    for (const SeamStretch& stretch : run.uncut) places[run.seam].push_back({&run, stretch});
  Marks marks(layout, lines, clearance_mm);
  std::size_t unlabelled = 0, unticked = 0;
  for (std::size_t s = 0; s < places.size(); ++s) {
    std::vector<Place>& of_seam = places[s];
    if (of_seam.empty()) continue;
    std::stable_sort(of_seam.begin(), of_seam.end(), [](const Place& a, const Place& b) {
      return a.stretch.to - a.stretch.from > b.stretch.to - b.stretch.from;
    });
    of_seam.resize(std::min<std::size_t>(of_seam.size(), 12));
    const auto letter = std::find_if(of_seam.begin(), of_seam.end(), [&](const Place& place) {
      return marks.letter(place, layout.seams[s].label);
    });
    // Ticks fit beside a letter only on a long stretch.
    std::size_t ticked = 0;
    for (auto place = of_seam.begin(); place != of_seam.end(); ++place)
      if (ticked < 2 && (place != letter || of_seam.size() == 1 || Marks::has_two(*place)) &&
          marks.tick(*place))
        ++ticked;
    if (letter == of_seam.end()) ++unlabelled;
    if (ticked == 0) ++unticked;
  }
  if (unlabelled > 0)
    layout.warnings.push_back(
        {.code = "seam_without_letter",
         .message = fmt::format("{} of {} seams have no room for a letter; assembly.svg shows them",
                                unlabelled, layout.seams.size())});
  if (unticked > 0)
    layout.warnings.push_back({.code = "seam_without_tick",
                               .message = fmt::format("{} of {} seams have no room for tick marks",
                                                      unticked, layout.seams.size())});
}

}  // namespace popcut
