// SPDX-License-Identifier: MIT
#include "core/curvature/fold_vertices.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/curvature/fold_lines.hpp"

namespace popcut {
namespace {

constexpr std::int32_t kNoVertex = -1;
constexpr double kTolerance = 1e-6;  // of the sheet's size, for what is meant to be equal

/// A line across one strip, with where its two panels are within the strip's own staircase.
struct Crossing {
  std::uint32_t line{};
  double x{}, z{};
};

/// A strip recognised as a connector.
struct Connector {
  std::size_t strip{};
  std::vector<Crossing> folds;  ///< along u, alternating
  bool placed{};
  double shift_x{}, shift_z{};
  std::int32_t shift_level{};
  std::uint32_t component{};
};

/// Where a mountain is among the connectors: its place in the list of the one or two it crosses.
struct Link {
  std::int32_t connector[2]{kNoVertex, kNoVertex};
  std::uint32_t at[2]{};
};

class VertexFinder {
 public:
  VertexFinder(std::vector<FoldLine> lines, double size)
      : lines_(std::move(lines)), tolerance_(kTolerance * size) {}

  Result<std::vector<FoldVertex>> find() {
    if (auto done = lay_strips(); !done) return tl::unexpected(done.error());
    choose_connectors();
    if (connectors_.empty()) {
      return fail(ErrorKind::Infeasible, "",
                  "has no connector strips between slices, so no fold vertices; a lattice of two "
                  "units and two slices or more is needed");
    }
    link_mountains();
    for (std::uint32_t c = 0; c < connectors_.size(); ++c) place_from(c);
    if (auto done = check_closed(); !done) return tl::unexpected(done.error());
    shift_to_corner();
    return vertices();
  }

 private:
  [[nodiscard]] std::size_t strips() const { return borders_.empty() ? 0 : borders_.size() - 1; }

  /// Cuts the sheet along v wherever a fold ends, and hands each strip the lines across it.
  Result<void> lay_strips() {
    for (const FoldLine& line : lines_) borders_.insert(borders_.end(), {line.v0, line.v1});
    std::sort(borders_.begin(), borders_.end());
    const auto same = [&](double a, double b) { return b - a <= tolerance_; };
    borders_.erase(std::unique(borders_.begin(), borders_.end(), same), borders_.end());
    std::size_t total = 0;
    constexpr std::size_t kMostCrossings = 20'000'000;
    for (const FoldLine& line : lines_) {
      const std::size_t first = border(line.v0), last = border(line.v1);
      range_.push_back({first, last});
      total += last - first;
      if (total > kMostCrossings) {
        return fail(ErrorKind::OutOfRange, "",
                    "its folds cross too many strips to be a lattice; at most 20 million crossings "
                    "are looked at");
      }
    }
    crossing_.resize(strips());
    std::vector<std::uint32_t> by_u(lines_.size());
    for (std::uint32_t k = 0; k < by_u.size(); ++k) by_u[k] = k;
    std::sort(by_u.begin(), by_u.end(), [&](std::uint32_t a, std::uint32_t b) {
      return lines_[a].u != lines_[b].u ? lines_[a].u < lines_[b].u : a < b;
    });
    for (const std::uint32_t k : by_u) {
      for (std::size_t s = range_[k].first; s < range_[k].last; ++s) crossing_[s].push_back(k);
    }
    return {};
  }

  [[nodiscard]] std::size_t border(double v) const {
    return static_cast<std::size_t>(
        std::lower_bound(borders_.begin(), borders_.end(), v - tolerance_) - borders_.begin());
  }

  /// The folds across strip `s` along u, with the sheet's border for a valley where the strip has
  /// no card to begin or end on.
  [[nodiscard]] std::vector<std::uint32_t> folds_across(std::size_t s) const {
    std::vector<std::uint32_t> folds;
    constexpr std::uint32_t kNoBorder = ~std::uint32_t{0};
    std::uint32_t border = kNoBorder;
    for (const std::uint32_t k : crossing_[s]) {
      if (lines_[k].border) {
        if (folds.empty() || border == kNoBorder) border = k;
        continue;
      }
      if (folds.empty() && lines_[k].mountain && border != kNoBorder) folds.push_back(border);
      border = kNoBorder;
      folds.push_back(k);
    }
    if (!folds.empty() && lines_[folds.back()].mountain && border != kNoBorder)
      folds.push_back(border);
    return folds;
  }

