// SPDX-License-Identifier: MIT
#include "core/formats/write/deployed_svg.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/geometry/vec.hpp"
#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

/// Parallel projection of places (x, v, z) to picture coordinates, y down.
struct Camera {
  Vec3 right, up;
  double scale{1}, x0{0}, y0{0};

  Camera(double azimuth_rad, double elevation_rad) {
    const double ca = std::cos(azimuth_rad), sa = std::sin(azimuth_rad);
    const double ce = std::cos(elevation_rad), se = std::sin(elevation_rad);
    right = {-sa, ca, 0};
    up = {-se * ca, -se * sa, ce};
  }
  [[nodiscard]] std::array<double, 2> project(const Vec3& p) const {
    return {scale * (dot(right, p) - x0), scale * (y0 - dot(up, p))};
  }
};

/// A place on a face: designed (x, z) at the v of a slab's border.
struct SlabPoint {
  double x{}, z{};
};

/// The part of a face between two borders of a slab, bounded by two edges of the face.
struct Piece {
  std::uint32_t face{};
  SlabPoint low_a, high_a;  ///< of the one edge, at the slab's lower and upper v
  SlabPoint low_b, high_b;
};

/// A part of an edge, drawn with the slab that it bounds or crosses.
struct Stroke3 {
  PatternVertex from, to;
  bool fold{};
};

/// The strips' common borders: all distinct v of the pattern, and what lies between them.
struct Slabs {
  std::vector<double> v;
  std::vector<std::vector<Piece>> pieces;
  std::vector<std::vector<Stroke3>> strokes;
  std::vector<std::vector<std::uint32_t>> v_folds;  ///< V-folds whose triangles end in the slab

  [[nodiscard]] std::size_t index(double at) const {
    return static_cast<std::size_t>(std::lower_bound(v.begin(), v.end(), at) - v.begin());
  }
};

SlabPoint at_v(const PatternVertex& a, const PatternVertex& b, double v) {
  const double t = (v - a.v) / (b.v - a.v);
  return {a.x + t * (b.x - a.x), a.z + t * (b.z - a.z)};
}

/// One crossing of a face's border through a slab.
struct Crossing {
  std::size_t slab;
  double u_middle;
  SlabPoint low, high;
};

void add_face(const Pattern& pattern, std::uint32_t f, Slabs& slabs) {
  const auto corners = pattern.face(f);
  std::vector<Crossing> crossings;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const PatternVertex* a = &pattern.vertices[corners[i]];
    const PatternVertex* b = &pattern.vertices[corners[(i + 1) % corners.size()]];
    if (a->v > b->v) std::swap(a, b);
    for (std::size_t s = slabs.index(a->v); s < slabs.index(b->v); ++s) {
      const SlabPoint low = at_v(*a, *b, slabs.v[s]), high = at_v(*a, *b, slabs.v[s + 1]);
      crossings.push_back({s, low.x - low.z + high.x - high.z, low, high});
    }
  }
  std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) {
    return std::pair(a.slab, a.u_middle) < std::pair(b.slab, b.u_middle);
  });
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    const Crossing &a = crossings[i], &b = crossings[i + 1];
    slabs.pieces[a.slab].push_back({f, a.low, a.high, b.low, b.high});
  }
}

void add_edge(const Pattern& pattern, const PatternEdge& edge, Slabs& slabs) {
  PatternVertex a = pattern.vertices[edge.from], b = pattern.vertices[edge.to];
  const bool fold = edge.role == EdgeRole::Mountain || edge.role == EdgeRole::Valley;
  if (a.v == b.v) {  // along a slab's border: drawn with its face
    const bool face_above = (pattern.u(b) > pattern.u(a)) == (edge.left >= 0);
    const std::size_t border = slabs.index(a.v);
    const std::size_t slab = face_above || border == 0 ? border : border - 1;
    return slabs.strokes[std::min(slab, slabs.strokes.size() - 1)].push_back({a, b, fold});
  }
  if (a.v > b.v) std::swap(a, b);
  for (std::size_t s = slabs.index(a.v); s < slabs.index(b.v); ++s) {
    const SlabPoint low = at_v(a, b, slabs.v[s]), high = at_v(a, b, slabs.v[s + 1]);
    slabs.strokes[s].push_back(
        {{low.x, low.z, slabs.v[s]}, {high.x, high.z, slabs.v[s + 1]}, fold});
  }
}

