// SPDX-License-Identifier: MIT
#include "core/design/book_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/design/shape_fit.hpp"
#include "core/design/target/placement_map.hpp"
#include "core/fit/area_samples.hpp"
#include "core/fit/distances.hpp"
#include "core/fit/triangle_tree.hpp"

namespace popcut {
namespace {

SpineMap spine_of(const Design& card) {
  std::vector<double> s_mm;
  for (const SliceReport& slice : card.report.slices) s_mm.push_back(slice.s_mm);
  return {card.strips, s_mm};
}

void append(const TriangleSoup& from, TriangleSoup& to) {
  to.corners.insert(to.corners.end(), from.corners.begin(), from.corners.end());
}

DistanceFigures figures_of(std::vector<double> far) {
  DistanceFigures out;
  out.samples = far.size();
  const auto count = static_cast<double>(far.size());
  double squares = 0.0;
  for (const double d : far) out.mean_mm += d / count, squares += d * d / count;
  out.rms_mm = std::sqrt(squares);
  std::sort(far.begin(), far.end());
  out.p95_mm = far[std::min(far.size() - 1, far.size() * 19 / 20)];
  out.max_mm = far.back();
  return out;
}

}  // namespace

TriangleSoup turned_in_book(TriangleSoup soup, double angle_deg, std::size_t card) {
  if (card == 0) return soup;
  // `turn_of` turns the wall toward the ground; cards follow each other the other way.
  const TurnMatrix turn = turn_of({0.0, -angle_deg * static_cast<double>(card), 0.0});
  for (std::size_t k = 0; k < soup.corners.size(); k += 3) {
    const double x = soup.corners[k], z = soup.corners[k + 2];
    soup.corners[k] = turn[0][0] * x + turn[0][2] * z;
    soup.corners[k + 2] = turn[2][0] * x + turn[2][2] * z;
  }
  return soup;
}

TriangleSoup book_structure(const PatchAssembly& book) {
  TriangleSoup out;
  for (std::size_t i = 0; i < book.parts.size(); ++i) {
    const Design& card = book.parts[i];
    TriangleSoup own = structure_triangles(card.strips, card.pattern, SpineMap());
    for (std::size_t k = 1; k < own.corners.size(); k += 3) own.corners[k] -= book.book->shift_mm;
    append(turned_in_book(std::move(own), book.book->angle_deg, i), out);
  }
  return out;
}

TriangleSoup book_target(const PatchAssembly& book) {
  TriangleSoup out;
  for (std::size_t i = 0; i < book.parts.size(); ++i) {
    const Design& card = book.parts[i];
    if (book.book->is_plain[i]) continue;
    append(turned_in_book(target_triangles(card.strips, spine_of(card), card.report, card.target),
                          book.book->angle_deg, i),
           out);
    if (book.book->has_whole_target) break;
  }
  return out;
}

std::optional<BookFit> book_fit(const PatchAssembly& book) {
  constexpr SampleDensity kDensity{0.25, 4096, 32768};
  const TriangleSoup target = book_target(book), structure = book_structure(book);
  BookFit out;
  out.size_mm = diagonal_of(target);
  out.target_mm2 = area_of(target), out.structure_mm2 = area_of(structure);
  const auto points = area_samples(target, samples_of(out.target_mm2, kDensity));
  const auto own = area_samples(structure, samples_of(out.structure_mm2, kDensity));
  if (points.empty() || own.empty()) return std::nullopt;
  std::vector<double> far = distances(points, TriangleTree(structure));
  for (std::size_t w = 0; w < BookFit::kWithin.size(); ++w) {
    const double near = BookFit::kWithin[w] * out.size_mm;
    const auto within = std::count_if(far.begin(), far.end(), [&](double d) { return d <= near; });
    out.share_within[w] = static_cast<double>(within) / static_cast<double>(far.size());
  }
  out.to_structure = figures_of(std::move(far));
  out.to_target = figures_of(distances(own, TriangleTree(target)));
  return out;
}

}  // namespace popcut
