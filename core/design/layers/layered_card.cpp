// SPDX-License-Identifier: MIT
#include "core/design/layers/layered_card.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/design/facet_design.hpp"
#include "core/design/layers/corner_layers.hpp"
#include "core/design/layers/layer_outline.hpp"
#include "core/design/target/surface.hpp"
#include "core/geometry/angle.hpp"
#include "core/geometry/triangulate.hpp"
#include "core/parts/elements.hpp"

namespace popcut {
namespace {

constexpr double kCrease_rad = radians(70.0);  ///< of all V-folds; flatter ones wobble more
constexpr double kMargin_mm = 8.0;             ///< beside what is shut or open
constexpr double kTab_mm = 7.0;
constexpr double kApart_mm = kTab_mm + 1.5;  ///< between creases, so that no tab lies on another
constexpr double kLeastSize_mm = 15.0;
constexpr double kMostCells = 6e5, kFinest_mm = 0.5;
constexpr double kHalfOpen_rad = 1.9;
constexpr double kCorner_deg = 90.0;
constexpr double kBehind_mm = 12.0;  ///< between the rearmost layer and the wall
constexpr double kLeastStrut_mm = 12.0, kMostStrut_mm = 70.0, kStrutMargin_mm = 2.0;

/// Where the outline seen from the front is most like its mirror image, near the middle: there the
/// fold of the layers cuts no knob or gable in two. Places along y, mm.
double mirror_of(const TriangleSoup& soup, double low, double high) {
  constexpr double kStep_mm = 0.5, kMostCells = 4000.0, kNear = 0.2;
  const double step = std::max(kStep_mm, (high - low) / kMostCells);
  std::vector<double> top(static_cast<std::size_t>(std::ceil((high - low) / step)) + 1, 0.0);
  const auto place = [&](double k) { return low + (k + 0.5) * step; };
  for (std::size_t t = 0; t < soup.size(); ++t)
    for (std::size_t e = 0; e < 3; ++e) {
      Vec3 a = soup.corner(t, e), b = soup.corner(t, (e + 1) % 3);
      if (a.y() > b.y()) std::swap(a, b);
      for (double k = std::max(0.0, std::ceil((a.y() - low) / step - 0.5)); place(k) < b.y(); ++k) {
        const double z = a.z() + (place(k) - a.y()) / (b.y() - a.y()) * (b.z() - a.z());
        double& cell = top[static_cast<std::size_t>(k)];
        cell = std::max(cell, z);
      }
    }
  const auto cells = static_cast<std::ptrdiff_t>(top.size());
  const auto near = static_cast<std::ptrdiff_t>(kNear * static_cast<double>(cells));
  double most = -1.0, best = 0.5 * (low + high);
  // Twice the place, so that the mirror may be a cell or between two; the middle first.
  for (std::ptrdiff_t n = 0; n <= 2 * near; ++n) {
    const std::ptrdiff_t twice = cells - 1 + (n % 2 == 0 ? n / 2 : -(n + 1) / 2);
    double alike = 0.0;
    for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, twice - cells + 1); 2 * k <= twice; ++k)
      alike += std::min(top[static_cast<std::size_t>(k)], top[static_cast<std::size_t>(twice - k)]);
    if (alike > most * (1.0 + 1e-9))
      most = alike, best = low + 0.5 * step * static_cast<double>(twice + 1);
  }
  return best;
}

