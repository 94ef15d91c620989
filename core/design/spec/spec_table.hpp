// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/design/spec/spec.hpp"
#include "core/text/field_table.hpp"

/// The one table of a spec's fields. A new field is a row in spec_table.cpp and a member to read it
/// into: the parser, the JSON Schema and the errors follow from the row.
namespace popcut {

/// Widths of slices as they are written: one for all, one for each, or chosen from the curvature.
struct WidthFields {
  std::optional<double> all_mm;
  std::optional<std::vector<double>> each_mm;
  std::optional<AdaptiveWidths> adaptive;
};

struct RegionFields : RegionSpec {
  WidthFields widths;
};

struct WeightFields {
  std::optional<double> K, H, first, second;
};

/// A spec as it is written: what `DesignSpec` holds in another form stands here.
struct SpecFields : DesignSpec {
  int version{1};
  std::vector<RegionFields> region_fields;
  std::optional<int> units_per_slice, slices;
  WidthFields widths;
  std::optional<double> given_min_panel_mm, given_ligament_mm, given_from_mm;
  WeightFields weights;
  std::vector<nlohmann::json> patch_fields;
  std::optional<PatchJoin> join_of_all;  ///< else `joins` has one for each border, or "auto" holds
};

/// The rows of a spec, in five parts. A spec is its whole, its name, what is shared and either one
/// design or several patches; a patch is a name, what is shared and a design.
struct SpecTables {
  FieldTable whole;    ///< "popcut", "material", "pen", "sheet", "design_angle_deg", "book"
  FieldTable name;     ///< "name"
  FieldTable shared;   ///< of a design; beside patches, what holds for those that have none
  FieldTable design;   ///< of one design only
  FieldTable patches;  ///< "patches" and how they are joined
};
/// The tables, bound to `spec`.
[[nodiscard]] SpecTables spec_tables(SpecFields& spec);

inline constexpr double kMaxLength = 1e5;  ///< 100 m: no sheet is larger

}  // namespace popcut
