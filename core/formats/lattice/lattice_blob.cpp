// SPDX-License-Identifier: MIT
#include "core/formats/lattice/lattice_blob.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/curvature/fold_vertices.hpp"
#include "core/curvature/pattern_curvature.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/formats/lattice/blob_bytes.hpp"
#include "core/formats/lattice/face_sides.hpp"
#include "core/formats/write/report_json.hpp"
#include "core/picture/deployed_svg.hpp"
#include "core/picture/ghost.hpp"
#include "core/picture/target_on_sheet.hpp"
#include "core/text/json_text.hpp"

namespace popcut {
namespace {

using Json = nlohmann::ordered_json;

constexpr float kNotMeasured = std::numeric_limits<float>::quiet_NaN();

constexpr int kKiteFrames = 60;  ///< from flat to shut, where the page does not know the motion

/// What a face is, by its number in the blob.
constexpr std::uint8_t kPanel = 0, kWall = 1, kGround = 2;

/// A pattern of the whole, and the design that it came from.
struct Part {
  const Pattern* pattern{};
  const Design* design{};
};

/// One error of a face and where it is.
struct WorstFace {
  float error_mm{kNotMeasured};
  std::int32_t slice{-1}, level{-1};
};

float f32(double number) { return static_cast<float>(number); }

void append(std::vector<float>& to, std::initializer_list<double> numbers) {
  for (const double number : numbers) to.push_back(f32(number));
}

/// Writes parts, one after another, into the arrays of a blob.
class LatticeWriter {
 public:
  LatticeWriter(std::span<const Part> parts, const LatticeFrames* frames,
                const LatticeBlobOptions& options)
      : parts_(parts), frames_(frames), options_(options) {
    for (const Part& part : parts_) {
      wall_mm_ = std::max(wall_mm_, wall_of(*part.pattern));
      has_kites_ = has_kites_ || !part.pattern->kites.empty();
    }
    if (frames_ != nullptr || !has_kites_) return;
    // The page knows the law of panels that are parallel to wall or ground alone.
    for (int k = 0; k <= kKiteFrames; ++k)
      own_.psi_rad.push_back(std::numbers::pi * (kKiteFrames - k) / kKiteFrames);
    frames_ = &own_;
  }

  /// @param name    of the whole
  /// @param report  its text, or "null"
  Result<std::string> write(const std::string& name, const std::string& report) {
    if (auto fits = check_sizes(report.size()); !fits) return tl::unexpected(fits.error());
    for (const Part& part : parts_)
      if (auto done = add(part); !done) return tl::unexpected(done.error());
    add_frames();
    return blob_bytes(head(name, report), arrays_);
  }

 private:
  [[nodiscard]] static double wall_of(const Pattern& p) { return p.place.u_mm + p.wall_mm; }

  /// Sizes before memory: none of the arrays becomes larger than what is counted here.
  [[nodiscard]] Result<void> check_sizes(std::size_t report_bytes) const {
    std::size_t bytes = 3 * report_bytes + 65536 + 64 * options_.most_ghost_triangles;
    for (const Part& part : parts_) {
      const Pattern& p = *part.pattern;
      if (frames_ == &own_) {
        bytes += 12 * p.vertices.size() * own_.psi_rad.size();
      } else if (frames_ != nullptr) {
        if (frames_->places.size() != frames_->psi_rad.size())
          return fail(ErrorKind::OutOfRange, "frames", "each needs an opening angle");
        for (std::size_t f = 0; f < frames_->places.size(); ++f)
          if (frames_->places[f].size() != p.vertices.size())
            return fail(ErrorKind::OutOfRange, fmt::format("frames/{}", f),
                        fmt::format("has {} places; the pattern has {} vertices",
                                    frames_->places[f].size(), p.vertices.size()));
        bytes += 12 * p.vertices.size() * frames_->places.size();
      }
      bytes += 20 * p.vertices.size() + 19 * most_triangles(p) + 26 * p.faces() +
               24 * p.v_folds.size() +
               17 * (std::max(p.lines.size(), p.edges.size()) + options_.others.size());
    }
    if (bytes > kMaxLatticeBytes)
      return fail(ErrorKind::OutOfRange, "",
                  fmt::format("the pattern takes {} MiB to show, and {} MiB are the most; use "
                              "fewer slices or units",
                              bytes >> 20, kMaxLatticeBytes >> 20));
    return {};
  }