/// The surface in millimetres, its middle at y = 0, its foot at z = 0, its front at x = 0.
/// `out` gets how it came there.
Result<TriangleSoup> standing_target(const DesignSpec& spec, const SurfaceAssets& assets,
                                     LayeredCard& out) {
  TriangleSoup soup;
  out.placement = spec.placement;
  if (solid_word(*spec.surface)) {
    // Away from wall and ground, which take triangles.
    out.placement.translate_mm = {1e4, 0.0, 1e4};
    const auto surface = Surface::make(*spec.surface, out.placement, FitMode::Nearest, assets);
    if (!surface) return tl::unexpected(surface.error());
    soup = surface->triangles({});
  } else {
    auto target = facet_target(spec, assets);
    if (!target) return tl::unexpected(target.error());
    soup = std::move(target->soup);
  }
  if (soup.size() == 0) return fail(ErrorKind::Infeasible, "/surface", "has no surface");
  Vec3 low = soup.corner(0, 0), high = low;
  for (std::size_t t = 0; t < soup.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      low = low.cwiseMin(soup.corner(t, k)), high = high.cwiseMax(soup.corner(t, k));
  const auto move = [&](const Vec3& origin) {
    out.origin += origin;
    for (std::size_t k = 0; k < soup.corners.size(); ++k)
      soup.corners[k] -= origin[static_cast<Eigen::Index>(k % 3)];
  };
  move({high.x(), 0.0, low.z()});
  move({0.0, mirror_of(soup, low.y(), high.y()), 0.0});
  if (high.y() - low.y() < kLeastSize_mm || high.z() - low.z() < kLeastSize_mm)
    return fail(
        ErrorKind::Infeasible, "/scale_mm",
        fmt::format("makes the shape {:.3g} mm wide and {:.3g} mm high; layers need at least "
                    "{:g} mm: give a larger one",
                    high.y() - low.y(), high.z() - low.z(), kLeastSize_mm));
  return soup;
}

using Outlines = std::vector<std::vector<Vec2>>;

/// A layer before it stands on a card: its halves on the sheet of its V-fold.
struct CutLayer {
  double depth_mm{};
  Outlines left, right;                    ///< as far from the middle, both positive
  double foot_left_mm{}, foot_right_mm{};  ///< of the border on the page, from the middle
  LayerStrut strut;                        ///< of a card that opens to 90 degrees
  LayerChanges changes;

  /// All corners, from the middle.
  [[nodiscard]] std::vector<Vec2> corners() const {
    std::vector<Vec2> out;
    for (const Outlines* half : {&left, &right})
      for (const std::vector<Vec2>& face : *half) out.insert(out.end(), face.begin(), face.end());
    return out;
  }
};

/// Makes room for a strut behind a layer: on its own paper, else on more of it.
LayerStrut strut_of(const LayerGrid& grid, LayerMask& mask, LayerChanges& changes) {
  if (const auto found =
          strut_behind(grid, mask, kLeastStrut_mm, kMostStrut_mm, kTab_mm + 1.0, kStrutMargin_mm))
    return *found;
  double sum = 0.0, count = 0.0;
  for (std::size_t c = 0; c < grid.columns; ++c)
    if (mask[grid.at(c, 0)] != 0) sum += static_cast<double>(c) + 0.5, ++count;
  const double middle =
      (sum / std::max(count, 1.0) - 0.5 * static_cast<double>(grid.columns)) * grid.cell_mm;
  const auto before = std::count(mask.begin(), mask.end(), 1);
  constexpr double kHigh = 0.3;  // of the layer; lower ones let it lean
  const LayerStrut out{middle - 0.5 * kLeastStrut_mm, middle + 0.5 * kLeastStrut_mm,
                       std::max(kTab_mm + 2.0, kHigh * height_of(grid, mask))};
  // From the foot up, so that it hangs on the layer.
  add_strut_paper(grid, out, out.height_mm, kStrutMargin_mm, mask);
  changes.shown_mm2 += static_cast<double>(std::count(mask.begin(), mask.end(), 1) - before) *
                       grid.cell_mm * grid.cell_mm;
  return out;
}

/// The foot of a V-fold, along its crease, that holds a layer within 1 mm where folds are 0.1 mm
/// off: its top moves by about `kMoves_mm` where the foot is as long as the layer is high. Found
/// with verify's wobble.
double firm_foot_mm(double height_mm) {
  constexpr double kMoves_mm = 0.465, kFirm_mm = 0.97, kEnds_mm = 2.0;  // without tabs
  return kMoves_mm / kFirm_mm * height_mm + kEnds_mm;
}

/// People look down on an open card. Folded layers go back on both sides of their fold, or come
/// nearer.
LayerLook look_of(bool opens_flat, bool looks_along_spine) {
  constexpr double kOnPages_rad = radians(40.0), kInCorner_rad = radians(45.0);  // as it is judged
  if (!opens_flat) return {std::tan(kInCorner_rad), 0.0};
  return {std::tan(kOnPages_rad), (looks_along_spine ? 1.0 : -1.0) / std::tan(kCrease_rad)};
}

/// Whether more than a tenth of what looks to the front would be below the page where the paper of
/// the foremost layer goes back from it.
bool front_sinks(const TriangleSoup& target, const LayerLook& look) {
  constexpr double kMost = 0.1;
  double all = 0.0, sunk = 0.0;
  for (std::size_t t = 0; t < target.size(); ++t) {
    const Vec3 a = target.corner(t, 0), b = target.corner(t, 1), c = target.corner(t, 2);
    const Vec3 middle = (1.0 / 3.0) * (a + b + c);
    const double area = std::abs(cross(Vec3(b - a), Vec3(c - a)).x());
    all += area;
    if (middle.z() < look.fall * (look.behind_mm(middle.y()) + middle.x())) sunk += area;
  }
  return sunk > kMost * all;
}

std::vector<CutLayer> cut_layers(const TriangleSoup& target, int count, bool opens_flat,
                                 const LayerLook& look, const Progress& progress, double cell_mm) {
  tell(progress, "choosing the depths of the layers");
  const std::vector<double> depths = layer_depths(target, count, kApart_mm);
  double half_mm = 0.0, high_mm = 0.0;  // of what is seen along the look
  for (std::size_t k = 0; k < target.corners.size(); k += 3) {
    half_mm = std::max(half_mm, std::abs(target.corners[k + 1]));
    high_mm = std::max(high_mm, target.corners[k + 2] - look.fall * target.corners[k]);
  }
  const double widest_mm = firm_foot_mm(high_mm + 2.0 * cell_mm);
  const DepthStacks stacks = depth_stacks(target, look, cell_mm, opens_flat ? widest_mm : 0.0);
  const std::vector<LayerMask> masks = layer_masks(stacks, depths);
  LayerMask hidden(stacks.grid.cells(), 0);
  std::vector<CutLayer> out;
  for (std::size_t j = 0; j < masks.size(); ++j) {
    tell(progress, "cutting the layers");
    LayerMask mask = masks[j];
    LayerPaper paper = opens_flat ? LayerPaper{} : unfolded_paper();
    paper.widest_foot_mm = half_mm + 2.0 * cell_mm;
    if (opens_flat)
      paper.firm_foot_mm = firm_foot_mm(height_of(stacks.grid, mask)) * std::sin(kCrease_rad);
    const auto shown = static_cast<double>(std::count(mask.begin(), mask.end(), 1));
    if (shown * cell_mm * cell_mm < 4.0 * paper.least_mm2) continue;
    CutLayer layer;
    layer.depth_mm = depths[j];
    if (!out.empty() && !opens_flat)
      add_strut_paper(stacks.grid, out.back().strut, kTab_mm + 1.0, 0.7 * kStrutMargin_mm, mask);
    layer.changes = make_one_piece(stacks.grid, hidden, paper, mask);
    if (!opens_flat) layer.strut = strut_of(stacks.grid, mask, layer.changes);
    layer.left = half_outlines(stacks.grid, mask, false);
    layer.right = half_outlines(stacks.grid, mask, true);
    // On the panel lengths along the crease are longer than seen from the front.
    const double longer = opens_flat ? 1.0 / std::sin(kCrease_rad) : 1.0;
    for (Outlines* half : {&layer.left, &layer.right})
      for (std::vector<Vec2>& face : *half)
        for (Vec2& p : face) p.x() *= longer;
    layer.foot_left_mm = longer * foot_mm(stacks.grid, mask, false);
    layer.foot_right_mm = longer * foot_mm(stacks.grid, mask, true);
    for (std::size_t k = 0; k < mask.size(); ++k) hidden[k] |= mask[k];
    out.push_back(std::move(layer));
  }
  return out;
}

/// Where the layers stand along the spine, and the pages that hold them.
struct Standing {
  bool looks_along_spine{};
  std::vector<double> at_mm;
  double page_mm{}, length_mm{};
};

/// Layers fold towards the beginning of the spine. Their front is at its beginning, or at its end.
Standing standing_of(const std::vector<CutLayer>& layers, bool looks_along_spine) {
  Standing out{looks_along_spine, {}, 0.0, 0.0};
  const double s = std::sin(kCrease_rad), c = std::cos(kCrease_rad);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const CutLayer& layer : layers) {
    const double at = looks_along_spine ? layer.depth_mm : -layer.depth_mm;
    out.at_mm.push_back(at);
    low = std::min(low, at - kTab_mm);
    for (const Vec2& p : layer.corners()) {
      const double q = std::abs(p.x()), h = p.y();
      low = std::min(low, at + q * c - h * s), high = std::max(high, at + q * c);
      out.page_mm = std::max({out.page_mm, q * s, q * s + h * c});
    }
  }
  for (double& at : out.at_mm) at += kMargin_mm - low;
  out.page_mm += kMargin_mm;
  out.length_mm = high - low + 2.0 * kMargin_mm;
  return out;
}

