// SPDX-License-Identifier: MIT
#include "core/picture/deployed_svg.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/fit/triangle_tree.hpp"
#include "core/geometry/angle.hpp"
#include "core/geometry/design_angle.hpp"
#include "core/geometry/vec.hpp"
#include "core/picture/ghost.hpp"
#include "core/picture/picture_words.hpp"
#include "core/text/svg_document.hpp"
#include "core/text/text_sink.hpp"

namespace popcut {
namespace {

/// Parallel projection of places (x, v, z) to picture coordinates, y down.
struct Camera {
  Vec3 right, up, eye;
  double scale{1}, x0{0}, y0{0};

  Camera(double azimuth_rad, double elevation_rad) {
    const double ca = std::cos(azimuth_rad), sa = std::sin(azimuth_rad);
    const double ce = std::cos(elevation_rad), se = std::sin(elevation_rad);
    right = {-sa, ca, 0};
    up = {-se * ca, -se * sa, ce};
    eye = {ce * ca, ce * sa, se};
  }
  [[nodiscard]] std::array<double, 2> project(const Vec3& p) const {
    return {scale * (dot(right, p) - x0), scale * (y0 - dot(up, p))};
  }
};

const Vec3 kLamp{0.42, 0.30, 0.86};  // unit length

using Colour = std::array<double, 3>;

std::string hex(const Colour& colour, double light) {
  const auto tone = [&](double c) { return static_cast<int>(std::clamp(c * light, 0.0, 255.0)); };
  return fmt::format("#{:02x}{:02x}{:02x}", tone(colour[0]), tone(colour[1]), tone(colour[2]));
}

/// From paper over orange and red to violet: lightness falls all the way, so that it also reads
/// without colours.
Colour error_colour(double share) {
  constexpr std::array<Colour, 5> kStops{
      {{250, 245, 225}, {253, 203, 122}, {240, 128, 84}, {186, 48, 100}, {78, 18, 112}}};
  const double at = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const std::size_t i = std::min(static_cast<std::size_t>(at), kStops.size() - 2);
  const double part = at - static_cast<double>(i);
  Colour out{};
  for (std::size_t k = 0; k < 3; ++k)
    out[k] = kStops[i][k] + part * (kStops[i + 1][k] - kStops[i][k]);
  return out;
}

class Picture {
 public:
  Picture(const CardScene& scene, double psi_rad, const View& view, std::ostream& out)
      : scene_(scene),
        pattern_(*scene.pattern),
        psi_rad_(psi_rad),
        view_(view),
        camera_(view.azimuth_rad, std::min(psi_rad / 2, kLargestElevationRad)),
        text_(out) {
    for (const auto& p : posed_vertices(pattern_, psi_rad)) places_.push_back(vec3(p));
    if (is_shown_at(scene, psi_rad)) raise_ghost(*scene.ghost);
    fit();
  }

  [[nodiscard]] std::array<double, 2> size_px() const { return {width_px_, height_px_}; }

  void draw() {
    text_.put(svg_head(fmt::format("width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\"",
                                   std::ceil(width_px_), std::ceil(height_px_)),
                       fmt::format("{}, psi = {} rad", pattern_.name, psi_rad_), SvgPlace::Inside));
    if (view_.labels == Labels::All)
      put_rectangle(text_, 0, 0, std::ceil(width_px_), std::ceil(height_px_), "#ffffff");
    text_.put("<g stroke-linejoin=\"round\" stroke-linecap=\"round\">\n");
    if (!ghost_.empty()) put_ghost(ghost_.front().outside);
    const std::vector<Slab>& slabs = scene_.slabs.slabs;
    for (std::size_t s = 0; s < slabs.size(); ++s) {
      for (const SlabPanel& hole : slabs[s].holes())
        put_panels({&hole}, slabs[s], hole.is_upright ? "#38322d" : "#4a423b", 0.9);
      if (!ghost_.empty()) put_ghost(ghost_[s + 1].inside, kBehindPaper);
      put_slab(s, false);
      put_strokes(slabs[s].strokes, false);
      put_slab(s, true);
      put_strokes(slabs[s].strokes, true);
      for (const std::uint32_t k : slabs[s].v_folds) put_v_fold(pattern_.v_folds[k]);
      if (!ghost_.empty()) put_ghost(ghost_[s + 1].outside);
    }
    if (!ghost_.empty()) put_ghost(ghost_.back().outside);
    for (const SceneLine& line : scene_.lines) {
      put_point("<path d=\"M", line.from, line.kite);
      put_point("L", line.to, line.kite);
      text_("\" fill=\"none\" stroke=\"", line.colour, "\" stroke-width=\"", kLinePx, "\"/>\n");
    }
    text_.put("</g>\n");
    if (view_.labels != Labels::None) put_bar();
    if (view_.labels == Labels::All) put_labels();
    text_.put("</svg>\n");
  }