  /// Whether the mountains of strip `s` run on as a connector's do (see the header).
  [[nodiscard]] bool like_connector(std::size_t s, const std::vector<std::uint32_t>& across) const {
    bool to_left = false, to_right = false;
    for (std::size_t k = 0; k < across.size(); ++k) {
      const FoldLine& line = lines_[across[k]];
      if (k > 0 && line.mountain == lines_[across[k - 1]].mountain) return false;
      if (!line.mountain) continue;
      const bool left = range_[across[k]].first<s, right = range_[across[k]].last> s + 1;
      if (left && right) return false;
      to_left |= left;
      to_right |= right;
    }
    return to_left && to_right;
  }

  /// Where levels end, a slice's mountains may look like a connector's. No two neighbours are both
  /// connectors, and a connector has about twice as many folds as a slice: so of strips in a row
  /// that look like it, every other one is taken, from where there are more folds on average.
  void choose_connectors() {
    std::vector<std::vector<std::uint32_t>> row;
    const auto close_row = [&](std::size_t end) {
      std::array<double, 2> sum{}, count{};
      for (std::size_t k = 0; k < row.size(); ++k) {
        sum[k % 2] += static_cast<double>(row[k].size());
        ++count[k % 2];
      }
      const bool second = count[1] > 0 && sum[1] / count[1] > sum[0] / count[0];
      for (std::size_t k = second ? 1 : 0; k < row.size(); k += 2)
        keep_connector(end - row.size() + k, row[k]);
      row.clear();
    };
    for (std::size_t s = 1; s + 1 < strips(); ++s) {
      std::vector<std::uint32_t> across = folds_across(s);
      if (like_connector(s, across)) {
        row.push_back(std::move(across));
      } else {
        close_row(s);
      }
    }
    if (strips() > 1) close_row(strips() - 1);
  }

  void keep_connector(std::size_t s, const std::vector<std::uint32_t>& across) {
    Connector connector;
    connector.strip = s;
    double x = 0, z = 0;
    for (std::size_t k = 0; k < across.size(); ++k) {
      if (k > 0) {
        const double step = lines_[across[k]].u - lines_[across[k - 1]].u;
        if (lines_[across[k]].mountain) {
          x += step;  // after a valley the panel is level
        } else {
          z -= step;
        }
      }
      connector.folds.push_back({across[k], x, z});
    }
    connectors_.push_back(std::move(connector));
  }

  void link_mountains() {
    links_.resize(lines_.size());
    for (std::uint32_t c = 0; c < connectors_.size(); ++c) {
      const auto& folds = connectors_[c].folds;
      for (std::uint32_t k = 0; k < folds.size(); ++k) {
        if (!lines_[folds[k].line].mountain) continue;
        Link& link = links_[folds[k].line];
        const int end = link.connector[0] == kNoVertex ? 0 : 1;
        link.connector[end] = static_cast<std::int32_t>(c);
        link.at[end] = k;
      }
    }
  }

  /// The other connector that the fold at `k` of connector `c` runs into, and its place there;
  /// valleys run into none.
  struct Beyond {
    std::int32_t connector{kNoVertex};
    std::uint32_t at{};
  };
  [[nodiscard]] Beyond beyond(std::uint32_t c, std::size_t k) const {
    const Link& link = links_[connectors_[c].folds[k].line];
    const int other = link.connector[0] == static_cast<std::int32_t>(c) ? 1 : 0;
    return {link.connector[other], link.at[other]};
  }
  /// Number of valleys before place `k` of connector `c`.
  [[nodiscard]] std::int32_t valleys_before(std::uint32_t c, std::size_t k) const {
    const bool valley_first = !lines_[connectors_[c].folds.front().line].mountain;
    return static_cast<std::int32_t>((k + (valley_first ? 1 : 0)) / 2);
  }

  /// Places every connector that hangs together with `first`, which itself stays where it is.
  void place_from(std::uint32_t first) {
    if (connectors_[first].placed) return;
    std::vector<std::uint32_t> queue{first};
    connectors_[first].placed = true;
    connectors_[first].component = components_;
    while (!queue.empty()) {
      const std::uint32_t c = queue.back();
      queue.pop_back();
      const Connector& here = connectors_[c];
      for (std::size_t k = 0; k < here.folds.size(); ++k) {
        const Beyond there = beyond(c, k);
        if (there.connector == kNoVertex) continue;
        const auto next = static_cast<std::uint32_t>(there.connector);
        Connector& other = connectors_[next];
        if (other.placed) continue;
        other.placed = true;
        other.component = components_;
        other.shift_x = here.shift_x + here.folds[k].x - other.folds[there.at].x;
        other.shift_z = here.shift_z + here.folds[k].z - other.folds[there.at].z;
        other.shift_level =
            here.shift_level + valleys_before(c, k) - valleys_before(next, there.at);
        queue.push_back(next);
      }
    }
    ++components_;
  }