  Result<void> add(const Part& part) {
    const Pattern& pattern = *part.pattern;
    first_point_ = static_cast<std::uint32_t>(arrays_.points.size() / 3);
    first_face_ = arrays_.face_kind.size();
    shift_v_ = parts_.size() > 1 ? pattern.place.v_mm : 0.0;
    shift_u_ = parts_.size() > 1 ? pattern.place.u_mm : 0.0;
    arrays_.points.reserve(arrays_.points.size() + 3 * pattern.vertices.size());
    for (const PatternVertex& p : pattern.vertices)
      append(arrays_.points, {p.x, p.z, p.v + shift_v_});
    auto cut = sided_triangles(pattern);
    if (!cut) return tl::unexpected(cut.error());
    add_triangles(*cut);
    add_faces(part);
    add_tips(pattern);
    add_lines(pattern);
    if (options_.curvature) add_curvature(pattern);
    if (part.design != nullptr) add_target(*part.design);
    return {};
  }

  void add_triangles(const SidedTriangles& cut) {
    for (std::size_t t = 0; t < cut.corners.size(); ++t) {
      for (const std::uint32_t corner : cut.corners[t])
        arrays_.triangles.push_back(first_point_ + corner);
      arrays_.triangle_face.push_back(static_cast<std::uint32_t>(first_face_) + cut.face[t]);
      for (const SideRole role : cut.sides[t])
        arrays_.sides.push_back(static_cast<std::uint8_t>(role));
    }
  }

  void add_faces(const Part& part) {
    const Pattern& pattern = *part.pattern;
    const std::size_t faces = first_face_ + pattern.faces();
    arrays_.face_kind.resize(faces, kPanel);
    arrays_.face_slice.resize(faces, -1);
    arrays_.face_level.resize(faces, -1);
    arrays_.face_error.resize(faces, kNotMeasured);
    arrays_.face_merged.resize(faces, 0);
    if (parts_.size() > 1)
      arrays_.face_part.resize(faces, static_cast<std::int32_t>(&part - parts_.data()));
    for (std::size_t p = 0; p < options_.parts.size(); ++p)
      arrays_.face_part.insert(arrays_.face_part.end(), options_.parts[p].faces,
                               static_cast<std::int32_t>(p));
    if (part.design != nullptr && part.design->panel_face.size() == part.design->strips.panels()) {
      add_panels(*part.design);
    } else if (pattern.card) {
      for (std::size_t f = 0; f < pattern.faces(); ++f)
        arrays_.face_kind[first_face_ + f] = kind_by_place(pattern, pattern.face(f));
    }
    add_v_fold_faces(pattern);
  }

  [[nodiscard]] static std::uint8_t kind_by_place(const Pattern& pattern,
                                                  std::span<const std::uint32_t> face) {
    const auto all_at = [&](double PatternVertex::*part) {
      return std::all_of(face.begin(), face.end(), [&](std::uint32_t i) {
        return std::abs(pattern.vertices[i].*part) <= 1e-9;
      });
    };
    if (all_at(&PatternVertex::x)) return kWall;
    return all_at(&PatternVertex::z) ? kGround : kPanel;
  }

  [[nodiscard]] std::size_t face_at(std::int32_t face) const {
    return first_face_ + static_cast<std::size_t>(face);
  }