 private:
  static constexpr double kLargestElevationRad = 0.55;
  static constexpr double kCaptionPx = 76, kLinePx = 4;
  static constexpr std::size_t kMostGhost = 3000;
  /// Of the ghost that is seen through an open side: a hole must not look like a panel.
  static constexpr double kBehindPaper = 0.14;

  [[nodiscard]] double margin_px() const { return view_.labels == Labels::All ? 34.0 : 12.0; }

  /// Cuts the target at the paper, in the coordinates of the section, where the paper is square.
  void raise_ghost(TriangleSoup target) {
    const DesignAngle opening = DesignAngle::of_rad(psi_rad_);
    const auto laid = [&](Vec3 p) {
      opening.to_oblique(p[0], p[2]);
      return p;
    };
    for (std::size_t k = 0; k < target.corners.size(); k += 3)
      opening.to_oblique(target.corners[k], target.corners[k + 2]);
    ghost_ = ghost_slabs(target, scene_.slabs.slabs, laid(camera_.eye), laid(kLamp), kMostGhost);
    for (GhostSlab& slab : ghost_)
      for (auto* const side : {&slab.inside, &slab.outside})
        for (GhostPolygon& polygon : *side)
          for (Vec3& p : polygon.corners) opening.to_space(p[0], p[2]);
  }

  // 1. The frame.

  /// Scales and shifts the projection so that the pattern fills the picture's width.
  void fit() {
    Eigen::AlignedBox2d seen;
    const auto see = [&](const Vec3& p) {
      seen.extend(Vec2{dot(camera_.right, p), dot(camera_.up, p)});
    };
    Eigen::AlignedBox3d box;
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const Vec3 place =
          pattern_.kites.empty() ? vec3(posed(pattern_.vertices[k], psi_rad_)) : places_[k];
      see(place), box.extend(place);
    }
    measure_depths();
    for (const GhostSlab& slab : ghost_)
      for (const auto* polygons : {&slab.inside, &slab.outside})
        for (const GhostPolygon& polygon : *polygons)
          for (const Vec3& p : polygon.corners) see(p);
    if (view_.labels != Labels::None && !box.isEmpty()) {
      const double across = box.sizes()[1];
      bar_mm_ = round_length(across / 2.5);
      bar_x_ = box.max()[0] + 0.05 * std::max(across, box.sizes()[0]);
      bar_v_ = box.min()[1];
      bar_deep_ = 0.012 * std::max(across, box.sizes()[0]);
      see({bar_x_ + bar_deep_, bar_v_, 0}), see({bar_x_ + bar_deep_, bar_v_ + bar_mm_, 0});
      bottom_px_ = 14;  // for its words, where nothing else is below it
    }
    width_px_ = view_.width_px;
    if (pattern_.vertices.empty()) return;
    const double left = seen.min().x(), right = seen.max().x(), top = seen.max().y();
    if (!(right > left)) return;
    const double margin = margin_px();
    camera_.scale =
        view_.px_per_mm > 0 ? view_.px_per_mm : (view_.width_px - 2 * margin) / (right - left);
    if (view_.px_per_mm > 0) width_px_ = (right - left) * camera_.scale + 2 * margin;
    camera_.x0 = left - margin / camera_.scale;
    camera_.y0 = top + margin / camera_.scale;
    height_px_ = (top - seen.min().y()) * camera_.scale + 2 * margin + bottom_px_;
    if (view_.labels == Labels::All) height_px_ += kCaptionPx;
    stroke_ = std::clamp(std::sqrt(4e5 / static_cast<double>(1 + pattern_.vertices.size())) / 20,
                         0.2, 1.0);
  }

