// SPDX-License-Identifier: MIT
#include "core/design/strips/pattern_builder.hpp"

#include <algorithm>
#include <limits>

namespace popcut {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// A stretch of the line between two strips along which a panel of each lies in the same plane.
struct Joint {
  std::uint32_t left_panel{}, right_panel{};
  double x0{}, z0{}, x1{}, z1{};
  std::uint32_t start_vertex{kNone}, end_vertex{kNone};
};

/// One side of a strip: its nodes in the order of u. Segment n runs from node n to node n + 1.
struct Side {
  std::vector<std::uint32_t> vertex;  ///< one a node
  std::vector<std::uint32_t> twin;    ///< node that starts the joined segment opposite, or kNone
  std::vector<std::uint32_t> twin_panel;  ///< its panel
  std::vector<std::uint32_t> corner;      ///< node of each staircase point
};

enum class HalfEdgeKind : std::uint8_t { Low, End, High, Begin };

/// A directed edge of a panel's boundary, counter-clockwise in (u, v): along its low side, up its
/// end fold, back along its high side, down its begin fold. `index` is a node or, for folds, the
/// panel.
struct HalfEdge {
  HalfEdgeKind kind{};
  std::uint32_t index{};
  std::uint32_t panel{};
};

class PatternBuilder {
 public:
  PatternBuilder(const Strips& strips, double wall_mm, double ground_mm, bool card,
                 double min_panel_mm, std::span<const std::uint32_t> parted)
      : strips_(strips),
        panels_(strips.panels()),
        min_panel_mm_(min_panel_mm),
        parted_(strips.panels(), 0) {
    for (const std::uint32_t panel : parted) parted_[panel] = 1;
    Pattern& p = out_.pattern;
    p.wall_mm = wall_mm;
    p.ground_mm = ground_mm;
    p.width_mm = strips.v_begin.back();
    p.card = card;
    strip_of_.reserve(panels_);
    for (std::uint32_t s = 0; s < strips.size(); ++s)
      strip_of_.insert(strip_of_.end(), strips.first_panel[s + 1] - strips.first_panel[s], s);
    for (Side* side : {&low_, &high_}) side->corner.assign(strips.x.size(), kNone);
    out_.panel_face.assign(panels_, -1);
  }

  Result<BuiltPattern> run() {
    for (std::size_t line = 0; line <= strips_.size(); ++line) walk_line(line);
    for (std::uint32_t panel = 0; panel < panels_; ++panel)
      if (!strips_.is_cut(panel) && out_.panel_face[panel] < 0 && !trace(panel))
        return fail(ErrorKind::Internal, "", "the strips do not make simple faces");
    if (!joints_are_inside_faces())
      return fail(ErrorKind::Internal, "", "a face of the strips has a hole");
    for (std::size_t e = 0; e < far_panel_.size(); ++e)
      if (far_panel_[e] != kNone) out_.pattern.edges[e].right = out_.panel_face[far_panel_[e]];
    for (std::size_t h = 0; h < out_.hinges.size(); ++h)
      out_.hinges[h].to_face = out_.panel_face[hinge_panel_[h]];
    drop_passed_vertices();
    return std::move(out_);
  }

 private:
  [[nodiscard]] double u(double x, double z) const { return x + (out_.pattern.wall_mm - z); }
  [[nodiscard]] double u_of(std::size_t point) const {
    return u(strips_.x[point], strips_.z[point]);
  }

  std::uint32_t add_vertex(double x, double z, double v) {
    out_.pattern.vertices.push_back({x, z, v});
    passed_.push_back(0);
    return static_cast<std::uint32_t>(passed_.size() - 1);
  }

  /// Where panels of strips `a` and `b` share a plane and overlap: two pointers along u.
  void find_joints(std::size_t a, std::size_t b) {
    joints_.clear();
    std::uint32_t p = strips_.first_panel[a], q = strips_.first_panel[b];
    const std::uint32_t p_end = strips_.first_panel[a + 1], q_end = strips_.first_panel[b + 1];
    while (p < p_end && q < q_end) {
      const std::size_t i = p + a, j = q + b;  // first points of the panels
      if (strips_.plane[p] == strips_.plane[q] && !strips_.is_cut(p) && parted_[q] == 0) {
        // In one plane the exact coordinate along it decides, never the sum u.
        const bool upright = strips_.x[i] == strips_.x[i + 1];
        Joint joint{p, q, strips_.x[i], strips_.z[i], strips_.x[i + 1], strips_.z[i + 1]};
        if (upright) {
          joint.z0 = std::min(strips_.z[i], strips_.z[j]);
          joint.z1 = std::max(strips_.z[i + 1], strips_.z[j + 1]);
          if (is_joint(joint.z0 - joint.z1, min_panel_mm_)) joints_.push_back(joint);
        } else {
          joint.x0 = std::max(strips_.x[i], strips_.x[j]);
          joint.x1 = std::min(strips_.x[i + 1], strips_.x[j + 1]);
          if (is_joint(joint.x1 - joint.x0, min_panel_mm_)) joints_.push_back(joint);
        }
      }
      const double p_stop = u_of(i + 1), q_stop = u_of(j + 1);
      if (p_stop <= q_stop) ++p;
      if (q_stop <= p_stop) ++q;
    }
  }

