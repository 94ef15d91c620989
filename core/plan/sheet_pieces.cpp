// SPDX-License-Identifier: MIT
#include "core/plan/sheet_pieces.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/layout/layout.hpp"
#include "core/layout/marks.hpp"

namespace popcut {
namespace {

/// First `first`, then `second`.
Placement after(const Placement& first, const Placement& second) {
  const PagePoint zero = second(first({0, 0}));
  const PagePoint x = second(first({1, 0})), y = second(first({0, 1}));
  return {x.x - zero.x, y.x - zero.x, zero.x, x.y - zero.y, y.y - zero.y, zero.y};
}

Box moved(const Box& box, const Placement& map) {
  Box out;
  for (const PagePoint& p :
       {PagePoint{box.x0, box.y0}, {box.x1, box.y0}, {box.x0, box.y1}, {box.x1, box.y1}})
    out.add(map(p));
  return out;
}

Box common(const Box& a, const Box& b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

bool overlap(const Box& a, const Box& b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

Box around(const Box& box, double mm) {
  return {box.x0 - mm, box.y0 - mm, box.x1 + mm, box.y1 + mm};
}

constexpr double kLetter_mm = 2.2;
constexpr double kOff_mm = 1.2;  // from what it names: colours go 1 mm past it

std::string in_letters(const std::string& name) {
  std::string out = name;
  for (char& letter : out)
    letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  return out;
}

/// A place for a label: the corner where its box begins, and whether it runs downward.
struct LabelPlace {
  Box box;
  bool down{};
};

Box box_at(double x, double y, double w, double h) { return {x, y, x + w, y + h}; }

/// The part of the side from a to b that lies in a box, as shares of it; none where `from` > `to`.
struct SidePart {
  double from{0.0}, to{1.0};
};
SidePart part_in(const Box& box, const PagePoint& a, const PagePoint& b) {
  SidePart out;
  for (const auto& [start, way, low, high] :
       {std::array{a.x, b.x - a.x, box.x0, box.x1}, std::array{a.y, b.y - a.y, box.y0, box.y1}}) {
    if (way == 0.0) {
      if (start < low || start > high) out.to = -1.0;
      continue;
    }
    const double first = (low - start) / way, last = (high - start) / way;
    out.from = std::max(out.from, std::min(first, last));
    out.to = std::min(out.to, std::max(first, last));
  }
  return out;
}

/// Whether a side of an outline comes into a box, or the box lies within it.
bool is_on_paper(const Box& box, const std::vector<std::vector<PagePoint>>& outline) {
  const PagePoint middle{0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1)};
  bool is_inside = false;
  for (const auto& line : outline)
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
      const PagePoint &a = line[k], &b = line[k + 1];
      if ((a.y > middle.y) != (b.y > middle.y) &&
          middle.x < a.x + (middle.y - a.y) / (b.y - a.y) * (b.x - a.x))
        is_inside = !is_inside;
      if (const SidePart part = part_in(box, a, b); part.from <= part.to) return true;
    }
  return is_inside;
}

/// A place along an outline, off it by `kOff_mm`, and farther from all others.
std::optional<LabelPlace> place_along(const PartOnSheet& part, const PagePoint& size,
                                      const Box& room, const std::vector<Box>& taken,
                                      std::span<const PartOnSheet> parts) {
  constexpr double kStep_mm = 3.0, kClear_mm = 0.6, kOther_mm = 1.8;
  const auto [wide, high] = size;
  const auto is_free = [&](const Box& b) {
    if (b.x0 < room.x0 || b.y0 < room.y0 || b.x1 > room.x1 || b.y1 > room.y1) return false;
    return std::none_of(taken.begin(), taken.end(), [&](const Box& t) { return overlap(t, b); }) &&
           std::none_of(parts.begin(), parts.end(), [&](const PartOnSheet& other) {
             const Box clear = around(b, &other == &part ? kClear_mm : kOther_mm);
             return other.outline.empty() ? overlap(other.box, clear)
                                          : is_on_paper(clear, other.outline);
           });
  };
  for (const auto& line : part.outline) {
    double gone = kStep_mm;
    for (std::size_t k = 0; k + 1 < line.size(); ++k) {
      const double length = std::hypot(line[k + 1].x - line[k].x, line[k + 1].y - line[k].y);
      if ((gone += length) < kStep_mm) continue;
      gone = 0.0;
      const PagePoint p{0.5 * (line[k].x + line[k + 1].x), 0.5 * (line[k].y + line[k + 1].y)};
      for (const LabelPlace& place :
           {LabelPlace{box_at(p.x - 0.5 * wide, p.y - kOff_mm - high, wide, high), false},
            LabelPlace{box_at(p.x - 0.5 * wide, p.y + kOff_mm, wide, high), false},
            LabelPlace{box_at(p.x + kOff_mm, p.y - 0.5 * wide, high, wide), true},
            LabelPlace{box_at(p.x - kOff_mm - high, p.y - 0.5 * wide, high, wide), true}})
        if (is_free(place.box)) return place;
    }
  }
  return std::nullopt;
}

std::optional<LabelPlace> place_beside(const Box& part, const PagePoint& size, const Box& room,
                                       const std::vector<Box>& taken) {
  const auto [wide, high] = size;
  std::vector<LabelPlace> places;
  const double right = part.x1 - wide, middle = 0.5 * (part.x0 + right);
  for (const double x : {part.x0, middle, right})
    for (const double y : {part.y1 + kOff_mm, part.y0 - kOff_mm - high})
      places.push_back({box_at(x, y, wide, high), false});
  const double last = part.y1 - wide, centre = 0.5 * (part.y0 + last);
  for (const double y : {part.y0, centre, last})
    for (const double x : {part.x1 + kOff_mm, part.x0 - kOff_mm - high})
      places.push_back({box_at(x, y, high, wide), true});
  for (const LabelPlace& place : places) {
    const Box& b = place.box;
    if (b.x0 < room.x0 || b.y0 < room.y0 || b.x1 > room.x1 || b.y1 > room.y1) continue;
    if (std::none_of(taken.begin(), taken.end(), [&](const Box& t) { return overlap(t, b); }))
      return place;
  }
  return std::nullopt;
}

void put_letters(std::string& svg, const std::string& letters, const LabelPlace& place) {
  for (const auto& line : single_stroke(letters, kLetter_mm)) {
    svg += "<path d=\"";
    for (std::size_t k = 0; k < line.size(); ++k) {
      // Its origin is on the baseline, a letter's height below the upper edge.
      const double x = line[k].x, y = line[k].y + kLetter_mm;
      const PagePoint p = place.down ? PagePoint{place.box.x1 - y, place.box.y0 + x}
                                     : PagePoint{place.box.x0 + x, place.box.y0 + y};
      svg += fmt::format("{}{:.2f} {:.2f}", k == 0 ? 'M' : 'L', p.x, p.y);
    }
    svg += "\"/>\n";
  }
}

}  // namespace

std::vector<PieceMap> pieces_on_sheet(const Plan& plan, std::size_t sheet) {
  const PlannedSheet& planned = plan.sheets[sheet];
  std::vector<PieceMap> out;
  if (!plan.layout) {
    const std::vector<PagePoint> once{{0, 0}};
    for (const PagePoint& copy : plan.copies.empty() ? once : plan.copies) {
      const Placement moved{1, 0, copy.x, 0, 1, copy.y};
      out.push_back({after(after(plan.drawing_transform, moved), planned.transform), {}});
    }
    return out;
  }
  for (const std::uint32_t k : planned.pieces) {
    const SheetPiece& piece = plan.layout->pieces[k];
    PieceMap map{after(plan.drawing_transform, piece.transform), {}};
    const auto add = [&](auto&& corners) {
      auto& polygon = map.polygons.emplace_back();
      for (const PagePoint& p : corners) polygon.push_back(piece.transform(p));
    };
    add(piece.share);
    for (const Tab& tab : plan.layout->tabs)
      if (tab.on == k) add(tab.corners);
    out.push_back(std::move(map));
  }
  return out;
}

std::vector<PartOnSheet> parts_on_sheet(const Plan& plan, std::size_t sheet) {
  constexpr double kLeast_mm = 1.0;
  std::vector<PartOnSheet> out;
  if (plan.parts.empty()) return out;
  const std::vector<PieceMap> pieces = pieces_on_sheet(plan, sheet);
  for (const DrawnPart& part : plan.parts)
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      const PieceMap& piece = pieces[k];
      Box box = moved(part.box, piece.to_sheet);
      if (!piece.polygons.empty()) box = common(box, bounds(piece.polygons.front()));
      if (!(box.width() > kLeast_mm && box.height() > kLeast_mm)) continue;
      PartOnSheet& found = out.emplace_back(PartOnSheet{part.name, box, {}});
      if (!plan.layout) continue;
      const SheetPiece& own = plan.layout->pieces[plan.sheets[sheet].pieces[k]];
      for (const DrawnLine& line : own.work.lines) {
        if (line.operation != Operation::Outline) continue;
        auto& points = found.outline.emplace_back();
        for (const PagePoint& p : own.work.points_of(line)) points.push_back(own.transform(p));
      }
    }
  return out;
}

