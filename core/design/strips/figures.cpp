// SPDX-License-Identifier: MIT
#include "core/design/strips/figures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace popcut {
namespace {

/// Collects squares and the largest of absolute values.
class Errors {
 public:
  void add(double e) {
    sum_ += e * e;
    most_ = std::max(most_, std::abs(e));
    ++count_;
  }
  [[nodiscard]] ErrorFigures figures() const {
    return {count_ == 0 ? 0.0 : std::sqrt(sum_ / static_cast<double>(count_)), most_, count_};
  }

 private:
  double sum_{}, most_{};
  std::size_t count_{};
};

/// Fold vertices of the strips at one station, in the order along the strip.
struct Row {
  double s_mm{};
  std::vector<SectionPoint> points;
};

/// The valley points of a strip with its wall and ground ends.
void add_valleys(const Strips& strips, std::size_t s, std::vector<SectionPoint>& out) {
  const std::uint32_t begin = strips.first_panel[s], end = strips.first_panel[s + 1];
  for (std::uint32_t p = begin; p < end; ++p) {
    const std::size_t q = p + s;
    const bool level = strips.z[q] == strips.z[q + 1];
    if (!level) continue;
    const bool starts_loose = p == begin;  // without a card: the wall end itself
    if (starts_loose || strips.x[q - 1] == strips.x[q]) out.push_back({strips.x[q], strips.z[q]});
  }
  const std::size_t last = end + s;
  if (begin < end && strips.x[last - 1] == strips.x[last])
    out.push_back({strips.x[last], strips.z[last]});
}

/// Distance to the nearest fold vertex: rows are searched outward from the point's own station, and
/// in a row outward from its place x - z along the chord, by which the vertices are sorted.
class NearestVertex {
 public:
  NearestVertex(std::vector<Row> rows, double cosine) : rows_(std::move(rows)), cosine_(cosine) {}

  [[nodiscard]] double distance(double s_mm, SectionPoint p) const {
    double best2 = std::numeric_limits<double>::infinity();
    const auto after = std::lower_bound(rows_.begin(), rows_.end(), s_mm,
                                        [](const Row& row, double s) { return row.s_mm < s; });
    auto up = after;
    auto down = after;
    bool more = true;
    while (more) {
      more = false;
      if (up != rows_.end() && square(up->s_mm - s_mm) < best2) {
        search(*up, s_mm, p, best2);
        ++up, more = true;
      }
      if (down != rows_.begin() && square(std::prev(down)->s_mm - s_mm) < best2) {
        --down;
        search(*down, s_mm, p, best2);
        more = true;
      }
    }
    return std::sqrt(best2);
  }

 private:
  static double square(double a) { return a * a; }
  void search(const Row& row, double s_mm, SectionPoint p, double& best2) const {
    const double along = p.x - p.z, apart2 = square(row.s_mm - s_mm);
    const auto middle =
        std::lower_bound(row.points.begin(), row.points.end(), along,
                         [](const SectionPoint& a, double want) { return a.x - a.z < want; });
    const auto visit = [&](const SectionPoint& q) {
      if (apart2 + 0.5 * (1.0 - cosine_) * square(q.x - q.z - along) >= best2) return false;
      best2 = std::min(best2, apart2 + square(q.x - p.x) + square(q.z - p.z) +
                                  2.0 * cosine_ * (q.x - p.x) * (q.z - p.z));
      return true;
    };
    for (auto it = middle; it != row.points.end() && visit(*it); ++it) {
    }
    for (auto it = middle; it != row.points.begin() && visit(*std::prev(it)); --it) {
    }
  }
  std::vector<Row> rows_;
  double cosine_{};  ///< of the angle between the axes of x and z
};

double largest_gap(const FigureInput& input, std::vector<Row> rows) {
  // Enough points that none lies farther from a sample than a small part of a step.
  std::vector<TargetStation> stations = input.slices;
  stations.insert(stations.end(), input.connectors.begin(), input.connectors.end());
  std::size_t vertices = 0;
  for (const Row& row : rows) vertices += row.points.size();
  const std::size_t a_row =
      std::max<std::size_t>(1, vertices / std::max<std::size_t>(1, rows.size()));
  constexpr std::size_t kMostSamples = 100'000;
  const std::size_t samples = std::clamp<std::size_t>(8 * a_row, 32, 400);
  const std::size_t stride = std::max<std::size_t>(1, stations.size() * samples / kMostSamples);
  const NearestVertex nearest(std::move(rows), input.opening.cosine);
  double most = 0.0;
  for (std::size_t k = 0; k < stations.size(); k += stride)
    for (std::size_t i = 0; i <= samples; ++i) {
      const CurveJet c =
          stations[k].curve->at(-1.0 + 2.0 * static_cast<double>(i) / static_cast<double>(samples));
      most = std::max(most, nearest.distance(stations[k].s_mm, {c.x, c.z}));
    }
  return most;
}

}  // namespace