  /// Whether a cut across a strip is a window: it has a length.
  [[nodiscard]] bool is_window(std::uint32_t panel) const {
    const std::size_t point = point_of(panel);
    return strips_.is_cut(panel) && u_of(point + 1) - u_of(point) > kSamePlace_mm;
  }

  /// Whether both panels of a joint that reaches to (x, z) end there at cuts across their strips.
  [[nodiscard]] bool both_cut(std::uint32_t left, std::uint32_t right, double x, double z,
                              bool at_end) const {
    const auto cut_at = [&](std::uint32_t panel) {
      const std::size_t s = strip_of_[panel];
      if (at_end ? panel + 1 == strips_.first_panel[s + 1] : panel == strips_.first_panel[s])
        return false;
      const std::size_t point = panel + s + (at_end ? 1 : 0);
      return strips_.is_cut(at_end ? panel + 1 : panel - 1) && strips_.x[point] == x &&
             strips_.z[point] == z;
    };
    const auto beyond = [&](std::uint32_t panel) { return at_end ? panel + 1 : panel - 1; };
    return cut_at(left) && cut_at(right) && is_window(beyond(left)) == is_window(beyond(right));
  }

  /// Gives the ends of the joints their vertices. Where one joint follows another at a point, a
  /// fold passes through; where both strips begin or end, the outline does, and where both are cut
  /// across, the cut does.
  void place_joint_vertices(std::size_t a, std::size_t b, double v) {
    const auto is_point = [&](double x, double z, std::size_t point) {
      return strips_.x[point] == x && strips_.z[point] == z;
    };
    for (std::size_t k = 0; k < joints_.size(); ++k) {
      Joint& joint = joints_[k];
      if (k > 0 && joints_[k - 1].x1 == joint.x0 && joints_[k - 1].z1 == joint.z0) {
        joint.start_vertex = joints_[k - 1].end_vertex;
        passed_[joint.start_vertex] = 1;
      } else {
        joint.start_vertex = add_vertex(joint.x0, joint.z0, v);
        const bool is_passed =
            (is_point(joint.x0, joint.z0, strips_.first_point(a)) &&
             is_point(joint.x0, joint.z0, strips_.first_point(b))) ||
            both_cut(joint.left_panel, joint.right_panel, joint.x0, joint.z0, false);
        passed_.back() = is_passed ? 1 : 0;
      }
      joint.end_vertex = add_vertex(joint.x1, joint.z1, v);
      const bool is_passed =
          (is_point(joint.x1, joint.z1, strips_.first_panel[a + 1] + a) &&
           is_point(joint.x1, joint.z1, strips_.first_panel[b + 1] + b)) ||
          both_cut(joint.left_panel, joint.right_panel, joint.x1, joint.z1, true);
      passed_.back() = is_passed ? 1 : 0;
    }
  }

  /// Writes the nodes of strip s along one of its sides: its corners and the ends of the joints.
  void write_side(std::size_t s, Side& side, bool is_left, double v) {
    std::size_t k = 0;
    const auto panel_of = [&](const Joint& j) { return is_left ? j.left_panel : j.right_panel; };
    const auto node = [&](std::uint32_t vertex) {
      side.vertex.push_back(vertex);
      side.twin.push_back(kNone);
      side.twin_panel.push_back(kNone);
    };
    for (std::uint32_t p = strips_.first_panel[s]; p < strips_.first_panel[s + 1]; ++p) {
      const std::size_t point = p + s;
      const double x = strips_.x[point], z = strips_.z[point];
      std::uint32_t corner = kNone;
      if (k > 0 && joints_[k - 1].x1 == x && joints_[k - 1].z1 == z)
        corner = joints_[k - 1].end_vertex;
      const bool joint_here = k < joints_.size() && panel_of(joints_[k]) == p;
      if (joint_here && joints_[k].x0 == x && joints_[k].z0 == z) corner = joints_[k].start_vertex;
      side.corner[point] = static_cast<std::uint32_t>(side.vertex.size());
      node(corner == kNone ? add_vertex(x, z, v) : corner);
      for (; k < joints_.size() && panel_of(joints_[k]) == p; ++k) {
        if (side.vertex.back() != joints_[k].start_vertex) node(joints_[k].start_vertex);
        joint_node_[k] = static_cast<std::uint32_t>(side.vertex.size() - 1);
        const bool ends_panel =
            joints_[k].x1 == strips_.x[point + 1] && joints_[k].z1 == strips_.z[point + 1];
        if (!ends_panel) node(joints_[k].end_vertex);
      }
    }
    const std::size_t last = strips_.first_panel[s + 1] + s;
    const bool joined =
        k > 0 && joints_[k - 1].x1 == strips_.x[last] && joints_[k - 1].z1 == strips_.z[last];
    side.corner[last] = static_cast<std::uint32_t>(side.vertex.size());
    node(joined ? joints_[k - 1].end_vertex : add_vertex(strips_.x[last], strips_.z[last], v));
  }