Slabs cut_into_slabs(const Pattern& pattern) {
  Slabs slabs;
  for (const PatternVertex& p : pattern.vertices) slabs.v.push_back(p.v);
  std::sort(slabs.v.begin(), slabs.v.end());
  slabs.v.erase(std::unique(slabs.v.begin(), slabs.v.end()), slabs.v.end());
  if (slabs.v.size() < 2) return slabs;
  slabs.pieces.resize(slabs.v.size() - 1);
  slabs.strokes.resize(slabs.v.size() - 1);
  slabs.v_folds.resize(slabs.v.size() - 1);
  // The triangles of V-folds leave their panels, so they are painted over their strip at the end.
  std::vector<std::uint8_t> is_tip(pattern.vertices.size(), 0);
  for (const VFold& fold : pattern.v_folds) is_tip[fold.tip] = 1;
  const auto leaves = [&](std::uint32_t vertex) { return is_tip[vertex] != 0; };
  for (std::uint32_t f = 0; f < pattern.faces(); ++f) {
    const auto face = pattern.face(f);
    if (std::none_of(face.begin(), face.end(), leaves)) add_face(pattern, f, slabs);
  }
  for (const PatternEdge& edge : pattern.edges)
    if (!leaves(edge.from) && !leaves(edge.to)) add_edge(pattern, edge, slabs);
  for (std::uint32_t k = 0; k < pattern.v_folds.size(); ++k) {
    const VFold& fold = pattern.v_folds[k];
    const double end = pattern.vertices[fold.tip].v;
    slabs.v_folds[std::max<std::size_t>(slabs.index(end), 1) - 1].push_back(k);
  }
  return slabs;
}

/// The colour of each face: warm paper for the structure, a cooler tone for the card behind it,
/// lighter the more the face turns towards the lamp.
std::vector<std::string> face_colours(const Pattern& pattern, double psi_rad) {
  const Vec3 lamp{0.42, 0.30, 0.86};  // unit length
  const Vec3 structure{255, 226, 178}, plain{238, 243, 247};
  const Vec3 ground_normal{0, 0, 1};
  const Vec3 wall_normal{std::sin(psi_rad), 0, -std::cos(psi_rad)};
  std::vector<std::string> colours;
  for (std::size_t f = 0; f < pattern.faces(); ++f) {
    bool same_x = true, same_z = true;
    const auto corners = pattern.face(f);
    const PatternVertex& first = pattern.vertices[corners.front()];
    for (const std::uint32_t corner : corners) {
      same_x = same_x && pattern.vertices[corner].x == first.x;
      same_z = same_z && pattern.vertices[corner].z == first.z;
    }
    const Vec3& normal = same_x && !same_z ? wall_normal : ground_normal;
    const bool card = (same_x && first.x == 0) || (same_z && first.z == 0);
    const double light = 0.80 + 0.22 * std::max(0.0, dot(normal, lamp));
    const Vec3& paper = card ? plain : structure;
    const auto tone = [&](double c) { return static_cast<int>(std::min(255.0, c * light)); };
    colours.push_back(
        fmt::format("#{:02x}{:02x}{:02x}", tone(paper[0]), tone(paper[1]), tone(paper[2])));
  }
  return colours;
}

class Picture {
 public:
  Picture(const Pattern& pattern, double psi_rad, const View& view, std::ostream& out)
      : pattern_(pattern),
        psi_rad_(psi_rad),
        camera_(view.azimuth_rad, std::min(psi_rad / 2, kLargestElevationRad)),
        text_(out) {
    for (const auto& p : posed_vertices(pattern, psi_rad)) places_.push_back(vec3(p));
    fit(view);
  }

  [[nodiscard]] std::array<double, 2> size_px() const { return {width_px_, height_px_}; }

  void draw() {
    const Slabs slabs = cut_into_slabs(pattern_);
    const std::vector<std::string> colours = face_colours(pattern_, psi_rad_);
    text_.put(svg_head(fmt::format("width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\"",
                                   std::ceil(width_px_), std::ceil(height_px_)),
                       fmt::format("{}, psi = {} rad", pattern_.name, psi_rad_), SvgPlace::Inside));
    text_.put("<g stroke-linejoin=\"round\" stroke-linecap=\"round\">\n");
    for (std::size_t s = 0; s < slabs.pieces.size(); ++s) {
      put_pieces(slabs, s, colours);
      put_strokes(slabs.strokes[s], true, "#9a8f80", "0.5");
      put_strokes(slabs.strokes[s], false, "#3d3a36", "0.8");
      for (const std::uint32_t k : slabs.v_folds[s]) put_v_fold(pattern_.v_folds[k]);
    }
    text_.put("</g>\n</svg>\n");
  }