  void add_panels(const Design& design) {
    const Strips& strips = design.strips;
    for (const bool of_slices : {false, true})  // what a slice says of a face it shares counts
      for (std::size_t s = 0; s < strips.size(); ++s) {
        const bool is_slice =
            strips.kind[s] == StripKind::Slice || strips.kind[s] == StripKind::Box;
        if (is_slice != of_slices) continue;
        for (std::uint32_t p = strips.first_panel[s]; p < strips.first_panel[s + 1]; ++p) {
          if (strips.is_cut(p)) continue;
          const std::size_t f = face_at(design.panel_face[p]);
          if (strips.plane[p] == kWallPlane) arrays_.face_kind[f] = kWall;
          if (strips.plane[p] == kGroundPlane) arrays_.face_kind[f] = kGround;
          if (strips.plane[p] <= kGroundPlane) continue;
          arrays_.face_slice[f] = strips.slice[s];
          arrays_.face_level[f] = strips.level[p];
        }
      }
    std::map<std::pair<std::int32_t, bool>, std::vector<std::size_t>> strips_of;
    for (std::size_t s = 0; s < strips.size(); ++s) {
      const StripKind kind = strips.kind[s];
      if (kind != StripKind::Margin && kind != StripKind::Blank)
        strips_of[{strips.slice[s], kind == StripKind::Slice || kind == StripKind::Box}].push_back(
            s);
    }
    for (const MergedPlace& place : design.report.merged)
      for (const std::size_t s : strips_of[{place.slice, place.where == "slice"}])
        mark_merged(design, s, place.level);
  }

  /// The panels of a strip on both sides of a level that it has not.
  void mark_merged(const Design& design, std::size_t s, int level) {
    const Strips& strips = design.strips;
    const auto begin = strips.level.begin() + strips.first_panel[s];
    const auto end = strips.level.begin() + strips.first_panel[s + 1];
    const auto mark = [&](auto panel) {
      const auto p = static_cast<std::size_t>(panel - strips.level.begin());
      if (strips.plane[p] > kGroundPlane) arrays_.face_merged[face_at(design.panel_face[p])] = 1;
    };
    const auto after = std::find_if(begin, end, [&](std::int32_t l) { return l > level; });
    if (after != end) mark(after);
    const auto before =
        std::find_if(std::make_reverse_iterator(end), std::make_reverse_iterator(begin),
                     [&](std::int32_t l) { return l >= 0 && l < level; });
    if (before.base() != begin) mark(std::prev(before.base()));
  }

  /// The triangles of a V-fold belong where its crease does.
  void add_v_fold_faces(const Pattern& pattern) {
    for (const VFold& fold : pattern.v_folds) {
      const PatternEdge &b = pattern.edges[fold.edge_b], &c = pattern.edges[fold.edge_c];
      for (const auto& [panel, triangle] : {std::pair(b.left, b.right), {c.right, c.left}}) {
        if (panel < 0 || triangle < 0) continue;
        arrays_.face_kind[face_at(triangle)] = kPanel;
        arrays_.face_slice[face_at(triangle)] = arrays_.face_slice[face_at(panel)];
        arrays_.face_level[face_at(triangle)] = arrays_.face_level[face_at(panel)];
      }
    }
  }

  void add_tips(const Pattern& pattern) {
    for (const VFold& fold : pattern.v_folds) {
      const PatternVertex& apex = pattern.vertices[fold.apex];
      arrays_.tips.push_back(first_point_ + fold.tip);
      append(arrays_.tip_apex, {apex.x, apex.z, apex.v + shift_v_});
      arrays_.tip_w.push_back(f32(fold.length_mm));
      arrays_.tip_alpha.push_back(f32(fold.alpha));
    }
  }

  void add_line(const SheetLine& line, SideRole role) {
    append(arrays_.lines,
           {line.u0 + shift_u_, line.v0 + shift_v_, line.u1 + shift_u_, line.v1 + shift_v_});
    arrays_.line_role.push_back(static_cast<std::uint8_t>(role));
  }

  void add_lines(const Pattern& pattern) {
    for (const SheetLine& line : pattern.lines) add_line(line, side_role({0, 0, 0, -1, line.role}));
    if (pattern.lines.empty()) add_lines_of_edges(pattern);
    for (const SheetLine& line : options_.others) add_line(line, SideRole::Inside);
  }

