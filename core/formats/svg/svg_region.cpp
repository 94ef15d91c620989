// SPDX-License-Identifier: MIT
#include "core/formats/svg/svg_region.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

#include "core/drawing/linework.hpp"

namespace popcut {
namespace {

// Points this near are one: a share of the largest coordinate, since a drawing may become larger
// after it is read, and at most 1 nm.
constexpr double kSameShare = 1e-8, kMostSame_mm = 1e-6;
constexpr double kLeastShare = 1e-15;  // what a double tells apart
constexpr double kAside = 10.0;        // times as far beside a line its sides are looked at

PagePoint on_line(const PagePoint& a, const PagePoint& b, double t) {
  return {std::lerp(a.x, b.x, t), std::lerp(a.y, b.y, t)};
}

// Appends `run` as a line and empties it.
void end_run(std::vector<PagePoint>& run, SvgLines& out) {
  if (run.size() > 1) {
    out.points.insert(out.points.end(), run.begin(), run.end());
    out.ends.push_back(static_cast<std::uint32_t>(out.points.size()));
  }
  run.clear();
}

// Gives points that are the same up to rounding the same number.
class NumberedPoints {
 public:
  explicit NumberedPoints(double same_mm) : same_mm_(same_mm) {}

  std::uint32_t number(const PagePoint& p) {
    const auto x = static_cast<std::int64_t>(std::floor(p.x / (2 * same_mm_)));
    const auto y = static_cast<std::int64_t>(std::floor(p.y / (2 * same_mm_)));
    for (std::int64_t i = x - 1; i <= x + 1; ++i)
      for (std::int64_t k = y - 1; k <= y + 1; ++k)
        if (const auto found = cells_.find({i, k});
            found != cells_.end() && distance(points_[found->second], p) <= 2 * same_mm_)
          return found->second;
    const auto next = static_cast<std::uint32_t>(points_.size());
    cells_.try_emplace({x, y}, next);
    points_.push_back(p);
    return next;
  }
  [[nodiscard]] const PagePoint& operator[](std::uint32_t number) const { return points_[number]; }

 private:
  double same_mm_;
  std::vector<PagePoint> points_;
  std::map<std::pair<std::int64_t, std::int64_t>, std::uint32_t> cells_;
};

}  // namespace

SvgRegion::Part SvgRegion::add_shape(const SvgLines& lines, bool even_odd) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto line = lines[i];
    for (std::size_t k = 0; k < line.size(); ++k) {
      const PagePoint& b = line[(k + 1) % line.size()];
      if (line[k] != b) edges_.push_back({line[k], b, shapes_});
    }
  }
  nodes_.push_back({even_odd ? Node::Kind::EvenOdd : Node::Kind::NonZero, shapes_++, {}});
  return static_cast<Part>(nodes_.size() - 1);
}

SvgRegion::Part SvgRegion::add_any(std::vector<Part> parts) {
  nodes_.push_back({Node::Kind::Any, 0, std::move(parts)});
  return static_cast<Part>(nodes_.size() - 1);
}

SvgRegion::Part SvgRegion::add_all(std::vector<Part> parts) {
  nodes_.push_back({Node::Kind::All, 0, std::move(parts)});
  return static_cast<Part>(nodes_.size() - 1);
}

SvgRegion::Part SvgRegion::add_region(const SvgRegion& other) {
  const auto first = static_cast<Part>(nodes_.size());
  for (Edge edge : other.edges_) {
    edge.shape += shapes_;
    edges_.push_back(edge);
  }
  for (Node node : other.nodes_) {
    node.shape += shapes_;
    for (Part& part : node.parts) part += first;
    nodes_.push_back(std::move(node));
  }
  shapes_ += other.shapes_;
  return first + other.area_;
}

void SvgRegion::finish(Part area) {
  area_ = area;
  windings_.assign(shapes_, 0);
  bands_.clear();
  if (edges_.empty()) return;
  double most = edges_[0].a.y, largest = 0.0;
  least_y_ = most;
  for (const Edge& e : edges_) {
    largest =
        std::max({largest, std::abs(e.a.x), std::abs(e.a.y), std::abs(e.b.x), std::abs(e.b.y)});
    least_y_ = std::min({least_y_, e.a.y, e.b.y});
    most = std::max({most, e.a.y, e.b.y});
  }
  same_mm_ = std::min(kSameShare * largest, std::max(kMostSame_mm, kLeastShare * largest));
  // A tall edge is in many bands: their number stays small if there are many edges.
  const auto n = static_cast<double>(edges_.size());
  const double count = std::max(1.0, std::floor(std::min(2.0 * std::sqrt(n), 1e7 / n)));
  band_height_ = std::max((most - least_y_) / count, 1e-3 * same_mm_);
  bands_.resize(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const auto [first, last] = bands_of(std::min(edges_[i].a.y, edges_[i].b.y) - same_mm_,
                                        std::max(edges_[i].a.y, edges_[i].b.y) + same_mm_);
    for (std::size_t k = first; k < last; ++k) bands_[k].push_back(static_cast<std::uint32_t>(i));
  }
}