  void walk_line(std::size_t line) {
    const double v = strips_.v_begin[line];
    joints_.clear();
    const bool has_left = line > 0, has_right = line < strips_.size();
    if (has_left && has_right) {
      find_joints(line - 1, line);
      place_joint_vertices(line - 1, line, v);
    }
    joint_node_.assign(joints_.size(), kNone);
    if (has_left) write_side(line - 1, high_, true, v);
    left_node_ = joint_node_;
    if (has_right) write_side(line, low_, false, v);
    for (std::size_t k = 0; k < joints_.size(); ++k) {
      high_.twin[left_node_[k]] = joint_node_[k];
      high_.twin_panel[left_node_[k]] = joints_[k].right_panel;
      low_.twin[joint_node_[k]] = left_node_[k];
      low_.twin_panel[joint_node_[k]] = joints_[k].left_panel;
    }
    add_lines(line, v);
  }

  /// Where there is no paper on either side of a line between two strips: stretches of u.
  [[nodiscard]] std::vector<std::pair<double, double>> common_windows(std::size_t line) const {
    std::vector<std::pair<double, double>> out;
    for (std::uint32_t p = strips_.first_panel[line - 1]; p < strips_.first_panel[line]; ++p)
      for (std::uint32_t q = strips_.first_panel[line];
           is_window(p) && q < strips_.first_panel[line + 1]; ++q) {
        if (!is_window(q)) continue;
        const double begin = std::max(u_of(point_of(p)), u_of(point_of(q))),
                     end = std::min(u_of(point_of(p) + 1), u_of(point_of(q) + 1));
        if (end > begin) out.emplace_back(begin, end);
      }
    return out;
  }

  /// The cuts of a line, each once, and its stretches that belong to the outline.
  void add_lines(std::size_t line, double v) {
    std::vector<SheetLine>& lines = out_.pattern.lines;
    const auto add = [&](double u0, double u1, EdgeRole role) {
      if (u1 - u0 > kSamePlace_mm) lines.push_back({u0, v, u1, v, role});
    };
    const auto range = [&](std::size_t s) {
      return std::pair{u_of(strips_.first_point(s)), u_of(strips_.first_panel[s + 1] + s)};
    };
    if (line == 0 || line == strips_.size()) {
      const auto [u0, u1] = range(line == 0 ? 0 : line - 1);
      add(u0, u1, EdgeRole::Outline);
      return;
    }
    const auto [a0, a1] = range(line - 1);
    const auto [b0, b1] = range(line);
    add(std::min(a0, b0), std::min({std::max(a0, b0), a1, b1}), EdgeRole::Outline);
    double done = std::max(a0, b0);
    const auto slit = [&](double from, double to) {
      for (const auto& [begin, end] : common_windows(line)) {
        if (!(end > from) || !(begin < to)) continue;
        add(from, begin, EdgeRole::Slit);
        from = end;
      }
      add(from, to, EdgeRole::Slit);
    };
    for (const Joint& joint : joints_) {
      slit(done, u(joint.x0, joint.z0));
      done = u(joint.x1, joint.z1);
    }
    slit(done, std::min(a1, b1));
    add(std::max({std::min(a1, b1), a0, b0}), std::max(a1, b1), EdgeRole::Outline);
  }

