// SPDX-License-Identifier: MIT
#include "core/artwork/printed_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "core/layout/layout.hpp"
#include "core/plan/marks.hpp"

namespace popcut {
namespace {

Placement inverse(const Placement& t) {
  const double d = t.xx * t.yy - t.xy * t.yx;
  Placement out{t.yy / d, -t.xy / d, 0, -t.yx / d, t.xx / d, 0};
  const PagePoint moved = out({t.x0, t.y0});
  out.x0 = -moved.x, out.y0 = -moved.y;
  return out;
}

/// Pixels whose middle lies in a polygon become 1 (even-odd).
void fill(const std::vector<PagePoint>& polygon, const PixelFrame& frame,
          std::vector<std::uint8_t>& mask) {
  std::vector<double> crossings;
  for (std::size_t j = 0; j < frame.height; ++j) {
    const double y = frame.middle(0, j).y;
    crossings.clear();
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const PagePoint &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
      if ((a.y <= y) == (b.y <= y)) continue;
      crossings.push_back(frame.in_pixels({a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x), y}).x);
    }
    std::sort(crossings.begin(), crossings.end());
    for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) {
      const double from = std::max(0.0, std::ceil(crossings[k]));
      const double to =
          std::min(static_cast<double>(frame.width) - 1, std::floor(crossings[k + 1]));
      for (double x = from; x <= to; x += 1)
        mask[j * frame.width + static_cast<std::size_t>(x)] = 1;
    }
  }
}

/// Pixels within `far` pixels of one that is 1 become 1 too: first across, then down.
void widen(const PixelFrame& frame, std::size_t far, std::vector<std::uint8_t>& mask) {
  const auto along = [&](std::size_t first, std::size_t step, std::size_t count) {
    std::size_t last = count + far + 1;  // steps since a 1, forward and then backward
    std::vector<std::uint8_t> out(count, 0);
    for (const bool backward : {false, true}) {
      last = far + 1;
      for (std::size_t k = 0; k < count; ++k) {
        const std::size_t n = backward ? count - 1 - k : k;
        last = mask[first + n * step] != 0 ? 0 : last + 1;
        if (last <= far) out[n] = 1;
      }
    }
    for (std::size_t n = 0; n < count; ++n) mask[first + n * step] = out[n];
  };
  for (std::size_t j = 0; j < frame.height; ++j) along(j * frame.width, 1, frame.width);
  for (std::size_t i = 0; i < frame.width; ++i) along(i, frame.width, frame.height);
}

/// The pixels of the sheet that a box covers, as columns and rows.
struct Window {
  std::size_t left{}, top{}, right{}, bottom{};  ///< one past the last
};
Window window_of(const PixelFrame& frame, const Box& box) {
  const auto within = [&](double mm, double start, std::size_t most) {
    const double pixel = std::floor((mm - start) / frame.pixel_mm);
    return static_cast<std::size_t>(std::clamp(pixel, 0.0, static_cast<double>(most)));
  };
  return {within(box.x0, frame.left_mm, frame.width), within(box.y0, frame.top_mm, frame.height),
          std::min(frame.width, within(box.x1, frame.left_mm, frame.width) + 1),
          std::min(frame.height, within(box.y1, frame.top_mm, frame.height) + 1)};
}

double distance_to(const Box& box, const PagePoint& p) {
  const double dx = std::max({box.x0 - p.x, 0.0, p.x - box.x1});
  const double dy = std::max({box.y0 - p.y, 0.0, p.y - box.y1});
  return std::hypot(dx, dy);
}

class Printing {
 public:
  Printing(const Artwork& artwork, const PixelFrame& frame, const Trapping& how)
      : artwork_(artwork),
        how_(how),
        out_{frame, ColourImage(frame.width, frame.height)},
        kept_(frame.pixels(), 0) {}