SvgRegion::Band SvgRegion::bands_of(double y0, double y1) const {
  const auto most = static_cast<double>(bands_.size());
  const double first = std::floor((y0 - least_y_) / band_height_);
  const double last = std::floor((y1 - least_y_) / band_height_);
  // The lowest edge ends at the border of the last band.
  if (last < 0.0 || first > most || bands_.empty()) return {};
  return {static_cast<std::size_t>(std::clamp(first, 0.0, most - 1.0)),
          static_cast<std::size_t>(std::clamp(last, 0.0, most - 1.0)) + 1};
}

bool SvgRegion::holds(Part part) const {
  const Node& node = nodes_[part];
  const auto is = [this](Part one) { return holds(one); };
  switch (node.kind) {
    case Node::Kind::NonZero:
      return windings_[node.shape] != 0;
    case Node::Kind::EvenOdd:
      return windings_[node.shape] % 2 != 0;
    case Node::Kind::Any:
      return std::any_of(node.parts.begin(), node.parts.end(), is);
    case Node::Kind::All:
      break;
  }
  return std::all_of(node.parts.begin(), node.parts.end(), is);
}

bool SvgRegion::contains(const PagePoint& p, std::size_t& steps) const {
  std::fill(windings_.begin(), windings_.end(), 0);
  const auto [first, last] = bands_of(p.y, p.y);
  if (first != last) {
    const auto& band = bands_[first];
    steps -= std::min(steps, band.size() + windings_.size());
    if (steps == 0) return false;
    for (const std::uint32_t i : band) {
      const Edge& e = edges_[i];
      if ((e.a.y <= p.y) == (e.b.y <= p.y)) continue;
      const double side = (e.b.x - e.a.x) * (p.y - e.a.y) - (p.x - e.a.x) * (e.b.y - e.a.y);
      const bool down = e.b.y > e.a.y;
      if (down ? side > 0.0 : side < 0.0) windings_[e.shape] += down ? 1 : -1;
    }
  }
  return holds(area_);
}

bool SvgRegion::contains_corner_of(const SvgRegion& other, std::size_t& steps) const {
  return std::any_of(other.edges_.begin(), other.edges_.end(),
                     [&](const Edge& e) { return contains(e.a, steps); });
}

void SvgRegion::meet(const PagePoint& a, const PagePoint& b, std::size_t& steps) const {
  places_.assign({0.0, 1.0});
  const double rx = b.x - a.x, ry = b.y - a.y, r2 = rx * rx + ry * ry, r = std::sqrt(r2);
  const double x0 = std::min(a.x, b.x) - same_mm_, x1 = std::max(a.x, b.x) + same_mm_;
  const double y0 = std::min(a.y, b.y) - same_mm_, y1 = std::max(a.y, b.y) + same_mm_;
  const auto add = [&](double t) {
    if (t > 0.0 && t < 1.0) places_.push_back(t);
  };
  const auto [first, last] = bands_of(y0, y1);
  for (std::size_t k = first; k < last; ++k) {
    steps -= std::min(steps, bands_[k].size());
    if (steps == 0) return;
    for (const std::uint32_t i : bands_[k]) {
      const PagePoint &c = edges_[i].a, &d = edges_[i].b;
      if (std::max(c.x, d.x) < x0 || std::min(c.x, d.x) > x1 || std::max(c.y, d.y) < y0 ||
          std::min(c.y, d.y) > y1)
        continue;
      const double sx = d.x - c.x, sy = d.y - c.y, s = std::hypot(sx, sy);
      const double across = rx * sy - ry * sx, cx = c.x - a.x, cy = c.y - a.y;
      if (std::abs(across) > 1e-12 * r * s) {
        const double u = (cx * ry - cy * rx) / across;
        if (u * s >= -same_mm_ && (u - 1.0) * s <= same_mm_) add((cx * sy - cy * sx) / across);
      }
      // Edges along the line begin and end somewhere on it.
      for (const PagePoint& p : {c, d})
        if (std::abs((p.x - a.x) * ry - (p.y - a.y) * rx) <= same_mm_ * r)
          add(((p.x - a.x) * rx + (p.y - a.y) * ry) / r2);
    }
  }
  std::sort(places_.begin(), places_.end());
}