  /// How far the middle of each face is towards the eye; all of a face has one tone.
  void measure_depths() {
    depth_.resize(pattern_.faces());
    for (std::size_t f = 0; f < depth_.size(); ++f) {
      const auto face = pattern_.face(f);
      for (const std::uint32_t corner : face) depth_[f] += dot(camera_.eye, places_[corner]);
      depth_[f] /= static_cast<double>(face.size());
      nearest_ = std::max(nearest_, depth_[f]), farthest_ = std::min(farthest_, depth_[f]);
    }
  }

  // 2. Paper.

  void put_place(std::string_view command, const Vec3& place) {
    const auto [x, y] = camera_.project(place);
    constexpr double kHundredths = 100.0;
    text_(command, std::round(x * kHundredths) / kHundredths, " ",
          std::round(y * kHundredths) / kHundredths);
  }

  void put_point(std::string_view command, const PatternVertex& p, const Kite* kite = nullptr) {
    put_place(command, vec3(kite != nullptr ? posed(*kite, p, psi_rad_) : posed(p, psi_rad_)));
  }

  void put_panels(const std::vector<const SlabPanel*>& panels, const Slab& slab,
                  std::string_view colour, double line) {
    text_.put("<path d=\"");
    for (const SlabPanel* panel : panels) {
      std::string_view command = "M";
      for (const PatternVertex& p : panel->corners(slab.low_mm, slab.high_mm))
        put_point(std::exchange(command, "L"), p, panel->kite);
      text_.put("Z");
    }
    // The stroke hides the thin line that antialiasing leaves between two panels.
    text_("\" fill=\"", colour, "\" stroke=\"", colour, "\" stroke-width=\"", line, "\"/>\n");
  }

  /// Of the panel of a kite, on the side on which the structure pops up.
  [[nodiscard]] Vec3 normal_of(const SlabPanel& panel) const {
    const KiteSection& kite = panel.kite->section;
    const KitePoint a = kite.posed(panel.low_a.x, panel.low_a.z, psi_rad_),
                    b = kite.posed(panel.low_b.x, panel.low_b.z, psi_rad_);
    return unit(Vec3{a.z - b.z, 0, b.x - a.x});
  }

  [[nodiscard]] std::string colour_of(std::size_t s, std::size_t p) const {
    const Slab& slab = scene_.slabs.slabs[s];
    const SlabPanel& panel = slab.panels[p];
    const Vec3 normal = panel.kite != nullptr ? normal_of(panel)
                        : panel.is_upright    ? Vec3{std::sin(psi_rad_), 0, -std::cos(psi_rad_)}
                                              : Vec3{0, 0, 1};
    const double lit = std::max(0.0, dot(normal, kLamp));
    if (panel.place != PanelPlace::Structure) return hex({238, 243, 247}, 0.80 + 0.22 * lit);
    const double range = nearest_ - farthest_;
    // A few steps only, so that panels of one slab come to one path.
    const double near =
        range > 0 ? std::round(24 * (depth_[panel.face] - farthest_) / range) / 24 : 1;
    if (!scene_.error_mm.empty()) {
      const double largest = scene_.largest_error_mm;
      const double share = largest > 0 ? scene_.error_mm[s][p] / largest : 0;
      return hex(error_colour(std::round(64 * share) / 64), 0.78 + 0.25 * lit);
    }
    const double light = (0.68 + 0.36 * lit) * (0.82 + 0.18 * near);
    return hex(colour_of(tone_of(panel.face)), light);
  }

  [[nodiscard]] PanelTone tone_of(std::uint32_t face) const {
    return face < scene_.tones.size() ? scene_.tones[face] : PanelTone::Paper;
  }