  // Tracing. A half-edge's origin, and the next one around the same panel.
  [[nodiscard]] std::size_t point_of(std::uint32_t panel) const { return panel + strip_of_[panel]; }
  [[nodiscard]] std::uint32_t origin(const HalfEdge& h) const {
    switch (h.kind) {
      case HalfEdgeKind::Low:
        return low_.vertex[h.index];
      case HalfEdgeKind::End:
        return low_.vertex[low_.corner[point_of(h.panel) + 1]];
      case HalfEdgeKind::High:
        return high_.vertex[h.index + 1];
      case HalfEdgeKind::Begin:
        return high_.vertex[high_.corner[point_of(h.panel)]];
    }
    return kNone;
  }
  [[nodiscard]] HalfEdge around(const HalfEdge& h) const {
    const std::size_t point = point_of(h.panel);
    switch (h.kind) {
      case HalfEdgeKind::Low:
        if (h.index + 1 == low_.corner[point + 1]) return {HalfEdgeKind::End, h.panel, h.panel};
        return {HalfEdgeKind::Low, h.index + 1, h.panel};
      case HalfEdgeKind::End:
        return {HalfEdgeKind::High, high_.corner[point + 1] - 1, h.panel};
      case HalfEdgeKind::High:
        if (h.index == high_.corner[point]) return {HalfEdgeKind::Begin, h.panel, h.panel};
        return {HalfEdgeKind::High, h.index - 1, h.panel};
      case HalfEdgeKind::Begin:
        return {HalfEdgeKind::Low, low_.corner[point], h.panel};
    }
    return h;
  }
  /// The next half-edge on the face's boundary: across joints into the panels they join.
  [[nodiscard]] HalfEdge next(HalfEdge h) const {
    h = around(h);
    for (;;) {
      const bool is_low = h.kind == HalfEdgeKind::Low, is_high = h.kind == HalfEdgeKind::High;
      if (!is_low && !is_high) return h;
      const Side& side = is_low ? low_ : high_;
      if (side.twin[h.index] == kNone) return h;
      h = around({is_low ? HalfEdgeKind::High : HalfEdgeKind::Low, side.twin[h.index],
                  side.twin_panel[h.index]});
    }
  }

  /// The panel beyond a fold, kNone at the sheet's border.
  [[nodiscard]] std::uint32_t beyond(const HalfEdge& h) const {
    const std::size_t s = strip_of_[h.panel];
    if (h.kind == HalfEdgeKind::End)
      return h.panel + 1 < strips_.first_panel[s + 1] ? h.panel + 1 : kNone;
    return h.panel > strips_.first_panel[s] ? h.panel - 1 : kNone;
  }
  [[nodiscard]] bool upright(std::uint32_t panel) const {
    const std::size_t point = point_of(panel);
    return strips_.x[point] == strips_.x[point + 1];
  }
  /// Whether a piece of a side lies where the neighbouring strip has no paper (without a card
  /// only).
  [[nodiscard]] bool on_outline(const HalfEdge& h, double middle_u) const {
    const std::size_t s = strip_of_[h.panel];
    const bool low = h.kind == HalfEdgeKind::Low;
    if (low ? s == 0 : s + 1 == strips_.size()) return true;
    const std::size_t other = low ? s - 1 : s + 1;
    return middle_u < u_of(strips_.first_point(other)) ||
           middle_u > u_of(strips_.first_panel[other + 1] + other);
  }

  void add_edge(std::uint32_t from, std::uint32_t to, std::int32_t face, EdgeRole role,
                std::uint32_t far) {
    out_.pattern.edges.push_back({from, to, face, -1, role});
    far_panel_.push_back(far);
  }

  /// Adds the edge of a chain of half-edges that starts with `h` and runs from `from` to `to`.
  void finish_chain(const HalfEdge& h, std::uint32_t from, std::uint32_t to, std::int32_t face) {
    const PatternVertex& a = out_.pattern.vertices[from];
    const PatternVertex& b = out_.pattern.vertices[to];
    if (h.kind == HalfEdgeKind::Low || h.kind == HalfEdgeKind::High) {
      const double middle = 0.5 * (out_.pattern.u(a) + out_.pattern.u(b));
      add_edge(from, to, face, on_outline(h, middle) ? EdgeRole::Outline : EdgeRole::Slit, kNone);
      return;
    }
    const std::uint32_t far = beyond(h);
    if (far != kNone && strips_.is_cut(far)) {
      add_edge(from, to, face, EdgeRole::Slit, kNone);
      if (h.kind == HalfEdgeKind::End || is_window(far))  // each cut has one such side
        out_.pattern.lines.push_back(
            {out_.pattern.u(a), a.v, out_.pattern.u(b), b.v, EdgeRole::Slit});
    } else if (far == kNone) {
      add_edge(from, to, face, EdgeRole::Outline, kNone);
      out_.pattern.lines.push_back(
          {out_.pattern.u(a), a.v, out_.pattern.u(b), b.v, EdgeRole::Outline});
    } else if (h.kind == HalfEdgeKind::End) {  // the face beyond sees the same fold from its begin
      const EdgeRole role = upright(h.panel) ? EdgeRole::Valley : EdgeRole::Mountain;
      add_edge(from, to, face, role, far);
      out_.pattern.lines.push_back({out_.pattern.u(a), a.v, out_.pattern.u(b), b.v, role});
      out_.hinges.push_back({face, -1, a.x, a.z});
      hinge_panel_.push_back(far);
    }
  }

