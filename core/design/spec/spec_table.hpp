// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/design/spec/spec.hpp"
#include "core/text/field_table.hpp"

/// The one table of a spec's fields. A new field is a row in spec_table.cpp and a member to read it
/// into: the parser, the JSON Schema and the errors follow from the row.
namespace popcut {

/// Three regions whose radius runs R1 -> R2 -> R3 -> R2 (S2.F of the paper).
struct CompositeSpec {
  std::array<double, 3> radii{};
};

using FixedWidths = std::variant<double, std::vector<double>>;
using WidthsField = std::variant<double, std::vector<double>, AdaptiveWidths>;
using SurfaceField = std::variant<RevolutionSpec, ProfileSpec, ImplicitSpec, GridSpec, MeshSpec,
                                  LoftSpec, TextSpec, OutlineSpec, CompositeSpec>;
using JoinField = std::variant<PatchJoin, std::vector<PatchJoin>>;
using AlphaField = std::variant<double, std::vector<std::vector<double>>>;

struct RegionFields : RegionSpec {
  std::optional<double> width_mm;
  std::optional<FixedWidths> widths_mm;
};

struct TargetFields : CurvatureTarget {
  std::optional<nlohmann::json> sign_text;
};

struct SplayFields : SplaySpec {
  std::optional<AlphaField> alpha_field;
  std::optional<std::vector<TargetFields>> target_fields;
  std::optional<double> given_ligament_mm;
};

struct WeightFields {
  std::optional<double> K, H, first, second;
};

struct CurvatureFields : AugmentedSpec {
  std::optional<WeightFields> weights;
};

struct FacetFields : FacetSpec {
  std::optional<double> given_from_mm;
};

/// A spec as it is written: what `DesignSpec` holds in another form stands here.
struct SpecFields : DesignSpec {
  int version{1};
  std::optional<SurfaceField> surface_field;
  std::optional<std::vector<RegionFields>> region_fields;
  std::optional<int> units_per_slice, slices;
  std::optional<double> given_min_panel_mm;
  std::optional<WidthsField> widths_field;
  std::optional<SplayFields> splay_fields;
  std::optional<CurvatureFields> curvature_fields;
  std::optional<FacetFields> facet_fields;
  std::vector<nlohmann::json> patch_fields;
  JoinField join_field{PatchJoin::Auto};
};

using SpecTable = FieldTable<SpecFields>;

/// The rows of a spec, in four parts. A spec is its whole, its name, what is shared and either one
/// design or several patches; a patch is a name, what is shared and a design.
struct SpecTables {
  SpecTable whole;    ///< "popcut", "material", "pen", "sheet", "design_angle_deg"
  SpecTable name;     ///< "name"
  SpecTable shared;   ///< of a design; beside patches, what holds for those that have none
  SpecTable design;   ///< of one design only
  SpecTable patches;  ///< "patches" and how they are joined
};
[[nodiscard]] const SpecTables& spec_tables();

inline constexpr double kMaxLength = 1e5;  ///< 100 m: no sheet is larger

}  // namespace popcut
