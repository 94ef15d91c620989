// SPDX-License-Identifier: MIT
#include "core/layout/nest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

namespace popcut {
namespace nest_parts {
namespace {

constexpr double kRounded = 1e-6;  // mm; rounding errors up to this size still fit
constexpr double kMostColumns = 1200.0, kLeastColumn_mm = 1.0;
constexpr double kFar = std::numeric_limits<double>::infinity();

struct Stretch {
  double from{}, to{};
};
/// The stretches of y of one column, ascending and apart.
using Column = std::vector<Stretch>;

void unite(Column& column) {
  std::sort(column.begin(), column.end(),
            [](const Stretch& a, const Stretch& b) { return a.from < b.from; });
  std::size_t kept = 0;
  for (const Stretch& one : column) {
    if (kept > 0 && one.from <= column[kept - 1].to)
      column[kept - 1].to = std::max(column[kept - 1].to, one.to);
    else
      column[kept++] = one;
  }
  column.resize(kept);
}

using Loop = std::vector<PagePoint>;

/// The closed lines that the strokes of an outline make, end to end; none if they do not close.
std::vector<Loop> closed_loops(const LineWork& work) {
  const bool has_outline =
      std::any_of(work.lines.begin(), work.lines.end(),
                  [](const DrawnLine& l) { return l.operation == Operation::Outline; });
  constexpr double kSame = 1e3;  // ends within a micrometre or so
  using Place = std::pair<std::int64_t, std::int64_t>;
  const auto place = [](const PagePoint& p) {
    return Place{std::llround(p.x * kSame), std::llround(p.y * kSame)};
  };
  std::vector<Loop> loops;
  std::vector<const DrawnLine*> open;
  std::map<Place, std::vector<std::size_t>> at;
  for (const DrawnLine& line : work.lines) {
    if (line.operation != (has_outline ? Operation::Outline : Operation::Cut)) continue;
    const auto points = work.points_of(line);
    if (place(points.front()) == place(points.back())) {
      loops.emplace_back(points.begin(), points.end());
      continue;
    }
    at[place(points.front())].push_back(open.size());
    at[place(points.back())].push_back(open.size());
    open.push_back(&line);
  }
  for (const auto& [where, ends] : at)
    if (ends.size() % 2 != 0) {
      if (has_outline) return {};
      break;
    }
  std::vector<bool> taken(open.size(), false);
  for (std::size_t first = 0; first < open.size(); ++first) {
    if (taken[first]) continue;
    Loop loop;
    std::optional<std::size_t> next = first;
    while (next) {
      taken[*next] = true;
      const auto points = work.points_of(*open[*next]);
      const bool is_turned = !loop.empty() && place(points.front()) != place(loop.back());
      for (std::size_t k = 0; k < points.size(); ++k)
        loop.push_back(points[is_turned ? points.size() - 1 - k : k]);
      const std::vector<std::size_t>& here = at[place(loop.back())];
      const auto found =
          std::find_if(here.begin(), here.end(), [&](std::size_t k) { return !taken[k]; });
      next = found == here.end() ? std::nullopt : std::optional(*found);
    }
    if (place(loop.front()) == place(loop.back())) loops.push_back(std::move(loop));
  }
  return loops;
}

PagePoint turned(const PagePoint& p, const Box& box, std::uint32_t quarters) {
  switch (quarters) {
    case 1:
      return {box.y1 - p.y, p.x - box.x0};
    case 2:
      return {box.x1 - p.x, box.y1 - p.y};
    case 3:
      return {p.y - box.y0, box.x1 - p.x};
    default:
      return {p.x - box.x0, p.y - box.y0};
  }
}

/// A piece in columns, its box at the origin.
struct Shape {
  double width{}, height{};
  std::vector<Column> columns;
};

class ShapeMaker {
 public:
  ShapeMaker(double width, double height, double column_mm)
      : column_mm_(column_mm), shape_{width, height, {}} {
    shape_.columns.resize(std::max<std::size_t>(
        1, static_cast<std::size_t>(std::ceil(width / column_mm - kRounded))));
  }