/// Where layers stand on the ground of a card that opens to 90 degrees: `at_mm` from its wall.
Standing corner_standing_of(const std::vector<CutLayer>& layers) {
  Standing out{true, {}, 0.0, 0.0};
  double wide = 0.0;
  for (const CutLayer& layer : layers) {
    const double at = kBehind_mm + layers.back().depth_mm - layer.depth_mm;
    out.at_mm.push_back(at);
    for (const Vec2& p : layer.corners()) {
      wide = std::max(wide, std::abs(p.x()));
      out.page_mm = std::max(out.page_mm, at + p.y() + kMargin_mm);  // shut
    }
  }
  out.length_mm = 2.0 * (wide + kMargin_mm);
  return out;
}

/// The lengths that a card of the spec has, or those that are needed.
Result<void> set_pages(const LayersSpec& asked, Standing& standing) {
  const auto check = [](const std::optional<double>& given, double& needed, const char* field,
                        const char* what) -> Result<void> {
    if (!given) return {};
    if (*given < needed)
      return fail(ErrorKind::Infeasible, fmt::format("/layers/{}", field),
                  fmt::format("is {:g}; the layers need {} of at least {:.4g} mm, or a smaller "
                              "scale_mm",
                              *given, what, needed));
    needed = *given;
    return {};
  };
  const double needed = standing.length_mm;
  if (auto done = check(asked.page_mm, standing.page_mm, "page_mm", "pages"); !done) return done;
  if (auto done = check(asked.spine_mm, standing.length_mm, "spine_mm", "a spine"); !done)
    return done;
  if (asked.opens_deg == 180.0)
    for (double& at : standing.at_mm) at += 0.5 * (standing.length_mm - needed);
  return {};
}