  /// Edges as lines; borders that lie on each other are the two sides of one slit.
  void add_lines_of_edges(const Pattern& pattern) {
    using Ends = std::array<double, 4>;
    std::map<Ends, bool> borders;  // whether it is there twice
    const auto line_of = [&](const PatternEdge& e) {
      const PatternVertex &a = pattern.vertices[e.from], &b = pattern.vertices[e.to];
      Ends line{pattern.u(a), a.v, pattern.u(b), b.v};
      if (std::pair(line[2], line[3]) < std::pair(line[0], line[1]))
        line = {line[2], line[3], line[0], line[1]};
      return line;
    };
    for (const PatternEdge& e : pattern.edges) {
      const SideRole role = side_role(e);
      if (role != SideRole::Outline && role != SideRole::Slit) continue;
      const auto [at, is_new] = borders.try_emplace(line_of(e), role == SideRole::Slit);
      if (!is_new) at->second = true;
    }
    for (const PatternEdge& e : pattern.edges) {
      const SideRole role = side_role(e);
      if (role != SideRole::Mountain && role != SideRole::Valley) continue;
      const Ends l = line_of(e);
      add_line({l[0], l[1], l[2], l[3], {}}, role);
    }
    for (const auto& [l, is_slit] : borders)
      add_line({l[0], l[1], l[2], l[3], {}}, is_slit ? SideRole::Slit : SideRole::Outline);
  }

  /// K and H at the ends of the folds whose middle is a fold vertex, and their mean over each face.
  /// A pattern without connectors has none.
  void add_curvature(const Pattern& pattern) {
    const std::size_t points = arrays_.points.size() / 3, faces = arrays_.face_kind.size();
    for (auto* at_points : {&arrays_.point_k, &arrays_.point_h})
      at_points->resize(points, kNotMeasured);
    for (auto* at_faces : {&arrays_.face_k, &arrays_.face_h}) at_faces->resize(faces, kNotMeasured);
    const auto vertices = fold_vertices(pattern);
    if (!vertices) return;
    const auto values = pattern_curvature(*vertices, pattern.design_psi_rad);
    auto value = values.begin();
    const CreasePoints creases(pattern);
    for (const FoldVertex& vertex : *vertices) {
      if (!vertex.inner()) continue;
      for (const std::uint32_t point : creases.on(vertex)) {
        arrays_.point_k[first_point_ + point] = f32(value->curvature.K_area);
        arrays_.point_h[first_point_ + point] = f32(value->curvature.H);
      }
      ++value;
    }
    for (std::size_t f = 0; f < pattern.faces(); ++f) {
      arrays_.face_k[first_face_ + f] = mean_at(pattern.face(f), arrays_.point_k);
      arrays_.face_h[first_face_ + f] = mean_at(pattern.face(f), arrays_.point_h);
    }
  }

  /// The points of a pattern on its valley folds.
  class CreasePoints {
   public:
    explicit CreasePoints(const Pattern& pattern) {
      for (const PatternEdge& e : pattern.edges)
        if (e.role == EdgeRole::Valley) add(pattern, e.from), add(pattern, e.to);
      for (const VFold& fold : pattern.v_folds) add(pattern, fold.tip);
      std::sort(points_.begin(), points_.end(), [](const Point& a, const Point& b) {
        return std::tie(a.u, a.v, a.index) < std::tie(b.u, b.v, b.index);
      });
    }

    [[nodiscard]] std::vector<std::uint32_t> on(const FoldVertex& vertex) const {
      constexpr double kSame = 1e-6;
      std::vector<std::uint32_t> out;
      const auto from = std::lower_bound(points_.begin(), points_.end(), vertex.u_mm - kSame,
                                         [](const Point& p, double u) { return p.u < u; });
      for (auto p = from; p != points_.end() && p->u <= vertex.u_mm + kSame; ++p)
        if (p->v >= vertex.v0_mm - kSame && p->v <= vertex.v1_mm + kSame) out.push_back(p->index);
      return out;
    }

   private:
    struct Point {
      double u{}, v{};
      std::uint32_t index{};
    };
    void add(const Pattern& pattern, std::uint32_t i) {
      points_.push_back({pattern.u(pattern.vertices[i]), pattern.vertices[i].v, i});
    }
    std::vector<Point> points_;
  };

  [[nodiscard]] float mean_at(std::span<const std::uint32_t> face,
                              const std::vector<float>& values) const {
    double sum = 0, count = 0;
    for (const std::uint32_t i : face) {
      const float value = values[first_point_ + i];
      if (std::isfinite(value)) sum += value, ++count;
    }
    return count > 0 ? f32(sum / count) : kNotMeasured;
  }