  void add(const PieceMap& piece) {
    const PixelFrame& from = artwork_.frame;
    const Placement back = inverse(piece.to_sheet);
    Box box;
    if (piece.polygons.empty()) {
      const double right = from.left_mm + static_cast<double>(from.width) * from.pixel_mm;
      const double bottom = from.top_mm + static_cast<double>(from.height) * from.pixel_mm;
      for (const PagePoint& p : {PagePoint{from.left_mm, from.top_mm}, PagePoint{right, bottom},
                                 PagePoint{from.left_mm, bottom}, PagePoint{right, from.top_mm}})
        box.add(piece.to_sheet(p));
    }
    for (const auto& polygon : piece.polygons)
      for (const PagePoint& p : polygon)
        for (const double side : {-1.0, 1.0})
          box.add({p.x + side * how_.bleed_mm, p.y + side * how_.bleed_mm});
    const Window window = window_of(out_.frame, box);
    if (window.right <= window.left || window.bottom <= window.top) return;
    PixelFrame part = out_.frame;
    part.left_mm += static_cast<double>(window.left) * part.pixel_mm;
    part.top_mm += static_cast<double>(window.top) * part.pixel_mm;
    part.width = window.right - window.left, part.height = window.bottom - window.top;
    std::vector<std::uint8_t> inside, mask;
    if (!piece.polygons.empty()) {
      inside.assign(part.pixels(), 0);
      for (const auto& polygon : piece.polygons) fill(polygon, part, inside);
      mask = inside;
      widen(part, static_cast<std::size_t>(std::ceil(how_.bleed_mm / part.pixel_mm)), mask);
    }
    for (std::size_t j = 0; j < part.height; ++j)
      for (std::size_t i = 0; i < part.width; ++i) {
        const std::size_t here = j * part.width + i;
        if (!mask.empty() && mask[here] == 0) continue;
        add_pixel(window.left + i, window.top + j, from.in_pixels(back(part.middle(i, j))),
                  inside.empty() || inside[here] != 0);
      }
  }

  /// Nothing is printed around the marks.
  Result<void> keep_clear(const MarkLayout& marks, double quiet_mm, std::size_t sheet) {
    double nearest = quiet_mm;
    PagePoint where;
    for (const Box& mark : mark_boxes(marks)) {
      const Window window = window_of(out_.frame, {mark.x0 - quiet_mm, mark.y0 - quiet_mm,
                                                   mark.x1 + quiet_mm, mark.y1 + quiet_mm});
      for (std::size_t j = window.top; j < window.bottom; ++j)
        for (std::size_t i = window.left; i < window.right; ++i) {
          const PagePoint p = out_.frame.middle(i, j);
          const double far = distance_to(mark, p);
          if (far >= quiet_mm) continue;
          if (kept_[j * out_.frame.width + i] != 0 && far < nearest) nearest = far, where = p;
          std::memset(out_.image.at(i, j), 0, 4);
        }
    }
    if (nearest >= quiet_mm) return {};
    return fail(ErrorKind::Infeasible, fmt::format("sheet {}", sheet + 1),
                fmt::format("the artwork at ({:.1f}, {:.1f}) mm comes within {:.2f} mm of a "
                            "registration mark; {:g} mm must stay free: move the drawing with `at`",
                            where.x, where.y, nearest, quiet_mm));
  }

  PrintedSheet taken() { return std::move(out_); }

 private:
  void add_pixel(std::size_t i, std::size_t j, const PagePoint& at, bool inside) {
    const PixelFrame& from = artwork_.frame;
    if (!(at.x > -0.5 && at.y > -0.5 && at.x < static_cast<double>(from.width) - 0.5 &&
          at.y < static_cast<double>(from.height) - 0.5))
      return;
    const auto x = static_cast<std::size_t>(std::floor(at.x + 0.5)),
               y = static_cast<std::size_t>(std::floor(at.y + 0.5));
    if (inside && artwork_.on_paper[y * from.width + x] != 0) kept_[j * out_.frame.width + i] = 1;
    const Colour colour = colour_between(artwork_.image, at.x, at.y);
    if (colour.a > 0) out_.image.set(i, j, colour);
  }

  const Artwork& artwork_;
  const Trapping& how_;
  PrintedSheet out_;
  std::vector<std::uint8_t> kept_;  ///< one a pixel: the knife keeps the paper there
};

}  // namespace

Result<PrintedSheet> printed_sheet(const Artwork& artwork, const Plan& plan, std::size_t sheet,
                                   double pixel_mm, const Trapping& how, double quiet_mm) {
  const PlannedSheet& planned = plan.sheets[sheet];
  const PixelFrame frame =
      frame_around({0, 0, planned.area_mm[0], planned.area_mm[1]}, 0, pixel_mm);
  if (frame.pixels() > kMaxPixels)
    return fail(ErrorKind::OutOfRange, fmt::format("sheet {}", sheet + 1),
                fmt::format("would have {} x {} pixels; at most {} million are printed: use fewer "
                            "dots an inch",
                            frame.width, frame.height, kMaxPixels / 1'000'000));
  Printing printing(artwork, frame, how);
  for (const PieceMap& piece : pieces_on_sheet(plan, sheet)) printing.add(piece);
  if (planned.registration)
    if (auto clear = printing.keep_clear(*planned.registration, quiet_mm, sheet); !clear)
      return tl::unexpected(clear.error());
  return printing.taken();
}

ColourImage mirrored(const ColourImage& image) {
  ColourImage out(image.width, image.height);
  for (std::size_t j = 0; j < image.height; ++j)
    for (std::size_t i = 0; i < image.width; ++i)
      std::memcpy(out.at(image.width - 1 - i, j), image.at(i, j), 4);
  return out;
}

}  // namespace popcut
