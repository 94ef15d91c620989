// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/design/target/surface_spec.hpp"
#include "core/result.hpp"

namespace popcut {

/// A stretch of slices with units of its own, and perhaps a radius of its own: of y from 0 at the
/// region's start to L at its end.
struct RegionSpec {
  int units_per_slice{};
  int slices{};
  std::optional<FormulaOrPoints> radius{};
};

/// Widths chosen from the target's curvature (`"widths_mm": {"max_error_mm": ...}`).
struct AdaptiveWidths {
  double max_error_mm{};
  std::optional<double> length_mm{};  ///< of the whole; none: as far as `slices` reach
};

/// What the surface through the fold vertices shall do at one opening angle: have an angle defect,
/// or a sign of it that is at least `margin_rad` away from zero.
struct CurvatureTarget {
  double psi_rad{};
  std::optional<double> K_rad{};
  int sign{0};  ///< +1 or -1 where K_rad is absent
  double margin_rad{0.05};
};

/// V-folds on the connectors' valley creases (docs/geometry.md, section 7).
struct SplaySpec {
  std::optional<double> uniform{};         ///< one alpha for all creases
  std::vector<std::vector<double>> alpha;  ///< else inner levels x connectors, 0 for no V-fold
  std::vector<CurvatureTarget> targets;    ///< else solved for the middle vertex
  std::optional<double> length_mm{};       ///< w; none: as long as the connector allows
  double ligament_mm{0.5};                 ///< paper left beside V-folds
  bool ligament_asked{false};              ///< the spec gives it
};

/// `curvature` of a spec: what the surface through the chains' vertices is to be, for the augmented
/// loss of S4. A list is empty (not asked for), or has one value for all, or has one for each inner
/// vertex: levels 1 .. N - 1 of each slice that has slices on both sides, slice by slice.
struct AugmentedSpec {
  std::vector<double> K_area;                 ///< Gaussian curvature, 1/mm^2
  std::vector<double> H;                      ///< mean curvature, 1/mm, > 0 where convex
  std::vector<std::array<double, 3>> first;   ///< a_ss, a_st, a_tt of (level, slice), mm^2
  std::vector<std::array<double, 3>> second;  ///< b_ss, b_st, b_tt, mm
  double weight_K{}, weight_H{}, weight_first{}, weight_second{};  ///< 0 where not asked for
};

/// What a structure is made of.
enum class DesignStyle {
  Lattice,     ///< slices of falling staircases, paired level by level
  Facets,      ///< origamic architecture: each point of the sheet lies in a plane of its own choice
  Silhouette,  ///< facets in a few upright planes with the target's outline, on struts
  Layers,      ///< several parts: upright layers on a card that opens flat
  Slices,      ///< several parts: two families of crossing slices on a card that opens flat
  Boxes        ///< several parts: boxes with roofs in a row on a card that opens flat
};
[[nodiscard]] constexpr bool is_of_facets(DesignStyle style) {
  return style == DesignStyle::Facets || style == DesignStyle::Silhouette;
}

/// What a card of several parts is made of, as a spec names it; null: it is of one sheet.
[[nodiscard]] constexpr const char* parts_word(DesignStyle style) {
  if (style == DesignStyle::Layers) return "layers";
  if (style == DesignStyle::Slices) return "slices";
  return style == DesignStyle::Boxes ? "boxes" : nullptr;
}

/// Whether it is a card of several parts that opens flat.
[[nodiscard]] constexpr bool is_of_parts(DesignStyle style) { return parts_word(style) != nullptr; }

/// How facets follow the curved parts of a target.
enum class CurvedParts {
  Lattice,  ///< panels of neighbouring strips hold each other as in a lattice, in fitted planes
  Facets    ///< as the planar parts
};

/// What holds a panel of facets: folds at any two different places, or so far apart that it holds
/// in paper too.
enum class FacetHold { Exact, Paper };

/// What becomes of sloped planes of a target, such as roofs.
enum class SlopedParts {
  None,   ///< as of all others: panels parallel to wall or ground
  Kites,  ///< sloped panels of the same sheet, where they can be
  Tents   ///< sloped panels of their own paper, glued on the sheet, where they can be
};

/// How a target is made of facets (`"facets"` or `"silhouette"` of a spec, docs/facets.md).
struct FacetSpec {
  double pitch_mm{2.0};               ///< between the planes that are tried
  double strip_mm{2.0};               ///< width of a strip along the spine
  double from_mm{0.0};                ///< where it begins along the spine
  bool from_given{false};             ///< the spec gives it
  std::optional<double> length_mm{};  ///< along the spine; none: all of a mesh or a grid
  double fold_cost_mm2{1.0}, jump_cost_mm2{4.0}, cut_cost_mm2{1.0};  ///< of a line, by length
  double hinge_cost_mm3{0.0};                                        ///< of a fold, however long
  CurvedParts curved{CurvedParts::Lattice};
  bool inward{false};  ///< parts behind wall and ground are made too
  FacetHold hold{FacetHold::Paper};
  SlopedParts sloped{SlopedParts::None};
  int layers{2};            ///< of a silhouette
  double min_fold_mm{8.0};  ///< of a silhouette: no strut is narrower, and none stands on less
  double widen_to_mm{0.0};  ///< of facets (`min_fold_mm`): shorter folds are made longer
  int most_folds{0};        ///< of facets; 0: as many as come
  /// Not a field of a spec. A search sets it: fewer rounds, to compare many designs quickly.
  bool rough{false};
};

/// How a target is made of layers (`"layers"` of a spec, docs/parts.md).
struct LayersSpec {
  int layers{5};
  double opens_deg{180.0};           ///< or 90
  std::optional<double> page_mm{};   ///< from the spine outward; none: as the layers need
  std::optional<double> spine_mm{};  ///< length of the spine; none: as the layers need
};

/// How a target is made of crossing slices (`"sliceform"` of a spec, docs/parts.md).
struct SlicesSpec {
  int x_slices{7}, y_slices{7};      ///< across the target's x axis and its y axis
  double frame_deg{45.0};            ///< between the spine and both families, on open pages
  double paper_mm{0.3};              ///< thickness
  double looseness{1.5};             ///< of slots: their width over what paper needs on open pages
  double base_mm{12.0};              ///< height of the strips that the target stands on
  std::optional<double> page_mm{};   ///< from the spine outward; none: as the slices need
  std::optional<double> spine_mm{};  ///< length of the spine; none: as the slices need
};

/// How a target is made of boxes (`"boxes"` of a spec, docs/parts.md).
struct BoxesSpec {
  int most{4};                       ///< boxes and tents
  std::optional<double> page_mm{};   ///< from the spine outward; none: as the boxes need
  std::optional<double> spine_mm{};  ///< length of the spine; none: as the boxes need
};

/// `Auto`: the one of the others that comes nearest to the target.
enum class LatticeMethod { Branching, Slices, Conformal, Levels, Direct, Auto };
inline constexpr std::array kLatticeNames{"branching", "slices", "conformal",
                                          "levels",    "direct", "auto"};
/// How a spec calls it.
[[nodiscard]] constexpr const char* name_of(LatticeMethod method) {
  return kLatticeNames[static_cast<std::size_t>(method)];
}
enum class SolverMethod { Newton, Slsqp };

/// Where the structure lies when the card is shut.
enum class CardShut {
  Inside,  ///< inside the card: measures that are left out are large enough for it
  Free     ///< it may stick out
};

/// Wall, ground and margins around the lattice; absent measures are chosen by the design.
struct CardSpec {
  std::optional<double> wall_mm;    ///< H, default the largest wall end + 15, and as `shut` asks
  std::optional<double> ground_mm;  ///< D, default the largest ground end + 15, and as `shut` asks
  double margin_mm{15.0};           ///< beside the strips, and around the shut structure
  CardShut shut{CardShut::Inside};
};

/// What the pattern is to be cut from (`"sheet"` of a spec).
struct SheetSpec {
  std::string name;  ///< "A3"; empty: given in mm
  double width_mm{}, height_mm{};
};

/// How neighbouring patches are joined along their common edge.
enum class PatchJoin {
  Auto,   ///< one sheet where wall and ground agree, else a seam
  Sheet,  ///< one sheet, or an error
  Seam    ///< patterns of their own that are glued
};

inline constexpr int kMostLayers = 9, kLeastCardLayers = 3;
inline constexpr int kLeastSlices = 2, kMostCrossedSlices = 60;
inline constexpr int kMostBoxes = 9;
inline constexpr int kLeastCards = 3, kMostCards = 12;

/// A book (`"book"` of a spec): cards around one spine, glued back to back, that show the target
/// from all sides. Each is a design with the angle `angle_deg()`.
struct BookSpec {
  int cards{};
  bool is_turned{};  ///< the spec gives rotate_deg
  bool is_moved{};   ///< the spec gives translate_mm