/// Whether faces meet in one plane: they are one panel, of several faces because of its holes.
bool is_flat(const PartFold& fold) { return std::abs(fold.angle_rad) < 1e-9; }

/// The folds of a card: stretches that touch in one line are one.
std::vector<double> fold_lengths(const Structure& card) {
  const PartPoses pose = posed(card, kHalfOpen_rad);
  std::vector<double> out;
  for (std::size_t p = 0; p < card.parts.size(); ++p) {
    const SheetPart& part = card.parts[p];
    std::vector<FlatLine> lines;
    for (const PartFold& fold : folds_of(part, pose[p])) {
      if (is_flat(fold) || part.is_slit(fold.from, fold.to)) continue;
      FlatLine line{part.vertices[fold.from], part.vertices[fold.to]};
      for (bool grown = true; grown;) {
        grown = false;
        for (std::size_t k = 0; k < lines.size() && !grown; ++k)
          for (const int mine : {0, 1})
            for (const int other : {0, 1}) {
              const Vec2 a = line[1 - mine], b = line[mine], c = lines[k][1 - other];
              if (grown || norm(Vec2(b - lines[k][other])) > 1e-7 ||
                  std::abs(cross(Vec2(b - a), Vec2(c - b))) > 1e-6)
                continue;
              line = {a, c}, grown = true;
              lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(k));
            }
      }
      lines.push_back(line);
    }
    for (const FlatLine& line : lines) out.push_back(norm(Vec2(line[1] - line[0])));
  }
  return out;
}

/// How many pieces fall out of a part: of paper in one piece, corners less sides and faces are one
/// less its holes.
std::size_t holes_of(const SheetPart& part) {
  std::set<std::uint32_t> corners;
  std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
  for (const auto& face : part.faces)
    for (std::size_t k = 0; k < face.size(); ++k) {
      corners.insert(face[k]);
      sides.insert(std::minmax(face[k], face[(k + 1) % face.size()]));
    }
  return 1 + sides.size() - corners.size() - part.faces.size();
}

