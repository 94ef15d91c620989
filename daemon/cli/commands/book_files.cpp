// SPDX-License-Identifier: MIT
#include "daemon/cli/commands/book_files.hpp"

#include <cstdio>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/deploy/sheet_mesh.hpp"
#include "core/design/book_fit.hpp"
#include "core/formats/write/report_json.hpp"
#include "core/text/utf8.hpp"
#include "daemon/cli/view/book_picture.hpp"
#include "daemon/planning/views/book_animation.hpp"

namespace popcut::cli {
namespace book_files_parts {
namespace {

std::vector<float> floats(const TriangleSoup& soup, double shift_mm) {
  std::vector<float> out;
  out.reserve(soup.corners.size());
  for (std::size_t k = 0; k < soup.corners.size(); ++k)
    out.push_back(static_cast<float>(soup.corners[k] + (k % 3 == 1 ? shift_mm : 0.0)));
  return out;
}

/// All faces of a card as it stands opened.
Result<TriangleSoup> paper_of(const Pattern& pattern) {
  const auto faces = triangulate_faces(pattern);
  if (!faces) return tl::unexpected(faces.error());
  const auto places = posed_vertices(pattern, pattern.design_psi_rad);
  TriangleSoup out;
  for (std::size_t f = 0; f < faces->faces(); ++f) {
    const auto face = pattern.face(f);
    const std::uint32_t first = faces->first_corner[f];
    const auto at = [&](std::uint32_t corner) { return Vec3(places[face[corner - first]].data()); };
    for (std::uint32_t t = faces->first_triangle[f]; t < faces->first_triangle[f + 1]; ++t) {
      const auto& [a, b, c] = faces->triangle[t];
      out.add(at(a), at(b), at(c));
    }
  }
  return out;
}

Result<std::string> picture_of(const PatchAssembly& book) {
  BookScene scene;
  const double shift = book.book->shift_mm;
  for (std::size_t i = 0; i < book.parts.size(); ++i) {
    auto paper = paper_of(book.parts[i].pattern);
    if (!paper) return tl::unexpected(paper.error());
    const auto turned = floats(turned_in_book(std::move(*paper), book.book->angle_deg, i), 0.0);
    scene.pages.insert(scene.pages.end(), turned.begin(), turned.end());
  }
  scene.structure = floats(book_structure(book), shift);
  scene.model = floats(book_target(book), shift);
  return book_picture(scene, fmt::format("{}: {} cards of {:g} degrees", book.name,
                                         book.parts.size(), book.book->angle_deg));
}

}  // namespace
}  // namespace book_files_parts

Result<void> add_book_files(const PatchAssembly& book, const BookFiles& files,
                            OutputFolder& folder) {
  using namespace book_files_parts;
  if (auto done = folder.add("book.json", report_json(book)); !done) return done;
  if (files.animation) {
    std::vector<const Pattern*> cards;
    for (const Design& card : book.parts) cards.push_back(&card.pattern);
    const auto glb = planning::book_animation_glb(cards, book.name, files.thickness_mm);
    if (!glb) return tl::unexpected(glb.error());
    if (auto done = folder.add("book.glb", *glb); !done) return done;
  }
  if (!files.picture) return {};
  const auto picture = picture_of(book);
  if (!picture) return tl::unexpected(picture.error());
  return folder.add("book.svg", *picture);
}

void say_book(const PatchAssembly& book) {
  const BookReport& report = *book.book;
  fmt::print(stderr, "{}: a book of {} cards, each open to {:g} degrees\n", shown_text(book.name),
             book.parts.size(), report.angle_deg);
  if (report.fit) {
    const BookFit& fit = *report.fit;
    fmt::print(stderr,
               "  shape    {:.3g} mm off on average ({:.2f} % of its size, {:.4g} mm); {:.1f} % of "
               "it is within 5 %, {:.1f} % within 1.5 %\n",
               fit.to_structure.mean_mm, 100.0 * fit.to_structure.mean_mm / fit.size_mm,
               fit.size_mm, 100.0 * fit.share_within[2], 100.0 * fit.share_within[0]);
  }
  fmt::print(stderr,
             "  pages    {:.1f} x {:.1f} mm; shut, the structures reach {:.1f} mm from the spine\n",
             report.page_mm, report.width_mm, report.closed_mm);
  fmt::print(stderr,
             "  glue     the wall of each card onto the back of the next card's ground; the ground "
             "of card 1 and the wall of card {} are the covers\n",
             book.parts.size());
}

}  // namespace popcut::cli