  /// The opening angle of each card when the book is open all around.
  [[nodiscard]] double angle_deg() const { return 360.0 / cards; }
};

/// What a user asks for, checked for type and range but not yet for feasibility.
struct DesignSpec {
  std::string name{"pattern"};
  std::optional<SurfaceSpec> surface;  ///< none where each region has a radius of its own
  TargetPlacement placement;
  FitMode fit{FitMode::Exact};
  DesignStyle style{DesignStyle::Lattice};
  FacetSpec facets;                 ///< of facets and silhouettes only
  LayersSpec layers;                ///< of layers only
  SlicesSpec sliced;                ///< of crossing slices only
  BoxesSpec boxes;                  ///< of boxes only
  std::vector<RegionSpec> regions;  ///< one where the spec has none: the whole; none of facets
  /// R1, R2 and R3 of a composite surface; `regions` have its formulas.
  std::optional<std::array<double, 3>> composite_radii;
  std::vector<double> widths_mm;  ///< one for each slice; empty with `adaptive`
  std::optional<AdaptiveWidths> adaptive;
  LatticeMethod lattice{LatticeMethod::Auto};
  SolverMethod solver{SolverMethod::Newton};
  std::optional<SplaySpec> splay;
  std::optional<AugmentedSpec> curvature;
  std::optional<CardSpec> card{CardSpec{}};  ///< none: `"card": false`
  double min_panel_mm{0.5};
  bool min_panel_asked{false};  ///< false: the caller may raise it to suit the material
  /// Largest step of a conformal lattice over the mean one; none: no limit. Where the user did not
  /// ask for it, up to `kRelaxedStep` is taken when that puts every vertex on the target.
  std::optional<double> max_step_over_mean{3.0};
  bool max_step_asked{false};
  std::string material{"paper-220"};
  std::string pens;  ///< settings in place of the material's, for who plans the pattern
  std::optional<SheetSpec> sheet;
  std::optional<BookSpec> book;  ///< none: one card