  /// What a segment takes of each column that it touches.
  void add_segment(const PagePoint& a, const PagePoint& b) {
    const double low = std::min(a.x, b.x), high = std::max(a.x, b.x);
    for (std::size_t c = column_at(low - kRounded); c <= column_at(high + kRounded); ++c) {
      const double x0 = std::clamp(left(c), low, high), x1 = std::clamp(left(c + 1), low, high);
      double from = std::min(a.y, b.y), to = std::max(a.y, b.y);
      if (high - low > kRounded) {
        const double slope = (b.y - a.y) / (b.x - a.x);
        const double y0 = a.y + slope * (x0 - a.x), y1 = a.y + slope * (x1 - a.x);
        from = std::min(y0, y1), to = std::max(y0, y1);
      }
      shape_.columns[c].push_back({from - kRounded, to + kRounded});
    }
  }

  /// The inside of a loop. What of it lies in a column without a side of the loop goes on at its
  /// borders.
  void fill(const Loop& loop) {
    std::vector<std::vector<double>> crossings(shape_.columns.size() + 1);
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const PagePoint &a = loop[k], &b = loop[(k + 1) % loop.size()];
      const double low = std::min(a.x, b.x), high = std::max(a.x, b.x);
      const auto first = static_cast<std::size_t>(std::max(0.0, std::floor(low / column_mm_)));
      for (std::size_t c = first; c < crossings.size() && left(c) <= high; ++c)
        if ((a.x < left(c)) != (b.x < left(c)))
          crossings[c].push_back(a.y + (left(c) - a.x) / (b.x - a.x) * (b.y - a.y));
    }
    for (std::size_t c = 0; c < crossings.size(); ++c) {
      std::sort(crossings[c].begin(), crossings[c].end());
      for (std::size_t k = 0; k + 1 < crossings[c].size(); k += 2) {
        const Stretch inside{crossings[c][k], crossings[c][k + 1]};
        if (c < shape_.columns.size()) shape_.columns[c].push_back(inside);
        if (c > 0) shape_.columns[c - 1].push_back(inside);
      }
    }
  }

  void fill_all() {
    for (Column& column : shape_.columns) column = {{0.0, shape_.height}};
  }

  Shape taken() {
    for (Column& column : shape_.columns) unite(column);
    return std::move(shape_);
  }

 private:
  [[nodiscard]] double left(std::size_t column) const {
    return static_cast<double>(column) * column_mm_;
  }
  [[nodiscard]] std::size_t column_at(double x) const {
    const double c = std::floor(x / column_mm_);
    return c <= 0.0 ? 0 : std::min(shape_.columns.size() - 1, static_cast<std::size_t>(c));
  }

  double column_mm_;
  Shape shape_;
};

Shape shape_of(const LineWork& work, const std::vector<Loop>& loops, std::uint32_t quarters,
               double column_mm) {
  const Box box = bounds(work);
  const bool is_turned = quarters % 2 != 0;
  ShapeMaker maker(is_turned ? box.height() : box.width(), is_turned ? box.width() : box.height(),
                   column_mm);
  if (loops.empty()) maker.fill_all();
  Loop moved;
  for (const Loop& loop : loops) {
    moved.clear();
    for (const PagePoint& p : loop) moved.push_back(turned(p, box, quarters));
    maker.fill(moved);
  }
  for (const DrawnLine& line : work.lines) {
    const auto points = work.points_of(line);
    for (std::size_t k = 0; k + 1 < points.size(); ++k)
      maker.add_segment(turned(points[k], box, quarters), turned(points[k + 1], box, quarters));
  }
  return maker.taken();
}

double area_of_columns(const Shape& shape, double column_mm) {
  double sum = 0.0;
  for (const Column& column : shape.columns)
    for (const Stretch& one : column) sum += (one.to - one.from) * column_mm;
  return sum;
}

/// A sheet, and what is taken of its columns: pieces with the spacing around them.
class Sheet {
 public:
  Sheet(const std::array<double, 2>& area, double spacing, double column_mm)
      : area_(area),
        spacing_(spacing),
        column_mm_(column_mm),
        columns_(static_cast<std::size_t>(std::ceil(area[0] / column_mm + kRounded)) + 1),
        free_mm2_((area[0] + spacing) * (area[1] + spacing)) {}

