// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

#include "core/design/patches.hpp"

namespace popcut {

/// The text of `report.json`: the fields of the report by their names in the manual, each with its
/// unit in the name, in a fixed order. `units_per_slice` is a number, or a list if regions differ.
/// A figure that is not finite is null.
[[nodiscard]] std::string report_json(const DesignReport& report);

/// The report of an assembly. A single design is reported as above. Patches add `patches` (name,
/// part, slices, v_mm from and to in the whole), `joins` (the two patches, counted from 0; sheet or
/// seam, and why; the misfit of their profiles and where it is) and `seams` (the line on both
/// parts). If there are several parts, counted from 1, `parts` has the report, folder and place of
/// each. A book (`book.json`) has its own figures, which faces are glued, and `card` with the
/// report and folder of each card, counted from 1.
[[nodiscard]] std::string report_json(const PatchAssembly& assembly);

/// The folder of part number `part` (from 0) inside the folder of the whole: "part-01", of a book
/// "card-01".
[[nodiscard]] std::string part_folder(const PatchAssembly& assembly, std::size_t part);

}  // namespace popcut