 private:
  static constexpr double kLargestElevationRad = 0.55;
  static constexpr double kMarginPx = 12.0;

  /// Scales and shifts the projection so that the pattern fills the picture's width.
  void fit(const View& view) {
    Eigen::AlignedBox2d seen;
    for (const PatternVertex& p : pattern_.vertices) {
      const Vec3 place = vec3(posed(p, psi_rad_));
      seen.extend(Vec2{dot(camera_.right, place), dot(camera_.up, place)});
    }
    const double left = seen.min().x(), right = seen.max().x(), top = seen.max().y();
    width_px_ = view.width_px;
    if (!(right > left)) return;
    camera_.scale =
        view.px_per_mm > 0 ? view.px_per_mm : (view.width_px - 2 * kMarginPx) / (right - left);
    if (view.px_per_mm > 0) width_px_ = (right - left) * camera_.scale + 2 * kMarginPx;
    camera_.x0 = left - kMarginPx / camera_.scale;
    camera_.y0 = top + kMarginPx / camera_.scale;
    height_px_ = (top - seen.min().y()) * camera_.scale + 2 * kMarginPx;
  }

  void put_point(std::string_view command, const PatternVertex& p) {
    put_place(command, vec3(posed(p, psi_rad_)));
  }

  void put_pieces(const Slabs& slabs, std::size_t s, const std::vector<std::string>& colours) {
    const double low = slabs.v[s], high = slabs.v[s + 1];
    for (const Piece& piece : slabs.pieces[s]) {
      text_.put("<path d=\"");
      put_point("M", {piece.low_a.x, piece.low_a.z, low});
      put_point("L", {piece.low_b.x, piece.low_b.z, low});
      put_point("L", {piece.high_b.x, piece.high_b.z, high});
      put_point("L", {piece.high_a.x, piece.high_a.z, high});
      const std::string& colour = colours[piece.face];
      // The stroke hides the thin line that antialiasing leaves between two pieces of a face.
      text_("Z\" fill=\"", colour, "\" stroke=\"", colour, "\" stroke-width=\"0.9\"/>\n");
    }
  }

  void put_place(std::string_view command, const Vec3& place) {
    const auto [x, y] = camera_.project(place);
    constexpr double kHundredths = 100.0;
    text_(command, std::round(x * kHundredths) / kHundredths, " ",
          std::round(y * kHundredths) / kHundredths);
  }

  /// The two triangles of a V-fold in their popped positions, the one away from the eye first.
  void put_v_fold(const VFold& fold) {
    const Vec3 &o = places_[fold.apex], &tip = places_[fold.tip];
    const Vec3& b = places_[pattern_.edges[fold.edge_b].to];
    const Vec3& c = places_[pattern_.edges[fold.edge_c].to];
    for (const auto& [side, colour] : {std::pair(&b, "#d9c193"), std::pair(&c, "#f3d7a3")}) {
      put_place("<path d=\"M", o);
      put_place("L", tip);
      put_place("L", *side);
      text_("Z\" fill=\"", colour, "\" stroke=\"#3d3a36\" stroke-width=\"0.7\"/>\n");
    }
  }

  void put_strokes(const std::vector<Stroke3>& strokes, bool folds, std::string_view colour,
                   std::string_view width) {
    bool any = false;
    for (const Stroke3& stroke : strokes) {
      if (stroke.fold != folds) continue;
      if (!std::exchange(any, true)) text_.put("<path d=\"");
      put_point("M", stroke.from);
      put_point("L", stroke.to);
    }
    if (any) text_("\" fill=\"none\" stroke=\"", colour, "\" stroke-width=\"", width, "\"/>\n");
  }

  const Pattern& pattern_;
  double psi_rad_;
  std::vector<Vec3> places_;
  Camera camera_;
  TextSink text_;
  double width_px_{0}, height_px_{0};
};

}  // namespace

std::array<double, 2> deployed_size_px(const Pattern& pattern, double psi_rad, const View& view) {
  std::ostringstream nowhere;
  return Picture(pattern, psi_rad, view, nowhere).size_px();
}

void write_deployed_svg(const Pattern& pattern, double psi_rad, const View& view,
                        std::ostream& out) {
  Picture(pattern, psi_rad, view, out).draw();
}

}  // namespace popcut
