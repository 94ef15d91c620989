// SPDX-License-Identifier: MIT
#include "core/design/strips/splay.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>

#include <fmt/format.h>

namespace popcut {
namespace {

/// A V-fold that is to be made: where, and how large.
struct Wanted {
  std::uint32_t edge{};  ///< the crease
  double apex_v_mm{}, length_mm{}, alpha{};
};

/// A crease by its place: v, x and z of its beginning, compared exactly since all come from the
/// same numbers.
using CreaseKey = std::array<double, 3>;

class Splayer {
 public:
  Splayer(const Strips& strips, const SplaySpec& splay, Pattern& pattern)
      : strips_(strips), splay_(splay), pattern_(pattern) {
    for (std::uint32_t e = 0; e < pattern.edges.size(); ++e) {
      if (pattern.edges[e].role != EdgeRole::Valley) continue;
      const PatternVertex& p = pattern.vertices[pattern.edges[e].from];
      creases_[{p.v, p.x, p.z}] = e;
    }
  }

  Result<void> run() {
    std::size_t connector = 0;
    for (std::size_t s = 0; s < strips_.size(); ++s) {
      if (strips_.kind[s] != StripKind::Connector) continue;
      if (auto found = look_at(s, connector); !found) return found;
      ++connector;
    }
    if (auto sized = check_size(connector); !sized) return sized;
    for (const Wanted& w : wanted_) make(w);
    rewrite_faces();
    return {};
  }

 private:
  [[nodiscard]] Result<void> check_size(std::size_t connectors) const {
    if (splay_.uniform) return {};
    for (std::size_t i = 0; i < splay_.alpha.size(); ++i)
      if (splay_.alpha[i].size() != connectors)
        return fail(ErrorKind::OutOfRange, fmt::format("/splay/alpha/{}", i),
                    fmt::format("has {} values for {} connectors; must have one for each",
                                splay_.alpha[i].size(), connectors));
    if (static_cast<int>(splay_.alpha.size()) != top_level_)
      return fail(ErrorKind::OutOfRange, "/splay/alpha",
                  fmt::format("has {} rows for {} inner levels; must have one for each",
                              splay_.alpha.size(), top_level_));
    return {};
  }

  [[nodiscard]] double alpha_of(int level, std::size_t connector) const {
    if (splay_.uniform) return *splay_.uniform;
    const auto row = static_cast<std::size_t>(level - 1);
    if (row >= splay_.alpha.size() || connector >= splay_.alpha[row].size()) return 0.0;
    return splay_.alpha[row][connector];
  }

  /// What fits a connector, in words.
  [[nodiscard]] std::string room_for(double width) const {
    const double most = width - 2.0 * splay_.ligament_mm;
    if (!(most > 0.0)) return fmt::format("use a ligament_mm under {:.4g} mm", 0.5 * width);
    return fmt::format("length_mm is {:.4g} mm, at most {:.4g} mm fits",
                       splay_.length_mm.value_or(most), most);
  }

  /// Collects the V-folds of one connector: its valleys between an upright and a level panel of the
  /// same level.
  Result<void> look_at(std::size_t s, std::size_t connector) {
    const double width = strips_.v_begin[s + 1] - strips_.v_begin[s];
    const double length = splay_.length_mm.value_or(width - 2.0 * splay_.ligament_mm);
    for (std::uint32_t p = strips_.first_panel[s]; p + 1 < strips_.first_panel[s + 1]; ++p) {
      const int level = strips_.level[p];
      if (level < 1 || strips_.level[p + 1] != level) continue;
      const std::size_t q = p + s;  // panel p runs from point q to q + 1, where the valley is
      top_level_ = std::max(top_level_, level);
      const double alpha = alpha_of(level, connector);
      if (alpha == 0.0) continue;
      const std::string place =
          splay_.uniform ? "/splay/alpha" : fmt::format("/splay/alpha/{}/{}", level - 1, connector);
      if (length <= 0.0 || length + 2.0 * splay_.ligament_mm > width + 1e-9)
        return fail(ErrorKind::Infeasible,
                    width > 2.0 * splay_.ligament_mm ? "/splay/length_mm" : "/splay/ligament_mm",
                    fmt::format("a V-fold with ligaments of {:g} mm does not fit connector {}, "
                                "{:.4g} mm wide: {}; or use wider slices",
                                splay_.ligament_mm, connector, width, room_for(width)));
      const double panel =
          std::min(strips_.z[q] - strips_.z[q + 1], strips_.x[q + 2] - strips_.x[q + 1]);
      if (length * alpha > panel - splay_.ligament_mm + 1e-9)
        return fail(ErrorKind::Infeasible, place,
                    fmt::format("is {:g}: its sides reach {:.4g} mm, and the panels of level {} "
                                "have {:.4g} mm less a "
                                "ligament of {:g} mm; at most {:.4g} fits",
                                alpha, length * alpha, level, panel, splay_.ligament_mm,
                                std::max(0.0, (panel - splay_.ligament_mm) / length)));
      const auto crease = creases_.find({strips_.v_begin[s], strips_.x[q + 1], strips_.z[q + 1]});
      if (crease == creases_.end())
        return fail(ErrorKind::Internal, place, "the crease of a V-fold was not found");
      wanted_.push_back(
          {crease->second, strips_.v_begin[s] + 0.5 * (width - length), length, alpha});
    }
    return {};
  }

