// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/design/target/surface_spec.hpp"
#include "core/fit/fit_figures.hpp"
#include "core/hands/folding.hpp"
#include "core/hands/wobble.hpp"
#include "core/warning.hpp"

namespace popcut {

/// Root mean square and largest value of an error, mm.
struct ErrorFigures {
  double rms_mm{};
  double max_mm{};
  std::size_t count{};  ///< of what was measured
};

/// How well a chain came out.
struct ChainFigures {
  double loss{};  ///< L of section 3, mm^2
  int iterations{};
  int minima{1};    ///< different ones that were found from several starts
  double spread{};  ///< largest of them over the smallest, less 1: 0 for a single minimum
};

/// One slice of the report: where it lies and how its chain came out.
struct SliceReport : ChainFigures {
  double s_mm{};  ///< place along the target
  double v_mm{};  ///< centre line of its strip on the sheet
  double width_mm{};
  SliceFit fit{};
  bool blank{};  ///< plain card: the target is not there, or too small
  double wall_mm{},
      ground_mm{};  ///< where its curve of the target meets wall and ground; 0 if blank
};

/// How near a lattice comes to its target, as it is laid, after merging.
struct LatticeFigures {
  ErrorFigures inner_error;  ///< connector vertices between wall and ground, from their own curve
  ErrorFigures end_error;    ///< wall and ground ends, from h and d of the slice that sets them
  double step_over_mean_min{}, step_over_mean_max{};
  double longest_step_s_mm{};  ///< where along the target that is
  double gap_mm{};             ///< largest distance of a target point from the nearest fold vertex
};

/// A place where the lattice does not follow the target level by level, and why.
struct MergedPlace {
  int slice{};  ///< slice, or the left slice of a connector
  int level{};
  std::string where;   ///< "slice" or "connector"
  std::string reason;  ///< one sentence with values in mm
};

/// A connector between slices whose levels do not pair (`add_bridges`).
struct BridgeReport {
  int slice{};         ///< the left one
  double off_mm{};     ///< largest distance of its fold vertices and ends from the target
  int left_planes{};   ///< planes that it shares with the left slice
  int right_planes{};  ///< and with the right one
};

/// Root mean square and largest distance from what was asked, in the measure's own unit.
struct MissFigures {
  double rms{};
  double max{};
};

/// What was asked of one measure of curvature, and what came of it. A miss is the distance from the
/// target, over all vertices; of a fundamental form its Frobenius norm.
struct CurvatureFigures {
  std::string name;  ///< "K_area", "H", "first", "second"
  std::string unit;
  bool asked{};
  double least{}, largest{};     ///< reached at the chains' vertices (of K_area and H)
  MissFigures plain_miss, miss;  ///< of the plain chains and of the augmented ones
  std::size_t lattice_vertices{};
  double lattice_least{}, lattice_largest{};  ///< at the lattice's own fold vertices
  MissFigures lattice_miss;
};

/// What the augmented loss did (`"curvature"` of the spec).
struct CurvatureReport {
  std::size_t vertices{};         ///< inner ones that have a target
  int slices_left_out{};          ///< in runs that are too small
  double start_mm2{}, end_mm2{};  ///< the augmented loss of the plain chains and of the result
  int evaluations{};
  bool out_of_time{};
  std::vector<CurvatureFigures> figures;
  std::vector<std::ptrdiff_t>
      first_target;  ///< one for each slice: of its first target, -1 for none
};

/// A lattice that was laid and measured for `"lattice": "auto"`. Distances are those of the panels
/// from the sections of the target, in space.
struct LatticeTrial {
  std::string lattice;
  bool laid{};  ///< it could be: the figures are there
  double to_target_mean_mm{}, to_structure_mean_mm{};
  double two_sided_rms_mm{};  ///< what is chosen by
  std::string reason;         ///< why it was not to be taken, else empty
};

/// How near the facets come to the target. Distances are along the direction of sight (1, 0, 1), at
/// points of the sheet where the target is seen or something stands.
struct FacetFigures {
  double depth_mean_mm{}, depth_p95_mm{};
  std::size_t patches{};   ///< connected pieces of one plane
  double over_least{1.0};  ///< the distance over the least one of any strips of these planes
  int planes{};            ///< that were tried
  int loose_before{}, shifted{}, dropped{};
  std::size_t struts{}, moves{};
};

/// What a design is, in figures (`report.json`).
struct DesignReport : LatticeFigures {
  std::string name;
  std::vector<int> units_per_slice;  ///< one, or one for each region
  std::vector<SliceReport> slices;
  std::string lattice;                 ///< the method that was used
  std::string lattice_asked;           ///< the method that was asked for
  std::string lattice_note;            ///< why they differ, else empty
  std::vector<LatticeTrial> lattices;  ///< those that "auto" chose from
  std::size_t faces{}, panels{}, folds{}, cuts{};
  double cut_length_mm{};      ///< of the slits, each once
  double outline_length_mm{};  ///< of the sheet's border
  double fold_length_mm{};
  hands::Handwork handwork;                    ///< what it takes to fold it
  std::optional<hands::WobbleFigures> wobble;  ///< how firmly it holds in paper; none: not measured
  int degrees_of_freedom{};
  int pieces{};
  double sheet_u_mm{}, sheet_v_mm{};
  double sticks_out_mm{};  ///< how far the structure reaches out of the shut card
  std::vector<MergedPlace> merged;
  std::vector<BridgeReport> bridges;
  std::optional<FacetFigures> facets;        ///< of that style: the lattice's figures say nothing
  std::optional<CurvatureReport> curvature;  ///< where the spec asks for some
  std::vector<std::string> notes;            ///< plain cuts, halved slices, spread of minima
  std::vector<Warning> warnings;             ///< what makes it hard to cut, fold or shut, and where
  double design_angle_deg{90.0};             ///< at which the structure is measured
  bool fit_nearest{};                        ///< "fit": "nearest" was asked for
  SliceFit fit{};                            ///< of all slices together
  std::optional<FitFigures> surface_fit;     ///< of the opened structure and the target itself
  double seconds{};
};

}  // namespace popcut