  /// A mountain that two connectors share must have the same two panels in both.
  [[nodiscard]] Result<void> check_closed() const {
    for (std::uint32_t c = 0; c < connectors_.size(); ++c) {
      const Connector& here = connectors_[c];
      for (std::size_t k = 0; k < here.folds.size(); ++k) {
        const Beyond there = beyond(c, k);
        if (there.connector == kNoVertex) continue;
        const Connector& other = connectors_[static_cast<std::uint32_t>(there.connector)];
        const double off_x =
            here.shift_x + here.folds[k].x - other.shift_x - other.folds[there.at].x;
        const double off_z =
            here.shift_z + here.folds[k].z - other.shift_z - other.folds[there.at].z;
        constexpr double kSlack = 100.0;  // sums of many steps
        if (std::hypot(off_x, off_z) > kSlack * tolerance_) {
          const FoldLine& line = lines_[here.folds[k].line];
          return fail(
              ErrorKind::Infeasible, fmt::format("fold at u {:g}, v {:g}", line.u, line.v0),
              fmt::format("the strips at its two ends do not close, by {:.3g} mm; panels of a "
                          "lattice are rectangles, level or upright",
                          std::hypot(off_x, off_z)));
        }
      }
    }
    return {};
  }

  /// Wall and ground to x = 0 and z = 0, the first level to 0, for all that hangs together.
  void shift_to_corner() {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    struct Corner {
      double x{kFar}, z{kFar};
      std::int32_t level{std::numeric_limits<std::int32_t>::max()};
    };
    std::vector<Corner> corner(components_);
    for (const Connector& c : connectors_) {
      Corner& of = corner[c.component];
      of.x = std::min(of.x, c.shift_x + c.folds.front().x);
      of.z = std::min(of.z, c.shift_z + c.folds.back().z);
      of.level = std::min(of.level, c.shift_level);
    }
    for (Connector& c : connectors_) {
      c.shift_x -= corner[c.component].x;
      c.shift_z -= corner[c.component].z;
      c.shift_level -= corner[c.component].level;
    }
  }

  [[nodiscard]] std::vector<FoldVertex> vertices() const {
    std::vector<FoldVertex> out;
    std::vector<std::size_t> first;  // vertex of each connector's first valley
    for (std::uint32_t c = 0; c < connectors_.size(); ++c) {
      const Connector& here = connectors_[c];
      const double middle = 0.5 * (borders_[here.strip] + borders_[here.strip + 1]);
      first.push_back(out.size());
      for (std::size_t k = 0; k < here.folds.size(); ++k) {
        const Crossing& fold = here.folds[k];
        if (lines_[fold.line].mountain) continue;
        FoldVertex vertex;
        vertex.i = here.shift_level + valleys_before(c, k);
        vertex.j = static_cast<std::int32_t>(c);
        vertex.x = here.shift_x + fold.x;
        vertex.z = here.shift_z + fold.z;
        vertex.v = middle;
        const FoldLine& line = lines_[fold.line];
        vertex.v_fold = line.v_fold;
        vertex.u_mm = line.u, vertex.v0_mm = line.v0, vertex.v1_mm = line.v1;
        out.push_back(vertex);
      }
    }
    for (std::uint32_t c = 0; c < connectors_.size(); ++c) add_rings(c, first, out);
    move_plain_to_tips(out);
    return out;
  }

  /// On a splayed lattice the fold vertices are tips. A crease without a V-fold (alpha = 0) has its
  /// vertex where such a tip would lie flat, so that all lie alike (docs/geometry.md, section 7).
  static void move_plain_to_tips(std::vector<FoldVertex>& vertices) {
    const auto splayed = std::find_if(vertices.begin(), vertices.end(),
                                      [](const FoldVertex& p) { return p.v_fold.has_value(); });
    if (splayed == vertices.end()) return;
    const CreaseVFold& fold = *splayed->v_fold;
    const double beyond_middle = fold.apex_v_mm + fold.sign * fold.w_mm - splayed->v;
    for (FoldVertex& p : vertices)
      if (!p.v_fold) p.v += beyond_middle;
  }