std::string part_names(std::span<const PartOnSheet> parts) {
  std::vector<std::string> names;
  for (const PartOnSheet& part : parts)
    if (std::find(names.begin(), names.end(), part.name) == names.end()) names.push_back(part.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string part_labels_svg(std::span<const PartOnSheet> parts, const Box& room,
                            std::vector<Box> taken, std::vector<std::string>* without) {
  std::vector<Box> boxes;
  boxes.reserve(parts.size());
  for (const PartOnSheet& part : parts) boxes.push_back(around(part.box, 1.0));
  std::string svg;
  for (const PartOnSheet& part : parts) {
    const std::string letters = in_letters(part.name);
    const PagePoint size = single_stroke_size(letters, kLetter_mm);
    std::vector<Box> all = boxes;
    all.insert(all.end(), taken.begin(), taken.end());
    // Where another box is near, what is beside this one may be nearer to that part.
    const Box near = around(part.box, kOff_mm + kLetter_mm);
    const bool is_nested =
        !part.outline.empty() && std::any_of(parts.begin(), parts.end(), [&](const auto& other) {
          return &other != &part && overlap(other.box, near);
        });
    auto place = is_nested ? place_along(part, size, room, taken, parts)
                           : place_beside(part.box, size, room, all);
    if (!place && !is_nested) place = place_along(part, size, room, taken, parts);
    if (!place) {
      if (without != nullptr) without->push_back(part.name);
      continue;
    }
    taken.push_back(place->box);
    put_letters(svg, letters, *place);
  }
  if (svg.empty()) return svg;
  return "<g id=\"parts\" fill=\"none\" stroke=\"#000000\" stroke-width=\"0.25\" "
         "stroke-linecap=\"round\">\n" +
         svg + "</g>\n";
}

std::string glue_marks_svg(const Plan& plan, std::size_t sheet) {
  std::string path;
  if (plan.glue_marks.size() == 0) return path;
  for (const PieceMap& piece : pieces_on_sheet(plan, sheet)) {
    // A piece of a part has what lies on it alone.
    constexpr double kFar = 1e9;
    const Box share =
        piece.polygons.empty() ? Box{-kFar, -kFar, kFar, kFar} : bounds(piece.polygons.front());
    for (std::size_t k = 0; k < plan.glue_marks.size(); ++k) {
      const auto line = plan.glue_marks[k];
      bool is_drawn_on = false;
      for (std::size_t n = 0; n + 1 < line.size(); ++n) {
        const PagePoint a = piece.to_sheet(line[n]), b = piece.to_sheet(line[n + 1]);
        const SidePart part = part_in(share, a, b);
        if (part.from > part.to) {
          is_drawn_on = false;
          continue;
        }
        const auto at = [&](double t) {
          return PagePoint{a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
        };
        const PagePoint from = at(part.from), to = at(part.to);
        if (!is_drawn_on) path += fmt::format("M{:.2f} {:.2f}", from.x, from.y);
        path += fmt::format("L{:.2f} {:.2f}", to.x, to.y);
        is_drawn_on = part.to >= 1.0;
      }
    }
  }
  if (path.empty()) return path;
  return "<path id=\"glue\" fill=\"none\" stroke=\"#707070\" stroke-width=\"0.2\" "
         "stroke-linecap=\"round\" d=\"" +
         path + "\"/>\n";
}

}  // namespace popcut