  [[nodiscard]] static Colour colour_of(PanelTone tone) {
    switch (tone) {
      case PanelTone::Pale:
        return {246, 240, 228};
      case PanelTone::Lit:
        return {255, 190, 60};
      case PanelTone::Loose:
        return {255, 120, 100};
      default:
        return {255, 226, 178};
    }
  }

  /// The panels of a slab, those of one colour as one path: none hides another. Or those of its
  /// kites, whose roofs come last.
  void put_slab(std::size_t s, bool kites) {
    const Slab& slab = scene_.slabs.slabs[s];
    std::map<std::pair<bool, std::string>, std::vector<const SlabPanel*>> of_colour;
    for (std::size_t p = 0; p < slab.panels.size(); ++p)
      if ((slab.panels[p].kite != nullptr) == kites)
        of_colour[{slab.panels[p].is_roof, colour_of(s, p)}].push_back(&slab.panels[p]);
    for (const auto& [key, panels] : of_colour)
      put_panels(
          panels, slab, key.second,
          panels.front()->place == PanelPlace::Structure ? std::max(0.6, 0.9 * stroke_) : 0.9);
  }

  /// The strokes of a slab, or those that bound the roofs of its kites.
  void put_strokes(const std::vector<SlabStroke>& strokes, bool of_roofs) {
    put_strokes(strokes, of_roofs, true, "#9a8f80", 0.5);
    put_strokes(strokes, of_roofs, false, kPictureInk, 0.8);
  }
  void put_strokes(const std::vector<SlabStroke>& strokes, bool of_roofs, bool folds,
                   std::string_view colour, double width) {
    bool any = false;
    for (const SlabStroke& stroke : strokes) {
      if (stroke.is_fold != folds || stroke.is_of_roof != of_roofs) continue;
      if (!std::exchange(any, true)) text_.put("<path d=\"");
      put_point("M", stroke.from, stroke.kite);
      put_point("L", stroke.to, stroke.kite);
    }
    if (any)
      text_("\" fill=\"none\" stroke=\"", colour, "\" stroke-width=\"",
            std::round(100 * width * stroke_) / 100, "\"/>\n");
  }

  /// The two triangles of a V-fold in their popped positions, the one away from the eye first.
  void put_v_fold(const VFold& fold) {
    const Vec3 &o = places_[fold.apex], &tip = places_[fold.tip];
    const Vec3& b = places_[pattern_.edges[fold.edge_b].to];
    const Vec3& c = places_[pattern_.edges[fold.edge_c].to];
    for (const auto& [side, colour] : {std::pair(&b, "#c9ab74"), std::pair(&c, "#eecb8c")}) {
      put_place("<path d=\"M", o);
      put_place("L", tip);
      put_place("L", *side);
      text_("Z\" fill=\"", colour, "\" stroke=\"", kPictureInk, "\" stroke-width=\"0.7\"/>\n");
    }
  }

  // 3. The ghost.

  void put_ghost(const std::vector<GhostPolygon>& polygons, double opacity = 0.42) {
    constexpr int kTones = 10;
    std::array<std::vector<const GhostPolygon*>, kTones + 1> of_tone;
    for (const GhostPolygon& polygon : polygons)
      of_tone[static_cast<std::size_t>(std::round(kTones * std::min(1.0, polygon.light)))]
          .push_back(&polygon);
    for (std::size_t tone = 0; tone < of_tone.size(); ++tone) {
      if (of_tone[tone].empty()) continue;
      const double light = static_cast<double>(tone) / kTones;
      text_.put("<path d=\"");
      for (const GhostPolygon* polygon : of_tone[tone]) {
        std::string_view command = "M";
        for (const Vec3& p : polygon->corners) put_tenths(std::exchange(command, "L"), p);
        text_.put("Z");
      }
      text_("\" fill=\"", hex({70 + 110 * light, 130 + 85 * light, 195 + 55 * light}, 1),
            "\" fill-opacity=\"", opacity, "\"/>\n");
    }
  }

  void put_tenths(std::string_view command, const Vec3& place) {
    const auto [x, y] = camera_.project(place);
    text_(command, std::round(x * 10) / 10, " ", std::round(y * 10) / 10);
  }