  void add_rings(std::uint32_t c, const std::vector<std::size_t>& first,
                 std::vector<FoldVertex>& out) const {
    const auto& folds = connectors_[c].folds;
    for (std::size_t k = 0; k < folds.size(); ++k) {
      if (lines_[folds[k].line].mountain) continue;
      const auto own =
          first[c] + static_cast<std::size_t>(valleys_before(c, k) - valleys_before(c, 0));
      FoldVertex& vertex = out[own];
      if (k + 2 < folds.size()) vertex.ring[0] = static_cast<std::int32_t>(own + 1);
      if (k >= 2) vertex.ring[2] = static_cast<std::int32_t>(own - 1);
      // Across a mountain, the neighbour's valley lies on the same side of it.
      for (const bool after : {false, true}) {
        if (after ? k + 1 >= folds.size() : k == 0) continue;
        const Beyond there = beyond(c, after ? k + 1 : k - 1);
        if (there.connector == kNoVertex) continue;
        const auto next = static_cast<std::uint32_t>(there.connector);
        const std::size_t at = after ? there.at - std::size_t{1} : there.at + std::size_t{1};
        if (at >= connectors_[next].folds.size()) continue;  // also none before the first
        const auto across = first[next] + static_cast<std::size_t>(valleys_before(next, at) -
                                                                   valleys_before(next, 0));
        vertex.ring[next > c ? 1 : 3] = static_cast<std::int32_t>(across);
      }
    }
  }

  struct Range {
    std::size_t first{}, last{};
  };
  std::vector<FoldLine> lines_;
  double tolerance_;
  std::vector<double> borders_;
  std::vector<Range> range_;  ///< of a line: the strips first .. last - 1
  std::vector<std::vector<std::uint32_t>> crossing_;
  std::vector<Connector> connectors_;
  std::vector<Link> links_;
  std::uint32_t components_{0};
};

double size_of(const FoldFrame& frame) {
  double size = 0;
  for (const auto& p : frame.vertices) size = std::max({size, std::abs(p[0]), std::abs(p[1])});
  return size;
}

Result<std::vector<FoldVertex>> found_in(const FoldFrame& frame, double mm) {
  const double size = size_of(frame) * mm;
  return VertexFinder(fold_lines(frame, mm, kTolerance * size), size).find();
}

}  // namespace

Point3 FoldVertex::posed(double psi_rad) const {
  Point3 p{x + z * std::cos(psi_rad), v, z * std::sin(psi_rad)};
  if (!v_fold) return p;
  const double theta = 2.0 * std::atan2(v_fold->alpha * std::cos(psi_rad / 2), 1.0);
  const double above = v_fold->w_mm * std::sin(theta);
  p[0] += above * std::cos(psi_rad / 2);
  p[1] = v_fold->apex_v_mm + v_fold->sign * v_fold->w_mm * std::cos(theta);
  p[2] += above * std::sin(psi_rad / 2);
  return p;
}

Result<std::vector<FoldVertex>> fold_vertices_from_fold(std::string_view text) {
  const auto file = read_fold(text);
  if (!file) return tl::unexpected(file.error());
  const FoldFrame* const frame = flat_frame(*file);
  if (frame == nullptr) {
    return fail(ErrorKind::Malformed, "/vertices_coords",
                "no frame with edges lies flat; the flat crease pattern is needed");
  }
  const double mm = fold_unit_mm(frame->unit);
  if (mm == 0.0) {
    return fail(ErrorKind::Malformed, "/frame_unit",
                fmt::format("\"{}\" is not a unit that is known; mm, cm, m or in", frame->unit));
  }
  return found_in(*frame, mm);
}

Result<std::vector<FoldVertex>> fold_vertices(const Pattern& pattern) {
  FoldFrame frame;
  frame.vertices.reserve(pattern.vertices.size());
  for (const PatternVertex& p : pattern.vertices) frame.vertices.push_back({pattern.u(p), p.v, 0});
  for (const PatternEdge& e : pattern.edges) {
    frame.edges.push_back({e.from, e.to});
    frame.assignments.push_back(e.role == EdgeRole::Mountain ? 'M'
                                : e.role == EdgeRole::Valley ? 'V'
                                                             : 'B');
  }
  return found_in(frame, 1.0);
}

}  // namespace popcut