  void add_target(const Design& design) {
    if (!options_.error && options_.most_ghost_triangles == 0) return;
    const TriangleSoup target = target_on_sheet(design, true);
    if (target.size() == 0) return;
    if (options_.error) add_errors(design.pattern, target);
    if (options_.most_ghost_triangles > 0)
      add_ghost(coarse_target(target, options_.most_ghost_triangles / parts_.size()));
  }

  /// The mean distance of each face from the target, as pictures colour panels by it.
  void add_errors(const Pattern& pattern, const TriangleSoup& target) {
    const int places_across = options_.quality == LatticeQuality::Draft ? 2 : 3;
    const CardScene scene =
        card_scene(pattern, {.target = &target,
                             .most_panels = std::numeric_limits<std::size_t>::max(),
                             .places_across = places_across});
    std::vector<double> sum(pattern.faces()), area(pattern.faces());
    for (std::size_t s = 0; s < scene.error_mm.size(); ++s) {
      const Slab& slab = scene.slabs.slabs[s];
      for (std::size_t k = 0; k < slab.panels.size(); ++k) {
        const SlabPanel& panel = slab.panels[k];
        const double length =
            std::abs(panel.low_b.x - panel.low_a.x) + std::abs(panel.low_b.z - panel.low_a.z) +
            std::abs(panel.high_b.x - panel.high_a.x) + std::abs(panel.high_b.z - panel.high_a.z);
        const double part = length * (slab.high_mm - slab.low_mm);
        sum[panel.face] += part * scene.error_mm[s][k];
        area[panel.face] += part;
      }
    }
    for (std::size_t f = 0; f < pattern.faces(); ++f) {
      float& error = arrays_.face_error[first_face_ + f];
      const std::uint8_t kind = arrays_.face_kind[first_face_ + f];
      if (kind != kPanel)
        error = 0;
      else if (area[f] > 0)
        error = f32(sum[f] / area[f]);
      if (kind == kPanel && !(error <= worst_.error_mm) && std::isfinite(error))
        worst_ = {error, arrays_.face_slice[first_face_ + f], arrays_.face_level[first_face_ + f]};
    }
  }

  void add_ghost(const CoarseTarget& ghost) {
    std::map<std::array<double, 3>, std::uint32_t> known;
    for (const auto& triangle : ghost.corners)
      for (const Vec3& p : triangle) {
        const auto next = static_cast<std::uint32_t>(arrays_.ghost_points.size() / 3);
        const auto [at, is_new] = known.try_emplace({p[0], p[1], p[2]}, next);
        if (is_new) append(arrays_.ghost_points, {p[0], p[1] + shift_v_, p[2]});
        arrays_.ghost_triangles.push_back(at->second);
      }
  }

  void add_frames() {
    if (frames_ == &own_) {
      arrays_.frames.reserve(arrays_.points.size() * own_.psi_rad.size());
      for (const double psi : own_.psi_rad)
        for (const Part& part : parts_)
          for (const auto& [x, v, z] : posed_vertices(*part.pattern, psi))
            append(arrays_.frames,
                   {x, v + (parts_.size() > 1 ? part.pattern->place.v_mm : 0.0), z});
      return;
    }
    if (frames_ == nullptr || frames_->places.empty()) return;
    arrays_.frames.reserve(arrays_.points.size() * frames_->places.size());
    for (const std::vector<Vec3>& frame : frames_->places)
      for (const Vec3& p : frame) append(arrays_.frames, {p[0], p[1], p[2]});
  }

  [[nodiscard]] Json card() const {
    double ground = 0, width = 0;
    bool is_card = true;
    for (const Part& part : parts_) {
      const Pattern& p = *part.pattern;
      const bool is_one = parts_.size() == 1;
      ground = std::max(ground, p.ground_mm);
      width = std::max(width, p.width_mm + (is_one ? 0.0 : p.place.v_mm));
      is_card = is_card && p.card;
    }
    return {{"wall_mm", parts_.size() == 1 ? parts_[0].pattern->wall_mm : wall_mm_},
            {"ground_mm", ground},
            {"width_mm", width},
            {"card", is_card}};
  }