  // 4. Words and measures.

  /// A bar on the floor before the card, in dark and light fifths.
  void put_bar() {
    if (!(bar_mm_ > 0)) return;
    constexpr int kParts = 5;
    for (int i = 0; i < kParts; ++i) {
      const double from = bar_v_ + bar_mm_ * i / kParts, to = bar_v_ + bar_mm_ * (i + 1) / kParts;
      put_place("<path d=\"M", {bar_x_, from, 0});
      put_place("L", {bar_x_, to, 0});
      put_place("L", {bar_x_ + bar_deep_, to, 0});
      put_place("L", {bar_x_ + bar_deep_, from, 0});
      text_("Z\" fill=\"", i % 2 == 0 ? kPictureInk : std::string_view("#ffffff"), "\" stroke=\"",
            kPictureInk, "\" stroke-width=\"0.7\"/>\n");
    }
    const auto [x, y] = camera_.project({bar_x_ + bar_deep_, bar_v_ + bar_mm_, 0});
    text_.put(picture_text(x + 4, y + 20, fmt::format("{:g} mm", bar_mm_), "start"));
  }

  /// A length along an edge of the card, beside its middle, on the right side of the way a to b.
  void put_length(const PatternVertex& a, const PatternVertex& b, double mm) {
    const auto [ax, ay] = camera_.project(vec3(posed(a, psi_rad_)));
    const auto [bx, by] = camera_.project(vec3(posed(b, psi_rad_)));
    const double length = std::hypot(bx - ax, by - ay);
    if (length < 40) return;
    const double nx = -(by - ay) / length, ny = (bx - ax) / length;
    double turn_deg = degrees(std::atan2(by - ay, bx - ax));
    const bool turned = turn_deg > 90 || turn_deg <= -90;
    if (turned) turn_deg += turn_deg > 0 ? -180 : 180;
    const double away = turned ? 7 : 17;  // the text stands on its base line
    text_.put(picture_text((ax + bx) / 2 + away * nx, (ay + by) / 2 + away * ny,
                           fmt::format("{:.4g} mm", mm), "middle", {.degrees = turn_deg}));
  }

  void put_labels() {
    const double w = pattern_.width_mm, wall = pattern_.wall_mm, ground = pattern_.ground_mm;
    if (pattern_.card) {
      put_length({ground, 0, w}, {ground, 0, 0}, w);
      put_length({0, 0, w}, {ground, 0, w}, ground);
      put_length({0, wall, w}, {0, 0, w}, wall);
    }
    const double left = 16, base = height_px_ - kCaptionPx + 24;
    text_.put(picture_text(left, base, pattern_.name, "start", {.size = 17}));
    std::string words = fmt::format("opened to {:.0f}\u00b0", degrees(psi_rad_));
    if (pattern_.card) words = card_in_words(pattern_) + ", " + words;
    if (!ghost_.empty()) words += "; blue: the shape asked for";
    if (std::ranges::find(scene_.tones, PanelTone::Loose) != scene_.tones.end())
      words += "; red: moves by more than 1 mm in paper";
    text_.put(picture_text(left, base + 20, words, "start"));
    text_.put(picture_text(left, base + 38, thinned_in_words(scene_), "start"));
    text_.put(error_legend(scene_, width_px_ - 216, base - 22));
  }