  std::uint32_t add_vertex(double x, double z, double v) {
    pattern_.vertices.push_back({x, z, v});
    return static_cast<std::uint32_t>(pattern_.vertices.size() - 1);
  }
  std::uint32_t add_edge(std::uint32_t from, std::uint32_t to, std::int32_t left,
                         std::int32_t right, EdgeRole role) {
    pattern_.edges.push_back({from, to, left, right, role});
    return static_cast<std::uint32_t>(pattern_.edges.size() - 1);
  }
  void add_line(double u0, double v0, double u1, double v1, EdgeRole role) {
    new_lines_.push_back({u0, v0, u1, v1, role});
  }

  void make(const Wanted& w) {
    const PatternEdge crease =
        pattern_.edges[w.edge];  // upright face on its left, level one on its right
    const PatternVertex start = pattern_.vertices[crease.from];
    const double side = w.length_mm * w.alpha, v = w.apex_v_mm, end = v + w.length_mm;
    const std::uint32_t o = add_vertex(start.x, start.z, v);
    const std::uint32_t tip = add_vertex(start.x, start.z, end);
    const std::uint32_t after = add_vertex(start.x, start.z, end);  // where the crease goes on
    const std::uint32_t b = add_vertex(start.x, start.z + side, end);
    const std::uint32_t c = add_vertex(start.x + side, start.z, end);
    const auto first = static_cast<std::int32_t>(pattern_.faces() + triangles_.size());
    triangles_.push_back({o, tip, b});
    triangles_.push_back({o, c, tip});
    insertions_[key(crease.from, crease.to)] = {o, b, after};
    insertions_[key(crease.to, crease.from)] = {after, c, o};

    pattern_.edges[w.edge].to = o;
    add_edge(after, crease.to, crease.left, crease.right, EdgeRole::Valley);
    const std::uint32_t edge_b = add_edge(o, b, crease.left, first, EdgeRole::Valley);
    const std::uint32_t edge_c = add_edge(o, c, first + 1, crease.right, EdgeRole::Valley);
    add_edge(o, tip, first, first + 1, EdgeRole::Mountain);
    add_edge(b, after, crease.left, -1, EdgeRole::Slit);
    add_edge(after, c, crease.right, -1, EdgeRole::Slit);
    add_edge(tip, b, first, -1, EdgeRole::Slit);
    add_edge(c, tip, first + 1, -1, EdgeRole::Slit);
    pattern_.v_folds.push_back({o, tip, edge_b, edge_c, w.length_mm, w.alpha});

    const double u = pattern_.u(start), far = pattern_.vertices[crease.to].v;
    split_[{u, start.v}] = {v, end};
    add_line(u, end, u, far, EdgeRole::Valley);
    add_line(u, v, u, end, EdgeRole::Mountain);
    add_line(u, v, u - side, end, EdgeRole::Valley);
    add_line(u, v, u + side, end, EdgeRole::Valley);
    add_line(u - side, end, u + side, end, EdgeRole::Slit);
  }

  static std::uint64_t key(std::uint32_t from, std::uint32_t to) {
    return (static_cast<std::uint64_t>(from) << 32) | to;
  }

  /// Writes the faces again: those beside a crease go around its triangles, which follow at the
  /// end.
  void rewrite_faces() {
    std::vector<std::uint32_t> first{0}, vertices;
    vertices.reserve(pattern_.face_vertices.size() + 6 * wanted_.size());
    for (std::size_t f = 0; f < pattern_.faces(); ++f) {
      const auto face = pattern_.face(f);
      for (std::size_t k = 0; k < face.size(); ++k) {
        vertices.push_back(face[k]);
        const auto more = insertions_.find(key(face[k], face[(k + 1) % face.size()]));
        if (more != insertions_.end())
          vertices.insert(vertices.end(), more->second.begin(), more->second.end());
      }
      first.push_back(static_cast<std::uint32_t>(vertices.size()));
    }
    for (const auto& triangle : triangles_) {
      vertices.insert(vertices.end(), triangle.begin(), triangle.end());
      first.push_back(static_cast<std::uint32_t>(vertices.size()));
    }
    pattern_.face_first = std::move(first);
    pattern_.face_vertices = std::move(vertices);
    for (SheetLine& line : pattern_.lines) {
      if (line.role != EdgeRole::Valley) continue;
      const auto cut = split_.find({line.u0, line.v0});
      if (cut != split_.end()) line.v1 = cut->second[0];  // the crease up to the apex
    }
    pattern_.lines.insert(pattern_.lines.end(), new_lines_.begin(), new_lines_.end());
  }

  const Strips& strips_;
  const SplaySpec& splay_;
  Pattern& pattern_;
  std::map<CreaseKey, std::uint32_t> creases_;
  std::vector<Wanted> wanted_;
  int top_level_{0};
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::unordered_map<std::uint64_t, std::array<std::uint32_t, 3>> insertions_;
  std::map<std::array<double, 2>, std::array<double, 2>> split_;
  std::vector<SheetLine> new_lines_;
};

}  // namespace

Result<void> add_v_folds(const Strips& strips, const SplaySpec& splay, Pattern& pattern) {
  return Splayer(strips, splay, pattern).run();
}

}  // namespace popcut
