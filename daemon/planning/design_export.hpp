// SPDX-License-Identifier: MIT
#pragma once

#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "core/design/patches.hpp"
#include "core/drawing/linework.hpp"
#include "core/fit/triangle_soup.hpp"
#include "core/formats/fold/fold_writer.hpp"
#include "core/machines/machine.hpp"
#include "core/picture/deployed_svg.hpp"
#include "core/result.hpp"
#include "daemon/planning/views/parts_card.hpp"

namespace popcut::planning {

/// The target, where it stands around the opened pattern; empty where no picture is wanted.
struct Scenery {
  TriangleSoup ghost;   ///< coarse
  TriangleSoup target;  ///< as fine as it is measured; only where errors are coloured

  [[nodiscard]] SceneOptions scene(std::size_t most_panels) const {
    return target.size() > 0 ? SceneOptions{nullptr, &target, most_panels}
                             : SceneOptions{&ghost, nullptr, most_panels};
  }
};
/// Panels that pictures draw; of more, strips and steps are drawn wider.
inline constexpr std::size_t kMostPanels = 12'000, kMostPanelsOfPoster = 4'000;

/// What the writers of a design's files need beside it.
struct ExportJob {
  const Design& made;
  const PatchAssembly* whole;  ///< none where the design is one part of several
  const LineWork& dashed;      ///< the page with each fold as its dashes
  FoldOptions fold;
  std::vector<double> psi_rad;  ///< of the meshes
  double thickness_mm{};        ///< of the meshes; 0: one surface
  const Scenery& scenery;
};

// The texts of the files that `popcut design` and popcutd write, the same in both.

[[nodiscard]] Result<void> write_fold_file(const ExportJob& job, std::ostream& out);
[[nodiscard]] Result<void> write_svg_file(const ExportJob& job, std::ostream& out);
[[nodiscard]] Result<void> write_cut_file(const ExportJob& job, std::ostream& out);
[[nodiscard]] Result<void> write_dxf_file(const ExportJob& job, std::ostream& out);
[[nodiscard]] Result<void> write_csv_file(const ExportJob& job, std::ostream& out);
[[nodiscard]] Result<void> write_deployed_file(const ExportJob& job, std::ostream& out);
[[nodiscard]] Result<void> write_poster_file(const ExportJob& job, std::ostream& out);
[[nodiscard]] Result<void> write_report_file(const ExportJob& job, std::ostream& out);
/// The animation of its opening.
[[nodiscard]] Result<void> write_glb_file(const ExportJob& job, std::ostream& out);
/// The opened card: the last STL file of `popcut design --formats stl`.
[[nodiscard]] Result<void> write_stl_file(const ExportJob& job, std::ostream& out);

/// What the header of an STL file of a pose says.
[[nodiscard]] std::string stl_title(const Pattern& pattern, double psi_rad);

/// `count` opening angles on the way from the first to the last; shut ones are moved to where a
/// picture can be drawn.
[[nodiscard]] std::vector<double> drawn_angles(const std::vector<double>& psi_rad,
                                               std::size_t count);

/// The page of a design with each fold as its dashes; folds without room for any are named in its
/// report.
[[nodiscard]] LineWork dashed_page(const Material& material, Design& made);

/// The dashes of all folds of such a page (x = v, y = u), back on the sheet.
[[nodiscard]] std::vector<SheetLine> micro_cuts(const LineWork& dashed);

/// One file of a designed spec ("pattern.fold", "cut.svg", ...), with the usual options of
/// `popcut design`.
///
/// @param part  from 0
/// @retval OutOfRange  there is no such file ("/file") or part ("/part")
[[nodiscard]] Result<std::string> design_file(PatchAssembly& made, const Material& material,
                                              std::string_view file, std::size_t part);

/// One file of a card of several parts, as `popcut design` and `popcut fold-guide` write it:
/// "pattern.fold", "pattern.svg", "cut.svg", "pattern.dxf", "report.json", "fold-guide.json".
///
/// @retval OutOfRange  the file is for cards of one sheet
[[nodiscard]] Result<std::string> parts_file(const PartsCard& made, const Material& material,
                                             std::string_view file);

}  // namespace popcut::planning
