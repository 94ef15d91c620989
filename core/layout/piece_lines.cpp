// SPDX-License-Identifier: MIT
#include "core/layout/piece_lines.hpp"

#include <algorithm>
#include <cmath>

namespace popcut {
namespace {

constexpr double kNear = 1e-5;  // mm; a plan rounds its numbers to 1e-6
constexpr double kSameLine = 1e-3;

// How far `p` lies from the line through a and b, and where along it.
struct Foot {
  double aside{}, along{};
};
Foot foot(const PagePoint& p, const PagePoint& a, const PagePoint& b) {
  const double l = distance(a, b), ux = (b.x - a.x) / l, uy = (b.y - a.y) / l;
  return {(p.y - a.y) * ux - (p.x - a.x) * uy, (p.x - a.x) * ux + (p.y - a.y) * uy};
}

class PieceLines {
 public:
  PieceLines(const LineWork& drawing, const LineIndex& lines, const PlannedPiece& piece)
      : drawing_(drawing), lines_(lines), piece_(piece), box_(bounds(piece.share)) {
    for (const PlannedPiece::Seam& seam : piece.seams)
      seams_.push_back({back(seam.ends[0]), back(seam.ends[1])});
    outlined_ = std::any_of(drawing.lines.begin(), drawing.lines.end(), [](const DrawnLine& line) {
      return line.operation == Operation::Outline;
    });
  }

  LineWork run() {
    out_.name = drawing_.name;
    for (const DrawnLine& line : drawing_.lines) {
      const auto points = drawing_.points_of(line);
      for (std::size_t i = 1; i < points.size(); ++i)
        clip(line.operation, points[i - 1], points[i]);
    }
    for (std::size_t s = 0; s < seams_.size(); ++s) {
      covered(seams_[s]);
      for (const auto& [from, to] : piece_.seams[s].glued) glued(from, to);
    }
    return std::move(out_);
  }

 private:
  // The inverse of a rigid move is its transpose.
  [[nodiscard]] PagePoint back(const PagePoint& p) const {
    const Placement& t = piece_.to_sheet;
    const double x = p.x - t.x0, y = p.y - t.y0;
    return {t.xx * x + t.yx * y, t.xy * x + t.yy * y};
  }

  void put(PenOperation operation, const PagePoint& a, const PagePoint& b) {
    out_.append(operation, std::array{piece_.to_sheet(a), piece_.to_sheet(b)});
  }

  [[nodiscard]] bool in_share(const PagePoint& p) const {
    bool inside = false;
    for (std::size_t i = 0, n = piece_.share.size(); i < n; ++i) {
      const PagePoint &a = piece_.share[i], &b = piece_.share[(i + 1) % n];
      if (a.y == b.y && std::abs(p.y - a.y) <= kNear && p.x >= std::min(a.x, b.x) - kNear &&
          p.x <= std::max(a.x, b.x) + kNear)
        return true;  // on a side of the polygon
      if (a.x == b.x && std::abs(p.x - a.x) <= kNear && p.y >= std::min(a.y, b.y) - kNear &&
          p.y <= std::max(a.y, b.y) + kNear)
        return true;
      if ((a.y > p.y) != (b.y > p.y) && a.x < p.x) inside = !inside;
    }
    return inside;
  }

  [[nodiscard]] bool on_seam(const PagePoint& a, const PagePoint& b) const {
    const PagePoint middle = lerp(a, b, 0.5);
    return std::any_of(seams_.begin(), seams_.end(), [&](const auto& seam) {
      const Foot fa = foot(a, seam[0], seam[1]), fb = foot(b, seam[0], seam[1]);
      const double along = foot(middle, seam[0], seam[1]).along;
      return std::abs(fa.aside) <= kNear && std::abs(fb.aside) <= kNear && along > 0.0 &&
             along < distance(seam[0], seam[1]);
    });
  }