  /// Walks the boundary of the face of `panel`; false where it is not simple.
  bool trace(std::uint32_t panel) {
    Pattern& p = out_.pattern;
    const auto face = static_cast<std::int32_t>(out_.upright.size());
    out_.upright.push_back(upright(panel) ? 1 : 0);
    if (p.face_first.empty()) p.face_first.push_back(0);
    HalfEdge start{HalfEdgeKind::End, panel, panel};
    while (passed_[origin(start)] != 0) {  // begin at a vertex that stays
      start = next(start);
      if (start.kind == HalfEdgeKind::End && start.panel == panel) return false;
    }
    HalfEdge h = start, chain = start;
    std::uint32_t from = origin(h);
    do {
      if (out_.panel_face[h.panel] >= 0 && out_.panel_face[h.panel] != face) return false;
      out_.panel_face[h.panel] = face;
      const HalfEdge after = next(h);
      const std::uint32_t to = origin(after);
      if (passed_[to] == 0) {
        p.face_vertices.push_back(from);
        finish_chain(chain, from, to, face);
        from = to;
        chain = after;
      }
      h = after;
    } while (h.kind != start.kind || h.index != start.index || h.panel != start.panel);
    p.face_first.push_back(static_cast<std::uint32_t>(p.face_vertices.size()));
    return true;
  }

  /// Joined panels must have come out as one face; they do not where a face surrounds another.
  [[nodiscard]] bool joints_are_inside_faces() const {
    for (std::uint32_t panel = 0; panel < panels_; ++panel)
      for (std::uint32_t n = low_.corner[point_of(panel)]; n < low_.corner[point_of(panel) + 1];
           ++n)
        if (low_.twin[n] != kNone && out_.panel_face[low_.twin_panel[n]] != out_.panel_face[panel])
          return false;
    return true;
  }

  void drop_passed_vertices() {
    Pattern& p = out_.pattern;
    std::vector<std::uint32_t> place(passed_.size());
    std::uint32_t kept = 0;
    for (std::size_t i = 0; i < passed_.size(); ++i) {
      place[i] = kept;
      if (passed_[i] == 0) p.vertices[kept++] = p.vertices[i];
    }
    p.vertices.resize(kept);
    for (PatternEdge& e : p.edges) e.from = place[e.from], e.to = place[e.to];
    for (std::uint32_t& v : p.face_vertices) v = place[v];
  }

  const Strips& strips_;
  std::size_t panels_;
  double min_panel_mm_;
  std::vector<std::uint8_t> parted_;  ///< one a panel
  BuiltPattern out_;
  std::vector<std::uint32_t> strip_of_;
  std::vector<std::uint8_t>
      passed_;  ///< one a vertex: folds or the outline run straight through it
  Side low_, high_;
  std::vector<Joint> joints_;
  std::vector<std::uint32_t> joint_node_, left_node_;
  std::vector<std::uint32_t> far_panel_;    ///< one an edge: panel on its right, kNone for a border
  std::vector<std::uint32_t> hinge_panel_;  ///< one a hinge
};

}  // namespace

rigid::Section BuiltPattern::section() const {
  rigid::Section out{upright, std::vector<double>(upright.size()), {}};
  for (const Hinge& h : hinges)
    for (const std::int32_t face : {h.from_face, h.to_face}) {
      const auto f = static_cast<std::size_t>(face);
      out.offset[f] = upright[f] != 0 ? h.x : h.z;
    }
  out.folds = Buckets<std::uint32_t>(upright.size(), [&](auto&& put) {
    for (const Hinge& h : hinges) {
      const auto a = static_cast<std::uint32_t>(h.from_face);
      const auto b = static_cast<std::uint32_t>(h.to_face);
      put(a, b);
      put(b, a);
    }
  });
  return out;
}

Result<BuiltPattern> build_pattern(const Strips& strips, double wall_mm, double ground_mm,
                                   bool card, double min_panel_mm,
                                   std::span<const std::uint32_t> parted) {
  return PatternBuilder(strips, wall_mm, ground_mm, card, min_panel_mm, parted).run();
}

}  // namespace popcut