bool SvgRegion::cut(std::span<const PagePoint> line, std::size_t& steps, SvgLines& out) const {
  const std::size_t lines_before = out.ends.size(), points_before = out.points.size();
  std::vector<PagePoint> run;
  PagePoint end{};
  bool lost = false, first_kept = false, state = false;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const PagePoint &a = line[i - 1], &b = line[i];
    const double length = distance(a, b);
    if (!(length > 0.0)) continue;
    meet(a, b, steps);
    const std::vector<double> places = places_;
    const PagePoint aside{-(b.y - a.y) / length * kAside * same_mm_,
                          (b.x - a.x) / length * kAside * same_mm_};
    double from = 0.0;
    for (std::size_t k = 1; k < places.size(); ++k) {
      const double to = places[k];
      const bool is_last = k + 1 == places.size();
      if ((to - from) * length <= same_mm_ && !is_last) continue;
      if ((to - from) * length > same_mm_) {
        const PagePoint m = on_line(a, b, (from + to) / 2);
        state = contains(m, steps) || contains({m.x + aside.x, m.y + aside.y}, steps) ||
                contains({m.x - aside.x, m.y - aside.y}, steps);
      }
      if (i == 1 && from == 0.0) first_kept = state;
      if (state) {
        if (run.empty()) run.push_back(on_line(a, b, from));
        end = on_line(a, b, to);
        if (is_last) run.push_back(b);
      } else {
        lost = true;
        if (!run.empty() && run.back() != end) run.push_back(end);
        end_run(run, out);
      }
      from = to;
    }
  }
  const bool last_kept = !run.empty();
  end_run(run, out);
  if (lost && first_kept && last_kept && line.front() == line.back() &&
      out.ends.size() >= lines_before + 2) {
    // The last part goes on as the first.
    const std::size_t last_first = out.ends[out.ends.size() - 2];
    std::vector<PagePoint> joined(out.points.begin() + static_cast<std::ptrdiff_t>(last_first),
                                  out.points.end());
    const auto begin = out.points.begin() + static_cast<std::ptrdiff_t>(points_before);
    joined.insert(joined.end(), begin + 1,
                  out.points.begin() + static_cast<std::ptrdiff_t>(out.ends[lines_before]));
    std::vector<PagePoint> middle(
        out.points.begin() + static_cast<std::ptrdiff_t>(out.ends[lines_before]),
        out.points.begin() + static_cast<std::ptrdiff_t>(last_first));
    const auto gone = static_cast<std::uint32_t>(out.ends[lines_before] - points_before);
    out.points.resize(points_before);
    out.points.insert(out.points.end(), middle.begin(), middle.end());
    out.points.insert(out.points.end(), joined.begin(), joined.end());
    out.ends.erase(out.ends.begin() + static_cast<std::ptrdiff_t>(lines_before));
    for (std::size_t i = lines_before; i < out.ends.size(); ++i) out.ends[i] -= gone;
    out.ends.back() = static_cast<std::uint32_t>(out.points.size());
  }
  return lost;
}

// What lies on one side of it inside and on the other side outside is the border. It is turned so
// that the inside is on the same side everywhere: then as many parts begin as end at each point,
// and a walk along them comes back to where it began.
SvgLines SvgRegion::border(std::size_t& steps) const {
  struct Piece {
    std::uint32_t from{}, to{};
    bool used{false};
  };
  NumberedPoints points(same_mm_);
  std::vector<Piece> pieces;
  std::set<std::pair<std::uint32_t, std::uint32_t>> known;
  for (const Edge& e : edges_) {
    const double length = distance(e.a, e.b);
    meet(e.a, e.b, steps);
    if (steps == 0) return {};
    const std::vector<double> places = places_;
    const PagePoint aside{-(e.b.y - e.a.y) / length * kAside * same_mm_,
                          (e.b.x - e.a.x) / length * kAside * same_mm_};
    for (std::size_t k = 1; k < places.size(); ++k) {
      std::uint32_t from = points.number(on_line(e.a, e.b, places[k - 1]));
      std::uint32_t to = points.number(on_line(e.a, e.b, places[k]));
      if (from == to) continue;
      const PagePoint m = on_line(e.a, e.b, (places[k - 1] + places[k]) / 2);
      const bool left = contains({m.x + aside.x, m.y + aside.y}, steps);
      if (left == contains({m.x - aside.x, m.y - aside.y}, steps)) continue;
      if (!left) std::swap(from, to);
      if (known.insert({from, to}).second) pieces.push_back({from, to});
    }
  }
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> beginning;
  for (std::size_t i = pieces.size(); i-- > 0;)
    beginning[pieces[i].from].push_back(static_cast<std::uint32_t>(i));
  SvgLines out;
  std::vector<PagePoint> run;
  for (Piece& first : pieces) {
    if (first.used) continue;
    run.push_back(points[first.from]);
    for (Piece* piece = &first; piece != nullptr;) {
      piece->used = true;
      run.push_back(points[piece->to]);
      if (piece->to == first.from) break;
      Piece* next = nullptr;
      if (const auto found = beginning.find(piece->to); found != beginning.end())
        for (auto& list = found->second; next == nullptr && !list.empty(); list.pop_back())
          if (!pieces[list.back()].used) next = &pieces[list.back()];
      piece = next;
    }
    end_run(run, out);
  }
  return out;
}

}  // namespace popcut