  // Adds the parts of a segment within the piece, except what runs along a seam.
  void clip(PenOperation operation, const PagePoint& a, const PagePoint& b) {
    if (std::max(a.x, b.x) < box_.x0 - kNear || std::min(a.x, b.x) > box_.x1 + kNear ||
        std::max(a.y, b.y) < box_.y0 - kNear || std::min(a.y, b.y) > box_.y1 + kNear)
      return;
    at_.assign({0.0, 1.0});
    const auto meet = [&](double from, double to, double side) {
      if (std::abs(to - from) <= kNear) return;
      const double k = (side - from) / (to - from);
      if (k > 0.0 && k < 1.0) at_.push_back(k);
    };
    for (const PagePoint& corner : piece_.share) {
      meet(a.x, b.x, corner.x);
      meet(a.y, b.y, corner.y);
    }
    std::sort(at_.begin(), at_.end());
    const double l = distance(a, b);
    double from = -1.0;  // start of the part inside that is not added yet
    for (std::size_t i = 1; i < at_.size(); ++i) {
      if ((at_[i] - at_[i - 1]) * l <= kNear) continue;
      const PagePoint p = lerp(a, b, at_[i - 1]), q = lerp(a, b, at_[i]);
      const bool here = in_share(lerp(p, q, 0.5)) && !on_seam(p, q);
      if (here && from < 0.0) from = at_[i - 1];
      if (here) continue;
      if (from >= 0.0) put(operation, lerp(a, b, from), p);
      from = -1.0;
    }
    if (from >= 0.0) put(operation, lerp(a, b, from), b);
  }

  // Where the drawing cuts along a seam anyway, the cut is part of this piece's border if its side
  // is paper.
  void covered(const std::array<PagePoint, 2>& seam) {
    AxisLine line{std::abs(seam[0].x - seam[1].x) <= kNear, 0.0};
    line.at = line.vertical ? seam[0].x : seam[0].y;
    for (const PagePoint& corner : piece_.share)  // the corners are not rounded
      if (const double at = line.vertical ? corner.x : corner.y; std::abs(at - line.at) <= kNear)
        line.at = at;
    const auto t_of = [&](const PagePoint& p) { return line.vertical ? p.y : p.x; };
    const double low = std::min(t_of(seam[0]), t_of(seam[1]));
    const double high = std::max(t_of(seam[0]), t_of(seam[1]));
    SeamScan scan;
    lines_.scan(line, low, high, 0.0, scan);
    for (const SeamStretch& cut : scan.covered) {
      const double middle = (cut.from + cut.to) / 2;
      for (const double side : {-kSameLine, kSameLine}) {
        const PagePoint beside = line.point(middle, side);
        if (in_share(beside) && lines_.is_paper(beside))
          put(border(), line.point(cut.from, 0), line.point(cut.to, 0));
      }
    }
  }

  // Adds a glued stretch: along the seam, and around the tabs on it.
  void glued(const PagePoint& from, const PagePoint& to) {
    const double l = distance(from, to);
    if (!(l > 0.0)) return;
    struct Root {
      double from{}, to{};
      std::size_t tab{};
    };
    std::vector<Root> roots;
    for (std::size_t i = 0; i < piece_.tabs.size(); ++i) {
      const Foot a = foot(piece_.tabs[i][0], from, to), b = foot(piece_.tabs[i][3], from, to);
      const double middle = (a.along + b.along) / 2;
      if (std::abs(a.aside) > kNear || std::abs(b.aside) > kNear || middle < 0.0 || middle > l)
        continue;
      roots.push_back({std::min(a.along, b.along), std::max(a.along, b.along), i});
    }
    std::sort(roots.begin(), roots.end(),
              [](const Root& a, const Root& b) { return a.from < b.from; });
    double reached = 0.0;
    const auto straight = [&](double until) {
      if (until - reached > kNear)
        out_.append(border(), std::array{lerp(from, to, reached / l), lerp(from, to, until / l)});
    };
    for (const Root& root : roots) {
      straight(root.from);
      out_.append(border(), piece_.tabs[root.tab]);
      reached = root.to;
    }
    straight(l);
  }

  [[nodiscard]] Operation border() const { return outlined_ ? Operation::Outline : Operation::Cut; }

  const LineWork& drawing_;
  const LineIndex& lines_;
  const PlannedPiece& piece_;
  Box box_;
  std::vector<std::array<PagePoint, 2>> seams_;  ///< drawing mm
  bool outlined_{false};
  std::vector<double> at_;
  LineWork out_;
};

}  // namespace

LineWork lines_of_piece(const LineWork& drawing, const LineIndex& lines,
                        const PlannedPiece& piece) {
  return PieceLines(drawing, lines, piece).run();
}

}  // namespace popcut