  struct Spot {
    std::size_t column{};
    double y{}, end{kFar};
  };

  /// The spot of a shape with the least end; none with an end of `below` or more.
  [[nodiscard]] Spot find(const Shape& shape, double paper, double below) const {
    Spot best;
    best.end = std::min(below, area_[1] + kRounded);
    bool is_found = false;
    if (paper <= free_mm2_ && shape.width <= area_[0] + kRounded)
      for (std::size_t c = 0;
           static_cast<double>(c) * column_mm_ + shape.width <= area_[0] + kRounded; ++c) {
        const double y = lowest(shape, c, best.end - shape.height);
        if (y + shape.height >= best.end) continue;
        best = {c, y, y + shape.height};
        is_found = true;
      }
    if (!is_found) best.end = kFar;
    return best;
  }

  void take(const Shape& shape, const Spot& spot, double paper) {
    free_mm2_ -= paper;
    const auto reach = static_cast<std::ptrdiff_t>(std::ceil(spacing_ / column_mm_)) + 1;
    std::vector<bool> is_changed(columns_.size(), false);
    for (std::size_t k = 0; k < shape.columns.size(); ++k)
      for (std::ptrdiff_t d = -reach; d <= reach; ++d) {
        const auto c = static_cast<std::ptrdiff_t>(spot.column + k) + d;
        if (c < 0 || c >= std::ssize(columns_)) continue;
        const double beside = std::max(0.0, static_cast<double>(std::abs(d) - 1)) * column_mm_;
        if (beside >= spacing_) continue;
        const double around = std::sqrt(spacing_ * spacing_ - beside * beside);
        for (const Stretch& one : shape.columns[k])
          columns_[static_cast<std::size_t>(c)].push_back(
              {one.from + spot.y - around, one.to + spot.y + around});
        is_changed[static_cast<std::size_t>(c)] = true;
      }
    for (std::size_t c = 0; c < columns_.size(); ++c)
      if (is_changed[c]) unite(columns_[c]);
    end_ = std::max(end_, spot.end);
  }

  [[nodiscard]] double end() const { return end_; }

 private:
  /// How far down a shape must go at a column until it meets nothing, or beyond `most`.
  [[nodiscard]] double lowest(const Shape& shape, std::size_t column, double most) const {
    double y = 0.0;
    for (std::size_t clear = 0, k = 0; clear < shape.columns.size() && y < most;) {
      const double before = y;
      const Column& taken = columns_[column + k];
      for (const Stretch& own : shape.columns[k])
        for (auto it = std::upper_bound(taken.begin(), taken.end(), own.from + y,
                                        [](double at, const Stretch&one) { return at < one.to; });
             it != taken.end() && it->from < own.to + y; ++it)
          y = it->to - own.from;
      // A stretch that was clear may not be so farther down.
      clear = y > before ? 0 : clear + 1;
      if (y == before) k = k + 1 == shape.columns.size() ? 0 : k + 1;
    }
    return y;
  }