/// V-folds, whose layers lie in planes as their pages lie flat.
Result<void> add_folded_layers(const std::vector<CutLayer>& layers, const Standing& standing,
                               Structure& card) {
  // Seen against the spine's direction, right is where u falls.
  const bool is_mirrored = !standing.looks_along_spine;
  for (std::size_t j = 0; j < layers.size(); ++j) {
    const CutLayer& layer = layers[j];
    VFoldElement fold;
    fold.name = fmt::format("layer-{}", j + 1);
    fold.at_mm = standing.at_mm[j];
    fold.left_crease_rad = fold.right_crease_rad = kCrease_rad;
    fold.left_panel_rad = fold.right_panel_rad = panel_of_tilt(kCrease_rad, 0.5 * std::numbers::pi);
    fold.left_outlines = is_mirrored ? layer.right : layer.left;
    fold.right_outlines = is_mirrored ? layer.left : layer.right;
    for (std::vector<Vec2>& face : fold.left_outlines)
      for (Vec2& p : face) p.x() = -p.x();
    constexpr double kClear_mm = 1.0;
    const double left = is_mirrored ? layer.foot_right_mm : layer.foot_left_mm,
                 right = is_mirrored ? layer.foot_left_mm : layer.foot_right_mm;
    fold.left_tabs = {{kClear_mm, left - kClear_mm}};
    fold.right_tabs = {{kClear_mm, right - kClear_mm}};
    if (auto done = add(card, spine_of(card), fold); !done) return done;
    if (is_mirrored) turn_over(card, card.parts.size() - 1);  // its front is printed
  }
  return {};
}

/// Layers that stay parallel to the wall.
Result<void> add_upright_layers(const std::vector<CutLayer>& layers, const Standing& standing,
                                Structure& card) {
  std::vector<CornerLayer> upright;
  for (std::size_t j = 0; j < layers.size(); ++j) {
    const CutLayer& layer = layers[j];
    constexpr double kClear_mm = 1.0;
    CornerLayer one;
    one.name = fmt::format("layer-{}", j + 1);
    for (std::vector<Vec2> face : layer.left) {
      for (Vec2& p : face) p.x() = -p.x();
      one.outlines.push_back(std::move(face));
    }
    one.outlines.insert(one.outlines.end(), layer.right.begin(), layer.right.end());
    one.foot_from_mm = kClear_mm - layer.foot_left_mm;
    one.foot_to_mm = layer.foot_right_mm - kClear_mm;
    if (layer.left.empty()) one.foot_from_mm = kClear_mm;
    if (layer.right.empty()) one.foot_to_mm = -kClear_mm;
    one.out_mm = standing.at_mm[j];
    one.strut = layer.strut;
    upright.push_back(std::move(one));
  }
  add_corner_layers(card, upright);
  return shuts_inside(card, 1);
}

void warn(const std::vector<CutLayer>& layers, int asked, LayeredCard& out) {
  std::size_t dropped = 0, filled = 0;
  double shown = 0.0;
  for (const CutLayer& layer : layers) {
    dropped += layer.changes.dropped, filled += layer.changes.filled;
    shown += layer.changes.shown_mm2;
  }
  if (layers.size() < static_cast<std::size_t>(asked))
    out.warnings.push_back(
        {.code = "fewer_layers",
         .message = fmt::format("the card has {} layer{}, not {}: the shape is not deep enough for "
                                "more, which must be {:g} mm apart for their tabs",
                                layers.size(), layers.size() == 1 ? "" : "s", asked, kApart_mm)});
  if (filled > 0)
    out.warnings.push_back(
        {.code = "holes_filled",
         .message = filled == 1
                        ? "1 small hole in a layer is filled with paper"
                        : fmt::format("{} small holes in layers are filled with paper", filled)});
  if (dropped > 0)
    out.warnings.push_back(
        {.code = "parts_dropped",
         .message = dropped == 1
                        ? "1 part of a layer is too small to cut and is left out"
                        : fmt::format("{} parts of layers are too small to cut and are left out",
                                      dropped)});
  if (shown > 25.0)
    out.warnings.push_back(
        {.code = "bridges_shown",
         .message =
             fmt::format("{:.0f} mm2 of paper that joins parts of layers can be seen from the "
                         "front; fewer layers may need less",
                         shown)});
}

}  // namespace