  /// Designs that are joined one after another along the spine, in place of all above but `name`
  /// and `material`; none: this is one design.
  std::vector<DesignSpec> patches;
  std::vector<PatchJoin> joins;   ///< one between neighbouring patches
  double join_tolerance_mm{1.0};  ///< largest distance of the edges' profiles
  bool is_patch{false};           ///< one of `patches`: its edges are wanted too
  bool is_card{false};            ///< one of a book: it may have nothing of the target
  /// Not a field of a spec. Who draws it while a hand moves a slider sets it: how far panels move
  /// in paper is not computed.
  bool is_draft{false};
};

/// Whether roofs are glued on its facets.
[[nodiscard]] inline bool has_tents(const DesignSpec& spec) {
  return spec.style == DesignStyle::Facets && spec.facets.sloped == SlopedParts::Tents;
}
/// Whether it is designed as a `BoxedCard`.
[[nodiscard]] inline bool is_of_boxes(const DesignSpec& spec) {
  return spec.style == DesignStyle::Boxes || has_tents(spec);
}
/// What a card of several parts is made of; null: it is of one sheet.
[[nodiscard]] inline const char* parts_word(const DesignSpec& spec) {
  return has_tents(spec) ? "facets with glued roofs" : parts_word(spec.style);
}
[[nodiscard]] inline bool is_of_parts(const DesignSpec& spec) {
  return parts_word(spec) != nullptr;
}

inline constexpr double kRelaxedStep = 5.0;
inline constexpr int kMaxUnitsPerSlice = 2000;
inline constexpr int kMaxSlices = 20000;
inline constexpr std::int64_t kMaxUnits = 2'000'000;  ///< units per slice times slices

/// Reads a design spec from JSON text. Unknown fields, wrong types and values out of range are
/// errors with a JSON pointer as place; text that is not JSON one with line and column.
///
/// @retval Malformed   not JSON, an unknown field, a wrong type
/// @retval OutOfRange  a value that is not valid (negative width, N = 0, 10^9 slices)
[[nodiscard]] Result<DesignSpec> parse_design_spec(std::string_view json_text);

/// The JSON Schema (draft 2020-12) of a design spec, as `popcut design --schema` prints it.
[[nodiscard]] std::string design_spec_schema();

}  // namespace popcut