  std::array<double, 2> area_;
  double spacing_, column_mm_;
  std::vector<Column> columns_;
  double free_mm2_{}, end_{0.0};
};

struct Piece {
  std::vector<Shape> turns;  ///< by quarters; two of a piece that fills its box
  double paper{}, side{};
};

/// @return the nest, and how far its last sheet is used
std::pair<Nest, double> in_order(const std::vector<Piece>& pieces,
                                 const std::vector<std::size_t>& order,
                                 const std::array<double, 2>& area, double spacing,
                                 double column_mm) {
  Nest out;
  out.places.resize(pieces.size());
  std::vector<Sheet> sheets;
  for (const std::size_t p : order) {
    const Piece& piece = pieces[p];
    bool is_placed = false;
    for (std::size_t s = 0; !is_placed; ++s) {
      if (s == sheets.size()) sheets.emplace_back(area, spacing, column_mm);
      Sheet::Spot best;
      std::uint32_t quarters = 0;
      for (std::uint32_t q = 0; q < piece.turns.size(); ++q) {
        const Sheet::Spot spot = sheets[s].find(piece.turns[q], piece.paper, best.end - kRounded);
        if (spot.end < best.end) best = spot, quarters = q;
      }
      if (best.end == kFar) {
        if (s + 1 == sheets.size() && sheets[s].end() == 0.0) break;  // it fits no sheet
        continue;
      }
      sheets[s].take(piece.turns[quarters], best, piece.paper);
      out.places[p] = {static_cast<std::uint32_t>(s), quarters,
                       static_cast<double>(best.column) * column_mm, best.y};
      is_placed = true;
    }
  }
  out.sheets = static_cast<std::uint32_t>(sheets.size());
  return {std::move(out), sheets.empty() ? 0.0 : sheets.back().end()};
}

}  // namespace
}  // namespace nest_parts

double paper_mm2(const LineWork& piece) {
  using namespace nest_parts;
  const Box box = bounds(piece);
  const std::vector<Loop> loops = closed_loops(piece);
  if (loops.empty()) return box.width() * box.height();
  const double columns = std::max(1.0, std::ceil(box.width() / kLeastColumn_mm));
  const double wide = box.width() / columns;
  std::vector<Column> inside(static_cast<std::size_t>(columns));
  for (const Loop& loop : loops) {
    std::vector<std::vector<double>> crossings(inside.size());  // of the columns' middles
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const PagePoint &a = loop[k], &b = loop[(k + 1) % loop.size()];
      const auto first =
          static_cast<std::size_t>(std::max(0.0, std::floor((std::min(a.x, b.x) - box.x0) / wide)));
      for (std::size_t c = first; c < inside.size(); ++c) {
        const double x = box.x0 + (static_cast<double>(c) + 0.5) * wide;
        if (x > std::max(a.x, b.x)) break;
        if ((a.x < x) != (b.x < x))
          crossings[c].push_back(a.y + (x - a.x) / (b.x - a.x) * (b.y - a.y));
      }
    }
    for (std::size_t c = 0; c < inside.size(); ++c) {
      std::sort(crossings[c].begin(), crossings[c].end());
      for (std::size_t k = 0; k + 1 < crossings[c].size(); k += 2)
        inside[c].push_back({crossings[c][k], crossings[c][k + 1]});
    }
  }
  double sum = 0.0;
  for (Column& column : inside) {
    unite(column);
    for (const Stretch& one : column) sum += (one.to - one.from) * wide;
  }
  return sum;
}

Nest nest(const std::vector<const LineWork*>& pieces, const std::array<double, 2>& area,
          double spacing) {
  using namespace nest_parts;
  const double column_mm = std::max(kLeastColumn_mm, area[0] / kMostColumns);
  std::vector<Piece> made;
  for (const LineWork* work : pieces) {
    constexpr double kFull = 0.97;
    const std::vector<Loop> loops = closed_loops(*work);
    Piece& piece = made.emplace_back();
    piece.turns.push_back(shape_of(*work, loops, 0, column_mm));
    const Shape& first = piece.turns.front();
    piece.paper = area_of_columns(first, column_mm);
    piece.side = std::max(first.width, first.height);
    const std::uint32_t turns = piece.paper > kFull * first.width * first.height ? 2 : 4;
    for (std::uint32_t q = 1; q < turns; ++q)
      piece.turns.push_back(shape_of(*work, loops, q, column_mm));
  }
  std::pair<Nest, double> best;
  for (const bool by_side : {true, false}) {
    std::vector<std::size_t> order(pieces.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return by_side ? made[a].side > made[b].side : made[a].paper > made[b].paper;
    });
    auto found = in_order(made, order, area, spacing, column_mm);
    if (by_side ||
        std::pair(found.first.sheets, found.second) < std::pair(best.first.sheets, best.second))
      best = std::move(found);
  }
  return std::move(best.first);
}

}  // namespace popcut