  [[nodiscard]] static Json warning(const Warning& warning) {
    Json json{{"code", warning.code}, {"message", warning.message}};
    Json& place = json["place"];
    if (warning.place.sheet > 0) place["sheet"] = warning.place.sheet;
    if (warning.place.u_mm) place["u_mm"] = *warning.place.u_mm;
    if (warning.place.v_mm) place["v_mm"] = *warning.place.v_mm;
    if (!warning.place.source.empty()) place["source"] = warning.place.source;
    json["spoils"] = warning.spoils;
    return json;
  }

  [[nodiscard]] std::string head(const std::string& name, const std::string& report) const {
    constexpr std::array kQualities{"draft", "exact", "stored"};
    const Part& first = parts_.front();
    const bool is_pose = frames_ == nullptr, is_frames = !is_pose && !frames_->psi_rad.empty();
    Json json{{"quality", kQualities.at(static_cast<std::size_t>(options_.quality))}};
    json["lattice"] = first.design == nullptr ? Json() : Json(first.design->report.lattice);
    json["name"] = name;
    json["kind"] = options_.kind;
    json["card"] = card();
    json["design_psi_rad"] = first.pattern->design_psi_rad;
    json["faces"] = arrays_.face_kind.size();
    json["warnings"] = Json::array();
    for (const Part& part : parts_)
      if (part.design != nullptr)
        for (const Warning& w : part.design->report.warnings)
          json["warnings"].push_back(warning(w));
    for (const Warning& w : options_.warnings) json["warnings"].push_back(warning(w));
    json["error_mm"] = nullptr;
    if (std::isfinite(worst_.error_mm))
      json["error_mm"] = {{"max", worst_.error_mm},
                          {"at", {{"slice", worst_.slice}, {"level", worst_.level}}}};
    json["motion"] = is_pose ? "pose" : is_frames ? "frames" : "flat";
    if (is_frames) json["frames"] = {{"psi_rad", frames_->psi_rad}};
    if (!options_.parts.empty()) {
      json["parts"] = Json::array();
      for (const LatticePart& part : options_.parts)
        json["parts"].push_back({{"name", part.name},
                                 {"folds", part.folds},
                                 {"tabs", part.tabs},
                                 {"box_mm", part.box_mm},
                                 {"shift_mm", part.shift_mm}});
    }
    json["judged"] = options_.judged;
    json["not_judged"] = options_.not_judged;
    std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.pop_back();
    return text + ",\"report\":" + report + "}";
  }

  std::span<const Part> parts_;
  const LatticeFrames* frames_;
  LatticeFrames own_;  ///< of patterns with kites, without places
  bool has_kites_{};
  const LatticeBlobOptions& options_;
  LatticeArrays arrays_;
  double wall_mm_{};
  std::uint32_t first_point_{};  ///< of the part that is written
  std::size_t first_face_{};
  double shift_u_{}, shift_v_{};
  WorstFace worst_;
};

}  // namespace

Result<std::string> lattice_blob(const Design& design, const LatticeBlobOptions& options) {
  const Part part{&design.pattern, &design};
  return LatticeWriter({&part, 1}, nullptr, options)
      .write(design.pattern.name, report_json(design.report));
}

Result<std::string> lattice_blob(const PatchAssembly& assembly, const LatticeBlobOptions& options) {
  std::vector<Part> parts;
  for (const Design& design : assembly.parts) parts.push_back({&design.pattern, &design});
  return LatticeWriter(parts, nullptr, options).write(assembly.name, report_json(assembly));
}

Result<std::string> lattice_blob(const Pattern& pattern, const LatticeBlobOptions& options) {
  const Part part{&pattern, nullptr};
  return LatticeWriter({&part, 1}, nullptr, options).write(pattern.name, "null");
}

Result<std::string> lattice_blob(const Pattern& pattern, const LatticeFrames& frames,
                                 const LatticeBlobOptions& options) {
  const Part part{&pattern, nullptr};
  return LatticeWriter({&part, 1}, &frames, options)
      .write(pattern.name, options.report.empty() ? "null" : options.report);
}

}  // namespace popcut
