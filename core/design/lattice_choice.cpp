// SPDX-License-Identifier: MIT
#include "core/design/lattice_choice.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/design/design_report.hpp"
#include "core/design/shape_fit.hpp"

namespace popcut {
namespace {

constexpr SampleDensity kRankingDensity{1.0, 2048, 4096};

/// A section of the target and its place on the sheet.
struct PlacedSection {
  double v_mm{};
  const SliceCurve* curve{};
};

/// The sections in their order along the spine; the first and the last reach to the ends of the
/// strips.
std::vector<PlacedSection> placed_sections(const Slicing& sliced, const Strips& strips) {
  const std::vector<double> v = slice_places(strips, sliced.s_mm.size());
  std::size_t first = 0, last = strips.size();
  while (strips.kind[first] == StripKind::Margin) ++first;
  while (strips.kind[last - 1] == StripKind::Margin) --last;
  std::vector<PlacedSection> out{{strips.v_begin[first], &sliced.curves.front()}};
  for (std::size_t j = 0; j < v.size(); ++j) {
    out.push_back({v[j], &sliced.curves[j]});
    if (j + 1 == v.size()) break;
    const double share =
        (sliced.between_s_mm[j] - sliced.s_mm[j]) / (sliced.s_mm[j + 1] - sliced.s_mm[j]);
    out.push_back({v[j] + share * (v[j + 1] - v[j]), &sliced.between[j]});
  }
  out.push_back({strips.v_begin[last], &sliced.curves.back()});
  return out;
}

TriangleSoup target_soup(const Slicing& sliced, const Strips& strips, const DesignAngle& opening) {
  const std::vector<PlacedSection> sections = placed_sections(sliced, strips);
  // Chords that stray from the curve by far less than panels do, fewer where sections are many.
  const std::size_t chords = std::clamp<std::size_t>(200'000 / sections.size(), 48, 256);
  TriangleSoup soup;
  soup.corners.reserve(18 * chords * sections.size());
  std::vector<Vec3> last, here;
  for (const PlacedSection& section : sections) {
    here.clear();
    for (std::size_t k = 0; k <= chords; ++k) {
      const CurveJet c =
          section.curve->at(-1.0 + 2.0 * static_cast<double>(k) / static_cast<double>(chords));
      double x = c.x, z = c.z;
      opening.to_space(x, z);
      here.emplace_back(x, section.v_mm, z);
    }
    for (std::size_t k = 0; k + 1 < here.size() && !last.empty(); ++k)
      soup.add(last[k], here[k], here[k + 1], last[k + 1]);
    last.swap(here);
  }
  return soup;
}

}  // namespace

LatticeRanking::LatticeRanking(const Slicing& sliced, const Strips& strips, double design_psi_rad)
    : target_(target_soup(sliced, strips, DesignAngle::of_rad(design_psi_rad)), kRankingDensity) {
  opened_.design_psi_rad = design_psi_rad;
}

void LatticeRanking::measure(const Strips& strips, LatticeTrial& trial) const {
  const FitFigures figures =
      target_.measure_roughly(structure_triangles(strips, opened_, SpineMap{}));
  trial.laid = true;
  trial.to_target_mean_mm = figures.to_target.mean_mm;
  trial.to_structure_mean_mm = figures.to_structure.mean_mm;
  trial.two_sided_rms_mm = figures.two_sided_rms_mm();
}

}  // namespace popcut