Result<LayeredCard> layered_card(const DesignSpec& spec, const SurfaceAssets& assets,
                                 const Progress& progress) {
  tell(progress, "reading the shape");
  LayeredCard out;
  auto target = standing_target(spec, assets, out);
  if (!target) return tl::unexpected(target.error());
  out.opens_flat = spec.layers.opens_deg == 180.0;
  const double fall = look_of(out.opens_flat, true).fall;
  double width = 0.0, height = 0.0;
  for (std::size_t k = 0; k < target->corners.size(); k += 3) {
    width = std::max(width, 2.0 * std::abs(target->corners[k + 1]));
    height = std::max(height, target->corners[k + 2] - fall * target->corners[k]);
  }
  const double cell_mm = std::max(kFinest_mm, std::sqrt(width * height / kMostCells));
  const auto cut = [&](bool looks_along_spine) {
    out.look = look_of(out.opens_flat, looks_along_spine);
    out.look.lifts_front = front_sinks(*target, out.look);
    return cut_layers(*target, spec.layers.layers, out.opens_flat, out.look, progress, cell_mm);
  };
  std::vector<CutLayer> layers = cut(true);
  if (layers.empty())
    return fail(ErrorKind::Infeasible, "/layers",
                "no layer is large enough to cut; use a larger "
                "scale_mm");
  Standing standing = out.opens_flat ? standing_of(layers, true) : corner_standing_of(layers);
  if (out.opens_flat) {
    const LayerLook look = out.look;
    std::vector<CutLayer> turned = cut(false);
    if (Standing other = standing_of(turned, false); other.length_mm < standing.length_mm)
      standing = std::move(other), layers = std::move(turned);
    else
      out.look = look;
  }
  if (auto done = set_pages(spec.layers, standing); !done) return tl::unexpected(done.error());

  out.looks_along_spine = standing.looks_along_spine;
  out.card = plain_card(standing.page_mm, standing.length_mm);
  out.card.name = spec.name;
  out.card.tab_mm = kTab_mm;
  out.card.opens_deg = spec.layers.opens_deg;
  for (std::size_t j = 0; j < layers.size(); ++j) {
    double high = 0.0, wide = 0.0;
    for (const Vec2& p : layers[j].corners())
      high = std::max(high, p.y()), wide = std::max(wide, 2.0 * std::abs(p.x()));
    out.layers.push_back({layers[j].depth_mm, standing.at_mm[j], high, wide, layers[j].changes});
  }
  if (auto done = out.opens_flat ? add_folded_layers(layers, standing, out.card)
                                 : add_upright_layers(layers, standing, out.card);
      !done)
    return tl::unexpected(within("/layers", done.error()));
  const double along = standing.looks_along_spine ? 1.0 : -1.0;
  if (out.opens_flat) out.begin_mm = standing.at_mm.front() - along * layers.front().depth_mm;
  move_to_card(out, target->corners);
  out.target = std::move(*target);
  PartsWork work = parts_work(out.card);
  out.folds = work.folds, out.tabs = work.tabs, out.handwork = std::move(work.handwork);
  warn(layers, spec.layers.layers, out);
  return out;
}

PartPoses pose_at(const LayeredCard& made, double opening_rad) {
  PartPoses out = posed(made.card, opening_rad);
  Eigen::Isometry3d turn = Eigen::Isometry3d::Identity();
  if (made.opens_flat) {
    const double level = 0.5 * (std::numbers::pi - opening_rad);
    turn.linear() = Eigen::AngleAxisd(-level, Vec3{0.0, 1.0, 0.0}).toRotationMatrix();
  } else {
    // From the ground's direction and along the spine to the right and away from who looks.
    turn.linear() =
        Eigen::AngleAxisd(-0.5 * std::numbers::pi, Vec3{0.0, 0.0, 1.0}).toRotationMatrix();
    turn.translation() = Vec3{-0.5 * made.card.length_mm,
                              made.layers.front().at_mm + made.layers.front().depth_mm, 0.0};
  }
  for (auto& part : out)
    for (Eigen::Isometry3d& face : part) face = turn * face;
  return out;
}

PartPoses open_pose(const LayeredCard& made) {
  constexpr double kOpen_rad = radians(179.99);  // closed forms end before 180 degrees
  return pose_at(made, made.opens_flat ? kOpen_rad : radians(kCorner_deg));
}