LatticeFigures measure(const FigureInput& input) {
  const Strips& strips = input.strips;
  LatticeFigures out;
  Errors inner, ends;
  std::vector<Row> rows, slice_rows;
  double shortest = std::numeric_limits<double>::infinity(), longest = 0.0;
  std::size_t slice = 0, connector = 0;
  for (std::size_t s = 0; s < strips.size(); ++s) {
    if (strips.kind[s] == StripKind::Margin || strips.kind[s] == StripKind::Bridge ||
        strips.kind[s] == StripKind::Blank)
      continue;
    const bool is_connector = strips.kind[s] == StripKind::Connector;
    const TargetStation& station =
        is_connector ? input.connectors[connector++] : input.slices[slice++];
    Row row{station.s_mm, {}};
    add_valleys(strips, s, row.points);
    if (!is_connector) {
      (strips.kind[s] == StripKind::Box ? rows : slice_rows).push_back(std::move(row));
      continue;
    }
    for (std::size_t i = 1; i + 1 < row.points.size(); ++i)
      inner.add(station.curve->nearest_distance(row.points[i]));
    // A connector's wall end is the height that one of its two slices brought, its ground end an
    // offset; each is compared with the end of the slice it came from.
    const auto end_of = [&](int level, bool height) -> const SliceCurve& {
      const bool left_holds =
          input.left_parity[connector - 1] == ((level & 1) != 0) ? height : !height;
      return *input.slices[slice - (left_holds ? 1 : 0)].curve;
    };
    const std::uint32_t first =
        strips.first_panel[s] + (strips.level[strips.first_panel[s]] < 0 ? 1 : 0);
    const std::uint32_t last =
        strips.first_panel[s + 1] - (strips.level[strips.first_panel[s + 1] - 1] < 0 ? 2 : 1);
    ends.add(row.points.front().z - end_of(strips.level[first], true).h());
    ends.add(row.points.back().x - end_of(strips.level[last], false).d());
    for (std::uint32_t p = first; p <= last; ++p) {
      const std::size_t q = p + s;
      const double step = (strips.x[q + 1] - strips.x[q]) + (strips.z[q] - strips.z[q + 1]);
      shortest = std::min(shortest, step);
      if (step > longest) longest = step, out.longest_step_s_mm = station.s_mm;
    }
    rows.push_back(std::move(row));
  }
  out.inner_error = inner.figures();
  out.end_error = ends.figures();
  if (longest > 0.0) {
    out.step_over_mean_min = shortest / input.mean_step_mm;
    out.step_over_mean_max = longest / input.mean_step_mm;
  } else {
    out.step_over_mean_min = out.step_over_mean_max = 1.0;
  }
  // A lattice without connectors or boxes is single strips: their own valleys have to do.
  out.gap_mm = largest_gap(input, rows.empty() ? std::move(slice_rows) : std::move(rows));
  return out;
}

}  // namespace popcut
