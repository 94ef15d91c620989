// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/design/book_report.hpp"
#include "core/design/design.hpp"

namespace popcut {

/// One patch of an assembly: where it came to lie.
struct PatchReport {
  std::string name;
  std::size_t part{};  ///< index of the pattern that it is in
  int first_slice{};   ///< its slices, in the numbering of that pattern
  int slices{};
  double v_begin_mm{}, v_end_mm{};  ///< along the spine of the whole, outer margins too
};

/// The border between a patch and the next one.
struct JoinReport {
  std::size_t left{};      ///< the patch before
  bool is_seam{};          ///< glued; else both are in one sheet
  std::string reason;      ///< why it is a seam, or how the sheet goes on
  double misfit_mm{};      ///< largest distance between the profiles of the two edges
  SectionPoint misfit_at;  ///< where, mm
  double v_mm{};           ///< of the border in the whole
  double seam_mm{};        ///< length to glue; 0 in one sheet
};

/// Designs that belong together: patches joined along the spine, in as few patterns as they allow.
struct PatchAssembly {
  std::string name;
  std::vector<Design> parts;         ///< each a pattern that stands and folds on its own
  std::vector<PatchReport> patches;  ///< none where the spec is one design
  std::vector<JoinReport> joins;     ///< one between neighbouring patches
  double u_mm{}, v_mm{};             ///< extent of the whole, put together and flat
  std::optional<BookReport> book;    ///< the parts are the cards of a book
};

/// Designs a spec with patches, a book (`design_book`), or one card: that is one part.
///
/// Each patch is designed on its own. Patches that ask for no wall or ground of their own all get
/// the same. Neighbours with the same wall and ground become one sheet: the margins between them
/// go, the outer slices stand beside each other, and a bridge (`add_bridges`) or a plain cut lies
/// between. Others, and where a seam is asked for, stay patterns with a declared seam
/// (`Pattern::seams`) along the margins. The fit of two edges is the largest distance between the
/// target profiles of both patches there, half a width beyond their outer slices.
///
/// @retval Infeasible  a misfit above `join_tolerance_mm` (place is the patch), or one sheet was
///                     asked for and walls or grounds differ; else as `design`, in a patch after
///                     `/patches/K`
[[nodiscard]] Result<PatchAssembly> design_assembly(const DesignSpec& spec,
                                                    const SurfaceAssets& assets = {},
                                                    const Progress& progress = {});

}  // namespace popcut