void move_to_card(const LayeredCard& made, std::vector<double>& corners) {
  const double along = made.looks_along_spine ? 1.0 : -1.0;
  for (std::size_t k = 0; k + 2 < corners.size(); k += 3) {
    const double depth = -corners[k], right = corners[k + 1];
    corners[k] = along * right, corners[k + 1] = made.begin_mm + along * depth;
  }
}

std::vector<Pattern> part_drawings(const Structure& card) {
  std::vector<Pattern> out;
  const PartPoses pose = posed(card, kHalfOpen_rad);
  for (std::size_t p = 0; p < card.parts.size(); ++p) {
    const SheetPart& part = card.parts[p];
    Pattern one;
    one.name = part.name;
    one.card = false;
    Eigen::AlignedBox2d box;
    for (const Vec2& at : part.vertices) box.extend(at);
    one.wall_mm = box.sizes().y(), one.width_mm = box.sizes().x();
    // Heights run up the page, so that a layer stands upright on it.
    const auto add_line = [&](std::uint32_t a, std::uint32_t b, EdgeRole role) {
      const Vec2 from = part.vertices[a], to = part.vertices[b];
      one.lines.push_back({box.max().y() - from.y(), from.x() - box.min().x(),
                           box.max().y() - to.y(), to.x() - box.min().x(), role});
    };
    std::vector<std::pair<std::uint32_t, std::uint32_t>> inner;
    for (const PartFold& fold : folds_of(part, pose[p])) {
      inner.emplace_back(std::minmax(fold.from, fold.to));
      if (is_flat(fold)) continue;
      add_line(fold.from, fold.to,
               part.is_slit(fold.from, fold.to) ? EdgeRole::Slit
               : fold.angle_rad > 0.0           ? EdgeRole::Valley
                                                : EdgeRole::Mountain);
    }
    std::sort(inner.begin(), inner.end());
    for (const auto& face : part.faces)
      for (std::size_t k = 0; k < face.size(); ++k) {
        const std::uint32_t a = face[k], b = face[(k + 1) % face.size()];
        if (!std::binary_search(inner.begin(), inner.end(),
                                std::pair<std::uint32_t, std::uint32_t>(std::minmax(a, b))))
          add_line(a, b, EdgeRole::Outline);
      }
    out.push_back(std::move(one));
  }
  return out;
}

Pattern parts_drawing(const Structure& card) {
  constexpr double kGap_mm = 10.0, kWidest_mm = 600.0;
  Pattern out;
  out.name = card.name;
  out.card = false;
  double u = 0.0, v = 0.0, row = 0.0;
  for (const Pattern& part : part_drawings(card)) {
    if (v > 0.0 && v + part.width_mm > kWidest_mm) u += row + kGap_mm, v = row = 0.0;
    for (SheetLine line : part.lines) {
      line.u0 += u, line.u1 += u, line.v0 += v, line.v1 += v;
      out.lines.push_back(line);
    }
    out.width_mm = std::max(out.width_mm, v + part.width_mm);
    row = std::max(row, part.wall_mm);
    v += part.width_mm + kGap_mm;
  }
  out.wall_mm = u + row;
  return out;
}

PartsWork parts_work(const Structure& card) {
  const std::vector<double> folds = fold_lengths(card);
  std::size_t waste = 0;
  for (const SheetPart& part : card.parts) waste += holes_of(part);
  return {folds.size(), card.joints.size(), hands::handwork(folds, waste, card.joints.size())};
}

TriangleSoup faces_in_space(const Structure& card, const PartPoses& pose) {
  TriangleSoup out;
  for (std::size_t p = 0; p < card.parts.size(); ++p) {
    const SheetPart& part = card.parts[p];
    for (std::size_t f = 0; f < part.faces.size(); ++f) {
      std::vector<Triangle> triangles;
      if (!triangulate(part.vertices, part.faces[f], triangles)) continue;
      const auto at = [&](std::uint32_t v) {
        return Vec3(pose[p][f] * Vec3{part.vertices[v].x(), part.vertices[v].y(), 0.0});
      };
      for (const auto& [a, b, c] : triangles) out.add(at(a), at(b), at(c));
    }
  }
  return out;
}

}  // namespace popcut