  const CardScene& scene_;
  const Pattern& pattern_;
  double psi_rad_;
  View view_;
  std::vector<Vec3> places_;
  std::vector<double> depth_;     ///< of each face's middle, towards the eye
  std::vector<GhostSlab> ghost_;  ///< none in other poses than the designed one
  Camera camera_;
  TextSink text_;
  double width_px_{0}, height_px_{0}, stroke_{1};
  double nearest_{-1e300}, farthest_{1e300};  ///< of the structure, towards the eye
  double bar_mm_{0}, bar_x_{0}, bar_v_{0}, bar_deep_{0}, bottom_px_{0};
};

/// Mean distance from the target of a panel that is opened to `psi_rad`. `hint` is a triangle of
/// the target near the panel before, and near this one after.
double distance_mm(const SlabPanel& panel, const Slab& slab, const TriangleTree& tree,
                   double psi_rad, int places_across, std::uint32_t& hint) {
  double sum = 0;
  const auto c = panel.corners(slab.low_mm, slab.high_mm);
  const auto place = [&](const PatternVertex& p) {
    return vec3(panel.kite != nullptr ? posed(*panel.kite, p, psi_rad) : posed(p, psi_rad));
  };
  const std::array<Vec3, 4> at{place(c[0]), place(c[1]), place(c[2]), place(c[3])};
  for (int i = 0; i < places_across; ++i)
    for (int j = 0; j < places_across; ++j) {
      const double s = (i + 0.5) / places_across, t = (j + 0.5) / places_across;
      const Vec3 low = at[0] + s * (at[1] - at[0]), high = at[3] + s * (at[2] - at[3]);
      const auto nearest = tree.nearest(low + t * (high - low), hint);
      hint = nearest.place;
      sum += std::sqrt(nearest.squared);
    }
  return sum / (places_across * places_across);
}

}  // namespace

CardScene card_scene(const Pattern& pattern, const SceneOptions& options) {
  CardScene scene{&pattern, options.ghost, cut_into_slabs(pattern, options.most_panels), {}, 0, {},
                  {}};
  if (options.target == nullptr || options.target->size() == 0) return scene;
  const TriangleTree tree(*options.target);
  std::uint32_t hint = TriangleTree::kNone;
  for (const Slab& slab : scene.slabs.slabs) {
    std::vector<double>& errors = scene.error_mm.emplace_back();
    for (const SlabPanel& panel : slab.panels) {
      const bool is_structure = panel.place == PanelPlace::Structure;
      errors.push_back(is_structure ? distance_mm(panel, slab, tree, pattern.design_psi_rad,
                                                  options.places_across, hint)
                                    : 0);
      scene.largest_error_mm = std::max(scene.largest_error_mm, errors.back());
    }
  }
  return scene;
}

bool is_shown_at(const CardScene& scene, double psi_rad) {
  return scene.ghost != nullptr && std::abs(psi_rad - scene.pattern->design_psi_rad) < 1e-9;
}

std::array<double, 2> deployed_size_px(const CardScene& scene, double psi_rad, const View& view) {
  std::ostringstream nowhere;
  return Picture(scene, psi_rad, view, nowhere).size_px();
}

void write_deployed_svg(const CardScene& scene, double psi_rad, const View& view,
                        std::ostream& out) {
  Picture(scene, psi_rad, view, out).draw();
}

std::string error_legend(const CardScene& scene, double x, double y) {
  if (scene.error_mm.empty()) return {};
  constexpr int kParts = 20;
  constexpr double kWidth = 200;
  std::string out = "<g>\n";
  out +=
      picture_text(x + kWidth / 2, y + 12, "mean distance from the shape", "middle", {.size = 13});
  y += 18;
  for (int i = 0; i < kParts; ++i)
    out += fmt::format(
        "<rect x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"10\" fill=\"{}\"/>\n",
        x + kWidth * i / kParts, y, kWidth / kParts + 0.3,
        hex(error_colour((i + 0.5) / kParts), 1));
  out += picture_text(x, y + 25, "0", "start", {.size = 13});
  out += picture_text(x + kWidth, y + 25, fmt::format("{:.2g} mm", scene.largest_error_mm), "end",
                      {.size = 13});
  return out + "</g>\n";
}

std::string thinned_in_words(const CardScene& scene) {
  const Slabs& slabs = scene.slabs;
  if (slabs.every_strip == 1 && slabs.every_step == 1) return {};
  return fmt::format("drawn coarser than it is: 1 of {} strips, {} step{} as one",
                     slabs.every_strip, slabs.every_step, slabs.every_step == 1 ? "" : "s");
}

std::string card_in_words(const Pattern& pattern) {
  return fmt::format("wall {0:.4g} x {1:.4g} mm, ground {2:.4g} x {1:.4g} mm", pattern.wall_mm,
                     pattern.width_mm, pattern.ground_mm);
}

}  // namespace popcut
