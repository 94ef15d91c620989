// SPDX-License-Identifier: MIT
#include "daemon/cli/input/compared_book.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "core/compare/view.hpp"
#include "core/design/book.hpp"
#include "core/design/facet_design.hpp"
#include "core/design/target/placement_map.hpp"
#include "core/geometry/angle.hpp"
#include "core/judge/book_pose.hpp"
#include "core/verify/sheet/fold_model.hpp"
#include "core/verify/target/target.hpp"
#include "core/verify/verify.hpp"
#include "daemon/cli/input/spec_assets.hpp"
#include "daemon/files/output_folder.hpp"

namespace popcut::cli {
namespace compared_book {
namespace {

constexpr std::uintmax_t kCardLimitBytes = 1u << 29;

void append(const std::vector<float>& from, std::vector<float>& to) {
  to.insert(to.end(), from.begin(), from.end());
}

/// The design of a book as one of `card`, with the placement that the verifier reads.
DesignSpec spec_of_card(DesignSpec spec, const DesignSpec& card) {
  spec.placement.design_angle_deg = card.placement.design_angle_deg;
  if (!card.surface || std::holds_alternative<RevolutionSpec>(*card.surface) ||
      !turns_with_cards(*card.surface))
    if (card.placement.about_spine_deg == 0.0) return spec;
  spec.placement.rotate_deg = degrees_of(whole_turn(card.placement));
  spec.placement.translate_mm = whole_shift_mm(card.placement);
  return spec;
}

/// Facets have no slices to check, so that the verifier does not read them.
Result<ComparedTarget> facet_book_target(const DesignSpec& spec, const SurfaceAssets& assets,
                                         const TargetPlacement& placement, bool is_mesh) {
  ComparedTarget out;
  out.is_solid = is_mesh;
  out.placed_by = "spec";
  const auto cards = static_cast<std::size_t>(spec.book->cards);
  for (std::size_t i = 0; i < (is_mesh ? 1 : cards); ++i) {
    const auto target = facet_target(card_of_book(spec, placement, i), assets);
    if (!target) return tl::unexpected(target.error());
    std::vector<float> own(target->soup.corners.begin(), target->soup.corners.end());
    judge::turn_about_spine(own, radians(static_cast<double>(i) * spec.book->angle_deg()));
    append(own, out.triangles);
    out.placement.shift_mm.y() = spec.card->margin_mm - target->from_mm;
  }
  out.triangles = likeness::placed(out.triangles, out.placement);
  return out;
}

}  // namespace
}  // namespace compared_book

Result<ComparedStructure> read_compared_book(const std::vector<std::string>& files,
                                             const Progress& progress) {
  using namespace compared_book;
  judge::BookPose book;
  ComparedStructure out;
  out.is_book = true;
  for (const std::string& file : files) {
    tell(progress, "reading the cards");
    auto text = read_file(file, kCardLimitBytes);
    if (!text) return tl::unexpected(text.error());
    const auto stands = book.add(file, *text, progress);
    if (!stands) return tl::unexpected(stands.error());
    if (out.fold_text.empty() && *stands) out.fold_text = std::move(*text);
  }
  constexpr double kRounding = 1e-6;
  if (book.turned_rad > 2.0 * std::numbers::pi + kRounding)
    return fail(ErrorKind::OutOfRange, files.back(),
                fmt::format("the cards take {:.4g} degrees, more than a whole turn; give those of "
                            "one book",
                            degrees(book.turned_rad)));
  if (book.triangles.empty())
    return fail(ErrorKind::OutOfRange, files.front(),
                "nothing stands between the pages of the book, so there is nothing to compare");
  out.triangles = std::move(book.triangles);
  out.model = std::move(book.model);
  out.psi_rad = book.psi_rad;
  out.folds = book.folds, out.pieces = book.pieces;
  out.smallest_joint_mm = book.smallest_joint_mm;
  out.notes = std::move(book.notes);
  return out;
}

Result<ComparedTarget> read_book_target(const std::string& file, const std::string& text,
                                        const ComparedStructure& structure) {
  using namespace compared_book;
  const auto spec = parse_design_spec(text);
  if (!spec) return tl::unexpected(within(file, spec.error()));
  if (!spec->book)
    return fail(ErrorKind::OutOfRange, file,
                "is the design of one card; give the model as a mesh, or the design of the book");
  const auto assets = load_assets(*spec, file);
  if (!assets) return tl::unexpected(within(file, assets.error()));
  const auto placement = book_placement(*spec, *assets);
  if (!placement) return tl::unexpected(within(file, placement.error()));
  const bool is_mesh = spec->surface && std::holds_alternative<MeshSpec>(*spec->surface);
  if (is_of_facets(spec->style)) {
    auto facets = facet_book_target(*spec, *assets, *placement, is_mesh);
    if (!facets) return tl::unexpected(within(file, facets.error()));
    return facets;
  }
  const verify::TargetFiles target_files(assets->begin(), assets->end());
  const likeness::Box box = likeness::box_of(structure.triangles);
  const double reach = 1.05 * std::max({box.high.x(), box.high.z(), -box.low.x(), -box.low.z()});
  ComparedTarget out;
  out.is_solid = is_mesh;
  out.placed_by = "spec";
  const auto cards = static_cast<std::size_t>(spec->book->cards);
  std::optional<double> shift;  // from the target to the sheets
  for (std::size_t i = 0; i < (is_mesh ? 1 : cards); ++i) {
    const DesignSpec card = card_of_book(*spec, *placement, i);
    auto target = verify::read_target(spec_of_card(*spec, card), target_files);
    if (!target) return tl::unexpected(within(file, target.error()));
    if (i == 0) {
      shift = shift_along_spine(structure.fold_text, *target);
      if (structure.model) shift = structure.model->shift_mm.y() - placement->translate_mm[1];
    }
    verify::TargetReach wanted{box.low.y() - shift.value_or(0.0),
                               box.high.y() - shift.value_or(0.0), reach, reach};
    if (!shift && !target->slices.empty()) {
      wanted.begin_mm = -0.5 * target->slices.front().width_mm;
      wanted.end_mm = target->slices.back().s_mm + 0.5 * target->slices.back().width_mm;
    }
    TriangleMesh triangles;
    target->surface->add_triangles(wanted, triangles);
    judge::turn_about_spine(triangles.corners,
                            radians(static_cast<double>(i) * spec->book->angle_deg()));
    append(triangles.corners, out.triangles);
  }
  if (shift) {
    out.placement.shift_mm.y() = *shift;
  } else {
    const auto found =
        likeness::find_shift_along_spine(out.triangles, {}, structure.triangles, std::nullopt);
    out.placement = found.placement, out.misfit = found.misfit;
  }
  out.triangles = likeness::placed(out.triangles, out.placement);
  if (!(likeness::box_of(out.triangles).diagonal() > 0.0))
    return fail(ErrorKind::OutOfRange, file, "the surface has no part along the slices");
  return out;
}

}  // namespace popcut::cli
